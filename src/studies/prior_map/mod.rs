//! The prior-knowledge study: M. Luperto, M. Antonazzi, F. Amigoni, N. A. Borghese, "Robot exploration of
//! indoor environments using incomplete and inaccurate prior knowledge", Robotics and Autonomous Systems 2020.
//!
//! A lidar robot maps an indoor environment; the next frontier maximises u(p) (equations 1 to 4), whose
//! information gain I(p) may use a prior map (section 3.2).

pub mod agreement;
mod cell_tests;
pub mod choice;
pub mod effects;
pub mod explorer;
mod field_of_view;
pub mod frontier;
mod gain_memory;
pub mod information_gain;
pub mod measures;
mod mission;
mod parameters;
mod phase;
mod ray_field;
mod rays;
pub mod readings;
mod released_gain;
mod requests;
pub mod results;
mod study;
mod terrain;
pub mod tour;
pub mod utility;

pub use cell_tests::{CellTests, Difference};
pub use measures::least_of;
pub use study::PriorMap;

pub use parameters::{
    Candidate, Coverage, CoverageMapCells, Crossing, Exploration, Gain, MapFrame, Mapping,
    Measurement, Mission, Navigation, Origin, Parameters, ReferenceMap, Replan, Reselect,
    SearchFrom, Sensing, Strategy, View,
};
pub use requests::{
    AgreementTable, CoverageCurve, CoverageTable, EffectsTable, MeasuresTable, Metric, PlanFigure,
    ReadingsTable,
};

use crate::digest::MeaningDigest;
use crate::geometry::Pose;
use crate::grid::OccupancyGrid;
use crate::robot::Robot;
use crate::studies::CannotBegin;
use crate::world::World;
use std::sync::{Arc, OnceLock};
use tour::TopoMetricMap;

pub use mission::columns;
pub use mission::{
    FURTHER_AT_MILESTONES, MILESTONES, NoMap, POSE_ERRORS, Prepared, SharedReference, at_level,
    coverage_at_distance, explored_map, is_coverage_at_distance, level_of, run,
};

/// A map that coverage is counted against.
#[derive(Debug, Clone)]
pub struct CoverageMap {
    /// The map, in the world's frame.
    pub map: Arc<OccupancyGrid>,
    /// What it means: where it lies and what it holds.
    pub meaning: MeaningDigest,
}

/// Everything that a trial of this study needs.
#[derive(Debug)]
pub struct Setup {
    /// The true world.
    pub world: Arc<World>,
    /// The robot.
    pub robot: Arc<Robot>,
    /// Prior knowledge PK_E, aligned to the world's frame; `None` for the strategy without.
    pub prior: Option<Arc<OccupancyGrid>>,
    /// Prior knowledge of the other kind, a graph in the world's frame, for `strategy: topo-metric-tour`.
    pub topo_metric_map: Option<Arc<TopoMetricMap>>,
    /// The robot's first pose, in the world's frame (m, rad).
    pub start: Pose,
    /// Everything else.
    pub parameters: Parameters,
    /// The map that coverage is counted against, where the manifest names one.
    pub coverage_map: Option<CoverageMap>,
    /// The reference of coverage, perhaps shared with other setups.
    reference: SharedReference,
    prepared: OnceLock<Result<Prepared, CannotBegin>>,
}

impl Setup {
    /// Creates a setup; nothing is computed yet.
    pub fn new(
        world: Arc<World>,
        robot: Arc<Robot>,
        prior: Option<Arc<OccupancyGrid>>,
        start: Pose,
        parameters: Parameters,
    ) -> Self {
        Self {
            world,
            robot,
            prior,
            topo_metric_map: None,
            start,
            parameters,
            coverage_map: None,
            reference: SharedReference::default(),
            prepared: OnceLock::new(),
        }
    }

    /// Returns the same setup, measured against `reference` together with others that differ in prior knowledge and
    /// `exploration` only.
    #[must_use]
    pub fn with_reference(self, reference: SharedReference) -> Self {
        Self { reference, ..self }
    }

    /// Returns the same setup with a topo-metric map.
    #[must_use]
    pub fn with_topo_metric_map(self, map: Option<Arc<TopoMetricMap>>) -> Self {
        Self { topo_metric_map: map, ..self }
    }

    /// Returns the same setup, its coverage counted against `map` in the world's frame.
    #[must_use]
    pub fn with_coverage_map(self, map: Option<CoverageMap>) -> Self {
        Self { coverage_map: map, ..self }
    }

    /// Returns the frame of the robot's map, a pose in the world's (m, rad): cells begin at its origin.
    pub fn map_frame(&self) -> Pose {
        let half = self.parameters.mapping.resolution_m / 2.0;
        match self.parameters.mapping.origin {
            Origin::Corner => self.start,
            Origin::Centre => self.start.compose(Pose::new(-half, -half, 0.0)),
        }
    }

    /// Returns the scanner's range for computing a gain, in cells of the robot's map; 0 without a scanner.
    pub fn gain_range_cells(&self) -> i32 {
        let (sensing, mapping) = (&self.parameters.sensing, &self.parameters.mapping);
        let own = self.robot.lidar.as_ref().map_or(0.0, |lidar| lidar.max_range);
        let range = sensing.range_m.unwrap_or(own);
        let range = mapping.clip_range_m.map_or(range, |clip| clip.min(range));
        #[expect(clippy::cast_possible_truncation, reason = "ranges are checked to be below 200 m")]
        let cells = (range / mapping.resolution_m).round() as i32;
        cells
    }

    /// Returns the data that all trials of this setup share, computed at the first request.
    ///
    /// # Errors
    /// Where the setup cannot run at all, which resolution refuses with a better message.
    pub fn prepared(&self) -> Result<&Prepared, CannotBegin> {
        self.prepared.get_or_init(|| Prepared::new(self)).as_ref().map_err(Clone::clone)
    }
}
