//! Simulated seconds per second (items, on one core) of whole trials of the quickstart: simulator, mapping, choosing, driving.
//!
//! `cargo bench --bench trial_prior_map`

mod shipped;

use reenact::studies;

fn main() {
    divan::main();
}

#[divan::bench(args = ["none/0", "floor-plan/0"], sample_count = 5, sample_size = 1)]
fn trial(bencher: divan::Bencher<'_, '_>, name: &str) {
    let plan = shipped::plan("quickstart.yaml");
    let spec = plan.find(name).expect("the quickstart has this trial");
    // Once beforehand: what all trials of a setup share is computed by the first.
    let record = studies::execute(spec);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole seconds below the time limit"
    )]
    let simulated = record.sim_seconds as u32;
    bencher
        .counter(divan::counter::ItemsCount::new(simulated))
        .bench_local(|| studies::execute(divan::black_box(spec)));
}
