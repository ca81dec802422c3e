//! The floor that a robot can reach, and what of a building can be told from it: walls that border it, rooms, doors.

use reenact::geometry::{Outline, Point};
use reenact::grid::{Cell, Grid, GridFrame, Occupancy};
use reenact::world::World;
use reenact::world::floor_plan::{FloorPlanSettings, floor_plan};
use std::collections::BTreeSet;

/// Side of a cell of floor (m).
const CELL: f64 = 0.05;
/// The Kobuki: its radius and its height (m), and the height of its lidar.
const RADIUS: f64 = 0.178;
const HEIGHT: f64 = 0.43;
const LIDAR: f64 = 0.1602;

/// A building as the robot's centre gets to know it.
pub(crate) struct Floor {
    solids: Vec<Outline>,
    /// Where the centre can be, driving from the start.
    reached: Grid<bool>,
}

/// Where two or more parts of a floor meet.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Passage<Name> {
    /// The parts.
    pub(crate) between: BTreeSet<Name>,
    /// Its middle (m).
    pub(crate) middle: Point,
}

impl Floor {
    pub(crate) fn of(world: &World, start: Point) -> Self {
        Self::with_radius(world, start, RADIUS)
    }

    /// Creates the floor of a robot of another radius (m).
    pub(crate) fn with_radius(world: &World, start: Point, radius: f64) -> Self {
        let solids = world.contact(0.0, HEIGHT);
        let frame = GridFrame::covering(world.bounds().grown(1.0), CELL);
        let blocked = near(&solids, frame, radius);
        let mut reached = Grid::filled(frame, false);
        let mut open = vec![frame.cell_at(start)];
        assert_eq!(blocked.get(open[0]), Some(false), "{}: the start is blocked", world.name);
        reached.set(open[0], true);
        while let Some(cell) = open.pop() {
            for next in cell.neighbours4() {
                if blocked.get(next) == Some(false) && reached.get(next) == Some(false) {
                    reached.set(next, true);
                    open.push(next);
                }
            }
        }
        Self { solids, reached }
    }

    fn reached(&self, cell: Cell) -> bool {
        self.reached.get(cell) == Some(true)
    }

