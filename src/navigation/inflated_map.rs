//! An inflated map that is kept current: after a change only the cells that it can reach are inflated anew.

use super::CostGrid;
use super::inflation::Fires;
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use std::sync::Arc;

/// A map inflated. What changed between two such states of one map can be asked for.
#[derive(Debug, Clone)]
pub struct Ground {
    /// The costs.
    pub costs: Arc<CostGrid>,
    pub(super) moment: Option<Moment>,
}

impl From<Arc<CostGrid>> for Ground {
    /// Takes costs of which nothing is known but themselves.
    fn from(costs: Arc<CostGrid>) -> Self {
        Self { costs, moment: None }
    }
}

/// A state of an inflated map: how often it was inflated anew, and how many changes were noted since.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Moment {
    renewal: u64,
    changes: usize,
}

/// A map and its inflation. [`InflatedMap::update`] gives what [`super::inflate`] gives, sooner.
///
/// Why only the neighbourhood of a change needs inflating follows from how a brushfire spreads: a difference between two
/// maps gets one cell further (in steps of 4 neighbours) with every step. Let all fires of the map before be out after K
/// steps.
/// 1. Beyond K cells of the change everything is then as before: out.
/// 2. A cut-out that reaches K cells further yet lacks what is beyond its edge, which spreads by a cell a step too, and
///    so is right, after K steps, within K cells of the change.
/// 3. Where the cut-out's fires are out by then, all are, and what is within K cells of the change is final. Where they
///    take longer, which winding free cells can cause, K was too small.
#[derive(Debug, Clone)]
pub struct InflatedMap {
    fires: Fires,
    known: Option<Known>,
    renewal: u64,
    /// The costs (padded indices) that changed since everything was inflated anew, in order.
    changes: Vec<u32>,
}

#[derive(Debug, Clone)]
struct Known {
    /// The map with the cells of `free` free.
    map: OccupancyGrid,
    /// The cell of the lattice that is its cell (0, 0).
    offset: Cell,
    /// Cells of the lattice.
    free: Vec<Cell>,
    costs: Arc<CostGrid>,
    /// After how many steps all fires were out: K.
    steps: u32,
}

/// Changes this near (cells) to each other are taken for one.
const NEAR: i32 = 12;
/// With more changed places than this everything is inflated anew.
const PLACES: usize = 64;
/// More changes than this are not kept: whoever follows them would rather start again.
const REMEMBERED: usize = 1 << 16;

impl InflatedMap {
    /// Creates an empty state, to be inflated over `radius` cells.
    pub fn new(radius: u32) -> Self {
        Self { fires: Fires::new(radius), known: None, renewal: 0, changes: Vec::new() }
    }

    /// Inflates `map`, whose cell (0, 0) is the cell `offset` of a lattice that stays, with the cells of `free` taken for free,
    /// and returns it. `changed` holds all cells in which `map` differs from the one before, and may hold more. Both
    /// are cells of the lattice.
    pub fn update(
        &mut self,
        map: &OccupancyGrid,
        offset: Cell,
        free: &[Cell],
        changed: impl IntoIterator<Item = Cell>,
    ) -> Ground {
        let same_cells = self.known.as_ref().is_some_and(|known| known.map.frame() == map.frame());
        if !same_cells || self.changes.len() > REMEMBERED {
            self.forget();
        }
        let known = self.known.take().and_then(|known| known.grown_to(map.frame(), offset));
        let known = if let Some(known) = known {
            self.renewed(known, map, free, changed)
        } else {
            let mut map = map.clone();
            for cell in free {
                map.set(Cell::new(cell.x - offset.x, cell.y - offset.y), Occupancy::Free);
            }
            self.anew(map, offset, free)
        };
        let costs = Arc::clone(&known.costs);
        self.known = Some(known);
        let moment = Moment { renewal: self.renewal, changes: self.changes.len() };
        Ground { costs, moment: Some(moment) }
    }

    /// Returns the costs (padded indices) that may have changed since `moment`, or `None` where nobody knows.
    pub(super) fn changes_since(&self, moment: Option<Moment>) -> Option<&[u32]> {
        let moment = moment.filter(|moment| moment.renewal == self.renewal)?;
        self.changes.get(moment.changes..)
    }

    fn forget(&mut self) {
        self.renewal += 1;
        self.changes.clear();
    }

    fn anew(&mut self, map: OccupancyGrid, offset: Cell, free: &[Cell]) -> Known {
        self.forget();
        let (costs, steps) = self.fires.spread(&map);
        Known { map, offset, free: free.to_vec(), costs: Arc::new(costs), steps }
    }

