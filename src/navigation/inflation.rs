//! Obstacles inflated over the free cells around them.

use super::CostGrid;
use crate::grid::{Cell, Occupancy, OccupancyGrid};

/// The map with costs that fall from 100 at obstacles to 0 at `radius` cells: trunc(100 (1 - d / radius)), d
/// the distance in cells to the obstacle that reached the cell first over free cells. Unknown cells are
/// neither inflated nor crossed (prior-map facts, section 4, "Inflation").
pub fn inflate(map: &OccupancyGrid, radius: u32) -> CostGrid {
    let frame = *map.frame();
    let mut costs = CostGrid::unknown(frame);
    // A brushfire: every cell remembers the obstacle its fire came from.
    let mut front: Vec<(Cell, Cell)> = Vec::new();
    for (index, &value) in map.values().iter().enumerate() {
        let cell = frame.cell_of(index);
        match value {
            Occupancy::Occupied => {
                costs.set(cell, 100);
                front.push((cell, cell));
            }
            Occupancy::Free => costs.set(cell, 0),
            Occupancy::Unknown => {}
        }
    }
    let reach = i64::from(radius) * i64::from(radius);
    let table: Vec<u8> = (0..=reach).map(|squared| cost_at(squared, radius)).collect();
    let mut next = Vec::new();
    while !front.is_empty() {
        for &(cell, source) in &front {
            for neighbour in cell.neighbours4() {
                let squared = neighbour.distance_squared(source);
                if squared >= reach {
                    continue;
                }
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "below reach"
                )]
                let cost = table[squared as usize];
                if costs.cost(neighbour).is_some_and(|known| known < cost) {
                    costs.set(neighbour, cost);
                    next.push((neighbour, source));
                }
            }
        }
        front.clear();
        std::mem::swap(&mut front, &mut next);
    }
    costs
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
    use crate::grid::GridFrame;

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
