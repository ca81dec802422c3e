//! Trials on all cores. The only file that names the thread pool.
//!
//! A run takes four steps:
//! 1. Take the records that the store has.
//! 2. Execute a drawn share of them again, and refuse the store where one differs.
//! 3. Announce the run.
//! 4. Execute the other trials, each stored as soon as it is finished, and hand the records over in plan order.

use super::{Executor, Nondeterminism, Observer, RunEvent, StoreError, TrialStore};
use crate::digest::Sha256Digest;
use crate::rng::Seeds;
use crate::studies::{Outcome, TrialRecord, TrialSpec};
use rayon::prelude::*;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use thiserror::Error;

/// Why a run ended early. Trials that had finished are in the store.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RunError {
    /// The threads could not be had.
    #[error("could not start {jobs} threads: {problem}; try fewer --jobs")]
    Threads {
        /// How many were asked for.
        jobs: usize,
        /// The system's message.
        problem: String,
    },
    /// The store refused.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Records of the store are not what their trials give.
    #[error(
        "trial {}/{} (key {}): expected the record in the store (sha256:{}) to be what the trial gives, found sha256:{} when it \
         was executed again {}; {count} of {doubted} records that were drawn differ: the store was changed, or another program \
         wrote it, so nothing is sealed; remove the store (`reenact cache dir` says where it is), or run with --no-cache",
        first.condition, first.trial, first.key, first.first, first.second, first.divergence
    )]
    Poisoned {
        /// The first of them: the store's record, then the one that its trial gives.
        first: Box<Nondeterminism>,
        /// How many there are.
        count: usize,
        /// The number of records drawn.
        doubted: usize,
    },
    /// Whoever takes the records refused one.
    #[error(
        "records cannot be kept until they are sealed: {0}; free some space where the bundle is to be written"
    )]
    Untaken(String),
    /// Trials executed twice gave two records.
    #[error(
        "trial {}/{} (key {}): expected the same bytes twice, found sha256:{} and sha256:{} {}; {count} of {executed} \
         trials differ: the engine is not deterministic, so nothing is stored or sealed; please report it, with the \
         manifest and its inputs",
        first.condition, first.trial, first.key, first.first, first.second, first.divergence
    )]
    Nondeterministic {
        /// The first of them.
        first: Box<Nondeterminism>,
        /// How many there are.
        count: usize,
        /// The number of trials executed.
        executed: usize,
    },
}

/// A pool of its own, so that neither the environment nor other users of the thread pool matter.
#[derive(Debug)]
pub struct Scheduler {
    /// `None` where there are no threads, in WebAssembly: trials are then executed one after the other.
    pool: Option<rayon::ThreadPool>,
    /// The seed that draws the records of a store to be checked.
    doubt: Option<u64>,
}

/// Records that are in memory at a time, at most. The last trials of so many leave threads idle, which is little time where they are
/// this many.
const AT_ONCE: usize = 8192;

/// One in this many records of a store is executed again, and this many at least.
const DOUBTED: (usize, usize) = (200, 3);

impl Scheduler {
    /// Creates a scheduler of `jobs` threads, at least one.
    ///
    /// # Errors
    /// Where the system does not provide them.
    pub fn new(jobs: usize) -> Result<Self, RunError> {
        let jobs = jobs.max(1);
        let pool = if cfg!(target_family = "wasm") {
            None
        } else {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(jobs)
                .thread_name(|i| format!("trial-{i}"))
                .build()
                .map_err(|e| RunError::Threads { jobs, problem: e.to_string() })?;
            Some(pool)
        };
        Ok(Self { pool, doubt: None })
    }

    /// Returns the same scheduler, except that a small share of the records of a store is executed again and compared
    /// before it is believed: a 200th, three records at least, drawn with `seed`, which must not be predictable.
    #[must_use]
    pub fn doubting(self, seed: u64) -> Self {
        Self { doubt: Some(seed), ..self }
    }

