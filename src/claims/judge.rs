//! From a claim and the trials to a verdict.

use super::cells::Where;
use super::expect::{Expect, Terms};
use super::metric::Metric;
use super::observations::Observations;
use super::terms::{Censored, Correction, Sides};
use super::verdict::{CellNumbers, ComparisonVerdict, Effect, Judgement, Verdict};
use super::{Claim, comparison, equality, level, published, sign, spread};
use crate::rng::{Seeds, Stream};
use crate::stats::distribution::normal_quantile;
use crate::stats::multiple::holm;
use crate::stats::proportion::Proportion;
use crate::stats::real;
use crate::stats::summary::{Summary, median};
use crate::table::Table;
use std::collections::BTreeMap;

/// Power that the numbers of trials named in verdicts would have had.
const POWER: f64 = 0.8;

/// Beyond this a number of trials is no plan any more.
const MOST_TRIALS: f64 = 1e6;

/// What a verdict depends on besides the trials.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The paper's tables by name (contract: [`published`]).
    pub published: &'a BTreeMap<String, Table>,
    /// Factors over which the trials share their noise.
    pub shared_noise: &'a [String],
    /// Seed of resampling: the experiment's.
    pub seed: u64,
    /// Bootstrap resamples.
    pub resamples: u32,
    /// Permutations drawn.
    pub permutations: u32,
}

impl<'a> Context<'a> {
    /// The context of a study: 2000 bootstrap resamples, 9999 permutations.
    pub fn new(
        published: &'a BTreeMap<String, Table>,
        shared_noise: &'a [String],
        seed: u64,
    ) -> Self {
        Self { published, shared_noise, seed, resamples: 2000, permutations: 9999 }
    }
}

/// Judges `claim` by the trials table (`results/trials.csv`).
///
/// # Errors
/// Where the table has not the columns of the contract ([`Observations::read`]).
pub fn judge(claim: &Claim, trials: &Table, context: &Context<'_>) -> Result<Verdict, String> {
    Ok(judge_observations(claim, &Observations::read(trials)?, context))
}

/// Judges `claim` by trials already read: for many claims on one table.
pub fn judge_observations(
    claim: &Claim,
    observations: &Observations,
    context: &Context<'_>,
) -> Verdict {
    let bench = Bench { claim: &claim.id, observations, context, terms: claim.expect.terms() };
    let drafts = match &claim.expect {
        Expect::Less(form) => comparison::less(&bench, form),
        Expect::Greater(form) => comparison::greater(&bench, form),
        Expect::Rank(form) => comparison::rank(&bench, form),
        Expect::Trend(form) => comparison::trend(&bench, form),
        Expect::Equivalent(form) => equality::equivalent(&bench, form),
        Expect::Homogeneous(form) => equality::homogeneous(&bench, form),
        Expect::Between(form) => level::between(&bench, form),
        Expect::Share(form) => level::share(&bench, form),
        Expect::SignTest(form) => vec![sign::sign_test(&bench, form)],
        Expect::Spread(form) => spread::spread(&bench, form),
        Expect::CorrelationWithPublished(form) => vec![published::correlation(&bench, form)],
        Expect::RmseWithPublished(form) => vec![published::rmse(&bench, form)],
    };
    conclude(claim, &bench, drafts)
}

/// Everything a form needs at hand.
pub(super) struct Bench<'a> {
    pub(super) claim: &'a str,
    pub(super) observations: &'a Observations,
    pub(super) context: &'a Context<'a>,
    pub(super) terms: Terms,
}

/// One comparison before correction.
pub(super) struct Draft {
    pub(super) about: String,
    pub(super) test: &'static str,
    pub(super) cells: Vec<CellNumbers>,
    /// Conditions whose number of trials the evidence grows with; empty where it grows with something else.
    pub(super) conditions: Vec<usize>,
    pub(super) evidence: Result<Evidence, String>,
    pub(super) notes: Vec<String>,
}

