//! Prior knowledge drawn: what is derived from a world, and a map laid over the world that it is to fit.

use super::world::world_under_svg;
use super::{
    Drawing, Fetch, describe_grid, describe_world, drawn_world, grid_png, grid_svg, topo_metric,
};
use crate::document::{Diagnostic, Source};
use crate::figure::canvas::metres;
use crate::geometry::{Bounds, Outline, Point};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use crate::studies::prior_map::tour;
use crate::world::floor_plan::{self, FloorPlanSettings};
use crate::world::formats::Foreign;
use crate::world::{World, document, sdf};

/// How near (m) to something solid an occupied cell of a prior counts as on it.
pub(super) const NEAR: f64 = 0.2;

/// What is derived from a world as prior knowledge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derived {
    /// The floor plan.
    FloorPlan,
    /// The floor plan without what stands inside.
    Footprint,
    /// The box around it.
    BoundingBox,
}

/// A map and where the start is that its origin is relative to (m); the world's origin where it is relative to none.
#[derive(Debug, Clone, Copy)]
pub struct Over<'a> {
    /// The descriptor's name.
    pub name: &'a str,
    /// The descriptor.
    pub bytes: &'a [u8],
    /// What its origin is relative to (m).
    pub start: Point,
}

/// Reads the world in the file `name` with its walls and `layers` (all where `None`), the meshes that `models` knows,
/// and what it lacks.
///
/// # Errors
/// Every fault of the file.
pub fn read_world(
    name: &str,
    bytes: &[u8],
    layers: Option<&[String]>,
    models: &mut dyn sdf::Models,
) -> Result<World, Vec<Diagnostic>> {
    if let Some(format) = Foreign::of(bytes) {
        return Err(vec![format.fault(name)]);
    }
    let text = text_of(name, bytes)?;
    let source = Source::new(name, text);
    if !text.trim_start().starts_with('<') {
        return document::read(&source, layers);
    }
    let world = sdf::read_with(&source, models)?;
    match layers.and_then(|layers| layers.iter().find(|layer| *layer != sdf::LAYER)) {
        None => Ok(world),
        Some(layer) => Err(vec![
            Diagnostic::placeless(format!("`{name}` has no layer `{layer}`"))
                .help(format!("all of a Gazebo world is its layer `{}`", sdf::LAYER)),
        ]),
    }
}

/// Draws `world` cut at `height` m.
pub fn draw_world(world: &World, height: f64) -> Drawing {
    drawn_world(world, height)
}

/// Draws what is derived from `world` at `height` m in cells of `resolution` m.
///
/// # Errors
/// Nothing to draw, or too much.
pub fn draw_derived(
    world: &World,
    kind: Derived,
    height: f64,
    resolution: f64,
) -> Result<Drawing, Vec<Diagnostic>> {
    let plan = FloorPlanSettings { height, resolution, layers: None };
    let (what, grid) = match kind {
        Derived::FloorPlan => ("floor plan", floor_plan::floor_plan(world, plan)),
        Derived::Footprint => ("footprint", floor_plan::footprint(world, plan)),
        Derived::BoundingBox => ("bounding box", floor_plan::bounding_box(world, plan)),
    };
    let grid = grid.map_err(|problem| vec![Diagnostic::placeless(problem.to_string())])?;
    let name = format!("{what} of {}", world.name);
    Ok(Drawing {
        kind: super::Kind::Prior,
        svg: grid_svg(&name, &grid),
        png: Some(grid_png(&grid)),
        text: describe_grid(&name, &grid),
        warnings: drawn_world(world, height).warnings,
    })
}

