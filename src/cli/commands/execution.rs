//! Executing a plan: with the store or without, once or twice.

use crate::bundle::wall_time::WallTimes;
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::Failure;
use crate::cli::forecast::Forecast;
use crate::cli::progress::Progress;
use crate::cli::terminal::{Terminal, counted};
use crate::plan::Plan;
use crate::provenance::{Environment, TrialWatch, most_jobs, processors, unforeseen_seed};
use crate::runner::{Executor, Observer, RunEvent, Scheduler, TrialStore, Twice};
use crate::store::DirectoryStore;
use crate::studies::{self, TrialRecord, TrialSpec};
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Threads, and the store of finished trials.
#[derive(Debug)]
pub(super) struct Execution {
    scheduler: Scheduler,
    store: Option<DirectoryStore>,
}

/// What is to be said of a plan's execution beside its records.
pub(super) struct Account {
    /// How many of them the store held.
    pub(super) cached: usize,
    /// How many of those were executed again, and gave the same bytes.
    pub(super) doubted: usize,
    /// Of the others that did not fail.
    pub(super) times: WallTimes,
}

/// How the trials of a plan are executed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Times {
    /// Once, unless the store has them.
    Once,
    /// Once, whatever the store has; nothing is kept.
    Anew,
    /// Twice, whatever the store has, to find what is not deterministic; nothing is kept.
    Twice,
}

/// Returns how many threads `--jobs` asks for: all processors by default, and never more than there is any use for.
pub(super) fn jobs(asked: Option<usize>, terminal: Terminal) -> Result<usize, Failure> {
    match asked {
        None => Ok(processors()),
        Some(0) => Err(Failure::not_understood("`--jobs` must be at least 1, found 0")),
        Some(asked) if asked > most_jobs() => {
            let most = most_jobs();
            terminal.note(&format!(
                "note: --jobs {asked}: {most} threads are started, the most that {} can use",
                counted(processors(), "processor")
            ));
            Ok(most)
        }
        Some(asked) => Ok(asked),
    }
}

impl Execution {
    /// Starts `jobs` threads, all processors by default, and opens the store unless it is not to be used.
    pub(super) fn new(
        jobs: Option<usize>,
        no_cache: bool,
        environment: &Environment,
    ) -> Result<Self, Failure> {
        // Whoever asked for more was told ([`jobs`]).
        let jobs = jobs.unwrap_or_else(processors).min(most_jobs());
        let scheduler = Scheduler::new(jobs).map_err(Failure::failed)?;
        let scheduler = scheduler.doubting(unforeseen_seed());
        let store = if no_cache {
            None
        } else {
            let root = environment.store().map_err(Failure::not_understood)?;
            let store = DirectoryStore::new(root);
            store.sweep();
            Some(store)
        };
        Ok(Self { scheduler, store })
    }

    /// Returns how many threads are at work.
    pub(super) fn jobs(&self) -> usize {
        self.scheduler.jobs()
    }

    /// Returns who runs the calibration that a manifest asks for.
    pub(super) fn calibrator(&self) -> Calibrator<'_> {
        Calibrator::Run { scheduler: &self.scheduler, store: self.store.as_ref() }
    }

    /// Foretells the run of `plan` by what the store has of it.
    pub(super) fn forecast(&self, plan: &Plan) -> Result<Forecast, Failure> {
        let looked = self.store.as_ref().map(DirectoryStore::look).transpose();
        let looked = looked.map_err(Failure::failed)?;
        Forecast::of(plan, looked.as_ref()).map_err(Failure::failed)
    }

    /// Returns the record of every trial of `plan`, in its order.
    pub(super) fn execute(
        &self,
        plan: &Plan,
        times: Times,
        terminal: Terminal,
    ) -> Result<Vec<TrialRecord>, Failure> {
        let mut records = Vec::with_capacity(plan.trials.len());
        self.execute_each(plan, times, terminal, &mut |record| {
            records.push(record);
            Ok(())
        })?;
        Ok(records)
    }

    /// Hands the record of every trial of `plan` to `take`, in its order.
    pub(super) fn execute_each(
        &self,
        plan: &Plan,
        times: Times,
        terminal: Terminal,
        take: &mut dyn FnMut(TrialRecord) -> io::Result<()>,
    ) -> Result<Account, Failure> {
        let store = self.store.as_ref().filter(|_| times == Times::Once);
        let progress = Progress::of(&plan.trials, terminal)
            .labelled(&plan.experiment.name)
            .interruptible(store.is_some());
        let (cached, doubted) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let walls = Mutex::new(WallTimes::new());
        // A million of them take a hundred megabytes: only for claims about them.
        let is_timed = plan.experiment.claims.iter().any(|claim| claim.circumstance);
        let observer = |event: &RunEvent<'_>| {
            match event {
                RunEvent::Started { cached: known, doubted: again, .. } => {
                    cached.store(*known, Ordering::Relaxed);
                    doubted.store(*again, Ordering::Relaxed);
                }
                // One that was only doubted is not measured: it stands for none of the others.
                RunEvent::Finished { cached: true, record, .. } => {
                    walls.lock().unwrap_or_else(PoisonError::into_inner).remove(&record.key);
                }
                RunEvent::Finished { .. } => {}
            }
            progress.notice(event);
        };
        let timed = |spec: &TrialSpec| {
            if !is_timed {
                return studies::execute(spec);
            }
            let mut watch = TrialWatch::start();
            let record = studies::execute_timed(spec, &mut watch);
            let time = watch.stop();
            walls.lock().unwrap_or_else(PoisonError::into_inner).insert(spec.key, time);
            record
        };
        let twice = (times == Times::Twice).then(|| Twice::new(&timed));
        let executor: &dyn Executor = match &twice {
            Some(twice) => twice,
            None => &timed,
        };
        let store = store.map(|store| store as &dyn TrialStore);
        let done = self.scheduler.run_each(&plan.trials, executor, store, &observer, take);
        progress.finish();
        for warning in self.store.iter().flat_map(DirectoryStore::warnings) {
            terminal.warning(&warning);
        }
        done.map_err(Failure::failed)?;
        if let Some(twice) = twice {
            twice.verdict(plan.trials.len()).map_err(Failure::failed)?;
        }
        Ok(Account {
            cached: cached.into_inner(),
            doubted: doubted.into_inner(),
            times: walls.into_inner().unwrap_or_else(PoisonError::into_inner),
        })
    }
}
