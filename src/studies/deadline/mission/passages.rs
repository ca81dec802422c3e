//! The isolated passages on which a calibration rests, one row per trial: sealed beside the pairs that follow from
//! them, so that anyone who doubts a pair can count again, and drive any passage again.

use super::calibrations::Calibrations;
use super::tally;
use crate::condition::Condition;
use crate::digest::Sha256Digest;
use crate::studies::deadline::build_cmdp::{Motion, Speed, Through};
use crate::studies::deadline::calibration::{Calibration, Driven};
use crate::studies::deadline::{Setup as DeadlineSetup, Task};
use crate::studies::{
    Calibrated, Calibrating, CalibrationError, Design, Expectations, Outcome, PlannedCalibration,
    Setup, TrialRecord,
};
use crate::table::{Table, Value};
use crate::world::World;
use std::sync::Arc;

const COLUMNS: [&str; 8] =
    ["world", "motion", "speed", "trial", "through", "outcome", "time-s", "record"];
/// How many of them the plan gives.
const PLANNED: usize = 4;

/// The outcomes that a passage can have.
const OUTCOMES: [Outcome; 5] =
    [Outcome::REACHED, Outcome::COLLIDED, Outcome::LATE, Outcome::STALLED, Outcome::PANICKED];

/// How this study learns from calibrations: by isolated passages.
#[derive(Debug)]
pub(in crate::studies::deadline) struct Isolated;

impl Calibrating for Isolated {
    fn planned(
        &self,
        design: &Design<'_>,
        trials: u32,
    ) -> Result<Box<dyn PlannedCalibration>, CalibrationError> {
        Ok(Box::new(PlannedPassages::of(design, trials)?))
    }
}

fn expectations(by_world: Vec<(Arc<World>, Arc<Calibration>)>) -> Expectations {
    let calibrations = Calibrations::new(by_world);
    let csv = calibrations.to_csv();
    Expectations::new(calibrations, csv)
}

impl PlannedCalibration for PlannedPassages {
    fn showed(&self, records: &[TrialRecord]) -> Result<Arc<dyn Calibrated>, CalibrationError> {
        Ok(Arc::new(self.passages_of(records)?))
    }

    fn read(&self, text: &str) -> Result<Arc<dyn Calibrated>, CalibrationError> {
        Ok(Arc::new(self.passages_in(text)?))
    }

    fn stand_in(&self) -> Expectations {
        let stand_in = Arc::new(Calibration::stand_in());
        let worlds = self.worlds.iter();
        expectations(worlds.map(|world| (Arc::clone(world), Arc::clone(&stand_in))).collect())
    }
}

/// The passages of a calibration experiment, in plan order.
#[derive(Debug, Clone, PartialEq)]
struct Passages {
    worlds: Vec<Arc<World>>,
    rows: Vec<Row>,
}

/// One passage.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    /// Index of the building.
    world: usize,
    trial: u32,
    passage: Driven,
    /// Digest of the trial's record line.
    record: Sha256Digest,
}

/// The passages that an experiment plans: building and maneuver of each condition, and trials per condition.
#[derive(Debug, Clone, PartialEq)]
struct PlannedPassages {
    /// Every building once, in the order of the conditions.
    worlds: Vec<Arc<World>>,
    maneuvers: Vec<(usize, Motion, Speed)>,
    trials: u32,
}

impl PlannedPassages {
    /// Creates the passages of an experiment of these conditions with `trials` each.
    ///
    /// # Errors
    /// Where a condition is something other than isolated passages.
    fn of(design: &Design<'_>, trials: u32) -> Result<Self, CalibrationError> {
        let mut worlds: Vec<Arc<World>> = Vec::new();
        let maneuver = |(condition, setup): &(&Condition, &Setup)| match setup.of::<DeadlineSetup>()
        {
            Some(setup) if setup.parameters.mission.task == Task::Passage => {
                let known = worlds.iter().position(|world| *world == setup.world);
                let world = known.unwrap_or(worlds.len());
                if known.is_none() {
                    worlds.push(Arc::clone(&setup.world));
                }
                let passage = &setup.parameters.passage;
                Ok((world, passage.motion, passage.speed))
            }
            _ => Err(CalibrationError::of(format!(
                "expected `mission.task: passage`, `{}` is something else",
                condition.slug()
            ))),
        };
        let maneuvers = design.iter().map(maneuver).collect::<Result<_, _>>()?;
        Ok(Self { worlds, maneuvers, trials })
    }

    /// Returns how many there are.
    fn count(&self) -> u64 {
        self.maneuvers.len() as u64 * u64::from(self.trials)
    }

