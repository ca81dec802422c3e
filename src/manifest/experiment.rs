//! A manifest with everything settled: names are references, defaults are written out, files are read.

use super::document::{Author, Cite};
use super::input::Input;
use crate::claims::{Claim, Multiverse, Sensitivity};
use crate::condition::Condition;
use crate::digest::MeaningDigest;
use crate::document::Tree;
use crate::factor::Factor;
use crate::labels::Labels;
use crate::studies::inference::from_trials::FromTrials;
use crate::studies::{Calibrated, Setup, StudyKind};
use crate::studies::{FigureRequest, TableRequest};
use crate::table::Table;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A resolved experiment.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Its short name, for files.
    pub name: String,
    /// Its title.
    pub title: String,
    /// The publication it re-enacts.
    pub cite: Option<Cite>,
    /// Authors of the manifest.
    pub authors: Vec<Author>,
    /// Licence of the manifest and of what it yields.
    pub license: Option<String>,
    /// What its numbers cannot show, one sentence each.
    pub limits: Vec<String>,
    /// Which study this is.
    pub kind: StudyKind,
    /// Seed of all randomness.
    pub seed: u64,
    /// Trials per condition.
    pub trials: u32,
    /// Factors whose values see the same noise.
    pub shared_noise: Vec<String>,
    /// The factors, in order.
    pub factors: Vec<Factor>,
    /// What readers see for factors and their values.
    pub labels: Labels,
    /// The cells of the design, in crossed order.
    pub conditions: Vec<ResolvedCondition>,
    /// The paper's own numbers, by name.
    pub published: BTreeMap<String, Table>,
    /// The file each of them comes from, as written.
    pub published_files: BTreeMap<String, String>,
    /// Tables to produce.
    pub tables: Vec<TableRequest>,
    /// What is inferred from the trials, where something is.
    pub from_trials: Option<FromTrials>,
    /// Figures to produce.
    pub figures: Vec<FigureRequest>,
    /// Claims; `/claims/N` in `document` says where, and how they are written.
    pub claims: Vec<Claim>,
    /// Values that the paper leaves open, with the reasons for them.
    pub assumptions: Vec<Assumption>,
    /// What the claims' verdicts were at other values of the assumptions, where that was tried.
    pub sensitivity: Option<Robustness>,
    /// What they were at draws of all ranges together, where that was tried.
    pub multiverse: Option<JointDraws>,
    /// The experiment that measured what the planner expects, where one did.
    pub calibration: Option<Arc<CalibrationRun>>,
    /// The inference whose draws are the values of a factor, where there is one.
    pub inference: Option<InferenceRun>,
    /// `PATH=VALUE` from the command line, in order.
    pub overrides: Vec<String>,
    /// Every file that was read, once.
    pub inputs: Vec<Input>,
    /// The manifest's tree, to point at in later faults.
    pub document: Tree,
}

/// A cell of the design with everything settled.
#[derive(Debug, Clone)]
pub struct ResolvedCondition {
    /// The value of every factor.
    pub condition: Condition,
    /// What its trials need.
    pub setup: Setup,
    /// What its things mean.
    pub meanings: Meanings,
    /// What it was resolved from, for people.
    pub described: Value,
}

/// What `reenact vary` found, and where it is written.
#[derive(Debug, Clone)]
pub struct Robustness {
    /// The file that holds it, as written.
    pub as_written: String,
    /// What was found.
    pub table: Sensitivity,
}

/// What `reenact vary --joint` found, and where it is written.
#[derive(Debug, Clone)]
pub struct JointDraws {
    /// The file that holds it, as written.
    pub as_written: String,
    /// What was found.
    pub table: Multiverse,
}

/// An experiment that others rest on, and what it showed.
#[derive(Debug, Clone)]
pub struct CalibrationRun {
    /// The experiment.
    pub experiment: Experiment,
    /// What its trials showed; `None` where numbers stand in that nobody measured.
    pub showed: Option<Arc<dyn Calibrated>>,
    /// The path by which bundles know its trials.
    pub sealed_as: String,
}

/// An inference whose draws others run, and what it proposed.
#[derive(Debug, Clone)]
pub struct InferenceRun {
    /// The experiment.
    pub experiment: Arc<Experiment>,
    /// The records of its trials, in plan order, each a line; `None` where draws stand in that nobody made.
    pub proposals: Option<Arc<[String]>>,
    /// The path by which bundles know them.
    pub sealed_as: String,
    /// The factor whose values are its draws.
    pub factor: String,
}

/// A parameter that the paper leaves open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assumption {
    /// Its path in the manifest (`parameters.mapping.resolution-m`).
    pub path: String,
    /// Its value, or one for every value of a factor.
    pub value: Value,
    /// Why it was chosen.
    pub why: String,
    /// Other values that could as well have been chosen; empty where the manifest states none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub range: Vec<Value>,
}

/// Digests of what a condition's things mean, whatever their files look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Meanings {
    /// The robot.
    pub robot: MeaningDigest,
    /// The world.
    pub world: MeaningDigest,
    /// The prior map, where there is one.
    pub prior: Option<MeaningDigest>,
}

impl Experiment {
    /// Returns the cells of the design and what their trials need, in crossed order.
    pub fn design(&self) -> impl Iterator<Item = (&Condition, &Setup)> + Clone {
        self.conditions.iter().map(|resolved| (&resolved.condition, &resolved.setup))
    }

    /// Returns the inference whose draws this experiment runs, or its calibration.
    pub fn inference(&self) -> Option<&InferenceRun> {
        let of_calibration = self.calibration.as_deref().map(|run| &run.experiment);
        self.inference.as_ref().or_else(|| of_calibration?.inference.as_ref())
    }

    /// Returns the factor whose values are draws of a posterior, where there is one.
    pub fn draws(&self) -> Option<&str> {
        self.inference.as_ref().map(|run| run.factor.as_str())
    }
}
