//! Prior knowledge as a manifest writes it.

use super::world::{StartDoc, WorldDoc};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

/// A `map_server` map, or that of a bag.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct MapPrior {
    /// The `map_server` YAML file; or a bag (`.mcap`) with a `nav_msgs/msg/OccupancyGrid`, of which the last counts.
    pub map: String,
    /// Bag: the topic of the grid; where left out, the one that holds grids, or `/map`.
    #[serde(default)]
    pub topic: Option<String>,
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
