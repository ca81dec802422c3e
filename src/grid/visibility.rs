//! Mutual visibility of cells: exactly, in integers.
//!
//! A cell is visible where the segment between the two centres touches no blocking cell (cells are closed squares).
//! From the origin cell, the square of column c and row d ≥ 1 hides the slopes (column per row) from one of its
//! corners to another: of cells in later rows all of [(c - ½) / (d ± ½), (c + ½) / (d ∓ ½)], of cells in its own row only what
//! lies before the row's middle.
//!
//! Each quadrant is swept row by row, keeping the slopes hidden so far as a sorted list of intervals:
//! 1. Blocking neighbours beside the origin touch the diagonals with a corner: two first intervals.
//! 2. Stop where one interval hides the whole quadrant.
//! 3. In each gap between the intervals, find the blocking squares of the row that reach into it: those side by side as one.
//! 4. Report the cells of the gap that the squares of their own row leave visible.
//! 5. Add the squares' shadows to the intervals, whose ends go on to the next row by sums (Bresenham 1965), without dividing.

use super::{Axis, Cell, CellSet, Run};
use std::cmp::Ordering;

/// Calls `see` with all cells within `radius` cells of `origin` (Euclidean, centres) that are visible from it
/// past the cells that are `blocking`, the origin itself included, in runs that do not overlap. Blocking cells are not
/// visible; a blocking origin still sees.
pub fn visible_runs(origin: Cell, radius: i32, blocking: &CellSet, see: impl FnMut(Run)) {
    examine_runs(origin, radius, blocking, |_| (), see);
}

/// Does the same, and calls `examine` with the runs of cells on which it depends: as long as none of them becomes blocking or
/// ceases to be, the same cells are visible. These are among them; runs may overlap.
pub fn examine_runs(
    origin: Cell,
    radius: i32,
    blocking: &CellSet,
    mut examine: impl FnMut(Run),
    mut see: impl FnMut(Run),
) {
    let own = Run { axis: Axis::X, line: origin.y, from: origin.x, to: origin.x };
    examine(own);
    see(own);
    for quadrant in 0..QUADRANTS {
        examine_quadrant(quadrant, origin, radius, blocking, &mut examine, &mut see);
    }
}

/// How many quadrants a disc has.
pub const QUADRANTS: usize = 4;

/// Does the same for one quadrant of the disc, counted from the upper one counter-clockwise; the origin is in none.
pub fn examine_quadrant(
    quadrant: usize,
    origin: Cell,
    radius: i32,
    blocking: &CellSet,
    mut examine: impl FnMut(Run),
    mut see: impl FnMut(Run),
) {
    let (axis, columns, rows) =
        [(Axis::X, 1, 1), (Axis::Y, -1, 1), (Axis::X, -1, -1), (Axis::Y, 1, -1)][quadrant];
    let quadrant = Quadrant { origin, axis, columns, rows };
    let blocks = |row, from, to, found: &mut Vec<(i32, i32)>| {
        let run = quadrant.run(row, from, to);
        examine(run);
        found.clear();
        blocking.runs(run, found);
        quadrant.to_columns(found);
    };
    sweep(radius, blocks, |row, from, to| see(quadrant.run(row, from, to)));
}

/// One of four quadrants: its columns and rows count along the two axes, up or down.
#[derive(Debug, Clone, Copy)]
struct Quadrant {
    origin: Cell,
    /// The axis of its columns.
    axis: Axis,
    columns: i32,
    rows: i32,
}

impl Quadrant {
    /// Returns the coordinates of the origin along the axis and across it.
    fn start(&self) -> (i32, i32) {
        match self.axis {
            Axis::X => (self.origin.x, self.origin.y),
            Axis::Y => (self.origin.y, self.origin.x),
        }
    }

