//! A claim as the page shows it: verdict, finding in human words, and every comparison behind it.

mod forest;

use super::template::{fixed, percent};
use crate::claims::published::PublishedCell;
use crate::claims::statement::{Statement, cell_in_words};
use crate::claims::terms::Correction;
use crate::claims::verdict::{CellNumbers, ComparisonVerdict, agreement_in_words, rounded};
use crate::claims::{self, Claim, ClaimVerdict, Judgement, PaperTable, share_of_draws};
use crate::labels::Labels;
use crate::math::exp;
use forest::{Quantity, Strip};
use serde::Serialize;
use std::collections::BTreeMap;

/// A claim and what became of it.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ClaimRow {
    /// Its id in the manifest.
    pub id: String,
    /// The paper's sentence, in its words; empty for a check of our own.
    pub says: String,
    /// What we check besides, in our words; empty for a claim of the paper.
    pub ours: String,
    /// Where it says so.
    pub cite: String,
    /// The verdict's name: `supported`, `contradicted`, `inconclusive`, `cannot-be-tested`.
    pub verdict: String,
    /// The numbers that decided it, in words, with their interval.
    pub numbers: String,
    /// What the paper's own table says: `supports`, `contradicts`, `silent`.
    pub paper_table: String,
    /// Where we and the paper's own table differ, in a sentence; empty where they do not.
    pub differs: String,
    /// How the sentence was made testable, as the manifest's author explains it; may be empty.
    pub why: String,
    /// The rule of the verdict: level, correction, how many comparisons must hold.
    pub rule: String,
    /// What a reader should know beside it.
    pub notes: Vec<String>,
    /// Every comparison.
    pub comparisons: Vec<ComparisonRow>,
    /// What the strip shows, with its unit: `difference, percentage points`; empty where there is no effect to draw.
    pub quantity: String,
    /// The effects and their intervals against the claim's line, an SVG; empty where there is none.
    pub strip: String,
    /// The axis that all strips of the quantity lie on, an SVG.
    pub axis: String,
    /// How many comparisons the strip leaves out: their effects are of another quantity, or there is none.
    pub undrawn: usize,
    /// Whether the strip marks what the paper's own numbers give.
    pub has_paper: bool,
}

/// One comparison of a claim.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ComparisonRow {
    /// Metric and cells.
    pub about: String,
    /// What was found: a verdict's name.
    pub verdict: String,
    /// Effect and interval in words, or why it cannot be tested.
    pub finding: String,
    /// The test and its p-value, corrected, in the direction that was found.
    pub test: String,
    /// What was counted, one line a cell.
    pub cells: Vec<String>,
}

/// Why a file is no list of verdicts.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {error}")]
pub struct NoVerdicts {
    path: String,
    error: serde_json::Error,
}

/// Returns the rows of a list of verdicts, the bytes of `path`; `claims` are the manifest's own, for their reasons, and `published`
/// the paper's numbers by the name of their table, `labels` what readers see for factors and values.
///
/// # Errors
/// Where the bytes are no list of verdicts.
pub(super) fn rows(
    path: &str,
    bytes: Option<&[u8]>,
    claims: &[Claim],
    published: &BTreeMap<String, Vec<PublishedCell>>,
    labels: &Labels,
) -> Result<Vec<ClaimRow>, NoVerdicts> {
    let Some(bytes) = bytes else { return Ok(Vec::new()) };
    let verdicts: Vec<ClaimVerdict> = serde_json::from_slice(bytes)
        .map_err(|error| NoVerdicts { path: path.to_owned(), error })?;
    let why = |id: &str| {
        let claim = claims.iter().find(|claim| claim.id == id);
        claim.and_then(|claim| claim.why.clone()).unwrap_or_default()
    };
    let strips: Vec<Option<Strip>> = verdicts.iter().map(|v| Strip::of(v, published)).collect();
    let mut alike: BTreeMap<&Quantity, Vec<&Strip>> = BTreeMap::new();
    for strip in strips.iter().flatten() {
        alike.entry(&strip.quantity).or_default().push(strip);
    }
    let axes: BTreeMap<_, _> = alike
        .into_iter()
        .map(|(quantity, strips)| (quantity, forest::axis_of(strips.into_iter())))
        .collect();
    let drawn = |verdict: ClaimVerdict, strip: Option<&Strip>| {
        let row = ClaimRow { why: why(&verdict.id), ..row(verdict, labels) };
        let Some(strip) = strip else { return row };
        let axis = &axes[&strip.quantity];
        ClaimRow {
            quantity: strip.quantity.name.clone(),
            strip: strip.draw(axis, &format!("{}: {}", row.id, row.numbers)),
            axis: forest::draw_axis(axis),
            undrawn: row.comparisons.len() - strip.len(),
            has_paper: strip.has_paper(),
            ..row
        }
    };
    Ok(verdicts.into_iter().zip(&strips).map(|(v, strip)| drawn(v, strip.as_ref())).collect())
}

