//! What a number of trials would decide, said before they run.
//!
//! Studies are made up from a supposed truth (the published cells, or values the manifest assumes), each is
//! judged by the very code that judges the real one, and the verdicts are counted. So pools, corrections,
//! margins, minimum n and the choice of test all enter as they are.

use super::assume::Assume;
use super::claim::Claim;
use super::context::Context;
use super::judge::judge_observations;
use super::metric::Metric;
use super::observations::{MadeUp, Observations};
use super::published::{PublishedCell, PublishedTableError, read, selection};
use super::verdict::{Judgement, rounded};
use crate::condition::Condition;
use crate::rng::Seeds;
use crate::stats::real;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use thiserror::Error;

/// Trials per condition that are tried beside the planned number.
const LADDER: [u64; 7] = [10, 20, 50, 100, 200, 500, 1000];

/// Probability of a verdict that counts as enough.
const ENOUGH: f64 = 0.8;

/// Made-up studies per number of trials: a share of 0.8 is then known to about ± 0.06 (two standard errors).
pub const REPLICATES: u32 = 200;

/// How often a number of trials would yield which verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Trials per condition.
    pub trials: u64,
    /// Share of made-up studies in which the claim is supported.
    pub supported: f64,
    /// Share in which it is contradicted.
    pub contradicted: f64,
}

impl Chance {
    fn decided(&self) -> f64 {
        self.supported + self.contradicted
    }
}

/// What trials would decide about one claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Power {
    /// The claim's id.
    pub id: String,
    /// At the number planned.
    pub planned: Chance,
    /// At 10, 20, 50, ... until one is enough.
    pub ladder: Vec<Chance>,
    /// Fewest trials tried that support or contradict the claim in 80 % of studies.
    pub enough: Option<u64>,
}

impl Power {
    /// Returns the line of `plan --power --format json`.
    pub fn to_json(&self) -> Value {
        let chance = |c: &Chance| {
            json!({
                "trials": c.trials,
                "supported": rounded(c.supported),
                "contradicted": rounded(c.contradicted),
            })
        };
        json!({
            "id": self.id,
            "planned": chance(&self.planned),
            "ladder": self.ladder.iter().map(chance).collect::<Vec<_>>(),
            "enough": self.enough,
        })
    }
}

/// Why nothing can be said of a claim before trials are run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PowerError {
    /// The claim does not say what to take for the truth.
    #[error("the claim assumes no truth; add `power:` with `published` or `cells`")]
    NoTruth,
    /// There is no such published table.
    #[error("there is no published table `{0}`")]
    NoTable(String),
    /// The published table cannot be read.
    #[error("published table `{table}`: {error}")]
    Table {
        /// Its name.
        table: String,
        /// Why.
        error: PublishedTableError,
    },
    /// A share is not between 0 and 1.
    #[error("{metric} in ({condition}) is a share and cannot be {value}; is a scale missing?")]
    NotAShare {
        /// The share.
        metric: String,
        /// Where, in words.
        condition: String,
        /// What was assumed.
        value: f64,
    },
    /// A measure has a mean and nothing that says how it varies.
    #[error("no standard deviation is known for {metric} in ({condition})")]
    NoDeviation {
        /// The measure.
        metric: String,
        /// Where, in words.
        condition: String,
    },
    /// Nothing that the claim compares is among what was assumed.
    #[error("the truth assumed covers no condition of the plan")]
    Nowhere,
}

/// Returns what `trials` per condition would decide about `claim`, by `replicates` made-up studies each.
///
/// `conditions` are the factor values of every condition of the plan, all with the same factors in one order.
///
/// # Errors
/// Where the claim assumes no truth, or the truth is not known for a condition the claim compares.
pub fn power(
    claim: &Claim,
    conditions: &[Condition],
    trials: u64,
    context: &Context<'_>,
    replicates: u32,
) -> Result<Power, PowerError> {
    let truths = truths(claim, conditions, context)?;
    // Resampling within resampling: fewer suffice, the studies average them.
    let context = Context { resamples: 200, permutations: 199, ..*context };
    let chance = |trials: u64| chance(claim, conditions, &truths, trials, &context, replicates);
    let planned = chance(trials);
    let mut ladder = Vec::new();
    for step in LADDER {
        ladder.push(if step == trials { planned } else { chance(step) });
        if ladder.last().is_some_and(|c| c.decided() >= ENOUGH) {
            break;
        }
    }
    let enough =
        ladder.iter().chain([&planned]).filter(|c| c.decided() >= ENOUGH).map(|c| c.trials).min();
    Ok(Power { id: claim.id.clone(), planned, ladder, enough })
}

