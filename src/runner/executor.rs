//! The executor of trials.

use crate::digest::Sha256Digest;
use crate::studies::{Outcome, TrialRecord, TrialSpec};

/// A pure function from a trial to its record. It may panic: the scheduler makes a record of that.
pub trait Executor: Sync {
    /// Executes one trial.
    fn execute(&self, spec: &TrialSpec) -> TrialRecord;
}

impl<F: Fn(&TrialSpec) -> TrialRecord + Sync> Executor for F {
    fn execute(&self, spec: &TrialSpec) -> TrialRecord {
        self(spec)
    }
}

/// An executor that simulates nothing: a record made of the trial's key, for tests of everything around the simulation.
#[derive(Debug, Clone, Default)]
pub struct Mock {
    /// Trial numbers that panic.
    pub panicking: Vec<u32>,
}

impl Executor for Mock {
    fn execute(&self, spec: &TrialSpec) -> TrialRecord {
        assert!(!self.panicking.contains(&spec.trial), "trial {} was told to fail", spec.trial);
        let state =
            |step: u8| Sha256Digest::of(format!("{}/{step}", spec.key)).hex()[..16].to_owned();
        TrialRecord {
            key: spec.key,
            condition: spec.condition.clone(),
            trial: spec.trial,
            outcome: Outcome::EXPLORED,
            cause: String::new(),
            measures: [("distance-m".to_owned(), Some(f64::from(spec.key.0.0[0]) / 4.0))].into(),
            series: Vec::new(),
            sim_seconds: 30.0,
            chain: (0..3).map(state).collect(),
        }
    }
}
