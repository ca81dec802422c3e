//! Simulated seconds per second of processor time of a whole trial of the office whose mind estimates its pose with 30 particles:
//! simulator, particle filter, map, choosing, driving. 720 beams, all matched, 25 m, cells of 0.1 m as in the manifest.
//!
//! `cargo bench --bench slam_trial -- [trials (3)] [particles (30)]`. Prints one line a trial, then all together.

#![expect(clippy::print_stdout, reason = "a benchmark prints")]

mod processor;
#[expect(dead_code, reason = "other benchmarks take manifests as they are")]
mod shipped;

use reenact::plan::Plan;
use reenact::studies;

/// The real robot's filter (docs/studies/prior-map-slam.md) and odometry that needs one, set as `--set` does.
fn plan(particles: u32) -> Plan {
    let mapping = [
        ("particles", f64::from(particles)),
        ("motion-noise-srr", 0.1),
        ("motion-noise-srt", 0.2),
        ("motion-noise-str", 0.1),
        ("motion-noise-stt", 0.2),
        ("match-linear-step-m", 0.05),
        ("match-angular-step-rad", 0.05),
    ];
    let sensing = [("odometry-noise-distance", 0.01), ("odometry-noise-heading", 0.012)];
    let set =
        |group: &str, (name, value): (&str, f64)| format!("parameters.{group}.{name}={value}");
    let assignments: Vec<String> = mapping
        .map(|value| set("mapping", value))
        .into_iter()
        .chain(sensing.map(|value| set("sensing", value)))
        .collect();
    shipped::plan_with("prior-tables-1-6.yaml", &assignments)
}

fn main() {
    let numbers: Vec<u32> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let trials = numbers.first().copied().unwrap_or(3);
    let particles = numbers.get(1).copied().unwrap_or(30);
    let plan = plan(particles);
    println!("trial  outcome      simulated s  processor s  simulated s per s");
    let (mut simulated, mut spent) = (0.0, 0.0);
    for trial in 0..trials {
        let name = format!("described_office_false_none/{trial}");
        let spec = plan.find(&name).expect("the manifest has this trial");
        let begun = processor::seconds();
        let record = studies::execute(spec);
        let took = processor::seconds() - begun;
        println!(
            "{trial:5}  {:12} {:11.1} {took:12.2} {:18.1}",
            record.outcome.name(),
            record.sim_seconds,
            record.sim_seconds / took
        );
        simulated += record.sim_seconds;
        spent += took;
    }
    println!("all {:30.1} {spent:12.2} {:18.1}", simulated, simulated / spent);
}
