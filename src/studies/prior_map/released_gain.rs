//! I(p) as the authors' released program computes it (prior-map facts, section 6): sampled rays over the inflated map.

use super::information_gain::AlignedPrior;
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::math;
use crate::navigation::CostGrid;

/// The rays of one range: one at every whole degree from 0 to 360, so that the first and the last are the same.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    /// For each ray, the offsets of its cells outwards, each with its number in the square around the disc.
    rays: Vec<Vec<(Cell, usize)>>,
    squares: usize,
}

impl Rays {
    /// Creates rays of `range` cells: the end point is rounded to a cell, and a ray takes one cell per step along its
    /// longer axis.
    pub(super) fn new(range: i32) -> Self {
        let side = 2 * range + 1;
        #[expect(clippy::cast_sign_loss, reason = "offsets are within the range")]
        let number = |cell: Cell| ((cell.y + range) * side + cell.x + range) as usize;
        let ray = |degrees: u32| {
            let (sin, cos) = math::sin_cos(f64::from(degrees).to_radians());
            #[expect(clippy::cast_possible_truncation, reason = "within the range")]
            let end = |share: f64| (share * f64::from(range)).round() as i32;
            let (x, y) = (end(cos), end(sin));
            let steps = x.abs().max(y.abs());
            (0..=steps)
                .map(|step| Cell::new(along(x, step, steps), along(y, step, steps)))
                .map(|cell| (cell, number(cell)))
                .collect()
        };
        #[expect(clippy::cast_sign_loss, reason = "a side is positive")]
        let squares = (side * side) as usize;
        Self { rays: (0..=360).map(ray).collect(), squares }
    }

    /// Counts the distinct unknown cells that rays from `p` meet before `stops`.
    fn unknown(&self, map: &OccupancyGrid, p: Cell, stops: impl Fn(Cell) -> bool) -> u32 {
        let mut met = vec![false; self.squares];
        let mut unknown = 0;
        for ray in &self.rays {
            for &(offset, number) in ray {
                let cell = Cell::new(p.x + offset.x, p.y + offset.y);
                if stops(cell) {
                    break;
                }
                if map.at(cell) == Occupancy::Unknown {
                    unknown += u32::from(!met[number]);
                    met[number] = true;
                }
            }
        }
        unknown
    }
}

/// Returns the coordinate after `step` of `steps` steps towards `end`, rounded to the nearest cell, halves away from
/// zero.
fn along(end: i32, step: i32, steps: i32) -> i32 {
    if steps == 0 { 0 } else { (2 * end.abs() * step + steps) / (2 * steps) * end.signum() }
}

/// The data needed to compute the released program's gain.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReleasedGain<'a> {
    pub(super) rays: &'a Rays,
    pub(super) map: &'a OccupancyGrid,
    /// The same map inflated.
    pub(super) costs: &'a CostGrid,
    /// Lattice cell of the map's cell (0, 0).
    pub(super) offset: Cell,
    pub(super) prior: Option<&'a AlignedPrior>,
    /// With a prior, rays stop at this inflated cost or more.
    pub(super) prior_stop: u8,
    /// Without, above this one.
    pub(super) baseline_stop: u8,
}

