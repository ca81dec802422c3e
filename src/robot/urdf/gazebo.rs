//! The `<gazebo>` blocks: the sensors that the robot carries, and the drive of its wheels.
//!
//! Sensors after SDF 1.6 (`ray`, `gpu_ray`, also `lidar` of later versions; `logical_camera`; `magnetometer` and `imu`,
//! either of which is read as a compass); drives after the plugins of gazebo_ros_pkgs (`diff_drive`,
//! `skid_steer_drive`), gz-sim (`diff-drive-system`) and kobuki_desktop (`kobuki`).

mod camera;
mod lidar;

use crate::document::suggestion;
use crate::document::xml::{self, Faults};
use crate::geometry::Placement;
use crate::robot::{Compass, Drive, DriveKind, Lidar, LogicalCamera};
use crate::units::Tick;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// Drive plugins by file name without `lib` and `.so`.
const DRIVES: [(&str, DriveKind); 7] = [
    ("gazebo_ros_diff_drive", DriveKind::Differential),
    ("gazebo_ros_kobuki", DriveKind::Differential),
    ("DiffDrivePlugin", DriveKind::Differential),
    ("gz-sim-diff-drive-system", DriveKind::Differential),
    ("ignition-gazebo-diff-drive-system", DriveKind::Differential),
    ("gazebo_ros_skid_steer_drive", DriveKind::SkidSteer),
    ("SkidSteerDrivePlugin", DriveKind::SkidSteer),
];

/// Plugins that only publish what the simulator knows anyway.
const HARMLESS: [&str; 4] = [
    "gazebo_ros_control",
    "gazebo_ros_joint_state_publisher",
    "gazebo_ros_p3d",
    "gz-sim-joint-state-publisher-system",
];

/// The sensors that are simulated, the first of each kind.
#[derive(Debug, Default)]
pub(super) struct Sensors {
    pub(super) lidar: Option<Lidar>,
    pub(super) camera: Option<LogicalCamera>,
    pub(super) compass: Option<Compass>,
}

/// The kind of sensor that is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Scanner,
    Camera,
    Compass,
}

impl Kind {
    /// Returns the kind that SDF's `type` names.
    fn of(name: &str) -> Option<Self> {
        match name {
            "ray" | "gpu_ray" | "lidar" | "gpu_lidar" => Some(Self::Scanner),
            "logical_camera" => Some(Self::Camera),
            "magnetometer" | "imu" => Some(Self::Compass),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Scanner => "range scanner",
            Self::Camera => "logical camera",
            Self::Compass => "compass",
        }
    }
}

/// Reads the drive plugin of the robot; `None` with a fault where there is none.
pub(super) fn drive(document: &Document<'_>, faults: &mut Faults<'_>) -> Option<Drive> {
    let mut found: Option<Drive> = None;
    let mut any = false;
    for plugin in
        blocks(document).flat_map(xml::elements).filter(|e| e.tag_name().name() == "plugin")
    {
        let file = plugin.attribute("filename").unwrap_or("");
        let name = file.strip_prefix("lib").unwrap_or(file);
        let name = name.strip_suffix(".so").unwrap_or(name);
        let Some((_, kind)) = DRIVES.iter().find(|(known, _)| *known == name) else {
            if !HARMLESS.contains(&name) {
                let mut fault = faults
                    .at(plugin, format!("unknown plugin `{file}`"))
                    .label("ignored")
                    .warning();
                if let Some(near) = suggestion(name, DRIVES.iter().map(|(known, _)| *known)) {
                    fault = fault.help(format!("did you mean `lib{near}.so`?"));
                }
                faults.push(fault);
            }
            continue;
        };
        if any {
            let fault = faults.at(plugin, "second drive plugin").label("expected one drive");
            faults.push(fault);
            continue;
        }
        any = true;
        found = read_drive(plugin, *kind, faults);
    }
    if !any {
        let fault = faults
            .at(document.root_element(), "the robot has no drive")
            .label("expected a <gazebo> block with a drive plugin")
            .help("add libgazebo_ros_diff_drive.so with wheelSeparation and wheelDiameter");
        faults.push(fault);
    }
    found
}

fn read_drive(plugin: Node<'_, '_>, kind: DriveKind, faults: &mut Faults<'_>) -> Option<Drive> {
    let separation = positive(plugin, &["wheelSeparation", "wheel_separation"], faults);
    let diameter = positive(plugin, &["wheelDiameter", "wheel_diameter"], faults).or_else(|| {
        positive(plugin, &["wheel_radius", "wheelRadius"], faults).map(|radius| 2.0 * radius)
    });
    for (value, expected) in [
        (separation, "<wheelSeparation> or <wheel_separation> in metres"),
        (diameter, "<wheelDiameter>, <wheel_diameter> or <wheel_radius> in metres"),
    ] {
        if value.is_none() {
            let fault = faults
                .at(plugin, "drive without its wheels' geometry")
                .label(format!("expected {expected}"));
            faults.push(fault);
        }
    }
    Some(Drive {
        kind,
        wheel_separation: separation?,
        wheel_diameter: diameter?,
        max_linear: positive(plugin, &["max_linear_velocity"], faults),
        max_angular: positive(plugin, &["max_angular_velocity"], faults),
    })
}

