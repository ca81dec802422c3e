//! A particle's own map, against which scans are matched: for each cell the mean of the beam ends in it (GMapping's
//! `PointAccumulator`), and, for each quarter of each cell, the nearest of these means.
//!
//! The second makes scoring one look-up per beam instead of one per cell of the window. Tiles are shared between
//! particles until one writes (copy on write), and so are blocks of tiles: a copy of a map costs little.

use super::tile::{
    EMPTY, Mean, Offset, Open, Place, QUARTER_BITS, QUARTER_STEPS, SIDE_BITS, STEP_BITS, STEPS,
    Seen, TILE_BITS, Tile, cell_in_tile, in_square, nearest_at, quarter_in_tile,
};
use std::sync::Arc;

/// Tiles in a side of a block, as a power of two.
pub(super) const BLOCK_BITS: u32 = 3;
const TILES: usize = 1 << (2 * BLOCK_BITS);
/// The largest window reaches this many cells to either side: GMapping's reaches 1, and offsets have to fit a byte.
pub(super) const MAX_KERNEL: u32 = 2;
/// Cells whose means may be the nearest of some cell of the largest window.
const AROUND: usize = (4 * MAX_KERNEL as usize + 1).pow(2);

/// A square of tiles, row by row.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) tiles: [Option<Arc<Tile>>; TILES],
}

/// The map. Cells, tiles and blocks are counted on an endless lattice.
#[derive(Debug, Clone)]
pub(super) struct HitMap {
    /// Cells to either side of a beam's end in which a mean is sought (GMapping's `kernelSize`).
    kernel: i32,
    /// The block that comes first in `blocks`.
    low: [i32; 2],
    size: [i32; 2],
    blocks: Vec<Option<Arc<Block>>>,
}

impl HitMap {
    /// Creates an empty map.
    pub(super) fn new(kernel: u32) -> Self {
        let kernel = i32::try_from(kernel.min(MAX_KERNEL)).unwrap_or(0);
        Self { kernel, low: [0, 0], size: [0, 0], blocks: Vec::new() }
    }

    /// Returns the squared distance (units) from `place` to the mean nearest to its quarter of a cell, among those of
    /// the cells in the window around it; more than the window's diagonal where there is none.
    pub(super) fn squared_distance(&self, place: Place) -> u32 {
        let quarter = [place.x >> QUARTER_BITS, place.y >> QUARTER_BITS];
        let tile = self.tile(quarter.map(|v| v >> SIDE_BITS)).unwrap_or(&EMPTY);
        let offset = nearest_at(&tile.nearest, quarter_in_tile(quarter));
        let within = |v: i32| v & ((1 << QUARTER_BITS) - 1);
        let [x, y] = offset.steps().map(|step| (step << STEP_BITS) + (1 << STEP_BITS) / 2);
        let (dx, dy) = (within(place.x) - x, within(place.y) - y);
        (dx * dx + dy * dy).unsigned_abs()
    }

    /// Registers beams that ended at `places`.
    pub(super) fn register(&mut self, places: &[Place]) {
        let mut moved = Vec::with_capacity(places.len());
        // Neighbouring beams often end in one cell.
        for places in places.chunk_by(|a, b| a.cell() == b.cell()) {
            let cell = places[0].cell();
            let (tile, index) = (tile_of(cell), cell_in_tile(cell));
            // What is settled may stay shared.
            if self.tile(tile).is_some_and(|tile| tile.hits[index].is_settled()) {
                continue;
            }
            let tile = self.tile_mut(tile);
            let hits = &mut tile.hits[index];
            for &place in places {
                hits.take(place);
            }
            let mean = hits.mean();
            let before = std::mem::replace(&mut tile.means[index], mean);
            if let Some(steps) = mean.steps()
                && before != mean
            {
                moved.push((cell, before.steps(), steps));
            }
        }
        // In whatever order: in the end every quarter has the nearest of what is there now.
        for (cell, before, mean) in moved {
            match self.kernel {
                0 => self.tell::<2, 8>(cell, before, mean),
                1 => self.tell::<6, 8>(cell, before, mean),
                _ => self.tell::<10, 16>(cell, before, mean),
            }
        }
    }

