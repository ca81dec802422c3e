//! Which scans are taken into the map: the first one, then one each time the robot has moved or turned enough
//! (GMapping's `linearUpdate` and `angularUpdate`).

use crate::geometry::Pose;
use crate::math;

/// When a scan is taken into the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyframeRule {
    /// After this much accumulated travel (m).
    pub distance: f64,
    /// ... or this much accumulated turning (rad).
    pub turn: f64,
}

/// The odometry since the last scan that was taken in.
#[derive(Debug)]
pub(super) struct Keyframes {
    rule: KeyframeRule,
    last: Option<Pose>,
    travelled: f64,
    turned: f64,
}

impl Keyframes {
    /// Creates the state before the first scan.
    pub(super) fn new(rule: KeyframeRule) -> Self {
        Self { rule, last: None, travelled: 0.0, turned: 0.0 }
    }

    /// Returns the last odometry pose seen.
    pub(super) fn last(&self) -> Option<Pose> {
        self.last
    }

    /// Returns whether a scan taken at `pose` (odometry) is to be taken into the map.
    pub(super) fn wants(&mut self, pose: Pose) -> bool {
        let Some(last) = self.last.replace(pose) else { return true };
        self.travelled += last.position().distance(pose.position());
        self.turned += math::wrap_angle(pose.heading - last.heading).abs();
        self.travelled >= self.rule.distance || self.turned >= self.rule.turn
    }

    /// Records that a scan was taken in at `pose` (odometry).
    pub(super) fn taken(&mut self, pose: Pose) {
        self.last = Some(pose);
        (self.travelled, self.turned) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wants_the_first_scan_and_then_one_per_metre_or_half_radian() {
        let mut keyframes = Keyframes::new(KeyframeRule { distance: 1.0, turn: 0.5 });
        let mut offer = |pose: Pose| {
            let wanted = keyframes.wants(pose);
            if wanted {
                keyframes.taken(pose);
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
