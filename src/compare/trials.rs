//! Trials of both sides, paired and compared.

use super::account::{Told, TrialAccount};
use super::{
    Account, Change, ConditionAccount, Discrepancy, Matching, MeasureChange, Tolerances,
    TrialDifference,
};
use crate::digest::TrialKey;
use crate::studies::first_divergence;
use std::collections::{BTreeMap, BTreeSet};

/// Trials of two accounts held against one another.
#[derive(Debug, Default)]
pub(super) struct Trials {
    pub(super) differences: Vec<Discrepancy>,
    pub(super) matching: Matching,
    /// Trials whose numbers differ by no more than was admitted.
    pub(super) tolerated: usize,
}

/// Compares every trial that both sides list. A trial is found by its key, and where no trial of the other side
/// has it, by the slug of its condition and its number.
pub(super) fn compare(a: &Account, b: &Account, tolerances: &Tolerances) -> Trials {
    let mut trials = Trials::default();
    let by_key: BTreeMap<TrialKey, (&str, &TrialAccount)> = all(b).map(|t| (t.1.key, t)).collect();
    let by_name: BTreeMap<(&str, u32), &TrialAccount> =
        all(b).map(|(slug, trial)| ((slug, trial.number), trial)).collect();
    let mut found: BTreeSet<(&str, u32)> = BTreeSet::new();
    let listed_by = |other: &Account, slug: &str, number: u32| {
        other.condition(slug).is_some_and(|c| lists(c, number))
    };
    for (slug, trial) in all(a) {
        let same = by_key.get(&trial.key);
        let other = match same {
            Some((slug, other)) => {
                trials.matching.by_key += 1;
                found.insert((slug, other.number));
                Some(*other)
            }
            None => by_name.get(&(slug, trial.number)).map(|other| {
                trials.matching.by_number += 1;
                found.insert((slug, trial.number));
                *other
            }),
        };
        match other {
            Some(other) => trials.pair(slug, trial, other, tolerances),
            // A side that does not list a trial has not lost it.
            None if listed_by(b, slug, trial.number) => {
                trials.differences.push(alone(slug, trial, true));
            }
            None => {}
        }
    }
    for (slug, trial) in all(b) {
        if !found.contains(&(slug, trial.number)) && listed_by(a, slug, trial.number) {
            trials.differences.push(alone(slug, trial, false));
        }
    }
    trials
}

fn all(account: &Account) -> impl Iterator<Item = (&str, &TrialAccount)> {
    account.conditions.iter().flat_map(|c| c.known.iter().map(|trial| (c.slug.as_str(), trial)))
}

/// Returns whether `condition` would list its trial `number` if it had it: a bundle lists all, a lock trial 0 only.
fn lists(condition: &ConditionAccount, number: u32) -> bool {
    condition.known.len() == condition.trials || condition.known.iter().any(|t| t.number == number)
}

impl Trials {
    fn pair(&mut self, slug: &str, a: &TrialAccount, b: &TrialAccount, tolerances: &Tolerances) {
        if a.sha256 == b.sha256 && a.key == b.key && (a.told.is_none() || b.told.is_none()) {
            return;
        }
        let (told_a, told_b) = (a.told(), b.told());
        let diverges_after = first_divergence(&told_a.chain, &told_b.chain);
        let outcomes = (outcome(told_a), outcome(told_b));
        let is_same = a.sha256 == b.sha256
            && a.key == b.key
            && outcomes.0 == outcomes.1
            && told_a.measures == told_b.measures
            && diverges_after.is_none();
        if is_same {
            return;
        }
        let names: BTreeSet<&str> =
            told_a.measures.names().chain(told_b.measures.names()).collect();
        let mut measures = Vec::new();
        for name in names {
            let (from, to) = (told_a.measures.number(name), told_b.measures.number(name));
            let admitted = match (from, to) {
                (Some(from), Some(to)) => tolerances.admits(name, from, to),
                (from, to) => from == to,
            };
            if !admitted {
                measures.push(MeasureChange { name: name.to_owned(), change: Change { from, to } });
            }
        }
        let outcome = (outcomes.0 != outcomes.1).then(|| Change::new(outcomes.0, outcomes.1));
        // Where tolerances are declared, states and curves may differ with the numbers.
        if outcome.is_none() && measures.is_empty() && !tolerances.is_none() {
            self.tolerated += 1;
            return;
        }
        self.differences.push(Discrepancy::Trial(TrialDifference {
            condition: slug.to_owned(),
            number: a.number,
            key: Change::new(a.key, b.key),
            sha256: Change::new(a.sha256, b.sha256),
            outcome,
            measures,
            diverges_after,
        }));
    }
}

fn outcome(trial: &Told) -> String {
    match trial.cause.as_str() {
        "" => trial.outcome.clone(),
        cause => format!("{} ({cause})", trial.outcome),
    }
}

fn alone(slug: &str, trial: &TrialAccount, gone: bool) -> Discrepancy {
    fn side<T>(value: T, gone: bool) -> Change<T> {
        if gone {
            Change { from: Some(value), to: None }
        } else {
            Change { from: None, to: Some(value) }
        }
    }
    Discrepancy::Trial(TrialDifference {
        condition: slug.to_owned(),
        number: trial.number,
        key: side(trial.key, gone),
        sha256: side(trial.sha256, gone),
        outcome: Some(side(outcome(trial.told()), gone)),
        measures: Vec::new(),
        diverges_after: None,
    })
}