/// Returns which side of what the study compares came out ahead, by the `bytes` of a list of verdicts; `None` where they say nothing
/// of it.
pub(super) fn compared(bytes: Option<&[u8]>, labels: &Labels) -> Option<String> {
    let verdicts: Vec<ClaimVerdict> = serde_json::from_slice(bytes?).ok()?;
    claims::compared(&verdicts, labels)
}

fn row(verdict: ClaimVerdict, labels: &Labels) -> ClaimRow {
    ClaimRow {
        numbers: numbers(&verdict) + &censored(&verdict),
        differs: differs(verdict.judgement, verdict.paper_table).to_owned(),
        rule: rule(&verdict),
        comparisons: verdict.comparisons.iter().map(|c| comparison(c, labels)).collect(),
        verdict: verdict.judgement.to_string(),
        paper_table: verdict.paper_table.to_string(),
        id: verdict.id,
        says: verdict.says.unwrap_or_default(),
        ours: verdict.ours.unwrap_or_default(),
        cite: verdict.cite.unwrap_or_default(),
        why: String::new(),
        notes: verdict.notes,
        ..ClaimRow::default()
    }
}

/// Says where what we find and what the paper's own table shows are at odds.
fn differs(verdict: Judgement, paper_table: PaperTable) -> &'static str {
    match (verdict, paper_table) {
        (Judgement::Supported, PaperTable::Contradicts) => {
            "The paper's own table contradicts its sentence; our trials support it."
        }
        (Judgement::Contradicted, PaperTable::Supports) => {
            "The paper's own table supports its sentence; our trials contradict it."
        }
        _ => "",
    }
}

fn rule(verdict: &ClaimVerdict) -> String {
    let mut rule = format!("Level of significance {}", rounded(verdict.alpha));
    let comparisons = verdict.comparisons.len();
    if comparisons > 1 {
        rule.push_str(&format!("; {} of {comparisons} comparisons must hold", verdict.required));
        if verdict.correction == Correction::Holm {
            rule.push_str(", p-values corrected after Holm");
        }
    }
    if verdict.minimum_n > 0 {
        let n = verdict.minimum_n;
        rule.push_str(&format!("; nothing is judged below {n} runs a cell"));
    }
    if let Some(n) = verdict.trials_to_decide {
        rule.push_str(&format!(
            "; about {n} trials per condition would decide it with 80 % power, if what was seen is the truth"
        ));
    }
    rule + "."
}

/// Says what decided a verdict.
fn numbers(verdict: &ClaimVerdict) -> String {
    match &verdict.comparisons[..] {
        [] => verdict.reason.clone(),
        [only] if effect(only).is_empty() => verdict.reason.clone(),
        [only] => {
            let known = only.statistics.iter().filter(|(_, x)| x.is_finite());
            let parts = [effect(only), agreement_in_words(known), test(only)];
            parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
        }
        all => {
            let count = |judgement| all.iter().filter(|c| c.judgement == judgement).count();
            let hold = count(Judgement::Supported);
            let mut words = vec![match verdict.over {
                Some(_) => share_of_draws(hold, all.len()),
                None => format!("{hold} of {} comparisons hold", all.len()),
            }];
            for (judgement, rest) in [
                (Judgement::Contradicted, "the other way"),
                (Judgement::Inconclusive, "undecided"),
                (Judgement::CannotBeTested, "not testable"),
            ] {
                if count(judgement) > 0 {
                    words.push(format!("{} {rest}", count(judgement)));
                }
            }
            format!("{}; {} must hold", words.join(", "), verdict.required)
        }
    }
}

/// What is said of runs without the measure that they are compared by.
pub(super) const CENSORED: &str = "never reached the measure";

/// Counts in words the runs that never reached what they were compared by; empty where all did.
fn censored(verdict: &ClaimVerdict) -> String {
    let words = |(censored, all)| format!("; {censored} of {all} runs compared {CENSORED}");
    verdict.censored().map(words).unwrap_or_default()
}

fn comparison(comparison: &ComparisonVerdict, labels: &Labels) -> ComparisonRow {
    let reason = comparison.reason.clone().filter(|reason| !reason.is_empty());
    ComparisonRow {
        about: Statement::read(&comparison.about)
            .map_or_else(|| comparison.about.clone(), |statement| statement.in_words(labels)),
        verdict: comparison.judgement.to_string(),
        finding: reason.unwrap_or_else(|| effect(comparison)),
        test: test(comparison),
        cells: comparison.cells.iter().map(|c| cell(c, labels)).collect(),
    }
}

