//! Claims on measures at levels of coverage: runs count once, the paper's n stands beside ours, ratios agree or not.

use super::*;
use crate::math::{exp, ln};

/// Printed means of `distance-m` at 80 and 95 % in three environments, without prior and with two of them.
const PRINTED: [(&str, [[f64; 2]; 3]); 3] = [
    ("basic", [[30.0, 36.0], [16.0, 28.0], [22.0, 29.0]]),
    ("office", [[180.0, 300.0], [120.0, 280.0], [150.0, 290.0]]),
    ("open", [[80.0, 190.0], [60.0, 140.0], [78.0, 175.0]]),
];
const PRIORS: [&str; 3] = ["none", "floor-plan", "footprint"];

/// Makes up twelve runs a cell around `mean(printed)`, spread by a factor that grows with the trial's number; trials of
/// `late` never reach 95 %.
fn runs(mean: impl Fn(f64) -> f64, late: &[i64]) -> Table {
    let columns =
        ["key", "environment", "prior", "trial", "outcome", "distance-m-at-80", "distance-m-at-95"];
    let mut table = Table::new(columns);
    for (environment, cells) in PRINTED {
        for (prior, [at_80, at_95]) in PRIORS.iter().zip(cells) {
            for trial in 0..12_i64 {
                // Both coverages of a run are long or short together.
                let run = exp(0.02 * (f64::from(u8::try_from(trial).unwrap()) - 5.5));
                let end = (!late.contains(&trial)).then_some(mean(at_95) * run);
                table.push(vec![
                    "k".into(),
                    environment.into(),
                    (*prior).into(),
                    trial.into(),
                    "explored".into(),
                    (mean(at_80) * run).into(),
                    end.into(),
                ]);
            }
        }
    }
    table
}

pub(super) fn printed() -> BTreeMap<String, Table> {
    let mut table = Table::new(["environment", "prior", "coverage-percent", "value", "sd", "n"]);
    for (environment, cells) in PRINTED {
        for (prior, values) in PRIORS.iter().zip(cells) {
            for (percent, value) in [80, 95].into_iter().zip(values) {
                table.push(vec![
                    environment.into(),
                    (*prior).into(),
                    percent.into(),
                    value.into(),
                    (0.07 * value).into(),
                    10.into(),
                ]);
            }
        }
    }
    [("distance-m".to_owned(), table)].into()
}

fn judged(trials: &Table, expect: &str) -> ClaimVerdict {
    let published = printed();
    judge(&claim(expect), trials, &Context::new(&published, &[], 7)).unwrap()
}

fn statistic(verdict: &ClaimVerdict, name: &str) -> f64 {
    let found = verdict.comparisons[0].statistics.get(name);
    found.unwrap_or_else(|| panic!("no {name}: {:?}", verdict.comparisons[0]))
}

const BOTH: &str = "metric: [distance-m-at-80, distance-m-at-95]";

#[test]
fn coverages_of_one_run_count_once() {
    let expect = format!(
        "{{less: {{{BOTH}, per-run: mean-log, where: {{environment: basic, prior: floor-plan}}, \
         than: {{where: {{environment: basic, prior: none}}}}, minimum-n: 12}}}}"
    );
    let found = judged(&runs(|x| x, &[]), &expect);
    let [only] = &found.comparisons[..] else { panic!("one comparison of both coverages") };
    assert_eq!((only.cells[0].trials, only.cells[0].reached), (12, 12));
    // ln(16/30) and ln(28/36) on average.
    let expected = f64::midpoint(ln(16.0 / 30.0), ln(28.0 / 36.0));
    assert_close(only.effect.as_ref().unwrap().value, expected, 1e-9);
    assert!(only.about.starts_with("mean log of distance-m-at-80, distance-m-at-95: "));
}

