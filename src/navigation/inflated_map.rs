//! An inflated map that is kept current: after a change only the cells that it can reach are inflated anew.

use super::CostGrid;
use super::inflation::inflate_in_steps;
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use std::sync::Arc;

/// A map and its inflation. [`InflatedMap::update`] gives what [`super::inflate`] gives, sooner.
///
/// Why only the neighbourhood of a change needs inflating follows from how a brushfire spreads. Let all fires be out
/// after K steps. A difference between two maps spreads by one cell (in steps of 4 neighbours) with every step, so that
/// costs differ at most K cells from it. Inflating a cut-out errs within K cells of its edge; a fire that enters there
/// after the K-th step stays within `radius` of where it began, so it gets 2 `radius` further at most. Where fires take
/// longer than K steps, which winding free cells can cause, everything is inflated anew.
#[derive(Debug, Clone)]
pub struct InflatedMap {
    radius: u32,
    known: Option<Known>,
}

#[derive(Debug, Clone)]
struct Known {
    map: OccupancyGrid,
    costs: Arc<CostGrid>,
    /// Whether all fires were out after [`STEPS`].
    calm: bool,
}

/// K: straight fires of a radius of 9 cells are out after 13.
const STEPS: u32 = 16;

impl InflatedMap {
    /// Creates an empty state, to be inflated over `radius` cells.
    pub fn new(radius: u32) -> Self {
        Self { radius, known: None }
    }

    /// Inflates `map` and returns its costs.
    pub fn update(&mut self, map: OccupancyGrid) -> Arc<CostGrid> {
        let patched = self.known.take().and_then(|known| self.patched(known, &map));
        let known = patched.unwrap_or_else(|| {
            let (costs, steps) = inflate_in_steps(&map, self.radius);
            (Arc::new(costs), steps <= STEPS)
        });
        let (costs, calm) = known;
        self.known = Some(Known { map, costs: Arc::clone(&costs), calm });
        costs
    }

    /// Computes the costs of `map` from those of the map before it; `None` where that does not pay or is impossible.
    fn patched(&self, known: Known, map: &OccupancyGrid) -> Option<(Arc<CostGrid>, bool)> {
        if !known.calm || known.map.frame() != map.frame() {
            return None;
        }
        let Some(changed) = difference(&known.map, map) else { return Some((known.costs, true)) };
        let reach = i32::try_from(STEPS).ok()?;
        let radius = i32::try_from(self.radius).ok()?;
        let redone = changed.grown(reach, map.frame());
        let seen = redone.grown(reach + 2 * radius + 1, map.frame());
        if 2 * seen.cells() > map.frame().len() {
            return None;
        }
        let (patch, steps) = inflate_in_steps(&seen.cut_out(map), self.radius);
        if steps > STEPS {
            return None;
        }
        let mut costs = known.costs;
        let whole = Arc::make_mut(&mut costs);
        for y in redone.low.y..=redone.high.y {
            let from = Cell::new(redone.low.x - seen.low.x, y - seen.low.y);
            whole.copy_row(Cell::new(redone.low.x, y), &patch, from, redone.width());
        }
        Some((costs, true))
    }
}

/// Cells from one corner to the other, both included.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    low: Cell,
    high: Cell,
}

impl Rectangle {
    fn grown(self, by: i32, within: &GridFrame) -> Self {
        Self {
            low: Cell::new((self.low.x - by).max(0), (self.low.y - by).max(0)),
            high: Cell::new(
                (self.high.x + by).min(within.width - 1),
                (self.high.y + by).min(within.height - 1),
            ),
        }
    }

    fn width(self) -> usize {
        usize::try_from(self.high.x - self.low.x + 1).unwrap_or(0)
    }

    fn cells(self) -> usize {
        self.width() * usize::try_from(self.high.y - self.low.y + 1).unwrap_or(0)
    }

    fn cut_out(self, map: &OccupancyGrid) -> OccupancyGrid {
        let mut cells: Vec<Occupancy> = Vec::with_capacity(self.cells());
        for y in self.low.y..=self.high.y {
            let first = map.frame().index(Cell::new(self.low.x, y)).unwrap_or(0);
            cells.extend_from_slice(&map.values()[first..first + self.width()]);
        }
        let (width, height) = (self.high.x - self.low.x + 1, self.high.y - self.low.y + 1);
        OccupancyGrid::from_cells(GridFrame { width, height, ..*map.frame() }, cells)
    }
}

