//! I(p) as the authors' released program computes it (prior-map facts, section 6): sampled rays over the inflated map.

use super::information_gain::AlignedPrior;
use super::parameters::Exploration;
use super::ray_field::RayField;
use super::rays::Rays;
use super::terrain::cost;
use crate::grid::{Cell, OccupancyGrid};
use crate::navigation::CostGrid;

/// Computes the released program's gains, and keeps those that still hold: no cell has changed that decided them.
#[derive(Debug)]
pub(super) struct ReleasedGains {
    rays: Rays,
    field: RayField,
    known: Vec<Known>,
}

#[derive(Debug)]
struct Known {
    /// The lattice cell of the location p.
    p: Cell,
    /// Distinct unknown cells that rays from there meet.
    cells: u32,
    /// How many cells of each ray decided that.
    looked_at: Box<[u16]>,
}

impl ReleasedGains {
    /// Prepares gains by the rules of `exploration`, for a scanner that sees `range` cells far, with or without a prior.
    pub(super) fn new(exploration: &Exploration, range: i32, has_prior: bool) -> Self {
        // With a prior, rays stop at this inflated cost or more, without above this one.
        let stop = if has_prior {
            cost(exploration.prior_ray_stop_cost)
        } else {
            cost(exploration.baseline_ray_stop_cost) + 1
        };
        Self { rays: Rays::new(range), field: RayField::new(range, stop), known: Vec::new() }
    }

    /// Computes I(p) in m², from each cell p of `candidates` of the map, whose cell (0, 0) is the lattice cell `offset` and
    /// which is inflated in `costs`.
    ///
    /// With a prior, rays stop at its border and at its first cell that is not free, and no cell at all counts as one.
    /// Without, the unknown stops nothing.
    pub(super) fn of(
        &mut self,
        map: &OccupancyGrid,
        costs: &CostGrid,
        offset: Cell,
        prior: Option<&AlignedPrior>,
        candidates: &[Cell],
    ) -> Vec<f64> {
        let mut earlier = std::mem::take(&mut self.known);
        match self.field.update(map, costs, offset, prior) {
            None => earlier.clear(),
            Some(changes) => {
                let changed = |known: &Known| {
                    changes.iter().any(|change| {
                        let off = Cell::new(change.x - known.p.x, change.y - known.p.y);
                        self.rays.look_at(off, &known.looked_at)
                    })
                };
                earlier.retain(|known| !changed(known));
            }
        }
        let resolution = map.frame().resolution;
        let least = u32::from(prior.is_some());
        let mut gain = |&candidate: &Cell| {
            let p = Cell::new(candidate.x + offset.x, candidate.y + offset.y);
            let known = if let Some(i) = earlier.iter().position(|known| known.p == p) {
                earlier.swap_remove(i)
            } else {
                let (states, width, place) = self.field.states(candidate);
                let (cells, looked_at) = self.rays.unknown(states, width, place);
                Known { p, cells, looked_at }
            };
            let cells = known.cells.max(least);
            self.known.push(known);
            f64::from(cells) * resolution * resolution
        };
        candidates.iter().map(&mut gain).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::grid::{GridFrame, Occupancy};
    use crate::navigation::inflate;
    use proptest::prelude::*;

    const FRAME: GridFrame =
        GridFrame { resolution: 0.1, origin: Point::ZERO, width: 80, height: 80 };

    fn gains(range: i32, prior: Option<&AlignedPrior>) -> ReleasedGains {
        let exploration = Exploration {
            prior_ray_stop_cost: 80,
            baseline_ray_stop_cost: 50,
            ..Exploration::default()
        };
        ReleasedGains::new(&exploration, range, prior.is_some())
    }

    fn gain(
        range: i32,
        map: &OccupancyGrid,
        costs: &CostGrid,
        prior: Option<&AlignedPrior>,
        p: Cell,
    ) -> f64 {
        gains(range, prior).of(map, costs, Cell::new(0, 0), prior, &[p])[0]
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
        let prior = OccupancyGrid::filled(FRAME, Occupancy::Free);
        let aligned = AlignedPrior::new(&prior, Pose::default(), 0.1);
        let p = Cell::new(32, 40);
        assert_eq!(cells(gain(30, &map, &costs, None, p)), 0);
        assert!(cells(gain(30, &map, &costs, Some(&aligned), p)) > 50);
        let outside = AlignedPrior::new(&prior, Pose::new(500.0, 0.0, 0.0), 0.1);
        assert_eq!(cells(gain(30, &map, &costs, Some(&outside), p)), 1, "0 becomes 1");
    }

    /// Checks the share of a disc that the rays meet: 94.5 % at 60 cells in the release, whose rays skip cells in two
    /// sectors that ours do not.
    #[test]
    fn rays_thin_out_with_their_length() {
        for (range, low, high) in [(60, 0.93, 0.97), (100, 0.70, 0.77), (250, 0.34, 0.39)] {
            let map = OccupancyGrid::filled(FRAME, Occupancy::Unknown);
            let costs = CostGrid::unknown(FRAME);
            let met = gain(range, &map, &costs, None, Cell::new(40, 40));
            let disc = std::f64::consts::PI * f64::from(range * range) * 0.01;
            assert!((low..high).contains(&(met / disc)), "{range}: {}", met / disc);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        /// Checks that gains that are kept, on maps that change and grow, are those counted anew.
        #[test]
        fn kept_gains_are_those_counted_anew(
            rounds in prop::collection::vec(
                (prop::collection::vec((0..80, 0..80, 0_u8..3), 0..12), 0..3_i32), 1..6,
            ),
            has_prior: bool,
        ) {
            let prior = OccupancyGrid::filled(FRAME, Occupancy::Free);
            let aligned = AlignedPrior::new(&prior, Pose::new(1.0, 0.4, 0.1), 0.1);
            let prior = has_prior.then_some(&aligned);
            let mut kept = gains(30, prior);
            let mut map = OccupancyGrid::filled(FRAME, Occupancy::Unknown);
            for cell in FRAME.cells().filter(|cell| (20..60).contains(&cell.x) && (25..50).contains(&cell.y)) {
                map.set(cell, if cell.x == 40 && cell.y != 30 { Occupancy::Occupied } else { Occupancy::Free });
            }
            let mut offset = Cell::new(-7, 3);
            for (changes, growth) in rounds {
                let frame = GridFrame { width: map.frame().width + growth, ..FRAME };
                let mut grown = OccupancyGrid::filled(frame, Occupancy::Unknown);
                for cell in map.frame().cells() {
                    grown.set(Cell::new(cell.x + growth, cell.y), map.at(cell));
                }
                (map, offset.x) = (grown, offset.x - growth);
                for (x, y, kind) in changes {
                    let value = [Occupancy::Unknown, Occupancy::Free, Occupancy::Occupied][usize::from(kind)];
                    map.set(Cell::new(x, y), value);
                }
                let costs = inflate(&map, 5);
                let candidates = [(25, 30), (38, 26), (43, 48), (59, 40)]
                    .map(|(x, y)| Cell::new(x - 7 - offset.x, y + 3 - offset.y));
                let found = kept.of(&map, &costs, offset, prior, &candidates);
                prop_assert_eq!(found, gains(30, prior).of(&map, &costs, offset, prior, &candidates));
            }
        }
    }
}
