//! A particle's own map, against which scans are matched: for each cell the mean of the beam ends in it (GMapping's
//! `PointAccumulator`), and, for each quarter of each cell, the nearest of these means.
//!
//! The second makes scoring one look-up per beam instead of one per cell of the window. Lengths are whole units, 1/256
//! of a cell
//! (0.2 mm for cells of 5 cm), so that sums do not depend on their order; means are kept to 1/32 of a cell. Tiles are shared
//! between particles until one writes (copy on write).

use crate::geometry::Point;
use std::sync::Arc;

/// Units in a cell, as a power of two.
pub(super) const CELL_BITS: u32 = 8;
const CELL: i32 = 1 << CELL_BITS;
/// Steps in a cell, as a power of two: means are rounded to these steps.
const STEP_BITS: u32 = 5;
const STEPS: i32 = 1 << STEP_BITS;
/// Cells in a side of a tile, as a power of two.
const TILE_BITS: u32 = 5;
const TILE: i32 = 1 << TILE_BITS;
const CELLS: usize = (TILE * TILE) as usize;
/// The largest window reaches this many cells to either side: GMapping's reaches 1, and offsets have to fit a byte.
pub(super) const MAX_KERNEL: u32 = 2;
/// Stands for "no mean near": further away than any window's diagonal.
const NONE: Offset = [i8::MIN; 2];
/// A squared distance beyond any window.
const FAR: u32 = u32::MAX;

/// The position of a mean, in steps from a cell's corner.
type Offset = [i8; 2];

/// A place in units from the map frame's origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) x: i32,
    pub(super) y: i32,
}

impl Place {
    /// Returns the place nearest to `point` (m) where a metre has `scale` units.
    #[expect(clippy::cast_possible_truncation, reason = "saturates, 400 km from the origin")]
    pub(super) fn of(point: Point, scale: f64) -> Self {
        let round = |v: f64| {
            let units = v * scale + 0.5;
            let cut = units as i32;
            cut - i32::from(f64::from(cut) > units)
        };
        Self { x: round(point.x), y: round(point.y) }
    }

    /// Returns the place moved by `by`. Wraps around far outside of any building.
    pub(super) fn plus(self, by: Self) -> Self {
        Self { x: self.x.wrapping_add(by.x), y: self.y.wrapping_add(by.y) }
    }
}

/// Beams that ended in a cell: their number, and the sums of their ends, in units from the cell's corner. At 255 the
/// mean is settled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Hits {
    x: u16,
    y: u16,
    count: u8,
}

impl Hits {
    const NONE: Self = Self { x: 0, y: 0, count: 0 };

    /// Returns the hits with one more, at `place`.
    fn with(self, place: Place) -> Self {
        if self.count == u8::MAX {
            return self;
        }
        #[expect(clippy::cast_sign_loss, reason = "masked")]
        let within = |v: i32| (v & (CELL - 1)) as u16;
        Self { x: self.x + within(place.x), y: self.y + within(place.y), count: self.count + 1 }
    }

    /// Returns the step that holds the mean, from the cell's corner; `None` before the first hit.
    fn mean(self) -> Option<[i32; 2]> {
        let mean = |sum: u16| i32::from(sum / u16::from(self.count)) >> (CELL_BITS - STEP_BITS);
        (self.count > 0).then(|| [mean(self.x), mean(self.y)])
    }
}

#[derive(Debug, Clone)]
struct Tile {
    hits: [Hits; CELLS],
    /// The nearest mean as seen from the middle of each quarter of each cell.
    nearest: [[Offset; 4]; CELLS],
}

const EMPTY: Tile = Tile { hits: [Hits::NONE; CELLS], nearest: [[NONE; 4]; CELLS] };

