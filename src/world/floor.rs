//! The floor on which a body can stand and go, in cells: for lints and for choosing a start, never for a mind.

use crate::geometry::{Bounds, Outline, Point};
use crate::grid::{Cell, GridFrame};

/// Side of a cell (m) where the world is not too large for it.
const RESOLUTION: f64 = 0.1;
/// Most cells along the longer side.
const MOST_ALONG: f64 = 1500.0;

/// Where the middle of a disc can be.
#[derive(Debug, Clone)]
pub struct Floor {
    frame: GridFrame,
    /// By cell: whether a disc there touches nothing.
    open: Vec<bool>,
}

impl Floor {
    /// Finds the places among `solids`, within `bounds` and a little around them, where a disc of `radius` (m) fits.
    /// `None` where there is nothing to stand among.
    pub fn of(solids: &[Outline], bounds: Bounds, radius: f64) -> Option<Self> {
        let extent = bounds.width().max(bounds.height());
        if bounds.is_empty() || !extent.is_finite() || !radius.is_finite() {
            return None;
        }
        let resolution = RESOLUTION.max(extent / MOST_ALONG);
        let margin = radius.min(extent) + 3.0 * resolution;
        let frame = GridFrame::covering(bounds.grown(margin), resolution);
        let mut open = vec![true; frame.len()];
        for solid in solids {
            let around = solid.bounds().grown(radius);
            let (low, high) = (frame.cell_at(around.min), frame.cell_at(around.max));
            for y in low.y.max(0)..=high.y.min(frame.height - 1) {
                for x in low.x.max(0)..=high.x.min(frame.width - 1) {
                    let cell = Cell::new(x, y);
                    if let Some(index) = frame.index(cell)
                        && open[index]
                        && solid.distance(frame.center(cell)) <= radius
                    {
                        open[index] = false;
                    }
                }
            }
        }
        Some(Self { frame, open })
    }

    /// Finds where the disc can go from `start`: nowhere where it does not fit there.
    pub fn reached_from(&self, start: Point) -> Reach {
        let mut reach = Reach {
            frame: self.frame,
            reached: vec![false; self.open.len()],
            cells: Vec::new(),
            is_closed: true,
        };
        let mut next: Vec<Cell> = vec![self.frame.cell_at(start)];
        while let Some(cell) = next.pop() {
            let Some(index) = self.frame.index(cell) else { continue };
            if !self.open[index] || reach.reached[index] {
                continue;
            }
            reach.reached[index] = true;
            reach.cells.push(cell);
            reach.is_closed &= self.frame.is_inside(cell);
            next.extend(cell.neighbours4());
        }
        reach
    }

    /// Finds the largest part of the floor that the disc cannot leave; where there is none, the largest of all.
    pub fn largest_room(&self) -> Option<Reach> {
        let mut seen = vec![false; self.open.len()];
        let mut rooms: Vec<Reach> = Vec::new();
        for (index, cell) in self.frame.cells().enumerate() {
            if !self.open[index] || seen[index] {
                continue;
            }
            let room = self.reached_from(self.frame.center(cell));
            let inside = room.cells.iter().filter_map(|cell| self.frame.index(*cell));
            inside.for_each(|index| seen[index] = true);
            rooms.push(room);
        }
        rooms.into_iter().max_by_key(|room| (room.is_closed, room.cells.len()))
    }
}

/// Where a disc can go from some start.
#[derive(Debug, Clone)]
pub struct Reach {
    frame: GridFrame,
    reached: Vec<bool>,
    cells: Vec<Cell>,
    is_closed: bool,
}

impl Reach {
    /// Returns whether the disc can be nowhere.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Returns whether it cannot get past everything solid.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Returns the place nearest to `wanted`, the middle of a cell.
    pub fn nearest(&self, wanted: Point) -> Option<Point> {
        let places = self.cells.iter().map(|cell| self.frame.center(*cell));
        places.min_by(|a, b| a.distance(wanted).total_cmp(&b.distance(wanted)))
    }

    /// Returns whether it can get within `distance` (m) of `point`.
    pub fn gets_near(&self, point: Point, distance: f64) -> bool {
        self.cells.iter().any(|cell| self.frame.center(*cell).distance(point) <= distance)
    }