    /// Updates the nearest means of the cells around `cell`, whose mean was `before` and is `mean` now: of `SIDE` by `SIDE`
    /// quarters, in rows that are held `WIDTH` wide.
    fn tell<const SIDE: usize, const WIDTH: usize>(
        &mut self,
        cell: [i32; 2],
        before: Option<[i32; 2]>,
        mean: [i32; 2],
    ) {
        let k = self.kernel;
        let first = cell.map(|v| v - k);
        let corner = first.map(|v| 2 * v);
        let patch = self.patch(first, cell.map(|v| v + k));
        let mut rows = [[Offset::NONE; WIDTH]; SIDE];
        patch.read(corner, &mut rows);
        let held = rows;
        // Steps are counted from the corner of the first quarter.
        let from_corner = |mean: [i32; 2]| mean.map(|v| v + k * STEPS);
        let ([x, y], gone) = (from_corner(mean), before.map(from_corner));
        let y_gone = gone.map_or(y, |gone| gone[1]);
        let seen = Seen::<WIDTH>::new(SIDE, x, gone.map(|gone| gone[0]));
        let mut open = [Open::NONE; SIDE];
        let corners = || (0..).step_by(QUARTER_STEPS as usize);
        for ((row, open), at) in rows.iter_mut().zip(&mut open).zip(corners()) {
            *open = seen.improve(row, y - at, y_gone - at);
        }
        if open.iter().any(|open| open.any) {
            let (around, found) = self.around(cell);
            let around = &around[..found];
            for mean in around.iter().filter(|mean| !mean.is_middle(k)) {
                let [x, y] = from_corner(mean.steps);
                let seen = Seen::<WIDTH>::new(SIDE, x, None);
                for (open, at) in open.iter_mut().zip(corners()).filter(|(open, _)| open.any) {
                    seen.rival(open, y - at);
                }
            }
            for ((row, open), j) in
                rows.iter_mut().zip(&open).zip(0..).filter(|((_, open), _)| open.any)
            {
                for ((held, &afresh), i) in row.iter_mut().zip(&open.afresh).take(SIDE).zip(0..) {
                    if afresh != 0 {
                        *held = nearest_of(around, [i, j], k);
                    }
                }
            }
        }
        // Compared first, so that a tile that would not change stays shared.
        if rows != held {
            self.write(corner, &rows, &held);
        }
    }

