//! The drive: a plugin of the simulator, after those of `gazebo_ros_pkgs` (ROS 1 and ROS 2), gz-sim and `kobuki_desktop`.

use super::amend;
use super::parts::Parts;
use super::wheels::{self, Wheels};
use crate::document::suggestion;
use crate::document::xml::{self, Faults};
use crate::robot::given::DriveDoc;
use crate::robot::{Drive, DriveKind};
use roxmltree::Node;

/// Drive plugins by [`base_name`].
const DRIVES: [(&str, DriveKind); 10] = [
    ("gazebo_ros_diff_drive", DriveKind::Differential),
    ("gazebo_ros_kobuki", DriveKind::Differential),
    ("gazebo_ros_create", DriveKind::Differential),
    ("DiffDrivePlugin", DriveKind::Differential),
    ("gz-sim-diff-drive-system", DriveKind::Differential),
    ("ignition-gazebo-diff-drive-system", DriveKind::Differential),
    ("diffdrive_plugin", DriveKind::Differential),
    ("gazebo_ros_skid_steer_drive", DriveKind::SkidSteer),
    ("SkidSteerDrivePlugin", DriveKind::SkidSteer),
    ("gazebo_ros_skid_steer", DriveKind::SkidSteer),
];

/// Plugins whose controllers are described elsewhere, in YAML that no file here names.
const CONTROLLERS: [&str; 5] = [
    "gazebo_ros_control",
    "gazebo_ros2_control",
    "gz_ros2_control-system",
    "ign_ros2_control-system",
    "gz_ros2_control",
];

/// Plugins that only publish what the simulator knows anyway, or run what is simulated here.
const HARMLESS: [&str; 14] = [
    "gazebo_ros_joint_state_publisher",
    "gazebo_ros_p3d",
    "gz-sim-joint-state-publisher-system",
    "gz-sim-pose-publisher-system",
    "gz-sim-odometry-publisher-system",
    "gz-sim-sensors-system",
    "gz-sim-imu-system",
    "gz-sim-contact-system",
    "ignition-gazebo-joint-state-publisher-system",
    "ignition-gazebo-pose-publisher-system",
    "ignition-gazebo-sensors-system",
    "ignition-gazebo-imu-system",
    "ignition-gazebo-contact-system",
    "ignition-gazebo-odometry-publisher-system",
];

/// Returns what a plugin's file is called without `lib`, `.so` and the number of a release.
fn base_name(file: &str) -> String {
    let file = file.rsplit('/').next().unwrap_or(file);
    let name = file.strip_prefix("lib").unwrap_or(file);
    let name = name.strip_suffix(".so").unwrap_or(name);
    for family in ["gz-sim", "ignition-gazebo"] {
        if let Some(rest) = name.strip_prefix(family) {
            return format!("{family}{}", rest.trim_start_matches(|c: char| c.is_ascii_digit()));
        }
    }
    name.to_owned()
}

/// Reads the drive of the robot as `given` amends it; `None` with a fault where there is none.
pub(super) fn read(
    parts: &Parts<'_, '_>,
    given: Option<&DriveDoc>,
    faults: &mut Faults<'_>,
) -> Option<Drive> {
    let mut drive: Option<(Node<'_, '_>, DriveKind)> = None;
    let mut controlled = false;
    for plugin in &parts.plugins {
        let file = plugin.attribute("filename").unwrap_or("");
        let name = base_name(file);
        let by_name = plugin.attribute("name").is_some_and(|name| name.ends_with("::DiffDrive"));
        let kind = DRIVES.iter().find(|(known, _)| *known == name).map(|(_, kind)| *kind);
        let Some(kind) = kind.or(by_name.then_some(DriveKind::Differential)) else {
            if CONTROLLERS.contains(&name.as_str()) {
                controlled = true;
            } else if !HARMLESS.contains(&name.as_str()) {
                let mut fault = faults
                    .at(*plugin, format!("unknown plugin `{file}`"))
                    .label("ignored")
                    .warning();
                if let Some(near) = suggestion(&name, DRIVES.iter().map(|(known, _)| *known)) {
                    fault = fault.help(format!("did you mean `lib{near}.so`?"));
                }
                faults.push(fault);
            }
            continue;
        };
        if drive.is_some() {
            let fault = faults.at(*plugin, "second drive plugin").label("expected one drive");
            faults.push(fault);
            continue;
        }
        drive = Some((*plugin, kind));
    }
    let given = given.cloned().unwrap_or(amend::NO_DRIVE);
    match drive {
        Some((plugin, kind)) => of_plugin(parts, plugin, kind, &given, faults),
        None => of_wheels(parts, controlled, &given, faults),
    }
}

