//! One trial: the simulator at one end, the mind at the other, and the measures in between.
//!
//! Setting up:
//! 1. Draw the start of the trial.
//! 2. Make the scene with the errors of drive and odometry.
//! 3. Give the mind its prior, or its tour with the noise of the graph's nodes.
//!
//! Running:
//! 1. Perceive the first scan.
//! 2. At every control period ask the mind for a twist, command it and note the state; end where the trial's end is
//!    reached.
//! 3. Advance to the next control or scan, and perceive the scan.
//! 4. Add the measures to the record, those that the manifest asks for last.

pub mod columns;
mod plan_figure;
mod pose_errors;
mod recorder;
mod reference;
mod start;
#[cfg(test)]
mod tests;
mod trace;

pub use pose_errors::POSE_ERRORS;
pub use reference::SharedReference;
pub(super) use reference::of_reference;
pub use trace::{MILESTONES, at_level, coverage_at_distance, is_coverage_at_distance, level_of};

use super::explorer::{CONTROL_PERIOD, Ending, Explorer};
use super::information_gain::AlignedPrior;
use super::tour::Tour;
use super::{Origin, Parameters, Setup};
use crate::geometry::{Outline, Point, Pose};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use crate::rng::Seeds;
use crate::robot::{Lidar, Odometry, Scan};
use crate::sim::{Distribution, DriveNoise, OdometryNoise, Scene, Simulator};
use crate::studies::recording::Recording;
use crate::studies::{CannotBegin, Outcome, Stopwatch, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};
use pose_errors::PoseErrors;
use recorder::Recorder;
use reference::Reference;
use std::collections::BTreeMap;
use std::sync::Arc;
use trace::Trace;

/// Recorded at every milestone where a manifest asks for further measures.
pub const FURTHER_AT_MILESTONES: [&str; 2] = ["decisions", "open-frontiers"];

/// Coverage (percent) below which a robot that gives up the frontiers left has not explored its surroundings.
const EXPLORED_FROM_PERCENT: f64 = 50.0;

/// The data that all trials of a setup share: computed once, from the setup alone.
#[derive(Debug)]
pub struct Prepared {
    visible: Vec<Outline>,
    solid: Vec<Outline>,
    lidar: Lidar,
    prior: Option<AlignedPrior>,
    reference: Arc<Reference>,
}

impl Prepared {
    /// Cuts the world at the lidar's height, aligns the prior and makes what coverage is counted against.
    ///
    /// # Errors
    /// Where the robot has no range scanner, which resolution refuses with a better message.
    pub fn new(setup: &Setup) -> Result<Self, CannotBegin> {
        let own = setup.robot.lidar.as_ref().ok_or(CannotBegin::NoScanner)?;
        let sensing = &setup.parameters.sensing;
        let own = match sensing.field_of_view_deg {
            Some(degrees) => own.looking_round(degrees.to_radians()),
            None => own.clone(),
        };
        let lidar = Lidar {
            max_range: sensing.range_m.unwrap_or(own.max_range),
            noise_sd: sensing.range_noise_sd_m.unwrap_or(own.noise_sd),
            ..own
        };
        let visible = setup.world.slice(lidar.height);
        let solid = setup.world.contact(setup.robot.body_z[0], setup.robot.body_z[1]);
        let (frame, resolution) = (setup.map_frame(), setup.parameters.mapping.resolution_m);
        let prior = setup.prior.as_ref().map(|prior| AlignedPrior::new(prior, frame, resolution));
        let mut prepared =
            Self { visible, solid, lidar, prior, reference: Arc::new(Reference::default()) };
        prepared.reference = setup.reference.get_or_explore(|| Reference::of(setup, &prepared));
        Ok(prepared)
    }
}

/// Runs the trial, writing everything to `recording` where there is one. The record is the same either way, and
/// whatever `watch` does.
pub fn run(
    spec: &TrialSpec,
    setup: &Setup,
    recording: Option<&mut Recording>,
    watch: &mut dyn Stopwatch,
) -> TrialRecord {
    match setup.prepared() {
        Ok(prepared) => enact(spec, setup, prepared, recording, watch).0,
        Err(why) => TrialRecord::panicked(spec, why.to_string()),
    }
}

