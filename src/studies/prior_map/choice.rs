//! Steps (b) and (c): frontiers, and their appraisal (section 3.1).

use super::field_of_view::{FieldOfView, Headings};
use super::frontier::{Frontier, FrontierFinder};
use super::gain_memory::GainMemory;
use super::information_gain::{AlignedPrior, InformationGain};
use super::parameters::{Exploration, Gain, Parameters, SearchFrom, Strategy, View};
use super::released_gain::ReleasedGains;
use super::terrain::cost;
use super::tour::Tour;
use super::utility::{Appraisal, utilities};
use crate::geometry::Pose;
use crate::grid::{Cell, GridFrame, Occupancy, QUADRANTS};
use crate::mapping::OccupancyMap;
use crate::math;
use crate::navigation::{CostGrid, nearest};
use crate::robot::Lidar;
use std::f64::consts::TAU;

/// A choice among frontiers, with the data on which it was made. Cells are those of `frame`.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The frame of the cells.
    pub frame: GridFrame,
    /// All frontiers not given up.
    pub frontiers: Vec<Frontier>,
    /// D and I of each.
    pub appraisals: Vec<Appraisal>,
    /// u of each.
    pub utilities: Vec<f64>,
    /// The chosen one.
    pub chosen: Option<usize>,
}

/// The data for a choice.
#[derive(Debug, Clone, Copy)]
pub struct Sight<'a> {
    /// The map M_E so far.
    pub map: &'a OccupancyMap,
    /// The same map inflated, the place where the robot stands free.
    pub costs: &'a CostGrid,
    /// The robot's pose in the map's frame.
    pub pose: Pose,
}

/// Finds and appraises frontiers by one set of parameters.
#[derive(Debug)]
pub struct Chooser {
    exploration: Exploration,
    frontier_lethal: u8,
    finder: FrontierFinder,
    prior: Option<AlignedPrior>,
    /// Range of the scanner in cells.
    range: i32,
    /// `None` where the scanner looks all round, or is assumed to.
    view: Option<FieldOfView>,
    /// Only for the best of all headings.
    headings: Option<Headings>,
    /// Only for the released program's gain.
    released: Option<ReleasedGains>,
    /// Only for the method of reference 8.
    tour: Option<Tour>,
    memory: GainMemory,
}

impl Chooser {
    /// Creates a chooser by `parameters`, with the prior on the lattice of the robot's map.
    pub fn new(parameters: &Parameters, lidar: &Lidar, prior: Option<AlignedPrior>) -> Self {
        let exploration = parameters.exploration.clone();
        let clip_range = parameters.mapping.clip_range_m.unwrap_or(f64::INFINITY);
        let reach = clip_range.min(lidar.max_range) / parameters.mapping.resolution_m;
        #[expect(clippy::cast_possible_truncation, reason = "ranges are checked to be below 200 m")]
        let range = reach.round() as i32;
        let view = FieldOfView { min_angle: lidar.min_angle, max_angle: lidar.max_angle };
        let is_turned = exploration.view != View::AllRound && view.width() < TAU;
        let view = (is_turned && exploration.gain == Gain::Paper).then_some(view);
        Self {
            headings: view
                .filter(|_| exploration.view == View::Best)
                .map(|view| Headings::new(range, view.width())),
            released: (exploration.gain == Gain::Released)
                .then(|| ReleasedGains::new(&exploration, range, prior.is_some())),
            frontier_lethal: cost(parameters.navigation.frontier_lethal_cost),
            finder: FrontierFinder::default(),
            exploration,
            prior,
            range,
            view,
            tour: None,
            memory: GainMemory::default(),
        }
    }

    /// Returns the same chooser, choosing along `tour` where the strategy requires it.
    #[must_use]
    pub fn with_tour(self, tour: Option<Tour>) -> Self {
        let tour = tour.filter(|_| self.exploration.strategy == Strategy::TopoMetricTour);
        Self { tour, ..self }
    }

    /// Does step (b): finds the frontiers that the robot can reach.
    pub fn frontiers(&mut self, sight: Sight<'_>) -> Vec<Frontier> {
        let map = sight.map.grid();
        let robot = map.frame().cell_at(sight.pose.position());
        let Exploration { minimum_frontier_cells, candidate, .. } = self.exploration;
        let lethal = self.frontier_lethal;
        let mut found_from = |cell: Cell| {
            self.finder.find(map, sight.costs, cell, lethal, minimum_frontier_cells, candidate)
        };
        let found = found_from(robot);
        if !found.is_empty() || self.exploration.search_from == SearchFrom::Robot {
            return found;
        }
        // It stands too close to an obstacle for the search to leave its cell.
        let is_free = |cell: &Cell| sight.costs.is_below(*cell, lethal);
        nearest(robot, is_free).map_or(found, found_from)
    }

    /// Computes the terms of equation 1 for `frontiers`; none is chosen yet. Without a utility there is no gain, and
    /// the values in place of u(p) have the order of the strategy.
    pub fn appraise(&mut self, sight: Sight<'_>, frontiers: Vec<Frontier>) -> Choice {
        let frame = *sight.map.grid().frame();
        let by_distance = self.exploration.strategy != Strategy::Utility;
        let gains = if by_distance {
            vec![0.0; frontiers.len()]
        } else {
            let candidates: Vec<Cell> = frontiers.iter().map(|f| f.candidate).collect();
            self.gains(sight, &candidates)
        };
        let distance = |f: &Frontier| sight.pose.position().distance(frame.center(f.candidate));
        let appraisals: Vec<_> = frontiers
            .iter()
            .zip(gains)
            .map(|(f, gain)| Appraisal { distance: distance(f), gain })
            .collect();
        let alpha = if by_distance { 1.0 } else { self.exploration.alpha };
        let utilities = match &mut self.tour {
            None => utilities(&appraisals, alpha),
            Some(tour) => {
                let places: Vec<_> = frontiers.iter().map(|f| frame.center(f.candidate)).collect();
                let map = sight.map.grid();
                let is_known = |place| map.at(frame.cell_at(place)) != Occupancy::Unknown;
                tour.rank(sight.pose.position(), &places, is_known)
            }
        };
        Choice { frame, frontiers, appraisals, utilities, chosen: None }
    }

    /// Computes I(p) of every candidate location.
    fn gains(&mut self, sight: Sight<'_>, candidates: &[Cell]) -> Vec<f64> {
        let (map, offset, prior) = (sight.map.grid(), sight.map.offset(), self.prior.as_ref());
        let exploration = &self.exploration;
        if let Some(released) = &mut self.released {
            return released.of(map, sight.costs, offset, prior, candidates);
        }
        let occlude = exploration.known_obstacles_occlude;
        let gain = InformationGain::new(map, offset, prior, self.range, occlude);
        match (self.view, &self.headings) {
            (None, _) => {
                self.memory.gains(gain, candidates, QUADRANTS, InformationGain::in_quadrant)
            }
            (Some(_), Some(headings)) => {
                let best = |gain: &InformationGain, _, p, examined: &mut _| {
                    gain.best(p, headings, examined)
                };
                self.memory.gains(gain, candidates, 1, best)
            }
            (Some(view), None) => {
                let one = |&p: &Cell| {
                    let way = map.frame().center(p) - sight.pose.position();
                    // Where it already stands there is no direction of arrival: it keeps its heading.
                    let is_there = way.norm() < map.frame().resolution;
                    let heading =
                        if is_there { sight.pose.heading } else { math::atan2(way.y, way.x) };
                    gain.within(p, view.facing(heading))
                };
                candidates.iter().map(one).collect()
            }
        }
    }
}