/// Returns the positive number in the first child called one of `names`; a fault where it is present and not such a
/// number.
fn positive(node: Node<'_, '_>, names: &[&str], faults: &mut Faults<'_>) -> Option<f64> {
    let child = names.iter().find_map(|name| xml::child(node, name))?;
    let number = faults.number(child)?;
    if number > 0.0 {
        return Some(number);
    }
    let fault = faults
        .at(child, format!("{} out of range", child.tag_name().name()))
        .label(format!("expected more than zero, found {number}"));
    faults.push(fault);
    None
}

/// Reads the first sensor of every kind that is simulated. Others are warned of.
pub(super) fn sensors(
    document: &Document<'_>,
    faults: &mut Faults<'_>,
    frames: &BTreeMap<String, Placement>,
    ground: f64,
) -> Sensors {
    let mut found = Sensors::default();
    let mut seen = Vec::new();
    for block in blocks(document) {
        let sensors: Vec<_> =
            xml::elements(block).filter(|e| e.tag_name().name() == "sensor").collect();
        let frame = block.attribute("reference").map(|link| frames.get(link));
        if let Some(None) = frame {
            let link = block.attribute("reference").unwrap_or_default();
            let mut fault = faults.at(block, format!("reference to an unknown link `{link}`"));
            if let Some(near) = suggestion(link, frames.keys().map(String::as_str)) {
                fault = fault.help(format!("did you mean `{near}`?"));
            }
            // A block that only colours a missing link does no harm.
            faults.push(if sensors.is_empty() { fault.warning() } else { fault });
            continue;
        }
        for node in sensors {
            let written = node.attribute("type").unwrap_or("");
            let name = node.attribute("name").unwrap_or("");
            let Some(kind) = Kind::of(written) else {
                let fault = faults
                    .at(node, format!("sensor `{name}` of type `{written}` is not simulated"))
                    .label("ignored")
                    .warning();
                faults.push(fault);
                continue;
            };
            if seen.contains(&kind) {
                let fault = faults
                    .at(node, format!("second {} `{name}`", kind.name()))
                    .label("ignored: the first one is used")
                    .warning();
                faults.push(fault);
                continue;
            }
            let Some(Some(link)) = frame else {
                let fault = faults
                    .at(block, format!("sensor `{name}` is on no link"))
                    .label("expected an attribute `reference`");
                faults.push(fault);
                continue;
            };
            seen.push(kind);
            let sensor = Sensor { node, kind, name, link };
            match kind {
                Kind::Scanner => found.lidar = lidar::read(&sensor, ground, faults),
                Kind::Camera => found.camera = camera::read(&sensor, faults),
                Kind::Compass => {
                    let rate_hz = sensor.rate("readings per second", faults);
                    found.compass =
                        rate_hz.map(|rate_hz| Compass { name: name.to_owned(), rate_hz });
                }
            }
        }
    }
    found
}

/// A `<sensor>` on its link.
struct Sensor<'a, 'i> {
    node: Node<'a, 'i>,
    kind: Kind,
    name: &'a str,
    link: &'a Placement,
}

impl Sensor<'_, '_> {
    /// Returns its kind and name, for messages.
    fn title(&self) -> String {
        format!("{} `{}`", self.kind.name(), self.name)
    }

    /// Returns its placement in the base frame; a fault where it is not level.
    fn level_placement(&self, plane: &str, faults: &mut Faults<'_>) -> Option<Placement> {
        let within = match xml::child(self.node, "pose") {
            Some(pose) => Placement::from_xyz_rpy(faults.numbers(pose)?),
            None => Placement::IDENTITY,
        };
        let placement = self.link.compose(&within);
        if placement.rotation[2][2] < 1.0 - 1e-6 {
            let fault = faults
                .at(self.node, format!("{} is tilted or upside down", self.title()))
                .label(format!("expected a level {plane}"));
            faults.push(fault);
        }
        Some(placement)
    }

    /// Returns its `<update_rate>` (Hz); a fault where the clock cannot serve it.
    fn rate(&self, meaning: &str, faults: &mut Faults<'_>) -> Option<f64> {
        let rate = faults.required(self.node, "update_rate", meaning)?;
        if Tick::period_of(rate).is_none() {
            let verb = if self.kind == Kind::Scanner { "scans" } else { "reads" };
            let fault = faults
                .at(self.node, format!("{} {verb} at {rate} Hz", self.title()))
                .label("expected a rate that divides the clock's 3000 Hz")
                .help("common rates are 5, 10, 12.5, 20, 25, 30, 40 and 50 Hz");
            faults.push(fault);
        }
        Some(rate)
    }
}

/// Returns the `<gazebo>` blocks of the robot.
fn blocks<'a, 'i>(document: &'a Document<'i>) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i> {
    document.root_element().children().filter(|e| e.is_element() && e.tag_name().name() == "gazebo")
}
