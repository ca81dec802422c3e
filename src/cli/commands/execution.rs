//! Executing a plan: with the store or without, once or twice.

use crate::cli::exit::Failure;
use crate::cli::progress::Progress;
use crate::cli::terminal::Terminal;
use crate::plan::Plan;
use crate::provenance::Environment;
use crate::runner::{Executor, Observer, RunEvent, Scheduler, TrialStore, Twice};
use crate::store::DirectoryStore;
use crate::studies::{self, TrialRecord};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How trials are executed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Execution {
    /// Whether finished trials are taken from the store and kept there; never where they are executed twice.
    pub(super) store: bool,
    /// Whether every trial is executed twice, to find what is not deterministic.
    pub(super) twice: bool,
}

/// The record of every trial of `plan`, in its order, and how many of them the store had.
pub(super) fn execute(
    plan: &Plan,
    scheduler: &Scheduler,
    how: Execution,
    environment: &Environment,
    terminal: Terminal,
) -> Result<(Vec<TrialRecord>, usize), Failure> {
    let kept = if how.store && !how.twice {
        Some(DirectoryStore::new(environment.store().map_err(Failure::not_understood)?))
    } else {
        None
    };
    let progress = Progress::new(terminal);
    let cached = AtomicUsize::new(0);
    let observer = |event: &RunEvent<'_>| {
        if let RunEvent::Started { cached: known, .. } = event {
            cached.store(*known, Ordering::Relaxed);
        }
        progress.notice(event);
    };
    let twice = how.twice.then(|| Twice::new(&studies::execute));
    let executor: &dyn Executor = match &twice {
        Some(twice) => twice,
        None => &studies::execute,
    };
    let store = kept.as_ref().map(|store| store as &dyn TrialStore);
    let records = scheduler.run(&plan.trials, executor, store, &observer);
    progress.finish();
    let records = records.map_err(Failure::failed)?;
    if let Some(twice) = twice {
        twice.verdict(records.len()).map_err(Failure::failed)?;
    }
    Ok((records, cached.into_inner()))
}
