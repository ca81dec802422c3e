//! The six maneuvers as the calibration measured them, beside their results in the study's own trials.

use super::Setup;
use super::calibration::{Calibration, MOTIONS, Pair, SPEEDS, maneuver_name};
use super::requests::ManeuverTable;
use crate::stats::proportion::{Proportion, wilson};
use crate::studies::TrialRecord;
use crate::studies::findings::{Findings, rounded};
use crate::table::{Table, Value};

/// One maneuver, expected and observed.
#[derive(Debug, Clone, PartialEq)]
pub struct ManeuverRow {
    /// Its name: `door-left-slow`.
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
    /// Returns the six maneuvers, motion by motion, slow before fast.
    pub fn maneuver_rows(&self, request: &ManeuverTable) -> Vec<ManeuverRow> {
        let only: Vec<(String, String)> =
            request.only.iter().map(|(f, v)| (f.clone(), v.0.clone())).collect();
        let trials = self.matching(&only);
        // One calibration serves all conditions.
        let mut setups = self.design.iter().filter_map(|(_, setup)| setup.of::<Setup>());
        let calibration = setups.find_map(|setup| setup.calibration.as_deref());
        MOTIONS
            .iter()
            .flat_map(|motion| SPEEDS.map(|speed| (*motion, speed)))
            .map(|(motion, speed)| {
                let pairs = calibration.into_iter().flat_map(Calibration::pairs);
                let pair = pairs.copied().find(|p| p.motion == motion && p.speed == speed);
                row(maneuver_name(motion, speed), pair, &trials)
            })
            .collect()
    }

    /// Returns the six maneuvers as a table.
    pub fn maneuver_table(&self, request: &ManeuverTable) -> Table {
        let mut table = Table::new([
            "maneuver",
            "expected-time-s",
            "time-s",
            "expected-failure-percent",
            "failure-percent",
            "failure-low-percent",
            "failure-high-percent",
            "passages",
        ]);
        for row in self.maneuver_rows(request) {
            table.push(vec![
                row.name.into(),
                row.expected_time_s.map(rounded).into(),
                row.met_time_s.map(rounded).into(),
                row.expected_failure_percent.map(rounded).into(),
                row.met_failure_percent.map(rounded).into(),
                row.met_failure_interval.map(|i| rounded(i.0)).into(),
                row.met_failure_interval.map(|i| rounded(i.1)).into(),
                Value::from(i64::try_from(row.passages).unwrap_or(i64::MAX)),
            ]);
        }
        table
    }
}

fn row(name: String, pair: Option<Pair>, trials: &[&TrialRecord]) -> ManeuverRow {
    let sum = |kind: &str| -> f64 {
        let measure = format!("{name}-{kind}");
        trials.iter().filter_map(|r| r.measures.get(&measure).copied().flatten()).sum()
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
