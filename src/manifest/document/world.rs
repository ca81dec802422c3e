//! The world of a manifest as written, and where the robot begins in it.

use crate::manifest::choice::Choice;
use crate::world::document::LayerDoc;
use crate::world::generate::Family;
use crate::world::map_server::solid::UnknownCells;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The true world: a file, or a building that is made for the purpose.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum WorldDoc {
    /// A file.
    File(WorldFile),
    /// A building of a family.
    Generated(GeneratedWorld),
    /// The building of a draw, with its goal and starts.
    Drawn(FactorRef),
}

/// A building of a family of buildings.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct GeneratedWorld {
    /// Which one.
    pub generate: GenerateDoc,
    /// Where goal and starts lie instead of where the building has them.
    #[serde(default)]
    pub place: Option<Box<PlaceDoc>>,
}

/// Where the goal and starts of a world lie instead of where it has them.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PlaceDoc {
    /// The goal; the world's own where left out.
    #[serde(default)]
    pub goal: Option<PointDoc>,
    /// Starts by name: new ones, and instead of the world's own of that name.
    #[serde(default)]
    pub starts: BTreeMap<String, PoseDoc>,
}

/// A point in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PointDoc {
    /// Position x (m).
    pub x_m: f64,
    /// Position y (m).
    pub y_m: f64,
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
    /// World YAML, a Gazebo `.world` or `.sdf` file, or the YAML of a `map_server` map: its occupied cells are walls.
    pub file: Choice<String>,
    /// Layers that stand; all where left out.
    #[serde(default)]
    pub layers: Option<Choice<Vec<String>>>,
    /// SDF: the folders of models by name, `NAME` of `model://NAME` and `model://NAME/mesh.dae` to its folder. They are
    /// relative to the manifest.
    #[serde(default)]
    pub models: BTreeMap<String, String>,
    /// SDF: folders that hold folders of models, searched in this order after `models`. They are relative to the manifest.
    #[serde(default)]
    pub model_path: Vec<String>,
    /// SDF: models that are left out, by name: `table`, or `table/lamp` of one within another.
    #[serde(default)]
    pub without: Vec<String>,
    /// SDF: whether COLLADA meshes are turned by the axis that they say is up. Gazebo turns none.
    #[serde(default)]
    pub up_axis: UpAxisDoc,
    /// SDF: what stands for meshes, by their URI as the world writes it: solids as in a layer of world YAML, in the frame of
    /// the collision. They go before a file.
    #[serde(default)]
    pub stand_ins: Box<BTreeMap<String, LayerDoc>>,
    /// Map: what its unknown cells are. By default they are walls where they border on free floor.
    #[serde(default)]
    pub unknown: Option<UnknownCells>,
    /// Where goal and starts lie instead of where the world has them.
    #[serde(default)]
    pub place: Option<Box<PlaceDoc>>,
}

/// What the axis that a mesh says is up comes to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UpAxisDoc {
    /// Nothing, as in Gazebo: z is up.
    #[default]
    Ignored,
    /// The mesh is turned so that it becomes z.
    AsWritten,
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
