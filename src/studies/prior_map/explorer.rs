//! The robot's mind: perceive, find frontiers, choose, go (section 3.1, steps a to d).
//!
//! It sees odometry and scans and answers with velocities; it never sees the world. Locations, paths and waves are in
//! the map's frame, in which the mapper localises it ([`Mapper::pose`]): with trusted odometry that is the odometry
//! frame. The operator and its local map stay in the odometry frame, which does not jump, as in ROS.
//!
//! Over 400 lines, as every step reads and moves the one state of the mind.

use super::choice::{Choice, Chooser, Sight};
use super::frontier::Frontier;
use super::information_gain::AlignedPrior;
use super::parameters::{Parameters, Replan, Reselect};
use super::phase::{Decided, Journey, Phase};
use super::terrain::Terrain;
use super::tour::Tour;
use super::utility::ranked;
use crate::geometry::{Point, Pose};
use crate::grid::{Cell, GridFrame};
use crate::mapping::{Change, Mapper, OccupancyMap, Showing};
use crate::math;
use crate::navigation::{
    CostGrid, LocalMap, LocalRule, Operator, OperatorRule, RestingWave, Steering, Wavefront,
    look_ahead, nearest_reached,
};
use crate::rng::Stream;
use crate::robot::{Lidar, Odometry, Scan, Twist};
use crate::units::{Seconds, Tick};
use std::f64::consts::FRAC_PI_2;

pub use super::phase::Ending;

/// The navigator plans at 5 Hz, the operator drives at 10 Hz, and the local map is renewed at about 3 Hz (prior-map
/// facts, section 4).
pub const CONTROL_PERIOD: Tick = Tick(300);
const NAVIGATION_PERIOD: Tick = Tick(600);
const LOCAL_MAP_PERIOD: Tick = Tick(900);

/// Progress towards a location means coming closer by this much (m).
const PROGRESS: f64 = 0.1;
/// A frontier whose candidate is this near (m) to one given up is given up too.
const GIVEN_UP_RADIUS: f64 = 0.5;
/// Facing the unknown means within this angle (rad).
const FACING: f64 = 0.15;

/// An exploring mind.
#[derive(Debug)]
pub struct Explorer {
    parameters: Parameters,
    chooser: Chooser,
    mapper: Mapper,
    local: LocalMap,
    operator: Operator,
    phase: Phase,
    terrain: Terrain,
    wave: Option<Wavefront>,
    /// A wave that is no longer followed, for its memory.
    spare: Option<RestingWave>,
    steering: Option<Steering>,
    keyframe_wanted: bool,
    /// Where it arrived or turned to look, it waits for no later map to show what it sees.
    showing: Showing,
    map_changed: bool,
    next_local_map: Tick,
    next_navigation: Tick,
    given_up: Vec<Point>,
    faced: Option<Point>,
    choices: u32,
    last_choice: Option<Choice>,
    path_changed: bool,
    /// Draws how long choices take to have an effect.
    delays: Stream,
    decided: Option<Decided>,
}

impl Explorer {
    /// Creates a mind without observations, with the prior on the lattice of its map. `delays` is drawn from where
    /// choices take time (`exploration.decision-jitter-s`), `particles` where odometry is not trusted.
    pub fn new(
        parameters: &Parameters,
        lidar: &Lidar,
        prior: Option<AlignedPrior>,
        delays: Stream,
        particles: Stream,
    ) -> Self {
        let mapping = &parameters.mapping;
        let navigation = &parameters.navigation;
        let local_rule = LocalRule {
            median_beams: navigation.obstacle_median_beams as usize,
            ..LocalRule::default()
        };
        Self {
            chooser: Chooser::new(parameters, lidar, prior),
            mapper: Mapper::new(mapping.keyframes(), mapping.scans(), mapping.filter(), particles)
                .showing_every(mapping.update_interval()),
            local: LocalMap::new(local_rule),
            operator: Operator::new(OperatorRule {
                max_linear: navigation.max_linear_m_s,
                max_angular: navigation.max_angular_rad_s,
                robot_radius: navigation.robot_radius_m,
                comfort_radius: local_rule.inflation_radius,
            }),
            parameters: parameters.clone(),
            phase: Phase::Choosing,
            terrain: Terrain::new(navigation),
            wave: None,
            spare: None,
            steering: None,
            keyframe_wanted: false,
            showing: Showing::WhenDue,
            map_changed: false,
            next_local_map: Tick(0),
            next_navigation: Tick(0),
            given_up: Vec::new(),
            faced: None,
            choices: 0,
            last_choice: None,
            path_changed: false,
            delays,
            decided: None,
        }
    }

