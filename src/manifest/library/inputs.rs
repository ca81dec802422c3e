//! Who hands over files and what is simulated before a manifest is resolved: the file system, or a bundle.

use crate::manifest::experiment::Experiment;
use crate::manifest::input::{Nested, WrittenIn};
use crate::studies::{CalibrationError, TrialRecord, TrialSpec, planned_calibration};
use std::error::Error;
use std::sync::Arc;

/// Why an input cannot be had.
#[derive(Debug, Clone, thiserror::Error)]
pub enum InputError {
    /// There is no file of that name.
    #[error("no such file")]
    NoFile,
    /// Nobody here runs calibrations.
    #[error("this program cannot run `{0}`")]
    NoCalibration(String),
    /// Nobody here makes proposals.
    #[error("this program cannot make the proposals of `{0}`")]
    NoInference(String),
    /// Nobody here runs explorations.
    #[error("this program cannot run the exploration {0}")]
    NoExploration(String),
    /// Whoever hands inputs over has a reason of its own.
    #[error("{0}")]
    Other(Arc<dyn Error + Send + Sync>),
}

impl InputError {
    /// Returns `reason` as the reason why there is no input.
    pub fn other(reason: impl Error + Send + Sync + 'static) -> Self {
        Self::Other(Arc::new(reason))
    }
}

/// Who hands over the bytes of files: the file system, or a bundle.
pub trait Inputs {
    /// Returns the bytes of the file `as_written`: a path with forward slashes and without needless dots.
    ///
    /// # Errors
    /// Why there are none.
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, InputError>;

    /// Returns whether `as_written` is followed where a file of a robot or a world names it, though it leads out of the folders
    /// that the manifest names: a path from the root of a file system, or above the file's own folder.
    fn follows(&self, as_written: &str, written_in: WrittenIn) -> bool {
        let _ = (as_written, written_in);
        false
    }

    /// Returns what the experiment `calibration` showed, one row a trial; in bundles they are sealed as `sealed_as`.
    ///
    /// # Errors
    /// Why there are none.
    fn calibrate(
        &self,
        calibration: &Experiment,
        sealed_as: &str,
    ) -> Result<CalibrationTrials, InputError> {
        let _ = sealed_as;
        Err(InputError::NoCalibration(calibration.name.clone()))
    }

    /// Returns what every trial of the experiment `inference` proposed; in bundles they are sealed as `sealed_as`.
    ///
    /// # Errors
    /// Why there are none.
    fn propose(
        &self,
        inference: &Experiment,
        sealed_as: &str,
    ) -> Result<ProposalTrials, InputError> {
        let _ = sealed_as;
        Err(InputError::NoInference(inference.name.clone()))
    }

    /// Returns the manifest on whose behalf these files are read, where another names it, and as what: it names none of its own.
    fn read_as(&self) -> Option<(Nested, &str)> {
        None
    }

    /// Returns the map that the robot of `spec` ends with, as a `map_server` descriptor and the image that it names; in
    /// bundles they are sealed as `sealed_as`. [`crate::manifest::explored`] makes them.
    ///
    /// # Errors
    /// Why there is none.
    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        let _ = sealed_as;
        Err(InputError::NoExploration(spec.key.short()))
    }
}

/// The trials of a calibration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CalibrationTrials {
    /// What they showed, as [`crate::studies::Calibrated::to_csv`] writes it.
    Csv(Vec<u8>),
    /// Nothing was measured: numbers stand in that enter no result.
    StandIn,
}

impl CalibrationTrials {
    /// Returns what the `records` of every trial of `calibration` show.
    ///
    /// # Errors
    /// Where they show nothing to calibrate with.
    pub fn shown_by(
        calibration: &Experiment,
        records: &[TrialRecord],
    ) -> Result<Self, CalibrationError> {
        planned_calibration(calibration.kind, calibration.design(), calibration.trials)
            .and_then(|planned| planned.showed(records))
            .map(|showed| Self::Csv(showed.to_csv().into_bytes()))
    }
}

/// The trials of an inference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProposalTrials {
    /// Their records in plan order, each a line.
    Lines(Vec<u8>),
    /// Nothing was proposed: draws stand in that enter no result.
    StandIn,
}

impl ProposalTrials {
    /// Returns what holds `records`, all of an inference's in plan order.
    pub fn of(records: &[TrialRecord]) -> Self {
        let lines = records.iter().map(|record| record.to_line() + "\n");
        Self::Lines(lines.collect::<String>().into_bytes())
    }
}
