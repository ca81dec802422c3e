//! The six maneuvers of the deadline study (section 6): through a corridor, a door to the left or to the right, each
//! slow or fast, driven closed-loop on the laser, the compass and the tag ahead.
//!
//! A [`Leg`] leads from one vertex of the building to the next. Its maneuver begins with a turn in place towards the
//! exit, whatever the turn (the paper's maneuvers turn a quarter at most; U-turns and turns into corridors are a named
//! deviation), and ends when the mission reports that the next vertex is reached. The scan is taken in the *leg's
//! frame*: the origin at the base, x along the leg's direction.
//!
//! A mind: it sees messages, never the simulator or the world.

mod corridor;
mod door;
mod guard;
mod heading;
mod outlook;
mod pilot;
mod rule;
#[cfg(test)]
mod tests;

pub use pilot::Pilot;
pub use rule::{DoorGuidance, HeadingSource, PilotRule, SpeedLimits};

use crate::geometry::Point;
use crate::robot::{CompassReading, Scan};
use crate::units::Tick;

/// The pilot is asked for a command at 10 Hz.
pub const CONTROL_PERIOD: Tick = Tick(300);

/// What an exit leads through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opening {
    /// Along a corridor.
    Corridor,
    /// Through a door.
    Door,
}

/// The connection from one vertex to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Absolute heading of the exit (rad, counter-clockwise from east): one of the building's four directions.
    pub direction: f64,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
    /// How fast it may be driven.
    pub limits: SpeedLimits,
}

/// What the pilot knows at one control step.
#[derive(Debug, Clone, Copy)]
pub struct Sense<'a> {
    /// The latest scan.
    pub scan: &'a Scan,
    /// The latest reading of the compass.
    pub compass: CompassReading,
    /// The vertex at the leg's end, where it is seen now, in the base frame (m).
    pub target: Option<Point>,
}
