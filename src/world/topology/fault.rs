//! Breaches of the convention of tags, in words.

use crate::geometry::{Cardinal, Point};

/// One breach of the convention by a building's tags.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TagFault {
    /// Two vertex tags so near each other that marks could belong to either.
    #[error(
        "the vertex tags `{}` and `{}` are {distance:.2} m apart: expected at least {least} m",
        tags[0], tags[1]
    )]
    Crowded {
        /// Their ids.
        tags: [String; 2],
        /// How far they are apart (m).
        distance: f64,
        /// How far they should be (m).
        least: f64,
    },
    /// An exit or goal tag that belongs to no vertex.
    #[error(
        "the {color} tag `{tag}` at ({}, {}) m belongs to no vertex: expected a vertex tag within {within} m",
        at.x, at.y
    )]
    Alone {
        /// Its id.
        tag: String,
        /// Its colour.
        color: String,
        /// Its position (m).
        at: Point,
        /// The distance within which a vertex tag was sought (m).
        within: f64,
    },
    /// An exit tag that faces none of the four directions.
    #[error("the exit tag `{tag}` faces {degrees:.1} degrees: expected east, north, west or south")]
    Askew {
        /// Its id.
        tag: String,
        /// Its heading (degrees, counter-clockwise from east).
        degrees: f64,
    },
    /// An exit tag that does not stand on the side to which it leads.
    #[error(
        "the exit tag `{tag}` faces {direction} but does not stand {direction} of its vertex `{vertex}`"
    )]
    Misplaced {
        /// Its id.
        tag: String,
        /// The vertex to which it belongs.
        vertex: String,
        /// Its direction.
        direction: Cardinal,
    },
    /// Two exits in one direction.
    #[error("the vertex `{vertex}` has two exits to the {direction}: `{}` and `{}`", tags[0], tags[1])]
    Doubled {
        /// The vertex.
        vertex: String,
        /// The direction.
        direction: Cardinal,
        /// The exits' ids.
        tags: [String; 2],
    },
    /// An exit that leads to no vertex.
    #[error("the exit `{tag}` has no other end: there is no vertex tag {direction} of it")]
    Nowhere {
        /// Its id.
        tag: String,
        /// Its direction.
        direction: Cardinal,
    },
    /// An exit whose other end does not lead back.
    #[error(
        "the exit `{tag}` leads {direction} to the vertex `{vertex}`, which has no exit {back} that leads back"
    )]
    NoWayBack {
        /// Its id.
        tag: String,
        /// The vertex at the other end.
        vertex: String,
        /// The direction of the exit.
        direction: Cardinal,
        /// The direction of the missing one.
        back: Cardinal,
    },
    /// The two ends of an edge differ in what it leads through.
    #[error("the exits `{}` and `{}` are of one edge and differ in colour", tags[0], tags[1])]
    Unequal {
        /// Their ids.
        tags: [String; 2],
    },
    /// A room that opens to a corridor without a door.
    #[error(
        "the room `{vertex}` has the corridor exit `{exit}`: expected exits through doors alone"
    )]
    OpenRoom {
        /// The room.
        vertex: String,
        /// The exit.
        exit: String,
    },
    /// A corridor vertex to which no corridor leads.
    #[error("the corridor vertex `{vertex}` has no exit through a corridor")]
    NoCorridor {
        /// The vertex.
        vertex: String,
    },
    /// A room without an exit.
    #[error("the room `{vertex}` has no exit")]
    NoExit {
        /// The room.
        vertex: String,
    },
}
