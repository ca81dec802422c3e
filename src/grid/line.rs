//! The cells of a straight line.

use super::Cell;

/// Returns the cells of the line between the centres of `from` and `to`, both included, in order (Bresenham 1965,
/// "Algorithm for computer control of a digital plotter").
pub fn line(from: Cell, to: Cell) -> impl Iterator<Item = Cell> {
    let (dx, dy) = ((to.x - from.x).abs(), -(to.y - from.y).abs());
    let (sx, sy) = ((to.x - from.x).signum(), (to.y - from.y).signum());
    let mut error = dx + dy;
    let mut next = Some(from);
    std::iter::from_fn(move || {
        let cell = next?;
        next = (cell != to).then(|| {
            let doubled = 2 * error;
            let mut ahead = cell;
            if doubled >= dy {
                error += dy;
                ahead.x += sx;
            }
            if doubled <= dx {
                error += dx;
                ahead.y += sy;
            }
            ahead
        });
        Some(cell)
    })
}

/// The same line over a grid's indices, each step computed by itself, so that none waits for the one before.
///
/// After k steps along the longer side the line is round(k × short / long) steps across, halves up. In units of 2^-32, with
/// the slope rounded up, that is exact for lines of up to 2^15 steps.
#[derive(Debug, Clone, Copy)]
pub struct Walk {
    long: i32,
    slope: i64,
    along: isize,
    across: isize,
    is_wide: bool,
}

/// Half a step across.
const HALF: i64 = 1 << 31;

impl Walk {
    /// Creates the walk from `from` to `to` over a grid of `width` cells.
    pub fn new(from: Cell, to: Cell, width: i32) -> Self {
        let (dx, dy) = ((to.x - from.x).abs(), (to.y - from.y).abs());
        let width = isize::try_from(width).unwrap_or(0);
        let aside = if to.x < from.x { -1 } else { 1 };
        let up = if to.y < from.y { -width } else { width };
        let is_wide = dx >= dy;
        let (long, short, along, across) =
            if is_wide { (dx, dy, aside, up) } else { (dy, dx, up, aside) };
        debug_assert!(long <= 1 << 15, "longer than is exact");
        let slope = if short == 0 { 0 } else { (i64::from(short) << 32) / i64::from(long) + 1 };
        Self { long, slope, along, across, is_wide }
    }

    /// Returns the offsets of its cells from the index of the first one, but for the last one.
    pub fn offsets(self) -> impl Iterator<Item = isize> {
        self.offsets_of(0, self.long)
    }

    /// Returns the offsets of its cells from the index of the first one, from one step to before another.
    pub fn offsets_of(self, from: i32, to: i32) -> impl Iterator<Item = isize> {
        (i64::from(from)..i64::from(to)).map(move |k| {
            #[expect(clippy::cast_possible_truncation, reason = "steps are few")]
            let (k, turns) = (k as isize, ((k * self.slope + HALF) >> 32) as isize);
            k * self.along + turns * self.across
        })
    }

    /// Returns how many steps it stays within `columns` columns and `rows` rows, counted from its first cell forward, before
    /// the last one.
    pub fn steps_within(self, columns: i32, rows: i32) -> i32 {
        let (along, across) = if self.is_wide { (columns, rows) } else { (rows, columns) };
        let steps = self.long.min(along);
        let limit = (i64::from(across) << 32) - HALF;
        // Most lines do not leave aside.
        if self.slope == 0 || i64::from(steps) * self.slope <= limit {
            return steps;
        }
        let until = (limit + self.slope - 1) / self.slope;
        steps.min(i32::try_from(until).unwrap_or(i32::MAX))
    }

    /// Returns a number of first steps at each of which it is in one cell with `one` or `other`, walks from the same cell that
    /// go on for as long.
    ///
    /// Between two lines that are less than a cell apart there is no room for a third one.
    pub fn steps_between(self, one: Self, other: Self) -> i32 {
        let octant = |walk: Self| (walk.is_wide, walk.along, walk.across);
        let (low, high) = (one.slope.min(other.slope), one.slope.max(other.slope));
        let is_between = (low..=high).contains(&self.slope);
        if !is_between || octant(one) != octant(self) || octant(other) != octant(self) {
            return 0;
        }
        let apart = u32::try_from(high - low).unwrap_or(u32::MAX);
        let steps = u32::MAX.checked_div(apart).unwrap_or(u32::MAX);
        i32::try_from(steps).unwrap_or(i32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn joins_its_ends_by_neighbours(x in -40..40, y in -40..40) {
            let (from, to) = (Cell::new(3, -2), Cell::new(x, y));
            let cells: Vec<_> = line(from, to).collect();
            prop_assert_eq!(cells.first(), Some(&from));
            prop_assert_eq!(cells.last(), Some(&to));
            prop_assert_eq!(
                i32::try_from(cells.len()).unwrap(),
                (x - 3).abs().max((y + 2).abs()) + 1
            );
            prop_assert!(cells.windows(2).all(|w| w[0].neighbours8().contains(&w[1])));
        }
    }
    proptest! {
        #[test]
        fn walks_are_lines(x in -300..300_i32, y in -300..300_i32, columns in 1..400_i32, rows in 1..400_i32) {
            let (from, to) = (Cell::new(0, 0), Cell::new(x, y));
            let walk = Walk::new(from, to, 1000);
            let index = |cell: Cell| isize::try_from(cell.y * 1000 + cell.x).unwrap();
            let expected: Vec<_> = line(from, to).filter(|&cell| cell != to).map(index).collect();
            prop_assert_eq!(walk.offsets().collect::<Vec<_>>(), expected);
            let is_within = |cell: &Cell| cell.x.abs() < columns && cell.y.abs() < rows;
            let within = line(from, to).filter(|&cell| cell != to).take_while(is_within);
            let expected: Vec<_> = within.map(index).collect();
            let steps = walk.steps_within(columns, rows);
            prop_assert_eq!(walk.offsets_of(0, steps).collect::<Vec<_>>(), expected);
        }

        #[test]
        fn a_walk_between_two_is_in_their_cells_at_first(
            to in prop::collection::vec((-150..150_i32, -150..150_i32), 3), near: bool,
        ) {
            let far = |&(x, y): &(i32, i32)| if near { (x / 40 + 120, y / 40 + 70) } else { (x, y) };
            let walks: Vec<Walk> =
                to.iter().map(far).map(|(x, y)| Walk::new(Cell::new(0, 0), Cell::new(x, y), 1000)).collect();
            let steps = walks[0].steps_between(walks[1], walks[2]);
            prop_assert!(!near || steps > 0 || walks[0].slope != walks[1].slope);
            let at = |walk: usize| walks[walk].offsets_of(0, steps.min(200));
            for (cell, beside) in at(0).zip(at(1).zip(at(2))) {
                prop_assert!(cell == beside.0 || cell == beside.1);
            }
        }
    }

    #[test]
    fn the_longest_walks_are_exact() {
        let long = 1 << 15;
        for short in [1, 2, 3, 9_999, 16_383, 16_384, 16_385, 32_766, 32_767, 32_768] {
            let walk = Walk::new(Cell::new(0, 0), Cell::new(long, short), 1 << 16);
            for (k, offset) in (0..i64::from(long)).zip(walk.offsets()) {
                let rounded = (2 * k * i64::from(short) + i64::from(long)) / (2 * i64::from(long));
                assert_eq!(offset as i64, k + (rounded << 16), "{short}, {k}");
            }
        }
    }
}
