//! The recent surroundings of the robot: a rolling window for the operator.

use crate::geometry::{Point, Pose};
use crate::grid::{Cell, GridFrame, Walk};
use crate::math;
use crate::robot::{BeamDirections, Scan};

/// Size and reach of the window (prior-map facts, section 4, `costmap.yaml`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalRule {
    /// Side of the square window (m).
    pub size: f64,
    /// Side of a cell (m).
    pub resolution: f64,
    /// Ends of beams within this range (m) mark obstacles.
    pub obstacle_range: f64,
    /// Distances to obstacles are known up to this (m), at most 11 cells.
    pub inflation_radius: f64,
    /// Radius around the robot (m) that is free because the robot is there.
    pub own_radius: f64,
    /// Each range is replaced by the median of this many neighbouring ones (odd; 1 leaves them as they are), so
    /// that single noisy beams draw no obstacles.
    pub median_beams: usize,
}

impl Default for LocalRule {
    fn default() -> Self {
        Self {
            size: 6.0,
            resolution: 0.05,
            obstacle_range: 5.0,
            inflation_radius: 0.35,
            own_radius: 0.3,
            median_beams: 1,
        }
    }
}

/// The largest distance in cells for which two squares of it fit into the bytes that are compared many at once.
const FURTHEST: u8 = 11;
/// How many medians are sought together.
const LANES: usize = 16;
/// How many cells are looked at together for obstacles.
const LOT: usize = 24;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    Unknown,
    Free,
    Obstacle,
}

/// The window, in the odometry frame, moving with the robot by whole cells.
#[derive(Debug, Clone)]
pub struct LocalMap {
    rule: LocalRule,
    side: i32,
    /// Lattice cell of the window's cell (0, 0).
    corner: Cell,
    seen: Vec<Seen>,
    shifted: Vec<Seen>,
    /// Squared distance in cells to the nearest obstacle; more than the square of `reach` where none is so near.
    clearance: Vec<u8>,
    /// The same, of obstacles in the cell's own row alone, and which rows have any.
    nearness: Vec<u8>,
    has_obstacle: Vec<bool>,
    /// How far obstacles are felt (cells), and the squares from there over 0 to there.
    reach: u8,
    squares: Vec<u8>,
    /// Distance (m) of a squared distance in cells, as far as the disc reaches.
    metres: Vec<f64>,
    directions: BeamDirections,
    ends: Vec<Cell>,
    /// Lines that beams clear, in the order of the beams: each with its steps in the window.
    lines: Vec<(Walk, i32)>,
    ranges: Vec<f64>,
    /// Memory for the medians.
    windows: Vec<[f64; LANES]>,
    window: Vec<f64>,
}

impl LocalMap {
    /// Creates a window around the origin in which nothing was seen.
    pub fn new(rule: LocalRule) -> Self {
        let count = |metres: f64| {
            #[expect(clippy::cast_possible_truncation, reason = "a window has few cells")]
            let cells = (metres / rule.resolution).round() as i32;
            cells
        };
        let side = count(rule.size);
        let reach = u8::try_from(count(rule.inflation_radius)).unwrap_or(FURTHEST).min(FURTHEST);
        let square = |x: u8| x * x;
        let squares = (0..=2 * reach).map(|x| square(x.abs_diff(reach))).collect();
        let metres = (0..=square(reach)).map(|s| f64::from(s).sqrt() * rule.resolution);
        let cells =
            GridFrame { resolution: 1.0, origin: Point::ZERO, width: side, height: side }.len();
        Self {
            rule,
            side,
            corner: Cell::new(-side / 2, -side / 2),
            seen: vec![Seen::Unknown; cells],
            shifted: Vec::new(),
            clearance: vec![u8::MAX; cells],
            nearness: vec![u8::MAX; cells],
            has_obstacle: vec![false; usize::try_from(side).unwrap_or(0)],
            reach,
            squares,
            metres: metres.collect(),
            directions: BeamDirections::default(),
            ends: Vec::new(),
            lines: Vec::new(),
            ranges: Vec::new(),
            windows: Vec::new(),
            window: Vec::new(),
        }
    }

