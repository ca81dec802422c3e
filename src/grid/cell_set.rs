//! Sets of cells as bits, read in runs along rows and along columns.

use super::Cell;

/// Bits of a word.
const WORD: i32 = 64;

/// The axis along which a run of cells goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Along x: cells of one row.
    X,
    /// Along y: cells of one column.
    Y,
}

/// Cells of one row or column, side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The axis along which it goes.
    pub axis: Axis,
    /// The row (along x) or column (along y) of which it is part.
    pub line: i32,
    /// Its first cell along the axis.
    pub from: i32,
    /// Its last one, included.
    pub to: i32,
}

impl Run {
    /// Returns the cell `along` the axis.
    pub fn cell(&self, along: i32) -> Cell {
        match self.axis {
            Axis::X => Cell::new(along, self.line),
            Axis::Y => Cell::new(self.line, along),
        }
    }
}

/// A set of cells within a rectangle; outside of it no cell is a member.
#[derive(Debug, Clone)]
pub struct CellSet {
    by_row: Lines,
    by_column: Lines,
}

/// Bits along one axis.
#[derive(Debug, Clone)]
struct Lines {
    /// First coordinate along the lines, a multiple of the word's size, and the first line's number.
    start: i32,
    first: i32,
    words: i32,
    count: i32,
    bits: Vec<u64>,
}

impl CellSet {
    /// Returns the largest multiple of the word's size that is not above `coordinate`: where words begin.
    pub fn word_start(coordinate: i32) -> i32 {
        coordinate.div_euclid(WORD) * WORD
    }

    /// Creates the set of cells from `low` to `high` (included, rounded outwards to whole words) whose members `word`
    /// gives: bit i of `word(x, y)`, x the start of a word, is the cell (x + i, y).
    pub fn of_words(low: Cell, high: Cell, mut word: impl FnMut(i32, i32) -> u64) -> Self {
        let (x, y) = (Self::word_start(low.x), Self::word_start(low.y));
        let words = (Self::word_start(high.x) - x) / WORD + 1;
        let blocks = (Self::word_start(high.y) - y) / WORD + 1;
        let mut by_row = Lines::empty(x, y, words, blocks * WORD);
        for row in 0..by_row.count {
            for column in 0..words {
                let index = by_row.index(column, row);
                by_row.bits[index] = word(x + column * WORD, y + row);
            }
        }
        let mut by_column = Lines::empty(y, x, blocks, words * WORD);
        let mut block = [0_u64; 64];
        for tall in 0..blocks {
            for wide in 0..words {
                for (row, bits) in (0..).zip(&mut block) {
                    *bits = by_row.bits[by_row.index(wide, tall * WORD + row)];
                }
                // Most blocks are all of one kind.
                if block.iter().any(|bits| *bits != block[0]) || !matches!(block[0], 0 | u64::MAX) {
                    transpose(&mut block);
                }
                for (column, bits) in (0..).zip(&block) {
                    let index = by_column.index(tall, wide * WORD + column);
                    by_column.bits[index] = *bits;
                }
            }
        }
        Self { by_row, by_column }
    }

    /// Returns the word that begins at the cell (`x`, `y`), `x` where words begin; `None` outside of the rectangle.
    pub fn word(&self, x: i32, y: i32) -> Option<u64> {
        let rows = &self.by_row;
        let (word, line) = ((x - rows.start) / WORD, y - rows.first);
        let is_within = x >= rows.start && word < rows.words && (0..rows.count).contains(&line);
        is_within.then(|| rows.bits[rows.index(word, line)])
    }

    /// Returns whether `run` has any member.
    pub fn has_any(&self, run: Run) -> bool {
        let mut any = false;
        self.lines(run.axis).words_of(run, |_, _| any = true);
        any
    }

    /// Counts the members among the cells of `run`.
    pub fn count(&self, run: Run) -> u32 {
        let mut count = 0;
        self.lines(run.axis).words_of(run, |_, bits| count += bits.count_ones());
        count
    }

    /// Adds the coordinates of the members of `run` along its axis to `members`, in ascending order.
    pub fn members(&self, run: Run, members: &mut Vec<i32>) {
        self.lines(run.axis).words_of(run, |start, mut bits| {
            while bits != 0 {
                members.push(start + bits.trailing_zeros().cast_signed());
                bits &= bits - 1;
            }
        });
    }

