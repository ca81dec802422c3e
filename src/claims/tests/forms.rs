//! Every documented example is judged, not only read; and the forms that count or compare within trials.

use super::faults::{examples, faults};
use super::*;
use crate::condition::Condition;

/// Returns `table` with a further column, filled from the row's place.
fn with(mut table: Table, name: &str, value: impl Fn(usize) -> f64) -> Table {
    table.columns.push(name.to_owned());
    for (i, row) in table.rows.iter_mut().enumerate() {
        row.push(value(i).into());
    }
    table
}

/// Returns Table 1's trials with made-up maneuvers: of every ten trials one ended in a fast maneuver.
fn maneuvers() -> Table {
    let place = |i: usize| crate::stats::real((i % 10) as u64);
    let table = with(as_printed(), "fast-maneuvers", move |i| 3.0 + place(i));
    let table = with(table, "slow-maneuvers", move |i| 12.0 - place(i));
    let table = with(table, "fast-collisions", move |i| f64::from(u8::from(i % 10 == 4)));
    with(table, "slow-collisions", |i| f64::from(u8::from(i % 50 == 7)))
}

/// Makes up trials of the other study: with a floor plan everything is a third shorter.
fn explorations() -> Table {
    let measures = [
        "distance-m-at-70",
        "distance-m-at-80",
        "distance-m-at-90",
        "distance-m-at-95",
        "time-s-at-70",
        "wall-time-s-per-selection",
    ];
    let mut table = Table::new(
        ["key", "environment", "furnished", "prior", "trial", "outcome"]
            .into_iter()
            .chain(measures),
    );
    for environment in ["basic", "office", "open"] {
        for furnished in ["true", "false"] {
            for (prior, factor) in [("none", 1.0), ("floor-plan", 0.67), ("footprint", 0.8)] {
                for trial in 0..12_i64 {
                    let noise = f64::from(u8::try_from(trial * 7 % 12).unwrap()) / 3.0;
                    let mut row: Vec<Value> = vec!["k".into()];
                    row.extend([environment, furnished, prior].map(Value::from));
                    row.extend([trial.into(), "explored".into()]);
                    row.extend(
                        [20.0, 30.0, 40.0, 50.0, 60.0].map(|x| Value::from(x * factor + noise)),
                    );
                    row.push((0.002 + noise / 1000.0).into());
                    table.push(row);
                }
            }
        }
    }
    table
}

#[test]
fn every_documented_example_is_judged_and_its_verdict_read_back() {
    let page = examples(include_str!("../../../docs/claims.md"), "");
    let page = page.iter().flat_map(|text| serde_yaml::from_str::<Vec<Claim>>(text).unwrap());
    let code = super::super::forms::FILES.iter().flat_map(|(_, text)| examples(text, "//!"));
    let code = code.map(|text| serde_yaml::from_str::<Claim>(&text).unwrap());
    let (deadline, prior) = (maneuvers(), explorations());
    let mut judged = BTreeMap::<&str, usize>::new();
    for claim in page.chain(code) {
        if let Expect::Untestable(form) = &claim.expect {
            let found =
                judge(&claim, &deadline, &Context::new(&BTreeMap::new(), &[], 2019)).unwrap();
            assert_eq!(found.judgement, Judgement::CannotBeTested, "{}", claim.id);
            assert!(found.reason.contains(&form.because), "{}", found.reason);
            continue;
        }
        let of_priors = serde_json::to_string(&claim).unwrap().contains("prior\":")
            || claim.expect.metrics()[0].starts_with(metric::WALL_TIME);
        let trials = if of_priors { &prior } else { &deadline };
        let mut published = published();
        published.extend(coverage::printed());
        let found = judge(&claim, trials, &Context::new(&published, &[], 2019)).unwrap();
        assert_ne!(found.judgement, Judgement::CannotBeTested, "{}: {}", claim.id, found.reason);
        assert!(!found.comparisons.is_empty(), "{}", claim.id);
        assert!(found.comparisons.iter().all(|c| !c.cells.is_empty()), "{}", claim.id);
        let written = serde_json::json!(found);
        let read: ClaimVerdict = serde_json::from_value(written.clone()).unwrap();
        assert_eq!(serde_json::json!(read), written, "{}", claim.id);
        *judged.entry(claim.expect.form()).or_default() += 1;
    }
    // Once in its own file, and once or more on the page.
    for (form, _) in super::super::forms::FILES.iter().filter(|(form, _)| *form != "untestable") {
        assert!(
            judged.get(form).is_some_and(|n| *n >= 2),
            "{form} is judged nowhere but in its file"
        );
    }
}

