//! Distances to a goal over the inflated map, and the way down.

use super::CostGrid;
use crate::grid::{Cell, Grid};

/// Value of cells the wave did not reach.
pub const UNREACHED: u32 = u32::MAX;

/// A straight step's plain length in the wave's units; a diagonal one is 1.4 times that.
const STRAIGHT: u32 = 10;
const DIAGONAL: u32 = 14;

/// Weighted distances from every cell to one goal (Dijkstra 1959, with the buckets of Dial 1969), 8-connected
/// over known cells below a lethal cost: a step costs its length x (1 + weight x cost / 100).
#[derive(Debug, Clone)]
pub struct Wavefront {
    distances: Grid<u32>,
    /// Wave units per metre of plain length.
    units_per_metre: f64,
}

impl Wavefront {
    /// The wave from `goal` over `costs`, crossing cells cheaper than `lethal`. Where the goal itself is not
    /// crossable, all crossable cells in the 11-cell box around it are seeds instead.
    pub fn from_goal(costs: &CostGrid, goal: Cell, lethal: u8, weight: f64) -> Self {
        let frame = *costs.frame();
        let mut wave = Self {
            distances: Grid::filled(frame, UNREACHED),
            units_per_metre: f64::from(STRAIGHT) * FINE / frame.resolution,
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small and positive"
        )]
        let step = |plain: u32, cost: u8| {
            (f64::from(plain) * FINE * (1.0 + weight * f64::from(cost) / 100.0)).round() as u32
        };
        let straight: Vec<u32> = (0..=100).map(|cost| step(STRAIGHT, cost)).collect();
        let diagonal: Vec<u32> = (0..=100).map(|cost| step(DIAGONAL, cost)).collect();
        let mut buckets = vec![Vec::new(); diagonal[100] as usize + 1];
        let mut waiting = 0_usize;
        if costs.is_below(goal, lethal) {
            wave.distances.set(goal, 0);
            buckets[0].push(goal);
            waiting = 1;
        } else {
            for y in goal.y - 5..=goal.y + 5 {
                for x in goal.x - 5..=goal.x + 5 {
                    let cell = Cell::new(x, y);
                    if costs.is_below(cell, lethal) {
                        wave.distances.set(cell, 0);
                        buckets[0].push(cell);
                        waiting += 1;
                    }
                }
            }
        }
        let mut distance = 0_u32;
        let mut current = Vec::new();
        while waiting > 0 {
            let slot = distance as usize % buckets.len();
            std::mem::swap(&mut current, &mut buckets[slot]);
            waiting -= current.len();
            for cell in current.drain(..) {
                if wave.distance(cell) != distance {
                    continue; // reached more cheaply since
                }
                for (i, neighbour) in cell.neighbours8().into_iter().enumerate() {
                    let Some(cost) = costs.cost(neighbour).filter(|&cost| cost < lethal) else {
                        continue;
                    };
                    let steps = if i % 2 == 0 { &straight } else { &diagonal };
                    let through = distance + steps[usize::from(cost)];
                    if through < wave.distance(neighbour) {
                        wave.distances.set(neighbour, through);
                        let slot = through as usize % buckets.len();
                        buckets[slot].push(neighbour);
                        waiting += 1;
                    }
                }
            }
            distance += 1;
        }
        wave
    }

    /// Distance of `cell` in wave units; [`UNREACHED`] where the wave did not come.
    pub fn distance(&self, cell: Cell) -> u32 {
        self.distances.get(cell).unwrap_or(UNREACHED)
    }

    /// Weighted distance of `cell` from the goal (m), or `None` where the wave did not come.
    pub fn metres(&self, cell: Cell) -> Option<f64> {
        match self.distance(cell) {
            UNREACHED => None,
            units => Some(f64::from(units) / self.units_per_metre),
        }
    }

    /// The nearest neighbour downhill of `cell`, or `None` at the goal and where the wave did not come.
    pub fn downhill(&self, cell: Cell) -> Option<Cell> {
        let here = self.distance(cell);
        cell.neighbours8()
            .into_iter()
            .map(|n| (self.distance(n), n))
            .filter(|&(distance, _)| distance < here)
            .min_by_key(|&(distance, _)| distance)
            .map(|(_, neighbour)| neighbour)
    }

    /// The way from `start` down to the goal, both included; empty where the wave did not come.
    pub fn path(&self, start: Cell) -> Vec<Cell> {
        if self.distance(start) == UNREACHED {
            return Vec::new();
        }
        std::iter::successors(Some(start), |&cell| self.downhill(cell)).collect()
    }
}

/// Sub-units per tenth of a step: keeps rounding of weighted steps below half a percent.
const FINE: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::GridFrame;
    use proptest::prelude::*;

    fn open(width: i32, height: i32) -> CostGrid {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width, height };
        let mut costs = CostGrid::unknown(frame);
        for cell in frame.cells() {
            costs.set(cell, 0);
        }
        costs
    }

    #[test]
    fn open_ground_has_plain_distances() {
        let wave = Wavefront::from_goal(&open(20, 20), Cell::new(2, 2), 75, 10.0);
        assert_eq!(wave.metres(Cell::new(12, 2)), Some(1.0));
        assert!((wave.metres(Cell::new(12, 12)).unwrap() - 1.4).abs() < 1e-9);
        assert_eq!(wave.path(Cell::new(5, 5)).len(), 4);
        assert!(wave.path(Cell::new(99, 0)).is_empty());
    }

    #[test]
    fn danger_is_avoided_where_a_detour_is_cheaper() {
        let mut costs = open(20, 9);
        for y in 2..7 {
            costs.set(Cell::new(10, y), 70);
        }
        let wave = Wavefront::from_goal(&costs, Cell::new(18, 4), 75, 10.0);
        let path = wave.path(Cell::new(2, 4));
        assert!(path.iter().all(|&cell| costs.cost(cell) == Some(0)), "{path:?}");
    }

    #[test]
    fn a_blocked_goal_is_approached_and_a_walled_one_is_not_reached() {
        let mut costs = open(30, 30);
        costs.set(Cell::new(15, 15), 100);
        let wave = Wavefront::from_goal(&costs, Cell::new(15, 15), 75, 10.0);
        assert_eq!(wave.distance(Cell::new(12, 12)), 0);
        for x in 0..30 {
            costs.set(Cell::new(x, 5), 100);
        }
        let wave = Wavefront::from_goal(&costs, Cell::new(15, 20), 75, 10.0);
        assert_eq!(wave.metres(Cell::new(15, 2)), None);
    }

    proptest! {
        /// Every reached cell but the goal has a way down, and each step down costs what it should.
        #[test]
        fn paths_end_at_the_goal(walls in prop::collection::vec((0..15, 0..15, 0_u8..100), 0..80)) {
            let mut costs = open(15, 15);
            for (x, y, cost) in walls {
                costs.set(Cell::new(x, y), cost);
            }
            let goal = Cell::new(7, 7);
            costs.set(goal, 0);
            let wave = Wavefront::from_goal(&costs, goal, 75, 10.0);
            for cell in costs.frame().cells() {
                if wave.distance(cell) != UNREACHED {
                    prop_assert_eq!(wave.path(cell).last().copied(), Some(goal));
                }
            }
        }
    }
}
