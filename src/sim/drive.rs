//! From commanded to executed velocity: limits of the drive and errors of the actuators.

use super::Distribution;
use crate::rng::{Seeds, Stream};
use crate::robot::{self, Twist};
use crate::units::{Seconds, Tick};

/// Errors of the executed velocity, each a share of the command that holds for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveNoise {
    /// How the two errors are distributed.
    pub distribution: Distribution,
    /// Size of the error of linear speed, as a share of the command: a standard deviation or a bound, by
    /// the distribution.
    pub linear: f64,
    /// Size of the error of angular speed, as a share of the command.
    pub angular: f64,
    /// How long one error lasts. A time, so that it does not depend on the control rate.
    pub correlation: Seconds,
}

impl DriveNoise {
    /// A drive that executes commands exactly.
    pub const NONE: Self = Self {
        distribution: Distribution::Gaussian,
        linear: 0.0,
        angular: 0.0,
        correlation: Seconds(1.0),
    };
}

#[derive(Debug)]
pub(super) struct Drive {
    noise: DriveNoise,
    hold: Tick,
    max_linear: f64,
    max_angular: f64,
    stream: Stream,
    command: Twist,
    /// Number of the current error and its two factors.
    current: (u64, f64, f64),
}

impl Drive {
    pub(super) fn new(noise: DriveNoise, limits: &robot::Drive, seeds: &Seeds) -> Self {
        let mut drive = Self {
            noise,
            hold: Tick(Tick::at_or_after(noise.correlation).0.max(1)),
            max_linear: limits.max_linear.unwrap_or(f64::INFINITY),
            max_angular: limits.max_angular.unwrap_or(f64::INFINITY),
            stream: seeds.stream("drive-noise"),
            command: Twist::STOP,
            current: (0, 1.0, 1.0),
        };
        drive.draw(0);
        drive
    }

    pub(super) fn command(&mut self, twist: Twist) {
        self.command = Twist {
            linear: twist.linear.clamp(-self.max_linear, self.max_linear),
            angular: twist.angular.clamp(-self.max_angular, self.max_angular),
        };
    }

    /// Returns the velocity executed at `now`.
    pub(super) fn executed(&mut self, now: Tick) -> Twist {
        let number = now.0 / self.hold.0;
        if number != self.current.0 {
            self.draw(number);
        }
        let (_, linear, angular) = self.current;
        // Errors do not make the motors stronger.
        Twist {
            linear: (self.command.linear * linear).clamp(-self.max_linear, self.max_linear),
            angular: (self.command.angular * angular).clamp(-self.max_angular, self.max_angular),
        }
    }

    fn draw(&mut self, number: u64) {
        let (linear, angular) = self.noise.distribution.pair(self.stream.at(number));
        self.current =
            (number, 1.0 + self.noise.linear * linear, 1.0 + self.noise.angular * angular);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::DriveKind;

    fn limits() -> robot::Drive {
        robot::Drive {
            kind: DriveKind::Differential,
            wheel_separation: 0.2,
            wheel_diameter: 0.07,
            max_linear: Some(0.5),
            max_angular: None,
        }
    }

    #[test]
    fn limits_hold_and_errors_last_their_time() {
        let noise = DriveNoise {
            distribution: Distribution::Gaussian,
            linear: 0.25,
            angular: 0.25,
            correlation: Seconds(0.5),
        };
        let seeds = Seeds::new(1, vec![]);
        let mut drive = Drive::new(noise, &limits(), &seeds);
        drive.command(Twist { linear: 0.2, angular: 1.0 });
        let at = |drive: &mut Drive, s: f64| drive.executed(Tick::at_or_after(Seconds(s))).linear;
        assert_eq!(at(&mut drive, 0.0), at(&mut drive, 0.49));
        assert_ne!(at(&mut drive, 0.49), at(&mut drive, 0.5));
        let first = at(&mut drive, 0.0);
        let mut again = Drive::new(noise, &limits(), &seeds);
        again.command(Twist { linear: 0.2, angular: 1.0 });
        assert_eq!(first, at(&mut again, 0.0), "the same errors for the same seeds");

        again.command(Twist { linear: 2.0, angular: 1.0 });
        let fastest = (0..100).map(|i| at(&mut again, f64::from(i))).fold(0.0, f64::max);
        assert_eq!(fastest, 0.5, "errors included");

        let mut exact = Drive::new(DriveNoise::NONE, &limits(), &seeds);
        exact.command(Twist { linear: 2.0, angular: -3.0 });
        assert_eq!(exact.executed(Tick(77)), Twist { linear: 0.5, angular: -3.0 });
    }

    #[test]
    fn uniform_errors_stay_within_their_bound_and_fill_it() {
        let noise = DriveNoise {
            distribution: Distribution::Uniform,
            linear: 0.25,
            angular: 0.1,
            correlation: Seconds(0.1),
        };
        let mut drive = Drive::new(noise, &limits(), &Seeds::new(3, vec![]));
        drive.command(Twist { linear: 0.4, angular: 2.0 });
        let twists: Vec<_> = (0..2000).map(|i| drive.executed(Tick(300 * i))).collect();
        let range = |of: fn(&Twist) -> f64| {
            let values = twists.iter().map(of);
            (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max))
        };
        let (low, high) = range(|twist| twist.linear);
        assert!((0.3..0.301).contains(&low) && (0.499..=0.5).contains(&high), "{low} {high}");
        let (low, high) = range(|twist| twist.angular);
        assert!((1.8..1.802).contains(&low) && (2.198..=2.2).contains(&high), "{low} {high}");
    }
}