#[test]
fn one_trial_beyond_a_bound_contradicts_every() {
    let expect = "{every: {that: {metric: time-s, at-most: deadline-s}, where: {start: A}, censored: reached-only}}";
    let found = verdict(expect);
    assert_eq!(found.judgement, Judgement::Supported);
    assert_eq!(found.reason, "438 of 438 trials that reached it, 1000 in all");
    assert_eq!(found.comparisons[0].about, "every trial with time-s <= deadline-s: (start=A)");
    assert_eq!(found.comparisons[0].p_for, None, "nothing was estimated");
    let mut late = as_printed();
    let place = late.column("time-s").unwrap();
    late.rows[0][place] = 680.5.into();
    let found = verdict_on(&late, expect);
    assert_eq!(found.judgement, Judgement::Contradicted);
    assert_eq!(found.reason, "437 of 438 trials that reached it, 1000 in all");
    // Runs that never got there are not passed over in silence.
    let found = verdict(&expect.replace(", censored: reached-only", ""));
    assert_eq!(found.judgement, Judgement::CannotBeTested);
    assert!(
        found.reason.starts_with("562 of 1000 runs of (start=A) never reached time-s;"),
        "{}",
        found.reason
    );
    // Nor do they meet a bound where they rank last.
    let found = verdict(&expect.replace("reached-only", "worst"));
    assert_eq!(found.judgement, Judgement::Contradicted);
}

#[test]
fn rates_compare_two_quantities_of_the_same_trials() {
    let expect = "{rate: {of: {metric: fast-collisions, per: fast-maneuvers}, direction: greater, than: {metric: \
                  slow-collisions, per: slow-maneuvers}, where: {start: B}}}";
    let found = verdict_on(&maneuvers(), expect);
    assert_eq!(found.judgement, Judgement::Supported);
    // 100 collisions in 7500 fast maneuvers against 20 in 7500 slow ones.
    let comparison = &found.comparisons[0];
    assert_eq!(statistics(comparison)[..2], [("first", 100.0 / 7500.0), ("second", 20.0 / 7500.0)]);
    let effect = comparison.effect.as_ref().unwrap();
    assert_close(effect.value, 80.0 / 7500.0, 1e-12);
    // Poisson: sqrt(100 + 20) / 7500 is the standard error, within the noise of 2000 resamples and of fixed counts.
    let half = (effect.high - effect.low) / 2.0;
    let poisson = 1.645 * 120.0_f64.sqrt() / 7500.0;
    assert!((0.8..1.1).contains(&(half / poisson)), "{half} {poisson}");
    let cells: Vec<&str> = comparison.cells.iter().map(|cell| cell.cell.as_str()).collect();
    assert_eq!(
        cells,
        [
            "fast-collisions: start=B",
            "fast-maneuvers: start=B",
            "slow-collisions: start=B",
            "slow-maneuvers: start=B"
        ]
    );
    assert_eq!(
        verdict_on(&maneuvers(), &expect.replace("greater", "less")).judgement,
        Judgement::Contradicted
    );
    // Shares per trial, of one pool: which ending is the more frequent.
    let endings = "{rate: {of: {metric: outcome:late}, direction: greater, than: {metric: \"outcome:collided|reached\"}}}";
    let found = verdict(endings);
    assert_eq!(found.judgement, Judgement::Contradicted);
    assert_eq!(found.comparisons[0].effect.as_ref().unwrap().value, -1.0);
    let none = with(maneuvers(), "no-maneuvers", |_| 0.0);
    let found = verdict_on(&none, &expect.replace("per: fast-maneuvers", "per: no-maneuvers"));
    assert_eq!(
        found.reason,
        "there are no no-maneuvers, so fast-collisions per no-maneuvers is no number"
    );
}

/// Returns a table of distances with a row per coverage, as the prior-map study keeps them.
fn distances() -> BTreeMap<String, Table> {
    let mut table =
        Table::new(["environment", "furnished", "prior", "coverage-percent", "value", "sd", "n"]);
    for (i, environment) in ["basic", "office", "open"].into_iter().enumerate() {
        for furnished in ["true", "false"] {
            for (prior, factor) in [("none", 1.0), ("floor-plan", 0.67)] {
                for (percent, length) in [(70_i64, 20.0), (80, 30.0), (95, 50.0)] {
                    let value = length * factor + 2.0 + crate::stats::real(i as u64) / 10.0;
                    let mut row: Vec<Value> =
                        [environment, furnished, prior].map(Value::from).into();
                    row.extend([percent.into(), value.into(), 1.2.into(), 10.into()]);
                    table.push(row);
                }
            }
        }
    }
    [("distance-m".to_owned(), table)].into()
}

