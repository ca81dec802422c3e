//! Which scans are taken into the map: one at the start, then one each time the robot has moved or turned
//! enough (GMapping's `linearUpdate` and `angularUpdate`).

use super::{Change, OccupancyMap, ScanRule};
use crate::geometry::Pose;
use crate::math;
use crate::robot::Scan;

/// When a scan is taken into the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyframeRule {
    /// After this much accumulated travel (m).
    pub distance: f64,
    /// ... or this much accumulated turning (rad).
    pub turn: f64,
}

/// A mapper with trusted odometry: `particles: 1`, no motion noise, no matching.
#[derive(Debug)]
pub struct KeyframeMapper {
    rule: KeyframeRule,
    map: OccupancyMap,
    last: Option<Pose>,
    travelled: f64,
    turned: f64,
}

impl KeyframeMapper {
    /// A mapper that has seen nothing.
    pub fn new(rule: KeyframeRule, scan_rule: ScanRule) -> Self {
        let map = OccupancyMap::new(scan_rule);
        Self { rule, map, last: None, travelled: 0.0, turned: 0.0 }
    }

    /// The map so far.
    pub fn map(&self) -> &OccupancyMap {
        &self.map
    }

    /// Whether a scan taken at `pose` (odometry) is to be taken into the map.
    pub fn wants(&mut self, pose: Pose) -> bool {
        let Some(last) = self.last.replace(pose) else { return true };
        self.travelled += last.position().distance(pose.position());
        self.turned += math::wrap_angle(pose.heading - last.heading).abs();
        self.travelled >= self.rule.distance || self.turned >= self.rule.turn
    }

    /// Takes `scan`, taken at `pose`, into the map and tells the cells that changed.
    pub fn integrate(&mut self, pose: Pose, scan: &Scan) -> &[Change] {
        self.last = Some(pose);
        (self.travelled, self.turned) = (0.0, 0.0);
        self.map.integrate(pose, scan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Tick;

    #[test]
    fn wants_the_first_scan_and_then_one_per_metre_or_half_radian() {
        let scan_rule = ScanRule { resolution: 0.1, clip_range: 5.0, hit_ratio: 0.05 };
        let mut mapper = KeyframeMapper::new(KeyframeRule { distance: 1.0, turn: 0.5 }, scan_rule);
        let scan = Scan {
            stamp: Tick(0),
            mount: Pose::default(),
            min_angle: 0.0,
            increment: 0.1,
            min_range: 0.0,
            max_range: 5.0,
            ranges: vec![],
        };
        let mut offer = |pose: Pose| {
            let wanted = mapper.wants(pose);
            if wanted {
                mapper.integrate(pose, &scan);
            }
            wanted
        };
        assert!(offer(Pose::default()));
        assert!(!offer(Pose::new(0.6, 0.0, 0.0)));
        assert!(offer(Pose::new(0.0, 0.0, 0.0)), "travel is accumulated, not net");
        assert!(!offer(Pose::new(0.0, 0.0, 0.4)));
        assert!(offer(Pose::new(0.0, 0.0, 0.55)));
    }
}
