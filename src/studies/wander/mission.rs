//! One trial: the simulator on one end, the mind on the other, and what is measured in between.

use super::Setup;
use super::mind::Mind;
use crate::geometry::{Bounds, Point};
use crate::grid::{Cell, Grid, GridFrame};
use crate::sim::{DriveNoise, OdometryNoise, Scene, Simulator, Stepping};
use crate::studies::recording::{Frame, Recording};
use crate::studies::state_chain::StateChain;
use crate::studies::{Outcome, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};

/// Runs the trial, writing everything down in `recording` where there is one.
pub(super) fn run(
    spec: &TrialSpec,
    setup: &Setup,
    mut recording: Option<&mut Recording>,
) -> TrialRecord {
    let Some(lidar) = setup.robot.lidar.clone() else {
        return TrialRecord::panicked(spec, "the robot has no range scanner".to_owned());
    };
    let visible = setup.world.slice(lidar.height);
    let scene = Scene {
        visible: &visible,
        solid: &setup.world.contact(setup.robot.body_z[0], setup.robot.body_z[1]),
        robot: &setup.robot,
        lidar,
        camera: None,
        compass: None,
        start: setup.start,
        stepping: Stepping::Always,
        drive_noise: DriveNoise::NONE,
        odometry_noise: OdometryNoise { distance: 0.0, heading: 0.0 },
    };
    if let Some(recording) = &mut recording {
        recording.world.clone_from(&visible);
        recording.footprint = setup.robot.footprint.clone();
        recording.rule.push_str("straight ahead, and a random turn where the way is blocked");
    }
    let mission = &setup.parameters.mission;
    let mut sim = Simulator::new(scene, &spec.seeds);
    let mut scan = sim.blank_scan();
    let driving = setup.parameters.driving.clone();
    let mut mind = Mind::new(driving, spec.seeds.stream("turns"));
    let mut swept = Swept::new(setup, mission.cell_m);
    let mut chain = StateChain::default();
    let limit = Tick::at_or_after(Seconds(mission.time_limit_s));
    while sim.now() < limit {
        sim.advance_to(sim.next_scan().min(limit));
        sim.read_scan(&mut scan);
        sim.command(mind.steer(&scan));
        let pose = sim.true_pose();
        swept.pass(pose.position());
        if chain.is_due(sim.now()) {
            chain.push(|hasher| {
                let state = [pose.x, pose.y, pose.heading, sim.travelled(), swept.area_m2()];
                for number in state {
                    hasher.update(number.to_le_bytes());
                }
            });
        }
        if let Some(recording) = &mut recording {
            recording.frames.push(Frame {
                time_s: sim.now().seconds().get(),
                pose,
                distance_m: sim.travelled(),
                ..Frame::default()
            });
        }
    }
    let measures = [
        ("distance-m", sim.travelled()),
        ("coverage-m2", swept.area_m2()),
        ("turns", f64::from(mind.blocked)),
        ("contacts", f64::from(sim.contacts())),
    ];
    TrialRecord {
        outcome: Outcome::TIME_LIMIT,
        measures: measures.map(|(name, value)| (name.to_owned(), Some(value))).into(),
        sim_seconds: sim.now().seconds().get(),
        chain: chain.to_hex(),
        ..TrialRecord::panicked(spec, String::new())
    }
}

/// The floor that the body has passed over, in cells.
struct Swept {
    cells: Grid<bool>,
    count: u32,
    /// Of the circle around the body, in which cells count (m).
    radius: f64,
}

impl Swept {
    fn new(setup: &Setup, cell: f64) -> Self {
        let bounds: Bounds = setup.world.bounds();
        let frame = GridFrame::covering(bounds.grown(1.0), cell);
        let radius = setup.robot.circumscribed_radius();
        Self { cells: Grid::filled(frame, false), count: 0, radius }
    }

    /// Counts the cells whose centre lies in that circle with the body at `at`.
    fn pass(&mut self, at: Point) {
        let frame = *self.cells.frame();
        let reach = Point::new(self.radius, self.radius);
        let (low, high) = (frame.cell_at(at + reach * -1.0), frame.cell_at(at + reach));
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let cell = Cell::new(x, y);
                let is_under = frame.center(cell).distance(at) <= self.radius;
                if is_under && self.cells.get(cell) == Some(false) {
                    self.cells.set(cell, true);
                    self.count += 1;
                }
            }
        }
    }

    fn area_m2(&self) -> f64 {
        let side = self.cells.frame().resolution;
        f64::from(self.count) * side * side
    }
}
