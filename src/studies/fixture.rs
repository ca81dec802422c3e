//! Made-up findings that every layout of tables has something to say of, and one request or more of each layout.

use super::deadline::{self, Calibration};
use super::{Findings, Ledger, Outcome, Setup, TableRequest, TrialRecord};
use crate::condition::Condition;
use crate::factor::Factor;
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::table::Table;
use crate::world::World;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Way (m) to 80 % without prior and with the paper's gain, of each environment.
const WAYS: [(&str, f64); 2] = [("basic", 40.0), ("office", 300.0)];
const PRIORS: [(&str, f64); 3] = [("none", 1.0), ("floor-plan", 0.7), ("graph", 0.85)];
/// Two choices that the paper leaves open, of which one exists only under the other.
const READINGS: [(&str, &str, f64); 3] =
    [("paper", "uneven", 1.0), ("released", "uneven", 0.9), ("released", "even", 1.2)];

/// Returns the record of a trial that explored in a second, of no condition and without measures.
pub(crate) fn blank() -> TrialRecord {
    let line = format!(
        "{{\"key\":\"{}\",\"condition\":[],\"trial\":0,\"outcome\":\"explored\",\"measures\":{{}},\"series\":[],\
         \"sim-seconds\":1,\"chain\":[]}}",
        "0".repeat(64)
    );
    TrialRecord::from_line(&line).unwrap()
}

/// Distances (m) at 80 and 95 % of coverage as the prior-knowledge study prints them, by environment and prior, rounded.
pub(crate) const PRINTED: [(&str, &str, [f64; 2]); 8] = [
    ("basic", "none", [30.0, 36.0]),
    ("basic", "floor-plan", [16.0, 28.0]),
    ("office", "none", [290.0, 430.0]),
    ("office", "floor-plan", [217.0, 405.0]),
    ("office", "bounding-box", [209.0, 433.0]),
    ("open", "none", [117.0, 306.0]),
    ("open", "floor-plan", [112.0, 224.0]),
    ("open", "bounding-box", [131.0, 223.0]),
];

/// Returns three trials of every condition but those of a graph of the office. Some never reach 95 %, and of one condition none.
fn records() -> Vec<TrialRecord> {
    let blank = blank();
    let mut records = Vec::new();
    for (environment, way) in WAYS {
        for (prior, gained) in PRIORS {
            for (gain, stop, moved) in READINGS {
                if (environment, prior) == ("office", "graph") {
                    continue;
                }
                for trial in 0..3_u32 {
                    let mut record = blank.clone();
                    let factors = [
                        ("environment", environment),
                        ("prior", prior),
                        ("gain", gain),
                        ("stop", stop),
                    ];
                    record.condition = Condition::from(factors);
                    record.trial = trial;
                    record.outcome = match (prior, trial) {
                        ("none", 2) => Outcome::TIME_LIMIT,
                        ("graph", 1) => Outcome::PANICKED,
                        _ => Outcome::EXPLORED,
                    };
                    let far = way * gained * moved * (1.0 + 0.05 * f64::from(trial));
                    let late = prior == "graph" && stop == "even" || prior == "none" && trial == 2;
                    let ended = record.outcome != Outcome::PANICKED;
                    let measures = [
                        ("distance-m-at-80", Some(far)),
                        ("distance-m-at-95", (!late).then_some(1.5 * far)),
                        ("time-s-at-80", Some(3.0 * far)),
                        ("distance-m", ended.then_some(2.0 * far)),
                        ("time-s", (ended && !late).then_some(6.0 * far)),
                        ("contacts", ended.then_some(f64::from(trial))),
                        ("decisions", ended.then_some(20.0 + f64::from(trial))),
                        ("corridor-slow-passages", Some(4.0)),
                        ("corridor-slow-arrived", Some(3.0)),
                        ("corridor-slow-collisions", Some(f64::from(trial / 2))),
                        ("corridor-slow-total-s", Some(31.0)),
                        ("door-left-fast-passages", Some(1.0)),
                    ];
                    record.measures = measures.map(|(name, x)| (name.to_owned(), x)).into();
                    records.push(record);
                }
            }
        }
    }
    records
}

fn published() -> BTreeMap<String, Table> {
    [
        (
            "ways",
            "environment,prior,coverage-percent,value,sd,n\nbasic,none,80,42,3,10\nbasic,floor-plan,80,29.5,2,10\n\
             basic,graph,80,90,2,10\nbasic,none,95,61,,\nbasic,floor-plan,95,50,,\noffice,none,80,310,40,\n\
             office,floor-plan,80,150,20,10\noffice,none,95,700,50,10\n",
        ),
        (
            "time-ways",
            "environment,prior,coverage-percent,value,sd,n\nbasic,none,80,130,9,10\nbasic,floor-plan,80,80,,\n\
             office,none,80,900,100,10\n",
        ),
        (
            "explored",
            "environment,prior,value,n\nbasic,none,60,50\nbasic,floor-plan,20,50\noffice,none,70,\n",
        ),
        ("times", "environment,gain,value\nbasic,paper,240.5\noffice,paper,1000\n"),
        (
            "whole",
            "environment,prior,measure,value,sd,n\nbasic,none,distance-m,81,2,10\nbasic,none,time-s,300,,\n\
             office,floor-plan,distance-m,600.25,,\n",
        ),
    ]
    .map(|(name, csv)| (name.to_owned(), Table::from_csv(csv).unwrap()))
    .into()
}

