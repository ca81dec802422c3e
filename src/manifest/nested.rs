//! Manifests that a manifest rests on: that of its calibration, and that of the inference whose draws it runs. They and all that they
//! read are inputs, too, so that whoever doubts what follows from their trials can run these again.

use super::experiment::Experiment;
use super::input::{Input, Nested, WrittenIn};
use super::library::{
    CalibrationTrials, InputError, Inputs, Library, ProposalTrials, joined, normalised,
};
use super::resolve::resolve;
use super::resolver::Resolver;
use crate::document::{Source, read};
use std::cell::RefCell;

impl Resolver<'_> {
    /// Returns the experiment that the manifest `path`, written at `pointer`, describes.
    pub(super) fn nested(&mut self, path: &str, pointer: &str, role: Nested) -> Option<Experiment> {
        let source = self.text(path, pointer, role.kind())?;
        if role == Nested::Inference && !self.infers(&source, path, pointer) {
            return None;
        }
        let written_in = self.faults.written_in(pointer);
        let path = normalised(path);
        let beside = Beside {
            library: RefCell::new(&mut self.library),
            manifest: path.clone(),
            written_in,
            role,
        };
        match resolve(&source, &[], &beside) {
            Ok((mut experiment, warnings)) => {
                for Input { as_written, kind, .. } in &experiment.inputs {
                    self.library.files.say(&joined(&path, as_written), written_in, *kind);
                }
                if let Some(run) = &mut experiment.inference {
                    run.sealed_as = joined(&path, &run.sealed_as);
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

    /// Returns whether `source` is the manifest of an inference; a fault at `pointer`, which names it as `path`, where it is not.
    fn infers(&mut self, source: &Source, path: &str, pointer: &str) -> bool {
        // What is no YAML is told by whoever resolves it.
        let infers = read(source).map_or(true, |tree| tree.root.get("infer").is_some());
        if !infers {
            let fault = self.faults.fault(pointer, format!("`{path}` infers nothing"));
            let fault = fault.label("expected a manifest with `infer`");
            self.faults.push(fault.help("docs/inference.md says how one is written"));
        }
        infers
    }
}

/// Why an inference's manifest gets no calibration.
#[derive(Debug, thiserror::Error)]
#[error(
    "an inference whose draws are run states all that its maneuvers take, in `parameters.graph`"
)]
struct NoCalibration;

/// The files of a manifest that another names, which are inputs of that one, too.
struct Beside<'f, 'a> {
    library: RefCell<&'f mut Library<'a>>,
    /// The manifest, [`normalised`], as the other writes it.
    manifest: String,
    written_in: WrittenIn,
    role: Nested,
}

impl Inputs for Beside<'_, '_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let path = joined(&self.manifest, as_written);
        let files = &mut self.library.borrow_mut().files;
        files.read(&path, self.written_in, self.role.kind()).map(|bytes| bytes.to_vec())
    }

    fn follows(&self, as_written: &str, _: WrittenIn) -> bool {
        let path = joined(&self.manifest, as_written);
        self.library.borrow().files.follows(&path, self.written_in)
    }

    fn calibrate(
        &self,
        calibration: &Experiment,
        _: &str,
    ) -> Result<CalibrationTrials, InputError> {
        match self.role {
            Nested::Inference => Err(InputError::other(NoCalibration)),
            Nested::Calibration => Err(InputError::NoCalibration(calibration.name.clone())),
        }
    }

    fn propose(
        &self,
        inference: &Experiment,
        sealed_as: &str,
    ) -> Result<ProposalTrials, InputError> {
        let sealed_as = joined(&self.manifest, sealed_as);
        self.library.borrow_mut().files.propose(inference, &sealed_as)
    }

    fn read_as(&self) -> Option<(Nested, &str)> {
        Some((self.role, &self.manifest))
    }
}