/// Writes an effect: `+30 percentage points (98 % interval +12 to +47)`; empty where there is none.
fn effect(comparison: &ComparisonVerdict) -> String {
    let Some(effect) = &comparison.effect else { return String::new() };
    let (value, low, high) = (effect.value, effect.low, effect.high);
    if ![value, low, high].iter().all(|x| x.is_finite()) {
        return String::new();
    }
    let of_logs = comparison.about.contains("mean log of");
    // A difference of logarithms is a ratio, and that is how people speak of it.
    let ratio = |x: f64| percent(100.0 * (exp(x) - 1.0));
    let signed = |x: f64, digits| {
        let text = fixed(x, digits);
        let positive = x > 0.0 && text.contains(|c: char| ('1'..='9').contains(&c));
        format!("{}{text}", if positive { "+" } else { "" })
    };
    let points = |x: f64| signed(100.0 * x, 0);
    let share = |x: f64| format!("{}\u{a0}%", fixed(100.0 * x, 0));
    let digits = digits(high - low);
    let plain = |x: f64| signed(x, digits);
    let said = |words: &str, show: &dyn Fn(f64) -> String| {
        let known = Some(effect.confidence).filter(|confidence| confidence.is_finite());
        let confidence = 100.0 * known.unwrap_or(0.95);
        // Claims at a strict level have intervals that are not of 100 %.
        let digits = if confidence > 99.5 { 4 } else { 0 };
        format!(
            "{}{words} ({}\u{a0}% interval {} to {})",
            show(value),
            fixed(confidence, digits),
            show(low),
            show(high)
        )
    };
    match effect.name.as_ref() {
        "risk-difference" => said(" percentage points", &points),
        "largest-difference" if comparison.test.contains("newcombe") => {
            format!("largest difference {}", said(" percentage points", &points))
        }
        "share" => said("", &share),
        "share-of-pairs" => said(" of pairs", &share),
        "relative-difference" => said(" relative difference", &|x| percent(100.0 * x)),
        "mean-difference" if of_logs => said(" difference", &ratio),
        "mean-difference" => said(" difference of means", &plain),
        "mean" => said(" on average", &|x| fixed(x, if x.abs() < 10.0 { 3 } else { 1 })),
        "spearman" => format!("rank correlation {}", said("", &plain)),
        "cliff-delta" => format!("Cliff's delta {}", said("", &plain)),
        "rmse" => format!("root mean square error {}", said("", &|x| fixed(x, 3))),
        other => format!("{} {}", other.replace('-', " "), said("", &plain)),
    }
}

/// Writes a test: `p = 0.0018 (welch)`, in the direction that was found.
fn test(comparison: &ComparisonVerdict) -> String {
    let name = test_name(&comparison.test);
    let (of, corrected, raw) = match comparison.judgement {
        Judgement::Contradicted => {
            (" for the opposite", comparison.p_against_corrected, comparison.p_against)
        }
        _ => ("", comparison.p_for_corrected, comparison.p_for),
    };
    let Some(p) = corrected.or(raw) else { return name };
    let p = if p < 0.0001 {
        "p < 0.0001".to_owned()
    } else {
        format!("p = {}", fixed(p, if p < 0.01 { 4 } else { 2 }))
    };
    format!("{p}{of} ({name})")
}

/// Returns how many decimals tell the ends of an interval of this width apart: two figures of it.
fn digits(width: f64) -> usize {
    const MOST: usize = 6;
    if width == 0.0 {
        return 2;
    }
    let (mut digits, mut width) = (0, width);
    while width < 10.0 && digits < MOST {
        width *= 10.0;
        digits += 1;
    }
    digits
}

/// Returns what people call the test `name`.
fn test_name(name: &str) -> String {
    let known = match name {
        "fisher-exact" => "Fisher's exact test",
        "chi-square" => "chi-squared test",
        "cochran-armitage" => "Cochran-Armitage trend test",
        "welch" => "Welch's t-test",
        "anova" => "analysis of variance",
        "mann-whitney" => "Mann-Whitney U test",
        "brown-forsythe" => "Brown-Forsythe test of spread",
        "spearman" => "Spearman's rank correlation, permuted",
        "tost-newcombe" => "two one-sided tests, Newcombe's interval",
        "tost-welch" => "two one-sided tests, Welch's",
        "binomial" => "exact binomial test",
        "score" => "score test",
        "count" => "every trial counted",
        "bootstrap-over-cells" => "bootstrap over cells",
        other => return other.replace('-', " "),
    };
    known.to_owned()
}

