//! The studies that Reenact re-enacts, behind one door: what a trial needs, what it yields.
//!
//! A study is a folder here and one arm of [`Setup`]; the two never import one another. What all of them
//! share, the trial's identity and its record, is in this module.

pub mod deadline;
mod dictionary;
mod factor_value;
mod findings;
pub mod outcomes;
pub mod prior_map;
mod published_scatter;
mod record;
pub mod recording;
mod requests;
mod state_chain;

pub use dictionary::Dictionary;
pub use factor_value::FactorValue;
pub use findings::Findings;
pub use published_scatter::{PublishedScatter, Scale};
pub use record::{
    CHAIN_STEP_S, Outcome, SeriesPoint, TrialRecord, first_divergence, records_digest,
};
pub use requests::{FigureLayout, FigureRequest, TableLayout, TableRequest, coverage_tables};

use crate::digest::TrialKey;
use crate::geometry::Pose;
use crate::rng::Seeds;
use crate::robot::Robot;
use crate::world::World;
use serde_json::{Value, json};
use std::sync::Arc;

/// A group of parameters: a struct that a manifest may write in part, every field with its default.
macro_rules! parameters {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty = $default:expr,)* }) => {
        $(#[$doc])*
        #[derive(
            Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
        )]
        #[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    };
}
pub(crate) use parameters;

/// Which study a manifest describes: a closed set.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum StudyKind {
    /// Susa Rincon and Carpin 2019: exploration under a deadline.
    Deadline,
    /// Luperto et al. 2020: exploration with prior knowledge.
    PriorMap,
}

/// One cell of the design: a value for every factor, in the manifest's order.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Condition(pub Vec<(String, String)>);

impl Condition {
    /// The value of `factor`.
    pub fn value(&self, factor: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == factor).map(|(_, value)| value.as_str())
    }

    /// A file name for this cell: the values joined by underscores, `all` where there is no factor.
    /// Only `[A-Za-z0-9.-]` of each value survive; resolution refuses manifests where two cells clash.
    pub fn slug(&self) -> String {
        let safe = |value: &String| {
            value
                .chars()
                .map(|c| if c.is_ascii_alphanumeric() || ".-".contains(c) { c } else { '-' })
                .collect::<String>()
        };
        let parts: Vec<_> = self.0.iter().map(|(_, value)| safe(value)).collect();
        if parts.is_empty() { "all".to_owned() } else { parts.join("_") }
    }
}

impl std::fmt::Display for Condition {
    /// `prior=floor-plan environment=basic`, as people read it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts: Vec<_> = self.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
        f.write_str(&parts.join(" "))
    }
}

/// Everything one trial needs, by study.
#[derive(Debug, Clone)]
pub enum Setup {
    /// A trial of the prior-knowledge study.
    PriorMap(Arc<prior_map::Setup>),
    /// A trial of the deadline study.
    Deadline(Arc<deadline::Setup>),
}

impl StudyKind {
    /// Every study.
    pub const ALL: [Self; 2] = [Self::Deadline, Self::PriorMap];

    /// The name in manifests, keys and streams.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deadline => "deadline",
            Self::PriorMap => "prior-map",
        }
    }
}

impl Setup {
    /// The true world.
    pub fn world(&self) -> &World {
        match self {
            Self::PriorMap(setup) => &setup.world,
            Self::Deadline(setup) => &setup.world,
        }
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        match self {
            Self::PriorMap(setup) => &setup.robot,
            Self::Deadline(setup) => &setup.robot,
        }
    }

    /// Where the robot begins, in the world's frame (m, rad).
    pub fn start(&self) -> Pose {
        match self {
            Self::PriorMap(setup) => setup.start,
            Self::Deadline(setup) => setup.start,
        }
    }

    /// The study's parameters, defaults written out.
    pub fn parameters(&self) -> Value {
        match self {
            Self::PriorMap(setup) => json!(setup.parameters),
            Self::Deadline(setup) => json!(setup.parameters),
        }
    }

    /// What the deadline study's planner expects of its maneuvers.
    pub fn calibration(&self) -> Option<&deadline::Calibration> {
        match self {
            Self::PriorMap(_) => None,
            Self::Deadline(setup) => setup.calibration.as_deref(),
        }
    }

    /// What else a trial depends on, by name: nothing of it is in robot, world, prior, start or parameters.
    pub fn further(&self) -> serde_json::Map<String, Value> {
        let calibration = self.calibration().into_iter();
        calibration.map(|known| ("maneuvers".to_owned(), known.to_json())).collect()
    }
}

/// One trial, self-contained: executing it is a pure function of this value.
#[derive(Debug, Clone)]
pub struct TrialSpec {
    /// Identity: digest of everything below and the engine version.
    pub key: TrialKey,
    /// The cell it belongs to.
    pub condition: Condition,
    /// Number within the cell, from 0.
    pub trial: u32,
    /// Where its random streams come from.
    pub seeds: Seeds,
    /// What it runs.
    pub setup: Setup,
}

/// Times parts of a trial, for claims about the machine. No record depends on it.
pub trait Stopwatch {
    /// A mind is asked what to do next.
    fn asked(&mut self);
    /// To answer, it chose where to go.
    fn chose(&mut self);
}

/// Nobody takes the time.
impl Stopwatch for () {
    fn asked(&mut self) {}
    fn chose(&mut self) {}
}

/// Runs a trial: a pure function of `spec`.
pub fn execute(spec: &TrialSpec) -> TrialRecord {
    execute_timed(spec, &mut ())
}

/// Runs a trial under the eyes of `watch`. The record is the one that [`execute`] yields.
pub fn execute_timed(spec: &TrialSpec, watch: &mut dyn Stopwatch) -> TrialRecord {
    match &spec.setup {
        Setup::PriorMap(setup) => prior_map::run(spec, setup, None, watch),
        Setup::Deadline(setup) => deadline::run(spec, setup, None, watch),
    }
}

/// Runs a trial and writes down what a replay shows. The record is the one that [`execute`] yields.
pub fn reenact(spec: &TrialSpec) -> (TrialRecord, recording::Recording) {
    reenact_into(spec, recording::Recording::default())
}

/// Runs a trial and writes down what a replay shows and every scan. The record is the one that [`execute`] yields.
pub fn reenact_sensing(spec: &TrialSpec) -> (TrialRecord, recording::Recording) {
    let sensed = Some(Vec::new());
    reenact_into(spec, recording::Recording { sensed, ..recording::Recording::default() })
}

fn reenact_into(
    spec: &TrialSpec,
    mut recording: recording::Recording,
) -> (TrialRecord, recording::Recording) {
    let record = match &spec.setup {
        Setup::PriorMap(setup) => prior_map::run(spec, setup, Some(&mut recording), &mut ()),
        Setup::Deadline(setup) => deadline::run(spec, setup, Some(&mut recording), &mut ()),
    };
    (record, recording)
}
