//! Trials on all cores. The only file that names the thread pool.
//!
//! A run takes four steps:
//! 1. Take the records that the store has.
//! 2. Execute a drawn share of them again, and refuse the store where one differs.
//! 3. Announce the run.
//! 4. Execute the other trials, each stored as soon as it is finished, and return the records in plan order.

use super::{Executor, Nondeterminism, Observer, RunEvent, StoreError, TrialStore};
use crate::digest::Sha256Digest;
use crate::rng::Seeds;
use crate::studies::{Outcome, TrialRecord, TrialSpec};
use rayon::prelude::*;
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
    pool: rayon::ThreadPool,
    /// The seed that draws the records of a store to be checked.
    doubt: Option<u64>,
}

/// One in this many records of a store is executed again, and this many at least.
const DOUBTED: (usize, usize) = (200, 3);

impl Scheduler {
    /// Creates a scheduler of `jobs` threads, at least one.
    ///
    /// # Errors
    /// Where the system does not provide them.
    pub fn new(jobs: usize) -> Result<Self, RunError> {
        let jobs = jobs.max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(jobs)
            .thread_name(|i| format!("trial-{i}"))
            .build()
            .map_err(|e| RunError::Threads { jobs, problem: e.to_string() })?;
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
        self.pool.current_num_threads()
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
        self.pool.install(|| {
            // 1. Stored records.
            let cached: Vec<Option<TrialRecord>> = plan
                .par_iter()
                .map(|spec| store.map_or(Ok(None), |store| recall(store, spec)))
                .collect::<Result<_, _>>()?;
            let known = cached.iter().flatten().count();
            // 2. Some of them again.
            let doubted = self.doubted(&cached);
            let wrong: Vec<(usize, TrialRecord)> = doubted
                .par_iter()
                .with_max_len(1)
                .filter_map(|&index| {
                    let fresh = attempt(executor, &plan[index]);
                    let stored = cached[index].as_ref()?;
                    (fresh.to_line() != stored.to_line()).then_some((index, fresh))
                })
                .collect();
            if let Some((index, fresh)) = wrong.first()
                && let Some(stored) = &cached[*index]
            {
                return Err(poisoned(stored, fresh, wrong.len(), doubted.len()));
            }
            // 3. The run begins.
            observer.notice(&RunEvent::Started {
                trials: plan.len(),
                cached: known,
                doubted: doubted.len(),
                jobs: self.jobs(),
            });
            // 4. The others.
            let finished =
                cached.into_par_iter().enumerate().with_max_len(1).map(|(index, cached)| {
                    let is_cached = cached.is_some();
                    let record = cached.unwrap_or_else(|| attempt(executor, &plan[index]));
                    if let (Some(store), false, true) =
                        (store, is_cached, record.outcome != Outcome::PANICKED)
                    {
                        store.put(&record)?;
                    }
                    observer.notice(&RunEvent::Finished {
                        index,
                        record: &record,
                        cached: is_cached,
                    });
                    Ok(record)
                });
            finished.collect()
        })
    }

    /// Draws the indices of the records of the store that are executed again.
    fn doubted(&self, cached: &[Option<TrialRecord>]) -> Vec<usize> {
        let Some(seed) = self.doubt else { return Vec::new() };
        let known: Vec<usize> =
            cached.iter().enumerate().filter(|(_, c)| c.is_some()).map(|(i, _)| i).collect();
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
