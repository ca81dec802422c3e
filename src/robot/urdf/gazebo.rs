//! The `<gazebo>` blocks: which range scanner the robot carries, and how its wheels drive it.
//!
//! Sensors after SDF 1.6 (`ray`, `gpu_ray`, also `lidar` of later versions); drives after the plugins of
//! gazebo_ros_pkgs (`diff_drive`, `skid_steer_drive`), gz-sim (`diff-drive-system`) and kobuki_desktop
//! (`kobuki`).

use crate::document::suggestion;
use crate::document::xml::{self, Faults};
use crate::geometry::{Placement, Pose};
use crate::robot::{Drive, DriveKind, Lidar};
use crate::units::Tick;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

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

const SCANNERS: [&str; 4] = ["ray", "gpu_ray", "lidar", "gpu_lidar"];

/// The drive plugin of the robot, or a fault.
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

/// The positive number in the first child called one of `names`; a fault where it is there and is not one.
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

/// The first range scanner of the robot. Other sensors and further scanners are warned of.
pub(super) fn lidar(
    document: &Document<'_>,
    faults: &mut Faults<'_>,
    frames: &BTreeMap<String, Placement>,
    ground: f64,
) -> Option<Lidar> {
    let mut found = None;
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
            // What only colours a link that is not there does no harm.
            faults.push(if sensors.is_empty() { fault.warning() } else { fault });
            continue;
        }
        for sensor in sensors {
            let kind = sensor.attribute("type").unwrap_or("");
            let name = sensor.attribute("name").unwrap_or("");
            if !SCANNERS.contains(&kind) {
                let fault = faults
                    .at(sensor, format!("sensor `{name}` of type `{kind}` is not simulated"))
                    .label("ignored")
                    .warning();
                faults.push(fault);
            } else if found.is_some() {
                let fault = faults
                    .at(sensor, format!("second range scanner `{name}`"))
                    .label("ignored: the first one is used")
                    .warning();
                faults.push(fault);
            } else if let Some(Some(frame)) = frame {
                found = Some(read_lidar(sensor, name, frame, ground, faults));
            } else {
                let fault = faults
                    .at(block, format!("sensor `{name}` is on no link"))
                    .label("expected an attribute `reference`");
                faults.push(fault);
            }
        }
    }
    found.flatten()
}

fn read_lidar(
    sensor: Node<'_, '_>,
    name: &str,
    link: &Placement,
    ground: f64,
    faults: &mut Faults<'_>,
) -> Option<Lidar> {
    let within = match xml::child(sensor, "pose") {
        Some(pose) => Placement::from_xyz_rpy(faults.numbers(pose)?),
        None => Placement::IDENTITY,
    };
    let placement = link.compose(&within);
    if placement.rotation[2][2] < 1.0 - 1e-6 {
        let fault = faults
            .at(sensor, format!("range scanner `{name}` is tilted or upside down"))
            .label("expected a level scan plane");
        faults.push(fault);
    }
    let rate_hz = faults.required(sensor, "update_rate", "scans per second");
    if let Some(rate) = rate_hz
        && Tick::period_of(rate).is_none()
    {
        let fault = faults
            .at(sensor, format!("range scanner `{name}` scans at {rate} Hz"))
            .label("expected a rate that divides the clock's 3000 Hz")
            .help("common rates are 5, 10, 12.5, 20, 25, 30, 40 and 50 Hz");
        faults.push(fault);
    }
    let Some(ray) = xml::child(sensor, "ray").or_else(|| xml::child(sensor, "lidar")) else {
        let fault = faults
            .at(sensor, format!("range scanner `{name}` has no <ray>"))
            .label("expected <ray> with <scan> and <range>");
        faults.push(fault);
        return None;
    };
    let (scan, range) = (xml::descend(ray, "scan/horizontal"), xml::child(ray, "range"));
    let (Some(scan), Some(range)) = (scan, range) else {
        let fault = faults
            .at(ray, format!("range scanner `{name}` is incomplete"))
            .label("expected <scan> with <horizontal>, and <range>");
        faults.push(fault);
        return None;
    };
    if let Some(rows) = xml::descend(ray, "scan/vertical/samples").and_then(|n| faults.number(n))
        && rows > 1.0
    {
        let fault = faults
            .at(ray, format!("range scanner `{name}` scans {rows} rows"))
            .label("only the horizontal one is simulated")
            .warning();
        faults.push(fault);
    }
    let samples = faults.required(scan, "samples", "a number of beams");
    let min_angle = faults.required(scan, "min_angle", "an angle in radians");
    let max_angle = faults.required(scan, "max_angle", "an angle in radians");
    let min_range = faults.required(range, "min", "a distance in metres");
    let max_range = faults.required(range, "max", "a distance in metres");
    let noise_sd = noise(ray, name, faults);

    let beams = beams(scan, samples?, faults);
    let (min_angle, mut max_angle) = (min_angle?, max_angle?);
    if max_angle <= min_angle || max_angle - min_angle > TAU + 0.01 {
        let fault = faults
            .at(scan, format!("range scanner `{name}` looks from {min_angle} to {max_angle} rad"))
            .label("expected min_angle below max_angle and at most a full turn between them");
        faults.push(fault);
    }
    let beams = beams?;
    if max_angle - min_angle >= TAU - 1e-6 {
        // Gazebo would look along the seam twice; the sensor itself does not.
        max_angle = min_angle + TAU * f64::from(beams - 1) / f64::from(beams);
        let fault = faults
            .at(scan, format!("range scanner `{name}` looks all round"))
            .label(format!("read as {beams} beams spaced evenly over the full turn"))
            .warning();
        faults.push(fault);
    }
    let (min_range, max_range) = (min_range?, max_range?);
    if min_range < 0.0 || max_range <= min_range {
        let fault = faults
            .at(range, format!("range scanner `{name}` sees from {min_range} to {max_range} m"))
            .label("expected zero or more, and a larger maximum");
        faults.push(fault);
    }
    let [x, y, z] = placement.translation;
    Some(Lidar {
        name: name.to_owned(),
        mount: Pose::new(x, y, placement.yaw()),
        height: z - ground,
        beams,
        min_angle,
        max_angle,
        min_range,
        max_range,
        rate_hz: rate_hz?,
        noise_sd: noise_sd?,
    })
}

