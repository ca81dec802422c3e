//! A room for tests: 6 x 4 m with a pillar, and the scans taken in it.

use super::{NoReturn, ScanRule};
use crate::geometry::{Point, Pose};
use crate::math;
use crate::robot::Scan;
use crate::units::Tick;
use std::f64::consts::PI;

/// Corners of the room and of the pillar, which is nearer to one corner so that no two views are alike.
const BOXES: [[f64; 4]; 2] = [[-3.0, -2.0, 3.0, 2.0], [1.6, 0.9, 2.0, 1.2]];

/// Returns the distance (m) from `from` to the first wall in direction `angle`.
fn cast(from: Point, angle: f64) -> f64 {
    let (sin, cos) = math::sin_cos(angle);
    let mut nearest = f64::INFINITY;
    for [x0, y0, x1, y1] in BOXES {
        for (wall, at, along, low, high) in [
            (x0, from.x, cos, y0, y1),
            (x1, from.x, cos, y0, y1),
            (y0, from.y, sin, x0, x1),
            (y1, from.y, sin, x0, x1),
        ] {
            let range = (wall - at) / along;
            let is_x = along == cos;
            let across = if is_x { from.y + range * sin } else { from.x + range * cos };
            if range > 0.0 && (low..=high).contains(&across) {
                nearest = nearest.min(range);
            }
        }
    }
    nearest
}

/// Returns a scan of 180 beams over half a circle, taken at `pose`, without noise.
pub(super) fn scan(pose: Pose) -> Scan {
    let increment = PI / 179.0;
    let mut scan = Scan {
        stamp: Tick(0),
        mount: Pose::new(0.1, 0.0, 0.0),
        min_angle: -PI / 2.0,
        increment,
        min_range: 0.01,
        max_range: 10.0,
        ranges: vec![0.0; 180],
    };
    let sensor = pose.compose(scan.mount);
    scan.ranges =
        (0..180).map(|i| cast(sensor.position(), sensor.heading + scan.angle(i))).collect();
    scan
}

/// Returns the ends of its beams, in the robot's frame (m).
pub(super) fn ends(pose: Pose) -> Vec<Point> {
    const RULE: ScanRule = ScanRule {
        resolution: 0.1,
        clip_range: 20.0,
        hit_ratio: 0.25,
        no_return: NoReturn::Nothing,
    };
    let directions = &mut crate::robot::BeamDirections::default();
    super::beam_ends::BeamEnds::of(&scan(pose), RULE, directions).hits(1).collect()
}
