//! The simulator without a mind in the unfurnished office: the way of a robot that explores it for 1000 simulated seconds, driven again
//! by the same commands, every scan read. Simulated seconds and rays per second of processor time, beside Stage's figure
//! (README.md says where that is from).
//!
//! `cargo bench --bench sim_office`

#![expect(clippy::print_stdout, reason = "a benchmark prints")]

#[expect(dead_code, reason = "each benchmark looks at what it is about")]
mod driving;
mod processor;
mod shipped;

use driving::Drive;
use reenact::robot::{Lidar, Twist};
use reenact::studies::TrialSpec;
use reenact::studies::prior_map::explorer::CONTROL_PERIOD;
use reenact::units::Tick;
use std::hint::black_box;

const END: Tick = Tick(1000 * 3000);

/// A lidar as a row of the table has it.
struct Row {
    beams: u32,
    rate_hz: f64,
    noise_sd: f64,
    /// The most simulated seconds per second that Stage reached with these rays, exact ones.
    stage: f64,
}

const ROWS: [Row; 4] = [
    Row { beams: 720, rate_hz: 20.0, noise_sd: 0.0, stage: 351.0 },
    Row { beams: 720, rate_hz: 20.0, noise_sd: 0.1, stage: 351.0 },
    Row { beams: 180, rate_hz: 10.0, noise_sd: 0.0, stage: 1054.0 },
    Row { beams: 180, rate_hz: 10.0, noise_sd: 0.1, stage: 1054.0 },
];

fn main() {
    let plan = shipped::plan("prior-tables-1-6.yaml");
    let spec = plan.find("described_office_false_none/0").expect("the manifest has this trial");
    let own = driving::lidar(driving::setup(spec));
    let commands = explore(spec);
    println!("rays  per second  noise m  simulated s/s  million rays/s  Stage 2026-11-28  times");
    for Row { beams, rate_hz, noise_sd, stage } in ROWS {
        let lidar = Lidar { beams, rate_hz, noise_sd, ..own.clone() };
        let begun = processor::seconds();
        let scans = drive(spec, &lidar, &commands);
        let took = processor::seconds() - begun;
        let simulated = END.seconds().get() / took;
        let rays = f64::from(beams) * f64::from(scans) / took / 1e6;
        println!(
            "{beams:4}  {rate_hz:10}  {noise_sd:7}  {simulated:13.0}  {rays:14.1}  {stage:16.0}  {:5.1}",
            simulated / stage
        );
    }
}

/// Returns the commands of a mind that explores, one each control cycle; it stands when it is done.
fn explore(spec: &TrialSpec) -> Vec<Twist> {
    let mut drive = Drive::new(spec);
    let mut commands = Vec::new();
    while drive.sim.now() < END {
        commands.extend(drive.step().twist);
    }
    let travelled = drive.sim.travelled();
    assert!(travelled > 300.0, "{travelled} m are too few to mean anything");
    commands
}

/// Drives by `commands`, reads every scan, and returns how many there were.
fn drive(spec: &TrialSpec, lidar: &Lidar, commands: &[Twist]) -> u32 {
    let mut sim = driving::simulator(spec, lidar);
    let mut scan = sim.blank_scan();
    let (mut scans, mut next_control) = (0, Tick(0));
    let mut commands = commands.iter();
    while sim.now() < END {
        if sim.now() == sim.odometry_at_scan().stamp {
            sim.read_scan(black_box(&mut scan));
            scans += 1;
        }
        if sim.now() >= next_control {
            next_control = next_control + CONTROL_PERIOD;
            sim.command(commands.next().copied().unwrap_or(Twist::STOP));
        }
        sim.advance_to(next_control.min(sim.next_scan()));
    }
    scans
}
