//! Progress as data.

use crate::studies::TrialRecord;

/// Something that happened during a run. Trials finish in any order; `index` is the position in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunEvent<'a> {
    /// The run begins.
    Started {
        /// Trials in the plan.
        trials: usize,
        /// How many of them the store holds already.
        cached: usize,
        /// How many of those were executed again before they were believed, and gave the same bytes.
        doubted: usize,
        /// Threads at work.
        jobs: usize,
    },
    /// A trial has its record; if it was executed and did not panic, the store has it too.
    Finished {
        /// Position in the plan.
        index: usize,
        /// Its record.
        record: &'a TrialRecord,
        /// Whether the store had it.
        cached: bool,
    },
}

/// A receiver of progress. Called from the threads that run trials.
pub trait Observer: Sync {
    /// Takes note of `event`.
    fn notice(&self, event: &RunEvent<'_>);
}

impl<F: Fn(&RunEvent<'_>) + Sync> Observer for F {
    fn notice(&self, event: &RunEvent<'_>) {
        self(event);
    }
}

/// An observer that ignores everything.
#[derive(Debug, Clone, Copy)]
pub struct Silent;

impl Observer for Silent {
    fn notice(&self, _event: &RunEvent<'_>) {}
}
