//! What an experiment needs of runs before its own: the trials of its calibration and of the inference whose draws it runs, run here
//! or taken from the store; and the maps of earlier explorations.

use super::progress::Progress;
use super::terminal::Terminal;
use crate::manifest::{self, CalibrationTrials, Experiment, ExploreError, ProposalTrials};
use crate::plan::Plan;
use crate::runner::{RunError, Scheduler, StoreError, TrialStore};
use crate::store::DirectoryStore;
use crate::studies::{self, CalibrationError, TrialRecord, TrialSpec};
use std::cell::RefCell;

/// Why there are no passages, or no proposals.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unmeasured {
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Unfit(#[from] CalibrationError),
    #[error(
        "{left} of its {of} {trials} have not run yet: `reenact {command} {manifest}` runs them"
    )]
    NotRun {
        left: usize,
        of: usize,
        /// What its trials are called.
        trials: &'static str,
        command: &'static str,
        manifest: String,
    },
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
        let plan = Plan::of(calibration.clone());
        match self.records(&plan, terminal)? {
            None => Ok(CalibrationTrials::StandIn),
            Some(records) => Ok(CalibrationTrials::shown_by(&plan.experiment, &records)?),
        }
    }

    /// Returns what the trials of `inference` proposed.
    pub(super) fn proposals(
        self,
        inference: &Experiment,
        terminal: Terminal,
    ) -> Result<ProposalTrials, Unmeasured> {
        let records = self.records(&Plan::of(inference.clone()), terminal)?;
        Ok(records.map_or(ProposalTrials::StandIn, |records| ProposalTrials::of(&records)))
    }

    /// Returns the record of every trial of `plan`; `None` where nothing is run and numbers stand in.
    fn records(
        self,
        plan: &Plan,
        terminal: Terminal,
    ) -> Result<Option<Vec<TrialRecord>>, Unmeasured> {
        match self {
            Self::StandIn => Ok(None),
            Self::Stored(store) => stored(plan, store).map(Some),
            Self::AtHand(store, missing) => match stored(plan, store) {
                Err(error @ Unmeasured::NotRun { .. }) => {
                    // What is named first is what the rest waits for.
                    missing.borrow_mut().get_or_insert(error);
                    Ok(None)
                }
                records => records.map(Some),
            },
            Self::Run { scheduler, store } => {
                let progress = Progress::of(&plan.trials, terminal).labelled(&plan.experiment.name);
                let progress = progress.interruptible(store.is_some());
                let store = store.map(|store| store as &dyn TrialStore);
                let records = scheduler.run(&plan.trials, &studies::execute, store, &progress);
                progress.finish();
                Ok(Some(records?))
            }
        }
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
    let infers = plan.experiment.document.node("/infer").is_some();
    let (trials, command) = if infers { ("proposals", "infer") } else { ("passages", "run") };
    Err(Unmeasured::NotRun {
        left: plan.trials.len() - records.len(),
        of: plan.trials.len(),
        trials,
        command,
        manifest: source.map_or_else(String::new, |source| source.name.to_string()),
    })
}
