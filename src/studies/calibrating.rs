//! What the trials of a study rest on: an experiment that runs before, whose trials show what to expect.
//!
//! A manifest names it by `calibration: FILE`. How its trials are read, and what follows from them, is the study's own; that they
//! are run, sealed, read again and driven again is not.

use super::{Setup, StudyKind, TrialRecord};
use crate::condition::Condition;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The conditions of an experiment, in plan order.
pub type Design<'a> = [(&'a Condition, &'a Setup)];

/// How a study learns from calibrations.
pub trait Calibrating: Sync {
    /// Returns what an experiment of these conditions, with `trials` each, will show.
    ///
    /// # Errors
    /// Where it is no calibration of this study.
    fn planned(
        &self,
        design: &Design<'_>,
        trials: u32,
    ) -> Result<Box<dyn PlannedCalibration>, CalibrationError>;
}

/// Returns what an experiment of these conditions, with `trials` each, will show as a calibration of `study`.
///
/// # Errors
/// Where it is none.
pub fn planned_calibration<'a>(
    study: StudyKind,
    design: impl IntoIterator<Item = (&'a Condition, &'a Setup)>,
    trials: u32,
) -> Result<Box<dyn PlannedCalibration>, CalibrationError> {
    let none = || CalibrationError::of(format!("the study `{}` rests on none", study.name()));
    let design: Vec<_> = design.into_iter().collect();
    study.calibrating().ok_or_else(none)?.planned(&design, trials)
}

/// The trials of a calibration before they are run.
pub trait PlannedCalibration {
    /// Returns what `records`, all of them in plan order, show.
    ///
    /// # Errors
    /// Where there are more or fewer records.
    fn showed(&self, records: &[TrialRecord]) -> Result<Arc<dyn Calibrated>, CalibrationError>;

    /// Reads a text that [`Calibrated::to_csv`] wrote of exactly these trials.
    ///
    /// # Errors
    /// Where it is something else, naming the line.
    fn read(&self, text: &str) -> Result<Arc<dyn Calibrated>, CalibrationError>;

    /// Returns expectations for checks where nothing was run: they enter no result.
    fn stand_in(&self) -> Expectations;
}

/// What the trials of a calibration showed, one row a trial in plan order.
pub trait Calibrated: fmt::Debug + Send + Sync {
    /// Returns how many trials there are.
    fn trials(&self) -> usize;

    /// Writes the table that is sealed as an input: one row per trial.
    fn to_csv(&self) -> String;

    /// Returns the row of the trial `index` for display, without the fields that the plan gives.
    fn told(&self, index: usize) -> Option<String>;

    /// Returns the same of `record`, whichever trial it belongs to.
    fn told_of(&self, record: &TrialRecord) -> String;

    /// Computes what follows from the trials.
    ///
    /// # Errors
    /// Where they are too few, or show nothing.
    fn expectations(&self) -> Result<Expectations, CalibrationError>;
}

/// What a study's mind expects, as its own type, and as the table that is sealed for people.
#[derive(Debug, Clone)]
pub struct Expectations {
    known: Arc<dyn Any + Send + Sync>,
    csv: String,
}

impl Expectations {
    /// Creates those that `known` holds, with their table in CSV.
    pub fn new(known: impl Any + Send + Sync, csv: String) -> Self {
        Self { known: Arc::new(known), csv }
    }

    /// Returns them as a study's own type; `None` where they are another study's.
    pub fn of<E: Any + Send + Sync>(&self) -> Option<Arc<E>> {
        Arc::clone(&self.known).downcast().ok()
    }

    /// Returns their table in CSV.
    pub fn csv(&self) -> &str {
        &self.csv
    }
}

/// Why trials are no calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("calibration: {0}")]
pub struct CalibrationError(String);

impl CalibrationError {
    /// Creates one that says `what` is wrong.
    pub(super) fn of(what: String) -> Self {
        Self(what)
    }
}
