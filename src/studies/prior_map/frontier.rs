//! Frontiers and candidate locations (section 3.1):
//! 1. A flood from the robot over traversable cells finds the frontier cells.
//! 2. Frontier cells that share a side or a corner form one chain.
//! 3. Each chain that is long enough is a frontier, with its candidate location.

use crate::geometry::Point;
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use crate::navigation::CostGrid;
use crate::studies::prior_map::Candidate;

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

/// Finds frontiers, and keeps the memory that this takes.
#[derive(Debug, Default)]
pub struct FrontierFinder {
    /// A bit for every cell, numbered by a [`Ring`]: unknown ones, those that share a side or a corner with one of them, and those
    /// that the flood may enter and has not yet. Bits, as all of them are looked at in an order that leaps from row to row.
    unknown: Vec<u64>,
    beside: Vec<u64>,
    open: Vec<u64>,
    /// Memory for a row.
    flags: Vec<u8>,
    flood: Vec<u32>,
    /// How many cells of frontiers were discovered before each of them, plus one; 0 for other cells, and for all in between.
    order: Vec<u32>,
}

impl FrontierFinder {
    /// Finds the frontiers that the robot at `robot` can reach: chains of free cells "adjacent to at least an unknown
    /// cell", of those that a 4-connected flood over cells cheaper than `lethal` reaches. Two cells belong to one chain
    /// where they share a side or a corner. Chains shorter than `minimum` cells are left out.
    pub fn find(
        &mut self,
        map: &OccupancyGrid,
        costs: &CostGrid,
        robot: Cell,
        lethal: u8,
        minimum: u32,
        candidate: Candidate,
    ) -> Vec<Frontier> {
        let frame = *map.frame();
        if !frame.contains(robot) {
            return Vec::new();
        }
        let ring = Ring::around(&frame);
        // 1. The flood.
        self.mark(map, costs, lethal, ring);
        if self.order.len() != ring.len() {
            self.order = vec![0; ring.len()];
        }
        let discovered = self.discovered(robot, ring);
        for (place, &index) in (1..).zip(&discovered) {
            self.order[index] = place;
        }
        chains(discovered, &mut self.order, ring, minimum, candidate)
    }

    /// Marks cells that are open, and those beside unknown ones.
    fn mark(&mut self, map: &OccupancyGrid, costs: &CostGrid, lethal: u8, ring: Ring) {
        let (words, cells) = (ring.width / WORD, ring.cells);
        self.unknown.clear();
        // One more, so that the last one too has one after it.
        self.unknown.resize(words * ring.height + 1, u64::MAX);
        self.open.clear();
        self.open.resize(words * ring.height, 0);
        self.flags.clear();
        self.flags.resize(ring.width - WORD, 1);
        let rows = self.unknown.chunks_mut(words).skip(1).take(ring.height - 2);
        for (row, values) in rows.zip(map.values().chunks(cells)) {
            for (flag, value) in self.flags.iter_mut().zip(values) {
                *flag = u8::from(*value == Occupancy::Unknown);
            }
            pack(&self.flags, &mut row[1..]);
        }
        self.flags.fill(0);
        let rows = self.open.chunks_mut(words).skip(1).take(ring.height - 2);
        for (y, row) in (0..).zip(rows) {
            for (flag, cost) in self.flags.iter_mut().zip(costs.row(y)) {
                *flag = u8::from(*cost < lethal);
            }
            pack(&self.flags, &mut row[1..]);
        }
        let unknown = &self.unknown;
        let sides = |i: usize| {
            let (left, right) = (unknown[i] << 1 | unknown[i - 1] >> 63, unknown[i + 1] << 63);
            left | unknown[i] >> 1 | right
        };
        self.beside.clear();
        self.beside.resize(words * ring.height, 0);
        for row in 1..ring.height - 1 {
            for i in row * words + 1..(row + 1) * words {
                let (below, above) = (i - words, i + words);
                let across = sides(below) | unknown[below] | sides(above) | unknown[above];
                self.beside[i] = sides(i) | across;
            }
        }
    }

