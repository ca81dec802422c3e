//! Following a wave to its goal, after Nav2D's navigator (prior-map facts, section 4).

use super::Wavefront;
use crate::grid::{Cell, line};

/// The navigator heads for the cell this many steps down the wave.
const LOOK_AHEAD: usize = 9;

/// Returns the cell to head for: the furthest of the next 9 down the wave to which a straight line is free, so that the
/// robot does not cut the corners of doors (the released program takes the ninth whatever lies between).
pub fn look_ahead(wave: &mut Wavefront, here: Cell) -> Cell {
    let mut path = [here; LOOK_AHEAD + 1];
    let mut length = 0;
    for cell in std::iter::successors(Some(here), |&cell| wave.downhill(cell)).take(path.len()) {
        path[length] = cell;
        length += 1;
    }
    let free = |ahead: &&Cell| line(here, **ahead).all(|cell| wave.reaches(cell));
    path[..length].iter().rev().find(free).copied().unwrap_or(here)
}

/// Returns the cell itself where the wave came, or else the nearest reached one on the smallest square ring around it,
/// at most 6 cells out: a robot that stands too close to an obstacle first heads out. `None` where the wave came to
/// none of them.
pub fn nearest_reached(wave: &mut Wavefront, cell: Cell) -> Option<Cell> {
    nearest(cell, |c| wave.reaches(*c))
}

/// Returns the cell itself where it is `wanted`, or else the nearest that is on the smallest square ring around it, at most 6
/// cells out.
pub fn nearest(cell: Cell, mut wanted: impl FnMut(&Cell) -> bool) -> Option<Cell> {
    if wanted(&cell) {
        return Some(cell);
    }
    (1..=6).find_map(|ring: i32| {
        let side = -ring..=ring;
        side.clone()
            .flat_map(|y| side.clone().map(move |x| Cell::new(cell.x + x, cell.y + y)))
            .filter(&mut wanted)
            .min_by_key(|c| (c.distance_squared(cell), c.y, c.x))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::GridFrame;
    use crate::navigation::CostGrid;
    use std::sync::Arc;

    /// Returns the wave from `goal` over 20 x 20 free cells with a wall at x = 10 that is open from y = 15 on.
    fn wave(goal: Cell) -> Wavefront {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 20, height: 20 };
        let mut costs = CostGrid::unknown(frame);
        for cell in frame.cells() {
            costs.set(cell, if cell.x == 10 && cell.y < 15 { 100 } else { 0 });
        }
        Wavefront::from_goal(Arc::new(costs), goal, 75, 10.0)
    }

    #[test]
    fn nine_cells_ahead_where_the_way_is_straight_and_fewer_at_a_corner() {
        let mut ahead = wave(Cell::new(0, 0));
        assert_eq!(look_ahead(&mut ahead, Cell::new(0, 18)), Cell::new(0, 9));
        let mut around = wave(Cell::new(19, 0));
        let start = Cell::new(8, 12);
        let corner = look_ahead(&mut around, start);
        assert!(line(start, corner).all(|cell| around.reaches(cell)), "{corner:?}");
        assert!(corner != start && corner.x <= 11, "not through the wall: {corner:?}");
    }

    #[test]
    fn a_robot_in_a_wall_heads_for_the_nearest_free_cell() {
        let mut wave = wave(Cell::new(0, 0));
        assert_eq!(nearest_reached(&mut wave, Cell::new(5, 5)), Some(Cell::new(5, 5)));
        assert_eq!(nearest_reached(&mut wave, Cell::new(10, 5)), Some(Cell::new(9, 5)));
        assert_eq!(nearest_reached(&mut wave, Cell::new(40, 40)), None);
    }
}