/// What a test says.
pub(super) struct Evidence {
    pub(super) p_for: f64,
    pub(super) p_against: f64,
    pub(super) statistics: Vec<(&'static str, f64)>,
    pub(super) effect: Option<Effect>,
}

/// The runs of one cell or pool.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) conditions: Vec<usize>,
    /// One per run that counts; infinite for censored runs where they rank last.
    pub(super) values: Vec<f64>,
    /// For shares.
    pub(super) proportion: Option<Proportion>,
    pub(super) summary: Summary,
}

/// Cells gathered for one comparison.
pub(super) struct Gathered {
    pub(super) numbers: Vec<CellNumbers>,
    pub(super) conditions: Vec<usize>,
    pub(super) groups: Result<Vec<Group>, String>,
    pub(super) notes: Vec<String>,
}

impl Bench<'_> {
    /// The runs of `cells`, or why they cannot be compared: nothing there, failed or censored runs, too few of
    /// them, a condition in two cells, or noise in common.
    pub(super) fn gather(&self, cells: &[Where], metric: &Metric) -> Gathered {
        let (mut numbers, mut groups, mut conditions) = (Vec::new(), Vec::new(), Vec::new());
        let mut reasons = Vec::new();
        reasons.extend(self.observations.lacks(metric));
        for cell in cells {
            let (group, seen, fault) = self.group(cell, metric);
            for &i in &group.conditions {
                if conditions.contains(&i) {
                    let name = self.observations.name(i);
                    reasons.push(format!("the condition {name} is in two of the cells compared"));
                } else {
                    conditions.push(i);
                }
            }
            numbers.push(seen);
            groups.push(group);
            reasons.extend(fault);
        }
        reasons.extend(self.shared_noise(&conditions));
        let notes = if self.terms.censored == Censored::ReachedOnly && !metric.is_share() {
            unequal_reach(&numbers, self.terms.alpha)
        } else {
            Vec::new()
        };
        let groups = reasons.into_iter().next().map_or(Ok(groups), Err);
        Gathered { numbers, conditions, groups, notes }
    }

    /// The refusal of trials that are not independent.
    pub(super) fn shared_noise(&self, conditions: &[usize]) -> Option<String> {
        let (one, other) = self.observations.sharing(conditions, self.context.shared_noise)?;
        Some(format!(
            "trials of ({one}) and ({other}) share their noise (over {}), and this test needs independent \
             trials; a sign-test with `pairs: trials` does not",
            self.context.shared_noise.join(", ")
        ))
    }

    /// The runs of one cell, and what is wrong with them.
    pub(super) fn group(
        &self,
        cell: &Where,
        metric: &Metric,
    ) -> (Group, CellNumbers, Option<String>) {
        let conditions = self.observations.select(cell);
        let readings = self.observations.readings(&conditions, metric);
        let trials = readings.values.len() as u64 + readings.failed;
        let reached: Vec<f64> = readings.values.iter().flatten().copied().collect();
        let summary = Summary::of(&reached);
        let proportion = metric.is_share().then(|| {
            let successes = reached.iter().filter(|&&x| x == 1.0).count() as u64;
            Proportion::new(successes, reached.len() as u64)
        });
        let finite = |x: f64| x.is_finite().then_some(x);
        let numbers = CellNumbers {
            cell: cell.to_string(),
            trials,
            reached: reached.len() as u64,
            successes: proportion.map(|p| p.successes),
            mean: finite(summary.mean),
            sd: finite(summary.sd).filter(|_| proportion.is_none()),
            median: finite(median(&reached)).filter(|_| proportion.is_none()),
            published: None,
        };
        let censored = readings.values.len() - reached.len();
        let mut values = reached;
        if self.terms.censored == Censored::Worst {
            values.resize(values.len() + censored, f64::INFINITY);
        }
        let n = values.len() as u64;
        let fault = if trials == 0 {
            Some(format!("no trial matches ({cell})"))
        } else if readings.failed > 0 {
            Some(format!("{} of {trials} trials of ({cell}) failed to run", readings.failed))
        } else if censored > 0 && self.terms.censored == Censored::Refuse {
            Some(format!(
                "{censored} of {trials} runs of ({cell}) never reached {metric}; say with `censored` whether \
                 those that did are compared (reached-only) or the others rank last (worst)"
            ))
        } else if n < self.terms.minimum_runs {
            let minimum = self.terms.minimum_runs;
            Some(format!("({cell}) has {n} runs to compare, fewer than the minimum of {minimum}"))
        } else {
            None
        };
        (Group { conditions, values, proportion, summary }, numbers, fault)
    }

    /// Confidence of the interval that says the same as the test.
    pub(super) fn confidence(&self) -> f64 {
        match self.terms.sides {
            Sides::One => 1.0 - 2.0 * self.terms.alpha,
            Sides::Two => 1.0 - self.terms.alpha,
        }
    }

    /// The resampling stream of one comparison.
    pub(super) fn stream(&self, about: &str) -> Stream {
        let coordinates = vec![("claim".to_owned(), self.claim.to_owned())];
        Seeds::new(self.context.seed, coordinates).stream(&format!("claims/{about}"))
    }
}