/// The map. Cells and tiles are counted on an endless lattice.
#[derive(Debug, Clone)]
pub(super) struct HitMap {
    /// Cells to either side of a beam's end in which a mean is sought (GMapping's `kernelSize`).
    kernel: i32,
    /// The tile that comes first in `tiles`.
    low: [i32; 2],
    size: [i32; 2],
    tiles: Vec<Option<Arc<Tile>>>,
}

impl HitMap {
    /// Creates an empty map.
    pub(super) fn new(kernel: u32) -> Self {
        let kernel = i32::try_from(kernel.min(MAX_KERNEL)).unwrap_or(0);
        Self { kernel, low: [0, 0], size: [0, 0], tiles: Vec::new() }
    }

    /// Returns the squared distance (units) from `place` to the mean nearest to its quarter of a cell, among those of
    /// the cells in the window around it; more than the window's diagonal where there is none.
    pub(super) fn squared_distance(&self, place: Place) -> u32 {
        let tile_x = (place.x >> (CELL_BITS + TILE_BITS)).wrapping_sub(self.low[0]);
        let tile_y = (place.y >> (CELL_BITS + TILE_BITS)).wrapping_sub(self.low[1]);
        #[expect(clippy::cast_sign_loss, reason = "negative ones become too large")]
        let (column, row) = (tile_x as u32, tile_y as u32);
        #[expect(clippy::cast_sign_loss, reason = "sizes are not negative")]
        if column >= self.size[0] as u32 || row >= self.size[1] as u32 {
            return FAR;
        }
        #[expect(clippy::cast_sign_loss, reason = "sizes are not negative")]
        let index = row as usize * self.size[0] as usize + column as usize;
        let Some(Some(tile)) = self.tiles.get(index) else { return FAR };
        let cell = in_tile([place.x >> CELL_BITS, place.y >> CELL_BITS]);
        let half = |v: i32| usize::from(v & (CELL / 2) != 0);
        let offset = tile.nearest[cell % CELLS][half(place.y) << 1 | half(place.x)];
        let [x, y] =
            offset.map(|step| (i32::from(step) << (CELL_BITS - STEP_BITS)) + CELL / STEPS / 2);
        let (dx, dy) = ((place.x & (CELL - 1)) - x, (place.y & (CELL - 1)) - y);
        #[expect(clippy::cast_sign_loss, reason = "a sum of squares")]
        let squared = (dx * dx + dy * dy) as u32;
        squared
    }

    /// Registers beams that ended at `places`.
    pub(super) fn register(&mut self, places: impl IntoIterator<Item = Place>) {
        for place in places {
            let cell = [place.x >> CELL_BITS, place.y >> CELL_BITS];
            let hits = &mut self.tile_mut(cell).hits[in_tile(cell)];
            let before = hits.mean();
            *hits = hits.with(place);
            if let Some(mean) = hits.mean()
                && before != Some(mean)
            {
                self.tell(cell, before, mean);
            }
        }
    }

    /// Updates the nearest means of the cells around `cell`, whose mean was `before` and is `mean` now.
    fn tell(&mut self, [x, y]: [i32; 2], before: Option<[i32; 2]>, mean: [i32; 2]) {
        let k = self.kernel;
        for dy in -k..=k {
            for dx in -k..=k {
                let there = [x + dx, y + dy];
                let seen = |[mx, my]: [i32; 2]| offset([mx - dx * STEPS, my - dy * STEPS]);
                let (gone, new) = (before.map(seen), seen(mean));
                let index = in_tile(there);
                let held = self.tile(there).map_or([NONE; 4], |tile| tile.nearest[index]);
                let mut nearest = held;
                for (quarter, nearest) in nearest.iter_mut().enumerate() {
                    if rank(quarter, new) <= rank(quarter, *nearest) {
                        *nearest = new;
                    } else if Some(*nearest) == gone {
                        *nearest = self.nearest_to(there, quarter);
                    }
                }
                // Compared first, so that a tile that would not change stays shared.
                if held != nearest {
                    self.tile_mut(there).nearest[index] = nearest;
                }
            }
        }
    }

