//! Agreement and tests of cells on made-up runs around the paper's own numbers.

use super::*;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::studies::Ledger;
use crate::studies::fixture::PRINTED;
use crate::studies::prior_map::Metric;
use crate::studies::{Layout, TrialRecord, fixture};
use crate::table::{Table, Value};
use std::collections::BTreeMap;

/// Returns fifteen trials a cell, of `value(printed)` on average with 3 % of spread; trials of `late` never reach 95 %.
fn records(value: impl Fn(f64) -> f64, late: std::ops::Range<u32>) -> Vec<TrialRecord> {
    let blank = fixture::blank();
    let mut records = Vec::new();
    for (environment, prior, [at_80, at_95]) in PRINTED {
        for trial in 0..15_u32 {
            let off = 1.0 + 0.03 * (f64::from(trial) - 7.0) / 4.5;
            let mut record = blank.clone();
            record.trial = trial;
            record.condition = Condition::from([("environment", environment), ("prior", prior)]);
            let end = (!late.contains(&trial)).then_some(value(at_95) * off);
            record.measures.insert("distance-m-at-80".to_owned(), Some(value(at_80) * off));
            record.measures.insert("distance-m-at-95".to_owned(), end);
            records.push(record);
        }
    }
    records
}

fn published(with_sd: impl Fn(&str) -> bool) -> BTreeMap<String, Table> {
    let columns = ["environment", "prior", "coverage-percent", "value", "sd", "n"];
    let mut table = Table::new(columns);
    for (environment, prior, values) in PRINTED {
        for (percent, value) in [80, 95].into_iter().zip(values) {
            let sd = with_sd(environment).then_some(0.1 * value);
            let row: [Value; 6] = [
                environment.into(),
                prior.into(),
                percent.into(),
                value.into(),
                sd.into(),
                10.into(),
            ];
            table.push(row.to_vec());
        }
    }
    [("distance-m".to_owned(), table)].into()
}

fn request(tests: bool) -> CoverageTable {
    CoverageTable {
        metric: Metric::DistanceM,
        at: vec![80, 95],
        by: "prior".to_owned(),
        baseline: Some(serde_json::from_str("\"none\"").unwrap()),
        rows: vec!["environment".to_owned()],
        published: Some("distance-m".to_owned()),
        tests,
    }
}

fn factors() -> Vec<Factor> {
    let values = |values: [&str; 3]| values.map(str::to_owned).to_vec();
    vec![
        Factor::new("environment", values(["basic", "office", "open"])),
        Factor::new("prior", values(["none", "floor-plan", "bounding-box"])),
    ]
}

fn found(records: &[TrialRecord], with_sd: impl Fn(&str) -> bool) -> Vec<TableAgreement> {
    let (factors, published) = (factors(), published(with_sd));
    let ledger = Ledger::of(records);
    let findings = Findings::new(&factors, &ledger, &published);
    let wanted = AgreementTable { tables: vec!["distance".to_owned()] };
    let table = request(false);
    findings.agreement(&wanted, &[("distance", &table), ("other", &table)])
}

#[test]
fn gains_agree_where_ratios_do_whatever_the_levels() {
    let parts = found(&records(|x| 0.2 * x, 0..0), |_| true);
    let all = &parts[0];
    assert_eq!((all.scope.as_str(), all.ratios, all.blocks), ("all", 10, 3));
    assert!((all.line.slope - 1.0).abs() < 1e-9 && all.line.intercept.abs() < 1e-9);
    assert!(all.rmse < 1e-9 && (all.skill - 1.0).abs() < 1e-9);
    assert_eq!((all.ratios_inside, all.cells_inside), ((10, 10), (0, 16)));
    let scopes: Vec<&str> = parts.iter().map(|part| part.scope.as_str()).collect();
    assert_eq!(
        scopes,
        [
            "all",
            "environment=basic",
            "environment=office",
            "environment=open",
            "prior=floor-plan",
            "prior=bounding-box"
        ]
    );
    assert_eq!(parts.iter().map(|part| part.ratios).collect::<Vec<_>>(), [10, 2, 4, 4, 6, 4]);
}

/// Checks that, with every sign right, the score still says that the gains are not the paper's.
#[test]
fn a_strategy_with_the_right_signs_and_the_wrong_sizes_scores_badly() {
    let flat =
        |x: f64| if [30.0, 36.0, 290.0, 430.0, 117.0, 306.0].contains(&x) { 100.0 } else { 99.0 };
    let parts = found(&records(flat, 0..0), |_| true);
    assert!(parts[0].skill < 0.0, "{:?}", parts[0]);
    assert!(parts[0].rmse > 0.2 && parts[0].mean < 0.0 && parts[0].published_mean < 0.0);
}

