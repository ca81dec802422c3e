//! A manifest run here: what the determinism contract holds against the program that users have.

use reenact::bundle::{Circumstance, Moment, assemble, seal};
use reenact::digest::ResultsDigest;
use reenact::document::{Source, reports};
use reenact::manifest::{self, CalibrationTrials, Experiment, InputError, Inputs, ProposalTrials, WrittenIn};
use reenact::plan::{Plan, Selection};
use reenact::runner::{Scheduler, Silent};
use reenact::studies::{self, Outcome, TrialRecord, TrialSpec};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Display;

/// Which manifest, and the files that lie in the bytes of the request, one after the other.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Asked {
    /// The manifest, one of the files.
    manifest: String,
    /// The path of each file as the manifest names it, from its own folder, and its length.
    files: Vec<(String, usize)>,
    /// As `--only FACTOR=VALUE[,VALUE]`.
    #[serde(default)]
    only: Vec<String>,
    /// As `--trials N`.
    trials: Option<u32>,
}

/// What came out.
pub(crate) struct Ran {
    pub(crate) results_digest: ResultsDigest,
    pub(crate) trials: usize,
    pub(crate) failed: usize,
}

/// The files of a request by their path.
struct Given<'a>(BTreeMap<&'a str, &'a [u8]>);

impl Inputs for Given<'_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        self.0.get(as_written).map(|bytes| bytes.to_vec()).ok_or(InputError::NoFile)
    }

    fn calibrate(
        &self,
        calibration: &Experiment,
        _: &str,
    ) -> Result<CalibrationTrials, InputError> {
        let plan = Plan::of(calibration.clone());
        let records = execute(&plan).map_err(InputError::other)?;
        CalibrationTrials::shown_by(&plan.experiment, &records).map_err(InputError::other)
    }

    fn propose(&self, inference: &Experiment, _: &str) -> Result<ProposalTrials, InputError> {
        let records = execute(&Plan::of(inference.clone())).map_err(InputError::other)?;
        Ok(ProposalTrials::of(&records))
    }

    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        Ok(manifest::explored(spec, sealed_as)?)
    }
}

fn execute(plan: &Plan) -> Result<Vec<TrialRecord>, reenact::runner::RunError> {
    Scheduler::new(1)?.run(&plan.trials, &studies::execute, None, &Silent)
}

/// Runs a manifest and seals what comes out, as `reenact run` does.
///
/// # Errors
/// What is wrong with the manifest or the request, in words.
pub(crate) fn run(asked: &Asked, mut bytes: &[u8]) -> Result<Ran, String> {
    let mut files = BTreeMap::new();
    for (path, length) in &asked.files {
        let (file, rest) = bytes.split_at_checked(*length).ok_or("fewer bytes than files")?;
        files.insert(path.as_str(), file);
        bytes = rest;
    }
    let text = files.get(asked.manifest.as_str()).ok_or("no such manifest")?;
    let text = str::from_utf8(text).map_err(in_words)?;
    let resolved =
        manifest::resolve(&Source::new(&*asked.manifest, text), &[], &Given(files.clone()));
    let (experiment, _) = resolved.map_err(|faults| reports(&faults, false).concat())?;
    let selection = Selection::parse(&asked.only, asked.trials, None).map_err(in_words)?;
    let plan = if selection.is_partial() {
        Plan::select(experiment, &selection).map_err(in_words)?
    } else {
        Plan::of(experiment)
    };
    let records = execute(&plan).map_err(in_words)?;
    let content = assemble::assemble(&plan, text.as_bytes(), &selection, &records);
    let sealed = seal(&content.map_err(in_words)?, &Circumstance::reproducible(Moment(0)));
    let failed = records.iter().filter(|record| record.outcome == Outcome::PANICKED).count();
    let results_digest = sealed.map_err(in_words)?.results_digest;
    Ok(Ran { results_digest, trials: records.len(), failed })
}

fn in_words(problem: impl Display) -> String {
    problem.to_string()
}