/// Returns the drive of a plugin.
fn of_plugin(
    parts: &Parts<'_, '_>,
    plugin: Node<'_, '_>,
    kind: DriveKind,
    given: &DriveDoc,
    faults: &mut Faults<'_>,
) -> Option<Drive> {
    let names = |keys: &[&str]| -> Vec<_> {
        let joints = xml::elements(plugin).filter(|e| keys.contains(&e.tag_name().name()));
        joints.map(xml::text).collect()
    };
    let left =
        ["left_joint", "leftJoint", "left_wheel_joint_name", "leftFrontJoint", "leftRearJoint"];
    let right = [
        "right_joint",
        "rightJoint",
        "right_wheel_joint_name",
        "rightFrontJoint",
        "rightRearJoint",
    ];
    let (left, right) = (names(&left), names(&right));
    let wheels = wheels::read(parts, &left, &right);
    let kind = if wheels.many && left.len() > 1 { DriveKind::SkidSteer } else { kind };
    let written_separation = positive(plugin, &["wheelSeparation", "wheel_separation"], faults);
    let written_diameter =
        positive(plugin, &["wheelDiameter", "wheel_diameter"], faults).or_else(|| {
            positive(plugin, &["wheel_radius", "wheelRadius"], faults).map(|radius| 2.0 * radius)
        });
    let mut length = |given: Option<f64>,
                      written: Option<f64>,
                      of_wheels: Option<f64>,
                      what: &str,
                      expected: &str| {
        if let Some(found) = given.or(written) {
            return Some(found);
        }
        let fault = faults.at(plugin, format!("the drive does not say the wheels' {what}"));
        if let Some(found) = of_wheels {
            faults.push(fault.label(format!("read as {found} m, from their joints")).warning());
            return Some(found);
        }
        faults.push(fault.label(format!("expected {expected}")).help(ask(wheels, kind)));
        None
    };
    let separation = length(
        given.wheel_separation_m,
        written_separation,
        wheels.separation,
        "separation",
        "<wheelSeparation> or <wheel_separation> in metres",
    );
    let diameter = length(
        given.wheel_diameter_m,
        written_diameter,
        wheels.diameter,
        "diameter",
        "<wheelDiameter>, <wheel_diameter> or <wheel_radius> in metres",
    );
    let limit = |name, faults: &mut Faults<'_>| positive(plugin, &[name], faults);
    let max_linear = limit("max_linear_velocity", faults);
    let max_angular = limit("max_angular_velocity", faults);
    Some(Drive {
        kind: given.kind.unwrap_or(kind),
        wheel_separation: separation?,
        wheel_diameter: diameter?,
        max_linear: given.max_linear_m_s.or(max_linear),
        max_angular: given.max_angular_rad_s.or(max_angular),
    })
}

/// Returns the drive that the manifest gives, with what the wheels' joints add to it.
fn of_wheels(
    parts: &Parts<'_, '_>,
    controlled: bool,
    given: &DriveDoc,
    faults: &mut Faults<'_>,
) -> Option<Drive> {
    let wheels = wheels::read(parts, &[], &[]);
    let kind = if wheels.many { DriveKind::SkidSteer } else { DriveKind::Differential };
    let is_given = *given != amend::NO_DRIVE;
    let separation = given.wheel_separation_m.or(wheels.separation.filter(|_| is_given));
    let diameter = given.wheel_diameter_m.or(wheels.diameter.filter(|_| is_given));
    let (Some(wheel_separation), Some(wheel_diameter)) = (separation, diameter) else {
        let label = if controlled {
            "its wheels are driven by a controller whose numbers are not in this file"
        } else {
            "expected a plugin that drives its wheels"
        };
        let fault = faults.at(parts.root, "the robot has no drive").label(label);
        faults.push(fault.help(ask(wheels, kind)));
        return None;
    };
    Some(Drive {
        kind: given.kind.unwrap_or(kind),
        wheel_separation,
        wheel_diameter,
        max_linear: given.max_linear_m_s,
        max_angular: given.max_angular_rad_s,
    })
}

/// Says how to give a drive, in the numbers of the wheels' joints where they have some.
fn ask(wheels: Wheels, kind: DriveKind) -> String {
    let kind = match kind {
        DriveKind::Differential => "differential",
        DriveKind::SkidSteer => "skid-steer",
    };
    let number = |number: Option<f64>| number.map_or("...".to_owned(), |number| number.to_string());
    let (separation, diameter) = (number(wheels.separation), number(wheels.diameter));
    let source = if wheels.separation.is_some() { " (numbers of its wheels' joints)" } else { "" };
    format!(
        "give it in the manifest: `robot: {{file, drive: {{kind: {kind}, wheel-separation-m: {separation}, \
         wheel-diameter-m: {diameter}}}}}`{source}"
    )
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
