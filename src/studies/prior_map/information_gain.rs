//! I(p): "the estimate of the amount of new (unexplored) area visible from p" (section 3.2).

use super::field_of_view::{Headings, Sector};
use crate::grid::{Cell, Occupancy, OccupancyGrid, visible_cells};

/// What is needed to estimate I(p).
#[derive(Debug, Clone, Copy)]
pub struct InformationGain<'a> {
    /// The map M_E so far.
    pub map: &'a OccupancyGrid,
    /// Lattice cell of the map's cell (0, 0).
    pub offset: Cell,
    /// The prior PK_E on the same lattice, if there is one.
    pub prior: Option<&'a AlignedPrior>,
    /// Range of the scanner in cells.
    pub range: i32,
    /// Without a prior: whether known obstacles hide what lies behind them.
    pub known_obstacles_occlude: bool,
}

impl InformationGain<'_> {
    /// I(p) in m², from the map cell `p`, looking all round.
    ///
    /// With a prior, the cells c of M_E that are unknown, within range, and satisfy the three conditions of
    /// section 3.2: c_PK is free; c_PK is visible from p_PK in PK_E; c is visible from p in M_E. Both grids
    /// have the same lattice here, so both lines of sight are one line over both grids' obstacles.
    ///
    /// Without (Figure 2b), every unknown cell within range.
    pub fn at(&self, p: Cell) -> f64 {
        let mut cells = 0;
        self.unknown(p, |_| cells += 1);
        self.area(cells)
    }

    /// The same, of what lies in `sector`.
    pub(super) fn within(&self, p: Cell, sector: Sector) -> f64 {
        let mut cells = 0;
        self.unknown(p, |offset| cells += u32::from(sector.contains(offset)));
        self.area(cells)
    }

    /// The same, of what is seen with the best of all headings.
    pub(super) fn best(&self, p: Cell, headings: &Headings) -> f64 {
        let mut cells = vec![0; headings.count()];
        let mut here = 0;
        self.unknown(p, |offset| match offset {
            Cell { x: 0, y: 0 } => here += 1,
            _ => cells[headings.direction(offset)] += 1,
        });
        self.area(here + headings.most(&cells))
    }

    /// Tells every cell that counts, as its offset from `p`.
    fn unknown(&self, p: Cell, mut count: impl FnMut(Cell)) {
        let see = |c: Cell| {
            if self.map.at(c) == Occupancy::Unknown {
                count(Cell::new(c.x - p.x, c.y - p.y));
            }
        };
        match self.prior {
            Some(prior) => visible_cells(
                p,
                self.range,
                |c| self.map.at(c) == Occupancy::Occupied || !prior.is_free(self.lattice(c)),
                see,
            ),
            None => visible_cells(
                p,
                self.range,
                |c| self.known_obstacles_occlude && self.map.at(c) == Occupancy::Occupied,
                see,
            ),
        }
    }

    fn area(&self, cells: u32) -> f64 {
        f64::from(cells) * self.map.frame().resolution * self.map.frame().resolution
    }

    fn lattice(&self, cell: Cell) -> Cell {
        Cell::new(cell.x + self.offset.x, cell.y + self.offset.y)
    }
}

/// A prior map brought to the lattice of the robot's own map, by the start pose known in both (section 3.2).
#[derive(Debug, Clone)]
pub struct AlignedPrior {
    free: OccupancyGrid,
    corner: Cell,
}

impl AlignedPrior {
    /// `prior` (world frame) on the lattice of `resolution` m cells whose frame is the pose `start`: each
    /// lattice cell takes the value of "the cell with the closest center after scaling and alignment".
    pub fn new(prior: &OccupancyGrid, start: crate::geometry::Pose, resolution: f64) -> Self {
        use crate::geometry::{Bounds, Point};
        use crate::grid::GridFrame;
        let area = prior.frame().bounds();
        let corners = [
            area.min,
            Point::new(area.max.x, area.min.y),
            area.max,
            Point::new(area.min.x, area.max.y),
        ];
        let bounds = corners
            .iter()
            .fold(Bounds::EMPTY, |b, &corner| b.including(start.inverse_transform(corner)));
        let frame = GridFrame::covering(bounds, resolution);
        let lattice = GridFrame { origin: Point::ZERO, ..frame };
        // Half a cell in, so that rounding cannot choose the neighbour.
        let half = Point::new(resolution / 2.0, resolution / 2.0);
        let corner = lattice.cell_at(frame.origin + half);
        let cells = frame
            .cells()
            .map(|cell| {
                let center = lattice.center(Cell::new(cell.x + corner.x, cell.y + corner.y));
                prior.at(prior.frame().cell_at(start.transform(center)))
            })
            .collect();
        Self { free: OccupancyGrid::from_cells(frame, cells), corner }
    }

    /// Whether the lattice `cell` is free in the prior: neither occupied nor unknown nor outside of it.
    pub fn is_free(&self, cell: Cell) -> bool {
        self.free.at(Cell::new(cell.x - self.corner.x, cell.y - self.corner.y)) == Occupancy::Free
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::grid::GridFrame;

    fn grid(origin: Point, value: Occupancy) -> OccupancyGrid {
        let frame = GridFrame { resolution: 0.1, origin, width: 40, height: 40 };
        OccupancyGrid::filled(frame, value)
    }

    /// Prior: a wall at x = 1 m in the world, free elsewhere.
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
        let gain = |prior| InformationGain {
            map: &map,
            offset: Cell::new(0, 0),
            prior,
            range: 8,
            known_obstacles_occlude: true,
        };
        let p = Cell::new(8, 20);
        let without = gain(None).at(p);
        let with = gain(Some(&aligned)).at(p);
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
        let mut gain = InformationGain {
            map: &map,
            offset: Cell::new(0, 0),
            prior: None,
            range: 3,
            known_obstacles_occlude: true,
        };
        let hidden = gain.at(Cell::new(9, 20));
        gain.known_obstacles_occlude = false;
        let open = gain.at(Cell::new(9, 20));
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
        let gain = InformationGain {
            map: &map,
            offset: Cell::new(0, 0),
            prior: None,
            range: 8,
            known_obstacles_occlude: true,
        };
        let p = Cell::new(20, 20);
        let view = FieldOfView { min_angle: -FRAC_PI_2, max_angle: FRAC_PI_2 };
        let all = gain.at(p);
        assert_eq!(gain.within(p, view.facing(0.0)), all);
        assert_eq!(gain.within(p, view.facing(PI)), 0.0);
        assert!((gain.within(p, view.facing(FRAC_PI_2)) - all / 2.0).abs() <= 0.041);
        assert_eq!(gain.best(p, &Headings::new(8, view.width())), all);
    }

    /// The same world seen from a start pose elsewhere and turned by a quarter.
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
