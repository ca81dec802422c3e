//! A square of a particle's map: for each cell the mean of the beam ends in it, and for each quarter of each cell the
//! nearest of these means.
//!
//! Lengths are whole units, 1/256 of a cell (0.2 mm for cells of 5 cm), so that sums do not depend on their order; means
//! are kept to 1/32 of a cell, a step.

use crate::geometry::Point;

/// Units in a cell, as a power of two.
pub(super) const CELL_BITS: u32 = 8;
/// Units in a side of a quarter, as a power of two.
pub(super) const QUARTER_BITS: u32 = CELL_BITS - 1;
/// Units in a step, as a power of two.
pub(super) const STEP_BITS: u32 = 3;
/// Steps in a side of a cell, and of a quarter.
pub(super) const STEPS: i32 = 1 << (CELL_BITS - STEP_BITS);
pub(super) const QUARTER_STEPS: i32 = STEPS / 2;
/// Cells in a side of a tile, as a power of two.
pub(super) const TILE_BITS: u32 = 4;
/// Quarters in a side of a tile, as a power of two.
pub(super) const SIDE_BITS: u32 = TILE_BITS + 1;
const CELLS: usize = 1 << (2 * TILE_BITS);
const QUARTERS: usize = 1 << (2 * SIDE_BITS);
/// Quarters beyond the last one, which are never looked at: a row of them may be read in one go.
const SPARE: usize = 8;

/// A place in units from the map frame's origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Place {
    pub(super) x: i32,
    pub(super) y: i32,
}

impl Place {
    /// Returns the place nearest to `point` (m) where a metre has `scale` units.
    pub(super) fn of(point: Point, scale: f64) -> Self {
        Self { x: units(point.x, scale), y: units(point.y, scale) }
    }

    /// Returns the place moved by `by`. Wraps around far outside of any building.
    pub(super) fn plus(self, by: Self) -> Self {
        Self { x: self.x.wrapping_add(by.x), y: self.y.wrapping_add(by.y) }
    }

    /// Returns the cell that holds the place.
    pub(super) fn cell(self) -> [i32; 2] {
        [self.x >> CELL_BITS, self.y >> CELL_BITS]
    }
}

/// Returns the whole number of units nearest to `v` (m) where a metre has `scale`, halves rounded up. Saturates, 400 km
/// from the origin.
///
/// Without a branch or a conversion, so that several are computed at once: added to 1.5 * 2^52, a number is rounded to
/// its nearest whole one, which then stands in the low bits.
#[expect(clippy::cast_possible_truncation, reason = "the low bits are meant")]
pub(super) fn units(v: f64, scale: f64) -> i32 {
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    const LOW: f64 = i32::MIN as f64;
    const HIGH: f64 = i32::MAX as f64;
    let units = v * scale + 0.5;
    let units = if units < LOW { LOW } else { units };
    let units = if units > HIGH { HIGH } else { units };
    let nearest = units + WHOLE;
    let down = if nearest - WHOLE > units { 1.0 } else { 0.0 };
    (nearest - down).to_bits() as i32
}

/// Beams that ended in a cell: their number, and the sums of their ends, in units from the cell's corner. At 255 the
/// mean is settled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Hits {
    x: u16,
    y: u16,
    count: u8,
}

impl Hits {
    const NONE: Self = Self { x: 0, y: 0, count: 0 };

    /// Returns whether no further hit counts.
    pub(super) fn is_settled(self) -> bool {
        self.count == u8::MAX
    }

    /// Takes in one more hit, at `place`.
    pub(super) fn take(&mut self, place: Place) {
        if self.is_settled() {
            return;
        }
        #[expect(clippy::cast_sign_loss, reason = "masked")]
        let within = |v: i32| (v & ((1 << CELL_BITS) - 1)) as u16;
        self.x += within(place.x);
        self.y += within(place.y);
        self.count += 1;
    }

    /// Computes the mean.
    #[expect(clippy::cast_possible_truncation, reason = "a mean of what is below 256, in steps")]
    pub(super) fn mean(self) -> Mean {
        if self.count == 0 {
            return Mean::NONE;
        }
        let count = u16::from(self.count);
        Mean([self.x, self.y].map(|sum| ((sum / count) >> STEP_BITS) as u8))
    }
}

/// The step that holds the mean of a cell's hits, from the cell's corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mean([u8; 2]);

impl Mean {
    pub(super) const NONE: Self = Self([u8::MAX; 2]);

    /// Returns the steps along x and y; `None` before the first hit.
    pub(super) fn steps(self) -> Option<[i32; 2]> {
        (self != Self::NONE).then(|| self.0.map(i32::from))
    }
}

