//! The trials table by condition, as the forms of expectation ask for it.

use super::cannot_test::CannotTest;
use super::cells::Where;
use super::metric::{FAILED, Metric};
use crate::table::{Table, Value};
use std::collections::BTreeMap;
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
}

/// Values by metric, one per trial; `None` where the run did not reach it.
pub(crate) type Measures = BTreeMap<String, Vec<Option<f64>>>;

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
    outcomes: Vec<String>,
    /// By name; as long as `numbers`.
    measures: Measures,
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
            here.outcomes.push(outcome.clone());
            for (name, value) in measures.iter().zip(&row[trial + 2..]) {
                here.measures.entry(name.clone()).or_default().push(value.as_f64());
            }
        }
        for condition in &conditions {
            let mut numbers = condition.numbers.clone();
            numbers.sort_unstable();
            if let Some(twice) = numbers.windows(2).find(|pair| pair[0] == pair[1]) {
                let (number, condition) = (twice[0], condition.values.join("/"));
                return Err(TrialsTableError::Twice { number, condition });
            }
        }
        Ok(Self { factors, conditions, measures })
    }

    /// Returns observations made up for a plan: each metric (shares as 0 and 1) by condition.
    pub(crate) fn simulated(
        factors: Vec<String>,
        conditions: Vec<(Vec<String>, Measures)>,
        trials: u64,
    ) -> Self {
        let measures =
            conditions.first().map(|c| c.1.keys().cloned().collect()).unwrap_or_default();
        let conditions = conditions
            .into_iter()
            .map(|(values, measures)| ConditionTrials {
                values,
                numbers: (0..trials).map(u64::cast_signed).collect(),
                outcomes: Vec::new(),
                measures,
            })
            .collect();
        Self { factors, conditions, measures }
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
        }
        kept
    }

    /// Returns the conditions that `cell` selects.
    pub(crate) fn select(&self, cell: &Where) -> Vec<usize> {
        (0..self.conditions.len())
            .filter(|&i| cell.admits(|factor| self.value(i, factor)))
            .collect()
    }

    /// Returns the values of `metric` over `conditions`, in order.
    pub(crate) fn readings(&self, conditions: &[usize], metric: &Metric) -> Readings {
        let mut readings = Readings::default();
        for &i in conditions {
            let condition = &self.conditions[i];
            for row in 0..condition.numbers.len() {
                match condition.reading(row, metric) {
                    Ok(value) => readings.values.push(value),
                    Err(FailedTrial) => readings.failed += 1,
                }
            }
        }
        readings
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
        let mut seen: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
        for &i in conditions {
            let coordinates = self.own_coordinates(i, shared_noise);
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
        let Some(outcome) = self.outcomes.get(row) else {
            let column = |name: &str| self.measures.get(name).and_then(|values| values[row]);
            let share = metric.is_share().then(|| column(&metric.to_string()));
            return Ok(share.unwrap_or_else(|| metric.of_columns(column)));
        };
        if outcome == FAILED {
            return Err(FailedTrial);
        }
        let column = |name: &str| self.measures.get(name).and_then(|values| values[row]);
        Ok(match metric.counts(outcome) {
            Some(counts) => Some(f64::from(u8::from(counts))),
            None => metric.of_columns(column),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table {
        Table::from_csv(text).unwrap()
    }

    const TRIALS: &str = "key,start,strategy,trial,outcome,time-s\n\
        k1,A,random,0,reached,10.5\nk2,A,random,1,late,\nk3,A,frontier,0,panicked,\nk4,B,random,0,collided,3\n";

    #[test]
    fn trials_are_grouped_and_never_dropped() {
        let all = Observations::read(&table(TRIALS)).unwrap();
        assert_eq!(all.factors, ["start", "strategy"]);
        let at_a: Where = serde_json::from_str(r#"{"start": "A"}"#).unwrap();
        let at_a = all.select(&at_a);
        assert_eq!(at_a, [0, 1]);
        let time = all.readings(&at_a, &Metric::named("time-s"));
        assert_eq!(time, Readings { values: vec![Some(10.5), None], failed: 1 });
        let success = all.readings(&[0, 2], &Metric::Success);
        assert_eq!(success.values, [Some(1.0), Some(0.0), Some(0.0)]);
        assert_eq!(all.trials_per_condition(&[1, 0]), 2);
        assert_eq!(
            all.lacks(&Metric::named("tim-s")),
            Some(CannotTest::NoColumn("tim-s".to_owned()))
        );
    }

    #[test]
    fn shared_noise_is_found_by_the_coordinates_that_remain() {
        let all = Observations::read(&table(TRIALS)).unwrap();
        let shared = ["strategy".to_owned()];
        assert_eq!(
            all.sharing(&[0, 1], &shared),
            Some(("start=A, strategy=random".into(), "start=A, strategy=frontier".into()))
        );
        assert_eq!(all.sharing(&[1, 2], &shared), None);
        assert_eq!(all.sharing(&[0, 1, 2], &[]), None);
    }

    #[test]
    fn a_table_of_another_shape_is_refused() {
        let fault = |text: &str| Observations::read(&table(text)).unwrap_err().to_string();
        assert_eq!(
            fault("key,outcome\n"),
            "the trials table has no column `trial` (it has key, outcome)"
        );
        assert_eq!(
            fault("key,trial,x,outcome\n"),
            "the trials table must have `outcome` right after `trial`"
        );
        assert_eq!(
            fault("key,start,trial,outcome\nk,A,x,late\n"),
            "a trial of A has the number `x` and the outcome `late`; expected a whole number and a name"
        );
        assert_eq!(
            fault("key,start,trial,outcome\nk,A,0,late\nk,A,0,late\n"),
            "trial 0 of A is there twice"
        );
    }
}
