//! Claims of the two papers, judged on the papers' own printed numbers, and the rules that guard verdicts.

use super::*;
use crate::stats::assert_close;
use crate::table::{Table, Value};
use std::collections::BTreeMap;

mod coverage;
mod deadline;
mod faults;
mod forms;
mod levels;
mod reporting;
mod rules;

const STRATEGIES: [&str; 5] =
    ["random", "frontier", "normalized-frontier", "corridors-first", "complete-corridor"];

/// Successes of 50 in the deadline study's Table 1, by start and deadline (s), in the order of [`STRATEGIES`].
const TABLE_1: [(&str, i64, [u64; 5]); 12] = [
    ("A", 680, [48, 28, 20, 20, 20]),
    ("A", 477, [47, 15, 23, 15, 17]),
    ("A", 272, [40, 16, 20, 18, 18]),
    ("A", 68, [13, 17, 15, 13, 15]),
    ("B", 2899, [25, 30, 28, 27, 29]),
    ("B", 2030, [21, 26, 28, 30, 27]),
    ("B", 1160, [27, 31, 17, 29, 23]),
    ("B", 290, [0, 17, 10, 11, 12]),
    ("C", 5628, [4, 27, 31, 25, 23]),
    ("C", 3940, [7, 29, 24, 27, 38]),
    ("C", 2251, [3, 28, 29, 28, 24]),
    ("C", 563, [0, 25, 17, 23, 10]),
];

/// Returns a trials table with `successes` of `trials` per cell of Table 1's design.
fn deadline_trials(trials: u64, successes: impl Fn(usize, usize) -> u64) -> Table {
    let mut table =
        Table::new(["key", "start", "deadline-s", "strategy", "trial", "outcome", "time-s"]);
    for (i, (start, deadline, _)) in TABLE_1.iter().enumerate() {
        for (j, strategy) in STRATEGIES.iter().enumerate() {
            for trial in 0..trials {
                let reached = trial < successes(i, j);
                table.push(vec![
                    format!("{i}-{j}-{trial}").into(),
                    (*start).into(),
                    Value::Integer(*deadline),
                    (*strategy).into(),
                    Value::Integer(trial.cast_signed()),
                    if reached { "reached" } else { "collided" }.into(),
                    if reached {
                        Value::Number(10.0 + crate::stats::real(trial))
                    } else {
                        Value::Missing
                    },
                ]);
            }
        }
    }
    table
}

fn as_printed() -> Table {
    deadline_trials(50, |i, j| TABLE_1[i].2[j])
}

/// Returns the published table beside the manifest: percent, with runs.
fn published() -> BTreeMap<String, Table> {
    let mut table = Table::new(["start", "deadline-s", "strategy", "value", "n"]);
    for (start, deadline, row) in TABLE_1 {
        for (strategy, k) in STRATEGIES.iter().zip(row) {
            let percent = Value::Number(2.0 * crate::stats::real(k));
            table.push(vec![start.into(), deadline.into(), (*strategy).into(), percent, 50.into()]);
        }
    }
    [("success-percent".to_owned(), table)].into()
}

fn claim(expect: &str) -> Claim {
    let text = format!("id: X\nsays: something\npaper-table: silent\nexpect: {expect}\n");
    serde_yaml::from_str(&text).unwrap_or_else(|fault| panic!("{text}\n{fault}"))
}

fn verdict_on(trials: &Table, expect: &str) -> ClaimVerdict {
    let published = published();
    judge(&claim(expect), trials, &Context::new(&published, &[], 2019)).unwrap()
}

fn statistics(comparison: &verdict::ComparisonVerdict) -> Vec<(&str, f64)> {
    comparison.statistics.iter().collect()
}

fn verdict(expect: &str) -> ClaimVerdict {
    verdict_on(&as_printed(), expect)
}

const OTHERS: &str = "[frontier, normalized-frontier, corridors-first, complete-corridor]";

