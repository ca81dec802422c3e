//! A third study, small enough to read in one sitting: a robot that drives straight ahead, turns by a random angle
//! where it is blocked, and stops when its time is up. It re-enacts no paper. `docs/architecture.md` walks through it
//! as the pattern of a study; `manifests/wander.yaml` runs it.

mod mind;
mod mission;
mod study;

pub use study::Wander;

use crate::geometry::Pose;
use crate::robot::Robot;
use crate::studies::parameters;
use crate::world::World;
use std::sync::Arc;

parameters!(
    /// Everything a trial needs besides robot, world and start.
    Parameters {
        /// How the robot drives.
        driving: Driving = Driving::default(),
        /// When a trial ends, and what it measures.
        mission: Mission = Mission::default(),
    }
);

parameters!(
    /// How the robot drives.
    Driving {
        /// Speed on the straight (m/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        linear_m_s: f64 = 0.4,
        /// Speed of a turn on the spot (rad/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        angular_rad_s: f64 = 1.0,
        /// The way is blocked where the scanner sees something nearer than this (m), above 0, within 35 degrees of straight
        /// ahead.
        #[schemars(extend("exclusiveMinimum" = 0))]
        clearance_m: f64 = 0.6,
    }
);

parameters!(
    /// When a trial ends, and what it measures.
    Mission {
        /// Simulated time after which a trial ends (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        time_limit_s: f64 = 120.0,
        /// Side of the cells in which floor is counted (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        cell_m: f64 = 0.1,
    }
);

/// Everything the trials of a condition need.
#[derive(Debug)]
pub struct Setup {
    /// The true world.
    pub world: Arc<World>,
    /// The robot.
    pub robot: Arc<Robot>,
    /// Where the robot begins, in the world's frame (m, rad).
    pub start: Pose,
    /// Everything else.
    pub parameters: Parameters,
}