    /// Finds the nearest mean as seen from a quarter of `cell`, afresh.
    fn nearest_to(&self, [x, y]: [i32; 2], quarter: usize) -> Offset {
        let (k, mut nearest) = (self.kernel, NONE);
        for dy in -k..=k {
            for dx in -k..=k {
                if let Some([mx, my]) = self.hits([x + dx, y + dy]).mean() {
                    let seen = offset([mx + dx * STEPS, my + dy * STEPS]);
                    if rank(quarter, seen) < rank(quarter, nearest) {
                        nearest = seen;
                    }
                }
            }
        }
        nearest
    }

    fn hits(&self, cell: [i32; 2]) -> Hits {
        self.tile(cell).map_or(Hits::default(), |tile| tile.hits[in_tile(cell)])
    }

    fn index(&self, cell: [i32; 2]) -> Option<usize> {
        let column = (cell[0] >> TILE_BITS).wrapping_sub(self.low[0]);
        let row = (cell[1] >> TILE_BITS).wrapping_sub(self.low[1]);
        let inside = (0..self.size[0]).contains(&column) && (0..self.size[1]).contains(&row);
        inside.then(|| usize::try_from(row * self.size[0] + column).unwrap_or(0))
    }

    fn tile(&self, cell: [i32; 2]) -> Option<&Tile> {
        self.index(cell).and_then(|index| self.tiles[index].as_deref())
    }

    /// Returns the tile of `cell`, made where there is none, and copied where it was shared.
    fn tile_mut(&mut self, cell: [i32; 2]) -> &mut Tile {
        let index = self.index(cell).unwrap_or_else(|| {
            self.grow_to([cell[0] >> TILE_BITS, cell[1] >> TILE_BITS]);
            self.index(cell).unwrap_or(0)
        });
        Arc::make_mut(self.tiles[index].get_or_insert_with(|| Arc::new(EMPTY)))
    }

    fn grow_to(&mut self, tile: [i32; 2]) {
        /// Tiles added beyond what is needed, so that the map grows seldom.
        const MARGIN: i32 = 8;
        let axis = |i: usize| {
            let (low, high) = (self.low[i], self.low[i] + self.size[i] - 1);
            let (low, high) = if self.tiles.is_empty() {
                (tile[i] - MARGIN, tile[i] + MARGIN)
            } else {
                (
                    if tile[i] < low { tile[i] - MARGIN } else { low },
                    if tile[i] > high { tile[i] + MARGIN } else { high },
                )
            };
            (low, high - low + 1)
        };
        let ((low_x, width), (low_y, height)) = (axis(0), axis(1));
        let mut tiles = vec![None; usize::try_from(width * height).unwrap_or(0)];
        for (old, tile) in (0..).zip(self.tiles.drain(..)) {
            let column = self.low[0] + old % self.size[0] - low_x;
            let row = self.low[1] + old / self.size[0] - low_y;
            tiles[usize::try_from(row * width + column).unwrap_or(0)] = tile;
        }
        (self.tiles, self.low, self.size) = (tiles, [low_x, low_y], [width, height]);
    }
}

/// Converts steps to an offset; they fit, being those of a mean within the largest window.
#[expect(clippy::cast_possible_truncation, reason = "at most 3 cells of 32 steps")]
fn offset(steps: [i32; 2]) -> Offset {
    steps.map(|v| v as i8)
}

/// Ranks a mean: lower is nearer to the middle of the quarter. The offset itself decides between equally
/// near ones, so that the nearest does not depend on the order of arrival.
fn rank(quarter: usize, offset: Offset) -> (i32, Offset) {
    let middle = |is_far: bool| if is_far { 3 * STEPS / 4 } else { STEPS / 4 };
    let dx = i32::from(offset[0]) - middle(quarter & 1 != 0);
    let dy = i32::from(offset[1]) - middle(quarter & 2 != 0);
    (dx * dx + dy * dy, offset)
}

