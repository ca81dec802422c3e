//! The compass: the true heading with an error.

use super::Distribution;
use crate::math;
use crate::rng::{Seeds, Stream};
use crate::robot::CompassReading;
use crate::units::{Seconds, Tick};

/// The error of readings, independent of the heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompassNoise {
    /// How it is distributed.
    pub distribution: Distribution,
    /// Its size (rad): a standard deviation or a bound, by its distribution.
    pub heading: f64,
    /// How long one error lasts; if no longer than the time between readings, the error is white. A time, so that it
    /// does not depend on any rate.
    pub correlation: Seconds,
}

impl CompassNoise {
    /// A compass without error.
    pub const NONE: Self =
        Self { distribution: Distribution::Gaussian, heading: 0.0, correlation: Seconds(1.0) };
}

#[derive(Debug)]
pub(super) struct Compass {
    noise: CompassNoise,
    hold: Tick,
    stream: Stream,
}

impl Compass {
    pub(super) fn new(noise: CompassNoise, seeds: &Seeds) -> Self {
        let hold = Tick(Tick::at_or_after(noise.correlation).0.max(1));
        Self { noise, hold, stream: seeds.stream("compass-noise") }
    }

    /// Returns the reading taken at `stamp` at the true `heading` (rad).
    pub(super) fn reading(&mut self, stamp: Tick, heading: f64) -> CompassReading {
        let error = if self.noise.heading > 0.0 {
            let number = stamp.0 / self.hold.0;
            self.noise.heading * self.noise.distribution.pair(self.stream.at(number)).0
        } else {
            0.0
        };
        CompassReading { stamp, heading: math::wrap_angle(heading + error) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compass(heading: f64, correlation: f64) -> Compass {
        let correlation = Seconds(correlation);
        let noise = CompassNoise { distribution: Distribution::Uniform, heading, correlation };
        Compass::new(noise, &Seeds::new(1, vec![]))
    }

    #[test]
    fn errors_are_bounded_unbiased_and_those_of_the_reading_s_time() {
        let bound = 9.0_f64.to_radians();
        let mut compass = compass(bound, 0.1);
        let read =
            |compass: &mut Compass, n: u64| compass.reading(Tick(300 * n), 1.0).heading - 1.0;
        let errors: Vec<f64> = (0..4000).map(|n| read(&mut compass, n)).collect();
        assert!(errors.iter().all(|error| error.abs() <= bound));
        assert!(errors.iter().any(|error| error.abs() > 0.99 * bound));
        let mean = errors.iter().sum::<f64>() / 4000.0;
        // Five standard errors of the mean of a uniform distribution.
        assert!(mean.abs() < 5.0 * bound / 3.0_f64.sqrt() / 4000.0_f64.sqrt(), "{mean}");
        assert_eq!(read(&mut compass, 7), errors[7], "whatever was read before");
        let mut right = Compass::new(CompassNoise::NONE, &Seeds::new(1, vec![]));
        assert_eq!(right.reading(Tick(900), -2.0).heading, -2.0);
    }

    #[test]
    fn errors_last_their_time() {
        let mut compass = compass(0.2, 12.0);
        let mut at = |s: f64| compass.reading(Tick::at_or_after(Seconds(s)), 0.0).heading;
        assert_eq!(at(0.1), at(11.9));
        assert_ne!(at(11.9), at(12.0));
    }

    #[test]
    fn a_reading_near_west_wraps() {
        let mut compass = compass(0.2, 0.1);
        let west = std::f64::consts::PI;
        let readings: Vec<f64> =
            (0..100).map(|n| compass.reading(Tick(300 * n), west).heading).collect();
        assert!(readings.iter().all(|heading| heading.abs() > west - 0.2 && heading.abs() <= west));
        assert!(readings.iter().any(|heading| *heading < 0.0));
    }
}