    /// Returns the same mind with a tour, in the frame of its map, to choose along under `strategy: topo-metric-tour`.
    #[must_use]
    pub fn with_tour(self, tour: Option<Tour>) -> Self {
        Self { chooser: self.chooser.with_tour(tour), ..self }
    }

    /// Returns whether the mind will use the scan taken at `odometry`.
    pub fn wants_scan(&mut self, odometry: Odometry) -> bool {
        self.keyframe_wanted |= self.mapper.wants(odometry.pose);
        self.keyframe_wanted || odometry.stamp >= self.next_local_map
    }

    /// Uses `scan`, taken at `odometry`, and returns the map cells that changed where it was taken into the map.
    pub fn take_scan(&mut self, odometry: Odometry, scan: &Scan) -> Option<&[Change]> {
        if odometry.stamp >= self.next_local_map {
            self.next_local_map = odometry.stamp + LOCAL_MAP_PERIOD;
            self.local.update(odometry.pose, scan);
        }
        if !self.keyframe_wanted {
            return None;
        }
        self.keyframe_wanted = false;
        let showing = std::mem::replace(&mut self.showing, Showing::WhenDue);
        let before = self.mapper.pose(odometry.pose);
        let is_shown = match self.mapper.integrate(odometry.pose, scan, showing) {
            Some(changes) => {
                self.terrain.note(changes);
                true
            }
            None => false,
        };
        self.map_changed |= is_shown;
        let after = self.mapper.pose(odometry.pose);
        if let Phase::Driving(journey) = &mut self.phase
            && before.position().distance(after.position()) > PROGRESS
        {
            // Its pose was corrected: its earlier progress means nothing.
            journey.closest = (f64::INFINITY, odometry.stamp);
        }
        Some(if is_shown { self.mapper.changes() } else { &[] })
    }

    /// Computes the velocity for the next control cycle.
    pub fn control(&mut self, odometry: Odometry) -> Twist {
        if odometry.stamp >= self.next_navigation {
            self.next_navigation = odometry.stamp + NAVIGATION_PERIOD;
            self.navigate(odometry);
        }
        match self.steering {
            Some(steering) => {
                self.operator.drive(steering, odometry.pose, &self.local, odometry.stamp)
            }
            None => Twist::STOP,
        }
    }

    /// Returns why exploration ended, once it has.
    pub fn ending(&self) -> Option<&Ending> {
        match &self.phase {
            Phase::Done(ending) => Some(ending),
            _ => None,
        }
    }

    /// Returns the map so far.
    pub fn map(&self) -> &OccupancyMap {
        self.mapper.map()
    }

    /// Returns how many times a location was chosen.
    pub fn choices(&self) -> u32 {
        self.choices
    }

    /// Returns how many locations were given up.
    pub fn given_up(&self) -> usize {
        self.given_up.len()
    }

    /// Returns its pose in the map, when odometry reads `odometry`.
    pub fn pose(&self, odometry: Pose) -> Pose {
        self.mapper.pose(odometry)
    }

    /// Returns whether it estimates its pose, that is, whether odometry is not trusted.
    pub fn estimates(&self) -> bool {
        self.mapper.estimates()
    }

    /// Returns its pose at each scan taken into the map, as now estimated; empty where odometry is trusted.
    pub fn way(&self) -> Vec<Pose> {
        self.mapper.way()
    }

    /// Returns how many frontiers there are, given up or not, when odometry reads `odometry`.
    pub fn open_frontiers(&mut self, odometry: Pose) -> usize {
        let pose = self.mapper.pose(odometry);
        let costs = self.terrain.costs_anew(self.map(), pose);
        self.chooser.frontiers(Sight { map: self.mapper.map(), costs: &costs, pose }).len()
    }

    /// Returns the choice made since the last call, if any.
    pub fn take_choice(&mut self) -> Option<Choice> {
        self.last_choice.take()
    }

    /// Returns the planned path (map frame) when odometry reads `odometry`, if it changed since the last call.
    pub fn take_path(&mut self, odometry: Pose) -> Option<Vec<Point>> {
        if !std::mem::take(&mut self.path_changed) {
            return None;
        }
        let pose = self.mapper.pose(odometry);
        let frame = self.frame_of_wave()?;
        let wave = self.wave.as_mut()?;
        let start = nearest_reached(wave, frame.cell_at(pose.position()))?;
        Some(wave.path(start).into_iter().map(|cell| frame.center(cell)).collect())
    }

