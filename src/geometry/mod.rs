//! Plane geometry in metres and radians: points, rigid transforms, segments, outlines.
//!
//! REP-103 axes: x forward (east in a world), y left (north), angles counter-clockwise.

mod cardinal;
mod outline;
mod placement;
mod point;
mod pose;
mod segment;

pub use cardinal::{Axis, Cardinal};
pub use outline::{Bounds, Outline, convex_hull};
pub use placement::Placement;
pub use point::Point;
pub use pose::Pose;
pub use segment::Segment;
