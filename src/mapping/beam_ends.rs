//! The ends of a scan's beams.

use crate::geometry::{Point, Pose};
use crate::robot::{BeamDirections, Scan};

/// The beams of one scan that carry information, cut to the usable range.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BeamEnds {
    /// Where the sensor sits on the robot (m, rad).
    pub(super) mount: Pose,
    /// Where beams end in the sensor's frame (m), and whether something was hit there: not where the beam was cut.
    pub(super) ends: Vec<(Point, bool)>,
}

impl BeamEnds {
    /// Returns the beams of `scan`, cut to `clip_range` m. Beams without a return are left out: they carry no
    /// information (prior-map facts, section 4).
    pub(super) fn of(scan: &Scan, clip_range: f64, directions: &mut BeamDirections) -> Self {
        let end = |(direction, &range): (&Point, &f64)| {
            let local = *direction * range.min(clip_range);
            range.is_finite().then_some((local, range < clip_range))
        };
        let beams = directions.of(scan).iter().zip(&scan.ranges);
        Self { mount: scan.mount, ends: beams.filter_map(end).collect() }
    }

    /// Returns the points where something was hit, in the robot's frame (m), every `every`th of them.
    pub(super) fn hits(&self, every: usize) -> impl Iterator<Item = Point> {
        let hits = self.ends.iter().filter(|(_, is_hit)| *is_hit).step_by(every.max(1));
        hits.map(|(end, _)| self.mount.transform(*end))
    }
}
