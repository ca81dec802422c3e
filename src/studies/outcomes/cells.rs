//! From records to the deadline study's Tables 1 and 2, and to whatever else is asked by condition.

use super::{OutcomeTable, Percent, Quantity};
use crate::condition::Condition;
use crate::stats::compatibility::{Agreement, Ours, Printed, printed_share};
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::summary::{Summary, quantile};
use crate::studies::{Entry, Findings, Outcome};
use crate::table::Value;

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;
/// Standard normal quantile of that confidence, two-sided.
const Z: f64 = 1.959_963_984_540_054;

/// One cell: ours beside the paper's.
#[derive(Debug, Clone, PartialEq)]
pub struct OutcomeCell {
    /// Values of the factors that have rows.
    pub rows: Condition,
    /// The value of the factor whose values stand side by side.
    pub by: String,
    /// Trials of this cell that did not fail by a fault of ours.
    pub trials: u64,
    /// What was found; `None` where no trial has the quantity.
    pub ours: Option<Estimate>,
    /// How it differs over the values of a factor, where that is asked for and they have it.
    pub band: Option<Band>,
    /// The paper's number, and the trials behind it where it says.
    pub published: Option<(f64, Option<u64>)>,
    /// How the two agree, or why they cannot.
    pub agreement: Agreement,
}

/// How a quantity differs over the values of a factor: quantiles of what each has by itself, all counted alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// 5 % of them are below.
    pub low: f64,
    /// Half of them are below.
    pub median: f64,
    /// 95 % of them are below.
    pub high: f64,
    /// How many values have the quantity.
    pub of: u64,
}

impl Band {
    fn of(values: &[f64]) -> Option<Self> {
        let at = |share: f64| quantile(values, share);
        let of = values.len() as u64;
        (of > 0).then(|| Self { low: at(0.05), median: at(0.5), high: at(0.95), of })
    }
}

/// A quantity with its spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The share (percent), mean (unit of the measure) or ratio (percent).
    pub value: f64,
    /// Standard deviation over trials, of means.
    pub sd: Option<f64>,
    /// 95 % interval, of shares, means and ratios.
    pub interval: Option<(f64, f64)>,
    /// Trials behind it.
    pub n: u64,
}

impl Findings<'_> {
    /// Returns the cells of a table in the paper's order: rows, then side by side. Cells of conditions that do not
    /// exist are left out together where a whole row is missing.
    pub fn outcome_cells(&self, request: &OutcomeTable) -> Vec<OutcomeCell> {
        let only: Condition = request.only.iter().map(|(f, v)| (f, &v.0)).collect();
        let columns = self.columns_of(request);
        let mut cells = Vec::new();
        for rows in self.crossed(&request.rows) {
            let line: Vec<OutcomeCell> = columns
                .iter()
                .map(|by| {
                    let fixed = only.clone().and(&rows).with(&request.by, by);
                    self.outcome_cell(request, rows.clone(), by.clone(), &fixed)
                })
                .collect();
            if line.iter().any(|cell| cell.trials > 0) {
                cells.extend(line);
            }
        }
        cells
    }

    /// Returns the values that stand side by side.
    pub fn columns_of(&self, request: &OutcomeTable) -> Vec<String> {
        let only = request.only.get(&request.by);
        let mut values = self.values_of(&request.by);
        values.retain(|value| only.is_none_or(|only| only.0 == *value));
        values
    }

    /// Returns what readers see for the values that stand side by side.
    pub(super) fn shown_columns(&self, request: &OutcomeTable) -> Vec<String> {
        let values = self.columns_of(request);
        values.iter().map(|value| self.labels.value(&request.by, value).to_owned()).collect()
    }

    fn outcome_cell(
        &self,
        request: &OutcomeTable,
        rows: Condition,
        by: String,
        fixed: &Condition,
    ) -> OutcomeCell {
        let mut trials = self.matching(fixed);
        let ran = trials.len() as u64;
        trials.retain(|trial| trial.outcome() != Outcome::PANICKED);
        let published = request.published.as_ref().and_then(|name| {
            let (table, row) = self.published_row(name, fixed)?;
            let n = match table.value(row, "n") {
                Value::Integer(n) => u64::try_from(*n).ok(),
                _ => None,
            };
            Some((table.value(row, "value").as_f64()?, n))
        });
        let found = compared(&request.show, &trials).ok_or_else(|| self.absence(fixed, ran));
        let paper = published.map(|(value, n)| Printed { value, sd: None, n });
        let band = request.over.as_ref().and_then(|over| {
            let of_value = |value: &String| {
                let own = |trial: &&Entry<'_>| trial.condition().value(over) == Some(value);
                let own: Vec<Entry<'_>> = trials.iter().filter(own).copied().collect();
                estimate(&request.show, &own).map(|estimate| estimate.value)
            };
            Band::of(&self.values_of(over).iter().filter_map(of_value).collect::<Vec<f64>>())
        });
        OutcomeCell {
            rows,
            by,
            trials: trials.len() as u64,
            ours: estimate(&request.show, &trials),
            band,
            published,
            agreement: Agreement::between(found, paper),
        }
    }
}

