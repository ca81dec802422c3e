//! The semantic topological oriented map M = (V, E, L, D, S): section 3, Definition 1, and its growth: section 4,
//! Algorithm 1.
//!
//! A vertex keeps its outgoing edges by compass direction. The requirements of Definition 1 on edges then mostly cannot
//! be broken: D(e) and S(e) are read off the direction, and the only function that makes an edge also makes the edge
//! back, in the opposite direction, so that D agrees and S differs ([`ToposemanticMap::check`] verifies it
//! nevertheless).

mod error;
mod growth;
mod label;
#[cfg(test)]
mod tests;

pub use error::{Inconsistency, MapError};
pub use label::{SemanticLabel, side};

use super::intersection::{Intersection, Opening};
use crate::geometry::{Axis, Cardinal};
use crate::studies::deadline::build_cmdp::{OrientedEdge, Place, Side, Through, Topology};
use label::Labels;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;

/// A vertex of one map: its number in order of discovery, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct VertexId(usize);

impl VertexId {
    /// Returns the vertex at which the robot began.
    pub const fn first() -> Self {
        Self(0)
    }

    /// Returns the number, from 0.
    pub const fn index(self) -> usize {
        self.0
    }
}

impl fmt::Display for VertexId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The end of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// v∅: unexplored space.
    Unexplored,
    /// A vertex.
    Vertex(VertexId),
}

/// One edge in the sense of Definition 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The vertex that it leaves.
    pub from: VertexId,
    /// Its direction.
    pub direction: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
    /// Its end.
    pub to: End,
}

impl Edge {
    /// Returns D(e).
    pub const fn axis(&self) -> Axis {
        self.direction.axis()
    }

    /// Returns S(e).
    pub const fn side(&self) -> Side {
        side(self.direction)
    }
}

/// The kind of a robot's arrival at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Arrival {
    /// It is new (Algorithm 1).
    New,
    /// It was known, and so was the edge.
    Revisit,
    /// It was known, and the edge to it was not: a loop closed.
    LoopClosed,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Vertex {
    label: SemanticLabel,
    tags: BTreeSet<String>,
    is_goal: bool,
    exits: [Option<(Opening, End)>; 4],
}

/// M = (V, E, L, D, S).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ToposemanticMap {
    vertices: Vec<Vertex>,
    labels: Labels,
}

impl ToposemanticMap {
    /// Returns the empty map.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the vertex that shares a tag with `here`, if there is one.
    ///
    /// # Errors
    /// There are two.
    pub fn recognise(&self, here: &Intersection) -> Result<Option<VertexId>, MapError> {
        let mut known = self
            .ids()
            .filter(|v| here.tags.iter().any(|tag| self.vertices[v.0].tags.contains(tag)));
        let first = known.next();
        match (first, known.next()) {
            (Some(first), Some(second)) => {
                Err(MapError::Conflated { first: self.label(first), second: self.label(second) })
            }
            _ => Ok(first),
        }
    }

    /// Returns |V|.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Returns whether V is empty.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Returns V, in order of discovery.
    pub fn ids(&self) -> impl Iterator<Item = VertexId> + use<> {
        (0..self.vertices.len()).map(VertexId)
    }

    /// Returns L(v).
    pub fn label(&self, v: VertexId) -> SemanticLabel {
        self.vertices[v.0].label
    }

    /// Returns whether v is a room or part of a corridor.
    pub fn place(&self, v: VertexId) -> Place {
        self.label(v).place()
    }

    /// Returns whether v is the goal.
    pub fn is_goal(&self, v: VertexId) -> bool {
        self.vertices[v.0].is_goal
    }

    /// Returns the tags by which v is recognised.
    pub fn tags(&self, v: VertexId) -> &BTreeSet<String> {
        &self.vertices[v.0].tags
    }