#[test]
fn coverages_of_a_published_table_are_metrics_of_ours() {
    let tables = distances();
    let context = Context::new(&tables, &[], 2020);
    let judged = |expect: &str| judge(&claim(expect), &explorations(), &context).unwrap();
    let expect = "{rmse-with-published: {metric: [distance-m-at-70, distance-m-at-80], published: distance-m, \
                  at-most: 1, baseline: [prior]}}";
    let found = judged(expect);
    assert_eq!(found.judgement, Judgement::Supported, "{}", found.reason);
    let comparison = &found.comparisons[0];
    // Twelve conditions at two coverages: what is measured on the same runs is drawn together.
    assert_eq!(statistics(comparison)[..2], [("cells", 24.0), ("independent-cells", 12.0)]);
    let cell = &comparison.cells[12];
    assert_eq!(cell.cell, "distance-m-at-80: environment=basic, furnished=true, prior=none");
    assert_eq!(cell.published, Some(32.0));
    let correlation = "{correlation-with-published: {metric: [distance-m-at-70, distance-m-at-80], published: \
                       distance-m, at-least: 0.3}}";
    let found = judged(correlation);
    assert_eq!(found.judgement, Judgement::Supported, "{}", found.reason);
    assert_eq!(statistics(&found.comparisons[0])[1], ("independent-cells", 12.0));
    // Many coverages of three conditions are three, not nine.
    let nested = correlation
        .replace("at-least", "where: {environment: basic, prior: none}, minimum-n: 4, at-least");
    assert_eq!(
        judged(&nested).reason,
        "the cells are of 2 independent conditions, fewer than the 4 that a correlation needs"
    );
    assert_eq!(
        judged(&expect.replace("[distance-m-at-70, distance-m-at-80]", "distance-m")).reason,
        "the published table `distance-m` tells coverages, and `distance-m` is at none; name metrics as `distance-m-at-80`"
    );
    assert_eq!(
        judged(&expect.replace("distance-m-at-80", "time-s-at-70")).reason,
        "the published table `distance-m` holds one quantity, and the claim compares it with distance-m and time-s"
    );
    // What power takes for the truth is found by coverage as well.
    let mut stated = claim(
        "{less: {metric: distance-m-at-80, where: {prior: floor-plan}, than: {where: {prior: none}}}}",
    );
    stated.power = serde_yaml::from_str("{published: {table: distance-m}}").unwrap();
    let conditions = ["none", "floor-plan"].map(|prior| {
        Condition::from([("environment", "basic"), ("furnished", "true"), ("prior", prior)])
    });
    let found = power::power(&stated, &conditions, 10, &context, 50).unwrap();
    assert_eq!(found.planned.supported, 1.0);
}

#[test]
fn faults_of_bounds_and_pools_of_outcomes_are_named() {
    assert_eq!(
        faults("{every: {that: {metric: time-s, at-most: deadline}}}"),
        [
            "expect.every.that.at-most: unknown factor `deadline`; did you mean `deadline-s`? (known: \
             start, strategy, deadline-s, prior, furnished, environment)"
        ]
    );
    assert_eq!(
        faults("{share: {that: {metric: time-s, at-most: start}, low: 0.5}}"),
        ["expect.share.that.at-most: `start` has the value `A`, which is no number"]
    );
    assert_eq!(
        faults("{every: {that: {metric: time-s}}}"),
        ["expect.every.that: a measure needs `at-least` or `at-most`, a share neither"]
    );
    assert_eq!(
        faults(
            "{rate: {of: {metric: time-s, per: success}, direction: less, than: {metric: success}}}"
        ),
        ["expect.rate.of.per: expected a measure; a share is counted per trial anyway"]
    );
    let unknown = faults("{between: {metric: \"outcome:late|stuck\", high: 0.5}}");
    assert_eq!(unknown.len(), 1);
    assert!(
        unknown[0].starts_with("expect.between.metric: unknown metric `outcome:stuck`"),
        "{}",
        unknown[0]
    );
}
