//! One trial: the simulator on one end, the mind on the other, and what is measured in between.

mod plan_figure;
mod pose_errors;
mod recorder;
mod reference;
mod start;
#[cfg(test)]
mod tests;
mod trace;

pub use plan_figure::plan_figure;
pub use pose_errors::POSE_ERRORS;
pub use trace::MILESTONES;

use super::explorer::{CONTROL_PERIOD, Ending, Explorer};
use super::information_gain::AlignedPrior;
use super::{Parameters, Setup};
use crate::geometry::{Outline, Pose};
use crate::robot::{Lidar, Odometry, Scan};
use crate::sim::{Distribution, DriveNoise, OdometryNoise, Scene, Simulator, Stepping};
use crate::studies::recording::Recording;
use crate::studies::{Outcome, Stopwatch, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};
use pose_errors::PoseErrors;
use recorder::Recorder;
use reference::Reference;
use std::collections::BTreeMap;
use trace::Trace;

/// Recorded at every milestone where a manifest asks for further measures.
pub const FURTHER_AT_MILESTONES: [&str; 2] = ["decisions", "open-frontiers"];

/// What all trials of a setup share: computed once, from the setup alone.
#[derive(Debug)]
pub struct Prepared {
    visible: Vec<Outline>,
    solid: Vec<Outline>,
    lidar: Lidar,
    prior: Option<AlignedPrior>,
    reference: Reference,
}

impl Prepared {
    /// Cuts the world at the lidar's height, aligns the prior and explores ideally.
    ///
    /// # Errors
    /// Where the robot has no range scanner, which resolution refuses with a better message.
    pub fn new(setup: &Setup) -> Result<Self, String> {
        let own = setup.robot.lidar.as_ref().ok_or("the robot has no range scanner")?;
        let sensing = &setup.parameters.sensing;
        let lidar = Lidar {
            max_range: sensing.range_m.unwrap_or(own.max_range),
            noise_sd: sensing.range_noise_sd_m.unwrap_or(own.noise_sd),
            ..own.clone()
        };
        let visible = setup.world.slice(lidar.height);
        let solid = setup.world.contact(setup.robot.body_z[0], setup.robot.body_z[1]);
        let resolution = setup.parameters.mapping.resolution_m;
        let prior =
            setup.prior.as_ref().map(|prior| AlignedPrior::new(prior, setup.start, resolution));
        let reference = Reference::explore(setup, &lidar, &visible, &solid);
        Ok(Self { visible, solid, lidar, prior, reference })
    }
}

/// Runs the trial, writing everything down in `recording` where there is one. The record is the same either way,
/// and whatever `watch` does.
pub fn run(
    spec: &TrialSpec,
    setup: &Setup,
    recording: Option<&mut Recording>,
    watch: &mut dyn Stopwatch,
) -> TrialRecord {
    let prepared = match setup.prepared() {
        Ok(prepared) => prepared,
        Err(cause) => return TrialRecord::panicked(spec, cause),
    };
    let Parameters { sensing, measurement, .. } = &setup.parameters;
    let start = start::draw(setup, &prepared.solid, &spec.seeds);
    let scene = Scene {
        visible: &prepared.visible,
        solid: &prepared.solid,
        robot: &setup.robot,
        lidar: prepared.lidar.clone(),
        camera: None,
        compass: None,
        start: start.unwrap_or(setup.start),
        stepping: Stepping::Always,
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
    let sim = Simulator::new(scene, &spec.seeds);
    let mission = Mission {
        setup,
        prepared,
        scan: sim.blank_scan(),
        sim,
        mind: Explorer::new(
            &setup.parameters,
            &prepared.lidar,
            prepared.prior.clone(),
            spec.seeds.stream("decision-delay"),
            spec.seeds.stream("slam"),
        ),
        errors: PoseErrors::default(),
        trace: Trace::new(prepared.reference.total(), measurement.crossing),
        further: BTreeMap::new(),
        recorder: recording.map(|recording| Recorder::new(recording, setup, &prepared.visible)),
        moved: (start.unwrap_or(setup.start), Tick(0)),
        known_start: start.map(|start| setup.start.relative(start)),
        watch,
    };
    mission.run(spec)
}

struct Mission<'a> {
    setup: &'a Setup,
    prepared: &'a Prepared,
    sim: Simulator,
    scan: Scan,
    mind: Explorer,
    trace: Trace,
    recorder: Option<Recorder<'a>>,
    /// Further measures taken on the way.
    further: BTreeMap<String, f64>,
    /// How far off poses are, where they are estimated.
    errors: PoseErrors,
    /// Where the robot starts in the frame of the manifest's start, where that is not the origin. The mind knows it: its
    /// map, its prior and what coverage is measured against share that one frame.
    known_start: Option<Pose>,
    /// Where the robot was when it last had moved on, and when.
    moved: (Pose, Tick),
    watch: &'a mut dyn Stopwatch,
}

impl Mission<'_> {
    fn run(mut self, spec: &TrialSpec) -> TrialRecord {
        let limit = Tick::at_or_after(Seconds(self.setup.parameters.mission.time_limit_s));
        let mut next_control = Tick(0);
        self.perceive();
        let (outcome, cause) = loop {
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
                    break ending;
                }
            }
            let until = next_control.min(self.sim.next_scan());
            self.sim.advance_to(until);
            if self.sim.now() == self.sim.odometry_at_scan().stamp {
                self.perceive();
            }
        };
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
        record
    }

    /// Step (a): shows the mind the scan just taken, where it wants it.
    fn perceive(&mut self) {
        let odometry = self.known(self.sim.odometry_at_scan());
        if !self.mind.wants_scan(odometry) {
            return;
        }
        self.sim.read_scan(&mut self.scan);
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
            let truth = self.setup.start.relative(self.sim.true_pose());
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

    /// Further measures at the keyframe that brought `percent`, with the robot at `pose` in its own frame.
    fn note_milestone(&mut self, percent: u32, pose: Pose) {
        #[expect(clippy::cast_precision_loss, reason = "few")]
        let open = self.mind.open_frontiers(pose) as f64;
        let decisions = f64::from(self.mind.choices());
        self.further.insert(format!("decisions-at-{percent}"), decisions);
        self.further.insert(format!("open-frontiers-at-{percent}"), open);
    }

    /// Odometry as the mind is told it, in the frame of the manifest's start.
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

    fn ending(&mut self, limit: Tick) -> Option<(Outcome, String)> {
        match self.mind.ending() {
            Some(Ending::NoFrontierLeft) => return Some((Outcome::Explored, String::new())),
            Some(Ending::NoWay { frontiers }) => {
                let cause = format!("no way to any of {frontiers} frontiers");
                return Some((Outcome::Stuck, cause));
            }
            None => {}
        }
        let now = self.sim.now();
        if now >= limit {
            return Some((Outcome::TimeLimit, String::new()));
        }
        let mission = &self.setup.parameters.mission;
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
            (Outcome::Stuck, cause)
        })
    }
}
