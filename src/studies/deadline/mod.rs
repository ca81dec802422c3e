//! The deadline study: J. L. Susa Rincon, S. Carpin, "Time constrained exploration using toposemantic spatial models: a
//! reproducible approach", IEEE Robotics and Automation Magazine 26(3), 2019.
//!
//! A Pioneer 3-AT explores a building towards a goal room under a global deadline, on a semantic topological oriented map
//! (Definition 1) without any metric; legs are planned as a constrained MDP.

pub mod calibration;
mod in_situ;
mod mission;
mod parameters;
mod requests;
pub mod results;

pub use calibration::Calibration;
pub use mission::{Task, measures, run};
pub use parameters::{Mission, Parameters, Passage, Sensing};
pub use requests::{ManeuverTable, OutcomeTable, Percent, Quantity};

use crate::geometry::Pose;
use crate::robot::Robot;
use crate::world::World;
use std::sync::Arc;

/// Everything a trial of this study needs.
#[derive(Debug)]
pub struct Setup {
    /// The true world.
    pub world: Arc<World>,
    /// The robot.
    pub robot: Arc<Robot>,
    /// Where the robot begins, in the world's frame (m, rad).
    pub start: Pose,
    /// The planner's expectations; `None` for isolated passages, which measure them.
    pub calibration: Option<Arc<Calibration>>,
    /// Everything else.
    pub parameters: Parameters,
}
