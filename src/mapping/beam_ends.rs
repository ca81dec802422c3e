//! The ends of a scan's beams.

use super::{NoReturn, ScanRule};
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
    /// Returns the beams of `scan` as `rule` cuts them and reads those without a return.
    pub(super) fn of(scan: &Scan, rule: ScanRule, directions: &mut BeamDirections) -> Self {
        let end = |(direction, &range): (&Point, &f64)| {
            if range.is_finite() {
                let local = *direction * range.min(rule.clip_range);
                return Some((local, range < rule.clip_range));
            }
            // Only infinity means "nothing within reach"; REP 117 has other values for what is nearer than the sensor sees.
            let is_free = range == f64::INFINITY && rule.no_return == NoReturn::Free;
            is_free.then(|| (*direction * scan.max_range.min(rule.clip_range), false))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Tick;

    #[test]
    fn a_beam_without_return_frees_floor_up_to_the_range_or_tells_nothing() {
        let scan = Scan {
            stamp: Tick(0),
            mount: Pose::default(),
            min_angle: 0.0,
            increment: 0.1,
            min_range: 0.1,
            max_range: 3.5,
            // REP 117: nothing within reach, something too near, no measurement, a wall.
            ranges: vec![f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 2.0],
        };
        let ends = |clip_range: f64, no_return: NoReturn| {
            let rule = ScanRule { resolution: 0.1, clip_range, hit_ratio: 0.25, no_return };
            let beams = BeamEnds::of(&scan, rule, &mut BeamDirections::default());
            let ends = beams.ends.into_iter();
            ends.map(|(end, is_hit)| ((end.norm() * 1e6).round() / 1e6, is_hit)).collect::<Vec<_>>()
        };
        assert_eq!(ends(f64::INFINITY, NoReturn::Free), [(3.5, false), (2.0, true)]);
        assert_eq!(ends(3.0, NoReturn::Free), [(3.0, false), (2.0, true)]);
        assert_eq!(ends(1.5, NoReturn::Free), [(1.5, false), (1.5, false)]);
        assert_eq!(ends(3.0, NoReturn::Nothing), [(2.0, true)]);
    }
}
