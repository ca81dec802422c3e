//! What an unstated choice moves: the main effect of a factor's level on a metric, in percent, over conditions that differ
//! in nothing else. A level that exists only together with another factor's is compared where both exist.

mod layout;

use super::requests::EffectsTable;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::math::{exp, ln};
use crate::stats::means::{TTest, welch_matched};
use crate::stats::summary::Summary;
use crate::studies::Findings;
use std::collections::BTreeMap;

/// Confidence of the intervals. Each stands alone: of a hundred effects of nothing, five miss 0.
const CONFIDENCE: f64 = 0.95;

/// One side of a comparison, over all matched conditions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Runs {
    /// Trials, whether or not they got there.
    pub trials: u64,
    /// Those that reached the coverage. One that had it at the start, at 0 m or 0 s, has no logarithm and is left out.
    pub reached: u64,
}

/// How a level of a factor moves one cell against the factor's first level.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// The factor.
    pub factor: String,
    /// The level.
    pub level: String,
    /// The factor's first level that was run.
    pub against: String,
    /// What names the cell besides its coverage.
    pub within: Condition,
    /// Coverage (percent).
    pub percent: u32,
    /// Combinations of all other factors' values that were run at both levels.
    pub matched: u64,
    /// Those of them of which runs of both levels got there: the effect is the mean over these.
    pub compared: u64,
    /// Runs at the level.
    pub runs: Runs,
    /// Runs at the first level.
    pub runs_against: Runs,
    /// Difference of the means of ln(metric); `None` where nothing could be compared.
    pub log_ratio: Option<f64>,
    /// Geometric mean at the first level (m or s), over the conditions compared.
    pub mean_against: Option<f64>,
    /// Interval and p of the difference; `None` where a side has no two runs of one condition.
    pub test: Option<TTest>,
    /// The paper's mean (m or s).
    pub published: Option<f64>,
}

impl Effect {
    /// Returns the effect (percent).
    pub fn percent_moved(&self) -> Option<f64> {
        self.log_ratio.map(in_percent)
    }

    /// Returns the ends of its interval (percent).
    pub fn interval_percent(&self) -> Option<(f64, f64)> {
        let interval = self.test?.interval(CONFIDENCE);
        Some((in_percent(interval.low), in_percent(interval.high)))
    }

    /// Computes ln(the paper's mean / ours at the first level): what would have to be moved.
    pub fn log_gap(&self) -> Option<f64> {
        let (published, ours) = (self.published?, self.mean_against?);
        (published > 0.0).then(|| ln(published / ours))
    }

    /// Returns that gap (percent).
    pub fn gap_percent(&self) -> Option<f64> {
        self.log_gap().map(in_percent)
    }

    /// Computes the effect as a share of that gap: 1 closes it, below 0 widens it.
    pub fn share_of_gap(&self) -> Option<f64> {
        let gap = self.log_gap().filter(|gap| *gap != 0.0)?;
        self.log_ratio.map(|moved| moved / gap)
    }
}

/// Converts a log ratio to percent.
fn in_percent(log_ratio: f64) -> f64 {
    100.0 * (exp(log_ratio) - 1.0)
}

/// Runs of one condition: how many there are, and ln(metric) of those that got there.
#[derive(Default)]
struct Group {
    trials: u64,
    logs: Vec<f64>,
}

impl Findings<'_> {
    /// Computes the effects in the order of the request: factor, level, values of `within`, coverage.
    pub fn effects(&self, wanted: &EffectsTable) -> Vec<Effect> {
        let mut effects = Vec::new();
        for factor in &wanted.factors {
            let levels = self.values_of(factor);
            let Some((against, levels)) = levels.split_first() else { continue };
            for level in levels {
                for within in self.crossed(&wanted.within) {
                    for &percent in &wanted.at {
                        effects.push(self.effect(
                            wanted,
                            (factor, level, against),
                            &within,
                            percent,
                        ));
                    }
                }
            }
        }
        effects
    }

    fn effect(
        &self,
        wanted: &EffectsTable,
        (factor, level, against): (&str, &str, &str),
        within: &Condition,
        percent: u32,
    ) -> Effect {
        let groups = |level: &str| self.groups(wanted, (factor, level), within, percent);
        let (here, there) = (groups(level), groups(against));
        let (mut runs, mut runs_against) = (Runs::default(), Runs::default());
        let (mut matched, mut pairs) = (0, Vec::new());
        for (others, group) in &here {
            let Some(base) = there.get(others) else { continue };
            matched += 1;
            for (runs, group) in [(&mut runs, group), (&mut runs_against, base)] {
                runs.trials += group.trials;
                runs.reached += group.logs.len() as u64;
            }
            if !group.logs.is_empty() && !base.logs.is_empty() {
                pairs.push((Summary::of(&group.logs), Summary::of(&base.logs)));
            }
        }
        let mean = |log: fn(&(Summary, Summary)) -> f64| {
            let logs: Vec<f64> = pairs.iter().map(log).collect();
            (!logs.is_empty()).then(|| crate::stats::summary::mean(&logs))
        };
        Effect {
            factor: factor.to_owned(),
            level: level.to_owned(),
            against: against.to_owned(),
            within: within.clone(),
            percent,
            matched,
            compared: pairs.len() as u64,
            runs,
            runs_against,
            log_ratio: mean(|(here, there)| here.mean - there.mean),
            mean_against: mean(|(_, there)| there.mean).map(exp),
            test: welch_matched(&pairs),
            published: self.published_mean(wanted, within, percent),
        }
    }

    /// Returns the runs of each combination of the other factors' values.
    fn groups(
        &self,
        wanted: &EffectsTable,
        (factor, level): (&str, &str),
        within: &Condition,
        percent: u32,
    ) -> BTreeMap<Condition, Group> {
        let measure = wanted.metric.measure_at(percent);
        let fixed = within.clone().with(factor, level);
        let mut groups: BTreeMap<_, Group> = BTreeMap::new();
        for trial in self.matching(&fixed) {
            let others = trial.condition().iter().filter(|pair| !fixed.contains(pair)).cloned();
            let group = groups.entry(others.collect()).or_default();
            group.trials += 1;
            let value = trial.number(&measure);
            group.logs.extend(value.filter(|value| *value > 0.0).map(ln));
        }
        groups
    }

    /// Returns the paper's mean for a cell; factors of one value name it too.
    fn published_mean(
        &self,
        wanted: &EffectsTable,
        within: &Condition,
        percent: u32,
    ) -> Option<f64> {
        let single =
            self.factors.iter().filter_map(|Factor { name, values }| match values.as_slice() {
                [only] if !within.iter().any(|(known, _)| known == name) => {
                    Some((name.clone(), only.clone()))
                }
                _ => None,
            });
        let fixed: Condition = within.iter().cloned().chain(single).collect();
        let fixed = fixed.with("coverage-percent", percent.to_string());
        let (table, row) = self.published_row(wanted.published.as_ref()?, &fixed)?;
        table.value(row, "value").as_f64()
    }
}

#[cfg(test)]
mod tests;
