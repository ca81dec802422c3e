//! The output of the Intersection Detection System: a vertex and the edges that leave it.

use crate::geometry::Cardinal;
use crate::studies::deadline::build_cmdp::Place;
use serde::{Deserialize, Serialize};

/// What an outgoing edge leads through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Opening {
    /// A corridor.
    Corridor,
    /// A door.
    Door,
}

/// An outgoing edge as perceived.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Exit {
    /// Its compass direction.
    pub direction: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
}

/// A vertex at which the robot has arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Intersection {
    /// Opaque ids of the tags that belong to it, at least one. Two intersections are the same vertex if and only if
    /// they share one; nothing else is read from an id, and the order has no meaning.
    pub tags: Vec<String>,
    /// Whether it is a room or part of a corridor.
    pub place: Place,
    /// Its outgoing edges, at most one in each direction, counter-clockwise from east.
    pub exits: Vec<Exit>,
    /// Whether it is the goal.
    pub is_goal: bool,
}
