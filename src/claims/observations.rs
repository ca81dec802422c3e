//! The trials table by condition, as the forms of expectation ask for it.

use super::cannot_test::CannotTest;
use super::cells::Where;
use super::metric::{FAILED, Metric};
use crate::table::{Table, Value};
use std::collections::BTreeMap;
use std::sync::Arc;
use thiserror::Error;

/// Trials grouped by condition, in the order of the table.
#[derive(Debug, Clone, Default)]
pub struct Observations {
    /// Factor columns.
    pub(crate) factors: Vec<String>,
    /// One per combination of factor values that has trials.
    pub(crate) conditions: Vec<ConditionTrials>,
    /// Names of the measures: an unknown one is not the same as one that nobody reached.
    measures: Vec<String>,
    levels: Levels,
}

/// The values of the factors as numbers: selections compare these.
#[derive(Debug, Clone, Default)]
struct Levels {
    /// The values of each factor, in the order of their first condition.
    values: Vec<Vec<String>>,
    /// For each factor, the place among these that each condition has.
    places: Vec<Vec<usize>>,
}

impl Levels {
    /// Numbers the values that `conditions` have of so many `factors`.
    fn of(factors: usize, conditions: &[ConditionTrials]) -> Self {
        let mut levels = Self::default();
        for factor in 0..factors {
            let mut values: Vec<String> = Vec::new();
            let place = |condition: &ConditionTrials| {
                let here = &condition.values[factor];
                values.iter().position(|value| value == here).unwrap_or_else(|| {
                    values.push(here.clone());
                    values.len() - 1
                })
            };
            levels.places.push(conditions.iter().map(place).collect());
            levels.values.push(values);
        }
        levels
    }
}

/// Values by metric, one per trial; `None` where the run did not reach it.
type Measures = BTreeMap<String, Vec<Option<f64>>>;

/// A trial that the engine failed to run has no value of any kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FailedTrial;

/// The trials of one condition.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConditionTrials {
    /// Factor values, in the order of the factors.
    pub(crate) values: Vec<String>,
    /// Trial numbers.
    pub(crate) numbers: Vec<i64>,
    /// Of trials that are made up there are none.
    outcomes: Vec<Arc<str>>,
    /// By name; as long as `numbers`.
    measures: Measures,
    /// Whether each trial counts, by the name of the share, where trials are made up; as long as `numbers`.
    shares: BTreeMap<String, Vec<bool>>,
}

/// The trials of one condition, column by column.
#[derive(Debug, Clone, Default)]
pub struct TrialColumns {
    /// Factor values, in the order of the factors.
    pub values: Vec<String>,
    /// Trial numbers.
    pub numbers: Vec<i64>,
    /// Names of the outcomes; as long as `numbers`.
    pub outcomes: Vec<Arc<str>>,
    /// By name; each as long as `numbers`.
    pub measures: BTreeMap<String, Vec<Option<f64>>>,
}

/// The readings of one metric in one condition, to be made up.
#[derive(Debug)]
pub(crate) enum MadeUp<'a> {
    /// Of a share: whether each trial counts.
    Share(&'a mut [bool]),
    /// Of a measure: the value of each trial.
    Measure(&'a mut [Option<f64>]),
}

/// The trials that count for a share, over a set of conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Counted {
    /// Trials that count.
    pub(crate) successes: u64,
    /// Trials with an outcome.
    pub(crate) reached: u64,
    /// Trials of which nothing is known.
    pub(crate) censored: u64,
    /// Trials that the engine failed to run, which are not among the others.
    pub(crate) failed: u64,
}

/// The values of one metric over a set of conditions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Readings {
    /// One per trial; `None` where the run did not reach the measure. Shares are 0 and 1.
    pub(crate) values: Vec<Option<f64>>,
    /// Trials that the engine failed to run, which are not among the values.
    pub(crate) failed: u64,
}

/// Why a table cannot be read as one of trials. A condition is named by the values of its factors.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TrialsTableError {
    /// A column is missing.
    #[error("the trials table has no column `{column}` (it has {columns})")]
    NoColumn {
        /// Its name.
        column: &'static str,
        /// Those there are.
        columns: String,
    },
    /// The outcome is out of its place.
    #[error("the trials table must have `outcome` right after `trial`")]
    OutcomeElsewhere,
    /// A trial has no whole number or no outcome.
    #[error(
        "a trial of {condition} has the number `{number}` and the outcome `{outcome}`; expected a whole number and a name"
    )]
    NotATrial {
        /// Its condition.
        condition: String,
        /// What stands there for its number.
        number: String,
        /// What stands there for its outcome.
        outcome: String,
    },
    /// A trial is there twice.
    #[error("trial {number} of {condition} is there twice")]
    Twice {
        /// Its number.
        number: i64,
        /// Its condition.
        condition: String,
    },
}