/// Writes a cell: `start=A, strategy=random: 96 %, 48 of 50 runs`.
fn cell(cell: &CellNumbers, labels: &Labels) -> String {
    let (trials, reached) = (cell.trials, cell.reached);
    let mut parts = Vec::new();
    match (cell.successes, cell.mean) {
        (Some(successes), Some(share)) => {
            let share = fixed(100.0 * share, 0);
            parts.push(format!("{share}\u{a0}%, {successes} of {trials} runs"));
        }
        (_, mean) => {
            if let Some(mean) = mean {
                let sd = cell.sd.map(|sd| format!(" ± {}", fixed(sd, 2))).unwrap_or_default();
                parts.push(format!("mean {}{sd}", fixed(mean, 2)));
            }
            parts.push(if reached < trials {
                format!("{reached} of {trials} runs, {} never got there", trials - reached)
            } else {
                format!("{trials} runs")
            });
        }
    }
    if let Some(published) = cell.published {
        parts.push(format!("paper {}", fixed(published, 2)));
    }
    format!("{}: {}", cell_in_words(&cell.cell, labels), parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels;
    use serde_json::{Value, json};

    fn one(verdict: &str, comparisons: &[Value]) -> ClaimRow {
        let verdict = json!([{
            "id": "D1", "says": "it is so", "verdict": verdict, "paper-table": "supports",
            "reason": "for a reason", "alpha": 0.05, "required": comparisons.len(), "correction": "holm",
            "minimum-n": 3, "comparisons": comparisons,
        }]);
        let claim = json!({
            "id": "D1", "ours": "it is so", "why": "the claim's own words", "expect": {"untestable": {"because": "so"}},
        });
        let claims = [serde_json::from_value(claim).unwrap()];
        rows(
            "claims.json",
            Some(verdict.to_string().as_bytes()),
            &claims,
            &BTreeMap::new(),
            &labels::NONE,
        )
        .unwrap()
        .remove(0)
    }

    fn compared(verdict: &str) -> Value {
        json!({
            "about": "success: (start=A) > (start=B)", "verdict": verdict, "test": "fisher-exact",
            "p-for": 0.01, "p-for-corrected": 0.02, "p-against-corrected": 0.00001,
            "effect": {"name": "risk-difference", "value": 0.3, "low": -0.0001, "high": 0.47, "confidence": 0.98},
            "cells": [
                {"cell": "start=A", "trials": 50, "reached": 50, "successes": 48, "mean": 0.96},
                {"cell": "start=B", "trials": 50, "reached": 44, "mean": 20.5, "sd": 2.25, "published": 21.0},
            ],
        })
    }

    #[test]
    fn a_single_comparison_is_told_with_its_interval_and_who_never_got_there() {
        let row = one("supported", &[compared("supported")]);
        assert_eq!(
            row.numbers,
            "+30 percentage points (98\u{a0}% interval 0 to +47); p = 0.02 (Fisher's exact test); 6 of 100 runs compared \
             never reached the measure"
        );
        assert_eq!((row.differs.as_str(), row.why.as_str()), ("", "the claim's own words"));
        assert_eq!(
            row.comparisons[0].cells,
            [
                "start=A: 96\u{a0}%, 48 of 50 runs",
                "start=B: mean 20.50 ± 2.25, 44 of 50 runs, 6 never got there, paper 21.00"
            ]
        );
    }

    #[test]
    fn a_contradiction_is_held_against_the_papers_own_table() {
        let row = one("contradicted", &[compared("contradicted"), compared("inconclusive")]);
        assert!(
            row.numbers
                .starts_with("0 of 2 comparisons hold, 1 the other way, 1 undecided; 2 must hold")
        );
        assert_eq!(row.comparisons[0].test, "p < 0.0001 for the opposite (Fisher's exact test)");
        assert_eq!(
            row.differs,
            "The paper's own table supports its sentence; our trials contradict it."
        );
        assert_eq!(
            row.rule,
            "Level of significance 0.05; 2 of 2 comparisons must hold, p-values corrected after Holm; nothing is \
             judged below 3 runs a cell."
        );
    }

    #[test]
    fn differences_of_logarithms_are_told_as_ratios() {
        let mut logs = compared("supported");
        logs["about"] = "mean log of distance-m-at-70: (a) < (b)".into();
        logs["effect"] = json!({"name": "mean-difference", "value": -0.3, "low": -0.46, "high": -0.14, "confidence": 0.9});
        let row = one("supported", &[logs]);
        assert!(row.numbers.starts_with(
            "\u{2212}26\u{a0}% difference (90\u{a0}% interval \u{2212}37\u{a0}% to \u{2212}13\u{a0}%); p = 0.02"
        ), "{}", row.numbers);
    }

    #[test]
    fn what_has_no_effect_keeps_its_reason_and_what_is_no_list_is_refused() {
        assert_eq!(one("cannot-be-tested", &[]).numbers, "for a reason");
        assert!(
            rows("claims.json", Some(b"{}"), &[], &BTreeMap::new(), &labels::NONE)
                .unwrap_err()
                .to_string()
                .starts_with("claims.json: ")
        );
        assert!(
            rows("claims.json", None, &[], &BTreeMap::new(), &labels::NONE).unwrap().is_empty()
        );
    }
}
