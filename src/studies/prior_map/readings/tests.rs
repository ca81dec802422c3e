//! Readings on made-up runs around the paper's own numbers.

use super::*;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::studies::Ledger;
use crate::studies::fixture::PRINTED;
use crate::studies::prior_map::Metric;
use crate::studies::{Layout, TrialRecord, fixture};
use crate::table::{Table, Value};
use std::collections::BTreeMap;

/// Returns fifteen trials a cell of two readings: one is off by a tenth either way, the other by a third.
fn records() -> Vec<TrialRecord> {
    let blank = fixture::blank();
    let mut records = Vec::new();
    for (reading, error) in [("near", 0.1), ("far", 0.33)] {
        for (i, (environment, prior, values)) in (0..).zip(PRINTED) {
            for trial in 0..15_u32 {
                let off = 1.0 + 0.03 * (f64::from(trial) - 7.0) / 4.5;
                let way = if i % 2 == 0 { 1.0 + error } else { 1.0 - error };
                let mut record = blank.clone();
                record.trial = trial;
                let factors =
                    [("environment", environment), ("prior", prior), ("reading", reading)];
                record.condition = Condition::from(factors);
                for (percent, value) in [80, 95].into_iter().zip(values) {
                    let distance = value * way * off;
                    let measures = &mut record.measures;
                    measures.insert(format!("distance-m-at-{percent}"), Some(distance));
                    measures.insert(format!("time-s-at-{percent}"), Some(2.0 * distance));
                }
                records.push(record);
            }
        }
    }
    records
}

fn published() -> BTreeMap<String, Table> {
    let columns = ["environment", "prior", "coverage-percent", "value", "sd", "n"];
    let (mut ways, mut times) = (Table::new(columns), Table::new(columns));
    for (environment, prior, values) in PRINTED {
        for (percent, value) in [80, 95].into_iter().zip(values) {
            for (table, factor) in [(&mut ways, 1.0), (&mut times, 2.5)] {
                let value = factor * value;
                let row: [Value; 6] = [
                    environment.into(),
                    prior.into(),
                    percent.into(),
                    value.into(),
                    (0.1 * value).into(),
                    10.into(),
                ];
                table.push(row.to_vec());
            }
        }
    }
    [("ways".to_owned(), ways), ("times".to_owned(), times)].into()
}

fn request(metric: Metric, published: &str) -> CoverageTable {
    CoverageTable {
        metric,
        at: vec![80, 95],
        by: "prior".to_owned(),
        baseline: Some(serde_json::from_str("\"none\"").unwrap()),
        rows: vec!["environment".to_owned(), "reading".to_owned()],
        published: Some(published.to_owned()),
        tests: false,
    }
}

/// Returns the scores by their scope, quantity and reading, and the answer.
fn found() -> (BTreeMap<String, ReadingScore>, String) {
    let (records, published) = (records(), published());
    let values = |values: &[&str]| values.iter().map(|v| (*v).to_owned()).collect::<Vec<_>>();
    let factors = [
        Factor::new("environment", values(&["basic", "office", "open"])),
        Factor::new("prior", values(&["none", "floor-plan", "bounding-box"])),
        Factor::new("reading", values(&["near", "far"])),
    ];
    let ledger = Ledger::of(&records);
    let findings = Findings::new(&factors, &ledger, &published);
    let wanted = ReadingsTable {
        tables: vec!["distance".to_owned(), "time".to_owned()],
        by: "reading".to_owned(),
        within: vec!["environment".to_owned()],
        only: BTreeMap::new(),
    };
    let ways = request(Metric::DistanceM, "ways");
    let times = request(Metric::TimeS, "times");
    let scores = findings.reading_scores(&wanted, &[("distance", &ways), ("time", &times)]);
    let answer = wanted.answer(&scores).unwrap();
    let name =
        |score: &ReadingScore| format!("{}/{}/{}", score.scope, score.quantity, score.reading);
    (scores.into_iter().map(|score| (name(&score), score)).collect(), answer)
}

#[test]
fn the_nearer_reading_leaves_less_unexplained_and_is_said_to() {
    let (scores, answer) = found();
    let tau = |name: &str| scores[name].tau.unwrap();
    let (near, interval) = tau("all/distance/near");
    let (low, high) = interval.unwrap();
    assert!((near - 0.1).abs() < 0.02 && low <= near && near <= high, "{near} [{low}, {high}]");
    let (far, _) = tau("all/distance/far");
    assert!((far - 0.36).abs() < 0.04, "{far}");
    assert_eq!(scores["all/distance/near"].nearest, Some(1.0));
    assert_eq!(scores["all/distance/far"].nearest, Some(0.0));
    // Two thirds of the mean of logs of 1.1 and 0.9, ...
    assert!(scores["all/distance/near"].bias.abs() < 0.02);
    // Times are printed two and a half times the ways, and ours are twice: ours are quicker by a quarter.
    let speed = &scores["all/speed/near"];
    assert!((speed.bias - ln(1.25)).abs() < 1e-9 && speed.tau.is_none(), "{speed:?}");
    assert!(
        answer.starts_with("Of a cell of the table distance stays unexplained: near 10 % ["),
        "{answer}"
    );
    assert!(answer.contains(
        "near is the nearest in 100 % of resampled arms; beside it stand exact-replicate "
    ));
    assert!(
        answer.contains("Mean speeds, which nobody tuned, are off by near +25 %, far +25 %."),
        "{answer}"
    );
    assert!(
        answer.ends_with(
            "was chosen after the score of ratios had been seen; both stand in the table."
        )
    );
}

#[test]
fn a_replicate_is_explained_by_sampling_and_guesses_are_not() {
    let (scores, _) = found();
    let replicate = &scores["all/distance/exact-replicate"];
    assert_eq!((replicate.whose, replicate.cells), (Whose::Replicate, 16));
    assert!(replicate.tau.unwrap().0 < 0.03, "{replicate:?}");
    let (inside, of) = replicate.inside.unwrap();
    assert!(of == 16 && inside >= 14, "{inside} of {of}");
    let blind = &scores["all/distance/as-without-prior"];
    // Of ten cells with prior knowledge.
    assert_eq!((blind.whose, blind.cells, blind.inside), (Whose::Guess, 10, None));
    assert!(blind.tau.unwrap().0 > 0.2, "{blind:?}");
    let one = &scores["all/distance/one-number-a-coverage"];
    assert!(one.cells == 16 && one.tau.unwrap().0 > 0.7, "{one:?}");
    assert!(one.bias.abs() < 1e-9, "{one:?}");
    // Within one environment, two arms are too few for an interval.
    assert_eq!(scores["environment=basic/distance/near"].tau.unwrap().1, None);
    assert!(scores["environment=open/distance/near"].tau.unwrap().1.is_some());
}

#[test]
fn readings_with_cells_in_different_arms_are_not_ranked() {
    let cell = |arm| Difference { arm, log_ratio: 0.1, variance: 0.0 };
    let (both, one) = (vec![cell(0), cell(1), cell(1)], vec![cell(0)]);
    assert!(on_the_same_arms(&[both.clone(), vec![cell(1), cell(0)], Vec::new()]));
    assert!(!on_the_same_arms(&[both, one]));
}
