//! What guards verdicts: censoring, independence, minimum n.

use super::faults::{faults_among, known};
use super::*;

#[test]
fn wall_time_is_circumstance() {
    let (factors, _, published) = known();
    let metrics = vec!["wall-time-selection-ms".to_owned(), "success".to_owned()];
    let things = (factors, metrics, published);
    let expect = "{between: {metric: wall-time-selection-ms, statistic: p95, high: 50}}";
    let mut about_speed = claim(expect);
    assert_eq!(
        faults_among(&about_speed, &things),
        [
            "expect.between.metric: `wall-time-selection-ms` depends on the machine and belongs to the \
          circumstance half of a bundle; mark the claim `circumstance: true` or measure simulated time"
        ]
    );
    // And where nobody checked, judging refuses it just the same.
    let found = verdict(expect);
    assert_eq!(found.judgement, Judgement::CannotBeTested);
    assert_eq!(
        found.reason,
        "`wall-time-selection-ms` depends on the machine: such claims are marked `circumstance: true` and judged \
         apart from the results"
    );
    about_speed.circumstance = true;
    assert_eq!(faults_among(&about_speed, &things), Vec::<String>::new());
    let mut about_success = claim("{between: {metric: success, high: 0.5}}");
    about_success.circumstance = true;
    assert_eq!(
        faults_among(&about_success, &things),
        ["circumstance: `success` is a result of the study; only claims on wall-time metrics are \
          circumstance"]
    );
}

#[test]
fn cells_that_share_noise_are_refused_and_paired_instead() {
    let published = published();
    let shared = ["strategy".to_owned()];
    let context = Context::new(&published, &shared, 1);
    let two = "{less: {metric: success, where: {start: C, deadline-s: 5628, strategy: random}, than: {where: \
               {start: C, deadline-s: 5628, strategy: frontier}}}}";
    let found = judge(&claim(two), &as_printed(), &context).unwrap();
    assert_eq!(found.judgement, Judgement::CannotBeTested);
    assert_eq!(
        found.reason,
        "trials of (start=C, deadline-s=5628, strategy=random) and (start=C, deadline-s=5628, strategy=frontier) \
         share their noise (over strategy), and this test needs independent trials; a sign-test with `pairs: \
         trials` does not"
    );
    // The numbers are there all the same.
    assert_eq!(found.comparisons[0].cells[0].successes, Some(4));
    // Cells that differ in a factor of their own do not share anything.
    let apart = two.replace(
        "{start: C, deadline-s: 5628, strategy: frontier}",
        "{start: B, deadline-s: 2899, strategy: frontier}",
    );
    assert_eq!(
        judge(&claim(&apart), &as_printed(), &context).unwrap().judgement,
        Judgement::Supported
    );
    // By trial: 4 and 27 of 50 succeed, in this table the first ones of each, so 23 pairs differ.
    let paired = "{sign-test: {metric: success, direction: less, pairs: trials, where: {strategy: random}, than: \
                  {strategy: frontier}, for-each: {start: C, deadline-s: 5628}}}";
    let found = judge(&claim(paired), &as_printed(), &context).unwrap();
    assert_eq!(found.judgement, Judgement::Supported);
    assert_eq!(
        statistics(&found.comparisons[0]),
        [("pairs", 23.0), ("as-claimed", 23.0), ("ties", 27.0)]
    );
    assert_close(found.comparisons[0].p_for.unwrap(), 0.5_f64 * 0.5 / 2_097_152.0, 1e-9);
}

#[test]
fn sign_tests_of_cells_count_one_vote_per_pair() {
    let expect = "{sign-test: {metric: success, direction: greater, where: {strategy: frontier}, than: {strategy: \
                  complete-corridor}, for-each: [{start: A, deadline-s: [680, 477, 272, 68]}, {start: B, deadline-s: \
                  [2899, 2030, 1160, 290]}, {start: C, deadline-s: [5628, 3940, 2251, 563]}]}}";
    let found = verdict(expect);
    // 28 20, 15 17, 16 18, 17 15, 30 29, 26 27, 31 23, 17 12, 27 23, 29 38, 28 24, 25 10: eight of twelve
    assert_eq!(
        statistics(&found.comparisons[0]),
        [("pairs", 12.0), ("as-claimed", 8.0), ("ties", 0.0)]
    );
    // scipy.stats.binomtest(8, 12, alternative='greater')
    assert_close(found.comparisons[0].p_for.unwrap(), 0.193_847_656_25, 1e-9);
    assert_eq!(found.judgement, Judgement::Inconclusive);
    assert_eq!(found.comparisons[0].cells.len(), 24);
    let few = expect.replace("greater,", "greater, minimum-n: 13,");
    assert_eq!(verdict(&few).reason, "12 pairs differ, fewer than the minimum of 13 (0 are tied)");
}