/// Number of beams: whole, 2 to 100 000.
fn beams(scan: Node<'_, '_>, samples: f64, faults: &mut Faults<'_>) -> Option<u32> {
    // SDF: the number of ranges reported is samples times resolution, interpolated where that is above 1.
    if let Some(node) = xml::child(scan, "resolution")
        && let Some(resolution) = faults.number(node)
        && resolution != 1.0
    {
        let fault = faults
            .at(node, format!("scan resolution {resolution}"))
            .label("read as 1: every sample is a beam of its own")
            .warning();
        faults.push(fault);
    }
    if samples.fract() != 0.0 || !(2.0..=100_000.0).contains(&samples) {
        let fault = faults
            .at(scan, "number of samples out of range")
            .label(format!("expected a whole number from 2 to 100000, found {samples}"));
        faults.push(fault);
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Some(samples as u32)
}

/// Standard deviation (m) of the range noise: zero where none is described.
fn noise(ray: Node<'_, '_>, name: &str, faults: &mut Faults<'_>) -> Option<f64> {
    let Some(noise) = xml::child(ray, "noise") else { return Some(0.0) };
    let kind = noise
        .attribute("type")
        .or_else(|| xml::child(noise, "type").map(xml::text))
        .unwrap_or("none");
    match kind {
        "none" => return Some(0.0),
        "gaussian" => {}
        _ => {
            let fault = faults
                .at(noise, format!("range scanner `{name}` has noise of kind `{kind}`"))
                .label("expected `gaussian` or `none`");
            faults.push(fault);
            return None;
        }
    }
    if let Some(mean) = xml::child(noise, "mean").and_then(|node| faults.number(node))
        && mean != 0.0
    {
        let fault = faults
            .at(noise, format!("range scanner `{name}` has a bias of {mean} m"))
            .label("read as zero")
            .warning();
        faults.push(fault);
    }
    let sd = faults.required(noise, "stddev", "a standard deviation in metres")?;
    if sd < 0.0 {
        let fault = faults
            .at(noise, format!("range scanner `{name}` has a negative standard deviation"))
            .label(format!("expected zero or more, found {sd}"));
        faults.push(fault);
        return None;
    }
    Some(sd)
}

/// The `<gazebo>` blocks of the robot.
fn blocks<'a, 'i>(document: &'a Document<'i>) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i> {
    document.root_element().children().filter(|e| e.is_element() && e.tag_name().name() == "gazebo")
}
