//! Parameters of the deadline study. Those the paper states have its values as default; what it leaves out has a default
//! here and, in our manifests, a `why`.

use super::mission::Task;
use crate::cmdp::build::{Motion, Speed};
use crate::studies::parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Everything a trial needs besides robot, world and start.
    Parameters {
        /// Errors of actuators and sensors, and what the camera sees.
        sensing: Sensing = Sensing::default(),
        /// What a trial is and when it ends.
        mission: Mission = Mission::default(),
        /// The maneuver of an isolated passage; nothing to an exploration.
        passage: Passage = Passage::default(),
    }
);

parameters!(
    /// Errors of actuators and sensors (section 6: 25 % on velocity commands, 5 % on orientation readings).
    Sensing {
        /// Standard deviation of the Gaussian noise on ranges (m), 0 or more; `null` is the robot's own.
        #[schemars(range(min = 0.0))]
        range_noise_sd_m: Option<f64> = None,
        /// Size of the error of the executed linear speed, as a share of the command, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_linear: f64 = 0.25,
        /// Size of the error of the executed angular speed, as a share of the command, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_angular: f64 = 0.25,
        /// How long one error of the drive lasts (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        drive_noise_correlation_s: f64 = 0.1,
    }
);

parameters!(
    /// What a trial is and when it ends.
    Mission {
        /// Exploration towards the goal, or one isolated maneuver.
        task: Task = Task::Exploration,
        /// The global temporal deadline T (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        deadline_s: f64 = 680.0,
    }
);

parameters!(
    /// One isolated maneuver, from a random vertex of the building where it is possible to the next.
    Passage {
        /// What is done.
        motion: Motion = Motion::Corridor,
        /// How fast.
        speed: Speed = Speed::Slow,
        /// Largest offset across and along at the beginning (m), 0 or more, uniform.
        #[schemars(range(min = 0.0))]
        offset_m: f64 = 0.2,
        /// Largest error of heading at the beginning (degrees), 0 or more, uniform.
        #[schemars(range(min = 0.0, max = 90.0))]
        heading_error_deg: f64 = 10.0,
        /// Simulated time after which a passage is given up (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        time_limit_s: f64 = 120.0,
    }
);
