//! The phases of an exploring mind between its choices.

use crate::geometry::Point;
use crate::navigation::Wavefront;
use crate::units::Tick;

/// The mind's present activity.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Phase {
    /// About to choose a location.
    Choosing,
    /// Driving to a location.
    Driving(Journey),
    /// At a frontier whose unknown side it has not looked at: turning towards `towards`.
    Facing { towards: Point },
    /// Nothing left to do, and why.
    Done(Ending),
}

/// Why exploration ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// No frontier is left.
    NoFrontierLeft,
    /// Frontiers are left, but none can be reached.
    NoWay {
        /// How many.
        frontiers: usize,
    },
}

/// A journey to a location.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Journey {
    /// The location (m, map frame).
    pub(super) target: Point,
    /// Lowest weighted distance so far (m), and when it was reached.
    pub(super) closest: (f64, Tick),
    /// Weighted distance (m) when last computed.
    pub(super) remaining: f64,
    pub(super) chosen_at: Tick,
}

/// A choice that has yet to take effect.
#[derive(Debug)]
pub(super) struct Decided {
    pub(super) due: Tick,
    pub(super) next: Phase,
    /// The wave to a new target.
    pub(super) wave: Option<Wavefront>,
}
