//! Poses as SDFormat writes them, in worlds and in robots.

use super::quoted;
use super::xml::{self, Faults};
use crate::geometry::Placement;
use roxmltree::Node;

/// A pose as written.
#[derive(Debug, Clone)]
pub struct Pose {
    /// The name of the frame that it is relative to; `None` where it does not say.
    pub frame: Option<String>,
    /// Where it is in that frame (m, and angles as they were written).
    pub placement: Placement,
}

/// Reads the `<pose>` of an element (SDFormat 1.3 to 1.12): three lengths (m), and roll, pitch and yaw (radians, or degrees where
/// it says so) or a quaternion `x y z w`. Where it has none, or a fault where it cannot be read, nothing is moved.
pub fn pose(node: Node<'_, '_>, faults: &mut Faults<'_>) -> Pose {
    let Some(pose) = xml::child(node, "pose") else {
        return Pose { frame: None, placement: Placement::IDENTITY };
    };
    // Versions before 1.7 say `frame`.
    let frame = ["relative_to", "frame"].iter().find_map(|name| pose.attribute(*name));
    let frame = frame.filter(|name| !name.is_empty()).map(str::to_owned);
    Pose { frame, placement: placement(pose, faults).unwrap_or(Placement::IDENTITY) }
}

/// Returns the `<pose>` elements of a document that turn by more than once around: written in degrees, as it seems, where
/// radians are read.
pub fn overturned<'a, 'i>(root: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    root.descendants().filter(|node| {
        node.has_tag_name("pose")
            && node.attribute("degrees").is_none()
            && node.attribute("rotation_format").is_none()
            && xml::text(*node)
                .split_ascii_whitespace()
                .skip(3)
                .filter_map(|word| word.parse().ok())
                .any(is_overturn)
    })
}

/// Returns whether an angle (radians) is more than once around.
pub fn is_overturn(angle: f64) -> bool {
    angle.abs() > std::f64::consts::TAU + 1e-3
}

/// Returns the placement that a `<pose>` says; `None` with a fault where it is malformed.
fn placement(pose: Node<'_, '_>, faults: &mut Faults<'_>) -> Option<Placement> {
    let format = pose.attribute("rotation_format").unwrap_or("euler_rpy");
    if xml::text(pose).is_empty() {
        return Some(Placement::IDENTITY);
    }
    match format {
        "euler_rpy" => {
            let degrees =
                pose.attribute("degrees").is_some_and(|v| matches!(v.trim(), "true" | "1"));
            let [x, y, z, angles @ ..] = faults.numbers::<6>(pose)?;
            let [roll, pitch, yaw] = if degrees { angles.map(f64::to_radians) } else { angles };
            Some(Placement::from_xyz_rpy([x, y, z, roll, pitch, yaw]))
        }
        "quat_xyzw" => {
            let [x, y, z, quaternion @ ..] = faults.numbers::<7>(pose)?;
            if quaternion.iter().all(|part| part.abs() < 1e-9) {
                let fault = faults.at(pose, "a quaternion of zeros is no rotation");
                faults.push(fault);
                return None;
            }
            Some(Placement::from_xyz_quaternion([x, y, z], quaternion))
        }
        other => {
            let fault = faults.at(pose, format!("unknown rotation format `{}`", quoted(other)));
            faults.push(fault.label("expected euler_rpy or quat_xyzw"));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Source;
    use std::f64::consts::FRAC_PI_2;

    fn read(attributes: &str, numbers: &str) -> (Pose, Vec<String>) {
        let text = format!("<link><pose {attributes}>{numbers}</pose></link>");
        let source = Source::new("a.sdf", text);
        let document = xml::parse(&source, 1000).unwrap();
        let mut faults = Faults::new(&source);
        let pose = pose(document.root_element(), &mut faults);
        (pose, faults.finish().into_iter().map(|fault| fault.message).collect())
    }

    #[test]
    fn radians_degrees_and_quaternions_are_the_same_turn() {
        let expected = Placement::from_xyz_rpy([1.0, 2.0, 3.0, 0.0, 0.0, FRAC_PI_2]);
        for (attributes, numbers) in [
            ("relative_to='a'", "1 2 3 0 0 1.5707963267948966"),
            ("frame='a' degrees='1'", "1 2 3 0 0 90"),
            ("relative_to='a' degrees='true'", "1 2 3 0 0 90"),
            ("relative_to='a' rotation_format='quat_xyzw'", "1 2 3 0 0 0.5 0.5"),
        ] {
            let (pose, faults) = read(attributes, numbers);
            assert_eq!((faults.len(), pose.frame.as_deref()), (0, Some("a")), "{attributes}");
            let found = pose.placement;
            assert_eq!(found.translation, expected.translation);
            let off = found.rotation.as_flattened().iter().zip(expected.rotation.as_flattened());
            assert!(off.clone().all(|(a, b)| (a - b).abs() < 1e-12), "{attributes}: {found:?}");
        }
        let (none, faults) = read("relative_to=''", " ");
        assert_eq!((none.frame, none.placement, faults.len()), (None, Placement::IDENTITY, 0));
    }

    #[test]
    fn only_angles_in_radians_turn_by_more_than_once_around() {
        let source = Source::new(
            "a.sdf",
            "<m><pose>0 0 0 0 0 90</pose><pose degrees='1'>0 0 0 0 0 90</pose><pose>400 0 0 0 0 6.28319</pose></m>",
        );
        let document = xml::parse(&source, 1000).unwrap();
        let found: Vec<&str> = overturned(document.root_element()).map(xml::text).collect();
        assert_eq!(found, ["0 0 0 0 0 90"]);
    }

    #[test]
    fn what_is_no_pose_is_told_and_moves_nothing() {
        for (attributes, numbers, said) in [
            (
                "rotation_format='quat_xyzw'",
                "1 2 3 0 0 0 0",
                "a quaternion of zeros is no rotation",
            ),
            ("rotation_format='axis'", "1 2 3 0 0 1", "unknown rotation format `axis`"),
        ] {
            let (pose, faults) = read(attributes, numbers);
            assert_eq!((pose.placement, faults), (Placement::IDENTITY, vec![said.to_owned()]));
        }
        assert_eq!(read("", "1 2 3").1.len(), 1);
    }
}
