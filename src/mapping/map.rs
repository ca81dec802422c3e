//! Hits and visits per cell, and the occupancy that follows from them.

use super::beam_ends::BeamEnds;
use crate::geometry::{Bounds, Point, Pose};
use crate::grid::{Cell, Grid, GridFrame, Occupancy, OccupancyGrid, Walk};
use crate::robot::{BeamDirections, Scan};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rule by which a scan is taken into the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanRule {
    /// Side of a cell (m).
    pub resolution: f64,
    /// Beams are cut to this range (m): beyond it they mark free space and no hit. GMapping's `maxUrange`.
    pub clip_range: f64,
    /// A visited cell is occupied where more than this share of its visits were hits. GMapping's `occ_thresh`.
    pub hit_ratio: f64,
    /// What a beam tells that comes back with nothing.
    pub no_return: NoReturn,
}

/// What a beam tells that comes back with nothing within the scanner's range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoReturn {
    /// Free floor up to the scanner's range, or to where beams are cut: Cartographer's `missing_data_ray_length`,
    /// `inf_is_valid` of ROS' costmaps.
    #[default]
    Free,
    /// Nothing, as GMapping has it: whoever sees no wall learns nothing.
    Nothing,
}

/// A cell that changed, as a place that stays valid when the map grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// The cell on the endless lattice whose cell (0, 0) has its corner at the map frame's origin.
    pub cell: Cell,
    /// Its occupancy before.
    pub from: Occupancy,
    /// Its occupancy now.
    pub to: Occupancy,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Count {
    hits: u16,
    visits: u16,
}

/// A map that grows as the robot sees more.
#[derive(Debug, Clone)]
pub struct OccupancyMap {
    rule: ScanRule,
    counts: Grid<Count>,
    grid: OccupancyGrid,
    /// Lattice cell of the grid's cell (0, 0).
    offset: Cell,
    /// Each cell that changed since `flipped` was empty, once, with its occupancy then.
    changes: Vec<Change>,
    /// A bit for each cell of the grid, set where the cell is among `changes`.
    flipped: Vec<u64>,
    /// Memory for the ends of a scan's beams.
    ends: Vec<(Point, bool)>,
    lines: Vec<Line>,
    directions: BeamDirections,
}

/// The beams of a scan that end in one cell, in the same way: they cross the same cells.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// The grid's index of the cell they end in.
    to: usize,
    is_hit: bool,
    beams: u16,
}

/// How many lines are remembered while others are sought that end in the same cell: with noise, neighbouring beams end in a
/// handful of cells.
const LATELY: usize = 64;

/// Cells added beyond what is needed when the map grows, so that it grows seldom.
const MARGIN: i32 = 32;

impl OccupancyMap {
    /// Creates an empty map around the origin.
    pub fn new(rule: ScanRule) -> Self {
        let frame =
            GridFrame { resolution: rule.resolution, origin: Point::ZERO, width: 0, height: 0 };
        Self {
            rule,
            counts: Grid::filled(frame, Count { hits: 0, visits: 0 }),
            grid: OccupancyGrid::filled(frame, Occupancy::Unknown),
            offset: Cell::new(0, 0),
            changes: Vec::new(),
            flipped: Vec::new(),
            ends: Vec::new(),
            lines: Vec::new(),
            directions: BeamDirections::default(),
        }
    }

    /// Returns the map so far.
    pub fn grid(&self) -> &OccupancyGrid {
        &self.grid
    }

    /// Returns the lattice cell of the grid's cell (0, 0): lattice = grid cell + offset.
    pub fn offset(&self) -> Cell {
        self.offset
    }

    /// Returns the occupancy of the lattice `cell`.
    pub fn at_lattice(&self, cell: Cell) -> Occupancy {
        self.grid.at(Cell::new(cell.x - self.offset.x, cell.y - self.offset.y))
    }