    /// Returns the number of threads at work.
    pub fn jobs(&self) -> usize {
        self.pool.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// Does `work` on the threads of this scheduler. Where there are none, the thread pool falls back to the one there is.
    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Runs `plan` and returns the record of every trial in its order, whatever the order in which they finish.
    ///
    /// Records that `store` has are taken from it; every other is stored as soon as it is finished, so a killed run
    /// loses nothing but the trials under way. A panic becomes a record ([`TrialRecord::panicked`]) and is not stored.
    ///
    /// # Errors
    /// A refusal of the store, or a record of it that its trial does not give; trials not yet begun are then left out.
    pub fn run(
        &self,
        plan: &[TrialSpec],
        executor: &dyn Executor,
        store: Option<&dyn TrialStore>,
        observer: &dyn Observer,
    ) -> Result<Vec<TrialRecord>, RunError> {
        let mut records = Vec::with_capacity(plan.len());
        self.run_each(plan, executor, store, observer, &mut |record| {
            records.push(record);
            Ok(())
        })?;
        Ok(records)
    }

    /// Does the same, and hands each record to `take`, in the order of the plan: at most 8192 of them are in memory at a time.
    ///
    /// # Errors
    /// As [`Self::run`], and where `take` refuses one.
    pub fn run_each(
        &self,
        plan: &[TrialSpec],
        executor: &dyn Executor,
        store: Option<&dyn TrialStore>,
        observer: &dyn Observer,
        take: &mut dyn FnMut(TrialRecord) -> io::Result<()>,
    ) -> Result<(), RunError> {
        // 1. Stored records: of a plan that is larger, only which there are.
        let mut first: Option<Vec<Option<TrialRecord>>> = None;
        let known: Vec<bool> = if plan.len() <= AT_ONCE {
            let cached = self.recall(plan, store)?;
            let known = cached.iter().map(Option::is_some).collect();
            first = Some(cached);
            known
        } else {
            let is_known =
                |spec: &TrialSpec| store.map_or(Ok(false), |s| Ok(recall(s, spec)?.is_some()));
            self.install(|| plan.par_iter().map(is_known).collect::<Result<_, StoreError>>())?
        };
        // 2. Some of them again.
        let doubted = self.doubted(&known);
        self.check(plan, executor, store, &doubted)?;
        // 3. The run begins.
        observer.notice(&RunEvent::Started {
            trials: plan.len(),
            cached: known.iter().filter(|known| **known).count(),
            doubted: doubted.len(),
            jobs: self.jobs(),
        });
        // 4. The others.
        for (number, part) in plan.chunks(AT_ONCE).enumerate() {
            let cached = match first.take() {
                Some(cached) => cached,
                None => self.recall(part, store)?,
            };
            for record in self.finish(part, number * AT_ONCE, cached, executor, store, observer)? {
                take(record).map_err(|problem| RunError::Untaken(problem.to_string()))?;
            }
        }
        Ok(())
    }

    /// Returns what the store has of each trial of `plan`.
    fn recall(
        &self,
        plan: &[TrialSpec],
        store: Option<&dyn TrialStore>,
    ) -> Result<Vec<Option<TrialRecord>>, StoreError> {
        let Some(store) = store else { return Ok(vec![None; plan.len()]) };
        self.install(|| plan.par_iter().map(|spec| recall(store, spec)).collect())
    }

    /// Executes the trials at the places `doubted` again, and refuses a store whose records are not what they give.
    fn check(
        &self,
        plan: &[TrialSpec],
        executor: &dyn Executor,
        store: Option<&dyn TrialStore>,
        doubted: &[usize],
    ) -> Result<(), RunError> {
        let Some(store) = store else { return Ok(()) };
        let again = |&index: &usize| -> Result<Option<(TrialRecord, TrialRecord)>, StoreError> {
            // One that has vanished since is executed as if it had never been there.
            let Some(stored) = recall(store, &plan[index])? else { return Ok(None) };
            let fresh = attempt(executor, &plan[index]);
            Ok((fresh.to_line() != stored.to_line()).then_some((stored, fresh)))
        };
        let wrong: Vec<Option<(TrialRecord, TrialRecord)>> = self
            .install(|| doubted.par_iter().with_max_len(1).map(again).collect::<Result<_, _>>())?;
        let wrong: Vec<_> = wrong.into_iter().flatten().collect();
        match wrong.first() {
            Some((stored, fresh)) => Err(poisoned(stored, fresh, wrong.len(), doubted.len())),
            None => Ok(()),
        }
    }

    /// Executes what is not `cached` of a part of the plan that begins at `first`, and returns its records in its order.
    fn finish(
        &self,
        part: &[TrialSpec],
        first: usize,
        cached: Vec<Option<TrialRecord>>,
        executor: &dyn Executor,
        store: Option<&dyn TrialStore>,
        observer: &dyn Observer,
    ) -> Result<Vec<TrialRecord>, RunError> {
        self.install(|| {
            let finished = cached.into_par_iter().enumerate().with_max_len(1).map(|(i, cached)| {
                let is_cached = cached.is_some();
                let record = cached.unwrap_or_else(|| attempt(executor, &part[i]));
                if let (Some(store), false, true) =
                    (store, is_cached, record.outcome != Outcome::PANICKED)
                {
                    store.put(&record)?;
                }
                let index = first + i;
                observer.notice(&RunEvent::Finished { index, record: &record, cached: is_cached });
                Ok(record)
            });
            finished.collect()
        })
    }

    /// Draws the indices of the records of the store that are executed again, of those that are `known`.
    fn doubted(&self, known: &[bool]) -> Vec<usize> {
        let Some(seed) = self.doubt else { return Vec::new() };
        let known: Vec<usize> =
            known.iter().enumerate().filter(|(_, known)| **known).map(|(i, _)| i).collect();
        let (one_of, least) = DOUBTED;
        let count = (known.len() / one_of).max(least);
        let mut stream = Seeds::new(seed, Vec::new()).stream("doubted-records");
        stream.places(count, known.len()).into_iter().map(|place| known[place]).collect()
    }
}

fn poisoned(stored: &TrialRecord, fresh: &TrialRecord, count: usize, doubted: usize) -> RunError {
    let first = Nondeterminism {
        condition: stored.condition.slug(),
        trial: stored.trial,
        key: stored.key,
        first: Sha256Digest::of(stored.to_line()),
        second: Sha256Digest::of(fresh.to_line()),
        divergence: stored.parting(fresh),
    };
    RunError::Poisoned { first: Box::new(first), count, doubted }
}

/// Returns the stored record of `spec`.
fn recall(store: &dyn TrialStore, spec: &TrialSpec) -> Result<Option<TrialRecord>, StoreError> {
    let Some(mut record) = store.get(&spec.key)? else { return Ok(None) };
    // A key does not depend on the order in which a manifest writes its factors; the record's bytes do.
    record.condition.clone_from(&spec.condition);
    record.trial = spec.trial;
    Ok(Some(record))
}

/// Executes `spec` and returns its record, also where the executor panics.
pub(super) fn attempt(executor: &dyn Executor, spec: &TrialSpec) -> TrialRecord {
    catch_unwind(AssertUnwindSafe(|| executor.execute(spec))).unwrap_or_else(|payload| {
        let cause = payload
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| payload.downcast_ref::<&str>().copied())
            .unwrap_or("a panic without a message");
        TrialRecord::panicked(spec, cause.to_owned())
    })
}
