//! The compass: the true heading with an error.

use super::Distribution;
use crate::math;
use crate::rng::{Seeds, Stream};
use crate::robot::CompassReading;
use crate::units::Tick;

/// The error of a reading, independent of all others and of the heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompassNoise {
    /// How it is distributed.
    pub distribution: Distribution,
    /// Its size (rad): a standard deviation or a bound, as the distribution says.
    pub heading: f64,
}

impl CompassNoise {
    /// A compass that is right.
    pub const NONE: Self = Self { distribution: Distribution::Gaussian, heading: 0.0 };
}

#[derive(Debug)]
pub(super) struct Compass {
    noise: CompassNoise,
    stream: Stream,
}

impl Compass {
    pub(super) fn new(noise: CompassNoise, seeds: &Seeds) -> Self {
        Self { noise, stream: seeds.stream("compass-noise") }
    }

    /// Reading `number`, taken at `stamp` at the true `heading` (rad).
    pub(super) fn reading(&mut self, number: u64, stamp: Tick, heading: f64) -> CompassReading {
        let error = if self.noise.heading > 0.0 {
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

    #[test]
    fn errors_are_bounded_unbiased_and_those_of_the_reading_s_number() {
        let bound = 9.0_f64.to_radians();
        let noise = CompassNoise { distribution: Distribution::Uniform, heading: bound };
        let mut compass = Compass::new(noise, &Seeds::new(1, vec![]));
        let read = |compass: &mut Compass, n| compass.reading(n, Tick(300 * n), 1.0).heading - 1.0;
        let errors: Vec<f64> = (0..4000).map(|n| read(&mut compass, n)).collect();
        assert!(errors.iter().all(|error| error.abs() <= bound));
        assert!(errors.iter().any(|error| error.abs() > 0.99 * bound));
        let mean = errors.iter().sum::<f64>() / 4000.0;
        // Five standard errors of the mean of a uniform distribution.
        assert!(mean.abs() < 5.0 * bound / 3.0_f64.sqrt() / 4000.0_f64.sqrt(), "{mean}");
        assert_eq!(read(&mut compass, 7), errors[7], "whatever was read before");
        assert_eq!(
            Compass::new(CompassNoise::NONE, &Seeds::new(1, vec![]))
                .reading(3, Tick(900), -2.0)
                .heading,
            -2.0
        );
    }

    #[test]
    fn a_reading_near_west_wraps() {
        let noise = CompassNoise { distribution: Distribution::Uniform, heading: 0.2 };
        let mut compass = Compass::new(noise, &Seeds::new(1, vec![]));
        let west = std::f64::consts::PI;
        let readings: Vec<f64> =
            (0..100).map(|n| compass.reading(n, Tick(0), west).heading).collect();
        assert!(readings.iter().all(|heading| heading.abs() > west - 0.2 && heading.abs() <= west));
        assert!(readings.iter().any(|heading| *heading < 0.0));
    }
}