    /// Adds the first and the last coordinate of the members of `run` that are side by side to `runs`, which is
    /// empty, in ascending order.
    pub fn runs(&self, run: Run, runs: &mut Vec<(i32, i32)>) {
        self.lines(run.axis).words_of(run, |start, mut bits| {
            while bits != 0 {
                let first = bits.trailing_zeros();
                let length = (!(bits >> first)).trailing_zeros();
                let from = start + first.cast_signed();
                let to = from + length.cast_signed() - 1;
                match runs.last_mut() {
                    Some(last) if last.1 + 1 == from => last.1 = to,
                    _ => runs.push((from, to)),
                }
                // Adding to the lowest bit carries through all beside it.
                bits &= bits.wrapping_add(1 << first);
            }
        });
    }

    fn lines(&self, axis: Axis) -> &Lines {
        match axis {
            Axis::X => &self.by_row,
            Axis::Y => &self.by_column,
        }
    }
}

impl Lines {
    fn empty(start: i32, first: i32, words: i32, count: i32) -> Self {
        let len = usize::try_from(words * count).unwrap_or(0);
        Self { start, first, words, count, bits: vec![0; len] }
    }

    fn index(&self, word: i32, line: i32) -> usize {
        #[expect(clippy::cast_sign_loss, reason = "asked for within the rectangle only")]
        let index = (line * self.words + word) as usize;
        index
    }

    /// Passes to `tell` the words of `run` that have members: where each begins, and its members.
    fn words_of(&self, run: Run, mut tell: impl FnMut(i32, u64)) {
        let line = run.line - self.first;
        let (from, to) =
            ((run.from - self.start).max(0), (run.to - self.start).min(self.words * WORD - 1));
        if !(0..self.count).contains(&line) || from > to {
            return;
        }
        for word in from / WORD..=to / WORD {
            let mut bits = self.bits[self.index(word, line)];
            if word == from / WORD {
                bits &= u64::MAX << (from % WORD);
            }
            if word == to / WORD {
                bits &= u64::MAX >> (WORD - 1 - to % WORD);
            }
            if bits != 0 {
                tell(self.start + word * WORD, bits);
            }
        }
    }
}

/// Exchanges rows and columns of a square of bits (Warren 2012, "Hacker's Delight", section 7-3).
fn transpose(block: &mut [u64; 64]) {
    let (mut width, mut mask) = (32, 0x0000_0000_ffff_ffff_u64);
    while width > 0 {
        let mut row = 0;
        while row < 64 {
            let swapped = ((block[row] >> width) ^ block[row + width]) & mask;
            block[row] ^= swapped << width;
            block[row + width] ^= swapped;
            row = (row + width + 1) & !width;
        }
        width >>= 1;
        mask ^= mask << width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Checks that along rows and along columns, runs hold the set's own members.
        #[test]
        fn runs_tell_members(
            cells in prop::collection::btree_set((-90..=90_i32, -70..=70_i32), 0..200),
            line in -130..130_i32, from in -140..140_i32, length in 0..200_i32,
        ) {
            let set = CellSet::of_words(Cell::new(-90, -70), Cell::new(90, 70), |x, y| {
                (0..64).filter(|i| cells.contains(&(x + i, y))).fold(0, |bits, i| bits | 1 << i)
            });
            for axis in [Axis::X, Axis::Y] {
                let run = Run { axis, line, from, to: from + length };
                let inside: BTreeSet<Cell> = (run.from..=run.to)
                    .map(|along| run.cell(along))
                    .filter(|cell| cells.contains(&(cell.x, cell.y)))
                    .collect();
                let mut members = Vec::new();
                set.members(run, &mut members);
                prop_assert!(members.windows(2).all(|w| w[0] < w[1]));
                let found: BTreeSet<Cell> = members.iter().map(|&along| run.cell(along)).collect();
                prop_assert_eq!(set.count(run) as usize, inside.len());
                prop_assert_eq!(set.has_any(run), !inside.is_empty());
                let word = set.word(CellSet::word_start(from), line);
                let starts = CellSet::word_start(from);
                let expected = (0..64).filter(|i| cells.contains(&(starts + i, line))).fold(0, |bits, i| bits | 1 << i);
                prop_assert_eq!(word.unwrap_or(0), expected);
                let mut runs = Vec::new();
                set.runs(run, &mut runs);
                prop_assert!(runs.windows(2).all(|w| w[0].1 + 1 < w[1].0));
                let along: Vec<i32> = runs.iter().flat_map(|&(first, last)| first..=last).collect();
                prop_assert_eq!(along, members);
                prop_assert_eq!(found, inside);
            }
        }
    }
}
