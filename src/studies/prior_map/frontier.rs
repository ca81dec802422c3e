//! Frontiers and candidate locations (section 3.1):
//! 1. A flood from the robot over traversable cells finds the frontier cells.
//! 2. Frontier cells that share a side or a corner form one chain.
//! 3. Each chain that is long enough is a frontier, with its candidate location.

use crate::geometry::Point;
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::navigation::CostGrid;
use crate::studies::prior_map::Candidate;
use std::collections::{BTreeMap, VecDeque};

/// A chain of free cells next to unknown ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frontier {
    /// Its cells, in the order in which a flood from the robot met them.
    pub cells: Vec<Cell>,
    /// The candidate location p: by default "the cell that divides a frontier into two equal segments".
    pub candidate: Cell,
}

impl Frontier {
    /// Returns the middle of the unknown cells of `map` next to it.
    pub(super) fn unknown_side(&self, map: &OccupancyGrid) -> Point {
        let unknown: Vec<Point> = self
            .cells
            .iter()
            .flat_map(|cell| cell.neighbours8())
            .filter(|&cell| map.at(cell) == Occupancy::Unknown)
            .map(|cell| map.frame().center(cell))
            .collect();
        #[expect(clippy::cast_precision_loss, reason = "few cells")]
        let share = 1.0 / unknown.len().max(1) as f64;
        unknown.iter().fold(Point::ZERO, |sum, &point| sum + point * share)
    }
}

/// Finds the frontiers that the robot at `robot` can reach: chains of free cells "adjacent to at least an unknown
/// cell", of those that a 4-connected flood over cells cheaper than `lethal` reaches. Two cells belong to one chain
/// where they share a side or a corner. Chains shorter than `minimum` cells are left out.
pub fn find_frontiers(
    map: &OccupancyGrid,
    costs: &CostGrid,
    robot: Cell,
    lethal: u8,
    minimum: u32,
    candidate: Candidate,
) -> Vec<Frontier> {
    // 1. The flood.
    let frame = map.frame();
    let mut met = vec![false; frame.len()];
    let mut queue = VecDeque::from([robot]);
    if let Some(index) = frame.index(robot) {
        met[index] = true;
    }
    // Cells of frontiers with the order of their discovery.
    let mut order: BTreeMap<Cell, usize> = BTreeMap::new();
    let (values, width) = (map.values(), usize::try_from(frame.width).unwrap_or(0));
    let borders_on_unknown = |cell: Cell| match frame.index(cell) {
        // Three cells of three rows, not one by one: most cells met are well inside.
        Some(at) if frame.is_inside(cell) => {
            [at - width, at, at + width]
                .iter()
                .any(|&middle| values[middle - 1..=middle + 1].contains(&Occupancy::Unknown))
                && cell.neighbours8().iter().any(|&n| map.at(n) == Occupancy::Unknown)
        }
        _ => cell.neighbours8().iter().any(|&n| map.at(n) == Occupancy::Unknown),
    };
    while let Some(cell) = queue.pop_front() {
        if borders_on_unknown(cell) {
            order.insert(cell, order.len());
        }
        for neighbour in cell.neighbours4() {
            let Some(index) = frame.index(neighbour) else { continue };
            if !met[index] && costs.is_below(neighbour, lethal) {
                met[index] = true;
                queue.push_back(neighbour);
            }
        }
    }
    // 2. The chains, by the discovery of their first cells.
    let mut by_discovery: Vec<Cell> = vec![robot; order.len()];
    for (&cell, &i) in &order {
        by_discovery[i] = cell;
    }
    let mut frontiers = Vec::new();
    for first in by_discovery {
        if !order.contains_key(&first) {
            continue; // taken into an earlier chain
        }
        let mut chain = Vec::new();
        let mut next = vec![first];
        let mut members = BTreeMap::new();
        while let Some(cell) = next.pop() {
            if let Some(discovered) = order.remove(&cell) {
                members.insert(discovered, cell);
                next.extend(cell.neighbours8().into_iter().filter(|n| order.contains_key(n)));
            }
        }
        chain.extend(members.into_values());
        // 3. The candidates.
        if chain.len() >= minimum as usize {
            let candidate = match candidate {
                Candidate::Middle => middle_of(&chain),
                Candidate::NearestToCentroid => nearest_to_centroid(&chain),
            };
            frontiers.push(Frontier { cells: chain, candidate });
        }
    }
    frontiers
}

/// Returns the cell half way along the chain: half way on the shortest path, over the chain's own cells, between two of
/// its ends that are furthest apart.
fn middle_of(chain: &[Cell]) -> Cell {
    let (_, one_end) = furthest(chain, chain[0]);
    let (way_back, other_end) = furthest(chain, one_end);
    let mut way = vec![other_end];
    while let Some(&cell) = way.last().and_then(|cell| way_back.get(cell)) {
        if way.last() == Some(&cell) {
            break;
        }
        way.push(cell);
    }
    way[way.len() / 2]
}

/// Returns the cell nearest to the centroid as the released program computes it: the mean of columns and of rows cut to
/// whole cells, distances to it cut to whole cells too, the first found among equals (prior-map facts, section 6).
fn nearest_to_centroid(chain: &[Cell]) -> Cell {
    let count = i64::try_from(chain.len()).unwrap_or(i64::MAX).max(1);
    let mean = |of: fn(&Cell) -> i32| {
        // Floored, not truncated: the same cell wherever the map's cell (0, 0) lies.
        let sum: i64 = chain.iter().map(|cell| i64::from(of(cell))).sum();
        i32::try_from(sum.div_euclid(count)).unwrap_or(i32::MAX)
    };
    let centroid = Cell::new(mean(|cell| cell.x), mean(|cell| cell.y));
    let nearest = chain.iter().min_by_key(|cell| cell.distance_squared(centroid).isqrt());
    nearest.copied().unwrap_or(centroid)
}

