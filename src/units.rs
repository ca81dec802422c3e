//! Physical units where numbers would be taken for one another: times, angles, and the one clock.
//!
//! REP-103 throughout: metres, seconds, radians; x forward, y left, angles counter-clockwise.
//! Everything else is a plain `f64` in SI units, with the unit in its name or its doc.

use serde::{Deserialize, Serialize};

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// Returns the bare number, in the unit after which the type is named.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, concat!("{} ", $symbol), self.0)
            }
        }
    };
}

unit!(
    /// A duration in seconds of simulated time.
    Seconds, "s"
);
unit!(
    /// An angle in radians, counter-clockwise.
    Radians, "rad"
);

impl Radians {
    /// Converts from degrees, as users write them (`heading-deg`).
    pub fn from_degrees(degrees: f64) -> Self {
        Self(degrees.to_radians())
    }

    /// Converts to degrees, as users read them.
    pub fn degrees(self) -> f64 {
        self.0.to_degrees()
    }
}

/// Ticks per second of the one simulation clock: the smallest rate that every common sensor and control
/// rate (5, 10, 12.5, 20, 24, 25, 30, 40, 50, 60, 100, 200 Hz) divides, so that schedules are integers.
pub const TICKS_PER_SECOND: u64 = 3000;

/// An instant (or a span) of simulated time, in ticks of 1/3000 s since the trial began.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Tick(pub u64);

impl Tick {
    /// Returns this instant in seconds.
    pub fn seconds(self) -> Seconds {
        #[expect(clippy::cast_precision_loss, reason = "2^53 ticks are 95 000 years")]
        Seconds(self.0 as f64 / TICKS_PER_SECOND as f64)
    }

    /// Returns the first instant not before `seconds` (≥ 0, finite).
    pub fn at_or_after(seconds: Seconds) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "durations are checked to be finite and non-negative when a manifest is resolved"
        )]
        Self((seconds.0 * TICKS_PER_SECOND as f64).ceil() as u64)
    }

    /// Returns the period of `rate_hz` in ticks, or `None` where the rate is not a positive divisor of the clock.
    pub fn period_of(rate_hz: f64) -> Option<Self> {
        #[expect(clippy::cast_precision_loss, reason = "3000 is exact")]
        let ticks = TICKS_PER_SECOND as f64 / rate_hz;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked to be an integer of at least one"
        )]
        (ticks.is_finite() && ticks >= 1.0 && ticks.fract() == 0.0).then_some(Self(ticks as u64))
    }
}

impl std::ops::Add for Tick {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_rates_are_whole_ticks_and_odd_ones_are_refused() {
        for (hz, ticks) in
            [(100.0, 30), (50.0, 60), (40.0, 75), (30.0, 100), (20.0, 150), (12.5, 240), (5.0, 600)]
        {
            assert_eq!(Tick::period_of(hz), Some(Tick(ticks)), "{hz} Hz");
        }
        for hz in [7.0, 0.0, -10.0, f64::NAN, f64::INFINITY, 6000.0] {
            assert_eq!(Tick::period_of(hz), None, "{hz} Hz");
        }
        assert_eq!(Tick::at_or_after(Seconds(3.2)), Tick(9600));
    }
}