impl ReleasedGain<'_> {
    /// Computes I(p) in m², from the map cell `p`.
    ///
    /// With a prior, rays stop at its border and at its first cell that is not free, and no cell at all counts as one.
    /// Without, the unknown stops nothing.
    pub(super) fn at(&self, p: Cell) -> f64 {
        let cost = |cell: Cell| self.costs.cost(cell).unwrap_or(0);
        let cells = match self.prior {
            Some(prior) => {
                let free =
                    |c: Cell| prior.is_free(Cell::new(c.x + self.offset.x, c.y + self.offset.y));
                let stops = |c: Cell| cost(c) >= self.prior_stop || !free(c);
                self.rays.unknown(self.map, p, stops).max(1)
            }
            None => self.rays.unknown(self.map, p, |c| cost(c) > self.baseline_stop),
        };
        f64::from(cells) * self.map.frame().resolution * self.map.frame().resolution
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::grid::GridFrame;
    use crate::navigation::inflate;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    const FRAME: GridFrame =
        GridFrame { resolution: 0.1, origin: Point::ZERO, width: 80, height: 80 };

    fn gain<'a>(
        rays: &'a Rays,
        map: &'a OccupancyGrid,
        costs: &'a CostGrid,
        prior: Option<&'a AlignedPrior>,
    ) -> ReleasedGain<'a> {
        let offset = Cell::new(0, 0);
        ReleasedGain { rays, map, costs, offset, prior, prior_stop: 80, baseline_stop: 50 }
    }

    fn cells(m2: f64) -> u32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few")]
        let cells = (m2 * 100.0).round() as u32;
        cells
    }

    /// Checks that a door of 8 cells in a known wall lets the rays of a prior through and, inflated, lets none through
    /// without a prior.
    #[test]
    fn a_known_door_stops_the_baseline_and_not_the_prior() {
        let mut map = OccupancyGrid::filled(FRAME, Occupancy::Unknown);
        for y in 0..80 {
            for x in 0..40 {
                map.set(Cell::new(x, y), Occupancy::Free);
            }
            if (36..44).contains(&y) {
                map.set(Cell::new(40, y), Occupancy::Free);
                map.set(Cell::new(41, y), Occupancy::Free);
            } else {
                map.set(Cell::new(40, y), Occupancy::Occupied);
            }
        }
        let costs = inflate(&map, 9);
        let rays = Rays::new(30);
        let prior = OccupancyGrid::filled(FRAME, Occupancy::Free);
        let aligned = AlignedPrior::new(&prior, Pose::default(), 0.1);
        let p = Cell::new(32, 40);
        assert_eq!(cells(gain(&rays, &map, &costs, None).at(p)), 0);
        assert!(cells(gain(&rays, &map, &costs, Some(&aligned)).at(p)) > 50);
        let outside = AlignedPrior::new(&prior, Pose::new(500.0, 0.0, 0.0), 0.1);
        assert_eq!(cells(gain(&rays, &map, &costs, Some(&outside)).at(p)), 1, "0 becomes 1");
    }

    /// Checks the share of a disc that the rays meet: 94.5 % at 60 cells in the release, whose rays skip cells in two
    /// sectors that ours do not.
    #[test]
    fn rays_thin_out_with_their_length() {
        for (range, low, high) in [(60, 0.93, 0.97), (100, 0.70, 0.77), (250, 0.34, 0.39)] {
            let map = OccupancyGrid::filled(FRAME, Occupancy::Unknown);
            let costs = CostGrid::unknown(FRAME);
            let rays = Rays::new(range);
            let met = gain(&rays, &map, &costs, None).at(Cell::new(40, 40));
            let disc = std::f64::consts::PI * f64::from(range * range) * 0.01;
            assert!((low..high).contains(&(met / disc)), "{range}: {}", met / disc);
        }
    }

    proptest! {
        /// Checks that every ray is a chain of neighbours that leaves none out and ends within half a cell of the
        /// range.
        #[test]
        fn rays_are_chains(range in 1..120_i32) {
            let rays = Rays::new(range);
            prop_assert_eq!(rays.rays.len(), 361);
            let mut ends = BTreeSet::new();
            for ray in &rays.rays {
                prop_assert_eq!(ray[0].0, Cell::new(0, 0));
                prop_assert!(ray.windows(2).all(|w| w[0].0.neighbours8().contains(&w[1].0)));
                let end = ray.last().unwrap().0;
                let length = math::hypot(f64::from(end.x), f64::from(end.y));
                prop_assert!((length - f64::from(range)).abs() <= std::f64::consts::FRAC_1_SQRT_2);
                ends.insert(end);
            }
            prop_assert!(ends.len() <= 360);
        }
    }
}
