//! Semantic, explore corridors first (S1): "if among the vertices with unexplored outgoing edges there are both corridors
//! and rooms, the robot always selects corridors first".

use super::{Candidates, Preference};
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::rules::parameters;
use crate::studies::deadline::toposemantic_map::VertexId;

parameters!(
    /// Semantic: explore corridors first.
    CorridorsFirst {
        /// Which of several corridors (and of several rooms, where there are no corridors). The paper gives no rule. With
        /// `uniform` the strategy is the random one wherever rooms have one door, because a room is left with nothing to
        /// explore; its printed results are not those of random, so that another rule was used: nearest.
        among: Preference = Preference::Nearest,
    }
);

impl CorridorsFirst {
    pub(super) fn choose(
        &self,
        candidates: &Candidates<'_>,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let corridors: Vec<VertexId> = candidates
            .open()
            .iter()
            .copied()
            .filter(|v| candidates.map.place(*v) == Place::Corridor)
            .collect();
        let among = if corridors.is_empty() { candidates.open().to_vec() } else { corridors };
        candidates.prefer(among, self.among, stream)
    }
}
