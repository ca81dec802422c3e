//! The isolated passages on which a calibration rests, one row per trial: sealed beside the pairs that follow from
//! them, so that anyone who doubts a pair can count again, and drive any passage again.

use super::calibration::{Calibration, Driven};
use super::parameters::Task;
use crate::condition::Condition;
use crate::digest::Sha256Digest;
use crate::studies::deadline::build_cmdp::{Motion, Speed};
use crate::studies::{
    Calibrated, Calibrating, CalibrationError, Design, Expectations, Outcome, PlannedCalibration,
    Setup, TrialRecord,
};
use crate::table::{Table, Value};
use std::sync::Arc;

const COLUMNS: [&str; 6] = ["motion", "speed", "trial", "outcome", "time-s", "record"];

/// The outcomes that a passage can have.
const OUTCOMES: [Outcome; 5] =
    [Outcome::REACHED, Outcome::COLLIDED, Outcome::LATE, Outcome::STALLED, Outcome::PANICKED];

/// How this study learns from calibrations: by isolated passages.
#[derive(Debug)]
pub(super) struct Isolated;

impl Calibrating for Isolated {
    fn planned(
        &self,
        design: &Design<'_>,
        trials: u32,
    ) -> Result<Box<dyn PlannedCalibration>, CalibrationError> {
        Ok(Box::new(PlannedPassages::of(design, trials)?))
    }
}

fn expectations(calibration: Calibration) -> Expectations {
    let csv = calibration.to_csv();
    Expectations::new(calibration, csv)
}

impl PlannedCalibration for PlannedPassages {
    fn showed(&self, records: &[TrialRecord]) -> Result<Arc<dyn Calibrated>, CalibrationError> {
        Ok(Arc::new(self.passages_of(records)?))
    }

    fn read(&self, text: &str) -> Result<Arc<dyn Calibrated>, CalibrationError> {
        Ok(Arc::new(self.passages_in(text)?))
    }

    fn stand_in(&self) -> Expectations {
        expectations(Calibration::stand_in())
    }
}

/// The passages of a calibration experiment, in plan order.
#[derive(Debug, Clone, PartialEq)]
struct Passages {
    rows: Vec<Row>,
}

/// One passage.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    trial: u32,
    passage: Driven,
    /// Digest of the trial's record line.
    record: Sha256Digest,
}

/// The passages that an experiment plans: the maneuver of each condition, and trials per condition.
#[derive(Debug, Clone, PartialEq, Eq)]
struct PlannedPassages {
    maneuvers: Vec<(Motion, Speed)>,
    trials: u32,
}

impl PlannedPassages {
    /// Creates the passages of an experiment of these conditions with `trials` each.
    ///
    /// # Errors
    /// Where a condition is something other than isolated passages.
    fn of(design: &Design<'_>, trials: u32) -> Result<Self, CalibrationError> {
        let maneuver = |(condition, setup): &(&Condition, &Setup)| match setup.of::<super::Setup>()
        {
            Some(setup) if setup.parameters.mission.task == Task::Passage => {
                Ok((setup.parameters.passage.motion, setup.parameters.passage.speed))
            }
            _ => Err(CalibrationError::of(format!(
                "expected `mission.task: passage`, `{}` is something else",
                condition.slug()
            ))),
        };
        let maneuvers = design.iter().map(maneuver).collect::<Result<_, _>>()?;
        Ok(Self { maneuvers, trials })
    }

    /// Returns how many there are.
    fn count(&self) -> u64 {
        self.maneuvers.len() as u64 * u64::from(self.trials)
    }

    fn each(&self) -> impl Iterator<Item = (Motion, Speed, u32)> + '_ {
        let of = |(motion, speed): &(Motion, Speed)| {
            let (motion, speed) = (*motion, *speed);
            (0..self.trials).map(move |trial| (motion, speed, trial))
        };
        self.maneuvers.iter().flat_map(of)
    }

    /// Builds the passages from their records: all of them, in plan order.
    ///
    /// # Errors
    /// Where there are more or fewer records.
    fn passages_of(&self, records: &[TrialRecord]) -> Result<Passages, CalibrationError> {
        if records.len() as u64 != self.count() {
            let (expected, found) = (self.count(), records.len());
            let what = format!("expected the records of {expected} passages, found {found}");
            return Err(CalibrationError::of(what));
        }
        let rows = self.each().zip(records).map(|((motion, speed, trial), record)| {
            let time_s = record.measures.get("time-s").copied().flatten();
            let passage = Driven { motion, speed, outcome: record.outcome, time_s };
            Row { trial, passage, record: Sha256Digest::of(record.to_line()) }
        });
        Ok(Passages { rows: rows.collect() })
    }

    /// Reads a text that [`Passages::to_csv`] wrote of exactly these.
    ///
    /// # Errors
    /// Where it is something else, naming the line.
    fn passages_in(&self, text: &str) -> Result<Passages, CalibrationError> {
        let fault = |what: String| CalibrationError::of(what);
        let lines = text.lines().count() as u64;
        // Counted before they are read: a manifest of a few words can request millions.
        if lines != self.count() + 1 {
            let expected = self.count();
            return Err(fault(format!(
                "expected a header and {expected} passages, found {lines} lines"
            )));
        }
        let table = Table::from_csv(text).map_err(|e| fault(e.to_string()))?;
        if table.columns != COLUMNS {
            let (expected, found) = (COLUMNS.join(", "), table.columns.join(", "));
            return Err(fault(format!("expected the columns {expected}, found {found}")));
        }
        let mut rows = Vec::with_capacity(table.rows.len());
        for (i, ((motion, speed, trial), row)) in self.each().zip(&table.rows).enumerate() {
            let at = |problem: String| fault(format!("line {}: {problem}", i + 2));
            let (wanted, found) = (named(motion, speed, trial), joined(&row[..3]));
            if wanted != found {
                return Err(at(format!("expected `{wanted}`, found `{found}`")));
            }
            let written = row[3].to_string();
            let outcome = OUTCOMES.into_iter().find(|outcome| outcome.name() == written);
            let outcome =
                outcome.ok_or_else(|| at(format!("`{written}` is no outcome of a passage")))?;
            let time_s = row[4].as_f64().filter(|time| *time >= 0.0);
            if time_s.is_none() && row[4] != Value::Missing {
                return Err(at(format!("`time-s` must be a number from 0, found `{}`", row[4])));
            }
            let digest = row[5].to_string();
            let record = Sha256Digest::from_hex(&digest)
                .ok_or_else(|| at(format!("`record` must be 64 hex digits, found `{digest}`")))?;
            rows.push(Row { trial, passage: Driven { motion, speed, outcome, time_s }, record });
        }
        Ok(Passages { rows })
    }
}

