//! The studies that Reenact re-enacts, behind one door: what a trial needs, what it yields.
//!
//! A study is a folder here and an entry in [`STUDIES`] ([`Study`] says what that takes); no two import one another. What
//! all of them share, the trial's identity and its record, is in this module.

mod calibrating;
mod cannot_begin;
mod columns;
pub mod deadline;
mod dictionary;
mod drawn;
mod exhibit;
mod factor_value;
mod findings;
#[cfg(test)]
pub(crate) mod fixture;
pub mod inference;
mod ledger;
mod measures;
mod outcome;
pub mod outcomes;
pub mod prior_map;
mod published_scatter;
mod record;
pub mod recording;
mod requests;
mod state_chain;
mod study;
pub mod wander;

pub use calibrating::{
    Calibrated, Calibrating, CalibrationError, Design, Expectations, PlannedCalibration,
    planned_calibration,
};
pub use cannot_begin::CannotBegin;
pub use columns::Columns;
pub use dictionary::Dictionary;
pub use drawn::Drawn;
pub use exhibit::{Exhibit, Grid, GridCell, GridRow, Layout, Lines, Measured, Set, Source};
pub use factor_value::FactorValue;
pub use findings::Findings;
pub use ledger::{Entry, Group, Ledger};
pub use measures::Measures;
pub use outcome::{End, Outcome};
pub use published_scatter::{PublishedScatter, Scale};
pub use record::{
    CHAIN_STEP_S, RecordError, SeriesPoint, TrialRecord, first_divergence, records_digest,
};
pub use requests::{FigureLayout, FigureRequest, TableLayout, TableRequest, coverage_tables};
pub use study::{
    ConditionAsWritten, Graph, Prior, Remark, Setup, Stopwatch, Study, StudyKind, StudySetup,
    Surroundings,
};

use crate::condition::Condition;
use crate::digest::TrialKey;
use crate::rng::Seeds;

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

/// Every study, in the order in which messages name them.
pub const STUDIES: &[&dyn Study] = &[&deadline::Deadline, &prior_map::PriorMap, &wander::Wander];

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

/// Runs a trial: a pure function of `spec`.
pub fn execute(spec: &TrialSpec) -> TrialRecord {
    execute_timed(spec, &mut ())
}

/// Runs a trial under the eyes of `watch`. The record is the one that [`execute`] yields.
pub fn execute_timed(spec: &TrialSpec, watch: &mut dyn Stopwatch) -> TrialRecord {
    spec.setup.run(spec, None, watch)
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
    let record = spec.setup.run(spec, Some(&mut recording), &mut ());
    record.outcome.name().clone_into(&mut recording.outcome);
    let robot = spec.setup.robot();
    recording.description = robot.as_urdf();
    recording.scan_height_m = robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
    // Who explores for its own sake has no goal, whatever the world names.
    let mut goals = spec.setup.world().goals.values().filter(|_| recording.deadline_s.is_some());
    recording.goal = goals.next().copied().filter(|_| goals.next().is_none());
    (record, recording)
}
