//! Topological frontier with normalised distances: the vertex with the highest
//!
//! S(v) = γ deg(v) / max deg(v') - (1 - γ) d(v) / max d(v'),   v' ∈ 𝒱
//!
//! where deg(v) is the number of unexplored edges and d(v) the number of edges to it.

use super::{Candidates, Preference};
use crate::rng::Stream;
use crate::studies::deadline::rules::parameters;
use crate::studies::deadline::toposemantic_map::VertexId;

/// Values of S that differ by no more are equal: γ/2 and γ - γ/2 need not be the same number.
const EQUAL: f64 = 1e-12;

parameters!(
    /// Topological frontier with normalised distances.
    NormalizedFrontier {
        /// γ, the weight of unexplored edges against distance, 0 to 1 (section 5: 0.5).
        #[schemars(range(min = 0.0, max = 1.0))]
        gamma: f64 = 0.5,
    }
);

impl NormalizedFrontier {
    /// Chooses the closer one of several vertices with the highest value, as the paper says; of several closest any.
    pub(super) fn choose(
        &self,
        candidates: &Candidates<'_>,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let values = self.values(candidates);
        let highest = values.iter().fold(f64::NEG_INFINITY, |highest, (_, s)| highest.max(*s));
        let best: Vec<VertexId> =
            values.iter().filter(|(_, s)| *s >= highest - EQUAL).map(|(v, _)| *v).collect();
        candidates.prefer(best, Preference::Nearest, stream)
    }

    /// Computes S(v) of every candidate, in order of discovery. Where all distances are zero, so is the term of
    /// distance.
    pub(super) fn values(&self, candidates: &Candidates<'_>) -> Vec<(VertexId, f64)> {
        let degree = |v: VertexId| candidates.degree(v);
        let distance = |v: VertexId| candidates.distance(v);
        let open = candidates.open();
        let max_degree = open.iter().map(|v| degree(*v)).max().unwrap_or(0);
        let max_distance = open.iter().map(|v| distance(*v)).max().unwrap_or(0);
        open.iter()
            .map(|v| {
                let s = self.gamma * share(degree(*v), max_degree)
                    - (1.0 - self.gamma) * share(distance(*v), max_distance);
                (*v, s)
            })
            .collect()
    }
}

#[expect(clippy::cast_precision_loss, reason = "edges of a building are few")]
fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}