    fn run(&self, row: i32, from: i32, to: i32) -> Run {
        let (along, across) = self.start();
        let ends = [along + self.columns * from, along + self.columns * to];
        Run {
            axis: self.axis,
            line: across + self.rows * row,
            from: ends[0].min(ends[1]),
            to: ends[0].max(ends[1]),
        }
    }

    /// Converts first and last coordinates along the axis to columns, still ascending.
    fn to_columns(self, found: &mut [(i32, i32)]) {
        let (along, _) = self.start();
        for (first, last) in &mut *found {
            let columns = [(*first - along) * self.columns, (*last - along) * self.columns];
            (*first, *last) = (columns[0].min(columns[1]), columns[0].max(columns[1]));
        }
        if self.columns < 0 {
            found.reverse();
        }
    }
}

/// A slope, columns per row, as a fraction with a positive denominator.
#[derive(Debug, Clone, Copy)]
struct Slope {
    over: i32,
    under: i32,
}

impl Slope {
    fn compare(self, other: Self) -> Ordering {
        (i64::from(self.over) * i64::from(other.under))
            .cmp(&(i64::from(other.over) * i64::from(self.under)))
    }

    fn at_most(self, other: Self) -> bool {
        self.compare(other) != Ordering::Greater
    }
}

/// A slope and where it is in the present row.
#[derive(Debug, Clone, Copy)]
struct Edge {
    slope: Slope,
    /// The last column that is not beyond the slope, and how far that is beyond it, in parts of the slope's denominator.
    column: i32,
    rest: i32,
    /// What a row adds to both.
    columns: i32,
    rests: i32,
}

impl Edge {
    fn new(slope: Slope, row: i32) -> Self {
        let Slope { over, under } = slope;
        Self {
            slope,
            column: (over * row).div_euclid(under),
            rest: (over * row).rem_euclid(under),
            columns: over.div_euclid(under),
            rests: over.rem_euclid(under),
        }
    }

    /// Goes on to the next row.
    fn advance(&mut self) {
        self.rest += self.rests;
        let carry = i32::from(self.rest >= self.slope.under);
        self.rest -= carry * self.slope.under;
        self.column += self.columns + carry;
    }

    /// Returns the first column that is not before the slope.
    fn ceil(&self) -> i32 {
        self.column + i32::from(self.rest > 0)
    }
}

/// A closed interval of hidden slopes.
#[derive(Debug, Clone, Copy)]
struct Shadow {
    low: Edge,
    high: Edge,
}

impl Shadow {
    fn hides_the_quadrant(&self) -> bool {
        self.low.slope.at_most(Slope { over: -1, under: 1 })
            && Slope { over: 1, under: 1 }.at_most(self.high.slope)
    }
}