    /// Returns the share of `wider`, where a smaller disc can go, of which each place is within `distance` (m) of this
    /// reach, along that floor. Both are of one start and one world, `wider` of cells not larger than these.
    pub fn covers(&self, wider: &Self, distance: f64) -> f64 {
        let at = |cell: Cell| {
            let index = self.frame.index(self.frame.cell_at(wider.frame.center(cell)));
            index.is_some_and(|index| self.reached[index])
        };
        let mut covered = vec![false; wider.reached.len()];
        let mut edge: Vec<Cell> = wider.cells.iter().copied().filter(|cell| at(*cell)).collect();
        let mut count = edge.len();
        for cell in &edge {
            wider.frame.index(*cell).into_iter().for_each(|index| covered[index] = true);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some cells")]
        let steps = (distance / wider.frame.resolution).ceil().min(1e4) as usize;
        for _ in 0..steps {
            let mut next = Vec::new();
            for neighbour in edge.iter().flat_map(|cell| cell.neighbours4()) {
                if let Some(index) = wider.frame.index(neighbour)
                    && wider.reached[index]
                    && !covered[index]
                {
                    covered[index] = true;
                    next.push(neighbour);
                }
            }
            count += next.len();
            edge = next;
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of cells")]
        let share = count as f64 / wider.cells.len().max(1) as f64;
        share
    }

    /// Finds the place from which the nearest of `solids` is farthest, and how far (m) that is, to within two cells.
    pub fn loneliest(&self, solids: &[Outline]) -> Option<(Point, f64)> {
        let reach = 2.0 * self.frame.resolution;
        let there = Floor::of(solids, self.frame.bounds(), reach)?;
        // A walk from what is solid, eight ways with the lengths of a chamfer of 3 and 4: up to 8 % too long.
        let mut steps: Vec<u32> =
            there.open.iter().map(|open| if *open { u32::MAX } else { 0 }).collect();
        let (width, height) = (there.frame.width, there.frame.height);
        let relax = |steps: &mut Vec<u32>, cell: Cell, around: [(i32, i32, u32); 4]| {
            let Some(index) = there.frame.index(cell) else { return };
            for (dx, dy, length) in around {
                let from = there.frame.index(Cell::new(cell.x + dx, cell.y + dy));
                let known = from.map_or(u32::MAX, |from| steps[from]);
                steps[index] = steps[index].min(known.saturating_add(length));
            }
        };
        for y in 0..height {
            for x in 0..width {
                let before = [(-1, 0, 3), (-1, -1, 4), (0, -1, 3), (1, -1, 4)];
                relax(&mut steps, Cell::new(x, y), before);
            }
        }
        for y in (0..height).rev() {
            for x in (0..width).rev() {
                let behind = [(1, 0, 3), (1, 1, 4), (0, 1, 3), (-1, 1, 4)];
                relax(&mut steps, Cell::new(x, y), behind);
            }
        }
        let places = self.cells.iter().filter_map(|cell| {
            let place = self.frame.center(*cell);
            let steps = steps[there.frame.index(there.frame.cell_at(place))?];
            (steps < u32::MAX).then_some((place, steps))
        });
        let (place, steps) = places.max_by_key(|(_, steps)| *steps)?;
        Some((place, reach + f64::from(steps) / 3.0 * there.frame.resolution))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(x0: f64, y0: f64, x1: f64, y1: f64) -> Outline {
        let (center, length) = (Point::new(f64::midpoint(x0, x1), f64::midpoint(y0, y1)), x1 - x0);
        Outline::rectangle(center, length, y1 - y0, 0.0)
    }

    /// Returns two rooms of 6 x 6 m, joined by a door of `door` m.
    fn rooms(door: f64) -> Vec<Outline> {
        vec![
            wall(-6.1, -3.1, 6.1, -3.0),
            wall(-6.1, 3.0, 6.1, 3.1),
            wall(-6.1, -3.1, -6.0, 3.1),
            wall(6.0, -3.1, 6.1, 3.1),
            wall(-0.05, -3.0, 0.05, -door / 2.0),
            wall(-0.05, door / 2.0, 0.05, 3.0),
        ]
    }

    fn around(solids: &[Outline]) -> Bounds {
        solids.iter().fold(Bounds::EMPTY, |bounds, solid| bounds.union(solid.bounds()))
    }

    #[test]
    fn a_wide_body_stays_on_its_side_of_a_narrow_door() {
        let solids = rooms(0.8);
        let reach = |radius: f64| {
            let floor = Floor::of(&solids, around(&solids), radius).unwrap();
            floor.reached_from(Point::new(-3.0, 0.0))
        };
        let (narrow, slim, wide) = (reach(0.1), reach(0.3), reach(0.5));
        assert!(narrow.is_closed() && slim.is_closed() && wide.is_closed());
        assert!(slim.covers(&narrow, 0.5) > 0.99, "{}", slim.covers(&narrow, 0.5));
        let half = wide.covers(&narrow, 0.8);
        assert!((0.49..0.56).contains(&half), "{half}");
        let far = Point::new(3.0, 0.0);
        assert!(slim.gets_near(far, 0.1) && !wide.gets_near(far, 0.1));
        assert!(reach(4.0).is_empty());
    }

    #[test]
    fn the_loneliest_place_is_the_middle_of_the_largest_room() {
        let solids = rooms(0.8);
        let floor = Floor::of(&solids, around(&solids), 0.2).unwrap();
        let (place, distance) =
            floor.reached_from(Point::new(-3.0, 0.0)).loneliest(&solids).unwrap();
        assert!((place.x.abs() - 3.0).abs() < 0.5 && place.y.abs() < 0.5, "{place:?}");
        assert!((2.8..3.3).contains(&distance), "{distance}");
    }

    #[test]
    fn the_largest_room_is_inside_the_walls() {
        let mut solids = rooms(0.8);
        // The left room is smaller by a closed closet.
        solids.push(wall(-6.0, 1.9, -4.0, 2.0));
        solids.push(wall(-4.1, 2.0, -4.0, 3.0));
        let floor = Floor::of(&solids, around(&solids), 0.5).unwrap();
        let room = floor.largest_room().unwrap();
        let place = room.nearest(Point::new(0.0, 0.0)).unwrap();
        assert!(room.is_closed() && place.x > 0.4 && place.y.abs() < 0.11, "{place:?}");
    }

    #[test]
    fn a_world_without_a_wall_is_open() {
        let mut solids = rooms(0.8);
        solids.remove(3);
        let floor = Floor::of(&solids, around(&solids), 0.2).unwrap();
        assert!(!floor.reached_from(Point::new(-3.0, 0.0)).is_closed());
        assert!(Floor::of(&[], Bounds::EMPTY, 0.2).is_none());
    }
}