    /// Returns the reached cells.
    fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.reached.frame().cells().filter(|cell| self.reached(*cell))
    }

    /// Returns the area that the centre reaches (m2).
    pub(crate) fn area(&self) -> f64 {
        f64::from(u32::try_from(self.cells().count()).unwrap()) * CELL * CELL
    }

    /// Computes the share of the floor reached that `outlines` cover.
    pub(crate) fn share_covered(&self, outlines: &[Outline]) -> f64 {
        let covered = near(outlines, *self.reached.frame(), 0.0);
        let both = self.cells().filter(|cell| covered.get(*cell) == Some(true)).count();
        f64::from(u32::try_from(both).unwrap()) * CELL * CELL / self.area()
    }

    /// Returns the area of `polygon` that the centre reaches (m2).
    pub(crate) fn area_in(&self, polygon: &Outline) -> f64 {
        let frame = *self.reached.frame();
        let inside = self.cells().filter(|cell| polygon.contains(frame.center(*cell))).count();
        f64::from(u32::try_from(inside).unwrap()) * CELL * CELL
    }

    pub(crate) fn reaches_into(&self, polygon: &Outline) -> bool {
        self.cells().any(|cell| polygon.contains(self.reached.frame().center(cell)))
    }

    /// Returns the cells of 0.1 m of the floor plan of `world` that border what is reached, by their centres (m).
    pub(crate) fn walls(&self, world: &World) -> Vec<Point> {
        let layers = ["walls".to_owned()];
        let plan = FloorPlanSettings { height: LIDAR, resolution: 0.1, layers: Some(&layers) };
        let plan = floor_plan(world, plan).unwrap();
        let frame = self.reached.frame();
        // The centre stays a radius away from a wall of 0.15 m.
        let borders = |at: Point| {
            let around = Point::new(0.4, 0.4);
            let (low, high) = (frame.cell_at(at - around), frame.cell_at(at + around));
            (low.y..=high.y).any(|y| {
                (low.x..=high.x).any(|x| {
                    let cell = Cell::new(x, y);
                    self.reached(cell) && frame.center(cell).distance(at) <= 0.4
                })
            })
        };
        let occupied = plan.frame().cells().filter(|cell| plan.at(*cell) == Occupancy::Occupied);
        occupied.map(|cell| plan.frame().center(cell)).filter(|at| borders(*at)).collect()
    }

    /// Returns rooms by their middles: pieces of the floor that stay when a robot of radius `half_door` m is too wide
    /// for its doors; and what joins them.
    pub(crate) fn rooms(&self, half_door: f64) -> (Vec<Point>, Vec<Passage<usize>>) {
        let frame = *self.reached.frame();
        let narrow = near(&self.solids, frame, half_door);
        let wide = |cell: Cell| self.reached(cell) && narrow.get(cell) == Some(false);
        let rooms = components(frame, wide);
        let reach = GridFrame { resolution: CELL, origin: Point::ZERO, width: 0, height: 0 };
        let reach = reach.cell_at(Point::new(half_door, 0.0)).x;
        // Which rooms a disc of that radius can cover a cell from: one in a room, several or none in a door.
        let mut covering: Grid<[Option<usize>; 2]> = Grid::filled(frame, [None; 2]);
        for (room, cells) in rooms.iter().enumerate() {
            for &cell in cells {
                covering.set(cell, [Some(room), None]);
                if cell.neighbours4().into_iter().all(wide) {
                    continue;
                }
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        let next = Cell::new(cell.x + dx, cell.y + dy);
                        if dx * dx + dy * dy > reach * reach || !self.reached(next) || wide(next) {
                            continue;
                        }
                        match covering.get(next) {
                            Some([None, _]) => covering.set(next, [Some(room), None]),
                            Some([Some(first), None]) if first != room => {
                                covering.set(next, [Some(first), Some(room)]);
                            }
                            _ => {}
                        }
                    }
                }
            }
        }
        let room_of = |cell: Cell| match covering.get(cell) {
            Some([Some(room), None]) => Some(room),
            _ => None,
        };
        let middles = rooms.iter().map(|cells| middle(frame, cells)).collect();
        (middles, self.passages(room_of))
    }

    /// Returns the doors between named parts of the floor.
    pub(crate) fn doors(&self, parts: &[(String, Outline)]) -> Vec<Passage<String>> {
        let frame = *self.reached.frame();
        let mut part_of: Grid<Option<usize>> = Grid::filled(frame, None);
        for cell in self.cells() {
            let at = frame.center(cell);
            part_of.set(cell, parts.iter().position(|(_, outline)| outline.contains(at)));
        }
        self.passages(|cell| part_of.get(cell).flatten())
            .into_iter()
            .map(|passage| Passage {
                between: passage.between.iter().map(|part| parts[*part].0.clone()).collect(),
                middle: passage.middle,
            })
            .collect()
    }

    /// Returns the pieces of the floor that belong to no part and touch two or more.
    fn passages(&self, part: impl Fn(Cell) -> Option<usize>) -> Vec<Passage<usize>> {
        let frame = *self.reached.frame();
        components(frame, |cell| self.reached(cell) && part(cell).is_none())
            .iter()
            .map(|cells| Passage {
                between: cells.iter().flat_map(|c| c.neighbours8()).filter_map(&part).collect(),
                middle: middle(frame, cells),
            })
            .filter(|passage| passage.between.len() > 1)
            .collect()
    }
}

/// Returns which cells have their centre within `reach` m of one of `outlines`.
fn near(outlines: &[Outline], frame: GridFrame, reach: f64) -> Grid<bool> {
    let mut grid = Grid::filled(frame, false);
    for outline in outlines {
        let bounds = outline.bounds().grown(reach + CELL);
        let (low, high) = (frame.cell_at(bounds.min), frame.cell_at(bounds.max));
        for y in low.y.max(0)..=high.y.min(frame.height - 1) {
            for x in low.x.max(0)..=high.x.min(frame.width - 1) {
                let cell = Cell::new(x, y);
                if outline.distance(frame.center(cell)) <= reach {
                    grid.set(cell, true);
                }
            }
        }
    }
    grid
}

/// Returns the pieces of what is `inside`, joined by sides and corners.
fn components(frame: GridFrame, inside: impl Fn(Cell) -> bool) -> Vec<Vec<Cell>> {
    let mut seen = Grid::filled(frame, false);
    let mut all = Vec::new();
    for first in frame.cells() {
        if !inside(first) || seen.get(first) == Some(true) {
            continue;
        }
        seen.set(first, true);
        let (mut piece, mut done) = (vec![first], 0);
        while done < piece.len() {
            for next in piece[done].neighbours8() {
                if seen.get(next) == Some(false) && inside(next) {
                    seen.set(next, true);
                    piece.push(next);
                }
            }
            done += 1;
        }
        all.push(piece);
    }
    all
}

fn middle(frame: GridFrame, cells: &[Cell]) -> Point {
    let sum = cells.iter().fold(Point::ZERO, |sum, cell| sum + frame.center(*cell));
    sum * (1.0 / f64::from(u32::try_from(cells.len()).unwrap()))
}
