//! Parameters of the deadline study. Those the paper states have its values as default; what it leaves out has a default
//! here and, in our manifests, a `why`.

use super::graph_level::{GraphLevel, Simulation};
use super::intersection_detection::Perception;
use super::rules::Rules;
use crate::navigation::maneuver::PilotRule;
use crate::studies::deadline::build_cmdp::{Motion, Speed};
use crate::studies::parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Everything a trial needs besides robot, world and start.
    Parameters {
        /// Errors of actuators and sensors, and what the camera sees.
        sensing: Sensing = Sensing::default(),
        /// What the tags mean to the Intersection Detection System.
        perception: Perception = Perception::default(),
        /// How maneuvers are driven.
        pilot: PilotRule = PilotRule::default(),
        /// How the robot explores, plans and hurries.
        rules: Rules = Rules::default(),
        /// What a trial is and when it ends.
        mission: Mission = Mission::default(),
        /// The maneuver of an isolated passage; nothing to an exploration.
        passage: Passage = Passage::default(),
        /// What maneuvers take at graph level; nothing to a simulation of bodies.
        #[serde(skip_serializing_if = "is_default")]
        graph: GraphLevel = GraphLevel::default(),
    }
);

parameters!(
    /// Errors of actuators and sensors (section 6: "a 25% error is added to linear and angular velocity commands, and a 5%
    /// error is added to orientation readings"), and what the camera sees. The paper says neither how the errors are
    /// distributed nor how long one lasts.
    Sensing {
        /// Standard deviation of the Gaussian noise on ranges (m), 0 or more; `null` is the robot's own.
        #[schemars(range(min = 0.0))]
        range_noise_sd_m: Option<f64> = None,
        /// How the errors of the drive are distributed.
        drive_noise: ErrorShape = ErrorShape::Uniform,
        /// Size of the error of the executed linear speed, as a share of the command, 0 to 1: a bound where uniform, a
        /// standard deviation where Gaussian.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_linear: f64 = 0.25,
        /// Size of the error of the executed angular speed, as a share of the command, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_angular: f64 = 0.25,
        /// How long one error of the drive lasts (s), above 0: 0.1 is white at the control rate, 12 about one a maneuver.
        #[schemars(extend("exclusiveMinimum" = 0))]
        drive_noise_correlation_s: f64 = 0.1,
        /// How the errors of the compass are distributed.
        compass_noise: ErrorShape = ErrorShape::Uniform,
        /// Size of the error of the compass (degrees), 0 or more: 5 % of half a turn.
        #[schemars(range(min = 0.0, max = 180.0))]
        compass_noise_deg: f64 = 9.0,
        /// How long one error of the compass lasts (s), above 0: 0.1 is white at its rate.
        #[schemars(extend("exclusiveMinimum" = 0))]
        compass_noise_correlation_s: f64 = 0.1,
        /// Whether walls hide tags from the logical camera; Gazebo's sees through them.
        occlusion: Hiding = Hiding::None,
    }
);

/// How an error is distributed around zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorShape {
    /// Uniform between minus and plus its size.
    Uniform,
    /// Normal, its size the standard deviation.
    Gaussian,
}

/// What hides tags from the logical camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Hiding {
    /// Nothing.
    None,
    /// Walls.
    Walls,
}

/// What a trial is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// Algorithm 3: explore until the goal is reached.
    Exploration,
    /// One isolated maneuver, to measure what it takes.
    Passage,
}

parameters!(
    /// What a trial is and when it ends.
    Mission {
        /// Exploration towards the goal, or one isolated maneuver.
        task: Task = Task::Exploration,
        /// What an exploration is simulated by.
        #[serde(skip_serializing_if = "is_default")]
        simulation: Simulation = Simulation::Physics,
        /// The global temporal deadline T (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        deadline_s: f64 = 680.0,
        /// A trial that misses its deadline counts as stalled, not late, where it had found no new vertex for this long (s)
        /// before it, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stalled_after_s: f64 = 300.0,
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

/// Returns whether a parameter that came later is as it was before; the keys of trials leave it out then.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
