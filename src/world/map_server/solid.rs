//! A map as a world: most people have one of their building, and no model of it.
//!
//! Occupied cells are walls. What lies beyond the known is open to choice: where unknown cells stand as walls, only those
//! beside the known free floor do, since nothing gets past them. Past the edge of the image all is unknown.

use crate::geometry::{Outline, Point};
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::world::{Body, Solid, World};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The layer of every solid of such a world.
pub const LAYER: &str = "walls";

/// How high its walls are (m): higher than any scanner here stands.
pub const HEIGHT: f64 = 2.5;

/// What unknown cells are in a map that is taken for a world.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnknownCells {
    /// Walls where they border on free floor: no robot gets out of what was mapped.
    #[default]
    Occupied,
    /// Floor.
    Free,
}

/// Returns the world of `name` whose walls are the occupied cells of `map`: in rows, rows of one width joined.
pub fn world(name: &str, map: &OccupancyGrid, unknown: UnknownCells) -> World {
    let is_wall = |cell: Cell| match map.at(cell) {
        Occupancy::Occupied => true,
        Occupancy::Free => false,
        Occupancy::Unknown => unknown == UnknownCells::Occupied && borders_on_floor(map, cell),
    };
    let frame = *map.frame();
    // Walls of what is open while rows are read from below: the cells of their first row, and that row.
    let mut open: Vec<([i32; 2], i32)> = Vec::new();
    let mut solids = Vec::new();
    let mut close = |[from, to]: [i32; 2], bottom: i32, top: i32| {
        let corner = |x: i32, y: i32| {
            frame.origin + Point::new(f64::from(x), f64::from(y)) * frame.resolution
        };
        let corners =
            vec![corner(from, bottom), corner(to, bottom), corner(to, top), corner(from, top)];
        solids.push(Solid {
            name: format!("cells {from},{bottom} to {},{}", to - 1, top - 1),
            layer: LAYER.to_owned(),
            body: Body::Prism { outline: Outline::Polygon(corners), z: [0.0, HEIGHT] },
        });
    };
    // One cell around the image belongs to the unknown, too.
    for y in -1..=frame.height + 1 {
        let walls = if y > frame.height {
            Vec::new()
        } else {
            runs(-1, frame.width + 1, |x| is_wall(Cell::new(x, y)))
        };
        let (same, ended): (Vec<_>, Vec<_>) =
            open.into_iter().partition(|(run, _)| walls.contains(run));
        for (run, bottom) in ended {
            close(run, bottom, y);
        }
        let known: Vec<[i32; 2]> = same.iter().map(|(run, _)| *run).collect();
        let new = walls.into_iter().filter(|run| !known.contains(run)).map(|run| (run, y));
        open = same.into_iter().chain(new).collect();
    }
    World { name: name.to_owned(), solids, ..World::default() }
}

/// Returns whether one of the eight cells around `cell` is free.
fn borders_on_floor(map: &OccupancyGrid, cell: Cell) -> bool {
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
    around
        .into_iter()
        .any(|(dx, dy)| map.at(Cell::new(cell.x + dx, cell.y + dy)) == Occupancy::Free)
}

/// Returns the runs `[from, to)` of numbers from `first` up to `end` that `holds`.
fn runs(first: i32, end: i32, holds: impl Fn(i32) -> bool) -> Vec<[i32; 2]> {
    let mut runs: Vec<[i32; 2]> = Vec::new();
    for x in (first..end).filter(|&x| holds(x)) {
        match runs.last_mut() {
            Some(run) if run[1] == x => run[1] = x + 1,
            _ => runs.push([x, x + 1]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GridFrame;
    use proptest::prelude::*;

    fn grid(width: i32, rows: &[&str]) -> OccupancyGrid {
        let height = i32::try_from(rows.len()).unwrap();
        let frame = GridFrame { resolution: 0.5, origin: Point::new(-1.0, 2.0), width, height };
        let cells = rows.iter().rev().flat_map(|row| row.chars()).map(|c| match c {
            '#' => Occupancy::Occupied,
            '.' => Occupancy::Free,
            _ => Occupancy::Unknown,
        });
        OccupancyGrid::from_cells(frame, cells.collect())
    }

    fn boxes(world: &World) -> Vec<[f64; 4]> {
        let bounds = world.slice(0.2).into_iter().map(|outline| outline.bounds());
        bounds.map(|b| [b.min.x, b.min.y, b.max.x, b.max.y]).collect()
    }

    #[test]
    fn rows_of_one_width_are_one_wall() {
        let map = grid(4, &["####", "#..#", "#..#", "####"]);
        let world = world("hall", &map, UnknownCells::Occupied);
        assert_eq!(
            boxes(&world),
            [
                [-1.0, 2.0, 1.0, 2.5],
                [-1.0, 2.5, -0.5, 3.5],
                [0.5, 2.5, 1.0, 3.5],
                [-1.0, 3.5, 1.0, 4.0]
            ]
        );
        assert_eq!(world.layers(), ["walls"]);
        assert_eq!(world.slice(HEIGHT + 0.1), []);
    }

    #[test]
    fn the_unknown_beside_the_floor_is_a_wall_or_floor() {
        let map = grid(3, &["  ?", " . ", "   "]);
        assert_eq!(world("", &map, UnknownCells::Free).solids, []);
        // The ring around the free cell, and no more.
        let closed = world("", &map, UnknownCells::Occupied);
        assert_eq!(
            boxes(&closed),
            [
                [-1.0, 2.0, 0.5, 2.5],
                [-1.0, 2.5, -0.5, 3.0],
                [0.0, 2.5, 0.5, 3.0],
                [-1.0, 3.0, 0.5, 3.5]
            ]
        );
        // Free floor at the edge of the image ends there.
        let edge = boxes(&world("", &grid(1, &["."]), UnknownCells::Occupied));
        assert_eq!((edge.len(), edge[0]), (4, [-1.5, 1.5, 0.0, 2.0]));
    }

    proptest! {
        #[test]
        fn every_cell_is_what_it_was(cells in proptest::collection::vec(0..3_u8, 42)) {
            let text: String = cells.iter().map(|c| [' ', '.', '#'][usize::from(*c)]).collect();
            let rows: Vec<&str> = (0..6).map(|row| &text[row * 7..row * 7 + 7]).collect();
            let map = grid(7, &rows);
            let walls = world("", &map, UnknownCells::Free).slice(1.0);
            for cell in map.frame().cells() {
                let middle = map.frame().center(cell);
                let covered = walls.iter().filter(|wall| wall.distance(middle) <= 0.0).count();
                prop_assert_eq!(covered, usize::from(map.at(cell) == Occupancy::Occupied));
            }
        }
    }
}