/// Mean (or share) and standard deviation of one metric in one condition.
#[derive(Clone, Copy)]
struct Truth {
    value: f64,
    sd: f64,
}

/// Truths by condition and metric; only conditions the claim may look at.
type Truths = Vec<(usize, BTreeMap<String, Truth>)>;

fn truths(
    claim: &Claim,
    conditions: &[Condition],
    context: &Context<'_>,
) -> Result<Truths, PowerError> {
    let Some(assume) = &claim.power else { return Err(PowerError::NoTruth) };
    let metrics = claim.expect.metrics();
    let factors: Vec<String> =
        conditions.first().map(|c| c.iter().map(|(f, _)| f.clone()).collect()).unwrap_or_default();
    let rows = match assume {
        Assume::Published { table, .. } => {
            let found = context.published.get(table);
            let found = found.ok_or_else(|| PowerError::NoTable(table.clone()))?;
            read(found, &factors)
                .map_err(|error| PowerError::Table { table: table.clone(), error })?
        }
        Assume::Cells(_) => Vec::new(),
    };
    let (mut all, pools) = (Vec::new(), claim.expect.as_form().scope().pools());
    for (i, condition) in conditions.iter().enumerate() {
        let value_of = |f: &str| condition.value(f);
        if !pools.iter().any(|pool| pool.admits(value_of)) {
            continue;
        }
        let mut here = BTreeMap::new();
        for name in &metrics {
            let truth = match assume {
                Assume::Published { scale, .. } => published_truth(&rows, name, *scale, &value_of),
                Assume::Cells(cells) => cells
                    .iter()
                    .find(|cell| cell.r#where.admits(value_of))
                    .map(|cell| (cell.value, cell.sd)),
            };
            let Some((value, sd)) = truth else { continue };
            let share = Metric::named(name).is_share();
            let words =
                || condition.iter().map(|(f, v)| format!("{f}={v}")).collect::<Vec<_>>().join(", ");
            if share && !(0.0..=1.0).contains(&value) {
                let (metric, condition) = (name.clone(), words());
                return Err(PowerError::NotAShare { metric, condition, value });
            }
            let sd = match sd {
                Some(sd) => sd,
                None if share => 0.0,
                None => {
                    let (metric, condition) = (name.clone(), words());
                    return Err(PowerError::NoDeviation { metric, condition });
                }
            };
            here.insert(name.clone(), Truth { value, sd });
        }
        if here.len() == metrics.len() {
            all.push((i, here));
        }
    }
    if all.is_empty() {
        return Err(PowerError::Nowhere);
    }
    Ok(all)
}

fn published_truth<'a>(
    rows: &[PublishedCell],
    metric: &str,
    scale: f64,
    value_of: &impl Fn(&str) -> Option<&'a str>,
) -> Option<(f64, Option<f64>)> {
    rows.iter()
        .find(|row| row.speaks_of(metric) && selection(&row.pins).admits(value_of))
        .and_then(|row| Some((row.value? * scale, row.sd.map(|sd| sd * scale))))
}

fn chance(
    claim: &Claim,
    conditions: &[Condition],
    truths: &Truths,
    trials: u64,
    context: &Context<'_>,
    replicates: u32,
) -> Chance {
    let factors: Vec<String> = conditions[0].iter().map(|(f, _)| f.clone()).collect();
    let values =
        truths.iter().map(|(i, _)| conditions[*i].iter().map(|(_, v)| v.clone()).collect());
    // Made up anew for every study: only the readings differ.
    let runs = usize::try_from(trials).unwrap_or(usize::MAX);
    let mut study = Observations::simulated(factors, values, &claim.expect.metrics(), runs);
    let seeds = Seeds::new(context.seed, vec![("claim".to_owned(), claim.id.clone())]);
    let (mut supported, mut contradicted) = (0, 0);
    for replicate in 0..replicates {
        let mut stream = seeds.stream(&format!("claims/power/{trials}/{replicate}"));
        for (condition, (_, truths)) in study.conditions.iter_mut().zip(truths) {
            for (name, truth) in truths {
                match condition.made_up(name) {
                    Some(MadeUp::Share(counts)) => stream.events(truth.value, counts),
                    Some(MadeUp::Measure(values)) => {
                        values.fill_with(|| Some(truth.value + truth.sd * stream.normal()));
                    }
                    None => {}
                }
            }
        }
        match judge_observations(claim, &study, context).judgement {
            Judgement::Supported => supported += 1,
            Judgement::Contradicted => contradicted += 1,
            Judgement::Inconclusive | Judgement::CannotBeTested => {}
        }
    }
    let share = |count: u64| real(count) / f64::from(replicates.max(1));
    Chance { trials, supported: share(supported), contradicted: share(contradicted) }
}
