//! `calibration: FILE`: the manifest whose trials measure what the mind of another expects.

use super::experiment::{CalibrationRun, Experiment};
use super::input::{Input, InputKind, WrittenIn};
use super::library::{CalibrationTrials, InputError, Inputs, Library, joined, normalised};
use super::resolve::resolve;
use super::resolver::Resolver;
use crate::studies::{CalibrationError, Expectations, planned_calibration};
use std::cell::RefCell;
use std::string::FromUtf8Error;
use std::sync::Arc;

impl Resolver<'_> {
    /// Returns what is expected, as measured by the calibration manifest or read from the bundle that holds it.
    pub(super) fn calibration(&mut self) -> Option<Expectations> {
        let key = self.doc.calibration.clone().unwrap_or_default();
        self.once(|library| &mut library.calibrations, key, Self::read_calibration)
    }

    fn read_calibration(&mut self) -> Option<Expectations> {
        let Some(path) = &self.doc.calibration else {
            let fault = self
                .faults
                .key_fault("/study", "an exploration under a deadline needs a `calibration`")
                .label("its planner must know what its maneuvers take");
            let help = "add `calibration: FILE`, a manifest of isolated passages";
            self.faults.push(fault.help(help));
            return None;
        };
        let pointer = "/calibration";
        if let Some(other) = self.library.files.calibrates() {
            let message =
                format!("`{other}` is read as a calibration and asks for the calibration `{path}`");
            let fault = self.faults.fault(pointer, message).label("one that is none of its own");
            let help = "a calibration measures isolated passages: `mission: {task: passage}`, no `calibration`";
            self.faults.push(fault.help(help));
            return None;
        }
        let experiment = self.calibration_experiment(path, pointer)?;
        let path = normalised(path);
        let stem = path.strip_suffix(".yaml").unwrap_or(&path);
        let [sealed_as, pairs] = ["passages", "maneuvers"].map(|what| format!("{stem}.{what}.csv"));
        match self.measured(experiment, sealed_as) {
            Ok((run, expected)) => {
                // What follows from the trials is sealed beside them, for people.
                if run.showed.is_some() {
                    let csv = expected.csv().as_bytes();
                    self.library.files.made(&pairs, InputKind::Maneuvers, csv);
                }
                self.calibration_run = Some(Arc::new(run));
                Some(expected)
            }
            Err(problem) => {
                let message = format!("`{path}` gives no calibration");
                let fault = self.faults.fault(pointer, message).label(problem.to_string());
                self.faults
                    .push(fault.help(format!("`reenact check {path}` tells its own faults")));
                None
            }
        }
    }

    /// Returns the experiment that the manifest `path`, written at `pointer`, describes. It and all that it reads are
    /// inputs, too: whoever doubts the pairs can measure them again.
    fn calibration_experiment(&mut self, path: &str, pointer: &str) -> Option<Experiment> {
        let source = self.text(path, pointer, InputKind::Calibration)?;
        let written_in = self.faults.written_in(pointer);
        let path = normalised(path);
        let resolved =
            resolve(&source, &[], &OfCalibration::new(&mut self.library, &path, written_in));
        match resolved {
            Ok((experiment, warnings)) => {
                for Input { as_written, kind, .. } in &experiment.inputs {
                    self.library.files.say(&joined(&path, as_written), written_in, *kind);
                }
                self.faults.extend(warnings);
                Some(experiment)
            }
            Err(faults) => {
                self.faults.extend(faults);
                None
            }
        }
    }

    /// Returns what the trials of `experiment` show.
    fn measured(
        &mut self,
        experiment: Experiment,
        sealed_as: String,
    ) -> Result<(CalibrationRun, Expectations), Unmeasured> {
        let study = self.doc.study;
        let planned = planned_calibration(study, experiment.design(), experiment.trials)?;
        let showed = match self.library.files.calibrate(&experiment, &sealed_as)? {
            CalibrationTrials::StandIn => None,
            CalibrationTrials::Csv(bytes) => {
                let text = String::from_utf8(bytes)?;
                let read = planned.read(&text);
                Some(read.map_err(|error| Unmeasured::Unread(sealed_as.clone(), error))?)
            }
        };
        let expected = match &showed {
            Some(showed) => showed.expectations()?,
            None => planned.stand_in(),
        };
        Ok((CalibrationRun { experiment, showed, sealed_as }, expected))
    }
}

/// Why a calibration's experiment shows nothing.
#[derive(Debug, thiserror::Error)]
enum Unmeasured {
    #[error(transparent)]
    Input(#[from] InputError),
    #[error(transparent)]
    NotText(#[from] FromUtf8Error),
    #[error("`{0}`: {1}")]
    Unread(String, CalibrationError),
    #[error(transparent)]
    Unfit(#[from] CalibrationError),
}

/// The files of the calibration manifest `manifest`, which are inputs of the manifest that names it, too.
struct OfCalibration<'f, 'a> {
    library: RefCell<&'f mut Library<'a>>,
    manifest: String,
    written_in: WrittenIn,
}

impl<'f, 'a> OfCalibration<'f, 'a> {
    /// Creates the files beside `manifest`, which is [`normalised`] and was written in `written_in`.
    fn new(library: &'f mut Library<'a>, manifest: &str, written_in: WrittenIn) -> Self {
        Self { library: RefCell::new(library), manifest: manifest.to_owned(), written_in }
    }
}

impl Inputs for OfCalibration<'_, '_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let path = joined(&self.manifest, as_written);
        let files = &mut self.library.borrow_mut().files;
        files.read(&path, self.written_in, InputKind::Calibration).map(|bytes| bytes.to_vec())
    }

    fn follows(&self, as_written: &str, _: WrittenIn) -> bool {
        let path = joined(&self.manifest, as_written);
        self.library.borrow().files.follows(&path, self.written_in)
    }

    fn calibrates(&self) -> Option<&str> {
        Some(&self.manifest)
    }
}