    fn navigate(&mut self, odometry: Odometry) {
        let odometry = Odometry { pose: self.mapper.pose(odometry.pose), ..odometry };
        if let Some(decided) = self.decided.take_if(|decided| decided.due <= odometry.stamp) {
            // Its path was planned on the map of then, whose cells may have got other numbers since.
            self.map_changed = true;
            self.take_up(decided);
        }
        let tolerance = self.parameters.navigation.goal_tolerance_m;
        match self.phase.clone() {
            Phase::Done(_) => self.steering = None,
            Phase::Choosing if self.decided.is_some() => self.steering = None,
            Phase::Choosing => self.choose(odometry),
            Phase::Facing { towards } => {
                let off = bearing(odometry.pose, towards);
                if off.abs() < FACING {
                    self.faced = Some(towards);
                    self.look();
                    self.steering = None;
                    self.phase = Phase::Choosing;
                } else {
                    // Slower at the end, so that it does not turn past.
                    let speed = if off.abs() < 0.5 { 0.4 } else { 1.0 };
                    self.steering =
                        Some(Steering { direction: off.signum(), speed, distance: 0.0 });
                }
            }
            Phase::Driving(journey) => {
                let arrived = odometry.pose.position().distance(journey.target) <= tolerance;
                if arrived {
                    self.look();
                    self.steering = None;
                    self.phase = Phase::Choosing;
                } else if self.is_time_to_reconsider(&journey, odometry) {
                    self.choose(odometry);
                } else {
                    self.drive_on(journey, odometry);
                }
            }
        }
    }

    /// Has the next scan taken into the map, for the next choice to see.
    fn look(&mut self) {
        self.keyframe_wanted = true;
        self.showing = Showing::Now;
    }

    fn is_time_to_reconsider(&self, journey: &Journey, odometry: Odometry) -> bool {
        let exploration = &self.parameters.exploration;
        if exploration.reselect == Reselect::OnArrival || self.decided.is_some() {
            return false;
        }
        let period = if journey.remaining <= exploration.reselect_near_cost {
            exploration.reselect_near_period_s
        } else {
            exploration.reselect_period_s
        };
        odometry.stamp >= journey.chosen_at + Tick::at_or_after(Seconds(period))
    }

    fn drive_on(&mut self, mut journey: Journey, odometry: Odometry) {
        let is_outdated = std::mem::take(&mut self.map_changed)
            && self.parameters.navigation.replan == Replan::OnMapChange;
        if is_outdated || self.wave.is_none() {
            let earlier = self.wave.take().map(Wavefront::rest);
            let ground = self.terrain.ground(self.mapper.map(), odometry.pose);
            self.wave = Some(self.terrain.wave_to(earlier, &ground, journey.target));
            self.path_changed = true;
        }
        let Some(frame) = self.frame_of_wave() else { return };
        let Some(wave) = &mut self.wave else { return };
        let robot = frame.cell_at(odometry.pose.position());
        let Some(here) = nearest_reached(wave, robot) else {
            self.steering = None;
            self.phase = Phase::Choosing;
            return;
        };
        let remaining = wave.metres(here).unwrap_or(f64::INFINITY);
        let patience = Seconds(self.parameters.navigation.patience_s);
        journey.remaining = remaining;
        if remaining < journey.closest.0 - PROGRESS {
            journey.closest = (remaining, odometry.stamp);
        } else if odometry.stamp > journey.closest.1 + Tick::at_or_after(patience) {
            self.given_up.push(journey.target);
            self.steering = None;
            self.phase = Phase::Choosing;
            return;
        }
        let ahead = frame.center(look_ahead(wave, here));
        let off = bearing(odometry.pose, ahead);
        let speed = if remaining < 1.0 { 0.5 + remaining / 2.0 } else { 1.0 };
        self.steering = Some(Steering {
            direction: (off / FRAC_PI_2).clamp(-1.0, 1.0),
            speed,
            distance: odometry.pose.position().distance(ahead),
        });
        self.phase = Phase::Driving(journey);
    }

    /// Returns the frame of the present wave's cells.
    fn frame_of_wave(&self) -> Option<GridFrame> {
        match self.parameters.navigation.replan {
            // Where the map grows while a choice takes time, the old wave is followed in the new frame till then: that it should
            // not is left to the next engine version, as trials repeat bit for bit within one.
            Replan::OnMapChange => Some(*self.map().grid().frame()),
            Replan::OnChoice => Some(*self.wave.as_ref()?.frame()),
        }
    }

