//! How long one selection of a frontier takes in whole trials of the office of `prior-tables-1-6.yaml`: find frontiers, judge
//! them, rank them, on every map on which the robot's mind chose. Prints median and 95th percentile.
//!
//! `cargo bench --bench office_selection`. `frontier_selection` measures one harder state again and again.

mod shipped;

use reenact::navigation::inflate;
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator, Stepping};
use reenact::stats::summary::{median, quantile};
use reenact::studies::prior_map::choice::{Chooser, Sight};
use reenact::studies::prior_map::explorer::{CONTROL_PERIOD, Explorer};
use reenact::studies::prior_map::information_gain::AlignedPrior;
use reenact::studies::prior_map::utility::ranked;
use reenact::studies::{TrialSpec, prior_map};
use reenact::units::Tick;
use std::hint::black_box;
use std::time::Instant;

#[expect(clippy::print_stdout, reason = "what was measured")]
fn main() {
    let plan = shipped::plan("prior-tables-1-6.yaml");
    println!("selection in the office      choices  frontiers  median ms    p95 ms  longest ms");
    for furnished in ["false", "true"] {
        for prior in ["none", "floor-plan", "footprint", "bounding-box"] {
            let name = format!("office_{furnished}_{prior}/0");
            let spec = plan.find(&name).expect("the manifest has this trial");
            let (times, frontiers) = selections(spec);
            let longest = times.iter().copied().fold(0.0, f64::max);
            println!(
                "{name:28} {:7} {:10.0} {:10.2} {:9.2} {longest:11.2}",
                times.len(),
                median(&frontiers),
                median(&times),
                quantile(&times, 0.95)
            );
        }
    }
}

/// Milliseconds and frontiers of every selection of a trial.
#[expect(clippy::disallowed_methods, reason = "the time is what is measured")]
fn selections(spec: &TrialSpec) -> (Vec<f64>, Vec<f64>) {
    let Some(setup) = spec.setup.of::<prior_map::Setup>() else {
        panic!("a study of another kind")
    };
    let own = setup.robot.lidar.clone().expect("it has a scanner");
    let sensing = &setup.parameters.sensing;
    let mut lidar = own;
    lidar.max_range = sensing.range_m.unwrap_or(lidar.max_range);
    lidar.noise_sd = sensing.range_noise_sd_m.unwrap_or(lidar.noise_sd);
    let visible = setup.world.slice(lidar.height);
    let solid = setup.world.contact(setup.robot.body_z[0], setup.robot.body_z[1]);
    let resolution = setup.parameters.mapping.resolution_m;
    let prior = setup.prior.as_ref().map(|prior| AlignedPrior::new(prior, setup.start, resolution));
    let mut sim = Simulator::new(
        Scene {
            visible: &visible,
            solid: &solid,
            robot: &setup.robot,
            lidar: lidar.clone(),
            camera: None,
            compass: None,
            start: setup.start,
            stepping: Stepping::Near,
            drive_noise: DriveNoise::NONE,
            odometry_noise: OdometryNoise::NONE,
        },
        &spec.seeds,
    );
    let [delays, particles] = ["decision-delay", "slam"].map(|name| spec.seeds.stream(name));
    let mut mind = Explorer::new(&setup.parameters, &lidar, prior.clone(), delays, particles);
    let mut chooser = Chooser::new(&setup.parameters, &lidar, prior);
    let mut scan = sim.blank_scan();
    let (mut times, mut frontiers) = (Vec::new(), Vec::new());
    let mut next_control = Tick(0);
    while mind.ending().is_none() && sim.now().seconds().get() < 900.0 {
        if sim.now() == sim.odometry_at_scan().stamp && mind.wants_scan(sim.odometry_at_scan()) {
            sim.read_scan(&mut scan);
            mind.take_scan(sim.odometry_at_scan(), &scan);
        }
        if sim.now() >= next_control {
            next_control = next_control + CONTROL_PERIOD;
            let choices = mind.choices();
            let twist = mind.control(sim.odometry());
            if mind.choices() > choices {
                let radius = setup.parameters.navigation.inflation_radius_cells;
                let costs = inflate(mind.map().grid(), radius);
                let sight = Sight { map: mind.map(), costs: &costs, pose: sim.odometry().pose };
                let begun = Instant::now();
                let choice = chooser.appraise(sight, chooser.frontiers(sight));
                black_box(ranked(&choice.utilities));
                times.push(begun.elapsed().as_secs_f64() * 1000.0);
                #[expect(clippy::cast_precision_loss, reason = "few")]
                frontiers.push(choice.frontiers.len() as f64);
            }
            sim.command(twist);
        }
        sim.advance_to(next_control.min(sim.next_scan()));
    }
    (times, frontiers)
}
