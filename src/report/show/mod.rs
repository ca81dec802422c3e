//! Drawings of what a manifest can name (robot, world, grid map), and what was understood of each in words.
//!
//! [`draw`] tells the kind of a file by its content; the `*_svg`, `*_png` and `describe_*` functions do one kind
//! each. All are pure: the caller fetches files and writes the results.

mod describe;
mod graph;
mod grid;
mod labels;
mod prior;
mod robot;
mod topo_metric;
mod world;

pub use describe::{describe_grid, describe_robot, describe_world};
pub use grid::{grid_png, grid_svg};
pub use prior::{Derived, Over, draw_derived, draw_over, draw_world, read_world};
pub use robot::robot_svg;
pub use world::world_svg;

use crate::document::{Diagnostic, Source};
use crate::grid::OccupancyGrid;
use crate::robot::description::{self, Request};
use crate::robot::given::Given;
use crate::robot::{FilePath, Files, Rooted};
use crate::studies::prior_map::tour;
use crate::world::formats::Foreign;
use crate::world::map_server::{self, Descriptor};
use crate::world::topology::{TagFault, TagScheme, Topology};
use crate::world::{document as world_document, sdf};
use std::collections::BTreeMap;

/// Height (m) at which worlds are cut where no robot says otherwise: the lidar of the studies' Kobuki.
pub const CUT_HEIGHT: f64 = 0.1602;

/// What a drawing is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A robot.
    Robot,
    /// A world.
    World,
    /// An occupancy grid.
    Map,
    /// A map of rooms and the ways between them.
    TopoMetricMap,
    /// What a robot may be told beforehand of a world.
    Prior,
}

impl Kind {
    /// Returns the word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::World => "world",
            Self::Map => "map",
            Self::TopoMetricMap => "topo-metric-map",
            Self::Prior => "prior",
        }
    }
}

/// What `reenact show` gives for one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// What is drawn.
    pub kind: Kind,
    /// The drawing, as an SVG file.
    pub svg: String,
    /// Grid maps only: a PNG of one pixel per cell, as `map_saver` writes it.
    pub png: Option<Vec<u8>>,
    /// What was understood, for stdout.
    pub text: String,
    /// What should be known, for stderr.
    pub warnings: Vec<Diagnostic>,
}

/// Why a file beside a descriptor cannot be had, as whoever fetches it says: the end of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FetchError(pub String);

/// Hands over a file by its path relative to the descriptor's folder.
pub type Fetch<'f> = dyn FnMut(&str) -> Result<Vec<u8>, FetchError> + 'f;

/// What a robot's description may name besides itself.
pub struct RobotFiles<'f> {
    /// Packages by name, and their folders.
    pub packages: &'f BTreeMap<String, String>,
    /// Arguments of xacro.
    pub arguments: &'f BTreeMap<String, String>,
    /// Who hands over files.
    pub files: &'f mut dyn Files,
}

/// Draws the robot, world or map in the file `name`, distinguished by content: URDF or xacro, SDF (a robot where it is a
/// model that drives or senses), `map_server` YAML (with an `image:`), topo-metric map or world YAML. Worlds are cut at
/// `height` m; all their layers are drawn.
///
/// `models` is asked for a world's meshes, `robot` for what a robot names, `fetch` for a map's image.
///
/// # Errors
/// Every fault of the file.
pub fn draw(
    name: &str,
    bytes: &[u8],
    height: f64,
    models: &mut dyn sdf::Models,
    robot: &mut RobotFiles<'_>,
    fetch: &mut Fetch<'_>,
) -> Result<Drawing, Vec<Diagnostic>> {
    if let Some(format) = Foreign::of(bytes) {
        return Err(vec![format.fault(name)]);
    }
    let Ok(text) = std::str::from_utf8(bytes) else {
        let fault = Diagnostic::placeless(format!("`{name}` is not text")).help(
            "show reads URDF, xacro and SDF robots, SDF or YAML worlds and map_server YAML; of a map image name the YAML",
        );
        return Err(vec![fault]);
    };
    let source = Source::new(name, text);
    if text.trim_start().starts_with('<') {
        if description::is_robot(&source) {
            let request = Request {
                path: FilePath { path: name.to_owned(), rooted: Rooted::Robot },
                gazebo: Vec::new(),
                packages: robot.packages,
                arguments: robot.arguments,
                given: &Given::default(),
                fault: &|_, message| Diagnostic::placeless(message),
            };
            let (robot, warnings) = description::read(&source, &request, &mut *robot.files)?;
            let (svg, text) = (robot_svg(&robot), describe_robot(&robot));
            return Ok(Drawing { kind: Kind::Robot, svg, png: None, text, warnings });
        }
        return Ok(drawn_world(&sdf::read_with(&source, models)?, height));
    }
    if map_server::is_descriptor(text) {
        let (map, warnings) = read_map(name, &source, fetch)?;
        return Ok(Drawing {
            kind: Kind::Map,
            svg: grid_svg(name, &map),
            png: Some(grid_png(&map)),
            text: describe_grid(name, &map),
            warnings,
        });
    }
    if text.lines().any(|line| line.starts_with("reenact-topo-metric-map:")) {
        return Ok(topo_metric::drawn(name, &tour::read(&source)?));
    }
    Ok(drawn_world(&world_document::read(&source, None)?, height))
}

/// Reads the map of the descriptor `source`, which is called `name`.
fn read_map(
    name: &str,
    source: &Source,
    fetch: &mut Fetch<'_>,
) -> Result<(OccupancyGrid, Vec<Diagnostic>), Vec<Diagnostic>> {
    let descriptor = Descriptor::read(source)?;
    let path = descriptor.image();
    let image = fetch(path).map_err(|why| {
        vec![Diagnostic::placeless(format!("cannot read the image `{path}` of `{name}`: {why}"))]
    })?;
    let map = descriptor.map(path, &image, map_server::Options::default())?;
    let warnings = descriptor.warnings().iter().cloned().chain(descriptor.doubt(&map)).collect();
    Ok((map, warnings))
}

fn drawn_world(world: &crate::world::World, height: f64) -> Drawing {
    let warning = |text: String| Diagnostic::placeless(text).warning();
    let breaks = graph_of(world).and_then(Result::err).unwrap_or_default();
    Drawing {
        kind: Kind::World,
        svg: world_svg(world, height),
        png: None,
        text: describe_world(world, height),
        warnings: (world.warnings.iter().cloned())
            .chain(breaks.iter().map(ToString::to_string))
            .map(warning)
            .collect(),
    }
}

/// Returns the graph that the world's tags mean, where any of them is a vertex tag of the usual colours.
fn graph_of(world: &crate::world::World) -> Option<Result<Topology, Vec<TagFault>>> {
    let scheme = TagScheme::default();
    let is_vertex = |color: &String| [&scheme.corridor, &scheme.room].contains(&color);
    let any = world.tags.iter().any(|tag| is_vertex(&tag.color));
    any.then(|| Topology::read(&world.tags, &scheme))
}

#[cfg(test)]
mod tests;