/// Says where the share of runs that reached a measure differs between cells: the comparison is then one of
/// those that got there.
fn unequal_reach(cells: &[CellNumbers], alpha: f64) -> Vec<String> {
    if cells.iter().all(|c| c.reached == c.trials) || cells.iter().any(|c| c.trials == 0) {
        return Vec::new();
    }
    let reach: Vec<_> = cells.iter().map(|c| Proportion::new(c.reached, c.trials)).collect();
    let p = match reach[..] {
        [a, b] => crate::stats::proportion::fisher_exact(a, b).two_sided,
        _ => crate::stats::proportion::chi_square_homogeneity(&reach).p,
    };
    let listed: Vec<String> =
        cells.iter().map(|c| format!("{} of {} ({})", c.reached, c.trials, c.cell)).collect();
    let differ = if p <= alpha {
        "; the cells differ in this, so the runs compared are a selection"
    } else {
        ""
    };
    vec![format!("reached by {}{differ}", listed.join(", "))]
}

/// Groups that do not vary at all were not drawn at random, and no test of means applies.
pub(super) fn varies(groups: &[&Group]) -> Result<(), String> {
    if let Some(small) = groups.iter().find(|g| g.summary.n < 2) {
        return Err(format!("a mean of {} runs has no known spread", small.summary.n));
    }
    if groups.iter().all(|g| g.proportion.is_none() && g.summary.sd == 0.0) {
        return Err(
            "no value varies within its cell: nothing was drawn at random, so no test applies"
                .into(),
        );
    }
    Ok(())
}

fn conclude(claim: &Claim, bench: &Bench<'_>, drafts: Vec<Draft>) -> Verdict {
    let terms = bench.terms;
    let p_of = |pick: fn(&Evidence) -> f64| -> Vec<f64> {
        // One that cannot be tested still counts in the family.
        drafts.iter().map(|d| d.evidence.as_ref().map_or(1.0, pick)).collect()
    };
    let (raw_for, raw_against) = (p_of(|e| e.p_for), p_of(|e| e.p_against));
    let correct = |raw: &[f64]| match terms.correction {
        Correction::Holm => holm(raw),
        Correction::None => raw.to_vec(),
    };
    let (p_for, p_against) = (correct(&raw_for), correct(&raw_against));
    let total = drafts.len();
    let required = terms.at_least.unwrap_or(total).min(total);
    let mut notes = Vec::new();
    let mut comparisons = Vec::with_capacity(total);
    for (i, draft) in drafts.into_iter().enumerate() {
        for note in draft.notes {
            let note = if total > 1 { format!("{}: {note}", draft.about) } else { note };
            notes.push(note);
        }
        let (judgement, reason, evidence) = match draft.evidence {
            Err(reason) => (Judgement::CannotBeTested, Some(reason), None),
            Ok(evidence) => {
                let judgement = if p_for[i] <= terms.alpha {
                    Judgement::Supported
                } else if p_against[i] <= terms.alpha {
                    Judgement::Contradicted
                } else {
                    Judgement::Inconclusive
                };
                (judgement, None, Some(evidence))
            }
        };
        let trials_to_decide = (judgement == Judgement::Inconclusive)
            .then(|| {
                let trials = bench.observations.trials_per_condition(&draft.conditions);
                let p = raw_for[i].min(raw_against[i]);
                trials_to_decide(trials, p, &terms, total)
            })
            .flatten();
        comparisons.push(ComparisonVerdict {
            about: draft.about,
            judgement,
            reason,
            test: draft.test,
            p_for: evidence.as_ref().map(|_| (raw_for[i], p_for[i])),
            p_against: evidence.as_ref().map(|_| (raw_against[i], p_against[i])),
            statistics: evidence.as_ref().map(|e| e.statistics.clone()).unwrap_or_default(),
            effect: evidence.and_then(|e| e.effect),
            cells: draft.cells,
            trials_to_decide,
        });
    }
    let (judgement, reason) = sum_up(&comparisons, required, &terms);
    let open: Vec<Option<u64>> = comparisons
        .iter()
        .filter(|c| c.judgement == Judgement::Inconclusive)
        .map(|c| c.trials_to_decide)
        .collect();
    let trials_to_decide = if judgement == Judgement::Inconclusive && !open.contains(&None) {
        open.into_iter().flatten().max()
    } else {
        None
    };
    Verdict {
        id: claim.id.clone(),
        says: claim.says.clone(),
        cite: claim.cite.clone(),
        paper_table: claim.paper_table,
        judgement,
        reason,
        form: claim.expect.form(),
        alpha: terms.alpha,
        correction: match terms.correction {
            Correction::Holm => "holm",
            Correction::None => "none",
        },
        required,
        minimum_n: terms.minimum_n,
        comparisons,
        notes,
        trials_to_decide,
    }
}

