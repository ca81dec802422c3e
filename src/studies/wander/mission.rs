//! One trial: the simulator at one end, the mind at the other, and the measures in between.
//!
//! 1. The scene: the world cut at the scanner's height, the robot, no errors.
//! 2. The recording takes what never changes.
//! 3. Until the time is up: advance to the next scan, let the mind steer, count the floor, and extend the chain of
//!    states and the recording.
//! 4. The measures become the record.

use super::Setup;
use super::mind::Mind;
use crate::geometry::{Bounds, Point};
use crate::grid::{Cell, Grid, GridFrame};
use crate::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use crate::studies::recording::{Frame, Recording};
use crate::studies::state_chain::StateChain;
use crate::studies::{Outcome, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};

/// Runs the trial in the steps of the module documentation, writing everything to `recording` where there is one.
pub(super) fn run(
    spec: &TrialSpec,
    setup: &Setup,
    mut recording: Option<&mut Recording>,
) -> TrialRecord {
    // 1. The scene.
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
        drive_noise: DriveNoise::NONE,
        odometry_noise: OdometryNoise { distance: 0.0, heading: 0.0 },
    };
    // 2. What never changes.
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
    // 3. Scan, steer, measure.
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
    // 4. The record.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::condition::Condition;
    use crate::digest::{Sha256Digest, TrialKey};
    use crate::document::Source;
    use crate::geometry::Pose;
    use crate::rng::Seeds;
    use crate::robot::urdf;
    use crate::studies::wander::{Driving, Mission, Parameters};
    use crate::studies::{self, reenact};
    use crate::world::document;
    use std::sync::Arc;

    /// Returns trial `number` of two seconds from (3, 2) m in our small apartment, at `linear_m_s`.
    fn spec(number: u32, linear_m_s: f64) -> TrialSpec {
        let file = |name: &str, text: &str| Source::new(name, text);
        let robot = file("kobuki.urdf", include_str!("../../../robots/kobuki.urdf"));
        let world = file("basic.yaml", include_str!("../../../worlds/basic.yaml"));
        let setup = Setup {
            world: Arc::new(document::read(&world, None).unwrap()),
            robot: Arc::new(urdf::read(&robot).unwrap().0),
            start: Pose::new(3.0, 2.0, 0.0),
            parameters: Parameters {
                driving: Driving { linear_m_s, ..Driving::default() },
                // Cells so small that areas are those of the geometry.
                mission: Mission { time_limit_s: 2.0, cell_m: 0.01 },
            },
        };
        TrialSpec {
            key: TrialKey(Sha256Digest::of(number.to_le_bytes())),
            condition: Condition::default(),
            trial: number,
            seeds: Seeds::new(1, vec![("trial".to_owned(), number.to_string())]),
            setup: studies::Setup::new(setup),
        }
    }

    #[test]
    fn a_trial_ends_at_its_limit_and_measures_its_way_and_the_floor_under_it() {
        let record = studies::execute(&spec(0, 0.4));
        assert_eq!((record.outcome, record.sim_seconds), (Outcome::TIME_LIMIT, 2.0));
        let measure = |name: &str| record.measures[name].unwrap();
        // The first scan comes at 0.1 s at the latest, and the body takes its time to speed up.
        let way = measure("distance-m");
        assert!((0.6..=0.8).contains(&way), "{way} m at 0.4 m/s in 2 s");
        // A disc of radius r that goes straight covers πr² + 2r·way.
        let radius = spec(0, 0.4).setup.robot().circumscribed_radius();
        let covered = std::f64::consts::PI * radius * radius + 2.0 * radius * way;
        let found = measure("coverage-m2");
        assert!((found / covered - 1.0).abs() < 0.03, "{found} of {covered} m²");
        assert_eq!((measure("turns"), measure("contacts")), (0.0, 0.0));
    }

    #[test]
    fn a_replay_sees_the_trial_that_was_run() {
        let (record, recording) = reenact(&spec(1, 0.2));
        assert_eq!(record, studies::execute(&spec(1, 0.2)));
        let last = recording.frames.last().unwrap();
        assert_eq!(Some(last.distance_m), record.measures["distance-m"]);
        assert_eq!(last.time_s, 2.0);
    }
}
