//! I(p): "the estimate of the amount of new (unexplored) area visible from p" (section 3.2).

use super::field_of_view::{Headings, Sector};
use crate::geometry::{Bounds, Point, Pose};
use crate::grid::{
    Axis, Cell, CellSet, GridFrame, Occupancy, OccupancyGrid, QUADRANTS, Run, examine_quadrant,
    examine_runs,
};

/// The data needed to estimate I(p) on one state of the map.
#[derive(Debug)]
pub struct InformationGain {
    /// Lattice cell of the map's cell (0, 0).
    offset: Cell,
    /// The lattice cells that anything is known of.
    low: Cell,
    high: Cell,
    /// Range of the scanner in cells.
    range: i32,
    /// Area of a cell (m²).
    cell_area: f64,
    /// Lattice cells that are unknown in the map.
    unknown: CellSet,
    /// Lattice cells that end lines of sight.
    blocking: CellSet,
}

impl InformationGain {
    /// Prepares the map M_E so far, whose cell (0, 0) is the lattice cell `offset`, and the prior PK_E on the same
    /// lattice, if there is one; for a scanner that sees `range` cells far. Without a prior, `known_obstacles_occlude`
    /// decides whether known obstacles hide what lies behind them.
    pub fn new(
        map: &OccupancyGrid,
        offset: Cell,
        prior: Option<&AlignedPrior>,
        range: i32,
        known_obstacles_occlude: bool,
    ) -> Self {
        let frame = map.frame();
        // Everything visible from any cell of the map, and a little more.
        let beyond = range + 8;
        let low = Cell::new(offset.x - beyond, offset.y - beyond);
        let high = Cell::new(offset.x + frame.width + beyond, offset.y + frame.height + beyond);
        let word =
            |x: i32, y: i32, value: Occupancy| word_of(map, x - offset.x, y - offset.y, value);
        let unknown = CellSet::of_words(low, high, |x, y| word(x, y, Occupancy::Unknown));
        let blocking = CellSet::of_words(low, high, |x, y| {
            let is_hiding = prior.is_some() || known_obstacles_occlude;
            let obstacles = if is_hiding { word(x, y, Occupancy::Occupied) } else { 0 };
            obstacles | prior.map_or(0, |prior| !prior.free_word(x, y))
        });
        let cell_area = frame.resolution * frame.resolution;
        Self { offset, low, high, range, cell_area, unknown, blocking }
    }

    /// Returns the lattice cells on which the gain depends that changed since the `earlier` state of the map.
    pub(super) fn changes_since(&self, earlier: &Self) -> CellSet {
        CellSet::of_words(self.low, self.high, |x, y| {
            let changed = |now: &CellSet, then: &CellSet| match (now.word(x, y), then.word(x, y)) {
                (Some(now), Some(then)) => now ^ then,
                // Beyond what was visible from the map of then.
                _ => 0,
            };
            changed(&self.unknown, &earlier.unknown) | changed(&self.blocking, &earlier.blocking)
        })
    }

    /// Computes I(p) in m², from the map cell `p`, looking all round.
    ///
    /// With a prior, the cells c of M_E that are unknown, within range, and satisfy the three conditions of
    /// section 3.2: c_PK is free; c_PK is visible from p_PK in PK_E; c is visible from p in M_E. Both grids
    /// have the same lattice here, so both lines of sight are one line over both grids' obstacles.
    ///
    /// Without (Figure 2b), every unknown cell within range.
    ///
    /// Adds the runs of lattice cells to `examined` whose state decides that.
    pub fn at(&self, p: Cell, examined: &mut Vec<Run>) -> f64 {
        self.area((0..QUADRANTS).map(|quadrant| self.in_quadrant(quadrant, p, examined)).sum())
    }

    /// Counts the cells that make up I(p) in one quadrant of the disc around `p`, which itself is taken for part of the first.
    pub(super) fn in_quadrant(&self, quadrant: usize, p: Cell, examined: &mut Vec<Run>) -> u32 {
        let p = self.lattice(p);
        let mut cells = 0;
        if quadrant == 0 {
            let own = Run { axis: Axis::X, line: p.y, from: p.x, to: p.x };
            examined.push(own);
            cells += self.unknown.count(own);
        }
        let examine = |run| examined.push(run);
        let see = |run| cells += self.unknown.count(run);
        examine_quadrant(quadrant, p, self.range, &self.blocking, examine, see);
        cells
    }

