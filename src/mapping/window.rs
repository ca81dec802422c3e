//! The part of a particle's map that a scan reaches, laid out so that a beam's end finds its nearest mean with two loads.

use super::beams::{Go, LANES, Split, Turned};
use super::hit_map::{BLOCK_BITS, HitMap};
use super::tile::{EMPTY, Nearest, Place, QUARTER_BITS, SIDE_BITS, STEP_BITS, nearest_at};

/// Units in a side of a tile, as a power of two.
const TILE_UNITS: u32 = QUARTER_BITS + SIDE_BITS;
/// Tiles beyond those that a scan reaches, as the search moves on.
const MARGIN: i32 = 2;
/// Most tiles in a window, and in a side of it, as powers of two: what 16 bits can tell apart.
const MOST_BITS: u32 = 15;
const MOST_SIDE_BITS: u32 = 11;

/// Tiles of a map around the ends of a scan. Places are told from one another by their low bits alone, which is why all
/// have to be within reach ([`Window::reach`]).
#[derive(Debug)]
pub(super) struct Window<'a> {
    map: &'a HitMap,
    /// The first and the last tile within reach.
    low: [i32; 2],
    high: [i32; 2],
    /// Width and height in tiles, as powers of two; `None` where the scan reaches further than a window can.
    bits: Option<[u32; 2]>,
    tiles: Vec<&'a Nearest>,
}

impl<'a> Window<'a> {
    /// Creates a window over `map` that reaches nothing yet.
    pub(super) fn over(map: &'a HitMap) -> Self {
        Self { map, low: [0; 2], high: [-1; 2], bits: None, tiles: Vec::new() }
    }

    /// Makes the window reach all `ends` seen from `at`.
    pub(super) fn reach(&mut self, ends: &Turned, at: Place) {
        if ends.count() == 0 {
            return;
        }
        let tile = |v: i32, by: i32| v.saturating_add(by) >> TILE_UNITS;
        let [first, last] = ends.bounds().map(|end| [tile(end.x, at.x), tile(end.y, at.y)]);
        let within = |i: usize| self.low[i] <= first[i] && last[i] <= self.high[i];
        if !(within(0) && within(1)) {
            self.lay_out(first.map(|v| v - MARGIN), last.map(|v| v + MARGIN));
        }
    }

    fn lay_out(&mut self, low: [i32; 2], high: [i32; 2]) {
        let bits =
            |i: usize| (high[i] - low[i] + 1).unsigned_abs().next_power_of_two().trailing_zeros();
        let bits = [bits(0), bits(1)];
        let fits =
            bits.iter().all(|&side| side <= MOST_SIDE_BITS) && bits[0] + bits[1] <= MOST_BITS;
        (self.low, self.high, self.bits) = (low, high, fits.then_some(bits));
        self.tiles.clear();
        if !fits {
            return;
        }
        self.tiles.resize(1 << (bits[0] + bits[1]), &EMPTY.nearest);
        for block_y in low[1] >> BLOCK_BITS..=high[1] >> BLOCK_BITS {
            for block_x in low[0] >> BLOCK_BITS..=high[0] >> BLOCK_BITS {
                let Some(block) = self.map.block([block_x, block_y]) else { continue };
                for (i, tile) in (0..).zip(&block.tiles) {
                    let x = (block_x << BLOCK_BITS) + (i & ((1 << BLOCK_BITS) - 1));
                    let y = (block_y << BLOCK_BITS) + (i >> BLOCK_BITS);
                    if let Some(tile) = tile
                        && (low[0]..=high[0]).contains(&x)
                        && (low[1]..=high[1]).contains(&y)
                    {
                        let masked =
                            |v: i32, bits: u32| usize::try_from(v & ((1 << bits) - 1)).unwrap_or(0);
                        self.tiles[masked(y, bits[1]) << bits[0] | masked(x, bits[0])] =
                            &tile.nearest;
                    }
                }
            }
        }
    }

