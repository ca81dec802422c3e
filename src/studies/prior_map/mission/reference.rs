//! What coverage is counted against: a map that was given, or one that is made of the same world.
//!
//! Ideal exploration scans all round, without noise, from every place the robot could stand, and takes the
//! scans into the same kind of map: a cell counts if light from such a place gets there. A robot's own exploration sees
//! less, as it stops where no frontier is left that it can go to; so does that of every trial. Several of them leave less
//! behind than one that had to give a corner up.

use super::{Prepared, begin};
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::grid::{Cell, Grid, GridFrame, Occupancy, OccupancyGrid};
use crate::mapping::OccupancyMap;
use crate::rng::Seeds;
use crate::robot::{Lidar, Scan};
use crate::sim::WallSweep;
use crate::studies::prior_map::information_gain::on_lattice;
use crate::studies::prior_map::{
    Candidate, Coverage, CoverageMapCells, Exploration, Mapping, Measurement, Mission, Navigation,
    Parameters, ReferenceMap, Replan, Reselect, Sensing, Setup, Strategy,
};
use crate::units::Tick;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Spacing of the places from which ideal exploration scans (m).
const SPACING: f64 = 0.5;

/// What coverage is counted against, on the lattice of the robot's own map.
#[derive(Debug, Default)]
pub(super) struct Reference {
    cells: OnLattice,
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
    /// Makes the reference of `setup`: from the map it was given, or by an exploration of its world.
    pub(super) fn of(setup: &Setup, prepared: &Prepared) -> Self {
        let Parameters { mapping, measurement, .. } = &setup.parameters;
        let map = match (&setup.coverage_map, measurement.reference) {
            (Some(given), _) => {
                let map = OnLattice::of_map(&given.map, setup.map_frame(), mapping.resolution_m);
                match measurement.coverage_map_cells {
                    CoverageMapCells::All => map,
                    CoverageMapCells::InView => {
                        map.known_to(&OnLattice::of_robot(&ideal_map(setup, prepared)))
                    }
                }
            }
            (None, ReferenceMap::Ideal) => OnLattice::of_robot(&ideal_map(setup, prepared)),
            (None, ReferenceMap::Robot) => map_of_robots(setup, prepared),
        };
        let cells = map.keeping(|value| counts(measurement.coverage, value));
        Self { total: cells.count(), cells }
    }

    /// Returns the cells that full coverage counts.
    pub(super) fn total(&self) -> u32 {
        self.total
    }

    /// Returns whether the robot's map, holding `value` at the lattice `cell`, covers a cell that counts. Mapped means
    /// known: range noise draws walls thicker than they are, and a cell of free floor that such a wall covers has been
    /// mapped all the same.
    pub(super) fn covers(&self, cell: Cell, value: Occupancy) -> bool {
        value != Occupancy::Unknown && self.cells.holds(cell)
    }
}

/// Cells of the robot's lattice.
#[derive(Debug)]
struct OnLattice<T = bool> {
    grid: Grid<T>,
    /// Lattice cell of the grid's cell (0, 0).
    corner: Cell,
}

impl Default for OnLattice {
    fn default() -> Self {
        let frame = GridFrame { resolution: 1.0, origin: Point::ZERO, width: 0, height: 0 };
        Self { grid: Grid::filled(frame, false), corner: Cell::new(0, 0) }
    }
}

impl OnLattice<Occupancy> {
    /// Takes the cells of a map that a robot made.
    fn of_robot(map: &OccupancyMap) -> Self {
        Self { grid: map.grid().clone(), corner: map.offset() }
    }

    /// Lays `map`, in the world's frame, on the lattice of `frame`: each cell has the value at its centre.
    fn of_map(map: &OccupancyGrid, frame: Pose, resolution: f64) -> Self {
        let (grid, corner) = on_lattice(map, frame, resolution);
        Self { grid, corner }
    }

    /// Returns what either has known; of cells that both have known, what is free in one is free.
    fn or(&self, other: &Self) -> Self {
        let both = [self, other];
        let least = |of: fn(&Cell) -> i32| both.map(|map| of(&map.corner)).into_iter().min();
        let corner = Cell::new(least(|c| c.x).unwrap_or(0), least(|c| c.y).unwrap_or(0));
        let most = |of: fn(&Self) -> i32| both.map(of).into_iter().max().unwrap_or(0);
        let frame = GridFrame {
            width: most(|map| map.corner.x + map.grid.frame().width) - corner.x,
            height: most(|map| map.corner.y + map.grid.frame().height) - corner.y,
            ..*self.grid.frame()
        };
        let value = |cell: Cell| {
            let lattice = Cell::new(cell.x + corner.x, cell.y + corner.y);
            match both.map(|map| map.at(lattice)) {
                [Occupancy::Free, _] | [_, Occupancy::Free] => Occupancy::Free,
                [Occupancy::Unknown, value] | [value, _] => value,
            }
        };
        Self { grid: Grid::from_cells(frame, frame.cells().map(value).collect()), corner }
    }

    /// Returns the map without what `other` does not know.
    fn known_to(&self, other: &Self) -> Self {
        let frame = *self.grid.frame();
        let value = |cell: Cell| {
            let lattice = Cell::new(cell.x + self.corner.x, cell.y + self.corner.y);
            match other.at(lattice) {
                Occupancy::Unknown => Occupancy::Unknown,
                _ => self.grid.at(cell),
            }
        };
        Self {
            grid: Grid::from_cells(frame, frame.cells().map(value).collect()),
            corner: self.corner,
        }
    }

