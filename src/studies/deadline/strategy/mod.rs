//! `ExplorationNext(M, time)`: five strategies that choose the next vertex (section 5).
//!
//! Each chooses among the vertices with one or more edges (v, v∅). Rules that the paper states are taken literally;
//! where it states none, a parameter names the alternatives.

mod complete_corridor;
mod corridors_first;
mod frontier;
mod normalized_frontier;
mod random;
#[cfg(test)]
mod tests;

pub use complete_corridor::{CompleteCorridor, Completion, CorridorOf};
pub use corridors_first::CorridorsFirst;
pub use frontier::{Frontier, Ties};
pub use normalized_frontier::NormalizedFrontier;

use super::build_cmdp::Through;
use super::intersection::Opening;
use super::rules::Rules;
use super::toposemantic_map::{Edge, ToposemanticMap, VertexId};
use crate::geometry::Cardinal;
use crate::rng::Stream;
use complete_corridor::CompletingCorridors;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which of the five.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Random strategy exploration (Ra).
    Random,
    /// Topological frontier (Fr).
    Frontier,
    /// Topological frontier with normalised distances (NF).
    NormalizedFrontier,
    /// Semantic: explore corridors first (S1).
    CorridorsFirst,
    /// Semantic: complete corridors first (S2).
    CompleteCorridor,
}

/// What a strategy without a stated rule goes by. Ties that remain are broken uniformly.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Preference {
    /// The fewest edges away.
    Nearest,
    /// The most edges (v, v∅), then the fewest edges away.
    MostUnexplored,
    /// None: any of them.
    Uniform,
}

/// How the robot came to the current vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Came {
    /// The vertex that it left.
    pub from: VertexId,
    /// The exit by which it left that one: its direction still.
    pub direction: Cardinal,
    /// What the exit led through.
    pub opening: Opening,
}

impl Came {
    /// Returns what `edge` leads through for a robot that `came` so to where it begins. A plan knows no heading; the robot does:
    /// an edge across the corridor by which it came leads into another corridor, whatever else comes up to the vertex.
    pub fn through(came: Option<Self>, map: &ToposemanticMap, edge: &Edge) -> Through {
        let turns =
            |came: Self| came.opening == Opening::Corridor && came.direction.axis() != edge.axis();
        match map.through(edge) {
            Through::Corridor if came.is_some_and(turns) => Through::SideCorridor,
            through => through,
        }
    }
}

/// 𝒱 of section 5, the vertices with edges (v, v∅), relative to the current vertex.
#[derive(Debug, Clone)]
pub struct Candidates<'a> {
    map: &'a ToposemanticMap,
    /// Number of edges from the current vertex, by vertex.
    distances: Vec<Option<usize>>,
    /// In order of discovery.
    open: Vec<VertexId>,
}

impl<'a> Candidates<'a> {
    /// Creates the candidates on `map` for a robot at `current`.
    pub fn new(map: &'a ToposemanticMap, current: VertexId) -> Self {
        let distances = map.distances(current);
        let open = map
            .ids()
            .filter(|v| distances[v.index()].is_some() && map.unexplored_degree(*v) > 0)
            .collect();
        Self { map, distances, open }
    }

    /// Returns the candidates, in order of discovery.
    pub fn open(&self) -> &[VertexId] {
        &self.open
    }

    /// Returns the number of edges from the current vertex to a candidate.
    pub fn distance(&self, v: VertexId) -> usize {
        self.distances[v.index()].expect("candidates can be reached")
    }

    fn degree(&self, v: VertexId) -> usize {
        self.map.unexplored_degree(v)
    }

    /// Returns the one of `among` that `preference` puts first; `None` where there is none.
    fn prefer(
        &self,
        among: Vec<VertexId>,
        preference: Preference,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let most = usize::MAX;
        let best = match preference {
            Preference::Uniform => among,
            Preference::Nearest => least(among, |v| self.distance(v)),
            Preference::MostUnexplored => {
                least(among, |v| (most - self.degree(v), self.distance(v)))
            }
        };
        uniform(&best, stream)
    }
}

/// Returns those of `among` whose `key` is least.
fn least<K: Ord>(mut among: Vec<VertexId>, key: impl Fn(VertexId) -> K) -> Vec<VertexId> {
    if let Some(best) = among.iter().map(|v| key(*v)).min() {
        among.retain(|v| key(*v) == best);
    }
    among
}

/// Draws one of `among`, each with the same probability; `None` where there is none.
pub(super) fn uniform<T: Copy>(among: &[T], stream: &mut Stream) -> Option<T> {
    if among.is_empty() {
        return None;
    }
    let index = usize::try_from(stream.below(among.len() as u64)).expect("it is below a length");
    Some(among[index])
}

/// A strategy with its memory between choices.
#[derive(Debug, Clone)]
pub struct Chooser {
    strategy: Strategy,
    frontier: Frontier,
    normalized_frontier: NormalizedFrontier,
    corridors_first: CorridorsFirst,
    complete_corridor: CompletingCorridors,
}

impl Chooser {
    /// Creates the strategy that `rules` name.
    pub fn new(rules: &Rules) -> Self {
        Self {
            strategy: rules.strategy,
            frontier: rules.frontier.clone(),
            normalized_frontier: rules.normalized_frontier.clone(),
            corridors_first: rules.corridors_first.clone(),
            complete_corridor: CompletingCorridors::new(rules.complete_corridor.clone()),
        }
    }

    /// Chooses the vertex to which to go next from `current`, to which the robot `came` by its last move; `None` where
    /// nothing is left to explore.
    pub fn next(
        &mut self,
        map: &ToposemanticMap,
        current: VertexId,
        came: Option<Came>,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let candidates = Candidates::new(map, current);
        match self.strategy {
            Strategy::Random => random::choose(&candidates, stream),
            Strategy::Frontier => self.frontier.choose(&candidates, stream),
            Strategy::NormalizedFrontier => self.normalized_frontier.choose(&candidates, stream),
            Strategy::CorridorsFirst => self.corridors_first.choose(&candidates, stream),
            Strategy::CompleteCorridor => {
                self.complete_corridor.choose(&candidates, current, came, stream)
            }
        }
    }
}
