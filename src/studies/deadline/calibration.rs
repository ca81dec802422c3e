//! The six (time, failure) pairs of the planner's maneuvers (section 6, "Maneuvers"), measured by a calibration
//! experiment of isolated passages and handed to the study as an input.

use super::mission::Task;
use crate::cmdp::build::{Expectation, Maneuvers, Motion, Speed};
use crate::stats::distribution::student_t_quantile;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::summary::Summary;
use crate::studies::findings::rounded;
use crate::studies::{Outcome, Setup, TrialRecord, TrialSpec};
use crate::table::{Table, Value};
use serde_json::{Value as Json, json};

/// The motions, in the order of the table.
pub const MOTIONS: [Motion; 3] = [Motion::Corridor, Motion::DoorLeft, Motion::DoorRight];
/// The speeds, in the order of the table.
pub const SPEEDS: [Speed; 2] = [Speed::Slow, Speed::Fast];
/// Passages that each maneuver needs at least before its pair is worth planning with.
pub const LEAST_PASSAGES: u64 = 10;

const CONFIDENCE: f64 = 0.95;
const COLUMNS: [&str; 11] = [
    "motion",
    "speed",
    "passages",
    "reached",
    "collided",
    "time-s",
    "time-low-s",
    "time-high-s",
    "failure",
    "failure-low",
    "failure-high",
];

/// What the passages of one maneuver showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// The motion.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
    /// Passages tried.
    pub passages: u64,
    /// Those that arrived.
    pub reached: u64,
    /// Those that ended in contact; the rest did not arrive in time.
    pub collided: u64,
    /// Mean duration (s) of those that arrived, and its 95 % interval (Student's t).
    pub time_s: [f64; 3],
    /// Share of passages that did not arrive, and its 95 % interval (Wilson).
    pub failure: [f64; 3],
}

/// All six pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    pairs: Vec<Pair>,
}

/// Why a text is not a calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("calibration: {0}")]
pub struct CalibrationError(String);

impl Calibration {
    /// What `passages` showed: the maneuver of each and its record.
    ///
    /// # Errors
    /// Where a maneuver has too few passages or none that arrived.
    pub fn measure<'a>(
        passages: impl IntoIterator<Item = (Motion, Speed, &'a TrialRecord)>,
    ) -> Result<Self, CalibrationError> {
        let passages: Vec<(Motion, Speed, &TrialRecord)> = passages.into_iter().collect();
        let mut pairs = Vec::new();
        for motion in MOTIONS {
            for speed in SPEEDS {
                let of = passages.iter().filter(|p| p.0 == motion && p.1 == speed).map(|p| p.2);
                pairs.push(pair(motion, speed, of)?);
            }
        }
        Ok(Self { pairs })
    }

    /// What the trials of a calibration experiment showed, in plan order with their records.
    ///
    /// # Errors
    /// Where a trial is no isolated passage, or as [`Self::measure`].
    pub fn of_trials(
        trials: &[TrialSpec],
        records: &[TrialRecord],
    ) -> Result<Self, CalibrationError> {
        let mut passages = Vec::new();
        for (spec, record) in trials.iter().zip(records) {
            match &spec.setup {
                Setup::Deadline(setup) if setup.parameters.mission.task == Task::Passage => {
                    let passage = &setup.parameters.passage;
                    passages.push((passage.motion, passage.speed, record));
                }
                _ => {
                    let place = format!("{}/{}", spec.condition.slug(), spec.trial);
                    let what =
                        format!("expected `mission.task: passage`, {place} is something else");
                    return Err(CalibrationError(what));
                }
            }
        }
        Self::measure(passages)
    }

    /// Pairs that nobody measured, for models and checks that need some.
    pub fn assumed(maneuvers: &Maneuvers) -> Self {
        let pair = |motion, speed| {
            let Expectation { time_s, failure } = maneuvers.expect(motion, speed);
            Pair {
                motion,
                speed,
                passages: 0,
                reached: 0,
                collided: 0,
                time_s: [time_s; 3],
                failure: [failure; 3],
            }
        };
        let pairs = MOTIONS.iter().flat_map(|m| SPEEDS.map(|s| pair(*m, s))).collect();
        Self { pairs }
    }

