//! Which cells see each other: exactly, in integers.
//!
//! A cell is visible where the segment between the two centres touches no blocking cell (cells are closed
//! squares). Seen from the origin cell, the square of column c and row d ≥ 1 hides the slopes (column per
//! row) from its one corner to the other: of cells in later rows all of
//! [(c - ½) / (d ± ½), (c + ½) / (d ∓ ½)], of cells in its own row only what lies before the row's middle.
//! Each quadrant is swept row by row, keeping the slopes hidden so far as a sorted list of intervals.

use super::Cell;
use std::cmp::Ordering;

/// Calls `see` with every cell within `radius` cells of `origin` (Euclidean, centres) that is visible from it
/// past the cells that are `blocking`, the origin itself included. Blocking cells are not visible; a blocking
/// origin still sees.
pub fn visible_cells(
    origin: Cell,
    radius: i32,
    blocking: impl Fn(Cell) -> bool,
    mut see: impl FnMut(Cell),
) {
    see(origin);
    // The four quadrants: (column, row) to the two axes.
    for (column, row) in
        [((1, 0), (0, 1)), ((0, -1), (1, 0)), ((-1, 0), (0, -1)), ((0, 1), (-1, 0))]
    {
        let cell = |c: i32, d: i32| {
            Cell::new(origin.x + c * column.0 + d * row.0, origin.y + c * column.1 + d * row.1)
        };
        sweep(radius, |c, d| blocking(cell(c, d)), |c, d| see(cell(c, d)));
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

/// A closed interval of hidden slopes.
#[derive(Debug, Clone, Copy)]
struct Shadow {
    low: Slope,
    high: Slope,
}

impl Shadow {
    fn hides_the_quadrant(&self) -> bool {
        self.low.at_most(Slope { over: -1, under: 1 })
            && Slope { over: 1, under: 1 }.at_most(self.high)
    }
}

/// One quadrant: rows 1..=radius, columns -row < c <= row (each diagonal belongs to one quadrant).
fn sweep(radius: i32, blocking: impl Fn(i32, i32) -> bool, mut see: impl FnMut(i32, i32)) {
    let mut earlier: Vec<Shadow> = Vec::new();
    // The neighbours beside the origin touch the diagonals with a corner.
    for side in [-1, 1] {
        if blocking(side, 0) {
            let corner = Slope { over: side, under: 1 };
            add(&mut earlier, Shadow { low: corner, high: corner });
        }
    }
    let (mut before, mut whole) = (Vec::new(), Vec::new());
    for row in 1..=radius {
        if earlier.first().is_some_and(Shadow::hides_the_quadrant) {
            return;
        }
        before.clear();
        whole.clear();
        // Squares just outside of the quadrant reach into it with a corner.
        for column in -row - 1..=row + 1 {
            if blocking(column, row) {
                // Doubled coordinates keep corners whole.
                let (near, middle, far) = (2 * row - 1, 2 * row, 2 * row + 1);
                let (left, right) = (2 * column - 1, 2 * column + 1);
                let low = |inner| Slope { over: left, under: if left < 0 { near } else { inner } };
                let high =
                    |inner| Slope { over: right, under: if right > 0 { near } else { inner } };
                before.push(Shadow { low: low(middle), high: high(middle) });
                whole.push(Shadow { low: low(far), high: high(far) });
            }
        }
        let half_width = row.min((radius * radius - row * row).max(0).isqrt());
        let (mut hidden_earlier, mut hidden_here) = (Sorted(&earlier), Sorted(&before));
        for column in (-half_width).max(1 - row)..=half_width {
            let slope = Slope { over: column, under: row };
            // Both lists must move along, whatever the other says.
            let hidden = [hidden_earlier.hide(slope), hidden_here.hide(slope)];
            if hidden == [false, false] {
                see(column, row);
            }
        }
        for &shadow in &whole {
            add(&mut earlier, shadow);
        }
    }
}

/// Shadows in ascending order, asked in ascending order of slope.
struct Sorted<'a>(&'a [Shadow]);

impl Sorted<'_> {
    fn hide(&mut self, slope: Slope) -> bool {
        while self.0.first().is_some_and(|s| s.high.compare(slope) == Ordering::Less) {
            self.0 = &self.0[1..];
        }
        self.0.first().is_some_and(|s| s.low.at_most(slope))
    }
}

/// Adds a shadow to the sorted list, merging what it meets.
fn add(shadows: &mut Vec<Shadow>, mut new: Shadow) {
    let first = shadows.partition_point(|s| s.high.compare(new.low) == Ordering::Less);
    let mut end = first;
    while end < shadows.len() && shadows[end].low.at_most(new.high) {
        if shadows[end].low.compare(new.low) == Ordering::Less {
            new.low = shadows[end].low;
        }
        if shadows[end].high.compare(new.high) == Ordering::Greater {
            new.high = shadows[end].high;
        }
        end += 1;
    }
    shadows.splice(first..end, [new]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// Whether the segment from the origin to the centre of `to` touches the closed square of `cell`, by
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
