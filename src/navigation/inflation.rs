//! Obstacles inflated over the free cells around them.

use super::CostGrid;
use super::costmap::{UNKNOWN, padded_width};
use crate::grid::{Occupancy, OccupancyGrid};

/// How many cells are looked at together for obstacles.
const LOT: usize = 32;

/// Inflates the map: costs fall from 100 at obstacles to 0 at `radius` cells, trunc(100 (1 - d / radius)), d the
/// distance in cells to the obstacle that reached the cell first over free cells. Unknown cells are neither inflated
/// nor crossed (prior-map facts, section 4, "Inflation").
pub fn inflate(map: &OccupancyGrid, radius: u32) -> CostGrid {
    Fires::new(radius).spread(map).0
}

/// A cell that a fire has reached: its padded index, and its offset from where the fire began, as [`Fires`] numbers it.
#[derive(Debug, Clone, Copy)]
struct Fire {
    index: usize,
    offset: usize,
}

/// The square of offsets that a fire can have, with one more on each side.
#[derive(Debug, Clone)]
pub(super) struct Fires {
    side: usize,
    /// The cost at each offset, row by row; 0 where it is out of reach, which no cell is below.
    costs: Vec<u8>,
}

impl Fires {
    /// Creates fires that reach `radius` cells.
    pub(super) fn new(radius: u32) -> Self {
        let edge = i64::from(radius) + 1;
        let within = i64::from(radius) * i64::from(radius);
        let costs = (-edge..=edge)
            .flat_map(|dy| (-edge..=edge).map(move |dx| dx * dx + dy * dy))
            .map(|squared| if squared < within { cost_at(squared, radius) } else { 0 });
        Self { side: 2 * radius as usize + 3, costs: costs.collect() }
    }

    /// Inflates the map, and returns how many steps the fires took until all were out.
    pub(super) fn spread(&self, map: &OccupancyGrid) -> (CostGrid, u32) {
        let frame = *map.frame();
        let mut grid = CostGrid::unknown(frame);
        let width = padded_width(&frame);
        let costs = grid.padded_mut();
        // A brushfire: every cell of its front remembers its offset from the obstacle its fire came from.
        let beginning = self.beginning();
        let mut front: Vec<Fire> = Vec::new();
        for (y, row) in map.values().chunks((width - 2).max(1)).enumerate() {
            let first = (y + 1) * width + 1;
            // Two loops that have no branch in most cells: what a cell holds cannot be foreseen. This one computes without a
            // table, so that many cells are computed at once.
            for (cost, value) in costs[first..].iter_mut().zip(row) {
                let is_unknown = u8::from(*value == Occupancy::Unknown);
                let is_occupied = u8::from(*value == Occupancy::Occupied);
                *cost = (is_unknown * UNKNOWN) | (is_occupied * 100);
            }
            for (i, cells) in row.chunks(LOT).enumerate() {
                let is_occupied = |value: &Occupancy| *value == Occupancy::Occupied;
                if !cells.iter().fold(false, |any, value| any | is_occupied(value)) {
                    continue;
                }
                for (x, _) in cells.iter().enumerate().filter(|(_, value)| is_occupied(value)) {
                    front.push(Fire { index: first + i * LOT + x, offset: beginning });
                }
            }
        }
        let mut next = Vec::new();
        let mut steps = 0;
        while !front.is_empty() {
            steps += 1;
            for &Fire { index, offset } in &front {
                let neighbours = [
                    Fire { index: index + 1, offset: offset + 1 },
                    Fire { index: index + width, offset: offset + self.side },
                    Fire { index: index - 1, offset: offset - 1 },
                    Fire { index: index - width, offset: offset - self.side },
                ];
                for fire in neighbours {
                    let cost = self.costs[fire.offset];
                    // Unknown cells hold more than any cost.
                    if costs[fire.index] < cost {
                        costs[fire.index] = cost;
                        next.push(fire);
                    }
                }
            }
            front.clear();
            std::mem::swap(&mut front, &mut next);
        }
        (grid, steps)
    }

    /// Returns the offset of where a fire begins.
    fn beginning(&self) -> usize {
        self.costs.len() / 2
    }
}

fn cost_at(squared_distance: i64, radius: u32) -> u8 {
    #[expect(clippy::cast_precision_loss, reason = "small")]
    let distance = (squared_distance as f64).sqrt();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100")]
    let cost = (100.0 * (1.0 - distance / f64::from(radius))).max(0.0) as u8;
    cost
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::{Cell, GridFrame};
    use proptest::prelude::*;

    /// Computes the brushfire as its description reads, cell by cell.
    fn by_the_book(map: &OccupancyGrid, radius: u32) -> Vec<Option<u8>> {
        let mut costs = CostGrid::unknown(*map.frame());
        let mut front = Vec::new();
        for cell in map.frame().cells() {
            match map.at(cell) {
                Occupancy::Occupied => {
                    costs.set(cell, 100);
                    front.push((cell, cell));
                }
                Occupancy::Free => costs.set(cell, 0),
                Occupancy::Unknown => {}
            }
        }
        while !front.is_empty() {
            let mut next = Vec::new();
            for (cell, source) in front {
                for neighbour in cell.neighbours4() {
                    let cost = cost_at(neighbour.distance_squared(source), radius);
                    if costs.cost(neighbour).is_some_and(|known| known < cost) {
                        costs.set(neighbour, cost);
                        next.push((neighbour, source));
                    }
                }
            }
            front = next;
        }
        map.frame().cells().map(|cell| costs.cost(cell)).collect()
    }

    proptest! {
        #[test]
        fn equals_the_book(raw in prop::collection::vec(0_u8..9, 240), radius in 1_u32..12) {
            let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 20, height: 12 };
            let cells = raw.iter().map(|&v| match v {
                0 => Occupancy::Occupied,
                1 | 2 => Occupancy::Unknown,
                _ => Occupancy::Free,
            });
            let map = OccupancyGrid::from_cells(frame, cells.collect());
            let costs = inflate(&map, radius);
            let found: Vec<_> = frame.cells().map(|cell| costs.cost(cell)).collect();
            prop_assert_eq!(found, by_the_book(&map, radius));
        }
    }

    #[test]
    fn clearances_are_those_of_the_released_program() {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 21, height: 21 };
        let mut map = OccupancyGrid::filled(frame, Occupancy::Free);
        map.set(Cell::new(10, 10), Occupancy::Occupied);
        map.set(Cell::new(3, 3), Occupancy::Unknown);
        let costs = inflate(&map, 9);
        let at = |x, y| costs.cost(Cell::new(x, y));
        assert_eq!(
            (at(10, 10), at(11, 10), at(13, 10), at(14, 10)),
            (Some(100), Some(88), Some(66), Some(55))
        );
        assert_eq!((at(18, 10), at(19, 10)), (Some(11), Some(0)));
        assert_eq!(at(3, 3), None, "unknown stays unknown");
        // Free for frontiers with 60 means further than 3.6 cells; for the planner with 75, than 2.25.
        assert!(!costs.is_below(Cell::new(13, 11), 60) && costs.is_below(Cell::new(14, 10), 60));
        assert!(!costs.is_below(Cell::new(12, 11), 75) && costs.is_below(Cell::new(13, 10), 75));
    }
}
