//! Every trial twice: this finds an engine that is not deterministic.

use super::scheduler::attempt;
use super::{Executor, RunError};
use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::{TrialRecord, TrialSpec};
use std::sync::{Mutex, PoisonError};

/// An executor that executes every trial twice with another one and remembers the trials whose records differ.
///
/// Run it without a store: a record that is in doubt must not be kept.
pub struct Twice<'a> {
    executor: &'a dyn Executor,
    differing: Mutex<Vec<Nondeterminism>>,
}

/// A trial that gave two records.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Nondeterminism {
    /// The slug of its condition.
    pub condition: String,
    /// Its number in the condition.
    pub trial: u32,
    /// Its key.
    pub key: TrialKey,
    /// Digest of the first record.
    pub first: Sha256Digest,
    /// Digest of the second.
    pub second: Sha256Digest,
    /// Where they diverge, in words.
    pub divergence: String,
}

impl<'a> Twice<'a> {
    /// Creates an executor that executes with `executor`, twice.
    pub fn new(executor: &'a dyn Executor) -> Self {
        Self { executor, differing: Mutex::new(Vec::new()) }
    }

    /// Returns whether every trial so far gave the same bytes twice, out of `executed`.
    ///
    /// # Errors
    /// [`RunError::Nondeterministic`] with the first trial, by condition and number, that did not.
    pub fn verdict(self, executed: usize) -> Result<(), RunError> {
        let mut differing = self.differing.into_inner().unwrap_or_else(PoisonError::into_inner);
        differing.sort();
        let count = differing.len();
        match differing.into_iter().next() {
            None => Ok(()),
            Some(first) => {
                Err(RunError::Nondeterministic { first: Box::new(first), count, executed })
            }
        }
    }
}

impl Executor for Twice<'_> {
    /// Executes twice and returns the first of the two records.
    fn execute(&self, spec: &TrialSpec) -> TrialRecord {
        // Panics are caught here: one that comes only once is a difference too.
        let (first, second) = (attempt(self.executor, spec), attempt(self.executor, spec));
        let (first_line, second_line) = (first.to_line(), second.to_line());
        if first_line != second_line {
            let difference = Nondeterminism {
                condition: spec.condition.slug(),
                trial: spec.trial,
                key: spec.key,
                first: Sha256Digest::of(first_line),
                second: Sha256Digest::of(second_line),
                divergence: first.parting(&second),
            };
            self.differing.lock().unwrap_or_else(PoisonError::into_inner).push(difference);
        }
        first
    }
}