/// Steps along x and y that stand for "no mean near".
const NONE_STEPS: i8 = -100;

/// The position of a mean, in steps from a quarter's corner: x in the low byte, y in the high one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Offset(u16);

impl Offset {
    /// Stands for "no mean near": further away than any window's diagonal, and near enough for 16 bits.
    pub(super) const NONE: Self = Self(u16::from_le_bytes([NONE_STEPS.cast_unsigned(); 2]));

    /// Converts steps; they fit, being those of a mean within the largest window.
    #[expect(clippy::cast_possible_truncation, reason = "at most 3 cells of 32 steps")]
    pub(super) fn new([x, y]: [i32; 2]) -> Self {
        Self(u16::from_le_bytes([x as i8, y as i8].map(i8::cast_unsigned)))
    }

    /// Returns the steps.
    pub(super) fn steps(self) -> [i32; 2] {
        self.0.to_le_bytes().map(|v| i32::from(v.cast_signed()))
    }

    /// Returns both bytes as they are held.
    pub(super) const fn bits(self) -> u16 {
        self.0
    }

    /// Returns the offset of which these are the bytes.
    pub(super) const fn of_bits(bits: u16) -> Self {
        Self(bits)
    }

    /// Ranks the mean: lower is nearer to the middle of the quarter. The offset itself decides between equally near ones, so
    /// that the nearest does not depend on the order of arrival.
    pub(super) fn rank(self) -> (i32, [i8; 2]) {
        let steps = self.0.to_le_bytes().map(u8::cast_signed);
        let [x, y] = steps.map(|v| i32::from(v) - QUARTER_STEPS / 2);
        (x * x + y * y, steps)
    }
}

/// What is left to be done in a row of quarters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Open<const WIDTH: usize> {
    /// Where a quarter's mean has moved away from it: the square of its distance (steps) now. Another one may be nearer.
    limit: [i16; WIDTH],
    /// Not 0 where a quarter's nearest mean has to be found afresh.
    pub(super) afresh: [u16; WIDTH],
    /// Whether there is anything left.
    pub(super) any: bool,
}

impl<const WIDTH: usize> Open<WIDTH> {
    pub(super) const NONE: Self = Self { limit: [i16::MIN; WIDTH], afresh: [0; WIDTH], any: false };
}

/// A mean as it is seen from the quarters of a row, and what it was before it moved.
#[derive(Debug)]
pub(super) struct Seen<const WIDTH: usize> {
    /// Bytes of the offset that are its x, and the square of its distance (steps) from the quarter's middle along x.
    x: [u16; WIDTH],
    x_squared: [i16; WIDTH],
    /// Bytes that were its x; no quarter holds them where there was no mean.
    x_before: [u16; WIDTH],
}

impl<const WIDTH: usize> Seen<WIDTH> {
    /// An x that no offset has.
    const NOWHERE: u16 = i8::MIN.cast_unsigned() as u16;
    /// A square beyond that of [`Offset::NONE`], though not of more than 16 bits even with another one added.
    const BEYOND: i16 = 23_400;

    /// Returns the mean `now` and `before` (steps along x from the first quarter's corner) as seen from the first `side`
    /// quarters.
    #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "few steps")]
    #[inline]
    pub(super) fn new(side: usize, now: i32, before: Option<i32>) -> Self {
        let mut seen = Self {
            x: [0; WIDTH],
            x_squared: [Self::BEYOND; WIDTH],
            x_before: [Self::NOWHERE; WIDTH],
        };
        // Computed for all quarters alike, and so for several at once.
        let (now, had) = (now as i16, before.is_some());
        let before = before.unwrap_or(0) as i16;
        for i in 0..WIDTH {
            let corner = i as i16 * QUARTER_STEPS as i16;
            // Cut where the square is beyond all.
            let across = (now - corner - QUARTER_STEPS as i16 / 2).clamp(-153, 153);
            let is_told = i < side;
            seen.x[i] = (now - corner).cast_unsigned() & 0xff;
            seen.x_squared[i] =
                if is_told { (across * across).min(Self::BEYOND) } else { Self::BEYOND };
            let byte = (before - corner).cast_unsigned() & 0xff;
            seen.x_before[i] = if is_told & had { byte } else { Self::NOWHERE };
        }
        seen
    }

