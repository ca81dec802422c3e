//! The six maneuvers as the calibration measured them, beside their results in the study's own trials.

use super::Setup;
use super::calibration::{Calibration, MOTIONS, Pair, SPEEDS, maneuver_name};
use super::requests::ManeuverTable;
use crate::condition::Condition;
use crate::stats::proportion::{Proportion, wilson};
use crate::studies::columns::Columns;
use crate::studies::deadline::build_cmdp::{Motion, Speed, Through};
use crate::studies::exhibit::{Grid, GridCell, GridRow, Layout, Lines, Measured, Set, Source};
use crate::studies::{Entry, Findings, TableRequest};
use crate::table::{Column, Table, Value};

/// One maneuver, expected and observed.
#[derive(Debug, Clone, PartialEq)]
pub struct ManeuverRow {
    /// Its name: `door-left-slow`, or with what it was done for `door-left-slow-entering`.
    pub name: String,
    /// Passages of the calibration; 0 without one.
    pub calibration_passages: u64,
    /// Mean duration (s) in the calibration.
    pub expected_time_s: Option<f64>,
    /// Share of passages that failed in the calibration (percent).
    pub expected_failure_percent: Option<f64>,
    /// Times it was begun in the study.
    pub passages: u64,
    /// Times it arrived in the study.
    pub arrived: u64,
    /// Mean duration (s) in the study of those that arrived.
    pub met_time_s: Option<f64>,
    /// Share that ended in contact in the study (percent), and its 95 % interval by Wilson, which takes passages for
    /// independent. A maneuver that the deadline cut short is neither arrived nor failed.
    pub met_failure_percent: Option<f64>,
    /// That interval.
    pub met_failure_interval: Option<(f64, f64)>,
}

impl Findings<'_> {
    /// Returns the six maneuvers, motion by motion, slow before fast; each of a door before the same by what it was done for.
    pub fn maneuver_rows(&self, request: &ManeuverTable) -> Vec<ManeuverRow> {
        let only: Condition = request.only.iter().map(|(f, v)| (f, &v.0)).collect();
        let trials = self.matching(&only);
        // Where several buildings run, each has a calibration of its own: none is that of them all.
        let mut setups = self.design.iter().filter_map(|(_, setup)| setup.of::<Setup>());
        let first = setups.clone().find_map(|setup| setup.calibration.as_deref());
        let calibration = first.filter(|first| {
            setups.all(|setup| setup.calibration.as_deref().is_none_or(|other| other == *first))
        });
        parts()
            .map(|(motion, speed, through)| {
                let pairs = calibration.into_iter().flat_map(Calibration::pairs).copied();
                let pair = pairs
                    .clone()
                    .find(|p| (p.motion, p.speed, p.through) == (motion, speed, through));
                row(part_name(motion, speed, through), pair, &trials)
            })
            .collect()
    }
}

/// Returns each maneuver, and after it the same by what it is done for.
pub(super) fn parts() -> impl Iterator<Item = (Motion, Speed, Option<Through>)> {
    let pairs = MOTIONS.iter().flat_map(|motion| SPEEDS.map(|speed| (*motion, speed)));
    pairs.flat_map(|(motion, speed)| {
        let split = Through::of(motion).iter().map(|through| Some(*through));
        std::iter::once(None).chain(split).map(move |through| (motion, speed, through))
    })
}

/// Returns the name of a maneuver, or of it done for that.
pub(super) fn part_name(motion: Motion, speed: Speed, through: Option<Through>) -> String {
    let maneuver = maneuver_name(motion, speed);
    through.map_or(maneuver.clone(), |through| format!("{maneuver}-{}", through.name()))
}

impl Layout for ManeuverTable {
    type Cell = ManeuverRow;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<ManeuverRow> {
        findings.maneuver_rows(self)
    }