    /// Takes in `scan`, taken at `pose`: beams clear the cells they cross, then their ends mark obstacles.
    pub fn update(&mut self, pose: Pose, scan: &Scan) {
        self.move_to(pose);
        let sensor = pose.compose(scan.mount);
        let from = self.lattice(sensor.position());
        self.ends.clear();
        self.lines.reserve(scan.ranges.len());
        self.smooth(&scan.ranges);
        let mut cleared = None;
        let mut directions = std::mem::take(&mut self.directions);
        let (sin, cos) = math::sin_cos(sensor.heading);
        for (i, direction) in directions.of(scan).iter().enumerate() {
            let range = self.ranges[i];
            let reach = range.min(scan.max_range).min(self.rule.size);
            let turned = Point::new(
                cos * direction.x - sin * direction.y,
                sin * direction.x + cos * direction.y,
            );
            let to = self.lattice(sensor.position() + turned * reach);
            // Neighbouring beams often end in one cell.
            if cleared != Some(to) {
                self.lines.push(self.line(from, to));
                cleared = Some(to);
            }
            if range < self.rule.obstacle_range.min(self.rule.size) {
                self.ends.push(to);
            }
        }
        self.directions = directions;
        self.clear_lines(from);
        for i in 0..self.ends.len() {
            if let Some(index) = self.index(self.ends[i]) {
                self.seen[index] = Seen::Obstacle;
            }
        }
        self.clear_own(pose);
        self.measure_clearance();
    }

    /// Returns the distance (m) from `point` (odometry frame) to the nearest obstacle, at most the inflation radius;
    /// `None` where nothing was seen yet or outside of the window.
    pub fn clearance(&self, point: Point) -> Option<f64> {
        let index = self.index(self.lattice(point))?;
        match self.seen[index] {
            Seen::Unknown => None,
            Seen::Obstacle => Some(0.0),
            Seen::Free => {
                let metres = self.metres.get(usize::from(self.clearance[index]));
                Some(metres.copied().unwrap_or(self.rule.inflation_radius))
            }
        }
    }

    /// Takes over `ranges`, each replaced by the median of those around it; by fewer at both ends.
    fn smooth(&mut self, ranges: &[f64]) {
        self.ranges.clear();
        self.ranges.extend_from_slice(ranges);
        let half = self.rule.median_beams / 2;
        if half == 0 {
            return;
        }
        // Many windows at once where all of their ranges exist, some of the last ones twice.
        let mut middle = half;
        if let Some(last) = ranges.len().checked_sub(half + LANES).filter(|last| *last >= half) {
            self.windows.resize(2 * half + 1, [0.0; LANES]);
            while middle < ranges.len() - half {
                let from = middle.min(last);
                for (window, first) in self.windows.iter_mut().zip(from - half..) {
                    window.copy_from_slice(&ranges[first..first + LANES]);
                }
                self.ranges[from..from + LANES].copy_from_slice(&medians(&mut self.windows));
                middle = from + LANES;
            }
        }
        let window = &mut self.window;
        for i in (0..half.min(ranges.len())).chain(middle..ranges.len()) {
            window.clear();
            window.extend_from_slice(
                &ranges[i.saturating_sub(half)..(i + half + 1).min(ranges.len())],
            );
            window.sort_unstable_by(f64::total_cmp);
            self.ranges[i] = window[window.len() / 2];
        }
    }

    /// Returns the walk from `from`, a cell of the window, to `to`, and how many of its steps are in the window.
    fn line(&self, from: Cell, to: Cell) -> (Walk, i32) {
        // How many cells of the window lie ahead, with the first one.
        let room = |at: i32, forward: bool| if forward { self.side - at } else { at + 1 };
        let columns = room(from.x - self.corner.x, to.x >= from.x);
        let rows = room(from.y - self.corner.y, to.y >= from.y);
        let walk = Walk::new(from, to, self.side);
        (walk, walk.steps_within(columns, rows))
    }

