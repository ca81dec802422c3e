//! Topological frontier: "sorts all nodes by the number of outgoing unexplored edges, and it randomly selects one among
//! those with the highest number".

use super::{Candidates, Preference, least, uniform};
use crate::rng::Stream;
use crate::studies::deadline::rules::parameters;
use crate::studies::deadline::toposemantic_map::VertexId;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Topological frontier.
    Frontier {
        /// Which of several vertices with the highest number of unexplored edges: `uniform`, as the paper says.
        ties: Ties = Ties::Uniform,
    }
);

/// Which of several equally good vertices.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Ties {
    /// Any of them ("a uniform distribution among all candidates is used").
    Uniform,
    /// The nearest ("we choose a closer vertex when one or more equivalent ones are present", said of the next strategy);
    /// any of those.
    Nearest,
}

impl Frontier {
    pub(super) fn choose(
        &self,
        candidates: &Candidates<'_>,
        stream: &mut Stream,
    ) -> Option<VertexId> {
        let highest = least(candidates.open().to_vec(), |v| usize::MAX - candidates.degree(v));
        match self.ties {
            Ties::Uniform => uniform(&highest, stream),
            Ties::Nearest => candidates.prefer(highest, Preference::Nearest, stream),
        }
    }
}