#[test]
fn random_is_most_effective_from_a_in_twelve_of_twelve_comparisons() {
    let found = verdict(&format!(
        "{{greater: {{metric: success, where: {{start: A, strategy: random}}, than: {{where: {{start: A, \
         strategy: {OTHERS}}}, each: [strategy]}}, for-each: {{deadline-s: [680, 477, 272]}}, \
         test: fisher-exact, alpha: 0.01}}}}"
    ));
    assert_eq!(found.judgement, Judgement::Supported);
    assert_eq!(found.comparisons.len(), 12);
    assert_eq!(
        found.reason,
        "12 of 12 comparisons hold, 0 hold the other way, 0 cannot be tested; 12 must hold, at alpha 0.01"
    );
    let worst = found.comparisons.iter().map(|c| c.p_for.unwrap()).fold(0.0, f64::max);
    // scipy.stats.fisher_exact([[40, 10], [20, 30]], 'greater')
    assert_close(worst, 4.154_329_353_119_574e-5, 1e-9);
    assert_eq!(
        found.comparisons[0].about,
        "success: (deadline-s=680, start=A, strategy=random) > (deadline-s=680, start=A, strategy=frontier)"
    );
    let cell = &found.comparisons[0].cells[0];
    assert_eq!((cell.trials, cell.reached, cell.successes), (50, 50, Some(48)));
}

#[test]
fn random_is_very_poor_from_c() {
    let found = verdict(&format!(
        "{{less: {{metric: success, where: {{start: C, strategy: random}}, than: {{where: {{start: C, \
         strategy: {OTHERS}}}, each: [strategy]}}, alpha: 0.000001}}}}"
    ));
    assert_eq!(found.judgement, Judgement::Supported);
    let level =
        verdict("{between: {metric: success, where: {start: C, strategy: random}, high: 0.15}}");
    assert_eq!(level.judgement, Judgement::Supported);
    assert_eq!(level.comparisons[0].effect.as_ref().unwrap().value, 0.07);
    // The example of the design, as it stands there.
    let design = verdict(
        "{less: {metric: success, where: {start: C, strategy: random}, than: {where: {start: C, strategy: \
         frontier}}, test: fisher-exact, alpha: 0.05}}",
    );
    assert_eq!(design.judgement, Judgement::Supported);
}

#[test]
fn deadlines_boost_failures_only_at_the_shortest() {
    let along = |steps: &str| {
        verdict(&format!(
            "{{trend: {{metric: success, direction: rising, along: [{steps}], for-each: {{strategy: [random, \
             frontier, normalized-frontier, corridors-first, complete-corridor]}}}}}}"
        ))
    };
    let loose = "{score: 1, where: {deadline-s: [680, 2899, 5628]}}, {score: 0.7, where: {deadline-s: [477, \
                 2030, 3940]}}, {score: 0.4, where: {deadline-s: [272, 1160, 2251]}}";
    let all = along(&format!("{loose}, {{score: 0.1, where: {{deadline-s: [68, 290, 563]}}}}"));
    assert_eq!(all.judgement, Judgement::Supported);
    assert_eq!(all.comparisons.len(), 5);
    let without = along(loose);
    assert_eq!(without.judgement, Judgement::Inconclusive);
    let ps: Vec<f64> = without.comparisons.iter().map(|c| c.p_for.unwrap()).collect();
    assert!(ps.iter().all(|p| *p > 0.03), "{ps:?}");
}