    /// Returns the squared distances (units) from the ends of a go, seen from `at`, to the mean nearest to their quarters of a
    /// cell, among those of the cells in the window around them; more than the window's diagonal where there is none. All have
    /// to be within reach.
    #[inline]
    pub(super) fn squared_distances(&self, ends: Go<'_>, at: Place) -> [u32; LANES] {
        const SIDE: i16 = (1 << SIDE_BITS) - 1;
        const QUARTER: i16 = (1 << QUARTER_BITS) - 1;
        const HALF_STEP: i16 = 1 << (STEP_BITS - 1);
        let Some([width, height]) = self.bits else { return self.one_by_one(ends, at) };
        let (columns, rows) = ((1_i16 << width) - 1, (1_i16 << height) - 1);
        let (at_x, at_y) = (Split::of(at.x), Split::of(at.y));
        // Step by step for all of them, as a processor computes several at once in all steps but the look-up.
        let (mut slots, mut quarters) = ([0_u16; LANES], [0_u16; LANES]);
        let (mut within_x, mut within_y) = ([0; LANES], [0; LANES]);
        for i in 0..LANES {
            let x = ends.x_within[i] + at_x.within;
            let y = ends.y_within[i] + at_y.within;
            let column =
                ends.x_quarter[i].wrapping_add(at_x.quarter).wrapping_add(x >> QUARTER_BITS);
            let row = ends.y_quarter[i].wrapping_add(at_y.quarter).wrapping_add(y >> QUARTER_BITS);
            within_x[i] = x & QUARTER;
            within_y[i] = y & QUARTER;
            let slot = ((row >> SIDE_BITS) & rows) << width | ((column >> SIDE_BITS) & columns);
            slots[i] = slot.cast_unsigned();
            quarters[i] = ((row & SIDE) << SIDE_BITS | (column & SIDE)).cast_unsigned();
        }
        let mut offsets = [0; LANES];
        for i in 0..LANES {
            let tile = self.tiles.get(usize::from(slots[i])).copied().unwrap_or(&EMPTY.nearest);
            offsets[i] = nearest_at(tile, quarters[i].into()).bits().cast_signed();
        }
        let mut squares = [0; LANES];
        for i in 0..LANES {
            let (x, y) = (offsets[i] << 8 >> 8, offsets[i] >> 8);
            let dx = within_x[i] - ((x << STEP_BITS) + HALF_STEP);
            let dy = within_y[i] - ((y << STEP_BITS) + HALF_STEP);
            let (dx, dy) = (i32::from(dx), i32::from(dy));
            squares[i] = (dx * dx + dy * dy).cast_unsigned();
        }
        squares
    }

    #[cold]
    fn one_by_one(&self, ends: Go<'_>, at: Place) -> [u32; LANES] {
        std::array::from_fn(|i| self.map.squared_distance(ends.place(i).plus(at)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::mapping::beams::Beams;
    use proptest::prelude::*;

    proptest! {
        /// Checks what several ends are told at once against what each is told by the map itself: near, far, beyond what a
        /// window can reach, and after the search has moved on.
        #[test]
        fn several_at_once_are_told_what_the_map_tells_each(
            hits in prop::collection::vec((-9.0..9.0, -9.0..9.0), 0..60),
            ends in prop::collection::vec((-8.0..8.0, -8.0..8.0), 0..40),
            far in prop::option::of(10.0..5000.0),
            moves in prop::collection::vec((-60_000..60_000, -3000..3000, -3.0..3.0), 1..5),
            kernel in 0_u32..3,
        ) {
            const SCALE: f64 = 5120.0;
            let mut map = HitMap::new(kernel);
            let places: Vec<_> =
                hits.iter().map(|&(x, y)| Place::of(Point::new(x, y), SCALE)).collect();
            map.register(&places);
            let far = far.map(|x| Point::new(x, 0.0));
            let ends: Vec<_> =
                ends.iter().map(|&(x, y)| Point::new(x, y)).chain(far).collect();
            let mut beams = Beams::default();
            beams.take(ends.iter().copied());
            let mut window = Window::over(&map);
            for (x, y, heading) in moves {
                let at = Place { x, y };
                beams.turn(heading, SCALE);
                window.reach(&beams.here, at);
                let mut told = Vec::new();
                for go in beams.here.goes() {
                    let squares = window.squared_distances(go, at);
                    for (i, squared) in squares.into_iter().enumerate() {
                        prop_assert_eq!(squared, map.squared_distance(go.place(i).plus(at)));
                        told.push(squared);
                    }
                }
                prop_assert_eq!(told.len(), ends.len().next_multiple_of(LANES));
                prop_assert_eq!(beams.here.count(), ends.len());
            }
        }
    }
}