fn requests() -> Vec<TableRequest> {
    serde_json::from_value(json!([
        {"id": "coverage", "title": "Table 1, way to coverage", "coverage-table": {
            "metric": "distance-m", "at": [80, 95], "by": "prior", "baseline": "none", "rows": ["environment"],
            "published": "ways", "tests": true}},
        {"id": "coverage-alone", "title": "Time to coverage", "coverage-table": {
            "metric": "time-s", "at": [80], "by": "prior", "rows": ["environment", "gain"]}},
        {"id": "coverage-other-baseline", "title": "Against the graph", "coverage-table": {
            "metric": "distance-m", "at": [95], "by": "prior", "baseline": "graph", "rows": ["environment", "stop"],
            "published": "ways"}},
        {"id": "readings", "title": "Every reading", "coverage-table": {
            "metric": "distance-m", "at": [80, 95], "by": "prior", "baseline": "none",
            "rows": ["environment", "gain", "stop"], "published": "ways"}},
        {"id": "agreement", "title": "Agreement with the paper", "agreement-table": {
            "tables": ["coverage", "readings"]}},
        {"id": "which-reading", "title": "Which reading explains the tables?", "readings-table": {
            "tables": ["readings", "times-by-gain"], "by": "gain", "within": ["environment"]}},
        {"id": "times-by-gain", "title": "Time by gain", "coverage-table": {
            "metric": "time-s", "at": [80], "by": "prior", "baseline": "none",
            "rows": ["environment", "gain", "stop"], "published": "time-ways"}},
        {"id": "effects", "title": "What each choice moves", "effects-table": {
            "metric": "distance-m", "at": [70, 75, 80, 85, 90, 95], "factors": ["prior", "gain", "stop"],
            "within": ["environment"], "published": "ways"}},
        {"id": "few-effects", "title": "What a gain moves", "effects-table": {
            "metric": "time-s", "at": [80], "factors": ["gain"]}},
        {"id": "measures", "title": "Whole trials", "measures-table": {
            "measures": ["distance-m", "time-s"], "rows": ["environment", "prior"], "published": "whole"}},
        {"id": "measures-alone", "title": "Whole trials by gain", "measures-table": {
            "measures": ["distance-m", "contacts", "decisions"], "rows": ["gain"]}},
        {"id": "share", "title": "Table 2, explored (%)", "outcome-table": {
            "show": {"share": ["explored"]}, "by": "prior", "rows": ["environment"], "published": "explored"}},
        {"id": "mean", "title": "Table 3, time | without prior", "outcome-table": {
            "show": {"mean": "time-s"}, "by": "gain", "rows": ["environment"], "where": {"prior": "none"},
            "published": "times"}},
        {"id": "percent", "title": "Contacts per decision", "outcome-table": {
            "show": {"percent": {"part": "contacts", "whole": "decisions"}}, "by": "stop"}},
        {"id": "maneuvers", "title": "The maneuvers", "maneuver-table": {"where": {"environment": "basic"}}}
    ]))
    .unwrap()
}

/// Returns a setup of which tables see the calibration alone.
fn setup() -> Setup {
    Setup::new(deadline::Setup::new(
        Arc::new(World::empty()),
        Arc::new(Robot::disc(0.2)),
        Pose::new(0.0, 0.0, 0.0),
        Some(Arc::new(Calibration::stand_in())),
        deadline::Parameters::default(),
    ))
}

/// Returns what `ask` finds in the findings, of calibrated maneuvers too, and in the requests.
pub(crate) fn with_findings<T>(ask: impl FnOnce(&Findings<'_>, &[TableRequest]) -> T) -> T {
    let factors = [
        ("environment", &["basic", "office"][..]),
        ("prior", &["none", "floor-plan", "graph"]),
        ("gain", &["paper", "released"]),
        ("stop", &["uneven", "even"]),
    ]
    .map(|(name, values)| Factor::new(name, values.iter().copied()));
    let (records, published, setup) = (records(), published(), setup());
    let mut design: Vec<Condition> =
        records.iter().map(|record| record.condition.clone()).collect();
    design.dedup();
    let design = design.iter().map(|condition| (condition, &setup));
    let ledger = Ledger::of(&records);
    ask(&Findings::new(&factors, &ledger, &published).designed(design), &requests())
}
