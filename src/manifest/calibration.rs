//! `calibration: FILE`: the manifest whose trials measure what the mind of another expects.

use super::experiment::{CalibrationRun, Experiment};
use super::input::{InputKind, Nested};
use super::library::{CalibrationTrials, InputError, normalised};
use super::resolver::Resolver;
use crate::studies::{CalibrationError, Expectations, planned_calibration};
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
        if let Some((Nested::Calibration, other)) = self.library.files.read_as() {
            let message =
                format!("`{other}` is read as a calibration and asks for the calibration `{path}`");
            let fault = self.faults.fault(pointer, message).label("one that is none of its own");
            let help = "a calibration measures isolated passages: `mission: {task: passage}`, no `calibration`";
            self.faults.push(fault.help(help));
            return None;
        }
        let experiment = self.nested(path, pointer, Nested::Calibration)?;
        if let (Some(own), Some(other)) = (&self.inference_run, &experiment.inference)
            && own.sealed_as != other.sealed_as
        {
            let message = format!("`{path}` runs draws of another posterior");
            let fault = self.faults.fault(pointer, message).label("expected draws of the same one");
            self.faults.push(fault.help("name the same `posterior` in both manifests"));
            return None;
        }
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