    fn columns<'a>(&'a self, _: &Findings<'_>) -> Columns<'a, ManeuverRow> {
        let time = |name: &str, meaning: &str, empty: &str| {
            Column::number(name, "s", meaning).at_least(0.0).empty_where(empty)
        };
        let failure = |name: &str, meaning: &str, empty: &str| {
            Column::percent(name, meaning).empty_where(empty)
        };
        let (unfinished, uncalibrated) =
            ("none was finished", "there was no calibration of it, or one for each building");
        let names: Vec<String> = parts().map(|(m, s, through)| part_name(m, s, through)).collect();
        Columns::<ManeuverRow>::none()
            .with(
                Column::of_values(
                    "maneuver",
                    "",
                    "Motion and speed, and what it was done for",
                    &names,
                ),
                |row| row.name.clone(),
            )
            .number(
                time(
                    "expected-time-s",
                    "Mean duration in the calibration: what the planner expects",
                    uncalibrated,
                ),
                |row| row.expected_time_s,
            )
            .number(
                time("time-s", "Mean duration in this study of those that arrived", "none arrived"),
                |row| row.met_time_s,
            )
            .number(
                failure(
                    "expected-failure-percent",
                    "Share that failed in the calibration: what the planner expects",
                    uncalibrated,
                ),
                |row| row.expected_failure_percent,
            )
            .number(
                failure(
                    "failure-percent",
                    "Share of finished ones that ended in contact in this study",
                    unfinished,
                ),
                |row| row.met_failure_percent,
            )
            .number(
                failure(
                    "failure-low-percent",
                    "Lower end of its 95 % interval (Wilson)",
                    unfinished,
                ),
                |row| row.met_failure_interval.map(|(low, _)| low),
            )
            .number(
                failure(
                    "failure-high-percent",
                    "Upper end of its 95 % interval (Wilson)",
                    unfinished,
                ),
                |row| row.met_failure_interval.map(|(_, high)| high),
            )
            .count("passages", "Times that it was begun in this study", |row| row.passages)
    }

    /// Sets one line a maneuver. On the page the calibration's numbers stand where the paper's would: a cell compares what was expected with what
    /// was met.
    fn set(&self, cells: &[ManeuverRow], _: &Findings<'_>) -> Set {
        Set {
            grid: Grid {
                quantity: "in the study's own trials".to_owned(),
                beside: "calibration",
                source: Source::Other("the calibration experiment"),
                decimals: 2,
                of_trials: false,
                row_header: "maneuver".to_owned(),
                columns: vec!["time (s)".to_owned(), "failure (%)".to_owned()],
                rows: cells.iter().map(grid_row).collect(),
            },
            print: None,
            lines: Lines::all(lines(cells), 1, [0]),
            legend: vec!["expected: by the calibration; the others: in these trials".to_owned()],
            more: 0,
        }
    }
}

fn grid_row(row: &ManeuverRow) -> GridRow {
    let measured = |mean: f64, n: u64| Measured { mean, sd: None, n: Some(n) };
    let cell = |expected: Option<f64>, met: Option<f64>, n: u64| GridCell {
        ours: met.map(|met| measured(met, n)),
        published: expected.map(|expected| measured(expected, row.calibration_passages)),
        ..GridCell::default()
    };
    GridRow {
        label: row.name.clone(),
        cells: vec![
            cell(row.expected_time_s, row.met_time_s, row.arrived),
            cell(row.expected_failure_percent, row.met_failure_percent, row.passages),
        ],
    }
}

/// Returns what the planner expects of each maneuver, and what became of it.
fn lines(rows: &[ManeuverRow]) -> Table {
    let columns =
        ["maneuver", "expected time", "time", "expected failure", "failure", "95 %", "passages"];
    let mut table = Table::new(columns);
    for row in rows {
        let with =
            |unit: &str, x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1} {unit}"));
        let interval = row
            .met_failure_interval
            .map_or("-".to_owned(), |(low, high)| format!("{low:.1} to {high:.1} %"));
        let texts = [
            row.name.clone(),
            with("s", row.expected_time_s),
            with("s", row.met_time_s),
            with("%", row.expected_failure_percent),
            with("%", row.met_failure_percent),
            interval,
            row.passages.to_string(),
        ];
        table.push(texts.map(Value::from).to_vec());
    }
    table
}

fn row(name: String, pair: Option<Pair>, trials: &[Entry<'_>]) -> ManeuverRow {
    let sum = |kind: &str| -> f64 {
        let measure = format!("{name}-{kind}");
        trials.iter().filter_map(|r| r.number(&measure)).sum()
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "sums of counts are whole and not negative"
    )]
    let count = |kind: &str| sum(kind) as u64;
    let (passages, arrived, collisions) =
        (count("passages"), count("arrived"), count("collisions"));
    let ended = arrived + collisions;
    let failed = (ended > 0).then(|| Proportion::new(collisions, ended));
    ManeuverRow {
        calibration_passages: pair.map_or(0, |p| p.passages),
        expected_time_s: pair.map(|p| p.time_s[0]),
        expected_failure_percent: pair.map(|p| 100.0 * p.failure[0]),
        passages,
        arrived,
        #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
        met_time_s: (arrived > 0).then(|| sum("total-s") / arrived as f64),
        met_failure_percent: failed.map(|share| 100.0 * share.share()),
        met_failure_interval: failed.map(|share| {
            let interval = wilson(share, 0.95);
            (100.0 * interval.low, 100.0 * interval.high)
        }),
        name,
    }
}