    /// The pairs, motion by motion, slow before fast.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// What the planner expects of each maneuver.
    pub fn maneuvers(&self) -> Maneuvers {
        let expect = |motion: Motion| {
            SPEEDS.map(|speed| {
                let found = self.pairs.iter().find(|p| p.motion == motion && p.speed == speed);
                found.map_or(Expectation { time_s: 0.0, failure: 0.0 }, |pair| Expectation {
                    time_s: pair.time_s[0],
                    failure: pair.failure[0],
                })
            })
        };
        Maneuvers {
            corridor: expect(Motion::Corridor),
            door_left: expect(Motion::DoorLeft),
            door_right: expect(Motion::DoorRight),
        }
    }

    /// The pairs as a trial's key and the resolved study hold them: what the planner sees, nothing else.
    pub fn to_json(&self) -> Json {
        let entry = |pair: &Pair| {
            json!({
                "motion": pair.motion,
                "speed": pair.speed,
                "time-s": pair.time_s[0],
                "failure": pair.failure[0],
            })
        };
        self.pairs.iter().map(entry).collect()
    }

    /// The table that is sealed as an input: one row a maneuver, numbers of six significant digits.
    pub fn to_csv(&self) -> String {
        let mut table = Table::new(COLUMNS);
        let whole = |n: u64| Value::from(i64::try_from(n).unwrap_or(i64::MAX));
        for pair in &self.pairs {
            let mut row: Vec<Value> = vec![name(&pair.motion).into(), name(&pair.speed).into()];
            row.extend([pair.passages, pair.reached, pair.collided].map(whole));
            row.extend(pair.time_s.map(Value::from));
            row.extend(pair.failure.map(Value::from));
            table.push(row);
        }
        table.to_csv()
    }

    /// Reads what [`Self::to_csv`] wrote.
    ///
    /// # Errors
    /// Where it is something else, naming the line.
    pub fn from_csv(text: &str) -> Result<Self, CalibrationError> {
        let fault = |what: String| CalibrationError(what);
        let table = Table::from_csv(text).map_err(|e| fault(e.to_string()))?;
        if table.columns != COLUMNS {
            let found = table.columns.join(", ");
            return Err(fault(format!(
                "expected the columns {}, found {found}",
                COLUMNS.join(", ")
            )));
        }
        let expected = MOTIONS.iter().flat_map(|m| SPEEDS.map(|s| (*m, s)));
        let mut pairs = Vec::new();
        for (i, (motion, speed)) in expected.enumerate() {
            let line = i + 2;
            let row = table.rows.get(i).ok_or_else(|| {
                fault(format!("expected a line for {} {}, found none", name(&motion), name(&speed)))
            })?;
            let found = (row[0].to_string(), row[1].to_string());
            if found != (name(&motion), name(&speed)) {
                return Err(fault(format!(
                    "line {line}: expected {} {}, found {} {}",
                    name(&motion),
                    name(&speed),
                    found.0,
                    found.1
                )));
            }
            let count = |column: usize| match &row[column] {
                Value::Integer(n) if *n >= 0 => Ok(n.unsigned_abs()),
                other => Err(fault(format!(
                    "line {line}: `{}` must be a count, found `{other}`",
                    COLUMNS[column]
                ))),
            };
            let number = |column: usize, most: f64| match row[column].as_f64() {
                Some(x) if (0.0..=most).contains(&x) => Ok(x),
                _ => Err(fault(format!(
                    "line {line}: `{}` must be a number from 0 to {most}, found `{}`",
                    COLUMNS[column], row[column]
                ))),
            };
            let time = |column: usize| number(column, 1e6);
            pairs.push(Pair {
                motion,
                speed,
                passages: count(2)?,
                reached: count(3)?,
                collided: count(4)?,
                time_s: [time(5)?, time(6)?, time(7)?],
                failure: [number(8, 1.0)?, number(9, 1.0)?, number(10, 1.0)?],
            });
        }
        if table.rows.len() > pairs.len() {
            return Err(fault(format!(
                "expected {} lines, found {}",
                pairs.len(),
                table.rows.len()
            )));
        }
        Ok(Self { pairs })
    }
}