/// Sweeps one quadrant: rows 1..=radius, columns -row < c <= row (each diagonal belongs to one quadrant). `blocks`
/// finds the blocking columns of a row from one column to another: the first and the last of each that are side by side, in
/// ascending order.
///
/// Only the gaps between shadows are examined: a square within a shadow adds none.
fn sweep(
    radius: i32,
    mut blocks: impl FnMut(i32, i32, i32, &mut Vec<(i32, i32)>),
    mut see: impl FnMut(i32, i32, i32),
) {
    let mut earlier: Vec<Shadow> = Vec::new();
    let (mut found, mut whole) = (Vec::new(), Vec::new());
    // 1. The neighbours beside the origin touch the diagonals with a corner.
    for side in [-1, 1] {
        blocks(0, side, side, &mut found);
        if !found.is_empty() {
            let corner = Edge::new(Slope { over: side, under: 1 }, 1);
            add(&mut earlier, Shadow { low: corner, high: corner });
        }
    }
    for row in 1..=radius {
        // 2. Nothing is visible any more.
        if earlier.first().is_some_and(Shadow::hides_the_quadrant) {
            return;
        }
        let half_width = row.min((radius * radius - row * row).max(0).isqrt());
        let (low, high) = ((-half_width).max(1 - row), half_width);
        // 3. Squares just outside of the quadrant, or of the disc, reach into it with a corner.
        let reach = (half_width + MARGIN).min(row + 1);
        whole.clear();
        let mut before = None;
        for i in 0..=earlier.len() {
            let after = earlier.get(i).map(|shadow| shadow.low.ceil());
            let first = before.map_or(-reach, |column: i32| (column - MARGIN).max(-reach));
            let last = after.map_or(reach, |column| (column + MARGIN).min(reach));
            let mut from = before.map_or(low, |column: i32| (column + 1).max(low));
            let to = after.map_or(high, |column| (column - 1).min(high));
            before = earlier.get(i).map(|shadow| shadow.high.column);
            if first > last {
                continue;
            }
            blocks(row, first, last, &mut found);
            for &(first, last) in &found {
                whole.push(shadow(first, last, row));
                // 4. Of its own row a square hides what lies before the row's middle: itself, and the diagonal beside it.
                let seen = (first - 1).min(to);
                if from <= seen {
                    see(row, from, seen);
                }
                from = from.max(if last == row - 1 { row + 1 } else { last + 1 });
            }
            if from <= to {
                see(row, from, to);
            }
        }
        // 5. The shadows of this row hold from the next one on.
        for shadow in &mut earlier {
            shadow.low.advance();
            shadow.high.advance();
        }
        for &shadow in &whole {
            add(&mut earlier, shadow);
        }
    }
}

/// What a square hides of later rows reaches less than this many columns beyond its own.
const MARGIN: i32 = 3;

/// Returns the slopes that the squares of `row` from the column `first` to `last` hide of later rows, from the next one on.
fn shadow(first: i32, last: i32, row: i32) -> Shadow {
    // Doubled coordinates keep corners whole.
    let (near, far) = (2 * row - 1, 2 * row + 1);
    let (left, right) = (2 * first - 1, 2 * last + 1);
    let low = Slope { over: left, under: if left < 0 { near } else { far } };
    let high = Slope { over: right, under: if right > 0 { near } else { far } };
    Shadow { low: Edge::new(low, row + 1), high: Edge::new(high, row + 1) }
}

