//! The recent surroundings of the robot: a rolling window for the operator.

use crate::geometry::{Point, Pose};
use crate::grid::{Cell, GridFrame};
use crate::math;
use crate::robot::Scan;
use std::cmp::Ordering;

/// Size and reach of the window (prior-map facts, section 4, `costmap.yaml`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalRule {
    /// Side of the square window (m).
    pub size: f64,
    /// Side of a cell (m).
    pub resolution: f64,
    /// Ends of beams within this range (m) mark obstacles.
    pub obstacle_range: f64,
    /// Distances to obstacles are known up to this (m).
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
    /// Squared distance in cells to the nearest obstacle, capped.
    clearance: Vec<u16>,
    /// Rows of the disc in which an obstacle is felt: how far up, and the squared distances from left to right.
    disc: Vec<(i32, Vec<u16>)>,
    /// Distance (m) of a squared distance in cells, as far as the disc reaches.
    metres: Vec<f64>,
    ends: Vec<Cell>,
    ranges: Vec<f64>,
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
        let reach = count(rule.inflation_radius);
        let squared = |x: i32, y: i32| u16::try_from(x * x + y * y).unwrap_or(u16::MAX);
        let disc = (-reach..=reach)
            .map(|y| {
                let half = (reach * reach - y * y).isqrt();
                (y, (-half..=half).map(|x| squared(x, y)).collect())
            })
            .collect();
        let metres = (0..=squared(reach, 0)).map(|s| f64::from(s).sqrt() * rule.resolution);
        let cells =
            GridFrame { resolution: 1.0, origin: Point::ZERO, width: side, height: side }.len();
        Self {
            rule,
            side,
            corner: Cell::new(-side / 2, -side / 2),
            seen: vec![Seen::Unknown; cells],
            shifted: Vec::new(),
            clearance: vec![u16::MAX; cells],
            disc,
            metres: metres.collect(),
            ends: Vec::new(),
            ranges: Vec::new(),
        }
    }

    /// Takes in `scan`, taken at `pose`: beams clear the cells they cross, then their ends mark obstacles.
    pub fn update(&mut self, pose: Pose, scan: &Scan) {
        self.move_to(pose);
        let sensor = pose.compose(scan.mount);
        let from = self.lattice(sensor.position());
        self.ends.clear();
        self.smooth(&scan.ranges);
        for i in 0..self.ranges.len() {
            let range = self.ranges[i];
            let reach = range.min(scan.max_range).min(self.rule.size);
            let angle = sensor.heading + scan.angle(i);
            let (sin, cos) = math::sin_cos(angle);
            let to = self.lattice(sensor.position() + Point::new(cos, sin) * reach);
            self.clear_way(from, to);
            if range < self.rule.obstacle_range.min(self.rule.size) {
                self.ends.push(to);
            }
        }
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

    fn smooth(&mut self, ranges: &[f64]) {
        self.ranges.clear();
        let half = self.rule.median_beams / 2;
        if half == 0 {
            self.ranges.extend_from_slice(ranges);
            return;
        }
        // The window's ranges in order, kept so while it moves on by one.
        let mut window: Vec<f64> = Vec::with_capacity(2 * half + 2);
        let place = |window: &[f64], range: f64| {
            window.partition_point(|other| other.total_cmp(&range) == Ordering::Less)
        };
        for &range in ranges.iter().take(half) {
            window.insert(place(&window, range), range);
        }
        for i in 0..ranges.len() {
            if let Some(&range) = ranges.get(i + half) {
                window.insert(place(&window, range), range);
            }
            if let Some(&range) = i.checked_sub(half + 1).and_then(|i| ranges.get(i)) {
                window.remove(place(&window, range));
            }
            self.ranges.push(window[window.len() / 2]);
        }
    }

    /// Marks the cells between `from` and `to` as free, as far as they are within the window: the walk of
    /// [`crate::grid::line`], over indices.
    fn clear_way(&mut self, from: Cell, to: Cell) {
        let (dx, dy) = ((to.x - from.x).abs(), -(to.y - from.y).abs());
        let (step_x, step_y) = ((to.x - from.x).signum(), (to.y - from.y).signum());
        let (mut x, mut y) = (from.x - self.corner.x, from.y - self.corner.y);
        let mut error = dx + dy;
        for _ in 0..dx.max(-dy) {
            if !((0..self.side).contains(&x) && (0..self.side).contains(&y)) {
                return;
            }
            #[expect(clippy::cast_sign_loss, reason = "checked to be inside")]
            let index = (y * self.side + x) as usize;
            self.seen[index] = Seen::Free;
            let doubled = 2 * error;
            if doubled >= dy {
                error += dy;
                x += step_x;
            }
            if doubled <= dx {
                error += dx;
                y += step_y;
            }
        }
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
        for y in 0..self.side {
            for x in 0..self.side {
                let old = self.index(Cell::new(x + corner.x, y + corner.y));
                self.shifted.push(old.map_or(Seen::Unknown, |i| self.seen[i]));
            }
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

    fn measure_clearance(&mut self) {
        self.clearance.fill(u16::MAX);
        for y in 0..self.side {
            for x in 0..self.side {
                #[expect(clippy::cast_sign_loss, reason = "inside")]
                let index = (y * self.side + x) as usize;
                if self.seen[index] != Seen::Obstacle {
                    continue;
                }
                for (dy, squared) in &self.disc {
                    let row = y + dy;
                    if !(0..self.side).contains(&row) {
                        continue;
                    }
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_possible_wrap,
                        reason = "few cells"
                    )]
                    let half = (squared.len() / 2) as i32;
                    let (from, to) = ((x - half).max(0), (x + half).min(self.side - 1));
                    #[expect(clippy::cast_sign_loss, reason = "inside")]
                    let (first, skipped, count) = (
                        (row * self.side + from) as usize,
                        (from - (x - half)) as usize,
                        (to - from + 1) as usize,
                    );
                    let felt = &mut self.clearance[first..first + count];
                    for (here, there) in felt.iter_mut().zip(&squared[skipped..]) {
                        *here = (*here).min(*there);
                    }
                }
            }
        }
    }
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
        fn ways_are_cleared_up_to_their_end_or_the_windows(x in -90..90_i32, y in -90..90_i32) {
            let mut map = LocalMap::new(LocalRule::default());
            let to = Cell::new(x, y);
            map.clear_way(Cell::new(0, 0), to);
            let mut expected = LocalMap::new(LocalRule::default());
            for cell in line(Cell::new(0, 0), to) {
                let Some(index) = expected.index(cell) else { break };
                if cell != to {
                    expected.seen[index] = Seen::Free;
                }
            }
            prop_assert_eq!(map.seen, expected.seen);
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