    /// Marks the cells of the lines from `from` on as free. A line is passed over as far as it has no cell for itself between the
    /// one before it and the one after; these two as far as the same is true of lines twice as far from them, and so on.
    fn clear_lines(&mut self, from: Cell) {
        let first = self.index(from);
        for (i, &(walk, steps)) in self.lines.iter().enumerate() {
            let Some(first) = first else { break };
            let stride = if i == 0 { self.lines.len() } else { 1 << i.trailing_zeros() };
            let shared = match (i.checked_sub(stride), self.lines.get(i + stride)) {
                (Some(before), Some(&(after, until))) => {
                    let (before, til) = self.lines[before];
                    walk.steps_between(before, after).min(til).min(until)
                }
                _ => 0,
            };
            for offset in walk.offsets_of(shared, steps) {
                self.seen[first.wrapping_add_signed(offset)] = Seen::Free;
            }
        }
        self.lines.clear();
    }

    fn lattice(&self, point: Point) -> Cell {
        let frame = GridFrame {
            resolution: self.rule.resolution,
            origin: Point::ZERO,
            width: self.side,
            height: self.side,
        };
        frame.cell_at(point)
    }

    fn index(&self, cell: Cell) -> Option<usize> {
        let (x, y) = (cell.x - self.corner.x, cell.y - self.corner.y);
        #[expect(clippy::cast_sign_loss, reason = "checked to be inside")]
        ((0..self.side).contains(&x) && (0..self.side).contains(&y))
            .then_some((y * self.side + x) as usize)
    }

    fn move_to(&mut self, pose: Pose) {
        let center = self.lattice(pose.position());
        let corner = Cell::new(center.x - self.side / 2, center.y - self.side / 2);
        if corner == self.corner {
            return;
        }
        self.shifted.clear();
        self.shifted.resize(self.seen.len(), Seen::Unknown);
        let (right, up) = (corner.x - self.corner.x, corner.y - self.corner.y);
        // The columns and rows of the new window that the old one has too.
        let shared = |by: i32| (-by).clamp(0, self.side)..(self.side - by).clamp(0, self.side);
        let columns = shared(right);
        // Of windows side by side no column is shared, and no cell whose index could be computed.
        let rows = if columns.is_empty() { 0..0 } else { shared(up) };
        #[expect(clippy::cast_sign_loss, reason = "inside of both windows")]
        for y in rows {
            let to = (y * self.side + columns.start) as usize;
            let from = ((y + up) * self.side + columns.start + right) as usize;
            let row = self.seen[from..].iter().take(columns.len());
            self.shifted[to..].iter_mut().zip(row).for_each(|(new, old)| *new = *old);
        }
        std::mem::swap(&mut self.seen, &mut self.shifted);
        self.corner = corner;
    }

    fn clear_own(&mut self, pose: Pose) {
        let center = self.lattice(pose.position());
        #[expect(clippy::cast_possible_truncation, reason = "few cells")]
        let reach = (self.rule.own_radius / self.rule.resolution) as i32;
        for y in -reach..=reach {
            for x in -reach..=reach {
                if x * x + y * y <= reach * reach
                    && let Some(index) = self.index(Cell::new(center.x + x, center.y + y))
                    && self.seen[index] == Seen::Unknown
                {
                    self.seen[index] = Seen::Free;
                }
            }
        }
    }

