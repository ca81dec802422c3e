//! Semantic labels, λ of Definition 1: the kind of place that a vertex is, and a name of its own.

use crate::geometry::{Axis, Cardinal};
use crate::studies::deadline::build_cmdp::{Place, Side};
use std::fmt;

/// L(v): a label that no other vertex of the map has, given in order of discovery and written as in Figures 1 and 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SemanticLabel {
    /// `R1`: a room.
    Room {
        /// From 1.
        number: u32,
    },
    /// `c1a`: a vertex of a corridor.
    Corridor {
        /// From 1.
        number: u32,
        /// Place in order of discovery among the vertices of this corridor, from 0.
        letter: u32,
    },
}

impl SemanticLabel {
    /// Returns the kind of place that it names.
    pub const fn place(self) -> Place {
        match self {
            Self::Room { .. } => Place::Room,
            Self::Corridor { .. } => Place::Corridor,
        }
    }
}

impl fmt::Display for SemanticLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Room { number } => write!(f, "R{number}"),
            Self::Corridor { number, letter } => write!(f, "c{number}{}", letters(*letter)),
        }
    }
}

/// Writes a number as letters: a, b, .., z, aa, ab, ..
fn letters(mut index: u32) -> String {
    let mut reversed = Vec::new();
    loop {
        let digit = u8::try_from(index % 26).expect("below 26");
        reversed.push(char::from(b'a' + digit));
        if index < 26 {
            break;
        }
        index = index / 26 - 1;
    }
    reversed.iter().rev().collect()
}

/// Returns S(e) of an edge that leaves in `direction`: seen facing north for E-W edges, facing west for N-S edges.
pub const fn side(direction: Cardinal) -> Side {
    match direction {
        Cardinal::West | Cardinal::South => Side::Left,
        Cardinal::East | Cardinal::North => Side::Right,
    }
}

/// Hands out labels in order of discovery.
///
/// A corridor vertex that is found by going on along the corridor of the vertex before it gets that corridor's number
/// and the next letter; any other opens a corridor of its own. A corridor runs along one axis, which its second vertex
/// fixes. What was found as two corridors and turns out to be one keeps its two numbers: labels are names, and a
/// strategy that needs the corridor of a vertex reads it from the graph.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Labels {
    rooms: u32,
    corridors: Vec<Corridor>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Corridor {
    axis: Option<Axis>,
    vertices: u32,
}

impl Labels {
    /// Returns a label for a new vertex of kind `place`; `along` is the label of the corridor vertex from which it was
    /// reached through a corridor, and the axis of the edge between them.
    pub(super) fn next(
        &mut self,
        place: Place,
        along: Option<(SemanticLabel, Axis)>,
    ) -> SemanticLabel {
        if place == Place::Room {
            self.rooms += 1;
            return SemanticLabel::Room { number: self.rooms };
        }
        let axis = along.map(|(_, axis)| axis);
        if let Some((SemanticLabel::Corridor { number, .. }, axis)) = along {
            let corridor = &mut self.corridors[number as usize - 1];
            if corridor.axis.is_none_or(|own| own == axis) {
                corridor.axis = Some(axis);
                let letter = corridor.vertices;
                corridor.vertices += 1;
                return SemanticLabel::Corridor { number, letter };
            }
        }
        self.corridors.push(Corridor { axis, vertices: 1 });
        let number = u32::try_from(self.corridors.len()).expect("a map has few corridors");
        SemanticLabel::Corridor { number, letter: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_after_z() {
        let written = |letter| SemanticLabel::Corridor { number: 3, letter }.to_string();
        assert_eq!(
            [0, 25, 26, 51, 52, 701, 702].map(written),
            ["c3a", "c3z", "c3aa", "c3az", "c3ba", "c3zz", "c3aaa"]
        );
        assert_eq!(SemanticLabel::Room { number: 12 }.to_string(), "R12");
    }

    /// Checks figure 1: west and south are left, east and north are right.
    #[test]
    fn sides_follow_figure_1() {
        assert_eq!(Cardinal::ALL.map(side), [Side::Right, Side::Right, Side::Left, Side::Left]);
    }
}
