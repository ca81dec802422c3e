//! The deadline study: J. L. Susa Rincon, S. Carpin, "Time-constrained exploration using toposemantic spatial models: a
//! reproducible approach to measurable robotics", IEEE Robotics & Automation Magazine 26(3), 2019, pages 78 to 87.
//!
//! A Pioneer 3-AT explores a building towards a goal room under a global deadline, on a semantic topological oriented map
//! (Definition 1) without any metric; legs are planned as a constrained MDP.

pub mod build_cmdp;
#[cfg(test)]
mod building;
pub mod calibration;
pub mod columns;
pub mod exploration;
mod graph_level;
mod in_situ;
pub mod intersection;
pub mod intersection_detection;
mod mission;
pub mod navigation;
mod parameters;
pub mod planner;
mod requests;
mod rules;
pub mod schedule;
pub mod strategy;
mod study;
pub mod toposemantic_map;

pub use calibration::Calibration;
pub use graph_level::{GraphLevel, Simulation, is_entry};
pub use in_situ::ManeuverRow;
pub use intersection_detection::{IntersectionDetectionSystem, Perception};
pub use mission::{Calibrations, run, tag_scheme};
pub use parameters::{ErrorShape, Hiding, Mission, Parameters, Passage, Sensing, Task};
pub use requests::{ManeuverTable, PolicyGraph};
pub use rules::{InitialEdges, Rules, UnplannedSpeed};
pub use study::Deadline;

use crate::geometry::Pose;
use crate::robot::Robot;
use crate::studies::CannotBegin;
use crate::world::World;
use mission::{Isolated, Prepared};
use std::sync::{Arc, OnceLock};

/// Everything that a trial of this study needs.
#[derive(Debug)]
pub struct Setup {
    /// The true world.
    pub world: Arc<World>,
    /// The robot.
    pub robot: Arc<Robot>,
    /// The robot's first pose, in the world's frame (m, rad).
    pub start: Pose,
    /// The planner's expectations; `None` for isolated passages, which measure them.
    pub calibration: Option<Arc<Calibration>>,
    /// Everything else.
    pub parameters: Parameters,
    prepared: OnceLock<Result<Prepared, CannotBegin>>,
}

impl Setup {
    /// Creates a setup; nothing is computed yet.
    pub fn new(
        world: Arc<World>,
        robot: Arc<Robot>,
        start: Pose,
        calibration: Option<Arc<Calibration>>,
        parameters: Parameters,
    ) -> Self {
        Self { world, robot, start, calibration, parameters, prepared: OnceLock::new() }
    }

    /// Returns the data that all trials of this setup share, computed at the first request.
    ///
    /// # Errors
    /// Where the setup cannot run at all, which resolution refuses with a better message.
    pub fn prepared(&self) -> Result<&Prepared, CannotBegin> {
        self.prepared.get_or_init(|| Prepared::new(self)).as_ref().map_err(Clone::clone)
    }
}
