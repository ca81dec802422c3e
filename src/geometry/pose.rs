//! Rigid transforms of the plane.

use super::Point;
use crate::math;
use serde::{Deserialize, Serialize};

/// A position (m) and heading (rad, counter-clockwise from x), or the transform that takes a frame there.
///
/// ```
/// use reenact::geometry::{Point, Pose};
/// use std::f64::consts::FRAC_PI_2;
///
/// let robot = Pose::new(2.0, 1.0, FRAC_PI_2);
/// let ahead = robot.transform(Point::new(3.0, 0.0));
/// assert!(ahead.distance(Point::new(2.0, 4.0)) < 1e-12);
/// assert_eq!(robot.relative(robot), Pose::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Pose {
    /// Position x (m).
    pub x: f64,
    /// Position y (m).
    pub y: f64,
    /// Heading (rad), in (-π, π].
    pub heading: f64,
}

impl Pose {
    /// Returns the pose at (`x`, `y`) m with `heading` rad, wrapped into (-π, π].
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { x, y, heading: math::wrap_angle(heading) }
    }

    /// Returns the position.
    pub fn position(self) -> Point {
        Point::new(self.x, self.y)
    }

    /// Transforms `point` from this pose's frame to the frame in which the pose is given.
    pub fn transform(self, point: Point) -> Point {
        let (sin, cos) = math::sin_cos(self.heading);
        Point::new(self.x + cos * point.x - sin * point.y, self.y + sin * point.x + cos * point.y)
    }

    /// Transforms `point` from the outer frame into this pose's frame.
    pub fn inverse_transform(self, point: Point) -> Point {
        let (sin, cos) = math::sin_cos(self.heading);
        let (dx, dy) = (point.x - self.x, point.y - self.y);
        Point::new(cos * dx + sin * dy, cos * dy - sin * dx)
    }

    /// Returns the pose `other`, given in this pose's frame, in the outer frame.
    #[must_use]
    pub fn compose(self, other: Self) -> Self {
        let position = self.transform(other.position());
        Self::new(position.x, position.y, self.heading + other.heading)
    }

    /// Returns the pose `other`, given in the outer frame, relative to this pose.
    #[must_use]
    pub fn relative(self, other: Self) -> Self {
        let position = self.inverse_transform(other.position());
        Self::new(position.x, position.y, other.heading - self.heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-100.0..100.0, -100.0..100.0, -10.0..10.0).prop_map(|(x, y, h)| Pose::new(x, y, h))
    }

    proptest! {
        #[test]
        fn relative_undoes_compose(a in pose(), b in pose()) {
            let back = a.relative(a.compose(b));
            prop_assert!(back.position().distance(b.position()) < 1e-9);
            prop_assert!(math::wrap_angle(back.heading - b.heading).abs() < 1e-9);
        }

        #[test]
        fn transforms_keep_distances(a in pose(), x in -50.0..50.0, y in -50.0..50.0) {
            let p = Point::new(x, y);
            prop_assert!((a.transform(p).distance(a.position()) - p.norm()).abs() < 1e-9);
            prop_assert!(a.inverse_transform(a.transform(p)).distance(p) < 1e-9);
        }
    }
}