    /// Returns the cells of frontiers in the order in which the flood meets them.
    fn discovered(&mut self, robot: Cell, ring: Ring) -> Vec<usize> {
        // Whatever is looked at is written behind the others, and stays there where it is open: which it is cannot be
        // foreseen.
        self.flood.resize(ring.len() + 4, 0);
        #[expect(clippy::cast_possible_truncation, reason = "no grid has 2^32 cells")]
        let number = |index: usize| index as u32;
        let (open, flood) = (&mut self.open, &mut self.flood);
        let mut discovered = Vec::new();
        let first = ring.index(robot);
        flood[0] = number(first);
        open[first / WORD] &= !(1 << (first % WORD));
        let (mut next, mut end) = (0, 1);
        while next < end {
            let index = flood[next] as usize;
            next += 1;
            if self.beside[index / WORD] >> (index % WORD) & 1 != 0 {
                discovered.push(index);
            }
            let ahead = &mut flood[end..end + 4];
            let mut found = 0;
            for neighbour in ring.beside(index) {
                let word = &mut open[neighbour / WORD];
                ahead[found % 4] = number(neighbour);
                found += usize::from(*word >> (neighbour % WORD) & 1 != 0);
                *word &= !(1 << (neighbour % WORD));
            }
            end += found;
        }
        discovered
    }
}

/// Bits of a word.
const WORD: usize = 64;

/// Packs `flags`, each 0 or 1, into `words`, eight at a time: the product moves each to its place in the highest byte.
fn pack(flags: &[u8], words: &mut [u64]) {
    for (word, flags) in words.iter_mut().zip(flags.chunks(WORD)) {
        *word = flags.chunks_exact(8).rev().fold(0, |word, eight| {
            let eight = u64::from_le_bytes(eight.try_into().unwrap_or_default());
            word << 8 | eight.wrapping_mul(0x0102_0408_1020_4080) >> 56
        });
    }
}

/// Returns the chains of the cells `discovered`, whose `order` is told and is 0 for all cells afterwards.
fn chains(
    discovered: Vec<usize>,
    order: &mut [u32],
    ring: Ring,
    minimum: u32,
    candidate: Candidate,
) -> Vec<Frontier> {
    // 2. The chains, by the discovery of their first cells.
    let mut frontiers = Vec::new();
    for first in discovered {
        if order[first] == 0 {
            continue; // taken into an earlier chain
        }
        let mut members: Vec<(u32, usize)> = Vec::new();
        let mut next = vec![first];
        while let Some(index) = next.pop() {
            let place = std::mem::take(&mut order[index]);
            if place > 0 {
                members.push((place, index));
                next.extend(ring.around_of(index).into_iter().filter(|&n| order[n] > 0));
            }
        }
        members.sort_unstable();
        let chain: Vec<Cell> = members.iter().map(|&(_, index)| ring.cell(index)).collect();
        // 3. The candidates.
        if chain.len() >= minimum as usize {
            let candidate = match candidate {
                Candidate::Middle => middle_of(&chain, ring, order),
                Candidate::NearestToCentroid => nearest_to_centroid(&chain),
            };
            frontiers.push(Frontier { cells: chain, candidate });
        }
    }
    frontiers
}

/// The numbering of a grid's cells with a ring of further ones around them, so that every cell has its neighbours. Rows begin
/// with a word of these and have whole words, as cells are numbered for bits.
#[derive(Debug, Clone, Copy)]
struct Ring {
    /// Cells of the grid's own rows.
    cells: usize,
    width: usize,
    height: usize,
}

impl Ring {
    fn around(frame: &GridFrame) -> Self {
        let side = |cells: i32| usize::try_from(cells).unwrap_or(0);
        let cells = side(frame.width);
        let width = WORD + (cells + 1).next_multiple_of(WORD);
        Self { cells, width, height: side(frame.height) + 2 }
    }

    /// Returns the index of `cell`, which is one of the grid's.
    #[expect(clippy::cast_sign_loss, reason = "cells of the grid are not negative")]
    fn index(self, cell: Cell) -> usize {
        (cell.y as usize + 1) * self.width + cell.x as usize + WORD
    }

    fn cell(self, index: usize) -> Cell {
        let at = |along: usize| i32::try_from(along).unwrap_or(i32::MAX);
        Cell::new(at(index % self.width - WORD), at(index / self.width - 1))
    }

    /// Returns the neighbours that share a side, in the order of [`Cell::neighbours4`].
    fn beside(self, index: usize) -> [usize; 4] {
        [index + 1, index + self.width, index - 1, index - self.width]
    }

    /// Returns the neighbours that share a side or a corner, in the order of [`Cell::neighbours8`].
    fn around_of(self, index: usize) -> [usize; 8] {
        let (up, down) = (index + self.width, index - self.width);
        [index + 1, up + 1, up, up - 1, index - 1, down - 1, down, down + 1]
    }

    /// Returns how many cells it numbers.
    fn len(self) -> usize {
        self.width * self.height
    }
}