/// Returns the smallest rectangle that holds all cells in which `a` and `b`, of one frame, differ.
fn difference(a: &OccupancyGrid, b: &OccupancyGrid) -> Option<Rectangle> {
    let width = usize::try_from(a.frame().width).unwrap_or(0).max(1);
    let mut found: Option<Rectangle> = None;
    for (y, (x, z)) in (0..).zip(a.values().chunks(width).zip(b.values().chunks(width))) {
        // Without an early end, so that the compiler compares many at once.
        let any = x.iter().zip(z).fold(0, |any, (x, z)| any | (*x as u8 ^ *z as u8));
        if any == 0 {
            continue;
        }
        let differs = |(x, z): (&Occupancy, &Occupancy)| x != z;
        let first = x.iter().zip(z).position(differs).unwrap_or(0);
        let last = x.iter().zip(z).rposition(differs).unwrap_or(width - 1);
        let [first, last] = [first, last].map(|at| i32::try_from(at).unwrap_or(i32::MAX));
        let so_far =
            found.get_or_insert(Rectangle { low: Cell::new(first, y), high: Cell::new(last, y) });
        so_far.low.x = so_far.low.x.min(first);
        so_far.high = Cell::new(so_far.high.x.max(last), y);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::navigation::inflate;
    use proptest::prelude::*;

    const SIDE: i32 = 240;

    /// Returns a map of rooms of free cells, walls with doors between them, and some obstacles and unknown cells strewn
    /// in.
    fn rooms(strewn: &[(i32, i32, u8)]) -> OccupancyGrid {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: SIDE, height: SIDE };
        let wall = |cell: Cell| {
            (cell.x % 60 == 0 && cell.y % 60 > 12) || (cell.y % 60 == 0 && cell.x % 60 > 12)
        };
        let cells =
            frame.cells().map(|c| if wall(c) { Occupancy::Occupied } else { Occupancy::Free });
        let mut map = OccupancyGrid::from_cells(frame, cells.collect());
        for &(x, y, kind) in strewn {
            change(&mut map, (x, y, kind));
        }
        map
    }

    fn change(map: &mut OccupancyGrid, (x, y, kind): (i32, i32, u8)) {
        let value =
            [Occupancy::Occupied, Occupancy::Unknown, Occupancy::Free][usize::from(kind % 3)];
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (2, 1)] {
            map.set(Cell::new(x + dx, y + dy), value);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn equals_inflating_anew(
            strewn in prop::collection::vec((0..SIDE, 0..SIDE, 0_u8..3), 0..400),
            changes in prop::collection::vec((0..SIDE, 0..SIDE, 0_u8..3, 0..9, 0..9), 1..12),
            radius in 1_u32..12,
        ) {
            let mut map = rooms(&strewn);
            let mut kept = InflatedMap::new(radius);
            kept.update(map.clone());
            for (x, y, kind, dx, dy) in changes {
                change(&mut map, (x, y, kind));
                change(&mut map, (x + dx, y + dy, kind + 1));
                prop_assert_eq!(&*kept.update(map.clone()), &inflate(&map, radius));
            }
        }
    }

    #[test]
    fn a_small_change_is_patched_and_a_map_that_grew_is_inflated_anew() {
        let mut kept = InflatedMap::new(9);
        let mut map = rooms(&[]);
        kept.update(map.clone());
        change(&mut map, (100, 100, 0));
        let known = kept.known.clone().unwrap();
        assert!(known.calm && kept.patched(known, &map).is_some());
        let frame = GridFrame { width: SIDE + 8, ..*map.frame() };
        let grown = OccupancyGrid::filled(frame, Occupancy::Free);
        let known = kept.known.clone().unwrap();
        assert!(kept.patched(known, &grown).is_none());
        assert_eq!(*kept.update(grown.clone()), inflate(&grown, 9));
    }

    #[test]
    fn fires_that_wind_for_long_are_not_patched() {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 200, height: 200 };
        let mut map = OccupancyGrid::filled(frame, Occupancy::Unknown);
        // A winding lane of free cells, one obstacle at its end.
        for row in 0..6 {
            for x in 0..7 {
                map.set(Cell::new(100 + x, 100 + 2 * row), Occupancy::Free);
            }
            map.set(
                Cell::new(if row % 2 == 0 { 106 } else { 100 }, 101 + 2 * row),
                Occupancy::Free,
            );
        }
        map.set(Cell::new(103, 100), Occupancy::Occupied);
        let mut kept = InflatedMap::new(9);
        assert_eq!(*kept.update(map.clone()), inflate(&map, 9));
        assert!(!kept.known.as_ref().unwrap().calm);
        map.set(Cell::new(102, 102), Occupancy::Occupied);
        assert_eq!(*kept.update(map.clone()), inflate(&map, 9));
    }
}