/// Adds a shadow to the sorted list, merging what it meets.
fn add(shadows: &mut Vec<Shadow>, mut new: Shadow) {
    let is_before = |a: &Edge, b: &Edge| a.slope.compare(b.slope) == Ordering::Less;
    let first = shadows.partition_point(|s| is_before(&s.high, &new.low));
    let mut end = first;
    while end < shadows.len() && shadows[end].low.slope.at_most(new.high.slope) {
        if is_before(&shadows[end].low, &new.low) {
            new.low = shadows[end].low;
        }
        if is_before(&new.high, &shadows[end].high) {
            new.high = shadows[end].high;
        }
        end += 1;
    }
    if end == first + 1 {
        shadows[first] = new;
    } else {
        shadows.splice(first..end, [new]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// Returns whether the segment from the origin to the centre of `to` touches the closed square of `cell`, by
    /// separating axes, in half cells.
    fn touches(to: Cell, cell: Cell) -> bool {
        let (tx, ty) = (2 * to.x, 2 * to.y);
        let (x0, x1, y0, y1) = (2 * cell.x - 1, 2 * cell.x + 1, 2 * cell.y - 1, 2 * cell.y + 1);
        if tx.max(0) < x0 || tx.min(0) > x1 || ty.max(0) < y0 || ty.min(0) > y1 {
            return false;
        }
        let sides = [(x0, y0), (x0, y1), (x1, y0), (x1, y1)].map(|(x, y)| tx * y - ty * x);
        sides.iter().any(|&s| s <= 0) && sides.iter().any(|&s| s >= 0)
    }

    fn brute_force(radius: i32, blocked: &BTreeSet<Cell>) -> BTreeSet<Cell> {
        let origin = Cell::new(0, 0);
        let mut seen = BTreeSet::from([origin]);
        for x in -radius..=radius {
            for y in -radius..=radius {
                let to = Cell::new(x, y);
                let near = x * x + y * y <= radius * radius && to != origin;
                if near && blocked.iter().all(|&b| b == origin || !touches(to, b)) {
                    seen.insert(to);
                }
            }
        }
        seen
    }

    fn visible_cells(
        origin: Cell,
        radius: i32,
        blocking: impl Fn(Cell) -> bool,
        mut see: impl FnMut(Cell),
    ) {
        let reach = radius + 4;
        let (low, high) = (
            Cell::new(origin.x - reach, origin.y - reach),
            Cell::new(origin.x + reach, origin.y + reach),
        );
        let set = CellSet::of_words(low, high, |x, y| {
            (0..64).filter(|i| blocking(Cell::new(x + i, y))).fold(0, |bits, i| bits | 1 << i)
        });
        visible_runs(origin, radius, &set, |run| {
            for along in run.from..=run.to {
                see(run.cell(along));
            }
        });
    }

    proptest! {
        #[test]
        fn equals_brute_force(raw in prop::collection::btree_set((-9..=9, -9..=9), 0..60), radius in 0..10) {
            let blocked: BTreeSet<Cell> = raw.into_iter().map(|(x, y)| Cell::new(x, y)).collect();
            let mut seen = BTreeSet::new();
            let mut visits = 0;
            visible_cells(Cell::new(0, 0), radius, |c| blocked.contains(&c), |c| {
                seen.insert(c);
                visits += 1;
            });
            prop_assert_eq!(visits, seen.len(), "each cell is told once");
            prop_assert_eq!(&seen, &brute_force(radius, &blocked));
        }
    }

    proptest! {
        /// Checks that what is visible depends on nothing but the cells that are said to decide it, and that it is among
        /// them.
        #[test]
        fn only_examined_cells_matter(
            raw in prop::collection::btree_set((-12..=12, -12..=12), 0..60),
            others in prop::collection::btree_set((-12..=12, -12..=12), 0..60),
            radius in 0..10,
        ) {
            let cells = |raw: &BTreeSet<(i32, i32)>| -> BTreeSet<Cell> {
                raw.iter().map(|&(x, y)| Cell::new(x, y)).collect()
            };
            let look = |blocked: &BTreeSet<Cell>| {
                let set = CellSet::of_words(Cell::new(-20, -20), Cell::new(20, 20), |x, y| {
                    (0..64).filter(|i| blocked.contains(&Cell::new(x + i, y))).fold(0, |bits, i| bits | 1 << i)
                });
                let (mut examined, mut seen) = (BTreeSet::new(), BTreeSet::new());
                let cells = |run: Run| (run.from..=run.to).map(move |along| run.cell(along));
                examine_runs(Cell::new(0, 0), radius, &set, |run| examined.extend(cells(run)), |run| {
                    seen.extend(cells(run));
                });
                (examined, seen)
            };
            let blocked = cells(&raw);
            let (examined, seen) = look(&blocked);
            prop_assert!(seen.is_subset(&examined));
            let elsewhere = cells(&others).into_iter().filter(|cell| !examined.contains(cell));
            let changed: BTreeSet<Cell> = blocked.symmetric_difference(&elsewhere.collect()).copied().collect();
            prop_assert_eq!(look(&changed), (examined, seen));
        }
    }

    #[test]
    fn sight_is_mutual_and_moves_with_the_origin() {
        let wall = |c: Cell| c.x == 105 && c.y != 203;
        let sees = |a: Cell, b: Cell| {
            let mut seen = false;
            visible_cells(a, 40, wall, |c| seen |= c == b);
            seen
        };
        for y in 190..220 {
            let (a, b) = (Cell::new(100, 200), Cell::new(110, y));
            assert_eq!(sees(a, b), sees(b, a), "{y}");
        }
        assert!(sees(Cell::new(100, 203), Cell::new(110, 203)), "through the gap");
    }
}
