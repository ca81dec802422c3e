//! A condition on one trial: what `share` and `every` count by.

use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::Where;
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::metric::Metric;
use crate::claims::terms::Censored;
use crate::stats::proportion::Proportion;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A condition on one trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct That {
    /// A measure; or `success`, `outcome:NAME`, which need no bound.
    pub metric: String,
    /// The measure is at least this.
    pub at_least: Option<Bound>,
    /// The measure is at most this.
    pub at_most: Option<Bound>,
}

/// What a measure is held against: a number, or the value that a factor has in the trial's condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Bound {
    /// A number in the measure's unit.
    Number(f64),
    /// Name of a factor whose values are numbers in the measure's unit.
    Factor(String),
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Factor(name) => f.write_str(name),
        }
    }
}

impl fmt::Display for That {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.metric)?;
        if let Some(bound) = &self.at_least {
            write!(f, " >= {bound}")?;
        }
        if let Some(bound) = &self.at_most {
            write!(f, " <= {bound}")?;
        }
        Ok(())
    }
}

impl That {
    pub(super) fn measured(&self) -> Vec<(String, &str)> {
        vec![("/that/metric".to_owned(), &self.metric)]
    }

    pub(super) fn check(&self, faults: &mut Faults<'_>) {
        let bounds = [("/that/at-least", &self.at_least), ("/that/at-most", &self.at_most)];
        let bounded = bounds.iter().any(|(_, bound)| bound.is_some());
        let share = Metric::named(&self.metric).is_share();
        faults.unless(bounded != share, "/that", || {
            "a measure needs `at-least` or `at-most`, a share neither".to_owned()
        });
        for (path, bound) in bounds {
            let Some(Bound::Factor(name)) = bound else { continue };
            match faults.values_of(name) {
                None => faults.unknown_factor(path, name, false),
                Some(values) => {
                    let word = values.iter().find(|value| value.parse::<f64>().is_err());
                    faults.unless(word.is_none(), path, || {
                        let word = word.map_or("", String::as_str);
                        format!("`{name}` has the value `{word}`, which is no number")
                    });
                }
            }
        }
    }
}

/// Counts the trials of `cell` that meet a condition and weighs their share.
pub(super) fn conditioned(
    bench: &Bench<'_>,
    cell: &Where,
    that: &That,
    about: String,
    test: &'static str,
    weigh: impl Fn(Proportion) -> Evidence,
) -> Draft {
    let metric = Metric::named(&that.metric);
    let gathered = bench.gather(std::slice::from_ref(cell), &metric);
    let mut cells = gathered.numbers;
    let evidence = gathered.groups.and_then(|_| {
        let share = met(bench, that, &metric, &gathered.conditions)?;
        for cell in &mut cells {
            cell.successes = Some(share.successes);
        }
        Ok(weigh(share))
    });
    Draft { about, test, cells, conditions: gathered.conditions, evidence, notes: gathered.notes }
}

/// Counts the trials that meet `that`, of those that count. A run that never reached the measure meets nothing, and counts
/// unless only those that did are looked at.
fn met(
    bench: &Bench<'_>,
    that: &That,
    metric: &Metric,
    conditions: &[usize],
) -> Result<Proportion, CannotTest> {
    let (mut met, mut counted) = (0, 0);
    for &i in conditions {
        let limit =
            |bound: &Option<Bound>| bound.as_ref().map(|bound| limit(bench, bound, i)).transpose();
        let (low, high) = (limit(&that.at_least)?, limit(&that.at_most)?);
        let meets = |reading: f64| {
            if metric.is_share() {
                return reading == 1.0;
            }
            low.is_none_or(|low| reading >= low) && high.is_none_or(|high| reading <= high)
        };
        for reading in bench.observations.readings(&[i], metric).values {
            counted +=
                u64::from(reading.is_some() || bench.terms.censored != Censored::ReachedOnly);
            met += u64::from(reading.is_some_and(meets));
        }
    }
    Ok(Proportion::new(met, counted))
}

/// Returns the value of a bound in one condition.
fn limit(bench: &Bench<'_>, bound: &Bound, condition: usize) -> Result<f64, CannotTest> {
    match bound {
        Bound::Number(number) => Ok(*number),
        Bound::Factor(factor) => {
            let value = bench.observations.value(condition, factor);
            value.and_then(|text| text.parse().ok()).ok_or_else(|| CannotTest::BoundIsNoNumber {
                factor: factor.clone(),
                condition: bench.observations.name(condition),
            })
        }
    }
}