    /// Writes the `rows` of quarters from `corner` on where they differ from what is `held`.
    fn write<const SIDE: usize, const WIDTH: usize>(
        &mut self,
        corner: [i32; 2],
        rows: &[[Offset; WIDTH]; SIDE],
        held: &[[Offset; WIDTH]; SIDE],
    ) {
        let side = i32::try_from(SIDE).unwrap_or(0);
        let (first, last) =
            (corner.map(|v| v >> SIDE_BITS), corner.map(|v| (v + side - 1) >> SIDE_BITS));
        if first == last {
            let start = quarter_in_tile(corner);
            let tile = self.tile_mut(first);
            for (row, into) in rows.iter().zip(tile.nearest[start..].chunks_mut(1 << SIDE_BITS)) {
                into[..SIDE].copy_from_slice(&row[..SIDE]);
            }
            return;
        }
        for tile_y in first[1]..=last[1] {
            for tile_x in first[0]..=last[0] {
                let quarters = |tile: i32, corner: i32| {
                    let low = corner.max(tile << SIDE_BITS) - corner;
                    let high = ((tile + 1) << SIDE_BITS).min(corner + side) - corner;
                    #[expect(clippy::cast_sign_loss, reason = "both are within the square")]
                    let within = low as usize..high as usize;
                    within
                };
                let (columns, lines) = (quarters(tile_x, corner[0]), quarters(tile_y, corner[1]));
                let differs = |j: usize| rows[j][columns.clone()] != held[j][columns.clone()];
                if lines.clone().any(differs) {
                    let tile = self.tile_mut([tile_x, tile_y]);
                    for j in lines {
                        #[expect(
                            clippy::cast_possible_truncation,
                            clippy::cast_possible_wrap,
                            reason = "few quarters"
                        )]
                        let (column, line) = (columns.start as i32, j as i32);
                        let start = quarter_in_tile([corner[0] + column, corner[1] + line]);
                        tile.nearest[start..][..columns.len()]
                            .copy_from_slice(&rows[j][columns.clone()]);
                    }
                }
            }
        }
    }

    /// Returns the means of the cells up to twice the kernel around `cell`, and how many there are.
    fn around(&self, cell: [i32; 2]) -> ([Neighbour; AROUND], usize) {
        let reach = 2 * self.kernel;
        let corner = cell.map(|v| v - reach);
        let patch = self.patch(corner, cell.map(|v| v + reach));
        let mut means = [Neighbour { column: 0, row: 0, steps: [0; 2] }; AROUND];
        let mut found = 0;
        for row in 0..=2 * reach {
            let mut take = |column: i32, mean: Mean| {
                if let Some([x, y]) = mean.steps() {
                    let steps = [x + (column - reach) * STEPS, y + (row - reach) * STEPS];
                    means[found] = Neighbour { column, row, steps };
                    found += 1;
                }
            };
            let first = [corner[0], corner[1] + row];
            if patch.is_one {
                let means = &patch.tiles[0][0].means[cell_in_tile(first)..];
                (0..=2 * reach).zip(means).for_each(|(column, mean)| take(column, *mean));
            } else {
                (0..=2 * reach)
                    .for_each(|column| take(column, patch.mean([first[0] + column, first[1]])));
            }
        }
        (means, found)
    }

    /// Returns the tiles from the one of the cell `first` to that of `last`: less than a tile lies between them.
    fn patch(&self, first: [i32; 2], last: [i32; 2]) -> Patch<'_> {
        let (first, last) = (tile_of(first), tile_of(last));
        let one = self.tile(first).unwrap_or(&EMPTY);
        let is_one = first == last;
        let tile = |x: i32, y: i32| if is_one { one } else { self.tile([x, y]).unwrap_or(&EMPTY) };
        Patch {
            first,
            is_one,
            tiles: [
                [one, tile(last[0], first[1])],
                [tile(first[0], last[1]), tile(last[0], last[1])],
            ],
        }
    }

    /// Returns the block with these coordinates, where there is one.
    pub(super) fn block(&self, block: [i32; 2]) -> Option<&Block> {
        self.index(block).and_then(|index| self.blocks[index].as_deref())
    }

    fn index(&self, block: [i32; 2]) -> Option<usize> {
        let column = block[0].wrapping_sub(self.low[0]);
        let row = block[1].wrapping_sub(self.low[1]);
        let inside = (0..self.size[0]).contains(&column) && (0..self.size[1]).contains(&row);
        inside.then(|| usize::try_from(row * self.size[0] + column).unwrap_or(0))
    }

    /// Returns the tile with these coordinates, where there is one.
    pub(super) fn tile(&self, tile: [i32; 2]) -> Option<&Tile> {
        let block = self.block(tile.map(|v| v >> BLOCK_BITS))?;
        block.tiles[in_square(tile, BLOCK_BITS)].as_deref()
    }

    /// Returns the tile with these coordinates, made where there is none, and copied where it was shared.
    fn tile_mut(&mut self, tile: [i32; 2]) -> &mut Tile {
        let block = tile.map(|v| v >> BLOCK_BITS);
        let index = self.index(block).unwrap_or_else(|| {
            self.grow_to(block);
            self.index(block).unwrap_or(0)
        });
        let block = self.blocks[index]
            .get_or_insert_with(|| Arc::new(Block { tiles: [const { None }; TILES] }));
        let tile = &mut Arc::make_mut(block).tiles[in_square(tile, BLOCK_BITS)];
        Arc::make_mut(tile.get_or_insert_with(|| Arc::new(EMPTY.clone())))
    }

    fn grow_to(&mut self, block: [i32; 2]) {
        /// Blocks added beyond what is needed, so that the map grows seldom.
        const MARGIN: i32 = 2;
        let axis = |i: usize| {
            let (low, high) = (self.low[i], self.low[i] + self.size[i] - 1);
            let (low, high) = if self.blocks.is_empty() {
                (block[i] - MARGIN, block[i] + MARGIN)
            } else {
                (
                    if block[i] < low { block[i] - MARGIN } else { low },
                    if block[i] > high { block[i] + MARGIN } else { high },
                )
            };
            (low, high - low + 1)
        };
        let ((low_x, width), (low_y, height)) = (axis(0), axis(1));
        let mut blocks = vec![None; usize::try_from(width * height).unwrap_or(0)];
        for (old, block) in (0..).zip(self.blocks.drain(..)) {
            let column = self.low[0] + old % self.size[0] - low_x;
            let row = self.low[1] + old / self.size[0] - low_y;
            blocks[usize::try_from(row * width + column).unwrap_or(0)] = block;
        }
        (self.blocks, self.low, self.size) = (blocks, [low_x, low_y], [width, height]);
    }
}