#[test]
fn censored_runs_are_counted_and_never_dropped_in_silence() {
    let expect = "{less: {metric: time-s, where: {start: A, strategy: frontier}, than: {where: {start: A, strategy: \
                  random}}}}";
    let refused = verdict(expect);
    assert_eq!(refused.judgement, Judgement::CannotBeTested);
    assert_eq!(
        refused.reason,
        "124 of 200 runs of (start=A, strategy=frontier) never reached time-s; say with `censored` whether those \
         that did are compared (reached-only) or the others rank last (worst)"
    );
    let reached = verdict(&expect.replace("less: {", "less: {censored: reached-only, "));
    assert_eq!(reached.judgement, Judgement::Supported);
    assert_eq!(
        reached.notes,
        [
            "reached by 76 of 200 (start=A, strategy=frontier), 148 of 200 (start=A, strategy=random); the cells differ \
          in this, so the runs compared are a selection"
        ]
    );
    let cell = &reached.comparisons[0].cells[0];
    assert_eq!((cell.trials, cell.reached), (200, 76));
    // Ranked last, the 124 that never arrived turn it round.
    let last = verdict(&expect.replace("less: {", "less: {censored: worst, test: mann-whitney, "));
    assert_eq!(last.judgement, Judgement::Contradicted);
    // A share of runs that arrive within a time counts those that never do.
    let share = verdict(
        "{share: {that: {metric: time-s, at-most: 1000}, where: {start: A, strategy: frontier}, low: 0.5}}",
    );
    assert_eq!(share.judgement, Judgement::Contradicted);
    assert_eq!(share.comparisons[0].effect.as_ref().unwrap().value, 0.38);
}

#[test]
fn nothing_is_judged_on_too_little_or_on_failed_runs() {
    let few = deadline_trials(5, |_, j| if j == 0 { 0 } else { 5 });
    let expect = "{less: {metric: success, where: {start: C, deadline-s: 563, strategy: random}, than: {where: {start: C, \
                  deadline-s: 563, strategy: frontier}}}}";
    assert_eq!(
        verdict_on(&few, expect).reason,
        "(deadline-s=563, start=C, strategy=random) has 5 runs to compare, fewer than the minimum of 10"
    );
    let mut failed = as_printed();
    let place = failed.column("outcome").unwrap();
    let last = failed.rows.len() - 1;
    failed.rows[last][place] = "panicked".into();
    let found = verdict_on(&failed, "{between: {metric: success, where: {start: C}, high: 0.9}}");
    assert_eq!(found.reason, "1 of 1000 trials of (start=C) failed to run");
    let none =
        verdict("{between: {metric: success, where: {start: C, deadline-s: 68}, high: 0.9}}");
    assert_eq!(none.reason, "no trial matches (deadline-s=68, start=C)");
    assert_eq!(none.judgement, Judgement::CannotBeTested);
    let overlap = verdict(
        "{less: {metric: success, where: {start: [A, B]}, than: {where: {start: [B, C]}}}}",
    );
    assert_eq!(
        overlap.reason,
        "the condition start=B, deadline-s=2899, strategy=random is in two of the cells compared"
    );
    let fixed = "{less: {metric: outcome:late, where: {start: A}, than: {where: {start: B}}}}";
    assert_eq!(verdict(fixed).judgement, Judgement::Inconclusive);
    let missing = verdict("{between: {metric: speed, high: 1}}");
    assert_eq!(missing.reason, "the trials table has no column `speed`");
}

#[test]
fn values_that_never_vary_are_no_sample() {
    let mut table = Table::new(["key", "prior", "trial", "outcome", "d"]);
    for (prior, d) in [("a", 1.0), ("b", 2.0)] {
        for trial in 0..10_i64 {
            table.push(vec!["k".into(), prior.into(), trial.into(), "explored".into(), d.into()]);
        }
    }
    let found =
        verdict_on(&table, "{less: {metric: d, where: {prior: a}, than: {where: {prior: b}}}}");
    assert_eq!(
        found.reason,
        "no value varies within its cell: nothing was drawn at random, so no test applies"
    );
}

#[test]
fn published_tables_are_read_by_contract() {
    let (factors, _, _) = known();
    let check = |text: &str| published::check_table("t", &Table::from_csv(text).unwrap(), &factors);
    assert_eq!(
        check("start,percent\n"),
        ["published table `t`: no column `value` (there are start, percent)"]
    );
    assert_eq!(
        check("start,value\nA,1\nA,2\n"),
        ["published table `t`: rows 1 and 2 speak of the same cell"]
    );
    assert_eq!(
        check("start,value\nA,x\n"),
        ["published table `t`: row 1: `value` is `x`, expected a number"]
    );
    assert_eq!(
        check("start,value\nA,1\nD,2\n"),
        ["published table `t`: row 2: factor `start` has no value `D`"]
    );
    assert_eq!(
        check("start,metric,value,sd,n,note\nA,m,1,0.5,10,x\nA,k,,,,y\n"),
        Vec::<String>::new()
    );
    // A printed number without runs of ours is noted, not dropped.
    let mut tables = published();
    let table = tables.get_mut("success-percent").unwrap();
    table.push(vec!["A".into(), 99.into(), "random".into(), 50.0.into(), 50.into()]);
    let expect = "{correlation-with-published: {metric: success, published: success-percent, at-least: 0.6}}";
    let found = judge(&claim(expect), &as_printed(), &Context::new(&tables, &[], 1)).unwrap();
    assert_eq!(found.judgement, Judgement::Supported);
    assert_eq!(
        found.notes,
        ["1 published cells have no runs to compare: deadline-s=99, start=A, strategy=random"]
    );
}

