//! The step loop asks for no memory: physics, sensors and control cycles work in what they were given at the start, once it has
//! grown to the size that they need. A binary of its own, because it counts every allocation.

#[expect(dead_code, reason = "benchmarks drive on")]
#[path = "../benches/driving/mod.rs"]
mod driving;
#[path = "../benches/shipped/mod.rs"]
mod shipped;

use allocation_counter::measure;
use reenact::document::Source;
use reenact::geometry::{Outline, Point, Pose};
use reenact::rng::Seeds;
use reenact::robot::{Robot, Twist, urdf};
use reenact::sim::{
    CameraScene, CompassNoise, Distribution, DriveNoise, Occlusion, OdometryNoise, Scene, Simulator,
};
use reenact::studies::prior_map::explorer::CONTROL_PERIOD;
use reenact::units::Tick;
use reenact::world::Tag;

const PIONEER: &str = include_str!("../robots/pioneer3at.urdf");

/// Returns the walls of a room of 20 m x 20 m with pillars.
fn room() -> Vec<Outline> {
    let mut walls = vec![
        Outline::rectangle(Point::new(0.0, 10.0), 20.0, 0.2, 0.0),
        Outline::rectangle(Point::new(0.0, -10.0), 20.0, 0.2, 0.0),
        Outline::rectangle(Point::new(10.0, 0.0), 0.2, 20.0, 0.0),
        Outline::rectangle(Point::new(-10.0, 0.0), 0.2, 20.0, 0.0),
    ];
    for (x, y) in [(-5.0, -5.0), (-5.0, 5.0), (5.0, -5.0), (5.0, 5.0)] {
        walls.push(Outline::Circle { center: Point::new(x, y), radius: 0.4 });
    }
    walls
}

fn robot() -> Robot {
    urdf::read(&Source::new("pioneer3at.urdf", PIONEER)).expect("it is shipped").0
}

#[test]
fn a_simulated_second_with_all_sensors_read_asks_for_no_memory() {
    let (walls, robot) = (room(), robot());
    let mut lidar = robot.lidar.clone().expect("it has one");
    lidar.noise_sd = 0.1;
    let tag = |x: f64| {
        let pose = Pose::new(x, 5.0, 0.0);
        Tag { id: format!("at {x}"), color: "green".into(), pose }
    };
    let tags = [-4.0, -1.0, 2.0, 5.0].map(tag);
    let noise = CompassNoise { heading: 0.1, ..CompassNoise::NONE };
    let scene = Scene {
        visible: &walls,
        solid: &walls,
        lidar,
        camera: robot.camera.clone().map(|camera| CameraScene {
            camera,
            tags: &tags,
            occlusion: Occlusion::Walls,
        }),
        compass: robot.compass.clone().map(|compass| (compass, noise)),
        start: Pose::default(),
        drive_noise: DriveNoise {
            distribution: Distribution::Gaussian,
            linear: 0.1,
            angular: 0.1,
            correlation: reenact::units::Seconds(0.1),
        },
        odometry_noise: OdometryNoise { distance: 0.01, heading: 0.01 },
        robot: &robot,
    };
    let mut sim = Simulator::new(scene, &Seeds::new(1, vec![]));
    let (mut scan, mut seen, mut was_seen) = (sim.blank_scan(), Vec::new(), false);
    let mut second = |sim: &mut Simulator| {
        let end = sim.now() + Tick(3000);
        while sim.now() < end {
            sim.advance_to(sim.next_scan());
            sim.read_scan(&mut scan);
            sim.read_detections(&mut seen);
            was_seen |= !seen.is_empty();
            sim.read_compass();
        }
    };
    sim.command(Twist { linear: 0.3, angular: 0.2 });
    second(&mut sim);
    let used = measure(|| (0..20).for_each(|_| second(&mut sim)));
    assert_eq!(used.count_total, 0, "{used:?}");
    assert!(sim.travelled() > 5.0 && sim.contacts() == 0 && was_seen);
}

/// Drives a trial of the quickstart, and counts what the mind asks for in the control cycles between keyframes and choices, which
/// are most.
#[test]
fn a_mind_asks_for_no_memory_between_keyframes() {
    let plan = shipped::plan("quickstart.yaml");
    let spec = plan.find("floor-plan/0").expect("the manifest has this trial");
    let lidar = driving::lidar(driving::setup(spec));
    let mut sim = driving::simulator(spec, &lidar);
    let mut mind = driving::mind(spec, &lidar);
    let mut scan = sim.blank_scan();
    let (mut quiet, mut asking, mut next_control) = (0, 0, Tick(0));
    let mut took_keyframe = false;
    while mind.ending().is_none() && sim.now() < Tick(120 * 3000) {
        if sim.now() == sim.odometry_at_scan().stamp && mind.wants_scan(sim.odometry_at_scan()) {
            sim.read_scan(&mut scan);
            let odometry = sim.odometry_at_scan();
            let used = measure(|| took_keyframe |= mind.take_scan(odometry, &scan).is_some());
            assert!(
                took_keyframe || quiet < WARM || used.count_total == 0,
                "{used:?} at {:?}",
                sim.now()
            );
        }
        if sim.now() >= next_control {
            next_control = next_control + CONTROL_PERIOD;
            let (choices, odometry) = (mind.choices(), sim.odometry());
            let mut twist = Twist::STOP;
            let used = measure(|| twist = mind.control(odometry));
            if mind.choices() == choices && !took_keyframe {
                quiet += 1;
                asking += u32::from(quiet > WARM && used.count_total > 0);
            }
            if mind.choices() > choices || twist != Twist::STOP {
                // What the keyframe changed was looked at by then.
                took_keyframe &= !sim.now().0.is_multiple_of(2 * CONTROL_PERIOD.0);
            }
            sim.command(twist);
        }
        sim.advance_to(next_control.min(sim.next_scan()));
    }
    // Few: where the robot leaves what the wave has come to, the wave goes on, and its lists may grow.
    assert!(quiet > 500 && asking * 20 < quiet, "{asking} of {quiet} cycles");
}

/// After so many cycles all memory has grown to the size that it needs.
const WARM: u32 = 20;
