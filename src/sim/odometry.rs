//! Wheel odometry: integrates how the body moved, with an error that grows with the distance travelled.

use crate::geometry::Pose;
use crate::math;
use crate::rng::{Seeds, Stream};
use crate::robot::{Odometry, Twist};
use crate::units::Tick;

/// How fast odometry drifts, as a random walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OdometryNoise {
    /// Standard deviation of the error of distance after one metre (m).
    pub distance: f64,
    /// Standard deviation of the error of heading after turning one radian (rad).
    pub heading: f64,
}

impl OdometryNoise {
    /// Odometry that never drifts, as the study's simulated robot had.
    pub const NONE: Self = Self { distance: 0.0, heading: 0.0 };
}

#[derive(Debug)]
pub(super) struct Odometer {
    noise: OdometryNoise,
    stream: Stream,
    pose: Pose,
    twist: Twist,
}

impl Odometer {
    pub(super) fn new(noise: OdometryNoise, seeds: &Seeds) -> Self {
        let stream = seeds.stream("odometry-noise");
        Self { noise, stream, pose: Pose::default(), twist: Twist::STOP }
    }

    /// Integrates that the body `moved` (in its own frame) during the physics step that ends `now`.
    pub(super) fn integrate(&mut self, moved: Pose, now: Tick) {
        let dt = super::PHYSICS_PERIOD.seconds().get();
        self.twist = Twist { linear: moved.x / dt, angular: moved.heading / dt };
        let mut measured = moved;
        if self.noise != OdometryNoise::NONE {
            let stream = self.stream.at(now.0);
            let (along, around) = (stream.normal(), stream.normal());
            let way = moved.position().norm();
            measured.x += self.noise.distance * way.sqrt() * along;
            let turn = self.noise.heading * moved.heading.abs().sqrt() * around;
            measured.heading = math::wrap_angle(measured.heading + turn);
        }
        self.pose = self.pose.compose(measured);
    }

    /// Returns the odometry reading stamped `stamp`.
    pub(super) fn reading(&self, stamp: Tick) -> Odometry {
        Odometry { stamp, pose: self.pose, twist: self.twist }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_noise_it_is_the_truth_and_with_noise_it_walks_off() {
        let drive = |noise: OdometryNoise| {
            let mut odometer = Odometer::new(noise, &Seeds::new(7, vec![]));
            for step in 1..=1000_u64 {
                odometer.integrate(Pose::new(0.01, 0.0, 0.002), Tick(step * 30));
            }
            odometer.reading(Tick(30_000)).pose
        };
        let mut truth = Pose::default();
        for _ in 0..1000 {
            truth = truth.compose(Pose::new(0.01, 0.0, 0.002));
        }
        assert_eq!(drive(OdometryNoise::NONE), truth);
        let drifted = drive(OdometryNoise { distance: 0.02, heading: 0.02 });
        let error = drifted.position().distance(truth.position());
        assert!(error > 1e-3 && error < 2.0, "{error}");
    }
}
