//! Walks of the real mind through the whole of a building, without clock and hazard.
//!
//! Where the mind goes does not depend on how long it takes: section 5 chooses by the map alone, and of all plans with the
//! fewest edges the one that is driven differs in speed only. A walk is therefore drawn once and timed as often as anything
//! about time or hazard is supposed ([`super::timing`]); and it serves every goal, for a goal is told on arrival. Left out is
//! what a loop of corridors makes possible: a quicker way of more edges, taken where a deadline cannot be met.

use crate::geometry::Cardinal;
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::{Maneuvers, Motion};
use crate::studies::deadline::intersection::Intersection;
use crate::studies::deadline::is_entry;
use crate::studies::deadline::rules::{InitialEdges, Rules};
use crate::studies::deadline::strategy::{Came, Chooser};
use crate::studies::deadline::toposemantic_map::{Edge, End, ToposemanticMap, VertexId};
use crate::world::topology::Topology;

/// A part of a walk: the way to a vertex that was chosen, or one move that no plan covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Leg {
    /// Whether a plan covers it.
    pub(super) planned: bool,
    /// Moves by the maneuver of a corridor.
    pub(super) corridors: u8,
    /// Moves by that of a door.
    pub(super) doors: u8,
    /// Moves whose hazard is that of entries.
    pub(super) entries: u8,
    /// The vertex of the building at which it ends.
    pub(super) to: u8,
}

impl Leg {
    const NOWHERE: Self = Self { planned: false, corridors: 0, doors: 0, entries: 0, to: 0 };

    /// Returns how many edges it passes.
    pub(super) const fn edges(self) -> u8 {
        self.corridors + self.doors
    }
}

/// A walk through the whole of a building.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Walk {
    pub(super) legs: Vec<Leg>,
    /// By goal: after how many legs the robot first stands there; `None` where it never does.
    pub(super) arrivals: Vec<Option<u16>>,
}

impl Walk {
    /// Notes when a walk of these `legs` from `start` first comes to each of the goals; `goal_at` is the number of the goal at each
    /// vertex of the building.
    pub(super) fn new(start: usize, legs: Vec<Leg>, goal_at: &[Option<usize>]) -> Self {
        let mut arrivals = vec![None; goal_at.iter().flatten().count()];
        let ends = std::iter::once(start).chain(legs.iter().map(|leg| usize::from(leg.to)));
        for (place, at) in (0_u16..).zip(ends) {
            if let Some(goal) = goal_at[at] {
                arrivals[goal].get_or_insert(place);
            }
        }
        Self { legs, arrivals }
    }
}

/// A building as walks see it.
pub(super) struct Site<'a> {
    pub(super) topology: &'a Topology,
    /// Its vertices as the IDS would report them, none of them a goal.
    pub(super) places: &'a [Intersection],
    /// By which maneuver an edge is passed.
    pub(super) maneuvers: &'a Maneuvers,
}

/// A mind on its way.
struct Walker<'a> {
    site: &'a Site<'a>,
    map: ToposemanticMap,
    /// The vertex of the building for every vertex of the map.
    truth: Vec<usize>,
    current: VertexId,
    came: Option<Came>,
    legs: Vec<Leg>,
}

impl Site<'_> {
    /// Lets a mind of these `rules` walk from the vertex `start` until nothing is left to explore, drawing as
    /// [`Explorer`](crate::studies::deadline::exploration::Explorer) does.
    pub(super) fn walk(&self, rules: &Rules, start: usize, stream: &mut Stream) -> Vec<Leg> {
        let mut map = ToposemanticMap::new();
        let Ok(current) = map.begin(&self.places[start]) else { return Vec::new() };
        let (truth, legs) = (vec![start], Vec::with_capacity(2 * self.places.len()));
        let mut walker = Walker { site: self, map, truth, current, came: None, legs };
        let mut chooser = Chooser::new(rules);
        while walker.turn(rules, &mut chooser, stream).is_some() {}
        walker.legs
    }
}

impl Walker<'_> {
    /// Makes the moves up to the next new edge; `None` where nothing is left to explore.
    fn turn(&mut self, rules: &Rules, chooser: &mut Chooser, stream: &mut Stream) -> Option<()> {
        let begun = self.map.len() >= rules.initial_vertices as usize;
        let mut edges: Vec<Edge> = self.map.unexplored(self.current).collect();
        if begun {
            let target = chooser.next(&self.map, self.current, self.came, stream)?;
            if target != self.current {
                self.go_to(target)?;
                edges = self.map.unexplored(target).collect();
            }
        } else {
            if self.map.ids().all(|v| self.map.unexplored_degree(v) == 0) {
                return None;
            }
            if edges.is_empty() || rules.initial_edges == InitialEdges::Any {
                edges = self.map.edges_from(self.current).collect();
            }
        }
        if edges.is_empty() {
            return None;
        }
        let drawn = usize::try_from(stream.below(edges.len() as u64)).ok()?;
        let mut leg = Leg::NOWHERE;
        self.step(edges[drawn], &mut leg)?;
        self.legs.push(leg);
        Some(())
    }

    /// Goes the way of fewest edges, of several the first by direction.
    fn go_to(&mut self, target: VertexId) -> Option<()> {
        let distances = self.map.distances(target);
        let mut leg = Leg { planned: true, ..Leg::NOWHERE };
        while self.current != target {
            let nearer = distances[self.current.index()]?.checked_sub(1)?;
            let mut edges = self.map.edges_from(self.current);
            let next = edges.find(|edge| match edge.to {
                End::Vertex(to) => distances[to.index()] == Some(nearer),
                End::Unexplored => false,
            })?;
            drop(edges);
            self.step(next, &mut leg)?;
        }
        self.legs.push(leg);
        Some(())
    }

    fn step(&mut self, edge: Edge, leg: &mut Leg) -> Option<()> {
        let through = Came::through(self.came, &self.map, &edge);
        let maneuvers = self.site.maneuvers;
        match maneuvers.motion(through, edge.side()) {
            Motion::Corridor => leg.corridors += 1,
            Motion::DoorLeft | Motion::DoorRight => leg.doors += 1,
        }
        leg.entries += u8::from(is_entry(through, maneuvers.side_corridors));
        let to = match edge.to {
            End::Vertex(to) => {
                self.current = to;
                self.truth[to.index()]
            }
            End::Unexplored => self.discover(&edge)?,
        };
        leg.to = u8::try_from(to).ok()?;
        let Edge { from, direction, opening, .. } = edge;
        self.came = Some(Came { from, direction, opening });
        Some(())
    }

    /// Follows an unexplored edge and returns the building's vertex to which it leads.
    fn discover(&mut self, edge: &Edge) -> Option<usize> {
        let to = self.end(self.truth[edge.from.index()], edge.direction)?;
        let here = &self.site.places[to];
        let (current, _) = self.map.arrive(edge.from, edge.direction, here).ok()?;
        if current.index() == self.truth.len() {
            self.truth.push(to);
        }
        self.current = current;
        Some(to)
    }

    fn end(&self, from: usize, direction: Cardinal) -> Option<usize> {
        let exits = &self.site.topology.vertices[from].exits;
        exits.iter().find(|exit| exit.direction == direction).map(|exit| exit.to)
    }
}
