//! How long one selection of a frontier takes in whole trials of the office of `prior-tables-1-6.yaml`: find frontiers, judge
//! them, rank them, on every map on which the robot's mind chose. Prints median and 95th percentile.
//!
//! `cargo bench --bench office_selection`. `frontier_selection` measures one harder state again and again.

#[expect(dead_code, reason = "each benchmark looks at what it is about")]
mod driving;
mod shipped;

use driving::Drive;
use reenact::navigation::inflate;
use reenact::stats::summary::{median, quantile};
use reenact::studies::TrialSpec;
use reenact::studies::prior_map::choice::{Chooser, Sight};
use reenact::studies::prior_map::utility::ranked;
use std::hint::black_box;
use std::time::Instant;

#[expect(clippy::print_stdout, reason = "what was measured")]
fn main() {
    let plan = shipped::plan("prior-tables-1-6.yaml");
    println!(
        "selection in the office                choices  frontiers  median ms    p95 ms  longest ms"
    );
    let setups = ["false", "true"].into_iter().flat_map(|furnished| {
        ["none", "floor-plan", "footprint", "bounding-box"].map(|prior| (furnished, prior))
    });
    for (reading, (furnished, prior)) in ["described", "released"]
        .iter()
        .flat_map(|reading| setups.clone().map(move |s| (reading, s)))
    {
        let name = format!("{reading}_office_{furnished}_{prior}/0");
        let spec = plan.find(&name).expect("the manifest has this trial");
        let (times, frontiers) = selections(spec);
        let longest = times.iter().copied().fold(0.0, f64::max);
        println!(
            "{name:38} {:7} {:10.0} {:10.2} {:9.2} {longest:11.2}",
            times.len(),
            median(&frontiers),
            median(&times),
            quantile(&times, 0.95)
        );
    }
}

/// Milliseconds and frontiers of every selection of a trial.
#[expect(clippy::disallowed_methods, reason = "the time is what is measured")]
fn selections(spec: &TrialSpec) -> (Vec<f64>, Vec<f64>) {
    let mut drive = Drive::new(spec);
    let parameters = &drive.setup.parameters;
    let mut chooser = Chooser::new(parameters, &drive.lidar, driving::prior(drive.setup));
    let (mut times, mut frontiers) = (Vec::new(), Vec::new());
    while drive.mind.ending().is_none() && drive.sim.now().seconds().get() < 900.0 {
        if !drive.step().chose {
            continue;
        }
        let map = drive.mind.map();
        let costs = inflate(map.grid(), parameters.navigation.inflation_radius_cells);
        let sight = Sight { map, costs: &costs, pose: drive.sim.odometry().pose };
        let begun = Instant::now();
        let found = chooser.frontiers(sight);
        let choice = chooser.appraise(sight, found);
        black_box(ranked(&choice.utilities));
        times.push(begun.elapsed().as_secs_f64() * 1000.0);
        #[expect(clippy::cast_precision_loss, reason = "few")]
        frontiers.push(choice.frontiers.len() as f64);
    }
    (times, frontiers)
}