    /// Measures how near obstacles are: within each row first, then across rows, since squared distances add up.
    fn measure_clearance(&mut self) {
        let side = self.nearness.len() / self.has_obstacle.len().max(1);
        let far = self.reach * self.reach + 1;
        // 1. The squared distance to the nearest obstacle of the row.
        self.nearness.fill(far);
        let rows = self.seen.chunks(side).zip(self.nearness.chunks_mut(side));
        for ((seen, near), has_obstacle) in rows.zip(&mut self.has_obstacle) {
            *has_obstacle = false;
            for (lot, cells) in seen.chunks(LOT).enumerate() {
                // Most lots have none, which is seen without going cell by cell.
                let is_obstacle = |seen: &Seen| *seen == Seen::Obstacle;
                if !cells.iter().fold(false, |any, seen| any | is_obstacle(seen)) {
                    continue;
                }
                *has_obstacle = true;
                for (x, _) in cells.iter().enumerate().filter(|(_, seen)| is_obstacle(seen)) {
                    let x = lot * LOT + x;
                    let skipped = self.squares.len() / 2;
                    let (first, skipped) = (x.saturating_sub(skipped), skipped.saturating_sub(x));
                    for (here, there) in near[first..].iter_mut().zip(&self.squares[skipped..]) {
                        *here = (*here).min(*there);
                    }
                }
            }
        }
        // 2. The nearest of all rows within reach.
        let reach = usize::from(self.reach);
        for (y, clearance) in self.clearance.chunks_mut(side).enumerate() {
            clearance.fill(far);
            for row in y.saturating_sub(reach)..(y + reach + 1).min(side) {
                if self.has_obstacle[row] {
                    let across = self.squares[row + reach - y];
                    let near = &self.nearness[row * side..(row + 1) * side];
                    for (here, there) in clearance.iter_mut().zip(near) {
                        *here = (*here).min(there.saturating_add(across));
                    }
                }
            }
        }
    }
}