/// Returns the index of `cell` within its tile.
fn in_tile(cell: [i32; 2]) -> usize {
    #[expect(clippy::cast_sign_loss, reason = "masked")]
    let [x, y] = cell.map(|v| (v & (TILE - 1)) as usize);
    y << TILE_BITS | x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = Place> {
        // About the corner where four tiles meet.
        (-2000..2000, -2000..2000).prop_map(|(x, y)| Place { x, y })
    }

    /// Returns the squared distance (units) from `at` to the mean, rounded to steps, that is nearest to its quarter of
    /// a cell, over all cells of the window.
    fn by_definition(places: &[Place], at: Place, kernel: i32) -> Option<u32> {
        let cell = |p: Place| [p.x >> CELL_BITS, p.y >> CELL_BITS];
        let [x, y] = cell(at);
        let half = |v: i32| (v >> 7) * 16 + 8;
        let mut best: Option<((i32, i32, i32), i32)> = None;
        for cy in y - kernel..=y + kernel {
            for cx in x - kernel..=x + kernel {
                let here: Vec<_> = places.iter().filter(|p| cell(**p) == [cx, cy]).collect();
                let n = i32::try_from(here.len()).unwrap();
                if n == 0 {
                    continue;
                }
                let mean = |of: fn(&Place) -> i32, c: i32| {
                    (c * CELL + here.iter().map(|p| of(p) - c * CELL).sum::<i32>() / n) >> 3
                };
                let (mx, my) = (mean(|p| p.x, cx), mean(|p| p.y, cy));
                let to_quarter = (mx - half(at.x)).pow(2) + (my - half(at.y)).pow(2);
                let squared = (mx * 8 + 4 - at.x).pow(2) + (my * 8 + 4 - at.y).pow(2);
                if best.is_none_or(|(rank, _)| (to_quarter, mx, my) < rank) {
                    best = Some(((to_quarter, mx, my), squared));
                }
            }
        }
        best.map(|(_, squared)| squared.unsigned_abs())
    }

    proptest! {
        #[test]
        fn one_look_up_tells_what_the_whole_window_would(
            scans in prop::collection::vec(prop::collection::vec(place(), 1..12), 1..4),
            asked in prop::collection::vec(place(), 50),
            kernel in 0_u32..3,
        ) {
            let mut map = HitMap::new(kernel);
            for scan in &scans {
                map.register(scan.iter().copied());
            }
            let all = scans.concat();
            let kernel = i32::try_from(kernel).unwrap();
            let window = ((kernel + 1) * CELL).pow(2) * 2;
            for at in asked.iter().chain(&all) {
                let found = map.squared_distance(*at);
                match by_definition(&all, *at, kernel) {
                    Some(expected) => prop_assert_eq!(found, expected),
                    None => prop_assert!(found > window.unsigned_abs()),
                }
            }
        }

        /// Checks copy on write: a change to one copy does not show in the other, and nothing is copied that is not
        /// written.
        #[test]
        fn a_copy_keeps_what_it_had(
            before in prop::collection::vec(place(), 1..20),
            after in prop::collection::vec(place(), 1..20),
        ) {
            let mut map = HitMap::new(1);
            map.register(before.iter().copied());
            map.register([Place { x: 40_000, y: 0 }]);
            let copy = map.clone();
            map.register(after.iter().copied());
            let mut alone = HitMap::new(1);
            alone.register(before.iter().copied());
            for at in before.iter().chain(&after) {
                prop_assert_eq!(copy.squared_distance(*at), alone.squared_distance(*at));
            }
            let far = |map: &HitMap| Arc::as_ptr(map.tiles[map.index([40_000 >> 8, 0]).unwrap()].as_ref().unwrap());
            prop_assert_eq!(far(&map), far(&copy));
        }
    }
}