/// Runs the trial and returns the map with which its robot ends, in the world's frame and cut to its known part.
///
/// # Errors
/// Where the setup cannot run, the robot starts turned against the world's axes, or it maps nothing.
pub fn explored_map(spec: &TrialSpec, setup: &Setup) -> Result<OccupancyGrid, NoMap> {
    if setup.start.heading != 0.0 {
        return Err(NoMap::Turned { degrees: setup.start.heading.to_degrees() });
    }
    let (_, mind) = enact(spec, setup, setup.prepared()?, None, &mut ());
    known_part(mind.map().grid(), setup.map_frame().position()).ok_or(NoMap::Empty)
}

/// The reason why a trial leaves no map that another may be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoMap {
    /// Its cells would not be those of the world's axes.
    #[error("a start that faces along x is needed, and this is turned by {degrees} degrees")]
    Turned {
        /// Heading of the start (degrees).
        degrees: f64,
    },
    /// No trial of this condition can begin.
    #[error(transparent)]
    CannotBegin(#[from] CannotBegin),
    /// No cell is known at the end.
    #[error("its robot mapped nothing")]
    Empty,
}

/// Returns the smallest part of `map` that holds all its known cells, its origin moved by `shift`.
fn known_part(map: &OccupancyGrid, shift: Point) -> Option<OccupancyGrid> {
    let frame = map.frame();
    let known = || frame.cells().filter(|cell| map.at(*cell) != Occupancy::Unknown);
    let (left, right) = (known().map(|c| c.x).min()?, known().map(|c| c.x).max()?);
    let (low, high) = (known().map(|c| c.y).min()?, known().map(|c| c.y).max()?);
    let corner = Point::new(f64::from(left), f64::from(low)) * frame.resolution;
    let part = GridFrame {
        resolution: frame.resolution,
        origin: frame.origin + corner + shift,
        width: right - left + 1,
        height: high - low + 1,
    };
    let cells = part.cells().map(|c| map.at(Cell::new(c.x + left, c.y + low))).collect();
    Some(OccupancyGrid::from_cells(part, cells))
}

fn enact(
    spec: &TrialSpec,
    setup: &Setup,
    prepared: &Prepared,
    recording: Option<&mut Recording>,
    watch: &mut dyn Stopwatch,
) -> (TrialRecord, Explorer) {
    let mut mission = begin(&spec.seeds, setup, prepared, recording, watch);
    let ending = mission.drive();
    mission.measured(spec, ending)
}

fn begin<'a>(
    seeds: &Seeds,
    setup: &'a Setup,
    prepared: &'a Prepared,
    recording: Option<&'a mut Recording>,
    watch: &'a mut dyn Stopwatch,
) -> Mission<'a> {
    // 1. The start.
    let Parameters { sensing, measurement, .. } = &setup.parameters;
    let start = start::draw(setup, &prepared.solid, seeds);
    // 2. The scene.
    let scene = Scene {
        visible: &prepared.visible,
        solid: &prepared.solid,
        robot: &setup.robot,
        lidar: prepared.lidar.clone(),
        camera: None,
        compass: None,
        start: start.unwrap_or(setup.start),
        drive_noise: DriveNoise {
            distribution: Distribution::Gaussian,
            linear: sensing.drive_noise_linear,
            angular: sensing.drive_noise_angular,
            correlation: Seconds(sensing.drive_noise_correlation_s),
        },
        odometry_noise: OdometryNoise {
            distance: sensing.odometry_noise_distance,
            heading: sensing.odometry_noise_heading,
        },
    };
    let sim = Simulator::new(scene, seeds);
    // 3. The mind.
    let node_noise = setup.parameters.exploration.node_noise_sd_m;
    let tour = setup.topo_metric_map.as_ref().map(|map| {
        let mut noise = seeds.stream("node-noise");
        Tour::new(&map.seen_from(setup.map_frame()).with_noise(node_noise, &mut noise))
    });
    Mission {
        setup,
        prepared,
        scan: sim.blank_scan(),
        sim,
        mind: Explorer::new(
            &setup.parameters,
            &prepared.lidar,
            prepared.prior.clone(),
            seeds.stream("decision-delay"),
            seeds.stream("slam"),
        )
        .with_tour(tour),
        errors: PoseErrors::default(),
        trace: Trace::new(
            prepared.reference.total(),
            measurement.crossing,
            &measurement.coverage_at_distance_m,
            &measurement.coverage_levels_percent,
        ),
        further: BTreeMap::new(),
        recorder: recording.map(|recording| Recorder::new(recording, setup, &prepared.visible)),
        moved: (start.unwrap_or(setup.start), Tick(0)),
        known_start: known_start(setup, start),
        watch,
    }
}