#[test]
fn alike_is_not_what_a_large_p_value_says() {
    let across = "{metric: success, where: {start: A, deadline-s: 68}, across: {strategy: [random, frontier, \
                  normalized-frontier, corridors-first, complete-corridor]}, margin: 0.1}";
    let found = verdict(&format!("{{homogeneous: {across}}}"));
    let statistic = |name: &str| found.comparisons[0].statistics.get(name).unwrap();
    // Chi-square sees no difference at all, and fifty trials still say nothing about ten points.
    assert_close(statistic("chi-square-p"), 0.896_880_024_991_800_1, 1e-9);
    assert_eq!(found.judgement, Judgement::Inconclusive);
    assert!(found.trials_to_decide.is_some_and(|n| n > 500), "{:?}", found.trials_to_decide);
    // With the same shares and enough trials it is established, within a margin that holds them.
    let many = deadline_trials(5000, |i, j| TABLE_1[i].2[j] * 100);
    let found = verdict_on(&many, &format!("{{homogeneous: {across}}}"));
    assert_eq!(found.judgement, Judgement::Supported);
    let tight = across.replace("0.1}", "0.02}");
    let found = verdict_on(&many, &format!("{{homogeneous: {tight}}}"));
    assert_eq!(found.judgement, Judgement::Contradicted);
    // D4: normalized-frontier against frontier at the shortest deadlines, 42 and 59 of 150.
    let found = verdict(
        "{equivalent: {metric: success, where: {strategy: normalized-frontier, deadline-s: [68, 290, 563]}, to: \
         {where: {strategy: frontier, deadline-s: [68, 290, 563]}}, margin: 0.1}}",
    );
    assert_eq!(found.judgement, Judgement::Inconclusive);
    let cells = &found.comparisons[0].cells;
    assert_eq!(
        (cells[0].successes, cells[1].successes, cells[1].trials),
        (Some(42), Some(59), 150)
    );
}

#[test]
fn claims_that_the_papers_table_does_not_bear_out() {
    // D9: normalized-frontier works best overall. It is third of five.
    let found = verdict(
        "{rank: {metric: success, across: {strategy: [random, frontier, normalized-frontier, corridors-first, \
         complete-corridor]}, order: {first: normalized-frontier}}}",
    );
    assert_eq!(found.judgement, Judgement::Inconclusive);
    assert_eq!(found.comparisons.len(), 4);
    // D5: the semantic strategies depend less on the start than frontier: 18.5 against 16.5 points.
    let found = verdict(
        "{spread: {metric: success, where: {strategy: corridors-first}, across: {start: [A, B, C]}, than: \
         {strategy: frontier}}}",
    );
    assert_eq!(found.judgement, Judgement::Inconclusive);
    assert_close(found.comparisons[0].effect.as_ref().unwrap().value, 0.02, 1e-9);
    // But all depend less on it than random, 67 points.
    let found = verdict(
        "{spread: {metric: success, where: {strategy: frontier}, across: {start: [A, B, C]}, than: {strategy: \
         random}}}",
    );
    assert_eq!(found.judgement, Judgement::Supported);
    // D16: failure rises from A to C. Contradicted for the four: success rises.
    let found = verdict(&format!(
        "{{less: {{metric: success, where: {{start: C}}, than: {{where: {{start: A}}}}, for-each: {{strategy: \
         {OTHERS}}}}}}}"
    ));
    assert_eq!(found.judgement, Judgement::Contradicted);
    assert!(
        found.reason.starts_with("0 of 4 comparisons hold, 4 hold the other way"),
        "{}",
        found.reason
    );
}

/// Checks what five guessed constants score on the paper's Table 1: a rank correlation of .77 and an RMSE of 10.2
/// points, so neither alone shows anything; the skill and the contrasts beside them say so.
#[test]
fn guessed_constants_agree_with_the_paper_but_have_no_contrasts() {
    let guess = deadline_trials(20, |i, j| match (TABLE_1[i].0, i % 4, j) {
        ("B" | "C", 3, 0) => 0,
        (_, 3, _) => 6,
        ("A", _, 0) => 18,
        ("C", _, 0) => 1,
        _ => 9,
    });
    let correlation = "{correlation-with-published: {metric: success, published: success-percent, scale: 0.01, \
                       at-least: 0.6}}";
    let found = verdict_on(&guess, correlation);
    let effect = found.comparisons[0].effect.as_ref().unwrap();
    assert!((effect.value - 0.77).abs() < 0.005, "{}", effect.value);
    assert_eq!(found.comparisons[0].cells.len(), 60);
    let rmse = "{rmse-with-published: {metric: success, published: success-percent, scale: 0.01, at-most: 0.18, \
                baseline: [start, strategy]}}";
    let found = verdict_on(&guess, rmse);
    assert_eq!(found.judgement, Judgement::Supported);
    let effect = found.comparisons[0].effect.as_ref().unwrap();
    assert!((effect.value - 0.102).abs() < 0.0005, "{}", effect.value);
    // The paper against itself: no distance, and the distance two exact replicates would have, 9.1 points.
    let itself = verdict(rmse);
    let statistic = |name: &str| itself.comparisons[0].statistics.get(name).unwrap();
    assert!((statistic("replicate-rmse") - 0.091).abs() < 0.0005);
    assert_eq!(statistic("inside-prediction-interval"), 1.0);
    assert_close(statistic("within-baseline-correlation"), 1.0, 1e-9);
    assert!(itself.comparisons[0].effect.as_ref().unwrap().value < 1e-15);
}