impl Observations {
    /// Reads the columns `key`, the factors, `trial`, `outcome` and the measures, in this order
    /// (`results/trials.csv`).
    ///
    /// # Errors
    /// Where a column is missing or out of its place, a trial has no number or outcome, or stands there twice.
    pub fn read(trials: &Table) -> Result<Self, TrialsTableError> {
        let place = |column: &'static str| {
            trials.column(column).ok_or_else(|| {
                let columns = trials.columns.join(", ");
                TrialsTableError::NoColumn { column, columns }
            })
        };
        let (trial, outcome) = (place("trial")?, place("outcome")?);
        let first = usize::from(trials.columns.first().is_some_and(|c| c == "key"));
        if outcome != trial + 1 {
            return Err(TrialsTableError::OutcomeElsewhere);
        }
        let factors = trials.columns[first..trial].to_vec();
        let measures = trials.columns[outcome + 1..].to_vec();
        let mut conditions: Vec<ConditionTrials> = Vec::new();
        let mut places: BTreeMap<Vec<String>, usize> = BTreeMap::new();
        for row in &trials.rows {
            let values: Vec<String> = row[first..trial].iter().map(ToString::to_string).collect();
            let &mut at = places.entry(values.clone()).or_insert_with(|| {
                conditions
                    .push(ConditionTrials { values: values.clone(), ..ConditionTrials::default() });
                conditions.len() - 1
            });
            let here = &mut conditions[at];
            let (Value::Integer(number), Value::Text(outcome)) = (&row[trial], &row[outcome])
            else {
                return Err(TrialsTableError::NotATrial {
                    condition: values.join("/"),
                    number: row[trial].to_string(),
                    outcome: row[outcome].to_string(),
                });
            };
            here.numbers.push(*number);
            here.outcomes.push(outcome.as_str().into());
            for (name, value) in measures.iter().zip(&row[trial + 2..]) {
                here.measures.entry(name.clone()).or_default().push(value.as_f64());
            }
        }
        Self::of(factors, measures, conditions)
    }

    /// Returns the trials that `columns` hold, of a design of these factors; a measure that a condition says nothing of was not
    /// reached there.
    ///
    /// # Errors
    /// Where a trial is there twice.
    pub fn of_columns(
        factors: Vec<String>,
        measures: Vec<String>,
        columns: impl IntoIterator<Item = TrialColumns>,
    ) -> Result<Self, TrialsTableError> {
        let mut conditions: Vec<ConditionTrials> = Vec::new();
        let mut places: BTreeMap<Vec<String>, usize> = BTreeMap::new();
        for mut here in columns {
            let read = measures.iter().map(|name| {
                let column = here.measures.remove(name);
                (name.clone(), column.unwrap_or_else(|| vec![None; here.numbers.len()]))
            });
            let read: Measures = read.collect();
            let TrialColumns { values, numbers, outcomes, .. } = here;
            // In plan order a condition does not begin anew, unless its records were written by somebody else.
            if let Some(&known) = places.get(&values) {
                let known = &mut conditions[known];
                known.numbers.extend(numbers);
                known.outcomes.extend(outcomes);
                for (name, column) in read {
                    known.measures.entry(name).or_default().extend(column);
                }
            } else {
                places.insert(values.clone(), conditions.len());
                let shares = BTreeMap::new();
                let trials = ConditionTrials { values, numbers, outcomes, measures: read, shares };
                conditions.push(trials);
            }
        }
        Self::of(factors, measures, conditions)
    }

    /// Returns those of `conditions`, where no trial is there twice.
    fn of(
        factors: Vec<String>,
        measures: Vec<String>,
        conditions: Vec<ConditionTrials>,
    ) -> Result<Self, TrialsTableError> {
        for condition in &conditions {
            // Of a condition in plan order there is nothing to be sorted.
            if condition.numbers.is_sorted_by(|a, b| a < b) {
                continue;
            }
            let mut numbers = condition.numbers.clone();
            numbers.sort_unstable();
            if let Some(twice) = numbers.windows(2).find(|pair| pair[0] == pair[1]) {
                let (number, condition) = (twice[0], condition.values.join("/"));
                return Err(TrialsTableError::Twice { number, condition });
            }
        }
        let levels = Levels::of(factors.len(), &conditions);
        Ok(Self { factors, conditions, measures, levels })
    }

    /// Returns observations to be made up for a plan ([`ConditionTrials::made_up`]): of each condition, by its factor
    /// values, so many `trials` of every metric.
    pub(crate) fn simulated(
        factors: Vec<String>,
        conditions: impl IntoIterator<Item = Vec<String>>,
        metrics: &[String],
        trials: usize,
    ) -> Self {
        let (shares, measures): (Vec<&String>, Vec<&String>) =
            metrics.iter().partition(|name| Metric::named(name).is_share());
        let conditions: Vec<_> = conditions
            .into_iter()
            .map(|values| ConditionTrials {
                values,
                numbers: (0..trials as u64).map(u64::cast_signed).collect(),
                outcomes: Vec::new(),
                measures: measures
                    .iter()
                    .map(|name| ((*name).clone(), vec![None; trials]))
                    .collect(),
                shares: shares.iter().map(|name| ((*name).clone(), vec![false; trials])).collect(),
            })
            .collect();
        let levels = Levels::of(factors.len(), &conditions);
        Self { factors, conditions, measures: measures.into_iter().cloned().collect(), levels }
    }

    /// Returns why `metric` cannot be read at all, if it cannot.
    pub(super) fn lacks(&self, metric: &Metric) -> Option<CannotTest> {
        let lacking = metric.columns().into_iter().find(|name| !self.measures.contains(name));
        lacking.map(|name| CannotTest::NoColumn(name.clone()))
    }

    /// Returns the first `n` trials of each condition, by number.
    pub(crate) fn first(&self, n: u64) -> Self {
        let mut kept = self.clone();
        for condition in &mut kept.conditions {
            let first: Vec<bool> =
                condition.numbers.iter().map(|&i| u64::try_from(i).is_ok_and(|i| i < n)).collect();
            let mut next = first.iter();
            condition.numbers.retain(|_| next.next() == Some(&true));
            let mut next = first.iter();
            condition.outcomes.retain(|_| next.next() == Some(&true));
            for values in condition.measures.values_mut() {
                let mut next = first.iter();
                values.retain(|_| next.next() == Some(&true));
            }
            for counts in condition.shares.values_mut() {
                let mut next = first.iter();
                counts.retain(|_| next.next() == Some(&true));
            }
        }
        kept
    }

    /// Returns the trials of the conditions that `cell` selects.
    pub(crate) fn only(&self, cell: &Where) -> Self {
        let selected = self.select(cell);
        let conditions: Vec<_> = selected.iter().map(|&i| self.conditions[i].clone()).collect();
        let levels = Levels::of(self.factors.len(), &conditions);
        let (factors, measures) = (self.factors.clone(), self.measures.clone());
        Self { factors, conditions, measures, levels }
    }

    /// Returns the conditions that `cell` selects.
    pub(crate) fn select(&self, cell: &Where) -> Vec<usize> {
        let mut selected: Vec<usize> = (0..self.conditions.len()).collect();
        for (factor, admitted) in &cell.0 {
            let Some(factor) = self.factors.iter().position(|f| f == factor) else {
                return Vec::new();
            };
            let values = self.levels.values[factor].iter();
            let admits: Vec<bool> = values.map(|value| admitted.0.contains(value)).collect();
            let places = &self.levels.places[factor];
            selected.retain(|&i| admits[places[i]]);
        }
        selected
    }

    /// Returns the values of `metric` over `conditions`, in order.
    pub(crate) fn readings(&self, conditions: &[usize], metric: &Metric) -> Readings {
        let mut readings = Readings::default();
        for &i in conditions {
            self.conditions[i].read(metric, &mut readings);
        }
        readings
    }

    /// Counts the trials of `conditions` for the share `metric`; `None` where that is a measure.
    pub(crate) fn counted(&self, conditions: &[usize], metric: &Metric) -> Option<Counted> {
        if !metric.is_share() {
            return None;
        }
        let (mut counted, name) = (Counted::default(), metric.to_string());
        for &i in conditions {
            self.conditions[i].count(metric, &name, &mut counted);
        }
        Some(counted)
    }

    /// Names two of these conditions whose trials of one number share their noise, if there are any.
    ///
    /// Noise shared over a factor leaves that factor out of the streams' coordinates, so two conditions that
    /// agree in every other factor draw the same numbers.
    pub(crate) fn sharing(
        &self,
        conditions: &[usize],
        shared_noise: &[String],
    ) -> Option<(String, String)> {
        let is_own = |factor: &usize| !shared_noise.contains(&self.factors[*factor]);
        let own: Vec<usize> = (0..self.factors.len()).filter(is_own).collect();
        if own.len() == self.factors.len() {
            // No two conditions have all their values in common.
            return None;
        }
        let mut seen: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        for &i in conditions {
            let coordinates = own.iter().map(|&factor| self.levels.places[factor][i]).collect();
            match seen.get(&coordinates) {
                Some(&other) if other != i => return Some((self.name(other), self.name(i))),
                _ => seen.insert(coordinates, i),
            };
        }
        None
    }

    /// Returns the factor values of a condition but for `left_out`.
    pub(crate) fn own_coordinates(&self, condition: usize, left_out: &[String]) -> Vec<&str> {
        let values = self.conditions[condition].values.iter();
        self.factors
            .iter()
            .zip(values)
            .filter(|(factor, _)| !left_out.contains(factor))
            .map(|(_, value)| value.as_str())
            .collect()
    }

    /// Returns the value of `factor` in a condition.
    pub(crate) fn value(&self, condition: usize, factor: &str) -> Option<&str> {
        let place = self.factors.iter().position(|f| f == factor)?;
        Some(self.conditions[condition].values[place].as_str())
    }

    /// Returns a condition in words.
    pub(crate) fn name(&self, condition: usize) -> String {
        let pairs = self.factors.iter().zip(&self.conditions[condition].values);
        pairs.map(|(factor, value)| format!("{factor}={value}")).collect::<Vec<_>>().join(", ")
    }

    /// Returns the largest number of trials that any of these conditions has.
    pub(crate) fn trials_per_condition(&self, conditions: &[usize]) -> u64 {
        conditions.iter().map(|&i| self.conditions[i].numbers.len() as u64).max().unwrap_or(0)
    }
}