    /// Brings `known` up to date.
    fn renewed(
        &mut self,
        mut known: Known,
        map: &OccupancyGrid,
        free: &[Cell],
        changed: impl IntoIterator<Item = Cell>,
    ) -> Known {
        let offset = known.offset;
        let mut places = Vec::new();
        let freed = std::mem::replace(&mut known.free, free.to_vec());
        for lattice in changed.into_iter().chain(freed).chain(free.iter().copied()) {
            let cell = Cell::new(lattice.x - offset.x, lattice.y - offset.y);
            let now = if free.contains(&lattice) { Occupancy::Free } else { map.at(cell) };
            if map.frame().contains(cell) && known.map.at(cell) != now {
                known.map.set(cell, now);
                note(&mut places, cell);
            }
        }
        debug_assert!(
            map.frame().cells().all(|cell| {
                let lattice = Cell::new(cell.x + offset.x, cell.y + offset.y);
                free.contains(&lattice) || known.map.at(cell) == map.at(cell)
            }),
            "a change was not reported"
        );
        if places.is_empty() {
            return known;
        }
        match self.patches(&known, &places) {
            Some((patches, steps)) => {
                known.steps = steps;
                let whole = Arc::make_mut(&mut known.costs);
                for Patch { redone, seen, costs } in patches {
                    for y in redone.low.y..=redone.high.y {
                        let from = Cell::new(redone.low.x - seen.low.x, y - seen.low.y);
                        let to = Cell::new(redone.low.x, y);
                        whole.copy_changes(to, &costs, from, redone.width(), &mut self.changes);
                    }
                }
                known
            }
            None => self.anew(known.map, offset, free),
        }
    }

    /// Inflates the neighbourhoods of the changed `places`, and returns them with the steps after which all fires are
    /// out; `None` where that does not pay.
    fn patches(&self, known: &Known, places: &[Rectangle]) -> Option<(Vec<Patch>, u32)> {
        if places.len() > PLACES {
            return None;
        }
        let frame = known.map.frame();
        let mut steps = known.steps;
        'longer: loop {
            let reach = i32::try_from(steps).ok()?;
            let around = |place: Rectangle| place.grown(2 * reach, frame);
            let places = merged(places.to_vec(), |place| around(place).cells());
            let cost: usize = places.iter().map(|&place| around(place).cells()).sum();
            if 10 * cost > 9 * frame.len() {
                return None;
            }
            let mut patches = Vec::with_capacity(places.len());
            for place in places {
                let (redone, seen) = (place.grown(reach, frame), around(place));
                let (costs, taken) = self.fires.spread(&seen.cut_out(&known.map));
                if taken > steps {
                    steps = taken;
                    continue 'longer;
                }
                patches.push(Patch { redone, seen, costs });
            }
            return Some((patches, steps));
        }
    }
}

impl Known {
    /// Returns the same in `frame`, a map around this one with nothing known in what it adds, whose cell (0, 0) is the cell
    /// `offset` of the lattice; `None` where it is not around this one.
    fn grown_to(self, frame: &GridFrame, offset: Cell) -> Option<Self> {
        let old = *self.map.frame();
        if old == *frame {
            return Some(self);
        }
        let corner = Cell::new(self.offset.x - offset.x, self.offset.y - offset.y);
        let far = Cell::new(corner.x + old.width - 1, corner.y + old.height - 1);
        let is_around =
            old.resolution == frame.resolution && frame.contains(corner) && frame.contains(far);
        if old.is_empty() || !is_around {
            return None;
        }
        let mut map = OccupancyGrid::filled(*frame, Occupancy::Unknown);
        let mut costs = CostGrid::unknown(*frame);
        let width = usize::try_from(old.width).ok()?;
        for y in 0..old.height {
            let (from, to) = (Cell::new(0, y), Cell::new(corner.x, corner.y + y));
            costs.copy_row(to, &self.costs, from, width);
            let (from, to) = (old.index(from)?, frame.index(to)?);
            map.values_mut()[to..to + width]
                .copy_from_slice(&self.map.values()[from..from + width]);
        }
        Some(Self { map, offset, costs: Arc::new(costs), ..self })
    }
}

/// A part of the map inflated by itself.
struct Patch {
    /// The part in which costs are right.
    redone: Rectangle,
    /// The part that was inflated.
    seen: Rectangle,
    costs: CostGrid,
}

/// Adds `cell` to the first of `places` that is near, or as a place of its own.
fn note(places: &mut Vec<Rectangle>, cell: Cell) {
    let alone = Rectangle { low: cell, high: cell };
    match places.iter().position(|place| place.is_near(cell)) {
        Some(i) => places[i] = places[i].including(alone),
        None if places.len() <= PLACES => places.push(alone),
        None => {}
    }
}

