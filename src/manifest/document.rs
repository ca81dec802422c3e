//! A manifest exactly as written. What it means is settled in `resolve`.

use super::choice::{Choice, FactorDoc, Ordered};
use super::parameters::ParametersDoc;
use super::pinned::PinnedDoc;
use crate::claims::Claim;
use crate::studies::StudyKind;
use crate::studies::{FactorValue, FigureRequest, TableRequest};
use crate::world::document::LayerDoc;
use crate::world::generate::Family;
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
    /// The robot: a URDF file.
    pub robot: Choice<String>,
    /// The true world.
    pub world: Choice<WorldDoc>,
    /// Where the robot begins, in the world's frame.
    pub start: Choice<StartDoc>,
    /// What is varied: every factor with its values, crossed in this order, the last one fastest.
    #[serde(default)]
    pub factors: Ordered<FactorDoc>,
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
    /// A file with parameters that several manifests share; those written here go before them.
    #[serde(default)]
    pub settings: Option<String>,
    /// Everything else a trial needs; every value may be plain, `{value, why, range}`, `{factor, why}` or
    /// `{by, values, otherwise, why}`.
    #[serde(default)]
    pub parameters: ParametersDoc,
    /// What `reenact vary` wrote: the claims' verdicts at the other values that the parameters' `range` states.
    #[serde(default)]
    pub sensitivity: Option<String>,
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

/// The true world: a file, or a building that is made for the purpose.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum WorldDoc {
    /// A file.
    File(WorldFile),
    /// A building of a family.
    Generated(GeneratedWorld),
}

/// A building of a family of buildings.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct GeneratedWorld {
    /// Which one.
    pub generate: GenerateDoc,
}

/// Which building of which family.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct GenerateDoc {
    /// The family.
    pub family: Family,
    /// The number that names one of them.
    pub seed: SeedDoc,
}

/// The number that names one building.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SeedDoc {
    /// A whole number from 0.
    Number(u64),
    /// The value of a factor, which is a number.
    Factor(FactorRef),
}

/// A world in a file and the parts of it that stand.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct WorldFile {
    /// World YAML, or a Gazebo `.world` or `.sdf` file.
    pub file: Choice<String>,
    /// Layers that stand; all where left out.
    #[serde(default)]
    pub layers: Option<Choice<Vec<String>>>,
    /// SDF: the folders of the models that meshes are named by, `NAME` of `model://NAME/mesh.dae` to its folder. They are
    /// relative to the manifest.
    #[serde(default)]
    pub models: BTreeMap<String, String>,
    /// SDF: what stands for meshes, by their URI as the world writes it: solids as in a layer of world YAML, in the frame of
    /// the collision. They go before a file.
    #[serde(default)]
    pub stand_ins: BTreeMap<String, LayerDoc>,
}

/// Where the robot begins.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StartDoc {
    /// A start that the world names.
    Name(String),
    /// A pose in the world's frame.
    Pose(PoseDoc),
    /// The start of the world that a factor's value names.
    Factor(FactorRef),
}

/// The value of a factor itself.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactorRef {
    /// The factor.
    pub factor: String,
}

/// A pose in the world's frame.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PoseDoc {
    /// Position x (m).
    pub x_m: f64,
    /// Position y (m).
    pub y_m: f64,
    /// Heading (degrees), counter-clockwise from x.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub heading_deg: f64,
}

/// Prior knowledge: a map file, what is derived from a world, or a graph.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PriorDoc {
    /// A `map_server` map.
    Map(MapPrior),
    /// A graph of places, for `exploration.strategy: topo-metric-tour`.
    TopoMetric(TopoMetricPrior),
    /// The floor plan of a world.
    FloorPlan(FloorPlanOf),
    /// A world's floor plan without what stands inside.
    Footprint(FootprintOf),
    /// The box around a world.
    BoundingBox(BoundingBoxOf),
    /// What a robot mapped earlier.
    Previous(PreviousMapOf),
}

/// A `map_server` map.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct MapPrior {
    /// The `map_server` YAML file.
    pub map: String,
    /// The frame its origin is given in.
    #[serde(default)]
    pub frame: PriorFrame,
    /// The origin to use instead of the file's: the lower left corner.
    #[serde(default)]
    pub origin: Option<OriginDoc>,
    /// What the image's alpha channel does.
    #[serde(default)]
    pub alpha: Alpha,
    /// What cells between the two thresholds become.
    #[serde(default)]
    pub unknown: UnknownAs,
}

/// A graph of places.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TopoMetricPrior {
    /// The YAML file with its nodes, in the world's frame, and edges.
    pub topo_metric_map: String,
}

/// A corner of a map.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct OriginDoc {
    /// Position x (m).
    pub x_m: f64,
    /// Position y (m).
    pub y_m: f64,
}

/// The frame a map's origin is given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PriorFrame {
    /// The world's.
    #[default]
    World,
    /// That of the robot's start, as in maps made for one run.
    Start,
}

/// What the alpha channel of a map's image does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Alpha {
    /// Averaged with the colours, as ROS's `map_server` does.
    #[default]
    Average,
    /// Left out.
    Ignore,
}

/// What the unknown cells of a map become.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnknownAs {
    /// They stay unknown.
    #[default]
    Unknown,
    /// Free.
    Free,
    /// Occupied.
    Occupied,
}

/// The floor plan of a world.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FloorPlanOf {
    /// `world` for the condition's own, or another one.
    pub floor_plan_of: DerivedFrom,
    /// Side of a cell (m); that of the robot's map where left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub resolution_m: Option<f64>,
}

/// A world's floor plan without what stands inside.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FootprintOf {
    /// `world` for the condition's own, or another one.
    pub footprint_of: DerivedFrom,
    /// Side of a cell (m); that of the robot's map where left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub resolution_m: Option<f64>,
}

/// The box around a world.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct BoundingBoxOf {
    /// `world` for the condition's own, or another one.
    pub bounding_box_of: DerivedFrom,
    /// Side of a cell (m); that of the robot's map where left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub resolution_m: Option<f64>,
}

/// The map that a robot of an earlier exploration ended with.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PreviousMapOf {
    /// Which exploration.
    pub previous_map: PreviousMapDoc,
}

/// One trial before the experiment's own, by the condition's robot with the condition's parameters.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PreviousMapDoc {
    /// The world as it was then.
    pub world: WorldDoc,
    /// Where the robot began then; where the condition's begins if left out.
    #[serde(default)]
    pub start: Option<StartDoc>,
    /// What it knew then: `none`, or another key of `prior-maps`.
    pub prior: String,
    /// Which of the trials that the seed gives, from 0.
    #[serde(default)]
    pub trial: u32,
    /// Seed of its randomness; the experiment's where left out.
    #[serde(default)]
    pub seed: Option<u64>,
    /// What cells that it never saw become.
    #[serde(default)]
    pub unknown: UnknownAs,
    /// Why this exploration.
    pub why: String,
}

/// The world that prior knowledge is derived from.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum DerivedFrom {
    /// The condition's own.
    Own(OwnWorld),
    /// Another one.
    Other(WorldDoc),
}

/// The condition's own world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OwnWorld {
    /// The condition's own.
    World,
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
    /// The file's path as written.
    pub fn path(&self) -> &str {
        match self {
            Self::Path(path) => path,
            Self::File(file) => &file.file,
        }
    }

    /// Factors that the paper did not vary.
    pub fn for_all(&self) -> &[String] {
        match self {
            Self::Path(_) => &[],
            Self::File(file) => &file.for_all,
        }
    }
}
