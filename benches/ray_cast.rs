//! Rays per second (items) of the wall sweep against trying every wall for every beam, in the quickstart's world.
//! Both must tell the same ranges.
//!
//! `cargo bench --bench ray_cast`

mod shipped;

use reenact::geometry::{Outline, Point, Pose};
use reenact::robot::Lidar;
use reenact::sim::WallSweep;

struct Case {
    visible: Vec<Outline>,
    lidar: Lidar,
    sensor: Pose,
}

fn case() -> Case {
    let plan = shipped::plan("quickstart.yaml");
    let setup = &plan.trials[0].setup;
    let lidar = setup.robot().lidar.clone().expect("the robot has a lidar");
    let visible = setup.world().slice(lidar.height);
    Case { visible, sensor: setup.start().compose(lidar.mount), lidar }
}

/// Every side of every outline for every beam. The walls of this world are polygons.
fn brute_force(case: &Case, sensor: Pose, ranges: &mut Vec<f64>) {
    ranges.clear();
    for beam in 0..case.lidar.beams {
        let angle =
            sensor.heading + case.lidar.min_angle + case.lidar.increment() * f64::from(beam);
        let direction = Point::new(reenact::math::cos(angle), reenact::math::sin(angle));
        let nearest = case
            .visible
            .iter()
            .flat_map(Outline::sides)
            .filter_map(|side| side.ray_range(sensor.position(), direction))
            .fold(f64::INFINITY, f64::min);
        ranges.push(if nearest > case.lidar.max_range { f64::INFINITY } else { nearest });
    }
}

fn main() {
    let case = case();
    let sweep = WallSweep::new(&case.visible, &case.lidar);
    let (mut swept, mut tried) = (Vec::new(), Vec::new());
    for turn in 0..64 {
        let turned = Pose::new(case.sensor.x, case.sensor.y, 0.1 * f64::from(turn));
        sweep.cast(turned, &mut swept);
        brute_force(&case, turned, &mut tried);
        for (beam, (a, b)) in swept.iter().zip(&tried).enumerate() {
            assert!(
                a == b || (a - b).abs() < 1e-9,
                "turn {turn}, beam {beam}: {a} m, expected {b} m"
            );
        }
    }
    divan::main();
}

#[divan::bench]
fn wall_sweep(bencher: divan::Bencher<'_, '_>) {
    let case = case();
    let sweep = WallSweep::new(&case.visible, &case.lidar);
    let mut ranges = Vec::new();
    bencher
        .counter(divan::counter::ItemsCount::new(case.lidar.beams))
        .bench_local(|| sweep.cast(divan::black_box(case.sensor), &mut ranges));
}

#[divan::bench]
fn every_wall_for_every_beam(bencher: divan::Bencher<'_, '_>) {
    let case = case();
    let mut ranges = Vec::new();
    bencher
        .counter(divan::counter::ItemsCount::new(case.lidar.beams))
        .bench_local(|| brute_force(&case, divan::black_box(case.sensor), &mut ranges));
}