#[test]
fn a_shrinking_gain_is_a_ratio_of_two_coverages_of_one_run() {
    let shrinks = |direction: &str| {
        let expect = format!(
            "{{{direction}: {{metric: [distance-m-at-95, distance-m-at-80], per-run: log-ratio, \
             where: {{environment: basic, prior: floor-plan}}, than: {{where: {{environment: basic, prior: none}}}}}}}}"
        );
        // Spread between runs: the run's own length cancels in the ratio, so some is added.
        let mut trials = runs(|x| x, &[]);
        for (i, row) in trials.rows.iter_mut().enumerate() {
            let Some(at_95) = row[6].as_f64() else { continue };
            row[6] = Value::Number(at_95 * if i % 3 == 0 { 1.02 } else { 0.99 });
        }
        judged(&trials, &expect)
    };
    let found = shrinks("greater");
    assert_eq!(found.judgement, Judgement::Supported);
    let effect = found.comparisons[0].effect.as_ref().unwrap().value;
    assert_close(effect, ln(28.0 / 16.0) - ln(36.0 / 30.0), 1e-9);
    assert_eq!(shrinks("less").judgement, Judgement::Contradicted);
}

#[test]
fn the_first_trials_stand_beside_all_and_decide_nothing() {
    let expect = |more: &str| {
        format!(
            "{{less: {{metric: distance-m-at-80, where: {{environment: open, prior: footprint}}, \
             than: {{where: {{environment: open, prior: none}}}}{more}}}}}"
        )
    };
    let plain = judged(&runs(|x| x, &[]), &expect(""));
    let beside = judged(&runs(|x| x, &[]), &expect(", also-at-n: 4"));
    assert_eq!(plain.judgement, beside.judgement);
    assert_eq!(plain.comparisons[0].p_for, beside.comparisons[0].p_for);
    assert_eq!(statistic(&beside, "first-n"), 4.0);
    assert!(statistic(&beside, "first-n-p") > 0.0 && statistic(&beside, "first-n-hedges-g") < 0.0);
    let words = beside.comparisons[0].at_both_numbers().unwrap();
    assert!(words.starts_with("at n = 4 p ") && words.contains("; at n = 12 p "), "{words}");
    assert_eq!(plain.comparisons[0].at_both_numbers(), None);
    // Where the first trials say nothing, a note says so.
    let expect = "{less: {metric: distance-m-at-95, censored: reached-only, minimum-n: 5, where: {prior: footprint, \
                  environment: open}, than: {where: {environment: open, prior: none}}, also-at-n: 2}}";
    let found = judged(&runs(|x| x, &[0, 1]), expect);
    assert!(found.notes.iter().any(|note| note.starts_with("of the first 2 trials alone: ")));
}

#[test]
fn runs_that_never_got_there_are_counted() {
    let expect = "{less: {metric: distance-m-at-95, censored: reached-only, minimum-n: 5, where: {prior: floor-plan, \
                  environment: open}, than: {where: {environment: open, prior: none}}}}";
    assert_eq!(judged(&runs(|x| x, &[3, 4, 5]), expect).censored(), Some((6, 24)));
    assert_eq!(judged(&runs(|x| x, &[]), expect).censored(), None);
}

#[test]
fn spreads_are_tested_by_the_distances_from_the_median() {
    let mut table = Table::new(["key", "group", "trial", "outcome", "d"]);
    for (group, values) in
        [("calm", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), ("wild", [1.0, 3.0, 8.0, 9.0, 15.0, 20.0])]
    {
        for (trial, d) in (0_i64..).zip(values) {
            let (d, outcome) = (Value::Number(d), "explored".into());
            table.push(vec!["k".into(), group.into(), trial.into(), outcome, d]);
        }
    }
    let expect = "{less: {metric: d, where: {group: calm}, than: {where: {group: wild}}, test: brown-forsythe, minimum-n: 6}}";
    let found = judged(&table, expect);
    // Distances 2.5 1.5 .5 .5 1.5 2.5 (mean 1.5) and 7.5 5.5 .5 .5 6.5 11.5 (mean 16/3); by hand.
    let effect = found.comparisons[0].effect.as_ref().unwrap().value;
    assert_close(effect, 1.5 - 16.0 / 3.0, 1e-12);
    let pooled = (4.0 + spread()) / 10.0;
    assert_close(statistic(&found, "t"), effect / (pooled / 3.0).sqrt(), 1e-9);
    assert_eq!(found.judgement, Judgement::Supported);
}