/// Returns values with exactly this mean and standard deviation.
fn printed(n: u32, mean: f64, sd: f64) -> Vec<f64> {
    let raw: Vec<f64> = (0..n).map(f64::from).collect();
    let shape = crate::stats::summary::Summary::of(&raw);
    raw.iter().map(|x| mean + (x - shape.mean) / shape.sd * sd).collect()
}

/// Returns trials of the basic environment, unfurnished, at 80 % (prior-knowledge study, Table 1).
fn prior_trials() -> Table {
    let mut table = Table::new(["key", "prior", "trial", "outcome", "distance-m-at-80"]);
    for (prior, mean, sd) in [
        ("none", 29.39, 4.73),
        ("floor-plan", 15.70, 4.92),
        ("footprint", 22.29, 1.50),
        ("bounding-box", 24.21, 1.55),
    ] {
        for (trial, value) in (0_i64..).zip(printed(10, mean, sd)) {
            let key = format!("{prior}-{trial}");
            table.push(vec![
                key.into(),
                prior.into(),
                trial.into(),
                "explored".into(),
                value.into(),
            ]);
        }
    }
    table
}

#[test]
fn the_floor_plan_shortens_exploration_by_the_papers_own_analysis() {
    let trials = prior_trials();
    let found = verdict_on(
        &trials,
        "{less: {metric: distance-m-at-80, where: {prior: floor-plan}, than: {where: {prior: none}}, test: anova, \
         sides: two, alpha: 0.0001}}",
    );
    assert_eq!(found.judgement, Judgement::Supported);
    // scipy.stats.ttest_ind_from_stats(29.39, 4.73, 10, 15.7, 4.92, 10): F = t^2, p
    let comparison = &found.comparisons[0];
    assert_close(comparison.statistics.get("f").unwrap(), 40.235_920_247_835_42, 1e-9);
    assert_close(comparison.p_for.unwrap(), 5.623_779_121_679_202e-6, 1e-9);
    assert!(comparison.effect.as_ref().unwrap().hedges_g.is_some());
    let saved = verdict_on(
        &trials,
        "{between: {metric: distance-m-at-80, where: {prior: floor-plan}, relative-to: {prior: none}, low: -0.65, \
         high: -0.25}}",
    );
    assert_eq!(saved.judgement, Judgement::Supported);
    let effect = saved.comparisons[0].effect.as_ref().unwrap();
    assert_close(effect.value, 15.7 / 29.39 - 1.0, 1e-9);
    let order = verdict_on(
        &trials,
        "{rank: {metric: distance-m-at-80, across: {prior: [none, bounding-box, footprint, floor-plan]}, order: \
         {descending: [none, bounding-box, footprint, floor-plan]}, test: mann-whitney}}",
    );
    assert_eq!(order.judgement, Judgement::Supported);
    let far = verdict_on(
        &trials,
        "{between: {metric: distance-m-at-80, where: {prior: none}, statistic: median, low: 20, high: 28}}",
    );
    assert_eq!(far.judgement, Judgement::Inconclusive);
    let share = verdict_on(
        &trials,
        "{share: {that: {metric: distance-m-at-80, at-most: 25}, where: {prior: floor-plan}, low: 0.5}}",
    );
    assert_eq!(share.judgement, Judgement::Supported);
    assert_eq!(share.comparisons[0].cells[0].successes, Some(10));
}
