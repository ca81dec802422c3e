//! The wheels by their joints, for drives that do not say how far apart and how large they are.

use super::parts::{Geometry, Joint, Parts};
use super::shape::ShapeKind;

/// How far aside (m) a wheel is at least.
const ASIDE: f64 = 0.01;

/// What the joints of the wheels say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Wheels {
    /// Distance between left and right wheels (m).
    pub(super) separation: Option<f64>,
    /// Wheel diameter (m).
    pub(super) diameter: Option<f64>,
    /// Whether there are several wheels on a side.
    pub(super) many: bool,
}

/// Returns what the joints say that `left` and `right` name; where those name none, the turning joints of wheels that lie
/// aside.
pub(super) fn read(parts: &Parts<'_, '_>, left: &[&str], right: &[&str]) -> Wheels {
    let named = |names: &[&str]| -> Vec<&Joint> {
        let joints = parts.joints.iter();
        joints.filter(|joint| names.contains(&joint.name.as_str())).collect()
    };
    let (mut lefts, mut rights) = (named(left), named(right));
    if lefts.is_empty() || rights.is_empty() {
        let is_wheel = |joint: &&Joint| {
            let name = format!("{} {}", joint.name, joint.child).to_lowercase();
            let no_wheel = ["caster", "castor", "swivel", "steer"];
            joint.turns
                && name.contains("wheel")
                && !no_wheel.iter().any(|word| name.contains(word))
        };
        let wheels: Vec<&Joint> = parts.joints.iter().filter(is_wheel).collect();
        let aside = |joint: &&Joint| joint.placement.translation[1];
        lefts = wheels.iter().copied().filter(|joint| aside(joint) > ASIDE).collect();
        rights = wheels.iter().copied().filter(|joint| aside(joint) < -ASIDE).collect();
    }
    #[expect(clippy::cast_precision_loss, reason = "a handful of wheels")]
    let middle = |joints: &[&Joint]| {
        let sum: f64 = joints.iter().map(|joint| joint.placement.translation[1]).sum();
        (!joints.is_empty()).then(|| sum / joints.len() as f64)
    };
    let separation = middle(&lefts).zip(middle(&rights)).map(|(left, right)| rounded(left - right));
    let diameter = lefts.iter().chain(&rights).find_map(|joint| {
        parts.collisions.iter().filter(|collision| collision.link == joint.child).find_map(
            |collision| match &collision.geometry {
                Geometry::Simple(
                    ShapeKind::Cylinder { radius, .. } | ShapeKind::Sphere { radius },
                ) => Some(rounded(2.0 * radius)),
                _ => None,
            },
        )
    });
    Wheels {
        separation: separation.filter(|separation| *separation > 2.0 * ASIDE),
        diameter,
        many: lefts.len() > 1 && rights.len() > 1,
    }
}

/// Returns a length to a hundredth of a millimetre: what is computed from joints is no rounder than it was written.
fn rounded(length: f64) -> f64 {
    (length * 1e5).round() / 1e5
}
