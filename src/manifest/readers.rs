//! Who reads robots, worlds and maps: the one seam between a manifest and their formats.

use super::document::Alpha;
use crate::document::{Diagnostic, Source};
use crate::grid::OccupancyGrid;
use crate::studies::prior_map::tour::{self, TopoMetricMap};
use crate::world::floor_plan::{self, FloorPlanError, FloorPlanSettings};
use crate::world::formats::Foreign;
use crate::world::map_server::{self, Descriptor};
use crate::world::{World, document, sdf};

/// What is derived from a world as prior knowledge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Derived {
    /// The floor plan.
    FloorPlan,
    /// The floor plan without what stands inside.
    Footprint,
    /// The box around it.
    BoundingBox,
}

impl Derived {
    /// Returns the key that asks for it in a manifest.
    pub(super) fn key(self) -> &'static str {
        match self {
            Self::FloorPlan => "floor-plan-of",
            Self::Footprint => "footprint-of",
            Self::BoundingBox => "bounding-box-of",
        }
    }

    /// Draws it from `world`.
    ///
    /// # Errors
    /// Nothing to draw or too much.
    pub(super) fn draw(
        self,
        world: &World,
        plan: FloorPlanSettings<'_>,
    ) -> Result<OccupancyGrid, FloorPlanError> {
        match self {
            Self::FloorPlan => floor_plan::floor_plan(world, plan),
            Self::Footprint => floor_plan::footprint(world, plan),
            Self::BoundingBox => floor_plan::bounding_box(world, plan),
        }
    }
}

/// Returns whether the file `name` is a Gazebo world, by its ending.
pub(super) fn is_sdf(name: &str) -> bool {
    let name = name.strip_suffix(".xacro").unwrap_or(name);
    let extension = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    extension == "world" || extension == "sdf"
}

/// Reads a world, by the ending of its file's name: all its layers, or its walls and those of `layers`; with the meshes
/// that `models` knows.
pub(super) fn world(
    source: &Source,
    layers: Option<&[String]>,
    models: &mut dyn sdf::Models,
) -> Result<World, Vec<Diagnostic>> {
    if let Some(format) = Foreign::of(source.text.as_bytes()) {
        Err(vec![format.fault(&source.name)])
    } else if is_sdf(&source.name) {
        sdf::read_with(source, models)
    } else {
        document::read(source, layers)
    }
}

/// Reads a topo-metric map.
pub(super) fn topo_metric_map(source: &Source) -> Result<TopoMetricMap, Vec<Diagnostic>> {
    tour::read(source)
}

/// Makes a map from the bytes of its image.
pub(super) fn map(
    descriptor: &Descriptor,
    image_name: &str,
    image: &[u8],
    alpha: Alpha,
) -> Result<OccupancyGrid, Vec<Diagnostic>> {
    let options = map_server::Options { average_alpha: alpha == Alpha::Average };
    descriptor.map(image_name, image, options)
}

/// Reads a map as [`map_server::write`] writes it.
pub(super) fn explored(
    source: &Source,
    image_name: &str,
    image: &[u8],
) -> Result<OccupancyGrid, Vec<Diagnostic>> {
    map_server::read(source, image_name, image, map_server::Options::default())
}
