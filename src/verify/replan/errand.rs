//! What a climb executes, so that others can execute it: workers that share no memory with whoever climbs.
//!
//! One climbs to level 3 and asks for the [`Errand`] of the level wanted; workers make the same errand of the same bundle, and
//! execute its trials by number; the first climbs again with what they [`Executed`], and compares. Whoever hands records in says
//! that they were executed for this climb: a store is none of that.

use super::{Reenactment, Study, plan_of};
use crate::bundle::Bundle;
use crate::digest::TrialKey;
use crate::manifest::Experiment;
use crate::plan::Plan;
use crate::runner::{StoreError, TrialStore};
use crate::studies::{self, TrialRecord, TrialSpec};
use crate::verify::{Made, Options, ReplanError, Replanned, reexecution};
use std::collections::{BTreeMap, BTreeSet};

/// The trials that a climb executes, each once: of the study, of its calibration, of the inference whose draws it runs, of rows of
/// its tables at other values. What is
/// explored or measured with fresh seeds is not among them.
#[derive(Debug)]
pub struct Errand {
    trials: Vec<TrialSpec>,
}

impl Errand {
    /// Returns how many trials there are.
    pub fn count(&self) -> usize {
        self.trials.len()
    }

    /// Executes the trial of that number, from 0; `None` where there is none.
    pub fn execute(&self, number: usize) -> Option<TrialRecord> {
        self.trials.get(number).map(studies::execute)
    }
}

/// Records that others executed for one climb.
#[derive(Debug, Default)]
pub struct Executed(BTreeMap<TrialKey, TrialRecord>);

impl Executed {
    /// Adds what a trial of the errand gave.
    pub fn add(&mut self, record: TrialRecord) {
        self.0.insert(record.key, record);
    }

    /// Returns how many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }
}

impl TrialStore for Executed {
    fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError> {
        Ok(self.0.get(key).cloned())
    }

    /// What is executed here is not asked for again.
    fn put(&self, _: &TrialRecord) -> Result<(), StoreError> {
        Ok(())
    }
}

impl<'o> Reenactment<'o> {
    /// Returns the same pipeline, except that trials which others `executed` for its climb are not executed here.
    #[must_use]
    pub fn with_executed(self, executed: &'o Executed) -> Self {
        Self { executed: Some(executed), ..self }
    }

    /// Returns what a climb of `bundle` with these `options` executes.
    ///
    /// # Errors
    /// Where the bundle's manifest makes no plan.
    pub fn errand(&self, bundle: &Bundle, options: &Options) -> Result<Errand, ReplanError> {
        let (plan, selection) = plan_of(bundle)?;
        let (scheduler, observer) = (&self.scheduler, self.observer);
        let study = Study { bundle, plan, selection, scheduler, observer, executed: None };
        let (level, indices) = reexecution::chosen(options, study.plan.trials.len());
        let mut trials: Vec<TrialSpec> =
            indices.iter().map(|&index| study.plan.trials[index].clone()).collect();
        for earlier in study.earlier() {
            trials.extend(study.units(earlier.made, &earlier.drawn(level, options)));
        }
        let mut known = BTreeSet::new();
        trials.retain(|spec| known.insert(spec.key));
        Ok(Errand { trials })
    }
}

impl Study<'_> {
    /// Returns the trials of the units at `indices` of what was `made` before. What makes no plan is none of them: the climb says why.
    fn units(&self, made: Made, indices: &[usize]) -> Vec<TrialSpec> {
        let experiment = &self.plan.experiment;
        let plans = |plans: &mut dyn Iterator<Item = Plan>| plans.flat_map(|p| p.trials).collect();
        match made {
            Made::Passages => {
                let Some(run) = experiment.calibration.as_deref() else { return Vec::new() };
                let plan = Plan::of(run.experiment.clone());
                indices.iter().filter_map(|&i| plan.trials.get(i).cloned()).collect()
            }
            Made::Proposals => {
                let Some(run) = experiment.inference() else { return Vec::new() };
                let plan = Plan::of(Experiment::clone(&run.experiment));
                indices.iter().filter_map(|&i| plan.trials.get(i).cloned()).collect()
            }
            Made::Robustness => {
                let Some(known) = &experiment.sensitivity else { return Vec::new() };
                let runs = known.table.runs();
                let rows = indices.iter().filter_map(|&i| runs.get(i));
                plans(&mut rows.filter_map(|run| self.varied_plan(run).ok()))
            }
            Made::Multiverse => {
                let Some(known) = &experiment.multiverse else { return Vec::new() };
                let choices = experiment.choices();
                let rows = indices.iter().filter_map(|&i| known.table.runs().nth(i));
                let overrides = rows.map(|draw| known.table.overrides(draw, &choices));
                plans(&mut overrides.filter_map(|values| self.plan_with_values(values).ok()))
            }
        }
    }
}