#[test]
fn log_ratios_compare_gains_instead_of_levels() {
    let mut tables = BTreeMap::new();
    let mut table = Table::new(["start", "deadline-s", "strategy", "value"]);
    for (start, deadline, row) in TABLE_1 {
        for (strategy, k) in STRATEGIES.iter().zip(row) {
            table.push(vec![
                start.into(),
                deadline.into(),
                (*strategy).into(),
                Value::Number(crate::stats::real(k)),
            ]);
        }
    }
    tables.insert("counts".to_owned(), table);
    let expect = "{correlation-with-published: {metric: success, published: counts, ratio-to: {strategy: frontier}, \
                  at-least: 0.5}}";
    let found = judge(&claim(expect), &as_printed(), &Context::new(&tables, &[], 1)).unwrap();
    // 48 cells are no base; random never succeeds in two.
    assert_eq!(statistics(&found.comparisons[0])[0], ("cells", 46.0));
    assert_eq!(found.notes, ["2 cells have no positive base to take a ratio to"]);
    let slope = found.comparisons[0].statistics.get("slope").unwrap();
    assert_close(slope, 1.0, 1e-9);
}

/// Checks that a claim that nobody checked is judged without a panic, and never supported for claiming nothing.
#[test]
fn empty_claims_are_not_supported() {
    for expect in [
        "{between: {metric: success}}",
        "{homogeneous: {metric: success, across: {}, margin: 0.1}}",
        "{homogeneous: {metric: success, across: {start: []}, margin: 0.1}}",
        "{spread: {metric: success, across: {}, at-most: 0.9}}",
        "{trend: {metric: success, direction: rising, along: []}}",
        "{rank: {metric: success, across: {}, order: {first: random}}}",
        "{rank: {metric: success, across: {start: A}, order: {descending: [x, y1, z, w]}}}",
        "{less: {metric: [], than: {where: {}}}}",
        "{less: {metric: success, where: {start: A}, than: {where: {start: B}}, test: welch, at-least: 0}}",
        "{equivalent: {metric: success, where: {start: A}, to: {where: {start: B}}, margin: -1}}",
        "{sign-test: {metric: success, direction: less, where: {}, than: {}, minimum-n: 0}}",
        "{share: {that: {metric: success}}}",
        "{rmse-with-published: {metric: success, published: nothing, at-most: 1}}",
    ] {
        assert_ne!(verdict(expect).judgement, Judgement::Supported, "{expect}");
    }
}

/// Checks that a claim within one level is judged as if nothing else had been run.
#[test]
fn a_claim_within_a_level_sees_no_other_trial() {
    let text = "{between: {metric: success, where: {strategy: random}, high: 0.9}}";
    let trials = as_printed();
    let published = published();
    let context = Context::new(&published, &[], 2019);
    let all = judge(&claim(text), &trials, &context).unwrap();
    let at_a = judge(&claim(text).within("start", "A"), &trials, &context).unwrap();
    let cell = |verdict: &ClaimVerdict| verdict.comparisons[0].cells[0].clone();
    assert_eq!((cell(&all).trials, cell(&at_a).trials), (600, 200));
    // Of TABLE_1: 48 + 47 + 40 + 13.
    assert_eq!((at_a.id.as_str(), cell(&at_a).successes), ("X-A", Some(148)));
}

/// Checks that a best run is held against the bounds as it is, and that no p is made of it.
#[test]
fn a_best_run_is_within_bounds_or_not() {
    // Times of those that reached the goal are 10, 11, ... s.
    let least = |bounds: &str| {
        verdict(&format!(
            "{{between: {{metric: time-s, where: {{start: A, deadline-s: 680, strategy: random}}, statistic: least, {bounds}, \
             censored: reached-only}}}}"
        ))
    };
    let within = least("low: 9, high: 11");
    assert_eq!(within.judgement, Judgement::Supported);
    assert_eq!(within.reason, "one number of all trials, held against the bounds");
    assert_eq!(within.comparisons[0].p_for, None);
    assert_eq!(within.comparisons[0].effect.as_ref().unwrap().value, 10.0);
    assert_eq!(least("high: 9.5").judgement, Judgement::Contradicted);
    assert_eq!(least("low: 10.5").judgement, Judgement::Contradicted);
}
