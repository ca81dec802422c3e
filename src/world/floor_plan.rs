//! Prior knowledge derived from a world: floor plan, footprint and bounding box.
//!
//! The three kinds of the prior-knowledge study (section 4.1). All are drawn at the lidar's height, so that
//! lintels do not close doors, on a grid that reaches half a metre beyond the walls; as in the images released
//! with the study, everything that is not a wall is free, outside too.

use super::World;
use crate::geometry::{Bounds, Outline, Point};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use thiserror::Error;

/// How far (m) a plan reaches beyond the walls.
const MARGIN: f64 = 0.5;

/// Largest plan drawn (cells).
const MAX_CELLS: f64 = (1_u32 << 26) as f64;

/// Why no plan can be drawn.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FloorPlanError {
    /// Nothing of the chosen layers is cut by the plane.
    #[error("world `{world}` has nothing at a height of {height} m in the chosen layers")]
    Empty {
        /// The world's name.
        world: String,
        /// The plane's height (m).
        height: f64,
    },
    /// The grid would not fit.
    #[error(
        "a plan of {width} x {height} m at {resolution} m per cell is too large: expected at most 2^26 cells"
    )]
    TooLarge {
        /// Extent along x (m).
        width: f64,
        /// Extent along y (m).
        height: f64,
        /// Side of a cell (m).
        resolution: f64,
    },
}

/// The layers to draw, and the resolution.
#[derive(Debug, Clone, Copy)]
pub struct FloorPlanSettings<'a> {
    /// Height of the cut (m): the lidar's.
    pub height: f64,
    /// Side of a cell (m).
    pub resolution: f64,
    /// The layers drawn; all where `None`. Names that no solid has draw nothing.
    pub layers: Option<&'a [String]>,
}

/// Draws the floor plan: a cell is occupied where something solid comes within half a cell of its centre.
///
/// # Errors
/// Nothing to draw, or too much.
pub fn floor_plan(
    world: &World,
    plan: FloorPlanSettings<'_>,
) -> Result<OccupancyGrid, FloorPlanError> {
    let outlines: Vec<Outline> = world
        .solids
        .iter()
        .filter(|solid| plan.layers.is_none_or(|layers| layers.contains(&solid.layer)))
        .flat_map(|solid| solid.body.slice(plan.height))
        .collect();
    let bounds = outlines.iter().fold(Bounds::EMPTY, |all, outline| all.union(outline.bounds()));
    if bounds.is_empty() {
        return Err(FloorPlanError::Empty { world: world.name.clone(), height: plan.height });
    }
    // At least two cells, so that the outside is one piece at any resolution.
    let bounds = bounds.grown(MARGIN.max(2.0 * plan.resolution));
    let (width, height, resolution) = (bounds.width(), bounds.height(), plan.resolution);
    let cells = (width / resolution + 2.0) * (height / resolution + 2.0);
    if !cells.is_finite() || cells > MAX_CELLS || resolution <= 0.0 {
        return Err(FloorPlanError::TooLarge { width, height, resolution });
    }
    let frame = GridFrame::covering(bounds, resolution);
    let mut grid = OccupancyGrid::filled(frame, Occupancy::Free);
    for outline in &outlines {
        let reach = outline.bounds().grown(resolution);
        let (low, high) = (frame.cell_at(reach.min), frame.cell_at(reach.max));
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let cell = Cell::new(x, y);
                if outline.distance(frame.center(cell)) <= resolution / 2.0 {
                    grid.set(cell, Occupancy::Occupied);
                }
            }
        }
    }
    Ok(grid)
}

/// Draws the footprint: of the floor plan only the walls that can be touched from outside, so without inner walls.
///
/// Outside is the part that a flood fill over free cells (by sides) reaches from the border of the grid. Where the
/// building stands open, the fill enters and inner walls stay.
///
/// # Errors
/// As [`floor_plan`].
pub fn footprint(
    world: &World,
    plan: FloorPlanSettings<'_>,
) -> Result<OccupancyGrid, FloorPlanError> {
    let walls = floor_plan(world, plan)?;
    let frame = *walls.frame();
    let mut outside = OccupancyGrid::filled(frame, Occupancy::Unknown);
    // The margin keeps the corner free.
    let mut open = vec![Cell::new(0, 0)];
    let mut touched = OccupancyGrid::filled(frame, Occupancy::Free);
    outside.set(Cell::new(0, 0), Occupancy::Free);
    while let Some(cell) = open.pop() {
        for next in cell.neighbours8() {
            if walls.at(next) == Occupancy::Occupied {
                touched.set(next, Occupancy::Occupied);
            }
        }
        for next in cell.neighbours4() {
            if walls.at(next) == Occupancy::Free && outside.at(next) == Occupancy::Unknown {
                outside.set(next, Occupancy::Free);
                open.push(next);
            }
        }
    }
    Ok(touched)
}