/// Computes the quantity of the trials that is compared with the paper's number; `None` where no trial has it.
fn compared(quantity: &Quantity, trials: &[Entry<'_>]) -> Option<Ours> {
    Some(match quantity {
        Quantity::Share(outcomes) => {
            let hits = trials.iter().filter(|r| outcomes.contains(&r.outcome())).count() as u64;
            let all = trials.len() as u64;
            (all > 0).then(|| Ours::Share(Proportion::new(hits, all)))?
        }
        Quantity::Mean(measure) => {
            let values = measured(trials, measure);
            (!values.is_empty()).then(|| Ours::Mean(Summary::of(&values)))?
        }
        Quantity::Percent(_) => Ours::Bare(estimate(quantity, trials)?.value),
    })
}

fn estimate(quantity: &Quantity, trials: &[Entry<'_>]) -> Option<Estimate> {
    let n = trials.len() as u64;
    match quantity {
        Quantity::Share(outcomes) => {
            let hits = trials.iter().filter(|r| outcomes.contains(&r.outcome())).count() as u64;
            (n > 0).then(|| {
                let share = Proportion::new(hits, n);
                let interval = wilson(share, CONFIDENCE);
                Estimate {
                    value: 100.0 * share.share(),
                    sd: None,
                    interval: Some((100.0 * interval.low, 100.0 * interval.high)),
                    n,
                }
            })
        }
        Quantity::Mean(measure) => {
            let values = measured(trials, measure);
            (!values.is_empty()).then(|| {
                let summary = Summary::of(&values);
                let several = summary.n > 1;
                let half = Z * summary.variance_of_mean().sqrt();
                Estimate {
                    value: summary.mean,
                    sd: several.then_some(summary.sd),
                    interval: several.then_some((summary.mean - half, summary.mean + half)),
                    n: summary.n,
                }
            })
        }
        Quantity::Percent(Percent { part, whole }) => {
            let pairs: Vec<(f64, f64)> =
                trials.iter().filter_map(|r| Some((r.number(part)?, r.number(whole)?))).collect();
            ratio(&pairs)
        }
    }
}

/// Computes the interval of a share that the paper prints (percent) of `n` trials.
pub(in crate::studies) fn published_share(percent: f64, n: u64) -> Option<(f64, f64)> {
    if n == 0 || !(0.0..=100.0).contains(&percent) {
        return None;
    }
    let interval = wilson(printed_share(percent, n), CONFIDENCE);
    Some((100.0 * interval.low, 100.0 * interval.high))
}

/// Returns the values of `measure` of those `trials` that have one.
pub(in crate::studies) fn measured(trials: &[Entry<'_>], measure: &str) -> Vec<f64> {
    trials.iter().filter_map(|trial| trial.number(measure)).collect()
}

/// Computes the ratio estimator and its linearised interval (Cochran 1977, Sampling Techniques, section 2.11), in
/// percent.
fn ratio(pairs: &[(f64, f64)]) -> Option<Estimate> {
    let part: f64 = pairs.iter().map(|p| p.0).sum();
    let whole: f64 = pairs.iter().map(|p| p.1).sum();
    if whole <= 0.0 {
        return None;
    }
    let ratio = part / whole;
    let n = crate::stats::length(pairs);
    let squares: f64 = pairs.iter().map(|(a, b)| (a - ratio * b) * (a - ratio * b)).sum();
    let half = Z * (squares * n / (n - 1.0).max(1.0)).sqrt() / whole;
    let interval = (100.0 * (ratio - half).max(0.0), 100.0 * (ratio + half).min(1.0));
    Some(Estimate {
        value: 100.0 * ratio,
        sd: None,
        interval: (pairs.len() > 1).then_some(interval),
        n: pairs.len() as u64,
    })
}