    /// Returns the value of the lattice `cell`.
    fn at(&self, cell: Cell) -> Occupancy {
        self.grid.at(Cell::new(cell.x - self.corner.x, cell.y - self.corner.y))
    }

    /// Returns which cells have such a value.
    fn keeping(&self, is_kept: impl Fn(Occupancy) -> bool) -> OnLattice {
        let frame = *self.grid.frame();
        let kept = self.grid.values().iter().map(|&value| is_kept(value)).collect();
        OnLattice { grid: Grid::from_cells(frame, kept), corner: self.corner }
    }
}

impl OnLattice {
    fn count(&self) -> u32 {
        let counted = self.grid.values().iter().filter(|&&is_kept| is_kept).count();
        u32::try_from(counted).unwrap_or(u32::MAX)
    }

    fn holds(&self, cell: Cell) -> bool {
        self.grid.get(Cell::new(cell.x - self.corner.x, cell.y - self.corner.y)) == Some(true)
    }
}

/// Explores the world of `setup` ideally: scans all round, without noise, from every place the robot could stand.
fn ideal_map(setup: &Setup, prepared: &Prepared) -> OccupancyMap {
    let Prepared { visible, solid, lidar, .. } = prepared;
    let (begins, mapping) = (setup.map_frame().relative(setup.start), &setup.parameters.mapping);
    let ideal = Lidar { noise_sd: 0.0, ..lidar.looking_round(2.0 * PI) };
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
    for place in reachable_places(setup, solid, mapping.resolution_m) {
        let pose = setup.start.compose(Pose::new(place.x, place.y, 0.0));
        sweep.cast(pose.compose(ideal.mount), &mut scan.ranges);
        map.integrate(Pose::new(begins.x + place.x, begins.y + place.y, 0.0), &scan);
    }
    map
}

/// Returns `parameters` for the robots that make a reference: without noise, prior knowledge or anything that a reading of the
/// study chooses, so that readings are counted against the same floor. They explore by the nearest frontier.
pub(in crate::studies::prior_map) fn of_reference(parameters: &Parameters) -> Parameters {
    let Parameters { sensing, mapping, navigation, measurement, .. } = parameters;
    Parameters {
        sensing: Sensing {
            range_m: sensing.range_m,
            field_of_view_deg: sensing.field_of_view_deg,
            range_noise_sd_m: Some(0.0),
            ..Sensing::default()
        },
        // Where odometry is exact there is nothing to estimate.
        mapping: Mapping {
            resolution_m: mapping.resolution_m,
            origin: mapping.origin,
            keyframe_distance_m: mapping.keyframe_distance_m,
            keyframe_turn_rad: mapping.keyframe_turn_rad,
            clip_range_m: mapping.clip_range_m,
            no_return: mapping.no_return,
            ..Mapping::default()
        },
        navigation: Navigation {
            obstacle_median_beams: 1,
            replan: Replan::default(),
            ..navigation.clone()
        },
        exploration: Exploration { strategy: Strategy::NearestFrontier, ..Exploration::default() },
        measurement: Measurement {
            coverage: measurement.coverage,
            reference: measurement.reference,
            coverage_map_cells: measurement.coverage_map_cells,
            ..Measurement::default()
        },
        mission: Mission { time_limit_s: PATIENCE_S, ..Mission::default() },
    }
}

/// Lets such robots explore the world of `setup` till no frontier is left, by each candidate of a frontier and by choosing
/// anew all the time, and returns what any of them has known. They draw no random number.
fn map_of_robots(setup: &Setup, prepared: &Prepared) -> OnLattice<Occupancy> {
    let ways = [
        (Candidate::Middle, Reselect::OnArrival),
        (Candidate::NearestToCentroid, Reselect::OnArrival),
        (Candidate::NearestToCentroid, Reselect::Continuous),
    ];
    let maps = ways.map(|(candidate, reselect)| {
        let mut parameters = of_reference(&setup.parameters);
        parameters.exploration.candidate = candidate;
        parameters.exploration.reselect = reselect;
        OnLattice::of_robot(&map_of_a_robot(setup, prepared, parameters))
    });
    let [first, second, third] = &maps;
    first.or(second).or(third)
}

fn map_of_a_robot(setup: &Setup, prepared: &Prepared, parameters: Parameters) -> OccupancyMap {
    let patient = Setup::new(
        Arc::clone(&setup.world),
        Arc::clone(&setup.robot),
        None,
        setup.start,
        parameters,
    );
    let there = Prepared {
        visible: prepared.visible.clone(),
        solid: prepared.solid.clone(),
        lidar: Lidar { noise_sd: 0.0, ..prepared.lidar.clone() },
        prior: None,
        reference: Arc::new(Reference::default()),
    };
    let (seeds, mut nobody) = (Seeds::new(0, Vec::new()), ());
    let mut mission = begin(&seeds, &patient, &there, None, &mut nobody);
    mission.drive();
    mission.mind.map().clone()
}

/// How long (s of simulated time) such a robot may explore. Where two frontiers win in turn it would go on for ever.
const PATIENCE_S: f64 = 2400.0;

fn counts(coverage: Coverage, value: Occupancy) -> bool {
    match coverage {
        Coverage::Paper => value == Occupancy::Free,
        Coverage::Released => value != Occupancy::Unknown,
    }
}

/// Finds the places (frame of the start) where the robot could stand, by a flood from its start over cells whose centre is a
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
