//! The rules of the mind as parameters of the study: what sections 4 and 5 state as default, and choices where they state
//! none.

use super::build_cmdp::SideCorridors;
use super::planner::Planning;
use super::schedule::Schedule;
use super::strategy::{CompleteCorridor, CorridorsFirst, Frontier, NormalizedFrontier, Strategy};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) use crate::studies::parameters;

parameters!(
    /// How the robot explores, navigates and hurries (sections 4 and 5).
    Rules {
        /// Which vertex to go to next (section 5).
        strategy: Strategy = Strategy::Random,
        /// K: how many vertices the map has before the strategy begins to choose (section 4: 3), at least 1. The vertex
        /// at which the robot starts counts, the paper does not say otherwise: K = 3 are two moves or more.
        #[schemars(range(min = 1))]
        initial_vertices: u32 = 3,
        /// Which edges the random moves before there are K vertices take. The paper says "randomly moves around".
        initial_edges: InitialEdges = InitialEdges::Unexplored,
        /// Topological frontier.
        frontier: Frontier = Frontier::default(),
        /// Topological frontier with normalised distances.
        normalized_frontier: NormalizedFrontier = NormalizedFrontier::default(),
        /// Semantic: explore corridors first.
        corridors_first: CorridorsFirst = CorridorsFirst::default(),
        /// Semantic: complete corridors first.
        complete_corridor: CompleteCorridor = CompleteCorridor::default(),
        /// The local temporal deadline t_d.
        schedule: Schedule = Schedule::default(),
        /// The speed of moves that no plan covers: following an edge (v, v∅) at the end of each iteration of Algorithm 3,
        /// and the moves before there are K vertices. The paper gives none; slow, because nothing bounds their time,
        /// and because the printed tables fit slow better.
        unplanned_speed: UnplannedSpeed = UnplannedSpeed::Slow,
        /// By which of the six maneuvers of section 6 a robot turns from one corridor into another: that of a door, as those
        /// of corridors keep the orientation.
        side_corridors: SideCorridors = SideCorridors::Door,
        /// Planning the way to a vertex (section 3, Algorithm 2).
        planner: Planning = Planning::default(),
    }
);

/// Which edges random moves take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum InitialEdges {
    /// Unexplored ones, where the vertex has any: a move that explores nothing adds no vertex.
    Unexplored,
    /// Any.
    Any,
}

/// The speed of moves that no plan covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnplannedSpeed {
    /// Always slow.
    Slow,
    /// Always fast.
    Fast,
    /// Fast where the slow maneuver is expected to take longer than the schedule would give one edge.
    Schedule,
}