    /// Returns the edges that leave v, counter-clockwise from east.
    pub fn edges_from(&self, v: VertexId) -> impl Iterator<Item = Edge> + '_ {
        Cardinal::ALL.into_iter().filter_map(move |direction| self.edge(v, direction))
    }

    /// Returns the edge that leaves v in `direction`.
    pub fn edge(&self, from: VertexId, direction: Cardinal) -> Option<Edge> {
        let (opening, to) = self.vertices[from.0].exits[direction.index()]?;
        Some(Edge { from, direction, opening, to })
    }

    /// Returns E, by vertex and direction.
    pub fn edges(&self) -> impl Iterator<Item = Edge> + '_ {
        self.ids().flat_map(|v| self.edges_from(v))
    }

    /// Returns the edges (v, v∅).
    pub fn unexplored(&self, v: VertexId) -> impl Iterator<Item = Edge> + '_ {
        self.edges_from(v).filter(|edge| edge.to == End::Unexplored)
    }

    /// Returns deg(v) of section 5: how many edges (v, v∅) there are.
    pub fn unexplored_degree(&self, v: VertexId) -> usize {
        self.unexplored(v).count()
    }

    /// Computes d(v) of section 5 for every v: the number of edges on a shortest path from `from`; `None` where there
    /// is none.
    pub fn distances(&self, from: VertexId) -> Vec<Option<usize>> {
        let mut distances = vec![None; self.len()];
        distances[from.0] = Some(0);
        let mut queue = VecDeque::from([(from, 0)]);
        while let Some((v, d)) = queue.pop_front() {
            for edge in self.edges_from(v) {
                if let End::Vertex(to) = edge.to
                    && distances[to.0].is_none()
                {
                    distances[to.0] = Some(d + 1);
                    queue.push_back((to, d + 1));
                }
            }
        }
        distances
    }

    /// Returns the corridor along `axis` on which `v` is (section 5, complete corridors first): the longest path
    /// through v of which all vertices are corridor vertices and all edges run along the axis. From west or south on;
    /// empty for a room.
    pub fn corridor(&self, v: VertexId, axis: Axis) -> Vec<VertexId> {
        if self.place(v) == Place::Room {
            return Vec::new();
        }
        let [forward, back] = axis.directions();
        let mut path = vec![v];
        for direction in [back, forward] {
            let mut at = v;
            while let Some(Edge { to: End::Vertex(next), .. }) = self.edge(at, direction)
                && self.place(next) == Place::Corridor
                && !path.contains(&next)
            {
                path.push(next);
                at = next;
            }
            if direction == back {
                path.reverse();
            }
        }
        path
    }

    /// Returns what `edge` leads through. A door into unexplored space leads out of a room, or else into one. A corridor is
    /// a side corridor where no corridor comes up to the vertex from the opposite side, from which a robot would go straight
    /// on, and one runs across.
    pub fn through(&self, edge: &Edge) -> Through {
        let corridor = |direction: Cardinal| {
            self.edge(edge.from, direction).is_some_and(|edge| edge.opening == Opening::Corridor)
        };
        match (edge.opening, edge.to) {
            (Opening::Corridor, _) => {
                let across = edge.axis().across().directions();
                let is_side =
                    !corridor(edge.direction.opposite()) && across.into_iter().any(corridor);
                if is_side { Through::SideCorridor } else { Through::Corridor }
            }
            (Opening::Door, End::Vertex(to)) if self.place(to) == Place::Corridor => {
                Through::Leaving
            }
            (Opening::Door, End::Unexplored) if self.place(edge.from) == Place::Room => {
                Through::Leaving
            }
            (Opening::Door, _) => Through::Entering,
        }
    }

    /// Returns the part that the planner needs: all vertices and the explored edges, with each edge's exit.
    pub fn topology(&self) -> (Topology, Vec<(VertexId, Cardinal)>) {
        let mut topology = Topology {
            vertices: self.vertices.iter().map(|vertex| vertex.label.place()).collect(),
            edges: Vec::new(),
        };
        let mut exits = Vec::new();
        for edge in self.edges() {
            if let End::Vertex(to) = edge.to {
                let (from, to) = (edge.from.0, to.0);
                let (side, through) = (edge.side(), self.through(&edge));
                topology.edges.push(OrientedEdge { from, to, side, through });
                exits.push((edge.from, edge.direction));
            }
        }
        (topology, exits)
    }

    /// Checks whether the map keeps Definition 1: L is injective, E is a set, and for every edge e = (vi, vj) there is
    /// e' = (vj, vi) with D(e) = D(e') and S(e) ≠ S(e').
    ///
    /// # Errors
    /// The first inconsistency.
    pub fn check(&self) -> Result<(), Inconsistency> {
        let mut labels = BTreeMap::new();
        let mut tags = BTreeMap::new();
        for v in self.ids() {
            if let Some(first) = labels.insert(self.label(v), v) {
                return Err(Inconsistency::SameLabel { first, second: v });
            }
            for tag in self.tags(v) {
                if let Some(first) = tags.insert(tag, v) {
                    return Err(Inconsistency::SharedTag { first, second: v });
                }
            }
        }
        let mut ends = BTreeMap::new();
        for edge in self.edges() {
            if let End::Vertex(to) = edge.to
                && (to == edge.from || ends.insert((edge.from, to), edge).is_some())
            {
                return Err(Inconsistency::NotSimple { from: edge.from, to });
            }
        }
        for ((from, to), edge) in &ends {
            let (from, to) = (*from, *to);
            let Some(back) = ends.get(&(to, from)) else {
                return Err(Inconsistency::OneWay { from, to });
            };
            if edge.axis() != back.axis() {
                return Err(Inconsistency::OtherAxis { from, to });
            }
            if edge.side() == back.side() {
                return Err(Inconsistency::SameSide { from, to });
            }
        }
        Ok(())
    }
}
