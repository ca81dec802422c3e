//! What an experiment needs of runs before its own: the passages by which a deadline study's planner knows what to expect of
//! its maneuvers, driven here or taken from the store; and the maps of earlier explorations.

use super::progress::Progress;
use super::terminal::Terminal;
use crate::manifest::{self, Experiment, Measured};
use crate::plan::Plan;
use crate::runner::{Scheduler, TrialStore};
use crate::store::DirectoryStore;
use crate::studies::deadline::PlannedPassages;
use crate::studies::{self, TrialRecord, TrialSpec};

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
    /// The passages of `calibration`.
    pub(super) fn passages(
        self,
        calibration: &Experiment,
        terminal: Terminal,
    ) -> Result<Measured, String> {
        if matches!(self, Self::StandIn) {
            return Ok(Measured::StandIn);
        }
        let plan = Plan::of(calibration.clone());
        let records = match self {
            Self::StandIn => Vec::new(),
            Self::Stored(store) => stored(&plan, store)?,
            Self::Run { scheduler, store } => {
                let progress = Progress::of(&plan.trials, terminal).labelled(&plan.experiment.name);
                let progress = progress.interruptible(store.is_some());
                let store = store.map(|store| store as &dyn TrialStore);
                let records = scheduler.run(&plan.trials, &studies::execute, store, &progress);
                progress.finish();
                records.map_err(|e| e.to_string())?
            }
        };
        let planned = PlannedPassages::of(plan.experiment.design(), plan.experiment.trials);
        let showed = planned.and_then(|planned| planned.showed(&records));
        showed
            .map(|passages| Measured::Passages(passages.to_csv().into_bytes()))
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

fn stored(plan: &Plan, store: &DirectoryStore) -> Result<Vec<TrialRecord>, String> {
    let mut records = Vec::new();
    for spec in &plan.trials {
        records.extend(store.get(&spec.key).map_err(|e| e.to_string())?);
    }
    if records.len() == plan.trials.len() {
        return Ok(records);
    }
    let manifest = plan.experiment.document.sources.first().map_or("", |source| &source.name);
    Err(format!(
        "{} of its {} passages have not run yet: `reenact run {manifest}` runs them",
        plan.trials.len() - records.len(),
        plan.trials.len(),
    ))
}