/// Returns where the robot, which begins at `start` or as the manifest says, begins in the frame of its map; `None` where
/// that is its origin.
fn known_start(setup: &Setup, start: Option<Pose>) -> Option<Pose> {
    let is_shifted = setup.parameters.mapping.origin != Origin::Corner;
    let start = start.or_else(|| is_shifted.then_some(setup.start))?;
    Some(setup.map_frame().relative(start))
}

struct Mission<'a> {
    setup: &'a Setup,
    prepared: &'a Prepared,
    sim: Simulator,
    scan: Scan,
    mind: Explorer,
    trace: Trace,
    recorder: Option<Recorder<'a>>,
    /// Further measures taken during the trial.
    further: BTreeMap<String, f64>,
    /// Errors of poses, where these are estimated.
    errors: PoseErrors,
    /// The robot's start in the frame of the map, where that is not its origin. The mind knows it: its map, its prior and
    /// the reference of coverage share that one frame.
    known_start: Option<Pose>,
    /// The robot's pose when it last had moved on, and the time.
    moved: (Pose, Tick),
    watch: &'a mut dyn Stopwatch,
}

impl Mission<'_> {
    /// Runs to the end and returns how it ended.
    fn drive(&mut self) -> (Outcome, String) {
        // 1. The first scan.
        let limit = Tick::at_or_after(Seconds(self.setup.parameters.mission.time_limit_s));
        let mut next_control = Tick(0);
        self.perceive();
        // 2. Control.
        loop {
            if self.sim.now() >= next_control {
                next_control = next_control + CONTROL_PERIOD;
                let choices = self.mind.choices();
                self.watch.asked();
                let twist = self.mind.control(self.known(self.sim.odometry()));
                if self.mind.choices() > choices {
                    self.watch.chose();
                    self.trace.note_choice(self.sim.now(), self.sim.travelled());
                }
                self.sim.command(twist);
                self.note_state();
                if let Some(ending) = self.ending(limit) {
                    return ending;
                }
            }
            // 3. Advance.
            let until = next_control.min(self.sim.next_scan());
            self.sim.advance_to(until);
            if self.sim.now() == self.sim.odometry_at_scan().stamp {
                self.perceive();
            }
        }
    }

    /// Returns the record of the trial `spec` that ended so, and its mind.
    fn measured(
        self,
        spec: &TrialSpec,
        (outcome, cause): (Outcome, String),
    ) -> (TrialRecord, Explorer) {
        // 4. Measures.
        let mut record = self.trace.finish(spec, outcome, cause, self.sim.now());
        let mut measure = |name: &str, value: f64| {
            record.measures.insert(name.to_owned(), Some(value));
        };
        measure("distance-m", self.sim.travelled());
        measure("turning-rad", self.sim.turned());
        measure("decisions", f64::from(self.mind.choices()));
        #[expect(clippy::cast_precision_loss, reason = "few")]
        measure("frontiers-given-up", self.mind.given_up() as f64);
        measure("contacts", f64::from(self.sim.contacts()));
        for (name, value) in self.errors.measures(&self.mind.way()) {
            measure(name, value);
        }
        if self.setup.parameters.measurement.mean_speed {
            let (distance, time) = (self.sim.travelled(), self.sim.now().seconds().get());
            let mean = (time > 0.0).then(|| distance / time);
            record.measures.insert("mean-speed-m-s".to_owned(), mean);
        }
        if self.setup.parameters.measurement.further {
            let distance = self.sim.travelled();
            let per_metre = (distance > 0.0).then(|| self.sim.turned() / distance);
            record.measures.insert("turning-rad-per-m".to_owned(), per_metre);
            for name in FURTHER_AT_MILESTONES {
                for percent in MILESTONES {
                    let name = format!("{name}-at-{percent}");
                    let value = self.further.get(&name).copied();
                    record.measures.insert(name, value);
                }
            }
        }
        (record, self.mind)
    }

    /// Does step (a): shows the mind the scan just taken, where it wants it.
    fn perceive(&mut self) {
        let odometry = self.known(self.sim.odometry_at_scan());
        let wanted = self.mind.wants_scan(odometry);
        if wanted || self.recorder.as_ref().is_some_and(Recorder::wants_scans) {
            self.sim.read_scan(&mut self.scan);
        }
        if let Some(recorder) = &mut self.recorder {
            let believed = self.mind.pose(odometry.pose);
            recorder.sensed(&self.scan, self.sim.odometry_at_scan(), believed);
        }
        if !wanted {
            return;
        }
        let Some(changes) = self.mind.take_scan(odometry, &self.scan) else { return };
        let is_new = !changes.is_empty();
        for change in changes {
            let reference = &self.prepared.reference;
            let was = reference.covers(change.cell, change.from);
            let is = reference.covers(change.cell, change.to);
            self.trace.cover(i64::from(is) - i64::from(was));
        }
        if let Some(recorder) = &mut self.recorder
            && is_new
        {
            recorder.map_changed(changes, &self.scan, self.sim.true_pose());
        }
        if self.mind.estimates() {
            let truth = self.setup.map_frame().relative(self.sim.true_pose());
            self.errors.note(truth, self.mind.pose(odometry.pose), odometry.pose);
        }
        if !is_new {
            return;
        }
        let crossed = self.trace.note_coverage(self.sim.now(), self.sim.travelled());
        if self.setup.parameters.measurement.further {
            for percent in MILESTONES.into_iter().filter(|percent| crossed.contains(percent)) {
                self.note_milestone(percent, odometry.pose);
            }
        }
    }

    /// Notes further measures at the keyframe that brought `percent`, with the robot at `pose` in its own frame.
    fn note_milestone(&mut self, percent: u32, pose: Pose) {
        #[expect(clippy::cast_precision_loss, reason = "few")]
        let open = self.mind.open_frontiers(pose) as f64;
        let decisions = f64::from(self.mind.choices());
        self.further.insert(format!("decisions-at-{percent}"), decisions);
        self.further.insert(format!("open-frontiers-at-{percent}"), open);
    }

    /// Returns odometry as the mind receives it, in the frame of the map.
    fn known(&self, odometry: Odometry) -> Odometry {
        match self.known_start {
            Some(start) => Odometry { pose: start.compose(odometry.pose), ..odometry },
            None => odometry,
        }
    }

    fn note_state(&mut self) {
        let now = self.sim.now();
        let pose = self.sim.true_pose();
        self.trace.note_time(now, self.sim.travelled(), pose, self.mind.choices());
        let here = self.known(self.sim.odometry()).pose;
        if let Some(recorder) = &mut self.recorder {
            let choice = self.mind.take_choice();
            let path = self.mind.take_path(here);
            recorder.note(
                now,
                pose,
                self.sim.travelled(),
                self.trace.coverage_percent(),
                choice.as_ref(),
                path,
            );
        }
    }

    /// Returns how a trial ends whose robot has no frontier left: not as explored where it gave some up and most is yet to
    /// be seen.
    fn without_frontiers(&self) -> (Outcome, String) {
        let (given_up, covered) = (self.mind.given_up(), self.trace.coverage_percent());
        if given_up == 0 || covered >= EXPLORED_FROM_PERCENT {
            return (Outcome::EXPLORED, String::new());
        }
        let frontiers = match given_up {
            1 => "the one frontier that was".to_owned(),
            more => format!("all {more} frontiers that were"),
        };
        (Outcome::GAVE_UP, format!("gave up {frontiers} left at {covered:.0} % coverage"))
    }

    fn ending(&mut self, limit: Tick) -> Option<(Outcome, String)> {
        match self.mind.ending() {
            Some(Ending::NoFrontierLeft) => return Some(self.without_frontiers()),
            Some(Ending::NoWay { frontiers }) => {
                let cause = format!("no way to any of {frontiers} frontiers");
                return Some((Outcome::STUCK, cause));
            }
            None => {}
        }
        let now = self.sim.now();
        if now >= limit {
            return Some((Outcome::TIME_LIMIT, String::new()));
        }
        let mission = &self.setup.parameters.mission;
        let enough = mission.stop_at_coverage_percent;
        if enough.is_some_and(|percent| self.trace.coverage_percent() >= percent)
            && self.trace.is_settled()
        {
            return Some((Outcome::COVERED, String::new()));
        }
        let pose = self.sim.true_pose();
        if pose.position().distance(self.moved.0.position()) >= mission.stuck_distance_m {
            self.moved = (pose, now);
        }
        let patience = Tick::at_or_after(Seconds(mission.stuck_after_s));
        (now > self.moved.1 + patience).then(|| {
            let cause = format!(
                "moved less than {} m in {} s",
                mission.stuck_distance_m, mission.stuck_after_s
            );
            (Outcome::STUCK, cause)
        })
    }
}