    fn each(&self) -> impl Iterator<Item = (usize, Motion, Speed, u32)> + '_ {
        let of = |(world, motion, speed): &(usize, Motion, Speed)| {
            let (world, motion, speed) = (*world, *motion, *speed);
            (0..self.trials).map(move |trial| (world, motion, speed, trial))
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
        let rows = self.each().zip(records).map(|((world, motion, speed, trial), record)| {
            let time_s = record.measures.number("time-s");
            let through = through_of(record);
            let passage = Driven { motion, speed, through, outcome: record.outcome, time_s };
            Row { world, trial, passage, record: Sha256Digest::of(record.to_line()) }
        });
        Ok(Passages { worlds: self.worlds.clone(), rows: rows.collect() })
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
        for (i, ((world, motion, speed, trial), row)) in self.each().zip(&table.rows).enumerate() {
            let at = |problem: String| fault(format!("line {}: {problem}", i + 2));
            let name = &self.worlds[world].name;
            let wanted = joined(&planned(name, motion, speed, trial));
            let found = joined(&row[..PLANNED]);
            if wanted != found {
                return Err(at(format!("expected `{wanted}`, found `{found}`")));
            }
            let written = row[4].to_string();
            let through = Through::ALL.into_iter().find(|through| through.name() == written);
            let through =
                through.ok_or_else(|| at(format!("`{written}` is nothing to pass through")))?;
            let written = row[5].to_string();
            let outcome = OUTCOMES.into_iter().find(|outcome| outcome.name() == written);
            let outcome =
                outcome.ok_or_else(|| at(format!("`{written}` is no outcome of a passage")))?;
            let time_s = row[6].as_f64().filter(|time| *time >= 0.0);
            if time_s.is_none() && row[6] != Value::Missing {
                return Err(at(format!("`time-s` must be a number from 0, found `{}`", row[6])));
            }
            let digest = row[7].to_string();
            let record = Sha256Digest::from_hex(&digest)
                .ok_or_else(|| at(format!("`record` must be 64 hex digits, found `{digest}`")))?;
            let passage = Driven { motion, speed, through, outcome, time_s };
            rows.push(Row { world, trial, passage, record });
        }
        Ok(Passages { worlds: self.worlds.clone(), rows })
    }
}

impl Calibrated for Passages {
    fn trials(&self) -> usize {
        self.rows.len()
    }

    fn to_csv(&self) -> String {
        let mut table = Table::new(COLUMNS);
        for row in &self.rows {
            table.push(self.fields(row));
        }
        table.to_csv()
    }

    /// Returns the row without its first fields, which are those that the plan gives.
    fn told(&self, index: usize) -> Option<String> {
        self.rows.get(index).map(|row| joined(&self.fields(row)[PLANNED..]))
    }

    fn told_of(&self, record: &TrialRecord) -> String {
        let time: Value = record.measures.number("time-s").into();
        joined(&[
            through_of(record).name().into(),
            record.outcome.name().into(),
            time,
            Sha256Digest::of(record.to_line()).hex().into(),
        ])
    }

    /// Computes the pairs of the maneuvers; an error where a maneuver has too few passages or none that arrived.
    fn expectations(&self) -> Result<Expectations, CalibrationError> {
        let measured = self.worlds.iter().enumerate().map(|(number, world)| {
            let here = self.rows.iter().filter(|row| row.world == number);
            let calibration = Calibration::measure(here.map(|row| row.passage))?;
            Ok((Arc::clone(world), Arc::new(calibration)))
        });
        measured.collect::<Result<_, _>>().map(expectations)
    }
}

impl Passages {
    fn fields(&self, row: &Row) -> Vec<Value> {
        let Driven { motion, speed, through, outcome, time_s } = row.passage;
        let mut fields = planned(&self.worlds[row.world].name, motion, speed, row.trial).to_vec();
        fields.extend([
            through.name().into(),
            outcome.name().into(),
            time_s.into(),
            row.record.hex().into(),
        ]);
        fields
    }
}

/// Returns the fields that the plan gives.
fn planned(world: &str, motion: Motion, speed: Speed, trial: u32) -> [Value; PLANNED] {
    [world.into(), motion.name().into(), speed.name().into(), i64::from(trial).into()]
}

/// Returns what the passage of `record` led through. One in which the program failed says nothing and counts for nothing.
fn through_of(record: &TrialRecord) -> Through {
    let passed = |through: &Through| {
        let measure = tally::passages_through(*through);
        record.measures.number(&measure).is_some_and(|count| count > 0.0)
    };
    Through::ALL.into_iter().find(passed).unwrap_or(Through::Corridor)
}

fn joined(fields: &[Value]) -> String {
    fields.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::sample;

    fn planned() -> PlannedPassages {
        PlannedPassages {
            worlds: vec![Arc::new(World::empty())],
            maneuvers: vec![(0, Motion::Corridor, Speed::Slow)],
            trials: 2,
        }
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
                "world,motion,speed,trial,through,outcome,time-s,record\n\
                 empty,corridor,slow,0,corridor,reached,12.5,{}\n\
                 empty,corridor,slow,1,corridor,collided,,{}\n",
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
            "calibration: line 3: expected `empty,corridor,slow,1`, found `empty,corridor,fast,1`"
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
