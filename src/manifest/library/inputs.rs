//! Who hands over files and what is simulated before a manifest is resolved: the file system, or a bundle.

use crate::manifest::experiment::Experiment;
use crate::manifest::input::WrittenIn;
use crate::studies::TrialSpec;

/// Who hands over the bytes of files: the file system, or a bundle.
pub trait Inputs {
    /// The bytes of the file `as_written`: a path with forward slashes and without needless dots.
    ///
    /// # Errors
    /// Why there are none, in words (`no such file`).
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, String>;

    /// The passages of the experiment `calibration`, one row a trial; in bundles they are sealed as `sealed_as`.
    ///
    /// # Errors
    /// Why there are none, in words.
    fn calibrate(&self, calibration: &Experiment, sealed_as: &str) -> Result<Measured, String> {
        let _ = sealed_as;
        Err(format!("nobody here can run `{}`", calibration.name))
    }

    /// The manifest on whose behalf these files are read, where that is a calibration: it has none of its own.
    fn calibrates(&self) -> Option<&str> {
        None
    }

    /// The map that the robot of `spec` ends with, as a `map_server` descriptor and the image that it names; in bundles
    /// they are sealed as `sealed_as`. [`crate::manifest::explored`] makes them.
    ///
    /// # Errors
    /// Why there is none, in words.
    fn explore(&self, spec: &TrialSpec, sealed_as: &[String; 2]) -> Result<[Vec<u8>; 2], String> {
        let _ = sealed_as;
        Err(format!("nobody here can run the exploration {}", spec.key.short()))
    }
}

/// What calibrating gave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Measured {
    /// The passages, as `studies::deadline::Passages` writes them.
    Passages(Vec<u8>),
    /// Nothing was measured: numbers stand in that enter no result.
    StandIn,
}