    /// Computes the same for the cells within `sector`.
    pub(super) fn within(&self, p: Cell, sector: Sector) -> f64 {
        let mut cells = 0;
        self.each_unknown(p, &mut Vec::new(), |offset| cells += u32::from(sector.contains(offset)));
        self.area(cells)
    }

    /// Counts the cells for the best of all headings.
    pub(super) fn best(&self, p: Cell, headings: &Headings, examined: &mut Vec<Run>) -> u32 {
        let mut cells = vec![0; headings.count()];
        let mut here = 0;
        self.each_unknown(p, examined, |offset| match offset {
            Cell { x: 0, y: 0 } => here += 1,
            _ => cells[headings.direction(offset)] += 1,
        });
        here + headings.most(&cells)
    }

    fn see(&self, p: Cell, examined: &mut Vec<Run>, see: impl FnMut(Run)) {
        let examine = |run| examined.push(run);
        examine_runs(self.lattice(p), self.range, &self.blocking, examine, see);
    }

    /// Passes to `count` every cell that counts, as its offset from `p`.
    fn each_unknown(&self, p: Cell, examined: &mut Vec<Run>, mut count: impl FnMut(Cell)) {
        let origin = self.lattice(p);
        let mut members = Vec::new();
        self.see(p, examined, |run| {
            members.clear();
            self.unknown.members(run, &mut members);
            for cell in members.iter().map(|&along| run.cell(along)) {
                count(Cell::new(cell.x - origin.x, cell.y - origin.y));
            }
        });
    }

    /// Returns the area of so many cells (m²).
    pub(super) fn area(&self, cells: u32) -> f64 {
        f64::from(cells) * self.cell_area
    }

    /// Returns the lattice cell of a cell of the map.
    pub(super) fn lattice(&self, cell: Cell) -> Cell {
        Cell::new(cell.x + self.offset.x, cell.y + self.offset.y)
    }
}

/// Returns which of the 64 cells of `map` from (`x`, `y`) on along x hold `value`; those outside are unknown.
fn word_of(map: &OccupancyGrid, x: i32, y: i32, value: Occupancy) -> u64 {
    let frame = map.frame();
    let outside = if value == Occupancy::Unknown { u64::MAX } else { 0 };
    let (first, end) = (x.max(0), (x + 64).min(frame.width));
    if first >= end {
        return outside;
    }
    let Some(index) = frame.index(Cell::new(first, y)) else { return outside };
    #[expect(clippy::cast_sign_loss, reason = "a part of 64 cells")]
    let (skipped, length) = ((first - x) as usize, (end - first) as usize);
    let cells = &map.values()[index..index + length];
    let mask = (u64::MAX >> (64 - length)) << skipped;
    // Most words are all of one kind, which counting finds faster than going bit by bit.
    let inside = match cells.iter().map(|&cell| u8::from(cell == value)).sum::<u8>() {
        0 => 0,
        all if usize::from(all) == length => mask >> skipped,
        _ => cells.iter().rev().fold(0, |bits, &cell| bits << 1 | u64::from(cell == value)),
    };
    (outside & !mask) | (inside << skipped)
}

/// A prior map transformed to the lattice of the robot's own map, by the start pose known in both (section 3.2).
#[derive(Debug, Clone)]
pub struct AlignedPrior {
    free: OccupancyGrid,
    corner: Cell,
}

impl AlignedPrior {
    /// Aligns `prior` (world frame) to the lattice of `resolution` m cells whose frame is the pose `start`: each
    /// lattice cell takes the value of "the cell with the closest center after scaling and alignment".
    pub fn new(prior: &OccupancyGrid, start: Pose, resolution: f64) -> Self {
        let (free, corner) = on_lattice(prior, start, resolution);
        Self { free, corner }
    }

