//! Prior knowledge drawn: what is derived from a world, and a map laid over the world that it is to fit.

use super::world::world_under_svg;
use super::{Drawing, describe_grid, describe_world, drawn_world, grid_png, grid_svg};
use crate::document::{Diagnostic, Source};
use crate::geometry::{Outline, Point};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::world::floor_plan::{self, Plan};
use crate::world::{World, document, sdf};

/// How near (m) to something solid an occupied cell of a prior counts as on it.
const NEAR: f64 = 0.2;

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

/// The world in the file `name` with its walls and `layers` (all where `None`), the meshes that `models` knows, and what it lacks.
///
/// # Errors
/// Every fault of the file.
pub fn read_world(
    name: &str,
    bytes: &[u8],
    layers: Option<&[String]>,
    models: &mut dyn sdf::Models,
) -> Result<World, Vec<Diagnostic>> {
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

/// `world` cut at `height` m.
pub fn draw_world(world: &World, height: f64) -> Drawing {
    drawn_world(world, height)
}

/// What is derived from `world` at `height` m in cells of `resolution` m.
///
/// # Errors
/// Nothing to draw, or too much.
pub fn draw_derived(
    world: &World,
    kind: Derived,
    height: f64,
    resolution: f64,
) -> Result<Drawing, Vec<Diagnostic>> {
    let plan = Plan { height, resolution, layers: None };
    let (what, grid) = match kind {
        Derived::FloorPlan => ("floor plan", floor_plan::floor_plan(world, plan)),
        Derived::Footprint => ("footprint", floor_plan::footprint(world, plan)),
        Derived::BoundingBox => ("bounding box", floor_plan::bounding_box(world, plan)),
    };
    let grid = grid.map_err(|problem| vec![Diagnostic::placeless(problem.to_string())])?;
    let name = format!("{what} of {}", world.name);
    Ok(Drawing {
        svg: grid_svg(&name, &grid),
        png: Some(grid_png(&grid)),
        text: describe_grid(&name, &grid),
        warnings: drawn_world(world, height).warnings,
    })
}

/// `world` at `height` m under the occupied cells of the map `over`, so that it is seen how far they lie apart.
///
/// `fetch` is asked for the map's image as in [`super::draw`].
///
/// # Errors
/// Every fault of the map.
pub fn draw_over(
    world: &World,
    height: f64,
    over: Over<'_>,
    fetch: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Drawing, Vec<Diagnostic>> {
    let source = Source::new(over.name, text_of(over.name, over.bytes)?);
    let map = super::read_map(over.name, &source, fetch)?;
    let frame = GridFrame { origin: map.frame().origin + over.start, ..*map.frame() };
    let map = OccupancyGrid::from_cells(frame, map.values().to_vec());
    let mut drawing = drawn_world(world, height);
    drawing.svg = world_under_svg(world, height, &map);
    drawing.text = describe_world(world, height) + &describe_grid(over.name, &map);
    let (near, all) = agreement(&map, &world.slice(height));
    drawing.text.push_str(&format!(
        "agreement: {near} of {all} occupied cells lie within {NEAR} m of something solid\n"
    ));
    Ok(drawing)
}

/// How many occupied cells of `map` are near one of `outlines`, and how many there are.
fn agreement(map: &OccupancyGrid, outlines: &[Outline]) -> (usize, usize) {
    let frame = map.frame();
    let occupied = || frame.cells().filter(|cell| map.at(*cell) == Occupancy::Occupied);
    let near = |at: Point| {
        let close = |o: &&Outline| o.bounds().grown(NEAR).contains(at) && o.distance(at) <= NEAR;
        outlines.iter().any(|outline| close(&outline))
    };
    (occupied().filter(|cell| near(frame.center(*cell))).count(), occupied().count())
}

fn text_of<'b>(name: &str, bytes: &'b [u8]) -> Result<&'b str, Vec<Diagnostic>> {
    std::str::from_utf8(bytes)
        .map_err(|_| vec![Diagnostic::placeless(format!("`{name}` is not text"))])
}