/// Returns the medians across `windows`, whose order is lost: the smallest go to the front, one after another, as far as
/// the middle.
fn medians(windows: &mut [[f64; LANES]]) -> [f64; LANES] {
    let middle = windows.len() / 2;
    for place in 0..=middle {
        // Copies, so that all lanes can be compared at once. A range is never NaN, and which of two equal ones is taken does
        // not matter.
        let mut smallest = windows[place];
        for other in &mut windows[place + 1..] {
            let (mut low, mut high) = (smallest, *other);
            for ((low, high), (&a, &b)) in
                low.iter_mut().zip(&mut high).zip(smallest.iter().zip(&*other))
            {
                *low = if b < a { b } else { a };
                *high = if b < a { a } else { b };
            }
            (smallest, *other) = (low, high);
        }
        windows[place] = smallest;
    }
    windows[middle]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::line;
    use crate::units::Tick;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn medians_are_those_of_sorted_windows(
            ranges in prop::collection::vec(prop_oneof![0.0..9.0, Just(f64::INFINITY), Just(1.0)], 0..60),
            half in 1_usize..6,
        ) {
            let rule = LocalRule { median_beams: 2 * half + 1, ..LocalRule::default() };
            let mut map = LocalMap::new(rule);
            map.smooth(&ranges);
            let median = |i: usize| {
                let mut window = ranges[i.saturating_sub(half)..(i + half + 1).min(ranges.len())].to_vec();
                window.sort_unstable_by(f64::total_cmp);
                window[window.len() / 2]
            };
            let expected: Vec<f64> = (0..ranges.len()).map(median).collect();
            prop_assert_eq!(map.ranges, expected);
        }

        #[test]
        fn lines_are_cleared_up_to_their_end_or_the_windows(
            ends in prop::collection::vec((-3.2..3.2, 0..130_u8), 1..90), is_sorted: bool, is_far: bool,
        ) {
            let mut ends: Vec<(f64, u8)> = ends;
            if is_sorted {
                ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            let mut map = LocalMap::new(LocalRule::default());
            let mut expected = map.clone();
            for (angle, length) in ends {
                let (sin, cos) = math::sin_cos(angle);
                let length = if is_far { 130.0 } else { f64::from(length) };
                #[expect(clippy::cast_possible_truncation, reason = "small")]
                let to = Cell::new((length * cos) as i32, (length * sin) as i32);
                map.lines.push(map.line(Cell::new(0, 0), to));
                for cell in line(Cell::new(0, 0), to) {
                    let Some(index) = expected.index(cell) else { break };
                    if cell != to {
                        expected.seen[index] = Seen::Free;
                    }
                }
            }
            map.clear_lines(Cell::new(0, 0));
            prop_assert_eq!(map.seen, expected.seen);
        }
    }

    proptest! {
        /// Checks that a window that moves keeps what it still covers, and knows nothing of the rest.
        #[test]
        fn a_window_that_moves_keeps_what_it_covers(x in -9.0..9.0, y in -9.0..9.0, salt in 0_usize..97) {
            let mut map = LocalMap::new(LocalRule::default());
            let kinds = [Seen::Unknown, Seen::Free, Seen::Obstacle];
            for (i, seen) in map.seen.iter_mut().enumerate() {
                *seen = kinds[i * (salt + 5) / 7 % 3];
            }
            let before = LocalMap { seen: map.seen.clone(), ..LocalMap::new(LocalRule::default()) };
            map.move_to(Pose::new(x, y, 0.0));
            for (i, &seen) in map.seen.iter().enumerate() {
                let side = usize::try_from(map.side).unwrap();
                let at = |i: usize| i32::try_from(i).unwrap();
                let cell = Cell::new(at(i % side) + map.corner.x, at(i / side) + map.corner.y);
                let expected = before.index(cell).map_or(Seen::Unknown, |i| before.seen[i]);
                prop_assert_eq!(seen, expected, "{:?}", cell);
            }
        }

        #[test]
        fn clearances_are_the_distances_to_the_nearest_obstacle(
            obstacles in prop::collection::vec((0..120_i32, 0..120_i32), 0..40),
        ) {
            let mut map = LocalMap::new(LocalRule::default());
            map.seen.fill(Seen::Free);
            let at = |(x, y): (i32, i32)| usize::try_from(y * 120 + x).unwrap();
            for &obstacle in &obstacles {
                map.seen[at(obstacle)] = Seen::Obstacle;
            }
            map.measure_clearance();
            for cell in (0..120).flat_map(|y| (0..120).map(move |x| (x, y))) {
                let squared = |&(x, y): &(i32, i32)| (x - cell.0).pow(2) + (y - cell.1).pow(2);
                let nearest = obstacles.iter().map(squared).min().filter(|squared| *squared <= 49);
                let found = i32::from(map.clearance[at(cell)]);
                prop_assert_eq!(Some(found).filter(|squared| *squared <= 49), nearest);
            }
        }
    }

    fn scan(range: f64) -> Scan {
        Scan {
            stamp: Tick(0),
            mount: Pose::default(),
            min_angle: -1.0,
            increment: 0.005,
            min_range: 0.0,
            max_range: 10.0,
            ranges: vec![range; 401],
        }
    }

    #[test]
    fn obstacles_are_felt_near_them_and_remembered_when_the_window_moves() {
        let mut map = LocalMap::new(LocalRule::default());
        map.update(Pose::default(), &scan(2.0));
        let at = |map: &LocalMap, x: f64| map.clearance(Point::new(x + 0.01, 0.01));
        assert_eq!(at(&map, 1.0), Some(0.35));
        let near = at(&map, 1.8).unwrap();
        assert!((0.14..0.21).contains(&near), "{near}");
        assert_eq!(at(&map, 2.0), Some(0.0));
        assert_eq!(at(&map, 2.5), None);
        assert_eq!(at(&map, -1.0), None, "behind the robot nothing was seen");
        assert_eq!(at(&map, -0.2), Some(0.35), "where the robot is, it is free");
        // Turned round, the wall is behind and remembered.
        map.update(Pose::new(0.5, 0.0, std::f64::consts::PI), &scan(5.5));
        assert_eq!(at(&map, 2.0), Some(0.0));
    }

    #[test]
    fn a_median_forgets_single_beams_and_keeps_edges() {
        let mut map = LocalMap::new(LocalRule { median_beams: 3, ..LocalRule::default() });
        map.smooth(&[2.0, 2.0, 0.4, 2.0, 2.0, 5.0, 5.0, 5.0]);
        assert_eq!(map.ranges, [2.0, 2.0, 2.0, 2.0, 2.0, 5.0, 5.0, 5.0]);
    }

    #[test]
    fn a_beam_that_passes_clears_an_obstacle() {
        let mut map = LocalMap::new(LocalRule::default());
        map.update(Pose::default(), &scan(1.0));
        map.update(Pose::default(), &scan(2.0));
        assert_eq!(map.clearance(Point::new(1.0, 0.0)), Some(0.35));
    }
}