    /// Returns which of the 64 lattice cells from (`x`, `y`) on along x are free in the prior.
    pub(super) fn free_word(&self, x: i32, y: i32) -> u64 {
        word_of(&self.free, x - self.corner.x, y - self.corner.y, Occupancy::Free)
    }

    /// Returns whether the lattice `cell` is free in the prior: neither occupied nor unknown nor outside of it.
    pub fn is_free(&self, cell: Cell) -> bool {
        self.free.at(Cell::new(cell.x - self.corner.x, cell.y - self.corner.y)) == Occupancy::Free
    }
}

/// Lays `map` (world frame) on the lattice of `resolution` m cells whose frame is the pose `origin`, each lattice cell with
/// the value of the map's cell with the closest centre, of two as close the upper; returns it with the lattice cell of its
/// cell (0, 0).
pub(super) fn on_lattice(
    map: &OccupancyGrid,
    origin: Pose,
    resolution: f64,
) -> (OccupancyGrid, Cell) {
    let area = map.frame().bounds();
    let corners = [
        area.min,
        Point::new(area.max.x, area.min.y),
        area.max,
        Point::new(area.min.x, area.max.y),
    ];
    let bounds = corners
        .iter()
        .fold(Bounds::EMPTY, |b, &corner| b.including(origin.inverse_transform(corner)));
    let frame = GridFrame::covering(bounds, resolution);
    let lattice = GridFrame { origin: Point::ZERO, ..frame };
    // Half a cell in, so that rounding cannot choose the neighbour.
    let half = Point::new(resolution / 2.0, resolution / 2.0);
    let corner = lattice.cell_at(frame.origin + half);
    // A lattice about the start lies half a cell off maps whose cells begin at whole ones: each of its centres is as close to
    // two of theirs, and rounding must not choose between them at random.
    let upward = half * 1e-6;
    let cells = frame
        .cells()
        .map(|cell| {
            let center = lattice.center(Cell::new(cell.x + corner.x, cell.y + corner.y));
            map.at(map.frame().cell_at(origin.transform(center) + upward))
        })
        .collect();
    (OccupancyGrid::from_cells(frame, cells), corner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid(origin: Point, value: Occupancy) -> OccupancyGrid {
        let frame = GridFrame { resolution: 0.1, origin, width: 40, height: 40 };
        OccupancyGrid::filled(frame, value)
    }

    /// Returns a prior with a wall at x = 1 m in the world, free elsewhere.
    fn prior() -> OccupancyGrid {
        let mut prior = grid(Point::ZERO, Occupancy::Free);
        for y in 0..40 {
            prior.set(Cell::new(10, y), Occupancy::Occupied);
        }
        prior
    }

    #[test]
    fn a_wall_of_the_prior_hides_what_lies_behind_it() {
        let map = grid(Point::ZERO, Occupancy::Unknown);
        let aligned = AlignedPrior::new(&prior(), Pose::default(), 0.1);
        let gain = |prior| InformationGain::new(&map, Cell::new(0, 0), prior, 8, true);
        let p = Cell::new(8, 20);
        let without = gain(None).at(p, &mut Vec::new());
        let with = gain(Some(&aligned)).at(p, &mut Vec::new());
        let disc = (-8..=8_i32)
            .flat_map(|x| (-8..=8_i32).map(move |y| (x, y)))
            .filter(|(x, y)| x * x + y * y <= 64);
        assert!(
            (without - 0.01 * f64::from(u32::try_from(disc.clone().count()).unwrap())).abs() < 1e-9
        );
        let this_side = u32::try_from(disc.filter(|(x, _)| *x < 2).count()).unwrap();
        assert!((with - 0.01 * f64::from(this_side)).abs() < 1e-9, "{with}");
    }

    #[test]
    fn known_cells_are_no_gain_and_known_obstacles_hide() {
        let mut map = grid(Point::ZERO, Occupancy::Unknown);
        for y in 0..40 {
            map.set(Cell::new(10, y), Occupancy::Occupied);
            map.set(Cell::new(9, y), Occupancy::Free);
        }
        let gain = |occlude| {
            let gain = InformationGain::new(&map, Cell::new(0, 0), None, 3, occlude);
            gain.at(Cell::new(9, 20), &mut Vec::new())
        };
        let (hidden, open) = (gain(true), gain(false));
        // Columns 6, 7 and 8 of the disc are unknown: 1 + 5 + 5 cells; behind the wall as many less the wall's.
        assert!((hidden - 0.11).abs() < 1e-9, "{hidden}");
        assert!((open - 0.17).abs() < 1e-9, "{open}");
    }

    #[test]
    fn half_a_view_sees_half_and_the_best_half_is_the_unknown_one() {
        use crate::studies::prior_map::field_of_view::{FieldOfView, Headings};
        use std::f64::consts::{FRAC_PI_2, PI};
        let mut map = grid(Point::ZERO, Occupancy::Free);
        for cell in map.frame().cells().filter(|c| c.x > 20) {
            map.set(cell, Occupancy::Unknown);
        }
        let gain = InformationGain::new(&map, Cell::new(0, 0), None, 8, true);
        let p = Cell::new(20, 20);
        let view = FieldOfView { min_angle: -FRAC_PI_2, max_angle: FRAC_PI_2 };
        let all = gain.at(p, &mut Vec::new());
        assert_eq!(gain.within(p, view.facing(0.0)), all);
        assert_eq!(gain.within(p, view.facing(PI)), 0.0);
        assert!((gain.within(p, view.facing(FRAC_PI_2)) - all / 2.0).abs() <= 0.041);
        let best = gain.best(p, &Headings::new(8, view.width()), &mut Vec::new());
        assert_eq!(gain.area(best), all);
    }

    proptest! {
        /// Checks that sets of cells read by words hold what the map and the prior hold cell by cell, wherever the
        /// map's cell (0, 0) lies on the lattice, and beyond both.
        #[test]
        fn words_are_cells(
            raw in prop::collection::vec(0_u8..3, 40 * 40), x in -70..70_i32, y in -70..70_i32, px in -3.0..3.0_f64,
        ) {
            let mut map = grid(Point::ZERO, Occupancy::Unknown);
            for (cell, value) in map.values_mut().iter_mut().zip(raw) {
                *cell = [Occupancy::Unknown, Occupancy::Free, Occupancy::Occupied][usize::from(value)];
            }
            let aligned = AlignedPrior::new(&prior(), Pose::new(px, 0.3, 0.2), 0.1);
            let offset = Cell::new(x, y);
            let gain = InformationGain::new(&map, offset, Some(&aligned), 5, true);
            for cell in (-60..110).step_by(3).flat_map(|y| (-60..110).map(move |x| Cell::new(x, y))) {
                let lattice = Cell::new(cell.x + x, cell.y + y);
                let run = Run { axis: Axis::X, line: lattice.y, from: lattice.x, to: lattice.x };
                // As far as anything is visible from the map.
                if (-5..45).contains(&cell.x) && (-5..45).contains(&cell.y) {
                    prop_assert_eq!(gain.unknown.count(run) == 1, map.at(cell) == Occupancy::Unknown);
                    let blocks = map.at(cell) == Occupancy::Occupied || !aligned.is_free(lattice);
                    prop_assert_eq!(gain.blocking.count(run) == 1, blocks);
                }
            }
        }
    }

    /// Checks the same world seen from a start pose elsewhere and turned by a quarter.
    #[test]
    fn alignment_moves_and_turns_the_prior() {
        let start = Pose::new(2.0, 1.0, std::f64::consts::FRAC_PI_2);
        let aligned = AlignedPrior::new(&prior(), start, 0.1);
        // The wall x = 1.0 to 1.1 m of the world is 0.9 to 1.0 m left of the robot.
        assert!(!aligned.is_free(Cell::new(3, 9)));
        assert!(aligned.is_free(Cell::new(3, 8)) && aligned.is_free(Cell::new(3, 10)));
        assert!(
            !aligned.is_free(Cell::new(3, 400)),
            "outside of the prior nothing is known to be free"
        );
    }
}
