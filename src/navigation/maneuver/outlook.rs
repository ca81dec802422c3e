//! A scan as points, in the base frame and in the leg's.

use crate::geometry::Point;
use crate::math;
use crate::robot::Scan;

/// The ends of a scan's beams, from right to left.
#[derive(Debug, Clone, Default)]
pub(super) struct Outlook {
    /// Unit directions of the beams in the base frame, and the scan they belong to.
    directions: Vec<Point>,
    shape: Option<(f64, f64, f64)>,
    /// Position of the sensor (m).
    pub(super) sensor: Point,
    /// Where the beams end (m): at the longest range where they hit nothing.
    pub(super) ends: Vec<Point>,
    /// Whether they hit something.
    pub(super) hits: Vec<bool>,
}

impl Outlook {
    /// Converts a scan to points in the base frame.
    pub(super) fn read(&mut self, scan: &Scan) {
        let shape = (scan.min_angle + scan.mount.heading, scan.increment, scan.max_range);
        if self.shape != Some(shape) || self.directions.len() != scan.ranges.len() {
            self.shape = Some(shape);
            self.directions.clear();
            self.directions.extend((0..scan.ranges.len()).map(|i| {
                let (sin, cos) = math::sin_cos(scan.mount.heading + scan.angle(i));
                Point::new(cos, sin)
            }));
        }
        self.sensor = scan.mount.position();
        self.ends.clear();
        self.hits.clear();
        for (direction, &range) in self.directions.iter().zip(&scan.ranges) {
            let hit = range.is_finite();
            let reach = if hit { range } else { scan.max_range };
            self.ends.push(self.sensor + *direction * reach);
            self.hits.push(hit);
        }
    }

    /// Takes the points of `other`, turned by `angle` rad about the base.
    pub(super) fn turn(&mut self, other: &Self, angle: f64) {
        let (sin, cos) = math::sin_cos(angle);
        let turned = |p: Point| Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
        self.sensor = turned(other.sensor);
        self.ends.clear();
        self.ends.extend(other.ends.iter().map(|&end| turned(end)));
        self.hits.clone_from(&other.hits);
    }

    /// Returns the points that were hit.
    pub(super) fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.ends.iter().zip(&self.hits).filter_map(|(end, hit)| hit.then_some(*end))
    }
}
