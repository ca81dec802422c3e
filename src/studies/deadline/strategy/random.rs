//! Random strategy exploration, the baseline: "a random vertex among all vertices with one or more outgoing unvisited
//! edges", with a uniform distribution.

use super::{Candidates, uniform};
use crate::rng::Stream;
use crate::studies::deadline::toposemantic_map::VertexId;

pub(super) fn choose(candidates: &Candidates<'_>, stream: &mut Stream) -> Option<VertexId> {
    uniform(candidates.open(), stream)
}