/// Returns the sum of squares of the second group's distances around their mean.
fn spread() -> f64 {
    let mean = 32.0 / 6.0;
    [7.5, 5.5, 0.5, 0.5, 6.5, 11.5].iter().map(|x: &f64| (x - mean) * (x - mean)).sum()
}

#[test]
fn log_ratios_agree_where_gains_do_whatever_the_levels() {
    let expect = format!(
        "{{rmse-with-published: {{{BOTH}, published: distance-m, ratio-to: {{prior: none}}, at-most: 0.05}}}}"
    );
    let same = judged(&runs(|x| 3.0 * x, &[]), &expect);
    assert_eq!(same.judgement, Judgement::Supported, "{}", same.reason);
    assert_close(statistic(&same, "skill-over-constant"), 1.0, 1e-9);
    assert_close(statistic(&same, "slope"), 1.0, 1e-9);
    assert_eq!(statistic(&same, "independent-cells"), 3.0, "ratios to one base are one");
    assert_eq!(statistic(&same, "cells"), 12.0);
    assert_eq!(statistic(&same, "inside-prediction-interval"), 1.0);
    // Half of the gain: the slope says so, and the bound is missed.
    let damped = judged(&runs(f64::sqrt, &[]), &expect);
    assert_eq!(damped.judgement, Judgement::Contradicted, "{}", damped.reason);
    assert_close(statistic(&damped, "slope"), 0.5, 1e-9);
    assert_close(statistic(&damped, "pearson"), 1.0, 1e-9);
    // Signs alone are all the same; the metric is not taken in by that.
    assert!(statistic(&damped, "skill-over-constant") < 0.7);
}

#[test]
fn faults_of_the_new_options_are_told() {
    let factors = [crate::factor::Factor::new("prior", PRIORS)];
    let metrics = ["success", "distance-m-at-80", "distance-m-at-95"].map(str::to_owned);
    let published = ["t".to_owned()];
    let known = Known { factors: &factors, metrics: &metrics, published: &published };
    let faults = |expect: &str| -> Vec<String> {
        claim(expect).check(known).iter().map(faults::told).collect()
    };
    let less = |what: &str| {
        faults(&format!(
            "{{less: {{{what}, where: {{prior: none}}, than: {{where: {{prior: footprint}}}}}}}}"
        ))
    };
    assert_eq!(
        less("metric: distance-m-at-80, per-run: mean-log"),
        ["expect.less.per-run: expected two metrics or more, found 1"]
    );
    assert_eq!(
        less("metric: distance-m-at-80, per-run: log-ratio"),
        ["expect.less.per-run: expected two metrics, found 1"]
    );
    assert_eq!(
        less("metric: [distance-m-at-80, success], per-run: mean-log"),
        ["expect.less.per-run: `success` is a share of runs; only measures have logarithms"]
    );
    assert_eq!(
        less("metric: distance-m-at-80, also-at-n: 1"),
        ["expect.less.also-at-n: expected at least 2: fewer trials have no spread"]
    );
    assert_eq!(
        faults(
            "{rmse-with-published: {metric: distance-m-at-80, published: t, at-most: 1, baseline: [prior], \
             ratio-to: {prior: [none, footprint]}}}"
        ),
        [
            "expect.rmse-with-published.ratio-to: expected one value per factor: the base of a ratio is one cell",
            "expect.rmse-with-published.baseline: skill over log ratios is counted over their mean; leave \
             `baseline` out"
        ]
    );
}