/// Draws the bounding box: the outermost cells of the floor plan's occupied extent, a rectangle one cell thick.
///
/// # Errors
/// As [`floor_plan`].
pub fn bounding_box(
    world: &World,
    plan: FloorPlanSettings<'_>,
) -> Result<OccupancyGrid, FloorPlanError> {
    let walls = floor_plan(world, plan)?;
    let frame = *walls.frame();
    let mut extent = Bounds::EMPTY;
    for cell in frame.cells().filter(|cell| walls.at(*cell) == Occupancy::Occupied) {
        extent = extent.including(Point::new(f64::from(cell.x), f64::from(cell.y)));
    }
    let mut grid = OccupancyGrid::filled(frame, Occupancy::Free);
    for cell in frame.cells() {
        let at = Point::new(f64::from(cell.x), f64::from(cell.y));
        let border = at.x == extent.min.x
            || at.x == extent.max.x
            || at.y == extent.min.y
            || at.y == extent.max.y;
        if border && extent.contains(at) {
            grid.set(cell, Occupancy::Occupied);
        }
    }
    Ok(grid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Body, Solid, originals, sdf};
    use std::collections::BTreeMap;

    /// Returns a 4 x 3 m room, walls 0.2 m thick, with an inner wall that leaves a door, a lintel over it, and a chair.
    fn world() -> World {
        let solid = |layer: &str, x: [f64; 2], y: [f64; 2], z: [f64; 2]| {
            let outline = Outline::Polygon(vec![
                Point::new(x[0], y[0]),
                Point::new(x[1], y[0]),
                Point::new(x[1], y[1]),
                Point::new(x[0], y[1]),
            ]);
            Solid { name: String::new(), layer: layer.to_owned(), body: Body::Prism { outline, z } }
        };
        World {
            name: "room".to_owned(),
            solids: vec![
                solid("walls", [0.0, 4.0], [0.0, 0.2], [0.0, 2.5]),
                solid("walls", [0.0, 4.0], [2.8, 3.0], [0.0, 2.5]),
                solid("walls", [0.0, 0.2], [0.0, 3.0], [0.0, 2.5]),
                solid("walls", [3.8, 4.0], [0.0, 3.0], [0.0, 2.5]),
                solid("walls", [2.0, 2.2], [0.0, 1.9], [0.0, 2.5]),
                solid("walls", [2.0, 2.2], [1.9, 2.8], [2.0, 2.5]),
                solid("furniture", [1.0, 1.4], [1.0, 1.4], [0.0, 1.0]),
            ],
            regions: Vec::new(),
            tags: Vec::new(),
            starts: BTreeMap::new(),
            goals: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }

    fn drawn(grid: &OccupancyGrid) -> Vec<String> {
        let width = usize::try_from(grid.frame().width).unwrap();
        let symbol = |o: &Occupancy| if *o == Occupancy::Occupied { '#' } else { '.' };
        grid.values().chunks(width).rev().map(|row| row.iter().map(symbol).collect()).collect()
    }

    fn plan(layers: Option<&[String]>) -> FloorPlanSettings<'_> {
        FloorPlanSettings { height: 0.16, resolution: 0.3, layers }
    }

    #[test]
    fn a_floor_plan_shows_walls_and_the_footprint_only_what_faces_out() {
        let walls = ["walls".to_owned()];
        let all = floor_plan(&world(), plan(None)).unwrap();
        assert_eq!(
            drawn(&all),
            [
                "..................",
                "..................",
                "..#############...",
                "..##############..",
                "..#...........##..",
                "..#...........##..",
                "..#.....##....##..",
                "..#.....##....##..",
                "..#..##.##....##..",
                "..#..##.##....##..",
                "..#.....##....##..",
                "..#.....##....##..",
                "..##############..",
                "..................",
                "..................",
            ]
        );
        let bare = floor_plan(&world(), plan(Some(&walls))).unwrap();
        assert!(bare.count(Occupancy::Occupied) < all.count(Occupancy::Occupied));
        let hull = footprint(&world(), plan(Some(&walls))).unwrap();
        assert_eq!(hull, footprint(&world(), plan(None)).unwrap(), "furniture is inside");
        assert_eq!(
            drawn(&hull)[8],
            "..#............#..",
            "the inner sides of thick walls are inner"
        );
        assert_eq!(drawn(&hull)[3], "..#...........##..");
    }

    #[test]
    fn a_bounding_box_is_a_rectangle_and_faults_are_named() {
        let drawn = drawn(&bounding_box(&world(), plan(None)).unwrap());
        assert_eq!(drawn[2], "..##############..");
        assert_eq!(drawn[12], "..##############..");
        assert!(drawn[3..12].iter().all(|row| row == "..#............#.."), "{drawn:#?}");
        let none = ["doors".to_owned()];
        assert_eq!(
            floor_plan(&world(), plan(Some(&none))).unwrap_err().to_string(),
            "world `room` has nothing at a height of 0.16 m in the chosen layers"
        );
        let fine = FloorPlanSettings { resolution: 1e-6, ..plan(None) };
        assert_eq!(
            floor_plan(&world(), fine).unwrap_err().to_string(),
            "a plan of 5 x 4 m at 0.000001 m per cell is too large: expected at most 2^26 cells"
        );
    }

    /// Checks that the worlds' outer walls are tight: otherwise the footprint would keep the inner ones.
    #[test]
    fn the_original_worlds_lose_their_inner_walls() {
        let Some(folder) = originals::folder("the_original_worlds_lose_their_inner_walls") else {
            return;
        };
        for name in ["basic_no_furniture", "office_no_furniture", "open_no_furniture", "map2"] {
            let source = originals::source(&folder.join(format!("worlds/{name}.world")));
            let world = sdf::read(&source).unwrap();
            let plan = FloorPlanSettings { height: 0.1602, resolution: 0.1, layers: None };
            let count = |grid: OccupancyGrid| grid.count(Occupancy::Occupied);
            let walls = count(floor_plan(&world, plan).unwrap());
            let hull = count(footprint(&world, plan).unwrap());
            let bounds = count(bounding_box(&world, plan).unwrap());
            assert!(hull * 2 < walls, "{name}: {walls} {hull} {bounds}");
            assert!(bounds > 500, "{name}: {bounds}");
        }
    }
}
