//! What an experiment needs of runs before its own: what a deadline study's planner expects of its maneuvers, measured by
//! running another manifest or taken from its trials in the store; and the maps of earlier explorations.

use super::load;
use super::progress::Progress;
use super::terminal::Terminal;
use crate::cmdp::build::{Expectation, Maneuvers};
use crate::manifest;
use crate::plan::Plan;
use crate::runner::{Scheduler, TrialStore};
use crate::store::DirectoryStore;
use crate::studies::deadline::Calibration;
use crate::studies::{self, TrialRecord, TrialSpec};
use std::path::Path;

/// How a calibration is had.
#[derive(Clone, Copy)]
pub(super) enum Calibrator<'a> {
    /// Simulate nothing: numbers stand in that enter no result.
    StandIn,
    /// From the store alone.
    Stored(&'a DirectoryStore),
    /// From the store, and by running what it has not.
    Run {
        /// Who runs it.
        scheduler: &'a Scheduler,
        /// Where finished trials are kept.
        store: Option<&'a DirectoryStore>,
    },
}

impl Calibrator<'_> {
    /// The calibration of the manifest at `path` as CSV.
    pub(super) fn csv(self, path: &Path, terminal: Terminal) -> Result<Vec<u8>, String> {
        if matches!(self, Self::StandIn) {
            return Ok(stand_in().to_csv().into_bytes());
        }
        let loaded = load::manifest(path, &[], Calibrator::StandIn, terminal)
            .map_err(|failure| failure.message)?;
        let plan = Plan::of(loaded.experiment);
        let records = match self {
            Self::StandIn => Vec::new(),
            Self::Stored(store) => stored(&plan, store, path)?,
            Self::Run { scheduler, store } => {
                let progress = Progress::of(&plan.trials, terminal).labelled(&plan.experiment.name);
                let progress = progress.interruptible(store.is_some());
                let store = store.map(|store| store as &dyn TrialStore);
                let records = scheduler.run(&plan.trials, &studies::execute, store, &progress);
                progress.finish();
                records.map_err(|e| e.to_string())?
            }
        };
        Calibration::of_trials(&plan.trials, &records)
            .map(|calibration| calibration.to_csv().into_bytes())
            .map_err(|e| e.to_string())
    }

    /// The map that the robot of `spec` ends with, as a descriptor and an image. One exploration takes about a second, so
    /// it is not kept in the store.
    pub(super) fn map(
        self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], String> {
        match self {
            Self::StandIn => manifest::unexplored(spec, sealed_as),
            Self::Stored(_) | Self::Run { .. } => manifest::explored(spec, sealed_as),
        }
    }
}

fn stored(
    plan: &Plan,
    store: &DirectoryStore,
    manifest: &Path,
) -> Result<Vec<TrialRecord>, String> {
    let mut records = Vec::new();
    for spec in &plan.trials {
        records.extend(store.get(&spec.key).map_err(|e| e.to_string())?);
    }
    if records.len() == plan.trials.len() {
        return Ok(records);
    }
    Err(format!(
        "{} of its {} passages have not run yet: `reenact run {}` runs them",
        plan.trials.len() - records.len(),
        plan.trials.len(),
        manifest.display()
    ))
}

/// What a check takes in place of measured pairs.
fn stand_in() -> Calibration {
    let pair =
        [Expectation { time_s: 10.0, failure: 0.01 }, Expectation { time_s: 6.0, failure: 0.02 }];
    Calibration::assumed(&Maneuvers { corridor: pair, door_left: pair, door_right: pair })
}
