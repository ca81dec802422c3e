//! The reference of coverage: the map that ideal exploration of the same world would make.
//!
//! Ideal exploration scans all round, without noise, from every place the robot could stand, and takes the
//! scans into the same kind of map; so a cell counts if and only if a patient robot could have seen it.

use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::grid::{Cell, Grid, GridFrame, Occupancy};
use crate::mapping::OccupancyMap;
use crate::robot::{Lidar, Scan};
use crate::sim::WallSweep;
use crate::studies::prior_map::{Coverage, Setup};
use crate::units::Tick;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Spacing of the places from which ideal exploration scans (m).
const SPACING: f64 = 0.5;

/// The map of ideal exploration, on the lattice of the robot's own map.
#[derive(Debug)]
pub(super) struct Reference {
    map: OccupancyMap,
    coverage: Coverage,
    total: u32,
}

/// A reference that several setups share: explored by the first trial that needs it. Setups may share one where they
/// differ only in their prior knowledge and `exploration`, on which ideal exploration does not depend.
#[derive(Debug, Clone, Default)]
pub struct SharedReference(Arc<OnceLock<Arc<Reference>>>);

impl SharedReference {
    /// Returns the reference, by `explore` where there is none yet.
    pub(super) fn get_or_explore(&self, explore: impl FnOnce() -> Reference) -> Arc<Reference> {
        Arc::clone(self.0.get_or_init(|| Arc::new(explore())))
    }
}

impl Reference {
    /// Explores the world of `setup`, whose `visible` and `solid` outlines are given, ideally.
    pub(super) fn explore(
        setup: &Setup,
        lidar: &Lidar,
        visible: &[Outline],
        solid: &[Outline],
    ) -> Self {
        let mapping = &setup.parameters.mapping;
        let resolution = mapping.resolution_m;
        let ideal = all_round(lidar);
        let sweep = WallSweep::new(visible, &ideal);
        let mut map = OccupancyMap::new(mapping.scans());
        let mut scan = Scan {
            stamp: Tick(0),
            mount: ideal.mount,
            min_angle: ideal.min_angle,
            increment: ideal.increment(),
            min_range: ideal.min_range,
            max_range: ideal.max_range,
            ranges: Vec::new(),
        };
        for place in reachable_places(setup, solid, resolution) {
            let pose = setup.start.compose(Pose::new(place.x, place.y, 0.0));
            sweep.cast(pose.compose(ideal.mount), &mut scan.ranges);
            map.integrate(Pose::new(place.x, place.y, 0.0), &scan);
        }
        let coverage = setup.parameters.measurement.coverage;
        let counted = map.grid().values().iter().filter(|&&v| counts(coverage, v)).count();
        Self { total: u32::try_from(counted).unwrap_or(u32::MAX), map, coverage }
    }

    /// Returns the cells that full coverage counts.
    pub(super) fn total(&self) -> u32 {
        self.total
    }

    /// Returns whether the robot's map, holding `value` at the lattice `cell`, covers a cell that counts. Mapped means
    /// known: range noise draws walls thicker than they are, and a cell of free floor that such a wall covers has been
    /// mapped all the same.
    pub(super) fn covers(&self, cell: Cell, value: Occupancy) -> bool {
        value != Occupancy::Unknown && counts(self.coverage, self.map.at_lattice(cell))
    }
}

fn counts(coverage: Coverage, value: Occupancy) -> bool {
    match coverage {
        Coverage::Paper => value == Occupancy::Free,
        Coverage::Released => value != Occupancy::Unknown,
    }
}

/// Returns the same scanner looking all round, its beams as dense as before.
fn all_round(lidar: &Lidar) -> Lidar {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "thousands at most"
    )]
    let beams = (2.0 * PI / lidar.increment()).ceil() as u32;
    let step = 2.0 * PI / f64::from(beams);
    Lidar { beams, min_angle: -PI, max_angle: PI - step, noise_sd: 0.0, ..lidar.clone() }
}

/// Finds the places (map frame) where the robot could stand, by a flood from its start over cells whose centre is a
/// robot's radius clear of everything solid.
fn reachable_places(setup: &Setup, solid: &[Outline], resolution: f64) -> Vec<Point> {
    let radius = setup.robot.circumscribed_radius();
    let bounds = solid
        .iter()
        .fold(Bounds::EMPTY.including(setup.start.position()), |b, o| b.union(o.bounds()))
        .grown(1.0);
    // A grid in the world's frame: outlines are rasterised there.
    let frame = GridFrame::covering(bounds, resolution);
    let mut blocked = Grid::filled(frame, false);
    for outline in solid {
        let near = outline.bounds().grown(radius + resolution);
        let (low, high) = (frame.cell_at(near.min), frame.cell_at(near.max));
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let cell = Cell::new(x, y);
                if outline.distance(frame.center(cell)) < radius {
                    blocked.set(cell, true);
                }
            }
        }
    }
    let start = frame.cell_at(setup.start.position());
    let mut reached = Grid::filled(frame, false);
    reached.set(start, true);
    let mut queue = VecDeque::from([start]);
    #[expect(clippy::cast_possible_truncation, reason = "a few cells")]
    let every = (SPACING / resolution).round().max(1.0) as i32;
    let mut places = vec![Point::ZERO];
    while let Some(cell) = queue.pop_front() {
        if cell.x % every == 0 && cell.y % every == 0 {
            places.push(setup.start.inverse_transform(frame.center(cell)));
        }
        for neighbour in cell.neighbours4() {
            if blocked.get(neighbour) == Some(false) && reached.get(neighbour) == Some(false) {
                reached.set(neighbour, true);
                queue.push_back(neighbour);
            }
        }
    }
    places
}
