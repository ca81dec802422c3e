//! Simulated seconds per second (items) of the quickstart's world without a mind: the robot drives in a circle,
//! and its 720 beams at 20 Hz are read or left.
//!
//! `cargo bench --bench sim_step`

mod shipped;

use reenact::rng::Seeds;
use reenact::robot::Twist;
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use reenact::units::{Seconds, Tick};

const SIMULATED: u32 = 20;

fn main() {
    divan::main();
}

#[divan::bench(args = [true, false], sample_count = 20, sample_size = 1)]
fn circle(bencher: divan::Bencher<'_, '_>, reads_scans: bool) {
    let plan = shipped::plan("quickstart.yaml");
    let setup = &plan.trials[0].setup;
    let robot = setup.robot();
    let lidar = robot.lidar.clone().expect("the robot has a lidar");
    let visible = setup.world().slice(lidar.height);
    let solid = setup.world().contact(robot.body_z[0], robot.body_z[1]);
    let end = Tick::at_or_after(Seconds(f64::from(SIMULATED)));
    bencher.counter(divan::counter::ItemsCount::new(SIMULATED)).bench_local(|| {
        let scene = Scene {
            visible: &visible,
            solid: &solid,
            robot,
            lidar: lidar.clone(),
            camera: None,
            compass: None,
            start: setup.start(),
            drive_noise: DriveNoise::NONE,
            odometry_noise: OdometryNoise { distance: 0.0, heading: 0.0 },
        };
        let mut sim = Simulator::new(scene, &Seeds::new(1, vec![]));
        let mut scan = sim.blank_scan();
        sim.command(Twist { linear: 0.3, angular: 0.5 });
        while sim.now() < end {
            sim.advance_to(sim.next_scan());
            if reads_scans {
                sim.read_scan(&mut scan);
            }
        }
        assert!(sim.travelled() > 5.0, "nothing stands in the way");
        sim.true_pose()
    });
}
