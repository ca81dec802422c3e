//! Prior knowledge as conditions use it, and what it means.

use super::document::UnknownAs;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use crate::digest::{Hasher, MeaningDigest};
use crate::geometry::Pose;
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::json;
use crate::robot::Robot;
use crate::studies::prior_map::Parameters;
use crate::studies::prior_map::tour::TopoMetricMap;
use serde_json::Value;
use std::sync::Arc;

/// Something could not be had; the faults say why.
#[derive(Debug)]
pub(super) struct Told;

/// Prior knowledge as a condition uses it.
#[derive(Clone)]
pub(super) enum Knowledge {
    /// A map.
    Map(UsedPrior),
    /// A graph, what it means and what it was read from.
    TopoMetric(Arc<TopoMetricMap>, MeaningDigest, Value),
}

impl Knowledge {
    /// Returns the map, where it is one.
    pub(super) fn map(&self) -> Option<&UsedPrior> {
        match self {
            Self::Map(map) => Some(map),
            Self::TopoMetric(..) => None,
        }
    }

    /// Returns the graph, where it is one.
    pub(super) fn topo_metric_map(&self) -> Option<Arc<TopoMetricMap>> {
        match self {
            Self::Map(_) => None,
            Self::TopoMetric(graph, ..) => Some(Arc::clone(graph)),
        }
    }

    /// Returns the digest of what it means.
    pub(super) fn meaning(&self) -> MeaningDigest {
        match self {
            Self::Map(map) => map.meaning,
            Self::TopoMetric(_, meaning, _) => *meaning,
        }
    }

    /// Returns what it was resolved from.
    pub(super) fn described(&self) -> Value {
        match self {
            Self::Map(map) => map.described.clone(),
            Self::TopoMetric(.., described) => described.clone(),
        }
    }
}

/// A prior map as a condition uses it.
#[derive(Clone)]
pub(super) struct UsedPrior {
    pub(super) grid: Arc<OccupancyGrid>,
    pub(super) meaning: MeaningDigest,
    pub(super) described: Value,
    /// Where it is written.
    pub(super) pointer: String,
    /// Whether it was derived from the condition's own world, and so lies on it.
    pub(super) own: bool,
}

/// What a robot explores with which settings: a condition's own trials, or an exploration before them.
#[derive(Clone, Copy)]
pub(super) struct Exploration<'a> {
    /// The condition that decides all choices, also for what went before.
    pub(super) condition: &'a Condition,
    pub(super) world: &'a UsedWorld,
    pub(super) robot: &'a Arc<Robot>,
    pub(super) start: Pose,
    pub(super) parameters: &'a Parameters,
}

/// Returns `grid` at `frame`, its unknown cells as `unknown` says, and the digest of what that means.
pub(super) fn read_as(
    grid: &OccupancyGrid,
    frame: GridFrame,
    unknown: UnknownAs,
) -> (Arc<OccupancyGrid>, MeaningDigest) {
    let unknown = match unknown {
        UnknownAs::Unknown => Occupancy::Unknown,
        UnknownAs::Free => Occupancy::Free,
        UnknownAs::Occupied => Occupancy::Occupied,
    };
    let cells = grid
        .values()
        .iter()
        .map(|&cell| if cell == Occupancy::Unknown { unknown } else { cell })
        .collect();
    let grid = OccupancyGrid::from_cells(frame, cells);
    let meaning = meaning(&grid);
    (Arc::new(grid), meaning)
}

/// Computes the digest of where a grid lies and what it holds.
pub(super) fn meaning(grid: &OccupancyGrid) -> MeaningDigest {
    let mut hasher = Hasher::new();
    hasher.update(b"reenact-grid-1\0").update(json::canonical_of(grid.frame())).update([0]);
    let cells: Vec<u8> = grid
        .values()
        .iter()
        .map(|cell| match cell {
            Occupancy::Unknown => b'?',
            Occupancy::Free => b'.',
            Occupancy::Occupied => b'#',
        })
        .collect();
    MeaningDigest(hasher.update(cells).digest())
}
