//! Semantic, complete corridors first (S2): "before moving to a different corridor the robot finishes exploring the corridor
//! it is located in"; it "enters a new corridor only once the previous corridor can no longer be extended".

use super::{Came, Candidates, Preference};
use crate::geometry::Axis;
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::Opening;
use crate::studies::deadline::rules::parameters;
use crate::studies::deadline::toposemantic_map::{End, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Semantic: complete corridors first.
    CompleteCorridor {
        /// Which corridor is finished before another is entered: the one it is located in, as the paper says.
        corridor: CorridorOf = CorridorOf::Located,
        /// Which of several vertices of the corridor. The paper gives no rule; nearest, which needs no further walk.
        inside: Preference = Preference::Nearest,
        /// Which vertex to begin the next corridor with. The paper gives no rule; nearest.
        next: Preference = Preference::Nearest,
        /// When a corridor is finished: when it "can no longer be extended", as the paper says.
        finished: Completion = Completion::Extended,
    }
);

/// Which corridor is finished before another is entered.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum CorridorOf {
    /// The one in which the robot is when it chooses: along its last move, and from a room the one at the door.
    Located,
    /// The one that it took up last, to which it comes back from wherever a random edge has led it.
    InHand,
}

/// When a corridor is finished.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Completion {
    /// When no vertex of it has an unexplored edge.
    Explored,
    /// When no vertex of it has an unexplored edge along it.
    Extended,
}

/// The strategy, with the corridor in hand for the reading that has one.
#[derive(Debug, Clone)]
pub(super) struct CompletingCorridors {
    rule: CompleteCorridor,
    /// Any vertex of it, and the axis along which it runs: as the map grows, so does the corridor.
    in_hand: Option<(VertexId, Axis)>,
}

impl CompletingCorridors {
    pub(super) fn new(rule: CompleteCorridor) -> Self {
        Self { rule, in_hand: None }
    }

    /// Returns a vertex of the corridor in hand and the axis along which it runs.
    #[cfg(test)]
    pub(super) fn in_hand(&self) -> Option<(VertexId, Axis)> {
        self.in_hand
    }

    /// Chooses a vertex of the corridor, or where that is finished one of another.
    pub(super) fn choose(
        &mut self,
        candidates: &Candidates<'_>,
        current: VertexId,
        came: Option<Came>,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let corridor = match self.rule.corridor {
            CorridorOf::Located => self.located(candidates, current, came),
            CorridorOf::InHand => {
                if self.in_hand.is_none() && candidates.map.place(current) == Place::Corridor {
                    self.in_hand = Some((current, self.axis_at(candidates, current)));
                }
                self.in_hand
            }
        };
        if let Some((member, axis)) = corridor {
            let unfinished = self.unfinished(candidates, member, axis);
            if !unfinished.is_empty() {
                return candidates.prefer(unfinished, self.rule.inside, stream);
            }
        }
        // Finished: "the robot enters a new corridor". Rooms with a further door come last, as the paper says nothing
        // of them.
        let open = candidates.open();
        let place = |v: &VertexId| candidates.map.place(*v);
        let corridors: Vec<VertexId> =
            open.iter().copied().filter(|v| place(v) == Place::Corridor).collect();
        let among = if corridors.is_empty() { open.to_vec() } else { corridors };
        let next = candidates.prefer(among, self.rule.next, stream)?;
        if place(&next) == Place::Corridor {
            self.in_hand = Some((next, self.axis_at(candidates, next)));
        }
        Some(next)
    }

    /// Returns a vertex of the corridor in which the robot is, and its axis: along its last move; in a room the corridor at
    /// the door by which it came, which runs across that move. `None` for a room without a corridor at its doors.
    fn located(
        &self,
        candidates: &Candidates<'_>,
        current: VertexId,
        came: Option<Came>,
    ) -> Option<(VertexId, Axis)> {
        let map = candidates.map;
        let is_corridor = |v: &VertexId| map.place(*v) == Place::Corridor;
        let member = if is_corridor(&current) {
            current
        } else {
            let behind = came.map(|came| came.from).filter(is_corridor);
            let ends = map.edges_from(current).filter_map(|edge| match edge.to {
                End::Vertex(to) => Some(to),
                End::Unexplored => None,
            });
            behind.or_else(|| ends.into_iter().find(is_corridor))?
        };
        let runs = |axis: &Axis| {
            let mut edges = map.edges_from(member);
            edges.any(|edge| edge.axis() == *axis && edge.opening == Opening::Corridor)
        };
        let axis = came.map(|came| {
            let along = came.direction.axis();
            if came.opening == Opening::Corridor { along } else { along.across() }
        });
        let axis = axis.filter(runs).unwrap_or_else(|| self.axis_at(candidates, member));
        Some((member, axis))
    }

    /// Returns the vertices of a corridor that keep it from being finished, in order of discovery.
    fn unfinished(
        &self,
        candidates: &Candidates<'_>,
        member: VertexId,
        axis: Axis,
    ) -> Vec<VertexId> {
        let corridor = candidates.map.corridor(member, axis);
        let keeps = |v: &VertexId| match self.rule.finished {
            Completion::Explored => true,
            Completion::Extended => extends(candidates, *v, axis),
        };
        candidates.open().iter().copied().filter(|v| corridor.contains(v) && keeps(v)).collect()
    }

    /// Returns the axis along which to take a vertex where two corridors cross: the one with more vertices left to
    /// explore, then the one that continues there, then the longer one, then E-W.
    fn axis_at(&self, candidates: &Candidates<'_>, v: VertexId) -> Axis {
        let worth = |axis: Axis| {
            (
                self.unfinished(candidates, v, axis).len(),
                extends(candidates, v, axis),
                candidates.map.corridor(v, axis).len(),
            )
        };
        let [first, second] = Axis::ALL;
        if worth(second) > worth(first) { second } else { first }
    }
}

/// Returns whether an unexplored edge along `axis` leaves `v` through a corridor.
fn extends(candidates: &Candidates<'_>, v: VertexId, axis: Axis) -> bool {
    candidates
        .map
        .unexplored(v)
        .any(|edge| edge.axis() == axis && edge.opening == Opening::Corridor)
}
