//! The `.msg` files of the types in a bag, and for each type all that it is made of.

macro_rules! define {
    ($name:literal) => {
        ($name, include_str!(concat!("definitions/", $name, ".msg")))
    };
}

/// Every type by `package/Type`, with its `.msg` text without comments (common interfaces of ROS 2 Humble).
const DEFINITIONS: &[(&str, &str)] = &[
    define!("builtin_interfaces/Duration"),
    define!("builtin_interfaces/Time"),
    define!("geometry_msgs/Point"),
    define!("geometry_msgs/Pose"),
    define!("geometry_msgs/PoseStamped"),
    define!("geometry_msgs/PoseWithCovariance"),
    define!("geometry_msgs/Quaternion"),
    define!("geometry_msgs/Transform"),
    define!("geometry_msgs/TransformStamped"),
    define!("geometry_msgs/Twist"),
    define!("geometry_msgs/TwistWithCovariance"),
    define!("geometry_msgs/Vector3"),
    define!("nav_msgs/MapMetaData"),
    define!("nav_msgs/OccupancyGrid"),
    define!("nav_msgs/Odometry"),
    define!("nav_msgs/Path"),
    define!("rcl_interfaces/Log"),
    define!("rosgraph_msgs/Clock"),
    define!("sensor_msgs/CompressedImage"),
    define!("sensor_msgs/LaserScan"),
    define!("std_msgs/ColorRGBA"),
    define!("std_msgs/Float64"),
    define!("std_msgs/Header"),
    define!("std_msgs/String"),
    define!("tf2_msgs/TFMessage"),
    define!("visualization_msgs/Marker"),
    define!("visualization_msgs/MarkerArray"),
    define!("visualization_msgs/MeshFile"),
    define!("visualization_msgs/UVCoordinate"),
];

/// Returns the definition of `name` (`package/Type`) with those of all types within behind it, each once: schema
/// encoding `ros2msg`.
pub(super) fn definition(name: &str) -> String {
    let mut parts = vec![name.to_owned()];
    let mut text = String::new();
    let mut next = 0;
    while let Some(part) = parts.get(next).cloned() {
        let own = text_of(&part).unwrap_or_default();
        if next > 0 {
            text += &format!("{}\nMSG: {part}\n", "=".repeat(80));
        }
        text += own;
        for within in types_within(&part, own) {
            if !parts.contains(&within) {
                parts.push(within);
            }
        }
        next += 1;
    }
    text
}

fn text_of(name: &str) -> Option<&'static str> {
    DEFINITIONS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Returns the types, other than built-in ones, of the fields of `text`; those without a package are of the package of
/// `name`.
fn types_within(name: &str, text: &str) -> Vec<String> {
    let package = name.split('/').next().unwrap_or_default();
    let kinds = text.lines().filter_map(|line| line.split([' ', '[']).next());
    kinds
        .filter(|kind| kind.contains('/') || kind.starts_with(char::is_uppercase))
        .map(|kind| if kind.contains('/') { kind.to_owned() } else { format!("{package}/{kind}") })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_within_a_type_is_defined() {
        for (name, text) in DEFINITIONS {
            for within in types_within(name, text) {
                assert!(text_of(&within).is_some(), "{name} has a {within}");
            }
        }
    }

    #[test]
    fn a_definition_has_its_parts_behind_it_once() {
        let text = definition("nav_msgs/Path");
        let parts: Vec<&str> = text.lines().filter_map(|l| l.strip_prefix("MSG: ")).collect();
        assert_eq!(
            parts,
            [
                "std_msgs/Header",
                "geometry_msgs/PoseStamped",
                "builtin_interfaces/Time",
                "geometry_msgs/Pose",
                "geometry_msgs/Point",
                "geometry_msgs/Quaternion"
            ]
        );
        assert!(text.starts_with("std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n="));
    }
}
