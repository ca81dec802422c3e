//! What the trials of a run came to, column by column: a number takes eight bytes here, and a record that is held whole some
//! thousands.

use super::{Outcome, SeriesPoint, TrialRecord};
use crate::condition::Condition;
use crate::digest::TrialKey;
use std::collections::BTreeMap;

/// The trials of a run in plan order, without their state hashes.
///
/// ```
/// use reenact::bundle::{Bundle, Limits};
/// use reenact::studies::Ledger;
///
/// let zip = std::fs::read("artifacts/quickstart-published.zip").unwrap();
/// let bundle = Bundle::read(&zip, &Limits::default()).unwrap();
/// let ledger = Ledger::of(&bundle.records().unwrap());
/// assert_eq!(ledger.len(), 20);
/// let first = ledger.entries().next().unwrap();
/// assert_eq!(first.condition().value("prior"), Some("none"));
/// assert!(first.number("distance-m") > Some(0.0));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ledger {
    groups: Vec<Group>,
    trials: usize,
}

/// Trials of one condition that follow one another.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    condition: Condition,
    keys: Vec<TrialKey>,
    numbers: Vec<u32>,
    /// How each ended: a place in `outcomes`.
    ended: Vec<u16>,
    /// Each once, in the order of their first trial.
    outcomes: Vec<Outcome>,
    /// Simulated time (s).
    sim_seconds: Vec<f64>,
    /// By the trial's place; of those that say one.
    causes: BTreeMap<usize, String>,
    /// By name; NaN where a trial never got there or says nothing of it. Shorter than `keys` where the last trials say nothing.
    measures: BTreeMap<String, Vec<f64>>,
    /// The curves; shorter than `keys` where the last trials have none.
    series: Vec<Box<[SeriesPoint]>>,
}

impl Ledger {
    /// Creates the ledger of `records`, which stand in plan order.
    pub fn of(records: &[TrialRecord]) -> Self {
        let mut ledger = Self::default();
        for record in records {
            ledger.enter(record);
        }
        ledger
    }

    /// Enters the record of the next trial of the plan.
    pub fn enter(&mut self, record: &TrialRecord) {
        self.trials += 1;
        match self.groups.last_mut() {
            Some(group) if group.condition == record.condition => group.enter(record),
            _ => {
                let mut group = Group::new(record.condition.clone());
                group.enter(record);
                self.groups.push(group);
            }
        }
    }

    /// Estimates how much memory (bytes) the record of the next trial would take here: a stranger's may say something that no
    /// other says, which takes room for all before it.
    pub fn weight_of(&self, record: &TrialRecord) -> usize {
        const NUMBER: usize = size_of::<f64>();
        const COLUMN: usize = 128;
        const TRIAL: usize = 64;
        let group = self.groups.last().filter(|group| group.condition == record.condition);
        let rows = group.map_or(0, Group::len);
        let column = |name: &str| match group.and_then(|group| group.measures.get(name)) {
            Some(column) => (rows + 1).saturating_sub(column.len()) * NUMBER,
            None => COLUMN + name.len() + (rows + 1) * NUMBER,
        };
        let curves = match group {
            Some(group) if !record.series.is_empty() => rows + 1 - group.series.len(),
            _ => 0,
        };
        let new = if group.is_some() { 0 } else { size_of::<Group>() + COLUMN };
        new + TRIAL
            + record.measures.names().map(column).sum::<usize>()
            + curves * size_of::<Box<[SeriesPoint]>>()
            + record.series.len() * size_of::<SeriesPoint>()
            + if record.cause.is_empty() { 0 } else { COLUMN + record.cause.len() }
    }

    /// Returns how many trials there are.
    pub fn len(&self) -> usize {
        self.trials
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.trials == 0
    }

    /// Returns the trials by condition, each as often as it begins anew in plan order.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Returns every trial, in plan order.
    pub fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        self.groups.iter().flat_map(Group::entries)
    }

    /// Counts the trials that ended with `outcome`.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.groups.iter().map(|group| group.count(outcome)).sum()
    }

    /// Sums the simulated time of all trials (s), in plan order.
    pub fn sim_seconds(&self) -> f64 {
        self.groups.iter().flat_map(|group| &group.sim_seconds).sum()
    }
}

impl Group {
    fn new(condition: Condition) -> Self {
        Self {
            condition,
            keys: Vec::new(),
            numbers: Vec::new(),
            ended: Vec::new(),
            outcomes: Vec::new(),
            sim_seconds: Vec::new(),
            causes: BTreeMap::new(),
            measures: BTreeMap::new(),
            series: Vec::new(),
        }
    }

    fn enter(&mut self, record: &TrialRecord) {
        let row = self.keys.len();
        self.keys.push(record.key);
        self.numbers.push(record.trial);
        self.sim_seconds.push(record.sim_seconds);
        let place = self.outcomes.iter().position(|known| *known == record.outcome);
        let place = place.unwrap_or_else(|| {
            self.outcomes.push(record.outcome);
            self.outcomes.len() - 1
        });
        self.ended.push(u16::try_from(place).expect("outcomes are a few dozen"));
        if !record.cause.is_empty() {
            self.causes.insert(row, record.cause.clone());
        }
        for (name, value) in &record.measures {
            let value = value.unwrap_or(f64::NAN);
            if let Some(column) = self.measures.get_mut(name) {
                column.resize(row, f64::NAN);
                column.push(value);
            } else {
                let mut column = vec![f64::NAN; row];
                column.push(value);
                self.measures.insert(name.to_owned(), column);
            }
        }
        if !record.series.is_empty() {
            self.series.resize_with(row, Box::default);
            self.series.push(record.series.as_slice().into());
        }
    }

