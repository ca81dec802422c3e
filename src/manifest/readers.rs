//! Who reads robots, worlds and maps: the one seam between a manifest and their formats.

use super::document::Alpha;
use crate::document::{Diagnostic, Source};
use crate::grid::OccupancyGrid;
use crate::world::floor_plan::{self, Plan};
use crate::world::{World, document, map_server, sdf};

/// What is derived from a world as prior knowledge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Derived {
    /// The floor plan.
    FloorPlanOf,
    /// The floor plan without what stands inside.
    FootprintOf,
    /// The box around it.
    BoundingBoxOf,
}

impl Derived {
    /// Draws it from `world`.
    ///
    /// # Errors
    /// Nothing to draw or too much, in words.
    pub(super) fn draw(self, world: &World, plan: Plan<'_>) -> Result<OccupancyGrid, String> {
        match self {
            Self::FloorPlanOf => floor_plan::floor_plan(world, plan),
            Self::FootprintOf => floor_plan::footprint(world, plan),
            Self::BoundingBoxOf => floor_plan::bounding_box(world, plan),
        }
        .map_err(|error| error.to_string())
    }
}

/// A world, by the ending of its file's name: all its layers, or its walls and those of `layers`.
pub(super) fn world(source: &Source, layers: Option<&[String]>) -> Result<World, Vec<Diagnostic>> {
    let name = source.name.to_ascii_lowercase();
    if name.ends_with(".world") || name.ends_with(".sdf") {
        sdf::read(source)
    } else {
        document::read(source, layers)
    }
}

/// A `map_server` map from its descriptor and the bytes of its image.
pub(super) fn map(
    source: &Source,
    image_name: &str,
    image: &[u8],
    alpha: Alpha,
) -> Result<OccupancyGrid, Vec<Diagnostic>> {
    let options = map_server::Options { average_alpha: alpha == Alpha::Average };
    map_server::read(source, image_name, image, options)
}
