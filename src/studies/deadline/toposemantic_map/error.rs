//! Observations that do not fit the map, and breaches of Definition 1 by a map.

use super::VertexId;
use super::label::SemanticLabel;
use crate::geometry::Cardinal;
use thiserror::Error;

/// An observation that cannot be true of the same building as the map: a misread intersection, or a building whose tags
/// do not keep Definition 1. The map is left as it was.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MapError {
    /// The map already has a vertex to begin with.
    #[error("the map already begins at {label}; arrive at further vertices by an exit")]
    Begun {
        /// The first vertex.
        label: SemanticLabel,
    },
    /// An intersection without tags could never be recognised.
    #[error("the intersection has no tags; expected at least one")]
    NoTags,
    /// Two exits in one direction.
    #[error(
        "the intersection has two exits to the {direction}; expected at most one in each direction"
    )]
    DoubleExit {
        /// The direction of both.
        direction: Cardinal,
    },
    /// The robot reports leaving by an exit that the vertex does not have.
    #[error("{label} has no exit to the {direction}")]
    NoSuchExit {
        /// The vertex.
        label: SemanticLabel,
        /// The exit.
        direction: Cardinal,
    },
    /// Definition 1: an edge in one direction needs the edge back.
    #[error(
        "{from}'s exit to the {direction} led to {to}, which has no exit back to the {}", .direction.opposite()
    )]
    NoWayBack {
        /// The vertex from which the robot came.
        from: SemanticLabel,
        /// The exit that it took.
        direction: Cardinal,
        /// Its arrival: a label, or `a new vertex`.
        to: String,
    },
    /// One end is a door, the other a corridor.
    #[error(
        "{from}'s exit to the {direction} leads through a {here}, but {to}'s exit back through a {there}"
    )]
    OtherOpening {
        /// The vertex from which the robot came.
        from: SemanticLabel,
        /// The exit that it took.
        direction: Cardinal,
        /// Its arrival: a label, or `a new vertex`.
        to: String,
        /// What the exit that it took leads through.
        here: &'static str,
        /// What the exit back leads through.
        there: &'static str,
    },
    /// The exit was explored before and led elsewhere.
    #[error("{from}'s exit to the {direction} led to {before} before, and now to {now}")]
    LedElsewhere {
        /// The vertex from which the robot came.
        from: SemanticLabel,
        /// The exit that it took.
        direction: Cardinal,
        /// The vertex to which it led.
        before: SemanticLabel,
        /// The vertex to which it leads now: a label, or `a new vertex`.
        now: String,
    },
    /// The exit back was explored before and led elsewhere.
    #[error("{from}'s exit to the {direction} led to {to}, whose exit back leads to {other}")]
    BackElsewhere {
        /// The vertex from which the robot came.
        from: SemanticLabel,
        /// The exit that it took.
        direction: Cardinal,
        /// The vertex at which it arrived.
        to: SemanticLabel,
        /// The vertex to which the exit back leads.
        other: SemanticLabel,
    },
    /// An exit led back to the vertex itself.
    #[error("{label}'s exit to the {direction} led back to {label}; expected another vertex")]
    Loop {
        /// The vertex.
        label: SemanticLabel,
        /// The exit.
        direction: Cardinal,
    },
    /// E is a set: two vertices have at most one edge from one to the other.
    #[error("{from}'s exits to the {first} and to the {second} both lead to {to}")]
    Parallel {
        /// The vertex from which the robot came.
        from: SemanticLabel,
        /// The exit that led there before.
        first: Cardinal,
        /// The exit that leads there now.
        second: Cardinal,
        /// The vertex to which both lead.
        to: SemanticLabel,
    },
    /// The tags belong to two vertices of the map.
    #[error("tags of {first} and of {second} were seen as one intersection")]
    Conflated {
        /// One.
        first: SemanticLabel,
        /// The other.
        second: SemanticLabel,
    },
    /// A known vertex changed its kind.
    #[error("{label} was seen as a {now}")]
    OtherPlace {
        /// The vertex.
        label: SemanticLabel,
        /// Its kind now.
        now: &'static str,
    },
    /// A new node that is not new.
    #[error("{label} is in the map already")]
    NotNew {
        /// The vertex.
        label: SemanticLabel,
    },
}

/// A breach of Definition 1 by a map. No operation of [`super::ToposemanticMap`] leads there; tests and debug builds
/// make sure.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Inconsistency {
    /// e = (vi, vj) is in E, e' = (vj, vi) is not.
    #[error("there is an edge from vertex {from} to vertex {to} and none back")]
    OneWay {
        /// vi.
        from: VertexId,
        /// vj.
        to: VertexId,
    },
    /// S(e) = S(e').
    #[error("vertices {from} and {to} are on the same side of each other")]
    SameSide {
        /// vi.
        from: VertexId,
        /// vj.
        to: VertexId,
    },
    /// D(e) and D(e') differ.
    #[error("the edges between vertices {from} and {to} run along different axes")]
    OtherAxis {
        /// vi.
        from: VertexId,
        /// vj.
        to: VertexId,
    },
    /// An edge from a vertex to itself, or two from one vertex to another.
    #[error("edge {from} to {to} is a loop or is there twice")]
    NotSimple {
        /// vi.
        from: VertexId,
        /// vj.
        to: VertexId,
    },
    /// L does not give each vertex its own label.
    #[error("vertices {first} and {second} have the same label")]
    SameLabel {
        /// One.
        first: VertexId,
        /// The other.
        second: VertexId,
    },
    /// A tag belongs to two vertices.
    #[error("vertices {first} and {second} share a tag")]
    SharedTag {
        /// One.
        first: VertexId,
        /// The other.
        second: VertexId,
    },
}