/// Returns for every cell of the chain the next one back to `from`, and the cell that takes the most steps.
fn furthest(chain: &[Cell], from: Cell) -> (BTreeMap<Cell, Cell>, Cell) {
    let members: std::collections::BTreeSet<Cell> = chain.iter().copied().collect();
    let mut way_back = BTreeMap::from([(from, from)]);
    let mut queue = VecDeque::from([from]);
    let mut last = from;
    while let Some(cell) = queue.pop_front() {
        last = cell;
        for neighbour in cell.neighbours8() {
            if members.contains(&neighbour) && !way_back.contains_key(&neighbour) {
                way_back.insert(neighbour, cell);
                queue.push_back(neighbour);
            }
        }
    }
    (way_back, last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::GridFrame;
    use crate::navigation::inflate;
    use proptest::prelude::*;

    /// Reads a map drawn in text, the first line its top row: `.` free, `#` occupied, ` ` unknown.
    fn map(rows: &[&str]) -> OccupancyGrid {
        let (width, height) = (rows[0].len(), rows.len());
        let frame = GridFrame {
            resolution: 0.1,
            origin: Point::ZERO,
            width: i32::try_from(width).unwrap(),
            height: i32::try_from(height).unwrap(),
        };
        let cells = rows.iter().rev().flat_map(|row| row.bytes()).map(|b| match b {
            b'.' => Occupancy::Free,
            b'#' => Occupancy::Occupied,
            _ => Occupancy::Unknown,
        });
        OccupancyGrid::from_cells(frame, cells.collect())
    }

    fn find(map: &OccupancyGrid, minimum: u32) -> Vec<Frontier> {
        find_frontiers(map, &inflate(map, 1), Cell::new(2, 2), 60, minimum, Candidate::Middle)
    }

    #[test]
    fn chains_are_told_apart_and_divided_in_two() {
        let map = map(&[
            "######    ",
            "#....     ",
            "#....     ",
            "#....     ",
            "#....#### ",
            "###.####  ",
            "  #.#     ",
        ]);
        // The robot is in the doorway's column; the right edge of the room and the doorway's end are open.
        let frontiers =
            find_frontiers(&map, &inflate(&map, 1), Cell::new(2, 3), 60, 1, Candidate::Middle);
        let candidates: Vec<_> = frontiers.iter().map(|f| f.candidate).collect();
        assert_eq!(frontiers.len(), 2, "{frontiers:?}");
        let right = frontiers.iter().find(|f| f.cells.len() == 4).unwrap();
        assert!(right.cells.iter().all(|c| c.x == 4));
        assert!((3..=4).contains(&right.candidate.y), "{candidates:?}");
    }

    #[test]
    fn known_rooms_have_none_and_short_chains_can_be_left_out() {
        let closed = map(&["######", "#....#", "#....#", "######"]);
        assert!(find(&closed, 1).is_empty());
        let leak = map(&["######", "#....#", "#.... ", "######"]);
        assert_eq!(
            find_frontiers(&leak, &inflate(&leak, 1), Cell::new(2, 1), 60, 1, Candidate::Middle)
                .len(),
            1
        );
        assert!(
            find_frontiers(&leak, &inflate(&leak, 1), Cell::new(2, 1), 60, 9, Candidate::Middle)
                .is_empty()
        );
    }

    #[test]
    fn the_middle_of_a_bent_chain_is_at_its_bend_and_the_centroid_may_be_nearer_to_an_arm() {
        // An L of 5 + 4 cells, whose corner the shortest path cuts; the mean (1, 1) is one whole cell from three of
        // them.
        let mut chain: Vec<Cell> = (0..5).rev().map(|y| Cell::new(0, y)).collect();
        chain.extend((1..5).map(|x| Cell::new(x, 0)));
        assert_eq!(middle_of(&chain), Cell::new(1, 0));
        assert_eq!(nearest_to_centroid(&chain), Cell::new(0, 2), "the first within a whole cell");
        let moved: Vec<Cell> = chain.iter().map(|c| Cell::new(c.x - 7, c.y - 9)).collect();
        assert_eq!(nearest_to_centroid(&moved), Cell::new(-7, -7), "wherever the map begins");
    }

    proptest! {
        /// Checks that every frontier cell is free, reachable and next to the unknown, and that no cell is in two
        /// chains.
        #[test]
        fn frontiers_are_what_the_paper_says(raw in prop::collection::vec(0_u8..6, 144)) {
            let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 12, height: 12 };
            let cells = raw.iter().map(|&v| match v {
                0 => Occupancy::Unknown,
                1 => Occupancy::Occupied,
                _ => Occupancy::Free,
            });
            let mut map = OccupancyGrid::from_cells(frame, cells.collect());
            map.set(Cell::new(2, 2), Occupancy::Free);
            let mut seen = std::collections::BTreeSet::new();
            for frontier in find(&map, 1) {
                prop_assert!(frontier.cells.contains(&frontier.candidate));
                for &cell in &frontier.cells {
                    prop_assert!(seen.insert(cell));
                    prop_assert_eq!(map.at(cell), Occupancy::Free);
                    prop_assert!(cell.neighbours8().iter().any(|&n| map.at(n) == Occupancy::Unknown));
                }
            }
        }
    }
}