/// Four tiles that meet, or fewer.
#[derive(Debug)]
struct Patch<'a> {
    first: [i32; 2],
    is_one: bool,
    tiles: [[&'a Tile; 2]; 2],
}

impl Patch<'_> {
    fn tile(&self, tile: [i32; 2]) -> &Tile {
        let is_second = |i: usize| usize::from(tile[i] != self.first[i]);
        self.tiles[is_second(1)][is_second(0)]
    }

    fn mean(&self, cell: [i32; 2]) -> Mean {
        self.tile(tile_of(cell)).means[cell_in_tile(cell)]
    }

    /// Reads the quarters from `corner` on into `rows`. What is beyond the first `SIDE` of a row is of no meaning.
    fn read<const SIDE: usize, const WIDTH: usize>(
        &self,
        corner: [i32; 2],
        rows: &mut [[Offset; WIDTH]; SIDE],
    ) {
        if self.is_one {
            let start = quarter_in_tile(corner);
            let nearest = &self.tiles[0][0].nearest;
            for (j, row) in rows.iter_mut().enumerate() {
                *row = *nearest[start + (j << SIDE_BITS)..].first_chunk().unwrap_or(row);
            }
            return;
        }
        for (row, y) in rows.iter_mut().zip(corner[1]..) {
            for (held, x) in row.iter_mut().take(SIDE).zip(corner[0]..) {
                let tile = self.tile([x >> SIDE_BITS, y >> SIDE_BITS]);
                *held = nearest_at(&tile.nearest, quarter_in_tile([x, y]));
            }
        }
    }
}

/// Returns the tile that holds `cell`.
fn tile_of(cell: [i32; 2]) -> [i32; 2] {
    cell.map(|v| v >> TILE_BITS)
}

/// The mean of a cell near another one.
#[derive(Debug, Clone, Copy)]
struct Neighbour {
    /// The cell, counted from the first one.
    column: i32,
    row: i32,
    /// The mean in steps from the other cell's corner.
    steps: [i32; 2],
}

impl Neighbour {
    fn is_middle(&self, kernel: i32) -> bool {
        [self.column, self.row] == [2 * kernel; 2]
    }
}

/// Finds the nearest mean as seen from a quarter, afresh. `around` are the means around a cell, and quarters are counted from
/// the first one of the cells within `kernel` of it.
fn nearest_of(around: &[Neighbour], quarter: [i32; 2], kernel: i32) -> Offset {
    let [column, row] = quarter.map(|v| v / 2 + kernel);
    let corner = quarter.map(|v| QUARTER_STEPS * (v - 2 * kernel));
    let mut nearest = Offset::NONE;
    for mean in around {
        if (mean.column - column).abs() <= kernel && (mean.row - row).abs() <= kernel {
            let seen = Offset::new([mean.steps[0] - corner[0], mean.steps[1] - corner[1]]);
            if seen.rank() < nearest.rank() {
                nearest = seen;
            }
        }
    }
    nearest
}

#[cfg(test)]
mod tests;
