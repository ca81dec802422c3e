//! Drives the simulator with a controller of one's own: ahead while the way is free, left where it is not.
//!
//! `cargo run --release --example own_controller`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use reenact::document::{Source, reports};
use reenact::geometry::Pose;
use reenact::rng::Seeds;
use reenact::robot::{Scan, Twist, urdf};
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use reenact::units::{Seconds, Tick};
use reenact::world;
use std::error::Error;
use std::path::Path;

/// What a mind sees is a scan; what it says is a twist (m/s, rad/s).
fn steer(scan: &Scan) -> Twist {
    let ahead = |i: usize| scan.angle(i).abs() < 0.6;
    let nearest = (0..scan.ranges.len()).filter(|&i| ahead(i)).map(|i| scan.ranges[i]);
    if nearest.fold(f64::INFINITY, f64::min) > 0.8 {
        Twist { linear: 0.4, angular: 0.0 }
    } else {
        Twist { linear: 0.0, angular: 0.7 }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read =
        |path: &str| std::fs::read_to_string(root.join(path)).map(|text| Source::new(path, text));
    let told = |faults: Vec<_>| reports(&faults, false).join("\n");
    let (robot, _) = urdf::read(&read("robots/kobuki.urdf")?).map_err(told)?;
    let world = world::document::read(&read("worlds/basic.yaml")?, None).map_err(told)?;
    let lidar = robot.lidar.clone().ok_or("the robot has no lidar")?;

    let scene = Scene {
        visible: &world.slice(lidar.height),
        solid: &world.contact(robot.body_z[0], robot.body_z[1]),
        robot: &robot,
        lidar: lidar.clone(),
        camera: None,
        compass: None,
        start: Pose::new(3.0, 2.0, 0.0),
        drive_noise: DriveNoise::NONE,
        odometry_noise: OdometryNoise { distance: 0.0, heading: 0.0 },
    };
    // All randomness comes from named streams of these seeds: the same again, whoever runs it.
    let mut sim = Simulator::new(scene, &Seeds::new(1, vec![]));
    let mut scan = sim.blank_scan();
    while sim.now() < Tick::at_or_after(Seconds(60.0)) {
        sim.advance_to(sim.next_scan());
        sim.read_scan(&mut scan);
        sim.command(steer(&scan));
    }
    println!("{:.2} m in a minute, {} contacts", sim.travelled(), sim.contacts());
    Ok(())
}