    /// Does step (c): chooses the most promising candidate location that can be reached.
    fn choose(&mut self, odometry: Odometry) {
        self.choices += 1;
        self.map_changed = false;
        // The present wave is followed where the target stays. Where the choice takes time, it serves until then.
        let is_instant = self.parameters.exploration.decision_jitter_s == 0.0;
        let earlier = self.wave.take_if(|_| is_instant).map(Wavefront::rest);
        let mut earlier = earlier.or_else(|| self.spare.take());
        let ground = self.terrain.ground(self.mapper.map(), odometry.pose);
        let mut choice = self.appraise(&ground.costs, odometry.pose);
        let tolerance = self.parameters.navigation.goal_tolerance_m;
        let robot = self.cell_at(odometry.pose);
        let (mut next, mut way) = (None, None);
        for i in ranked(&choice.utilities) {
            let target = choice.frame.center(choice.frontiers[i].candidate);
            if odometry.pose.position().distance(target) <= tolerance {
                // Already there, and the frontier is still one: look at its unknown side, once.
                let towards = choice.frontiers[i].unknown_side(self.map().grid());
                if self.faced.is_none_or(|faced| faced.distance(towards) > tolerance) {
                    choice.chosen = Some(i);
                    next = Some(Phase::Facing { towards });
                    break;
                }
                self.given_up.push(target);
                continue;
            }
            let mut wave = self.terrain.wave_to(earlier.take(), &ground, target);
            if let Some(here) = nearest_reached(&mut wave, robot) {
                choice.chosen = Some(i);
                let distance = wave.metres(here).unwrap_or(f64::INFINITY);
                let closest = (distance, odometry.stamp);
                way = Some(wave);
                next = Some(Phase::Driving(self.journey_to(target, closest, odometry.stamp)));
                break;
            }
            earlier = Some(wave.rest());
        }
        self.spare = earlier;
        let next = next.unwrap_or_else(|| {
            Phase::Done(if choice.frontiers.iter().all(|f| self.is_given_up(f, &choice.frame)) {
                Ending::NoFrontierLeft
            } else {
                Ending::NoWay { frontiers: choice.frontiers.len() }
            })
        });
        self.last_choice = Some(choice);
        let decided = Decided { due: odometry.stamp + self.delay(), next, wave: way };
        if decided.due <= odometry.stamp {
            self.take_up(decided);
        } else {
            self.decided = Some(decided);
        }
    }

    /// Draws how long the present choice takes to have an effect: numbered by choice, so that no draw depends on
    /// another.
    fn delay(&mut self) -> Tick {
        let longest = self.parameters.exploration.decision_jitter_s;
        let share = self.delays.at(u64::from(self.choices)).uniform();
        Tick::at_or_after(Seconds(longest * share))
    }

    /// Acts on the choice.
    fn take_up(&mut self, decided: Decided) {
        if let Some(wave) = decided.wave {
            self.spare = self.wave.replace(wave).map(Wavefront::rest).or(self.spare.take());
            self.path_changed = true;
        }
        if matches!(decided.next, Phase::Done(_)) {
            self.steering = None;
        }
        self.phase = decided.next;
    }

    /// Returns a new journey, or the present one continued where the target is still the same.
    fn journey_to(&self, target: Point, closest: (f64, Tick), now: Tick) -> Journey {
        match &self.phase {
            Phase::Driving(journey) if journey.target == target => {
                Journey { remaining: closest.0, chosen_at: now, ..journey.clone() }
            }
            _ => Journey { target, closest, remaining: closest.0, chosen_at: now },
        }
    }

    /// Does step (b) and computes the terms of equation 1, of the frontiers not given up.
    fn appraise(&mut self, costs: &CostGrid, pose: Pose) -> Choice {
        // Not by `map()`: the chooser updates its tour while it looks.
        let sight = Sight { map: self.mapper.map(), costs, pose };
        let mut frontiers = self.chooser.frontiers(sight);
        let frame = sight.map.grid().frame();
        frontiers.retain(|frontier| !self.is_given_up(frontier, frame));
        self.chooser.appraise(sight, frontiers)
    }

    fn is_given_up(&self, frontier: &Frontier, frame: &GridFrame) -> bool {
        let candidate = frame.center(frontier.candidate);
        self.given_up.iter().any(|given_up| given_up.distance(candidate) < GIVEN_UP_RADIUS)
    }

    fn cell_at(&self, pose: Pose) -> Cell {
        self.map().grid().frame().cell_at(pose.position())
    }
}

/// Returns the bearing (rad) of `point` from the robot's heading.
fn bearing(pose: Pose, point: Point) -> f64 {
    let to = pose.inverse_transform(point);
    math::atan2(to.y, to.x)
}
