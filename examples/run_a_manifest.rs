//! Runs the first trials of a manifest and reads their records: no bundle, no store.
//!
//! `cargo run --release --example run_a_manifest`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use reenact::document::{Source, reports};
use reenact::manifest::{self, InputError, Inputs, WrittenIn};
use reenact::plan::{Plan, Selection};
use reenact::runner::{Scheduler, Silent};
use reenact::studies;
use std::error::Error;
use std::path::Path;

/// Files by their path from the manifest's folder.
struct Beside<'a>(&'a Path);

impl Inputs for Beside<'_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        std::fs::read(self.0.join(as_written)).map_err(InputError::other)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manifests");
    let name = "quickstart.yaml";
    let manifest = Source::new(name, std::fs::read_to_string(folder.join(name))?);
    let (experiment, _) = manifest::resolve(&manifest, &[], &Beside(&folder))
        .map_err(|faults| reports(&faults, false).join("\n"))?;

    let first_of_each = Selection::parse(&[], Some(1), None)?;
    let plan = Plan::select(experiment, &first_of_each)?;
    let scheduler = Scheduler::new(2)?;
    let records = scheduler.run(&plan.trials, &studies::execute, None, &Silent)?;
    for record in &records {
        let distance = record.measures.get("distance-m").copied().flatten().unwrap_or(f64::NAN);
        println!(
            "{:<20} {:>9} after {:>6.1} s and {distance:>6.1} m",
            record.condition.to_string(),
            record.outcome.name(),
            record.sim_seconds
        );
    }
    Ok(())
}
