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
    outcomes: Vec<String>,
    /// By name; as long as `numbers`.
    measures: Measures,
    /// Whether each trial counts, by the name of the share, where trials are made up; as long as `numbers`.
    shares: BTreeMap<String, Vec<bool>>,
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
        if outcome.is_some_and(|outcome| outcome == FAILED) {
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
            let failed = |row: usize| self.outcomes.get(row).is_some_and(|o| o == FAILED);
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
            if outcome == FAILED {
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
        let counted = Counted { successes: 1, reached: 3, censored: 0, failed: 1 };
        assert_eq!(all.counted(&[0, 1, 2], &Metric::Success), Some(counted));
        assert_eq!(all.counted(&[0], &Metric::named("time-s")), None);
        assert_eq!(all.trials_per_condition(&[1, 0]), 2);
        assert_eq!(
            all.lacks(&Metric::named("tim-s")),
            Some(CannotTest::NoColumn("tim-s".to_owned()))
        );
    }

    #[test]
    fn a_selection_names_factors_that_are_there_and_any_of_their_values() {
        let all = Observations::read(&table(TRIALS)).unwrap();
        let select = |cell: &str| all.select(&serde_json::from_str(cell).unwrap());
        assert_eq!(select("{}"), [0, 1, 2]);
        assert_eq!(select(r#"{"start": ["B", "A", "C"], "strategy": "random"}"#), [0, 2]);
        assert_eq!(select(r#"{"start": "C"}"#), [0; 0]);
        assert_eq!(select(r#"{"stop": "A"}"#), [0; 0]);
    }

    #[test]
    fn what_is_made_up_is_read_and_counted_like_trials() {
        let metrics = ["success".to_owned(), "time-s".to_owned()];
        let conditions = ["A", "B"].map(|start| vec![start.to_owned()]);
        let mut study = Observations::simulated(vec!["start".into()], conditions, &metrics, 3);
        for condition in &mut study.conditions {
            let Some(MadeUp::Share(counts)) = condition.made_up("success") else { panic!("share") };
            counts.copy_from_slice(&[true, false, true]);
            let Some(MadeUp::Measure(times)) = condition.made_up("time-s") else { panic!("time") };
            times[2] = Some(7.0);
            assert!(condition.made_up("outcome:late").is_none());
        }
        let counted = Counted { successes: 4, reached: 6, ..Counted::default() };
        assert_eq!(study.counted(&[0, 1], &Metric::Success), Some(counted));
        let success = study.readings(&[1], &Metric::Success).values;
        assert_eq!(success, [Some(1.0), Some(0.0), Some(1.0)]);
        let unknown = study.counted(&[0], &Metric::named("outcome:late")).unwrap();
        assert_eq!(unknown, Counted { censored: 3, ..Counted::default() });
        let time = Metric::named("time-s");
        assert_eq!(study.readings(&[0], &time).values, [None, None, Some(7.0)]);
        assert_eq!(study.first(2).readings(&[0], &time).values, [None, None]);
        assert_eq!(study.first(1).counted(&[0], &Metric::Success).unwrap().successes, 1);
        assert_eq!(study.lacks(&Metric::Success), None);
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
