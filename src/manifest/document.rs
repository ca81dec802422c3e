//! A manifest exactly as written. What it means is settled in `resolve`.

mod infer;
mod prior;
mod robot;
mod world;

pub use infer::{ChoiceDoc, ChoicePriorDoc, FromTrialsDoc, InferDoc, InferenceDoc, LeftOutDoc};
pub use prior::{
    Alpha, BoundingBoxOf, DerivedFrom, FloorPlanOf, FootprintOf, MapPrior, OriginDoc, OwnWorld,
    PreviousMapDoc, PreviousMapOf, PriorDoc, PriorFrame, TopoMetricPrior, UnknownAs,
};
pub use robot::{RobotDoc, RobotFile};
pub(super) use world::UpAxisDoc;
pub use world::{
    FactorRef, GenerateDoc, GeneratedWorld, PlaceDoc, PointDoc, PoseDoc, SeedDoc, StartDoc,
    WorldDoc, WorldFile,
};

use super::choice::{Choice, FactorDoc, Ordered};
use super::parameters::ParametersDoc;
use super::pinned::PinnedDoc;
use crate::claims::Claim;
use crate::labels::Labels;
use crate::studies::StudyKind;
use crate::studies::{FactorValue, FigureRequest, TableRequest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A manifest: one experiment, from the worlds and robots it names to the tables it produces.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "Reenact manifest")]
pub struct ManifestDoc {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub reenact: u32,
    /// Short name of the experiment, for files: lower-case letters, digits and single hyphens.
    pub name: String,
    /// Title of the experiment.
    pub title: String,
    /// The publication that is re-enacted.
    #[serde(default)]
    pub cite: Option<Cite>,
    /// Authors of this manifest, not of the paper.
    #[serde(default)]
    pub authors: Vec<Author>,
    /// Licence of this manifest and of what it yields, as an SPDX identifier.
    #[serde(default)]
    pub license: Option<String>,
    /// Licences of input files that others made, by the path as written.
    #[serde(default)]
    pub license_of: BTreeMap<String, String>,
    /// Inputs that others published: where they are to be had, and what they must hold.
    #[serde(default)]
    pub pinned: Vec<PinnedDoc>,
    /// What the numbers cannot show, one sentence each: reports say it before any number. For what is invented, stands in
    /// for something else, or was settled while looking at the published numbers.
    #[serde(default)]
    #[schemars(inner(length(min = 1)))]
    pub limits: Vec<String>,
    /// Which study this is.
    pub study: StudyKind,
    /// Seed of all randomness.
    pub seed: u64,
    /// Trials per condition.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub trials: u32,
    /// Factors whose values see the same noise, trial by trial; tests that need independence are then barred.
    #[serde(default)]
    pub shared_noise: Vec<String>,
    /// The robot: a URDF, xacro or SDF file, or that and what else is to be said of it.
    pub robot: Choice<RobotDoc>,
    /// The true world.
    pub world: Choice<WorldDoc>,
    /// Where the robot begins, in the world's frame.
    pub start: Choice<StartDoc>,
    /// What is varied: every factor with its values, crossed in this order, the last one fastest.
    #[serde(default)]
    pub factors: Ordered<FactorDoc>,
    /// What readers see for factors and their values, by the factor; files for programs keep names and values as written.
    #[serde(default)]
    pub labels: Labels,
    /// Conditions to add to the crossed ones, each with a value for every factor.
    #[serde(default)]
    pub include: Vec<BTreeMap<String, FactorValue>>,
    /// Conditions to leave out: those that have all values of one of these.
    #[serde(default)]
    pub exclude: Vec<BTreeMap<String, FactorValue>>,
    /// The prior map, where no factor `prior` chooses it: `none` or a key of `prior-maps`.
    #[serde(default)]
    pub prior: Option<String>,
    /// Prior knowledge by name, for the factor `prior` to choose from.
    #[serde(default)]
    pub prior_maps: BTreeMap<String, Choice<PriorDoc>>,
    /// Deadline study: the manifest whose isolated passages measure the planner's maneuvers. It is run first where its
    /// trials are not in the store, and what they showed is sealed as an input.
    #[serde(default)]
    pub calibration: Option<String>,
    /// A file with parameters that several manifests share, several of which the later go before the earlier, or one for every value
    /// of a factor; those written here go before them.
    #[serde(default)]
    pub settings: Option<SettingsRef>,
    /// Everything else a trial needs; every value may be plain, `{value, why, range}`, `{factor, why}` or
    /// `{by, values, otherwise, why}`.
    #[serde(default)]
    pub parameters: ParametersDoc,
    /// What `reenact vary` wrote: the claims' verdicts at the other values that the parameters' `range` states.
    #[serde(default)]
    pub sensitivity: Option<String>,
    /// What is to be inferred from which of the paper's tables: `reenact infer` runs such a manifest. Inferred from counts, its trials
    /// are proposals at graph level, so that it asks for no tables, figures and claims of its own; with `choices` they are trials
    /// like any other.
    #[serde(default)]
    pub infer: Option<InferenceDoc>,
    /// What `reenact vary --joint` wrote: the claims' verdicts at draws of all those ranges together.
    #[serde(default)]
    pub multiverse: Option<String>,
    /// The paper's own numbers by name: tidy CSV files.
    #[serde(default)]
    pub published: BTreeMap<String, PublishedDoc>,
    /// Tables to produce.
    #[serde(default)]
    pub tables: Vec<TableRequest>,
    /// Figures to produce.
    #[serde(default)]
    pub figures: Vec<FigureRequest>,
    /// Claims to judge.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// A factor for each of whose values every claim is judged by itself, under its id and that value.
    #[serde(default)]
    pub claims_by: Option<String>,
}

/// Where settings are: in one file or several, or in one for every value of a factor.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SettingsRef {
    /// The same for all conditions.
    File(String),
    /// Several, the later over the earlier.
    Files(#[schemars(length(min = 1))] Vec<String>),
    /// One for every value of a factor: each sets what the others set, so that each is whole.
    By(SettingsBy),
}

/// A file of settings for every value of a factor.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SettingsBy {
    /// The factor that decides.
    pub by: String,
    /// The file for each of its values.
    #[schemars(extend("minProperties" = 1))]
    pub values: BTreeMap<String, String>,
}

/// The publication that is re-enacted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Cite {
    /// Authors, title, venue and year.
    pub paper: String,
    /// Section, table or figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<String>,
    /// Digital object identifier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doi: Option<String>,
}

/// Someone who wrote the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Author {
    /// Full name.
    pub name: String,
    /// Where they work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub affiliation: Option<String>,
    /// ORCID iD, as `0000-0000-0000-0000` or its URL.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orcid: Option<String>,
}

/// Numbers of the paper.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PublishedDoc {
    /// A CSV file.
    Path(String),
    /// A CSV file.
    File(PublishedFile),
}

/// Numbers of the paper in a CSV file.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PublishedFile {
    /// Columns: factors, `coverage-percent` or `measure`, `value`, `sd`, `n`.
    pub file: String,
    /// Factors that the paper did not vary: its numbers stand beside all their values.
    #[serde(default)]
    pub for_all: Vec<String>,
}

impl PublishedDoc {
    /// Returns the file's path as written.
    pub fn path(&self) -> &str {
        match self {
            Self::Path(path) => path,
            Self::File(file) => &file.file,
        }
    }

    /// Returns the factors that the paper did not vary.
    pub fn for_all(&self) -> &[String] {
        match self {
            Self::Path(_) => &[],
            Self::File(file) => &file.for_all,
        }
    }
}