fn pair<'a>(
    motion: Motion,
    speed: Speed,
    records: impl Iterator<Item = &'a TrialRecord>,
) -> Result<Pair, CalibrationError> {
    let (mut times, mut passages, mut collided) = (Vec::new(), 0, 0);
    for record in records.filter(|r| r.outcome != Outcome::Panicked) {
        passages += 1;
        collided += u64::from(record.outcome == Outcome::Collided);
        if record.outcome == Outcome::Reached {
            times.push(record.sim_seconds);
        }
    }
    let reached = times.len() as u64;
    if passages < LEAST_PASSAGES || reached < 2 {
        return Err(CalibrationError(format!(
            "expected at least {LEAST_PASSAGES} passages of {} {} and 2 that arrive, found {passages} and {reached}",
            name(&motion),
            name(&speed)
        )));
    }
    let summary = Summary::of(&times);
    #[expect(clippy::cast_precision_loss, reason = "counts of passages are small")]
    let freedom = (reached - 1) as f64;
    let half =
        student_t_quantile(0.5 + 0.5 * CONFIDENCE, freedom) * summary.variance_of_mean().sqrt();
    let failed = Proportion::new(passages - reached, passages);
    let interval = wilson(failed, CONFIDENCE);
    Ok(Pair {
        motion,
        speed,
        passages,
        reached,
        collided,
        time_s: [summary.mean, (summary.mean - half).max(0.0), summary.mean + half].map(rounded),
        failure: [failed.share(), interval.low, interval.high].map(rounded),
    })
}

/// The name of a motion or speed in files.
fn name(value: &impl serde::Serialize) -> String {
    json!(value).as_str().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::{Sha256Digest, TrialKey};

    fn record(outcome: Outcome, sim_seconds: f64) -> TrialRecord {
        TrialRecord {
            key: TrialKey(Sha256Digest::of("a passage")),
            condition: Vec::new(),
            trial: 0,
            outcome,
            cause: String::new(),
            measures: std::collections::BTreeMap::new(),
            series: Vec::new(),
            sim_seconds,
            chain: Vec::new(),
        }
    }

    #[test]
    fn a_calibration_is_measured_written_and_read() {
        let records: Vec<TrialRecord> = (0..20)
            .map(|i| {
                let outcome = if i < 3 { Outcome::Collided } else { Outcome::Reached };
                record(outcome, 10.0 + f64::from(i))
            })
            .collect();
        let passages = MOTIONS
            .iter()
            .flat_map(|m| SPEEDS.map(|s| (*m, s)))
            .flat_map(|(m, s)| records.iter().map(move |r| (m, s, r)));
        let calibration = Calibration::measure(passages).unwrap();
        let first = calibration.pairs()[0];
        assert_eq!((first.passages, first.reached, first.collided), (20, 17, 3));
        assert_eq!((first.time_s[0], first.failure[0]), (21.0, 0.15));
        // Student's t with 16 degrees of freedom: 2.1199; the sample's sd is 5.04975.
        assert!((first.time_s[2] - (21.0 + 2.1199 * 5.04975 / 17.0_f64.sqrt())).abs() < 1e-3);
        assert_eq!(Calibration::from_csv(&calibration.to_csv()).unwrap(), calibration);
        let maneuvers = calibration.maneuvers();
        assert_eq!(maneuvers.expect(Motion::DoorLeft, Speed::Fast).time_s, 21.0);
    }

    #[test]
    fn a_foreign_table_is_refused_with_its_line() {
        let refused = |text: &str| Calibration::from_csv(text).unwrap_err().to_string();
        let header = COLUMNS.join(",");
        assert_eq!(
            refused(&format!("{header}\ncorridor,fast,1,1,0,1,1,1,0,0,0\n")),
            "calibration: line 2: expected corridor slow, found corridor fast"
        );
        assert_eq!(
            refused(&format!("{header}\ncorridor,slow,9,9,0,1,1,1,1.5,0,0\n")),
            "calibration: line 2: `failure` must be a number from 0 to 1, found `1.5`"
        );
        assert_eq!(
            refused(&format!("{header}\n")),
            "calibration: expected a line for corridor slow, found none"
        );
    }

    #[test]
    fn too_few_passages_are_no_calibration() {
        assert_eq!(
            Calibration::measure([]).unwrap_err().to_string(),
            "calibration: expected at least 10 passages of corridor slow and 2 that arrive, found 0 and 0"
        );
    }
}