#[test]
fn what_is_missing_or_censored_or_has_no_spread_is_counted() {
    let parts = found(&records(|x| x, 0..15), |environment| environment != "open");
    let all = &parts[0];
    assert_eq!((all.ratios, all.missing, all.censored), (5, 8, 0), "nobody reached 95 %");
    assert_eq!((all.ratios_inside.1, all.cells_inside.1), (3, 5), "those of open have no spread");
    let parts = found(&records(|x| x, 0..5), |_| true);
    assert_eq!((parts[0].ratios, parts[0].missing, parts[0].censored), (10, 0, 8));
}

#[test]
fn cells_are_tested_at_all_runs_and_at_the_papers_number() {
    let (factors, published, records) = (factors(), published(|_| true), records(|x| x, 0..5));
    let ledger = Ledger::of(&records);
    let findings = Findings::new(&factors, &ledger, &published);
    let cells = findings.coverage_cells(&request(true));
    let cell = |by: &str, percent| {
        let wanted = ("environment".to_owned(), "office".to_owned());
        let mut found = cells.iter().filter(|c| c.by == by && c.percent == percent);
        found.find(|c| c.rows.contains(&wanted)).unwrap()
    };
    assert_eq!(cell("none", 80).tests, None, "the baseline is not tested against itself");
    let tests = cell("floor-plan", 95).tests.unwrap();
    assert_eq!((tests.first_n, tests.first_reached), (10, 5));
    let (all, first) = (tests.all.unwrap(), tests.first.unwrap());
    assert!(all.g < 0.0 && first.g < 0.0 && all.p < first.p);
    let printed = tests.published.unwrap();
    // Welch of 405 ± 40.5 and 430 ± 43, ten each: t = -1.33836 at 17.9358 df, its tails integrated numerically.
    assert!((printed.p - 0.197_498).abs() < 1e-5, "{}", printed.p);
    let tidy = |wanted: CoverageTable| wanted.columns(&findings).table(&cells);
    let (plain, tested) = (tidy(request(false)), tidy(request(true)));
    assert_eq!(tested.columns.len(), plain.columns.len() + 8);
    assert_eq!(tested.columns[..plain.columns.len()], plain.columns[..]);
    // A combination that the design leaves out is no row that was not reached.
    let print = request(true).set(&cells, &findings).print.unwrap();
    let basic = &print.rows[0];
    assert_eq!(*print.value(basic, "bounding-box"), Value::from("not in the design"));
}

/// Checks two choices that the paper leaves open, one of which exists only under the other: three readings, each with
/// its score.
#[test]
fn every_reading_that_was_run_has_its_own_score() {
    let mut factors = factors();
    for (name, values) in [("gain", ["paper", "released"]), ("stop", ["uneven", "even"])] {
        factors.push(Factor::new(name, values));
    }
    let readings =
        [("paper", "uneven", 1.0), ("released", "uneven", 0.8), ("released", "even", 0.5)];
    let mut all = Vec::new();
    for (gain, stop, share) in readings {
        // What lies with the floor plan below 30 m is less by that share; the baseline stays.
        for mut record in records(|x| if [16.0, 28.0].contains(&x) { share * x } else { x }, 0..0) {
            record.condition = record.condition.with("gain", gain).with("stop", stop);
            all.push(record);
        }
    }
    let published = published(|_| true);
    let ledger = Ledger::of(&all);
    let findings = Findings::new(&factors, &ledger, &published);
    let mut table = request(false);
    table.rows.extend(["gain".to_owned(), "stop".to_owned()]);
    let wanted = AgreementTable { tables: vec!["distance".to_owned()] };
    let parts = findings.agreement(&wanted, &[("distance", &table)]);
    let part = |scope: &str| parts.iter().find(|part| part.scope == scope).unwrap();
    assert_eq!((part("all").ratios, part("all").missing, part("all").blocks), (30, 0, 3));
    assert_eq!(parts.iter().filter(|part| part.scope.contains(", ")).count(), 3);
    let score = |reading: &str| part(reading).rmse;
    assert!(score("gain=paper, stop=uneven") < 1e-9);
    // Two of ten ratios are off by ln 0.8, and by ln 0.5.
    let off = |share: f64| (2.0 * ln(share) * ln(share) / 10.0).sqrt();
    assert!((score("gain=released, stop=uneven") - off(0.8)).abs() < 1e-9);
    assert!((score("gain=released, stop=even") - off(0.5)).abs() < 1e-9);
    assert_eq!(part("gain=released, stop=even").name, "released, even");
    let tidy = table.columns(&findings).table(&[]);
    assert_eq!(tidy.columns[..3], ["environment", "gain", "stop"]);
}