/// The claim's judgement from those of its comparisons, and a sentence for it.
fn sum_up(
    comparisons: &[ComparisonVerdict],
    required: usize,
    terms: &Terms,
) -> (Judgement, String) {
    let total = comparisons.len();
    let count = |j| comparisons.iter().filter(|c| c.judgement == j).count();
    let (supported, contradicted) = (count(Judgement::Supported), count(Judgement::Contradicted));
    let untestable = count(Judgement::CannotBeTested);
    let judgement = if total == 0 {
        Judgement::CannotBeTested
    } else if supported >= required {
        Judgement::Supported
    } else if contradicted > total - required {
        Judgement::Contradicted
    } else if total - untestable < required {
        Judgement::CannotBeTested
    } else {
        Judgement::Inconclusive
    };
    let first_reason = comparisons.iter().find_map(|c| c.reason.clone());
    let reason = match (judgement, total) {
        (Judgement::CannotBeTested, _) => {
            first_reason.unwrap_or_else(|| "the claim compares nothing".to_owned())
        }
        (_, 1) => {
            let (p, which) = match judgement {
                Judgement::Contradicted => (comparisons[0].p_against, "of the opposite "),
                _ => (comparisons[0].p_for, ""),
            };
            let p = p.map_or(1.0, |(_, corrected)| corrected);
            format!("p {which}{p:.2e} at alpha {} by {}", terms.alpha, comparisons[0].test)
        }
        _ => format!(
            "{supported} of {total} comparisons hold, {contradicted} hold the other way, {untestable} cannot be \
             tested; {required} must hold, at alpha {}",
            terms.alpha
        ),
    };
    (judgement, reason)
}

/// Trials per condition that would have decided a comparison with 80 % power, if what was seen is the truth.
///
/// A test statistic grows with the root of the number of trials, so n' = n ((z_alpha + z_power) / z_seen)²,
/// with alpha shared among the comparisons of the claim as Bonferroni would. `None` where nothing was seen or
/// more than a million would be needed.
fn trials_to_decide(trials: u64, p: f64, terms: &Terms, comparisons: usize) -> Option<u64> {
    let tails = if terms.sides == Sides::Two { 2.0 } else { 1.0 };
    let shared = match terms.correction {
        Correction::Holm => real(comparisons.max(1) as u64),
        Correction::None => 1.0,
    };
    let seen = -normal_quantile((p / tails).min(1.0));
    let needed = -normal_quantile(terms.alpha / shared / tails) + normal_quantile(POWER);
    let ratio = needed / seen;
    let found = (real(trials) * ratio * ratio).ceil();
    if trials == 0 || seen.is_nan() || seen <= 0.0 || found > MOST_TRIALS {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole, positive and below a million"
    )]
    let found = found as u64;
    Some(found.max(trials + 1))
}
