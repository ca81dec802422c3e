//! From a claim and the trials to a verdict.

use super::cannot_test::CannotTest;
use super::claim::Claim;
use super::context::Context;
use super::gather::{Bench, COUNT, Draft, Evidence};
use super::metric::WALL_TIME;
use super::observations::{Observations, TrialsTableError};
use super::terms::{Correction, Sides, Terms};
use super::verdict::{CellNumbers, ClaimVerdict, ComparisonVerdict, Judgement};
use super::words::Words;
use crate::stats::distribution::normal_quantile;
use crate::stats::multiple::holm;
use crate::stats::real;
use crate::table::Table;

/// Power that the numbers of trials named in verdicts would have had.
const POWER: f64 = 0.8;

/// Beyond this a number of trials is no plan any more.
const MOST_TRIALS: f64 = 1e6;

/// Judges `claim` by the trials table (`results/trials.csv`).
///
/// # Errors
/// Where the table has not the columns of the contract ([`Observations::read`]).
pub fn judge(
    claim: &Claim,
    trials: &Table,
    context: &Context<'_>,
) -> Result<ClaimVerdict, TrialsTableError> {
    Ok(judge_observations(claim, &Observations::read(trials)?, context))
}

/// Judges `claim` by trials already read: for many claims on one table.
pub fn judge_observations(
    claim: &Claim,
    observations: &Observations,
    context: &Context<'_>,
) -> ClaimVerdict {
    let of_these = (!claim.only.is_all()).then(|| observations.only(&claim.only));
    let observations = of_these.as_ref().unwrap_or(observations);
    let bench =
        Bench { claim: &claim.id, observations, context, terms: claim.expect.as_form().terms() };
    let machine = claim.expect.metrics().into_iter().find(|m| m.starts_with(WALL_TIME));
    let drafts = match machine {
        Some(metric) if !claim.circumstance => {
            let reason = CannotTest::OfTheMachine(metric.clone());
            vec![Draft::untestable(metric, reason)]
        }
        _ => claim.expect.as_form().judge(&bench),
    };
    conclude(claim, &bench, drafts)
}

/// Returns the verdict on a claim for which nothing was measured, for this `reason`.
pub fn not_measured(claim: &Claim, reason: &str, context: &Context<'_>) -> ClaimVerdict {
    let observations = Observations::default();
    let terms = claim.expect.as_form().terms();
    let bench = Bench { claim: &claim.id, observations: &observations, context, terms };
    let about = claim.expect.metrics().join(" and ");
    conclude(claim, &bench, vec![Draft::untestable(about, CannotTest::Stated(reason.to_owned()))])
}

fn conclude(claim: &Claim, bench: &Bench<'_>, drafts: Vec<Draft>) -> ClaimVerdict {
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
    let required = terms.at_least.unwrap_or(total).clamp(1, total.max(1));
    let mut notes = Vec::new();
    let mut comparisons = Vec::with_capacity(total);
    for (i, draft) in drafts.into_iter().enumerate() {
        for note in draft.notes {
            let note = if total > 1 { format!("{}: {note}", draft.about) } else { note };
            notes.push(note);
        }
        let (judgement, reason, evidence) = match draft.evidence {
            Err(reason) => (Judgement::CannotBeTested, Some(reason.to_string()), None),
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
        let tested = evidence.is_some() && draft.test != COUNT;
        comparisons.push(ComparisonVerdict {
            about: draft.about,
            judgement,
            reason,
            test: draft.test.into(),
            p_for: tested.then_some(raw_for[i]),
            p_for_corrected: tested.then_some(p_for[i]),
            p_against: tested.then_some(raw_against[i]),
            p_against_corrected: tested.then_some(p_against[i]),
            statistics: evidence.iter().flat_map(|e| e.statistics.iter().copied()).collect(),
            effect: evidence.and_then(|e| e.effect),
            cells: draft.cells,
            trials_to_decide,
        });
    }
    let over = over_draws(claim, bench.context, total);
    let (judgement, reason) = sum_up(&comparisons, required, &terms, over);
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
    let (says, ours) = match claim.words() {
        Words::Says(text) => (Some(text), None),
        Words::Ours(text) => (None, Some(text)),
    };
    ClaimVerdict {
        id: claim.id.clone(),
        says,
        ours,
        cite: claim.cite.clone(),
        paper_table: claim.papers_table(),
        judgement,
        reason,
        form: claim.expect.form().into(),
        alpha: terms.alpha,
        correction: terms.correction,
        over: over.map(str::to_owned),
        required,
        minimum_n: terms.minimum_n,
        comparisons,
        notes,
        trials_to_decide,
    }
}

/// Returns the factor of draws, where `claim` is repeated over its values alone and makes one comparison for each.
fn over_draws<'c>(claim: &Claim, context: &Context<'c>, comparisons: usize) -> Option<&'c str> {
    let draws = context.draws?;
    let scope = claim.expect.as_form().scope();
    let mut repeated =
        scope.selections.iter().filter(|(pointer, _)| pointer.starts_with("/for-each/"));
    let (_, each) = repeated.next().filter(|_| scope.measured.len() == 1)?;
    let alone = repeated.next().is_none() && each.0.len() == 1;
    (alone && each.0.get(draws)?.0.len() == comparisons).then_some(draws)
}

/// Says in what share of draws a claim holds.
pub fn share_of_draws(hold: usize, of: usize) -> String {
    let percent = 100.0 * real(hold as u64) / real(of.max(1) as u64);
    format!("holds in {percent:.0} % of draws ({hold} of {of})")
}

/// Sums up the judgements of a claim's comparisons: the claim's own, and a sentence for it.
fn sum_up(
    comparisons: &[ComparisonVerdict],
    required: usize,
    terms: &Terms,
    over: Option<&str>,
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
        (_, 1) if comparisons[0].test == COUNT && comparisons[0].effect.is_some() => {
            "one number of all trials, held against the bounds".to_owned()
        }
        (_, 1) if comparisons[0].test == COUNT => {
            let counted = comparisons[0].cells.first();
            let of = |pick: fn(&CellNumbers) -> u64| counted.map_or(0, pick);
            format!(
                "{} of {} trials that reached it, {} in all",
                of(|cell| cell.successes.unwrap_or(0)),
                of(|cell| cell.reached),
                of(|cell| cell.trials)
            )
        }
        (_, 1) => {
            let (p, which) = match judgement {
                Judgement::Contradicted => (comparisons[0].p_against_corrected, "of the opposite "),
                _ => (comparisons[0].p_for_corrected, ""),
            };
            let p = p.unwrap_or(1.0);
            format!("p {which}{p:.2e} at alpha {} by {}", terms.alpha, comparisons[0].test)
        }
        _ if over.is_some() => format!(
            "{}, the other way in {contradicted}, {untestable} cannot be tested; {required} must hold, at alpha {}",
            share_of_draws(supported, total),
            terms.alpha
        ),
        _ => format!(
            "{supported} of {total} comparisons hold, {contradicted} hold the other way, {untestable} cannot be \
             tested; {required} must hold, at alpha {}",
            terms.alpha
        ),
    };
    (judgement, reason)
}

/// Returns the trials per condition that would have decided a comparison with 80 % power, if what was seen is the truth.
///
/// A test statistic grows with the root of the number of trials, so `n' = n ((z_alpha + z_power) / z_seen)²`,
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