    /// Puts the mean in the quarters of a row to which it is nearer than what they `hold`, and in those that held it before. It
    /// is `now` steps along y from the row's corner, and was `before`.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "no branches: all lanes are compared at once")]
    pub(super) fn improve(&self, hold: &mut [Offset; WIDTH], now: i32, before: i32) -> Open<WIDTH> {
        let (y, y_squared, y_before) = Self::row(now, before);
        let (mut limit, mut afresh, mut any) = ([0; WIDTH], [0; WIDTH], [0; WIDTH]);
        for i in 0..WIDTH {
            let held = hold[i].bits();
            let new = self.x[i] | y;
            let (rank, rank_held) = (self.x_squared[i] + y_squared, Self::rank(held));
            let is_gone = held == self.x_before[i] | y_before;
            let is_nearer = rank < rank_held;
            let is_open = is_gone & !is_nearer;
            hold[i] = Offset::of_bits(if is_gone | is_nearer { new } else { held });
            limit[i] = if is_open { rank } else { i16::MIN };
            // Another one that is exactly as near: the offsets decide.
            let is_tied = (rank == rank_held) & (held != new) & !is_gone;
            afresh[i] = u16::from(is_tied);
            any[i] = u16::from(is_open | is_tied);
        }
        Open { limit, afresh, any: any.iter().fold(0, |any, lane| any | lane) != 0 }
    }

    /// Marks the quarters to which the mean, `now` steps along y from the row's corner, is as near as their limit, or nearer.
    #[inline]
    pub(super) fn rival(&self, open: &mut Open<WIDTH>, now: i32) {
        let (_, y_squared, _) = Self::row(now, now);
        for i in 0..WIDTH {
            open.afresh[i] |= u16::from(self.x_squared[i] + y_squared <= open.limit[i]);
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "at most 3 cells of 32 steps, or its square"
    )]
    fn row(now: i32, before: i32) -> (u16, i16, u16) {
        // Of means further away than any window reaches, and that 16 bits hold beside another.
        const MOST: i32 = 9_000;
        let byte = |v: i32| u16::from((v as i8).cast_unsigned()) << 8;
        (byte(now), (now - QUARTER_STEPS / 2).pow(2).min(MOST) as i16, byte(before))
    }

    /// Returns the squared distance (steps) from the quarter's middle, as in [`Offset::rank`].
    fn rank(held: u16) -> i16 {
        #[expect(clippy::cast_possible_truncation, reason = "few steps")]
        const MIDDLE: i16 = (QUARTER_STEPS / 2) as i16;
        let held = held.cast_signed();
        let (x, y) = ((held << 8 >> 8) - MIDDLE, (held >> 8) - MIDDLE);
        x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y))
    }
}

/// The nearest mean as seen from the middle of each quarter of a tile, row by row.
pub(super) type Nearest = [Offset; QUARTERS + SPARE];

/// Returns the nearest mean as seen from a quarter of the tile, by its index there.
pub(super) fn nearest_at(nearest: &Nearest, quarter: usize) -> Offset {
    nearest[quarter % QUARTERS]
}

#[derive(Debug, Clone)]
pub(super) struct Tile {
    pub(super) nearest: Nearest,
    /// Apart from the hits, as they are looked at far more often.
    pub(super) means: [Mean; CELLS],
    pub(super) hits: [Hits; CELLS],
}

/// A tile without hits.
pub(super) static EMPTY: Tile = Tile {
    nearest: [Offset::NONE; QUARTERS + SPARE],
    means: [Mean::NONE; CELLS],
    hits: [Hits::NONE; CELLS],
};

/// Returns the index of `cell` within its tile.
pub(super) fn cell_in_tile(cell: [i32; 2]) -> usize {
    in_square(cell, TILE_BITS)
}

/// Returns the index of `quarter` (counted on an endless lattice) within its tile.
pub(super) fn quarter_in_tile(quarter: [i32; 2]) -> usize {
    in_square(quarter, SIDE_BITS)
}

/// Returns the index of `cell` within the square of 2^`bits` cells that holds it, row by row.
pub(super) fn in_square(cell: [i32; 2], bits: u32) -> usize {
    #[expect(clippy::cast_sign_loss, reason = "masked")]
    let [x, y] = cell.map(|v| (v & ((1 << bits) - 1)) as usize);
    y << bits | x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn units_are_rounded_as_by_floor(v in -1e5..1e5, scale in 1.0..2e4, halves in -4_000_000..4_000_000_i32) {
            let plainly = |v: f64, scale: f64| (v * scale + 0.5).floor().clamp(i32::MIN.into(), i32::MAX.into());
            prop_assert_eq!(f64::from(units(v, scale)), plainly(v, scale));
            let half = f64::from(halves) / 2.0;
            for v in [half, half.next_up(), half.next_down()] {
                prop_assert_eq!(f64::from(units(v, 1.0)), plainly(v, 1.0));
            }
        }
    }
}
