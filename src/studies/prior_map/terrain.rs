//! What the robot may drive on: its map with obstacles inflated, and distances over it.

use super::parameters::Navigation;
use crate::geometry::{Point, Pose};
use crate::grid::{Cell, GridFrame, Occupancy};
use crate::mapping::{Change, OccupancyMap};
use crate::navigation::{CostGrid, Ground, InflatedMap, RestingWave, Wavefront, inflate};

/// The map as the navigator sees it, kept current with what changes in it.
#[derive(Debug)]
pub(super) struct Terrain {
    inflated: InflatedMap,
    /// Cells of the lattice that changed since the map was inflated last.
    changed: Vec<Cell>,
    /// Obstacles are inflated over this many cells.
    radius: u32,
    /// Cells of this cost cannot be crossed.
    lethal: u8,
    /// How much dearer than its length a step into a cell of cost 100 is.
    weight: f64,
}

impl Terrain {
    /// Creates one of which nothing is known.
    pub(super) fn new(navigation: &Navigation) -> Self {
        let radius = navigation.inflation_radius_cells;
        Self {
            inflated: InflatedMap::new(radius),
            changed: Vec::new(),
            radius,
            lethal: cost(navigation.planner_lethal_cost),
            weight: navigation.cost_weight,
        }
    }

    /// Notes that the map changed. Every change is to be noted.
    pub(super) fn note(&mut self, changes: &[Change]) {
        self.changed.extend(changes.iter().map(|change| change.cell));
    }

    /// Returns `map` inflated, with the place of a robot at `pose` free.
    pub(super) fn ground(&mut self, map: &OccupancyMap, pose: Pose) -> Ground {
        let offset = map.offset();
        let lattice = |cell: Cell| Cell::new(cell.x + offset.x, cell.y + offset.y);
        let place: Vec<Cell> = place(map.grid().frame(), pose).map(lattice).collect();
        self.inflated.update(map.grid(), offset, &place, self.changed.drain(..))
    }

    /// Returns the same without keeping anything for the next time.
    pub(super) fn costs_anew(&self, map: &OccupancyMap, pose: Pose) -> CostGrid {
        let mut map = map.grid().clone();
        let frame = *map.frame();
        for cell in place(&frame, pose) {
            map.set(cell, Occupancy::Free);
        }
        inflate(&map, self.radius)
    }

    /// Starts a wave over `ground` from `target`, with what an `earlier` one knows.
    pub(super) fn wave_to(
        &self,
        earlier: Option<RestingWave>,
        ground: &Ground,
        target: Point,
    ) -> Wavefront {
        let goal = ground.costs.frame().cell_at(target);
        let (ground, lethal, weight) = (ground.clone(), self.lethal, self.weight);
        match earlier {
            None => Wavefront::from_goal(ground, goal, lethal, weight),
            Some(earlier) => {
                Wavefront::instead_of(earlier, &self.inflated, ground, goal, lethal, weight)
            }
        }
    }
}

/// Returns the cells on which the robot stands, which are taken for free (prior-map facts, section 4).
fn place(frame: &GridFrame, pose: Pose) -> impl Iterator<Item = Cell> {
    let robot = frame.cell_at(pose.position());
    (-2..=1).flat_map(move |y| (-2..=1).map(move |x| Cell::new(robot.x + x, robot.y + y)))
}

/// Returns an inflated cost that a parameter names.
pub(super) fn cost(parameter: u32) -> u8 {
    u8::try_from(parameter.min(101)).unwrap_or(101)
}
