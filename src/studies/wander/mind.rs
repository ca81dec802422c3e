//! The wandering mind. It sees scans and answers with velocities; it never sees the world.

use super::Driving;
use crate::rng::Stream;
use crate::robot::{Scan, Twist};
use crate::units::{Seconds, Tick};
use std::f64::consts::{FRAC_PI_2, PI};

/// Beams within this angle of straight ahead decide whether the robot is blocked (rad): 35 degrees.
const AHEAD: f64 = 0.61;

/// Drives ahead until it is blocked, then turns.
#[derive(Debug)]
pub(super) struct Mind {
    driving: Driving,
    turns: Stream,
    /// The turn under way: its twist, and when it ends.
    turning: Option<(Twist, Tick)>,
    pub(super) blocked: u32,
}

impl Mind {
    /// Creates a mind that draws its turns from the stream `turns`.
    pub(super) fn new(driving: Driving, turns: Stream) -> Self {
        Self { driving, turns, turning: None, blocked: 0 }
    }

    /// Returns the command after `scan`.
    pub(super) fn steer(&mut self, scan: &Scan) -> Twist {
        if let Some((twist, until)) = self.turning
            && scan.stamp < until
        {
            return twist;
        }
        self.turning = None;
        if self.is_free(scan) {
            return Twist { linear: self.driving.linear_m_s, angular: 0.0 };
        }
        self.blocked += 1;
        let (angle, speed) = (self.turns.between(FRAC_PI_2, 1.5 * PI), self.driving.angular_rad_s);
        let twist = Twist { linear: 0.0, angular: speed };
        self.turning = Some((twist, scan.stamp + Tick::at_or_after(Seconds(angle / speed))));
        twist
    }

    fn is_free(&self, scan: &Scan) -> bool {
        let ahead = |i: &usize| (scan.mount.heading + scan.angle(*i)).abs() < AHEAD;
        let mut ranges = (0..scan.ranges.len()).filter(ahead).map(|i| scan.ranges[i]);
        ranges.all(|range| range > self.driving.clearance_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    fn scan(at_s: f64, ahead: f64) -> Scan {
        Scan {
            stamp: Tick::at_or_after(Seconds(at_s)),
            mount: crate::geometry::Pose::default(),
            min_angle: -FRAC_PI_2,
            increment: FRAC_PI_2,
            min_range: 0.1,
            max_range: 5.0,
            ranges: vec![0.2, ahead, f64::INFINITY],
        }
    }

    #[test]
    fn it_drives_where_the_way_is_free_and_turns_at_least_a_quarter_where_not() {
        let mut mind = Mind::new(Driving::default(), Seeds::new(1, Vec::new()).stream("turns"));
        let ahead = Twist { linear: 0.4, angular: 0.0 };
        assert_eq!(mind.steer(&scan(0.0, 2.0)), ahead, "what is beside it does not block");
        assert_eq!(mind.steer(&scan(1.0, 0.5)).linear, 0.0);
        assert_eq!(mind.steer(&scan(2.5, 2.0)).angular, 1.0, "a quarter turn takes 1.57 s");
        assert_eq!(mind.steer(&scan(1.0 + 4.8, 2.0)), ahead, "three quarters take 4.71 s");
        assert_eq!(mind.blocked, 1);
    }
}
