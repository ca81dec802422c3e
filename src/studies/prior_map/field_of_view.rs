//! The cells that a scanner with a limited field of view sees from a place, by its heading there.

use crate::grid::Cell;
use crate::math;
use std::f64::consts::{PI, TAU};

/// Angles closer than this (rad) are one: cells on the very edge of a view belong to it.
const SAME: f64 = 1e-9;

/// The angles over which a scanner looks, relative to the robot's heading (rad).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FieldOfView {
    pub(super) min_angle: f64,
    pub(super) max_angle: f64,
}

impl FieldOfView {
    /// Returns its width (rad), at most a full turn.
    pub(super) fn width(self) -> f64 {
        (self.max_angle - self.min_angle).clamp(0.0, TAU)
    }

    /// Returns the sector that it covers with the robot headed to `heading` (rad).
    pub(super) fn facing(self, heading: f64) -> Sector {
        let edge = |angle: f64| {
            let (sin, cos) = math::sin_cos(heading + angle);
            (cos, sin)
        };
        Sector { low: edge(self.min_angle), high: edge(self.max_angle), width: self.width() }
    }
}

/// All directions counter-clockwise from one to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sector {
    low: (f64, f64),
    high: (f64, f64),
    width: f64,
}

impl Sector {
    /// Returns whether the direction to the cell that is `offset` away lies in the sector, its edges included.
    pub(super) fn contains(&self, offset: Cell) -> bool {
        let (x, y) = (f64::from(offset.x), f64::from(offset.y));
        let margin = SAME * (x.abs() + y.abs());
        let left_of_low = self.low.0 * y - self.low.1 * x >= -margin;
        let right_of_high = x * self.high.1 - y * self.high.0 >= -margin;
        if self.width >= TAU - SAME {
            true
        } else if self.width <= PI + SAME {
            left_of_low && right_of_high && self.is_ahead(x, y)
        } else {
            left_of_low || right_of_high
        }
    }

    /// Returns whether the point is in front: a narrow sector's two edges, extended backwards, touch in the origin, and
    /// what lies behind is not in it.
    fn is_ahead(&self, x: f64, y: f64) -> bool {
        self.width > PI - SAME
            || x * (self.low.0 + self.high.0) + y * (self.low.1 + self.high.1) >= 0.0
    }
}

/// All directions from a cell to the cells of the disc around it, in order, so that the heading which sees most cells
/// is found exactly: a window of the scanner's width is slid over them.
#[derive(Debug, Clone)]
pub(super) struct Headings {
    range: i32,
    /// For every offset of the square around the disc, row-major, the number of its direction.
    direction: Vec<u32>,
    /// For every direction, the number of the first one after it that a view beginning there does not reach; numbers
    /// beyond the last go round.
    ends: Vec<usize>,
}

impl Headings {
    /// Creates the directions for a disc of `range` cells and a view of `width` rad.
    pub(super) fn new(range: i32, width: f64) -> Self {
        let mut offsets: Vec<(f64, usize)> = Vec::new();
        let side = -range..=range;
        for (index, (y, x)) in
            side.clone().flat_map(|y| side.clone().map(move |x| (y, x))).enumerate()
        {
            let within = x * x + y * y <= range * range;
            if within && (x, y) != (0, 0) {
                // Reduced, so that cells behind one another have one direction to the last bit.
                let divisor = greatest_common_divisor(x.abs(), y.abs());
                let angle = math::atan2(f64::from(y / divisor), f64::from(x / divisor));
                offsets.push((angle, index));
            }
        }
        offsets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        #[expect(clippy::cast_sign_loss, reason = "a side is positive")]
        let squares = ((2 * range + 1) * (2 * range + 1)) as usize;
        let mut direction = vec![0_u32; squares];
        let mut angles: Vec<f64> = Vec::new();
        for (angle, index) in offsets {
            if angles.last().is_none_or(|&last| last < angle) {
                angles.push(angle);
            }
            direction[index] = u32::try_from(angles.len() - 1).unwrap_or(u32::MAX);
        }
        let count = angles.len();
        let angle_of = |i: usize| angles[i % count] + if i < count { 0.0 } else { TAU };
        let mut end = 0;
        let ends = (0..count)
            .map(|first| {
                end = end.max(first);
                while end < first + count && angle_of(end) <= angles[first] + width + SAME {
                    end += 1;
                }
                end
            })
            .collect();
        Self { range, direction, ends }
    }