/// Returns the cell half way along the chain: half way on the shortest path, over the chain's own cells, between two of
/// its ends that are furthest apart.
///
/// `numbers` is 0 for all cells of the ring, before and after.
fn middle_of(chain: &[Cell], ring: Ring, numbers: &mut [u32]) -> Cell {
    for (number, &cell) in (1..).zip(chain) {
        numbers[ring.index(cell)] = number;
    }
    let (_, one_end) = furthest(chain, 0, ring, numbers);
    let (way_back, other_end) = furthest(chain, one_end, ring, numbers);
    for &cell in chain {
        numbers[ring.index(cell)] = 0;
    }
    let back = |&at: &usize| way_back[at].filter(|back| *back != at);
    let way: Vec<usize> = std::iter::successors(Some(other_end), back).collect();
    chain[way[way.len() / 2]]
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

/// Returns for every cell of the chain the next one back to `from`, and the cell that takes the most steps. Cells are
/// meant by their place in the chain; `numbers` tells these places, plus one, and 0 for other cells.
fn furthest(
    chain: &[Cell],
    from: usize,
    ring: Ring,
    numbers: &[u32],
) -> (Vec<Option<usize>>, usize) {
    let mut way_back = vec![None; chain.len()];
    way_back[from] = Some(from);
    let mut queue = vec![from];
    let mut next = 0;
    while let Some(&at) = queue.get(next) {
        next += 1;
        for neighbour in ring.around_of(ring.index(chain[at])) {
            if let Some(number) = (numbers[neighbour] as usize).checked_sub(1)
                && way_back[number].is_none()
            {
                way_back[number] = Some(at);
                queue.push(number);
            }
        }
    }
    (way_back, queue[queue.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::GridFrame;
    use crate::navigation::inflate;
    use proptest::prelude::*;

    /// Finds frontiers without keeping anything for the next time.
    fn find_frontiers(
        map: &OccupancyGrid,
        costs: &CostGrid,
        robot: Cell,
        lethal: u8,
        minimum: u32,
        candidate: Candidate,
    ) -> Vec<Frontier> {
        FrontierFinder::default().find(map, costs, robot, lethal, minimum, candidate)
    }

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
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 5, height: 5 };
        let ring = Ring::around(&frame);
        let mut numbers = vec![0; ring.len()];
        assert_eq!(middle_of(&chain, ring, &mut numbers), Cell::new(1, 0));
        assert!(numbers.iter().all(|number| *number == 0));
        assert_eq!(nearest_to_centroid(&chain), Cell::new(0, 2), "the first within a whole cell");
        let moved: Vec<Cell> = chain.iter().map(|c| Cell::new(c.x - 7, c.y - 9)).collect();
        assert_eq!(nearest_to_centroid(&moved), Cell::new(-7, -7), "wherever the map begins");
    }

    /// Finds the cells of frontiers, chain by chain, as the description reads.
    fn by_the_book(
        map: &OccupancyGrid,
        costs: &CostGrid,
        robot: Cell,
        lethal: u8,
    ) -> Vec<Vec<Cell>> {
        let is_beside_unknown =
            |cell: Cell| cell.neighbours8().iter().any(|&n| map.at(n) == Occupancy::Unknown);
        let mut flood = vec![robot];
        let mut next = 0;
        while next < flood.len() {
            for cell in flood[next].neighbours4() {
                if costs.is_below(cell, lethal) && !flood.contains(&cell) {
                    flood.push(cell);
                }
            }
            next += 1;
        }
        let mut left: Vec<Cell> =
            flood.into_iter().filter(|&cell| is_beside_unknown(cell)).collect();
        let order = left.clone();
        let mut chains = Vec::new();
        while !left.is_empty() {
            let mut chain = vec![left.remove(0)];
            let mut next = 0;
            while next < chain.len() {
                let is_near = |cell: &Cell| chain[next].neighbours8().contains(cell);
                let (near, far): (Vec<Cell>, Vec<Cell>) =
                    left.iter().partition(|cell| is_near(cell));
                chain.extend(near);
                left = far;
                next += 1;
            }
            chain.sort_by_key(|cell| order.iter().position(|other| other == cell));
            chains.push(chain);
        }
        chains
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
            let costs = inflate(&map, 1);
            let found: Vec<_> = find(&map, 1).into_iter().map(|frontier| frontier.cells).collect();
            prop_assert_eq!(found, by_the_book(&map, &costs, Cell::new(2, 2), 60));
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