/// Joins places where one costs no more than two.
fn merged(mut places: Vec<Rectangle>, cost: impl Fn(Rectangle) -> usize) -> Vec<Rectangle> {
    let mut i = 0;
    while i < places.len() {
        let pays = |j: &usize| {
            let (a, b) = (places[i], places[*j]);
            cost(a.including(b)) <= cost(a) + cost(b)
        };
        if let Some(j) = (i + 1..places.len()).find(pays) {
            places[i] = places[i].including(places.remove(j));
            // What did not pay before may now.
            i = 0;
        } else {
            i += 1;
        }
    }
    places
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

    fn including(self, other: Self) -> Self {
        Self {
            low: Cell::new(self.low.x.min(other.low.x), self.low.y.min(other.low.y)),
            high: Cell::new(self.high.x.max(other.high.x), self.high.y.max(other.high.y)),
        }
    }

    fn is_near(self, cell: Cell) -> bool {
        (self.low.x - NEAR..=self.high.x + NEAR).contains(&cell.x)
            && (self.low.y - NEAR..=self.high.y + NEAR).contains(&cell.y)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::navigation::inflate;
    use proptest::prelude::*;

    const SIDE: i32 = 240;
    /// Where the maps lie on the lattice.
    const AT: Cell = Cell { x: -7, y: 11 };

    fn lattice(cell: Cell) -> Cell {
        Cell::new(cell.x + AT.x, cell.y + AT.y)
    }

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

    fn change(map: &mut OccupancyGrid, (x, y, kind): (i32, i32, u8)) -> Vec<Cell> {
        let value =
            [Occupancy::Occupied, Occupancy::Unknown, Occupancy::Free][usize::from(kind % 3)];
        let cells = [(0, 0), (1, 0), (0, 1), (2, 1)].map(|(dx, dy)| Cell::new(x + dx, y + dy));
        for cell in cells {
            map.set(cell, value);
        }
        cells.to_vec()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn equals_inflating_anew(
            strewn in prop::collection::vec((0..SIDE, 0..SIDE, 0_u8..3), 0..400),
            changes in prop::collection::vec((0..SIDE, 0..SIDE, 0_u8..3, 0..90, 0..90), 1..12),
            radius in 1_u32..12,
        ) {
            let mut map = rooms(&strewn);
            let mut kept = InflatedMap::new(radius);
            let mut ground = kept.update(&map, AT, &[], []);
            for (x, y, kind, dx, dy) in changes {
                let mut changed = change(&mut map, (x, y, kind));
                changed.extend(change(&mut map, (x + dx, y + dy, kind + 1)));
                let changed = changed.into_iter().map(lattice);
                let free = [Cell::new(y, x), Cell::new(y + 1, x)];
                let mut with_place = map.clone();
                for cell in free {
                    with_place.set(cell, Occupancy::Free);
                }
                let before = ground;
                ground = kept.update(&map, AT, &free.map(lattice), changed);
                prop_assert_eq!(&*ground.costs, &inflate(&with_place, radius));
                if let Some(told) = kept.changes_since(before.moment) {
                    let (old, new) = (before.costs.padded(), ground.costs.padded());
                    let changed = (0..old.len()).filter(|&i| old[i] != new[i]);
                    let told: std::collections::BTreeSet<_> = told.iter().map(|&i| i as usize).collect();
                    prop_assert!(changed.eq(told));
                }
            }
        }
    }

    #[test]
    fn small_changes_are_patched_each_by_itself() {
        let mut kept = InflatedMap::new(9);
        let mut map = rooms(&[]);
        kept.update(&map, AT, &[], []);
        let mut places = Vec::new();
        for at in [(20, 20, 0), (220, 220, 0)] {
            for cell in change(&mut map, at) {
                note(&mut places, cell);
            }
        }
        assert_eq!(places.len(), 2);
        let known = kept.known.clone().unwrap();
        let (patches, _) = kept.patches(&known, &places).unwrap();
        assert_eq!(patches.len(), 2, "one for each is cheaper than one for both");
        let crowd = vec![places[0]; PLACES + 1];
        assert!(kept.patches(&known, &crowd).is_none());
    }

    #[test]
    fn a_map_that_grew_keeps_what_was_known() {
        let map = rooms(&[]);
        let mut kept = InflatedMap::new(9);
        kept.update(&map, AT, &[], []);
        let frame = GridFrame { width: SIDE + 40, height: SIDE + 9, ..*map.frame() };
        let mut grown = OccupancyGrid::filled(frame, Occupancy::Unknown);
        for cell in map.frame().cells() {
            grown.set(Cell::new(cell.x + 31, cell.y + 2), map.at(cell));
        }
        let known = kept.known.clone().unwrap().grown_to(&frame, Cell::new(AT.x - 31, AT.y - 2));
        assert_eq!(*known.unwrap().costs, inflate(&grown, 9));
        let elsewhere = kept.known.clone().unwrap().grown_to(&frame, Cell::new(AT.x + 1, AT.y));
        assert!(elsewhere.is_none());
        let place = Cell::new(150, 150);
        grown.set(place, Occupancy::Occupied);
        let offset = Cell::new(AT.x - 31, AT.y - 2);
        let changed = [Cell::new(place.x + offset.x, place.y + offset.y)];
        assert_eq!(*kept.update(&grown, offset, &[], changed).costs, inflate(&grown, 9));
    }

    #[test]
    fn fires_that_wind_for_long_are_waited_for() {
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
        assert_eq!(*kept.update(&map, AT, &[], []).costs, inflate(&map, 9));
        assert_eq!(kept.known.as_ref().unwrap().steps, 36);
        let obstacle = Cell::new(102, 102);
        map.set(obstacle, Occupancy::Occupied);
        let ground = kept.update(&map, AT, &[], [lattice(obstacle)]);
        assert_eq!(*ground.costs, inflate(&map, 9));
    }
}