/// Draws `world` at `height` m under the occupied cells of the map `over`, so that one sees how far they lie apart.
///
/// `fetch` is asked for the map's image as in [`super::draw`].
///
/// # Errors
/// Every fault of the map.
pub fn draw_over(
    world: &World,
    height: f64,
    over: Over<'_>,
    fetch: &mut Fetch<'_>,
) -> Result<Drawing, Vec<Diagnostic>> {
    let text = text_of(over.name, over.bytes)?;
    let source = Source::new(over.name, text);
    if text.lines().any(|line| line.starts_with("reenact-topo-metric-map:")) {
        return Ok(topo_metric::drawn_over(over.name, &tour::read(&source)?, world, height));
    }
    let (map, warnings) = super::read_map(over.name, &source, fetch)?;
    let frame = GridFrame { origin: map.frame().origin + over.start, ..*map.frame() };
    let map = OccupancyGrid::from_cells(frame, map.values().to_vec());
    let mut drawing = drawn_world(world, height);
    drawing.svg = world_under_svg(world, height, &map);
    drawing.text = describe_world(world, height) + &describe_grid(over.name, &map);
    let solids = world.slice(height);
    drawing.text.push_str(&alignment(&map, over.start, &solids));
    drawing.warnings.extend(warnings);
    Ok(drawing)
}

/// Says in words how `map`, laid with its origin relative to `start`, lies on `solids`.
fn alignment(map: &OccupancyGrid, start: Point, solids: &[Outline]) -> String {
    let frame = map.frame();
    let mut off: Vec<f64> = frame
        .cells()
        .filter(|cell| map.at(*cell) == Occupancy::Occupied)
        .map(|cell| distance(frame.center(cell), solids))
        .collect();
    off.sort_by(f64::total_cmp);
    let near = off.partition_point(|distance| *distance <= NEAR);
    let mut text = String::new();
    if let (false, Some(most)) = (solids.is_empty(), off.last()) {
        let span =
            |bounds: Bounds| format!("{} x {} m", metres(bounds.width()), metres(bounds.height()));
        let occupied = frame.cells().filter(|cell| map.at(*cell) == Occupancy::Occupied);
        let of_map =
            occupied.fold(Bounds::EMPTY, |bounds, cell| bounds.including(frame.center(cell)));
        let of_world =
            solids.iter().fold(Bounds::EMPTY, |bounds, solid| bounds.union(solid.bounds()));
        let shift = (of_map.min + of_map.max - of_world.min - of_world.max) * 0.5;
        text.push_str(&format!(
            "laid: origin moved by ({}, {}) m, neither turned nor scaled\n\
             extent: occupied {}, solid {}; middles ({}, {}) m apart\n\
             distance to something solid: median {:.2} m, 90 % below {:.2} m, at most {:.2} m\n",
            metres(start.x),
            metres(start.y),
            span(of_map.grown(0.5 * frame.resolution)),
            span(of_world),
            metres((shift.x * 100.0).round() / 100.0),
            metres((shift.y * 100.0).round() / 100.0),
            off[off.len() / 2],
            off[(off.len() * 9 / 10).min(off.len() - 1)],
            most,
        ));
    }
    text.push_str(&format!(
        "agreement: {near} of {} occupied cells lie within {NEAR} m of something solid\n",
        off.len()
    ));
    text
}

/// Returns how far (m) `at` is from the nearest of `solids`; infinite where there is none.
fn distance(at: Point, solids: &[Outline]) -> f64 {
    solids.iter().map(|solid| solid.distance(at)).fold(f64::INFINITY, f64::min)
}

/// Returns whether `cell` of `map` is near one of `outlines`.
pub(super) fn is_near(map: &OccupancyGrid, outlines: &[Outline], cell: Cell) -> bool {
    let at = map.frame().center(cell);
    outlines.iter().any(|o| o.bounds().grown(NEAR).contains(at) && o.distance(at) <= NEAR)
}

fn text_of<'b>(name: &str, bytes: &'b [u8]) -> Result<&'b str, Vec<Diagnostic>> {
    std::str::from_utf8(bytes)
        .map_err(|_| vec![Diagnostic::placeless(format!("`{name}` is not text"))])
}