    /// Returns how many directions there are.
    pub(super) fn count(&self) -> usize {
        self.ends.len()
    }

    /// Returns the number of the direction to the cell that is `offset` away, which is within the range and not zero.
    pub(super) fn direction(&self, offset: Cell) -> usize {
        let side = 2 * self.range + 1;
        #[expect(clippy::cast_sign_loss, reason = "offsets are within the range")]
        let index = ((offset.y + self.range) * side + offset.x + self.range) as usize;
        self.direction[index] as usize
    }

    /// Returns the most cells that one view sees, of `cells` in every direction.
    pub(super) fn most(&self, cells: &[u32]) -> u32 {
        let mut before = Vec::with_capacity(cells.len() + 1);
        let mut sum = 0;
        before.push(sum);
        before.extend(cells.iter().map(|cells| {
            sum += cells;
            sum
        }));
        let count = self.count();
        let seen = |(first, &end): (usize, &usize)| {
            if end <= count {
                before[end] - before[first]
            } else {
                sum - before[first] + before[end - count]
            }
        };
        self.ends.iter().enumerate().map(seen).max().unwrap_or(0)
    }
}

fn greatest_common_divisor(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn view(degrees: f64) -> FieldOfView {
        let half = degrees.to_radians() / 2.0;
        FieldOfView { min_angle: -half, max_angle: half }
    }

    #[test]
    fn half_a_turn_sees_what_is_not_behind() {
        let ahead = view(180.0).facing(0.0);
        for (x, y, seen) in [(3, 0, true), (0, 2, true), (0, -2, true), (-1, 5, false)] {
            assert_eq!(ahead.contains(Cell::new(x, y)), seen, "{x} {y}");
        }
        let narrow = view(60.0).facing(PI / 2.0);
        assert!(narrow.contains(Cell::new(1, 2)) && !narrow.contains(Cell::new(2, 1)));
        assert!(!narrow.contains(Cell::new(0, -1)), "nor behind");
        let wide = view(300.0).facing(0.0);
        assert!(wide.contains(Cell::new(-1, 3)) && !wide.contains(Cell::new(-5, 1)));
    }

    proptest! {
        /// Checks that the sector is that of the angles, but for its very edges.
        #[test]
        fn sectors_are_angles(x in -30..=30_i32, y in -30..=30_i32, heading in -7.0..7.0_f64, degrees in 1.0..359.0_f64) {
            prop_assume!((x, y) != (0, 0));
            let off = math::wrap_angle(math::atan2(f64::from(y), f64::from(x)) - heading).abs();
            let half = degrees.to_radians() / 2.0;
            prop_assume!((off - half).abs() > 1e-6);
            prop_assert_eq!(view(degrees).facing(heading).contains(Cell::new(x, y)), off < half);
        }

        /// Checks that no heading sees more than the best one, and that one which begins at a cell sees as much.
        #[test]
        fn the_best_heading_is_the_best(
            cells in prop::collection::btree_set((-6..=6_i32, -6..=6_i32), 1..40), degrees in 5.0..360.0_f64,
        ) {
            let cells: Vec<Cell> = cells.into_iter().filter(|&(x, y)| (x, y) != (0, 0) && x * x + y * y <= 36)
                .map(|(x, y)| Cell::new(x, y)).collect();
            let headings = Headings::new(6, view(degrees).width());
            let mut counts = vec![0; headings.count()];
            for &cell in &cells {
                counts[headings.direction(cell)] += 1;
            }
            let most = headings.most(&counts);
            let seen = |heading: f64| {
                let sector = view(degrees).facing(heading);
                u32::try_from(cells.iter().filter(|&&c| sector.contains(c)).count()).unwrap()
            };
            for step in 0..90 {
                prop_assert!(seen(f64::from(step) * 4.0_f64.to_radians()) <= most);
            }
            let half = degrees.to_radians() / 2.0;
            let begins = cells.iter().map(|c| seen(math::atan2(f64::from(c.y), f64::from(c.x)) + half));
            prop_assert_eq!(begins.max().unwrap_or(0), most);
        }
    }
}
