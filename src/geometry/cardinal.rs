//! The four directions along which the walls and corridors of a building run.

use crate::math;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt;

/// A cardinal direction of a world whose x axis points east and whose y axis points north.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Cardinal {
    /// Along x.
    East,
    /// Along y.
    North,
    /// Against x.
    West,
    /// Against y.
    South,
}

/// The line along which a cardinal direction runs.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// E-W.
    EastWest,
    /// N-S.
    NorthSouth,
}

impl Cardinal {
    /// All four, counter-clockwise from east.
    pub const ALL: [Self; 4] = [Self::East, Self::North, Self::West, Self::South];

    /// Returns the heading counter-clockwise from east (rad), in (-π, π].
    pub const fn heading(self) -> f64 {
        match self {
            Self::East => 0.0,
            Self::North => FRAC_PI_2,
            Self::West => PI,
            Self::South => -FRAC_PI_2,
        }
    }

    /// Returns the direction nearest to `heading` (rad, finite); of two equally near ones the counter-clockwise one.
    pub fn from_heading(heading: f64) -> Self {
        let heading = math::wrap_angle(heading);
        if !(-3.0 * FRAC_PI_4..3.0 * FRAC_PI_4).contains(&heading) {
            Self::West
        } else if heading < -FRAC_PI_4 {
            Self::South
        } else if heading < FRAC_PI_4 {
            Self::East
        } else {
            Self::North
        }
    }

    /// Returns the opposite direction.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::East => Self::West,
            Self::North => Self::South,
            Self::West => Self::East,
            Self::South => Self::North,
        }
    }

    /// Returns the line along which it runs.
    pub const fn axis(self) -> Axis {
        match self {
            Self::East | Self::West => Axis::EastWest,
            Self::North | Self::South => Axis::NorthSouth,
        }
    }

    /// Returns its position in [`Cardinal::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for Cardinal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::East => "east",
            Self::North => "north",
            Self::West => "west",
            Self::South => "south",
        })
    }
}

impl Axis {
    /// Both.
    pub const ALL: [Self; 2] = [Self::EastWest, Self::NorthSouth];

    /// Returns the other one.
    #[must_use]
    pub const fn across(self) -> Self {
        match self {
            Self::EastWest => Self::NorthSouth,
            Self::NorthSouth => Self::EastWest,
        }
    }

    /// Returns the two directions along it.
    pub const fn directions(self) -> [Cardinal; 2] {
        match self {
            Self::EastWest => [Cardinal::East, Cardinal::West],
            Self::NorthSouth => [Cardinal::North, Cardinal::South],
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::EastWest => "E-W",
            Self::NorthSouth => "N-S",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn headings_turn_counter_clockwise_from_east() {
        for (k, direction) in Cardinal::ALL.into_iter().enumerate() {
            assert_eq!(direction.index(), k);
            let quarter = Cardinal::from_heading(direction.heading() + FRAC_PI_2);
            assert_eq!(quarter, Cardinal::ALL[(k + 1) % 4]);
            assert_eq!(direction.opposite(), Cardinal::ALL[(k + 2) % 4]);
            assert_eq!(direction.axis(), direction.opposite().axis());
            assert!(direction.axis().directions().contains(&direction));
        }
    }

    #[test]
    fn halfway_goes_counter_clockwise() {
        let near = |degrees: f64| Cardinal::from_heading(degrees.to_radians());
        assert_eq!(Cardinal::from_heading(FRAC_PI_4), Cardinal::North);
        assert_eq!(Cardinal::from_heading(-FRAC_PI_4), Cardinal::East);
        assert_eq!(Cardinal::from_heading(3.0 * FRAC_PI_4), Cardinal::West);
        assert_eq!(Cardinal::from_heading(-3.0 * FRAC_PI_4), Cardinal::South);
        assert_eq!([near(44.0), near(46.0), near(-136.0), near(224.0)], {
            [Cardinal::East, Cardinal::North, Cardinal::West, Cardinal::West]
        });
    }

    proptest! {
        #[test]
        fn the_nearest_is_within_an_eighth_of_a_turn(heading in -50.0..50.0) {
            let off = math::wrap_angle(heading - Cardinal::from_heading(heading).heading());
            prop_assert!(off.abs() <= FRAC_PI_4 + 1e-12);
        }
    }
}