    /// Returns the condition.
    pub fn condition(&self) -> &Condition {
        &self.condition
    }

    /// Returns how many trials there are, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a group has a trial")]
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Returns the trials, in plan order.
    pub fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        (0..self.len()).map(|row| Entry { group: self, row })
    }

    /// Counts the trials that ended with `outcome`.
    pub fn count(&self, outcome: Outcome) -> usize {
        let Some(place) = self.outcomes.iter().position(|known| *known == outcome) else {
            return 0;
        };
        self.ended.iter().filter(|ended| usize::from(**ended) == place).count()
    }

    /// Returns the names of all measures that a trial says something of, sorted.
    pub fn measures(&self) -> impl Iterator<Item = &str> {
        self.measures.keys().map(String::as_str)
    }

    /// Returns the column of the measure `name`, one value a trial: `None` where a trial never got there.
    pub fn column(&self, name: &str) -> impl Iterator<Item = Option<f64>> {
        let column = self.measures.get(name);
        (0..self.len()).map(move |row| present(column, row))
    }
}

/// Returns the value in `row` of a column that may be short or not there.
fn present(column: Option<&Vec<f64>>, row: usize) -> Option<f64> {
    column.and_then(|column| column.get(row)).copied().filter(|value| !value.is_nan())
}

/// A trial of a ledger.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    group: &'a Group,
    row: usize,
}

impl<'a> Entry<'a> {
    /// Returns the trial's identity.
    pub fn key(self) -> TrialKey {
        self.group.keys[self.row]
    }

    /// Returns the cell to which it belongs.
    pub fn condition(self) -> &'a Condition {
        &self.group.condition
    }

    /// Returns its number within the cell, from 0.
    pub fn trial(self) -> u32 {
        self.group.numbers[self.row]
    }

    /// Returns why it ended.
    pub fn outcome(self) -> Outcome {
        self.group.outcomes[usize::from(self.group.ended[self.row])]
    }

    /// Returns how it ended, in words; empty where the outcome alone says it.
    pub fn cause(self) -> &'a str {
        self.group.causes.get(&self.row).map_or("", String::as_str)
    }

    /// Returns the simulated time that it took (s).
    pub fn sim_seconds(self) -> f64 {
        self.group.sim_seconds[self.row]
    }

    /// Returns the measure `name`; `None` where the trial never got there or says nothing of it.
    pub fn number(self, name: &str) -> Option<f64> {
        present(self.group.measures.get(name), self.row)
    }

    /// Returns whether trials of its condition say anything of the measure `name`, a failed one never.
    pub fn says(self, name: &str) -> bool {
        self.outcome() != Outcome::PANICKED && self.group.measures.contains_key(name)
    }

    /// Returns the trial's curve.
    pub fn series(self) -> &'a [SeriesPoint] {
        self.group.series.get(self.row).map_or(&[], |series| series)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::Sha256Digest;
    use crate::studies::Measures;

    fn record(prior: &str, trial: u32, outcome: Outcome, measures: Measures) -> TrialRecord {
        TrialRecord {
            key: TrialKey(Sha256Digest::of(format!("{prior}{trial}"))),
            condition: Condition::from([("prior", prior)]),
            trial,
            outcome,
            cause: if outcome == Outcome::PANICKED { "a wall".to_owned() } else { String::new() },
            measures,
            series: Vec::new(),
            sim_seconds: 2.0,
            chain: vec!["0123456789abcdef".to_owned()],
        }
    }

    #[test]
    fn a_trial_says_in_columns_what_its_record_said() {
        let mut records = vec![
            record("none", 0, Outcome::EXPLORED, Measures::new()),
            record("none", 1, Outcome::PANICKED, [("time-s", Some(1.5)), ("way-m", None)].into()),
            record("none", 2, Outcome::EXPLORED, Measures::new()),
            record("map", 0, Outcome::EXPLORED, [("time-s", Some(3.0))].into()),
        ];
        let point = SeriesPoint { time_s: 1.0, distance_m: 2.0, coverage_percent: 3.0 };
        records[1].series = vec![point];
        let ledger = Ledger::of(&records);
        assert_eq!((ledger.len(), ledger.groups().len(), ledger.sim_seconds()), (4, 2, 8.0));
        for (entry, record) in ledger.entries().zip(&records) {
            assert_eq!(entry.key(), record.key);
            assert_eq!(*entry.condition(), record.condition);
            assert_eq!((entry.trial(), entry.outcome()), (record.trial, record.outcome));
            assert_eq!((entry.cause(), entry.sim_seconds()), (record.cause.as_str(), 2.0));
            assert_eq!(entry.number("time-s"), record.measures.number("time-s"));
            assert_eq!(entry.number("way-m"), None);
            assert_eq!(entry.series(), record.series);
            assert_eq!(
                entry.says("way-m"),
                record.condition.value("prior") == Some("none") && record.trial != 1
            );
        }
        let first = &ledger.groups()[0];
        assert_eq!(first.measures().collect::<Vec<_>>(), ["time-s", "way-m"]);
        assert_eq!(first.column("time-s").collect::<Vec<_>>(), [None, Some(1.5), None]);
        assert_eq!(first.column("other").collect::<Vec<_>>(), [None; 3]);
        assert_eq!((ledger.count(Outcome::EXPLORED), ledger.count(Outcome::LATE)), (3, 0));
    }
}
