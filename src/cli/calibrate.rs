//! What an experiment needs of runs before its own: the trials of its calibration, run here or taken from the store; and the
//! maps of earlier explorations.

use super::progress::Progress;
use super::terminal::Terminal;
use crate::manifest::{self, CalibrationTrials, Experiment, ExploreError};
use crate::plan::Plan;
use crate::runner::{RunError, Scheduler, StoreError, TrialStore};
use crate::store::DirectoryStore;
use crate::studies::{self, CalibrationError, TrialRecord, TrialSpec};
use std::cell::RefCell;

/// Why there are no passages.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unmeasured {
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Unfit(#[from] CalibrationError),
    #[error("{left} of its {of} passages have not run yet: `reenact run {manifest}` runs them")]
    NotRun { left: usize, of: usize, manifest: String },
}

/// How a calibration is had.
#[derive(Clone, Copy)]
pub(super) enum Calibrator<'a> {
    /// Simulate nothing: numbers stand in that enter no result.
    StandIn,
    /// From the store alone.
    Stored(&'a DirectoryStore),
    /// From the store where it has all of it; else numbers stand in that enter no result, and it is noted what is not there.
    AtHand(&'a DirectoryStore, &'a RefCell<Option<Unmeasured>>),
    /// From the store, and by running what it has not.
    Run {
        /// Who runs it.
        scheduler: &'a Scheduler,
        /// Where finished trials are kept.
        store: Option<&'a DirectoryStore>,
    },
}

impl Calibrator<'_> {
    /// Returns what the trials of `calibration` showed.
    pub(super) fn trials(
        self,
        calibration: &Experiment,
        terminal: Terminal,
    ) -> Result<CalibrationTrials, Unmeasured> {
        if matches!(self, Self::StandIn) {
            return Ok(CalibrationTrials::StandIn);
        }
        let plan = Plan::of(calibration.clone());
        let records = match self {
            Self::StandIn => Vec::new(),
            Self::Stored(store) => stored(&plan, store)?,
            Self::AtHand(store, missing) => match stored(&plan, store) {
                Err(error @ Unmeasured::NotRun { .. }) => {
                    missing.replace(Some(error));
                    return Ok(CalibrationTrials::StandIn);
                }
                records => records?,
            },
            Self::Run { scheduler, store } => {
                let progress = Progress::of(&plan.trials, terminal).labelled(&plan.experiment.name);
                let progress = progress.interruptible(store.is_some());
                let store = store.map(|store| store as &dyn TrialStore);
                let records = scheduler.run(&plan.trials, &studies::execute, store, &progress);
                progress.finish();
                records?
            }
        };
        Ok(CalibrationTrials::shown_by(&plan.experiment, &records)?)
    }

    /// Returns the map that the robot of `spec` ends with, as a descriptor and an image. One exploration takes about a
    /// second, so it is not kept in the store.
    pub(super) fn map(
        self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], ExploreError> {
        match self {
            Self::StandIn => manifest::unexplored(spec, sealed_as),
            Self::Stored(_) | Self::AtHand(..) | Self::Run { .. } => {
                manifest::explored(spec, sealed_as)
            }
        }
    }
}

fn stored(plan: &Plan, store: &DirectoryStore) -> Result<Vec<TrialRecord>, Unmeasured> {
    let (store, mut records) = (store.look()?, Vec::new());
    for spec in &plan.trials {
        records.extend(store.get(&spec.key)?);
    }
    if records.len() == plan.trials.len() {
        return Ok(records);
    }
    let source = plan.experiment.document.sources.first();
    Err(Unmeasured::NotRun {
        left: plan.trials.len() - records.len(),
        of: plan.trials.len(),
        manifest: source.map_or_else(String::new, |source| source.name.to_string()),
    })
}
