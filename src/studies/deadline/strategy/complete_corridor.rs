//! Semantic, complete corridors first (S2): "before moving to a different corridor the robot finishes exploring the corridor
//! it is located in".

use super::{Candidates, Preference};
use crate::geometry::Axis;
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::Opening;
use crate::studies::deadline::rules::parameters;
use crate::studies::deadline::toposemantic_map::VertexId;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Semantic: complete corridors first.
    CompleteCorridor {
        /// Which of several vertices of the corridor. The paper gives no rule; nearest, which needs no further walk.
        inside: Preference = Preference::Nearest,
        /// Which vertex to begin the next corridor with. The paper gives no rule; nearest.
        next: Preference = Preference::Nearest,
        /// When a corridor is finished. The paper says both "finishes exploring" and "can no longer be extended", and that
        /// rooms are explored on the way; the first covers the other two.
        finished: Completion = Completion::Explored,
    }
);

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

/// The strategy with the corridor at which it works.
#[derive(Debug, Clone)]
pub(super) struct CorridorInHand {
    rule: CompleteCorridor,
    /// Any vertex of it, and the axis along which it runs: as the map grows, so does the corridor.
    corridor: Option<(VertexId, Axis)>,
}

impl CorridorInHand {
    pub(super) fn new(rule: CompleteCorridor) -> Self {
        Self { rule, corridor: None }
    }

    /// Returns a vertex of the corridor in hand and the axis along which it runs.
    #[cfg(test)]
    pub(super) fn in_hand(&self) -> Option<(VertexId, Axis)> {
        self.corridor
    }

    /// Chooses a vertex of the corridor in hand, or where that is finished one of another. The robot's path there and
    /// the random edge that follows may leave the corridor; it is remembered, so that the next choice returns to it.
    pub(super) fn choose(
        &mut self,
        candidates: &Candidates<'_>,
        current: VertexId,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        if self.corridor.is_none() && candidates.map.place(current) == Place::Corridor {
            self.corridor = Some((current, self.axis_at(candidates, current)));
        }
        if let Some((member, axis)) = self.corridor {
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
            self.corridor = Some((next, self.axis_at(candidates, next)));
        }
        Some(next)
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