    /// Returns the cells that the last scan taken in changed.
    pub(super) fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Integrates `scan`, taken with the robot at `pose`, and returns the cells that changed.
    ///
    /// Per beam the cells before the end are visited, and the end is hit unless the beam was cut or came back with nothing;
    /// such a one may also mark nothing at all, as the rule has it.
    pub fn integrate(&mut self, pose: Pose, scan: &Scan) -> &[Change] {
        self.changes.clear();
        let beams = BeamEnds::of(scan, self.rule, &mut self.directions);
        self.add(pose, &beams);
        self.tell()
    }

    /// Takes out the scans of `removed`, integrates those of `added`, and returns the cells that changed.
    ///
    /// Counts add up, so the map is then as if it had never seen what was taken out. A count that is full (65,535
    /// visits of a cell) stays as it is.
    pub(super) fn redraw<'a>(
        &mut self,
        removed: impl IntoIterator<Item = (Pose, &'a BeamEnds)>,
        added: impl IntoIterator<Item = (Pose, &'a BeamEnds)>,
    ) -> &[Change] {
        self.changes.clear();
        for (pose, beams) in removed {
            self.remove(pose, beams);
        }
        for (pose, beams) in added {
            self.add(pose, beams);
        }
        self.tell()
    }

    fn add(&mut self, pose: Pose, beams: &BeamEnds) {
        let sensor = pose.compose(beams.mount).position();
        let reach = self.place(pose, beams);
        self.grow_to(reach);
        let (from, lines) = self.lines(sensor);
        let frame = *self.grid.frame();
        for &Line { to, is_hit, beams } in &lines {
            walk(&frame, from, frame.cell_of(to), is_hit, |index, is_hit| {
                if is_hit {
                    self.visit(index, beams, beams);
                } else {
                    self.pass(index, beams);
                }
            });
        }
        self.lines = lines;
    }

    fn remove(&mut self, pose: Pose, beams: &BeamEnds) {
        let sensor = pose.compose(beams.mount).position();
        self.place(pose, beams);
        let (from, lines) = self.lines(sensor);
        let frame = *self.grid.frame();
        for &Line { to, is_hit, beams } in &lines {
            walk(&frame, from, frame.cell_of(to), is_hit, |index, is_hit| {
                self.unvisit(index, beams, if is_hit { beams } else { 0 });
            });
        }
        self.lines = lines;
    }

    /// Places the ends of `beams`, taken with the robot at `pose`, in the map's frame, and returns what holds them and
    /// the sensor.
    fn place(&mut self, pose: Pose, beams: &BeamEnds) -> Bounds {
        let sensor = pose.compose(beams.mount);
        self.ends.clear();
        self.ends.extend(beams.ends.iter().map(|&(end, is_hit)| (sensor.transform(end), is_hit)));
        let start = Bounds::EMPTY.including(sensor.position());
        self.ends.iter().fold(start, |bounds, end| bounds.including(end.0))
    }

    /// Returns the cell of the `sensor`, and the lines from there to the ends last placed: those of neighbouring beams that
    /// end in one cell as one. Counts add up, so it does not matter which are found.
    fn lines(&mut self, sensor: Point) -> (Cell, Vec<Line>) {
        let frame = *self.grid.frame();
        let mut lines = std::mem::take(&mut self.lines);
        lines.clear();
        let mut lately = [usize::MAX; LATELY];
        for &(end, is_hit) in &self.ends {
            let Some(to) = frame.index(frame.cell_at(end)) else { continue };
            // The line that ended in this cell, or in one that shares the place, last.
            let place = &mut lately[(2 * to + usize::from(is_hit)) % LATELY];
            match lines.get_mut(*place) {
                Some(line) if (line.to, line.is_hit) == (to, is_hit) => line.beams += 1,
                _ => {
                    *place = lines.len();
                    lines.push(Line { to, is_hit, beams: 1 });
                }
            }
        }
        (frame.cell_at(sensor), lines)
    }

    /// Returns the cells that differ from what they were when `changes` was empty, row by row.
    fn tell(&mut self) -> &[Change] {
        // A cell may have changed back and forth in between: only what differs in the end is reported.
        for i in 0..self.changes.len() {
            let change = &mut self.changes[i];
            let cell = Cell::new(change.cell.x - self.offset.x, change.cell.y - self.offset.y);
            change.to = self.grid.at(cell);
            if let Some(index) = self.grid.frame().index(cell) {
                self.flipped[index / 64] = 0;
            }
        }
        self.changes.retain(|change| change.to != change.from);
        self.changes.sort_unstable_by_key(|c| (c.cell.y, c.cell.x));
        &self.changes
    }

    /// Counts `times` visits of a cell without a hit.
    fn pass(&mut self, index: usize, times: u16) {
        let count = &mut self.counts.values_mut()[index];
        // Most cells: never hit, and known to be free since the first visit.
        if count.hits == 0 && count.visits > 0 {
            count.visits = count.visits.saturating_add(times);
        } else {
            self.visit(index, times, 0);
        }
    }

    /// Counts `times` visits of a cell, `hits` of them with a hit.
    fn visit(&mut self, index: usize, times: u16, hits: u16) {
        let count = &mut self.counts.values_mut()[index];
        count.visits = count.visits.saturating_add(times);
        count.hits = count.hits.saturating_add(hits);
        self.look(index);
    }

    /// Updates the occupancy of a cell from its counts.
    fn look(&mut self, index: usize) {
        let count = self.counts.values()[index];
        let is_occupied =
            count.hits > 0 && f64::from(count.hits) / f64::from(count.visits) > self.rule.hit_ratio;
        let now = match count.visits {
            0 => Occupancy::Unknown,
            _ if is_occupied => Occupancy::Occupied,
            _ => Occupancy::Free,
        };
        let value = &mut self.grid.values_mut()[index];
        let was = *value;
        if was != now {
            *value = now;
            let cell = self.grid.frame().cell_of(index);
            let lattice = Cell::new(cell.x + self.offset.x, cell.y + self.offset.y);
            let (word, bit) = (&mut self.flipped[index / 64], 1 << (index % 64));
            if *word & bit == 0 {
                *word |= bit;
                self.changes.push(Change { cell: lattice, from: was, to: now });
            }
        }
    }

    /// Undoes `times` visits of a cell, `hits` of them with a hit.
    fn unvisit(&mut self, index: usize, times: u16, hits: u16) {
        let count = &mut self.counts.values_mut()[index];
        if count.visits == u16::MAX {
            return;
        }
        count.visits = count.visits.saturating_sub(times);
        if count.hits > 0 || count.visits == 0 {
            count.hits = count.hits.saturating_sub(hits);
            self.look(index);
        }
    }

    fn grow_to(&mut self, bounds: Bounds) {
        let old = *self.grid.frame();
        let resolution = self.rule.resolution;
        let lattice = GridFrame { resolution, origin: Point::ZERO, width: 0, height: 0 };
        let (low, high) = (lattice.cell_at(bounds.min), lattice.cell_at(bounds.max));
        let (old_low, old_high) =
            (self.offset, Cell::new(self.offset.x + old.width - 1, self.offset.y + old.height - 1));
        let inside = !old.is_empty()
            && low.x >= old_low.x
            && low.y >= old_low.y
            && high.x <= old_high.x
            && high.y <= old_high.y;
        if inside {
            return;
        }
        let (low, high) = if old.is_empty() {
            (low, high)
        } else {
            (
                Cell::new(low.x.min(old_low.x), low.y.min(old_low.y)),
                Cell::new(high.x.max(old_high.x), high.y.max(old_high.y)),
            )
        };
        let offset = Cell::new(low.x - MARGIN, low.y - MARGIN);
        let frame = GridFrame {
            resolution,
            origin: Point::new(f64::from(offset.x) * resolution, f64::from(offset.y) * resolution),
            width: high.x - low.x + 1 + 2 * MARGIN,
            height: high.y - low.y + 1 + 2 * MARGIN,
        };
        let mut counts = Grid::filled(frame, Count { hits: 0, visits: 0 });
        let mut grid = OccupancyGrid::filled(frame, Occupancy::Unknown);
        let width = usize::try_from(old.width).unwrap_or(0);
        for y in 0..old.height {
            let there = Cell::new(self.offset.x - offset.x, y + self.offset.y - offset.y);
            let (Some(from), Some(to)) = (old.index(Cell::new(0, y)), frame.index(there)) else {
                continue;
            };
            let (from, to) = (from..from + width, to..to + width);
            counts.values_mut()[to.clone()].copy_from_slice(&self.counts.values()[from.clone()]);
            grid.values_mut()[to].copy_from_slice(&self.grid.values()[from]);
        }
        (self.counts, self.grid, self.offset) = (counts, grid, offset);
        // The cells that changed in this round so far have new indices.
        self.flipped = vec![0; frame.len().div_ceil(64)];
        for change in &self.changes {
            let cell = Cell::new(change.cell.x - offset.x, change.cell.y - offset.y);
            if let Some(index) = frame.index(cell) {
                self.flipped[index / 64] |= 1 << (index % 64);
            }
        }
    }
}

/// Visits the cells of the line `from` .. `to` by index, its end only where that is a hit. Both are within the grid,
/// and so is what lies between.
fn walk(frame: &GridFrame, from: Cell, to: Cell, is_hit: bool, mut visit: impl FnMut(usize, bool)) {
    let (Some(first), Some(last)) = (frame.index(from), frame.index(to)) else { return };
    for offset in Walk::new(from, to, frame.width).offsets() {
        visit(first.wrapping_add_signed(offset), false);
    }
    if is_hit {
        visit(last, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::line;
    use crate::units::Tick;
    use proptest::prelude::*;

    const RULE: ScanRule = ScanRule {
        resolution: 0.1,
        clip_range: 5.0,
        hit_ratio: 0.05,
        no_return: NoReturn::Nothing,
    };

    fn scan(ranges: Vec<f64>) -> Scan {
        #[expect(clippy::cast_precision_loss, reason = "small")]
        let increment = std::f64::consts::PI / (ranges.len().max(2) - 1) as f64;
        Scan {
            stamp: Tick(0),
            mount: Pose::new(0.1, 0.0, 0.0),
            min_angle: -std::f64::consts::FRAC_PI_2,
            increment,
            min_range: 0.01,
            max_range: 10.0,
            ranges,
        }
    }

    #[test]
    fn a_beam_marks_free_up_to_its_end_and_the_end_occupied() {
        let mut map = OccupancyMap::new(RULE);
        map.integrate(Pose::new(0.05, 0.05, 0.0), &scan(vec![f64::INFINITY, 2.0, f64::INFINITY]));
        let at = |x: f64| map.grid().at(map.grid().frame().cell_at(Point::new(x, 0.05)));
        assert_eq!(
            (at(0.2), at(2.0), at(2.15), at(2.3)),
            (Occupancy::Free, Occupancy::Free, Occupancy::Occupied, Occupancy::Unknown)
        );
    }

    #[test]
    fn a_cut_beam_marks_no_hit_and_no_return_marks_nothing() {
        let mut map = OccupancyMap::new(RULE);
        map.integrate(Pose::new(0.05, 0.05, 0.0), &scan(vec![f64::INFINITY, 9.0, f64::INFINITY]));
        assert_eq!(map.grid().count(Occupancy::Occupied), 0);
        assert_eq!(map.grid().count(Occupancy::Free), 50);
    }

    #[test]
    fn one_hit_in_nineteen_visits_is_an_obstacle_and_in_twenty_is_not() {
        let mut map = OccupancyMap::new(RULE);
        let near = scan(vec![f64::INFINITY, 2.0, f64::INFINITY]);
        let far = scan(vec![f64::INFINITY, 3.0, f64::INFINITY]);
        let pose = Pose::new(0.05, 0.05, 0.0);
        map.integrate(pose, &near);
        for _ in 0..18 {
            map.integrate(pose, &far);
        }
        let cell = map.grid().frame().cell_at(Point::new(2.15, 0.05));
        assert_eq!(map.grid().at(cell), Occupancy::Occupied, "1 of 19");
        let changes = map.integrate(pose, &far).to_vec();
        assert_eq!(map.grid().at(cell), Occupancy::Free, "1 of 20");
        assert_eq!(changes.len(), 1);
        assert_eq!((changes[0].from, changes[0].to), (Occupancy::Occupied, Occupancy::Free));
    }

    proptest! {
        #[test]
        fn walks_are_the_lines_of_the_grid(x in 0..90_i32, y in 0..90_i32, to_x in 0..90_i32, to_y in 0..90_i32) {
            let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 90, height: 90 };
            let (from, to) = (Cell::new(x, y), Cell::new(to_x, to_y));
            let mut walked = Vec::new();
            walk(&frame, from, to, true, |index, is_end| walked.push((frame.cell_of(index), is_end)));
            let expected: Vec<_> = line(from, to).map(|cell| (cell, cell == to)).collect();
            prop_assert_eq!(walked, expected);
        }

        /// Checks that beams that end in one cell count as if each was walked by itself, and that scans taken back count
        /// as if they had never been.
        #[test]
        fn counts_are_those_of_every_beam_by_itself(
            poses in prop::collection::vec((-2.0..2.0, -2.0..2.0, -3.0..3.0), 1..5),
            ranges in prop::collection::vec(prop_oneof![0.05..9.0, Just(0.31), Just(f64::INFINITY)], 5..60),
            back: bool,
        ) {
            let scan = scan(ranges);
            let beams = BeamEnds::of(&scan, RULE, &mut BeamDirections::default());
            let mut map = OccupancyMap::new(RULE);
            for &(x, y, heading) in &poses {
                map.add(Pose::new(x, y, heading), &beams);
            }
            let kept = if back { &poses[1..] } else { &poses[..] };
            if back {
                let (x, y, heading) = poses[0];
                map.remove(Pose::new(x, y, heading), &beams);
            }
            let frame = *map.grid.frame();
            let mut counts = std::collections::BTreeMap::new();
            for &(x, y, heading) in kept {
                let sensor = Pose::new(x, y, heading).compose(beams.mount);
                let from = frame.cell_at(sensor.position());
                for &(end, is_hit) in &beams.ends {
                    let to = frame.cell_at(sensor.transform(end));
                    for cell in line(from, to).filter(|&cell| cell != to || is_hit) {
                        let (visits, hits) = counts.entry(cell).or_insert((0_u16, 0_u16));
                        *visits += 1;
                        *hits += u16::from(cell == to);
                    }
                }
            }
            for cell in frame.cells() {
                let count = map.counts.get(cell).unwrap();
                let expected = counts.get(&cell).copied().unwrap_or((0, 0));
                prop_assert_eq!((count.visits, count.hits), expected, "{:?}", cell);
            }
        }

        /// Checks that growing never loses a known cell, and that the cells reported as changed are exactly those that
        /// changed.
        #[test]
        fn changes_tell_the_whole_story(
            poses in prop::collection::vec((-20.0..20.0, -20.0..20.0, -3.0..3.0), 1..6),
            ranges in prop::collection::vec(0.05..9.0, 5..20),
        ) {
            let mut map = OccupancyMap::new(RULE);
            let mut told = std::collections::BTreeMap::new();
            for (x, y, heading) in poses {
                for change in map.integrate(Pose::new(x, y, heading), &scan(ranges.clone())) {
                    let was = told.insert(change.cell, change.to).unwrap_or(Occupancy::Unknown);
                    prop_assert_eq!(was, change.from);
                    prop_assert!(change.to != Occupancy::Unknown);
                }
            }
            let known = map.grid().values().iter().filter(|&&v| v != Occupancy::Unknown).count();
            prop_assert_eq!(known, told.len());
            for (cell, value) in told {
                prop_assert_eq!(map.at_lattice(cell), value);
            }
        }
    }
}