impl Calibrated for Passages {
    fn trials(&self) -> usize {
        self.rows.len()
    }

    fn to_csv(&self) -> String {
        let mut table = Table::new(COLUMNS);
        for row in &self.rows {
            table.push(fields(row));
        }
        table.to_csv()
    }

    /// Returns the row without its first three fields, which are those that the plan gives.
    fn told(&self, index: usize) -> Option<String> {
        self.rows.get(index).map(|row| joined(&fields(row)[3..]))
    }

    fn told_of(&self, record: &TrialRecord) -> String {
        let time: Value = record.measures.get("time-s").copied().flatten().into();
        joined(&[
            record.outcome.name().into(),
            time,
            Sha256Digest::of(record.to_line()).hex().into(),
        ])
    }

    /// Computes the pairs of the maneuvers; an error where a maneuver has too few passages or none that arrived.
    fn expectations(&self) -> Result<Expectations, CalibrationError> {
        Calibration::measure(self.rows.iter().map(|row| row.passage)).map(expectations)
    }
}

fn fields(row: &Row) -> Vec<Value> {
    let Driven { motion, speed, outcome, time_s } = row.passage;
    vec![
        motion.name().into(),
        speed.name().into(),
        i64::from(row.trial).into(),
        outcome.name().into(),
        time_s.into(),
        row.record.hex().into(),
    ]
}

fn named(motion: Motion, speed: Speed, trial: u32) -> String {
    format!("{},{},{trial}", motion.name(), speed.name())
}

fn joined(fields: &[Value]) -> String {
    fields.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::sample;

    fn planned() -> PlannedPassages {
        PlannedPassages { maneuvers: vec![(Motion::Corridor, Speed::Slow)], trials: 2 }
    }

    fn records() -> [TrialRecord; 2] {
        [0, 1].map(|trial| {
            let mut record = sample::record(7, "none", trial);
            record.outcome = if trial == 0 { Outcome::REACHED } else { Outcome::COLLIDED };
            record.measures = [("time-s".to_owned(), (trial == 0).then_some(12.5))].into();
            record
        })
    }

    #[test]
    fn passages_survive_their_table() {
        let showed = planned().showed(&records()).unwrap();
        let text = showed.to_csv();
        let digest = |i: usize| Sha256Digest::of(records()[i].to_line());
        assert_eq!(
            text,
            format!(
                "motion,speed,trial,outcome,time-s,record\ncorridor,slow,0,reached,12.5,{}\n\
                 corridor,slow,1,collided,,{}\n",
                digest(0),
                digest(1)
            )
        );
        assert_eq!(planned().read(&text).unwrap().to_csv(), text);
        assert_eq!(showed.told(1).unwrap(), showed.told_of(&records()[1]));
    }

    #[test]
    fn what_is_not_of_the_plan_is_refused_with_its_line() {
        let text = planned().showed(&records()).unwrap().to_csv();
        let refused = |text: &str| planned().read(text).unwrap_err().to_string();
        assert_eq!(
            refused(&text.replace("slow,1", "fast,1")),
            "calibration: line 3: expected `corridor,slow,1`, found `corridor,fast,1`"
        );
        assert_eq!(
            refused(&text.replace("12.5", "soon")),
            "calibration: line 2: `time-s` must be a number from 0, found `soon`"
        );
        assert_eq!(
            refused(&text.replace("collided", "explored")),
            "calibration: line 3: `explored` is no outcome of a passage"
        );
        assert_eq!(
            refused("motion,speed\n"),
            "calibration: expected a header and 2 passages, found 1 lines"
        );
        let cut = text.replace(&Sha256Digest::of(records()[1].to_line()).hex(), "abc");
        assert_eq!(
            refused(&cut),
            "calibration: line 3: `record` must be 64 hex digits, found `abc`"
        );
        assert_eq!(
            planned().showed(&records()[..1]).unwrap_err().to_string(),
            "calibration: expected the records of 2 passages, found 1"
        );
    }
}