impl ConditionTrials {
    /// Returns the value of `metric` in one trial: `None` where the run did not reach it.
    pub(crate) fn reading(&self, row: usize, metric: &Metric) -> Result<Option<f64>, FailedTrial> {
        let outcome = self.outcomes.get(row);
        if outcome.is_some_and(|outcome| **outcome == *FAILED) {
            return Err(FailedTrial);
        }
        if metric.is_share() {
            let counts = match outcome {
                Some(outcome) => metric.counts(outcome),
                None => self.shares.get(&metric.to_string()).map(|counts| counts[row]),
            };
            return Ok(counts.map(|counts| f64::from(u8::from(counts))));
        }
        Ok(metric.of_columns(|name| self.measures.get(name).and_then(|values| values[row])))
    }

    /// Adds the value of `metric` in every trial to `readings`.
    fn read(&self, metric: &Metric, readings: &mut Readings) {
        if let Metric::Measure(name) = metric {
            // Looked up once for all trials: nearly every metric that is read is one column.
            let column = self.measures.get(name);
            let failed = |row: usize| self.outcomes.get(row).is_some_and(|o| **o == *FAILED);
            for row in 0..self.numbers.len() {
                if failed(row) {
                    readings.failed += 1;
                } else {
                    readings.values.push(column.and_then(|values| values[row]));
                }
            }
            return;
        }
        for row in 0..self.numbers.len() {
            match self.reading(row, metric) {
                Ok(value) => readings.values.push(value),
                Err(FailedTrial) => readings.failed += 1,
            }
        }
    }

    /// Counts every trial for the share `metric`, whose name that is.
    fn count(&self, metric: &Metric, name: &str, counted: &mut Counted) {
        if self.outcomes.is_empty() {
            match self.shares.get(name) {
                Some(counts) => {
                    counted.successes +=
                        counts.iter().map(|counts| u64::from(*counts)).sum::<u64>();
                    counted.reached += counts.len() as u64;
                }
                None => counted.censored += self.numbers.len() as u64,
            }
            return;
        }
        for outcome in &self.outcomes {
            if **outcome == *FAILED {
                counted.failed += 1;
            } else {
                counted.reached += 1;
                counted.successes += u64::from(metric.counts(outcome) == Some(true));
            }
        }
    }

    /// Returns the readings of the metric `name`, to be made up; `None` where there are no such.
    pub(crate) fn made_up(&mut self, name: &str) -> Option<MadeUp<'_>> {
        match self.shares.get_mut(name) {
            Some(counts) => Some(MadeUp::Share(counts)),
            None => self.measures.get_mut(name).map(|values| MadeUp::Measure(values)),
        }
    }
}

#[cfg(test)]
mod tests;
