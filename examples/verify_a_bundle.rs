//! Verifies a bundle as far as its files go, and says what was found.
//!
//! `cargo run --release --example verify_a_bundle [BUNDLE]`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use reenact::bundle::Limits;
use reenact::store;
use reenact::verify::{Level, Options, Reenactment, Verdict, climb};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let published = "artifacts/quickstart-published.zip";
    let bundle = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(published), PathBuf::from);
    // Derived: everything that is not a record or an input is made again from those that are.
    let options = Options { level: Level::Derived, sample: 59, rows: None, seed: 1 };
    let opened = store::open_bundle(&bundle, &Limits::default())?;
    let report = climb(opened, &options, &Reenactment::new(2)?);
    print!("{}", report.to_human());
    let holds = report.verdict() == Verdict::Holds;
    if holds { Ok(()) } else { Err(format!("{} does not hold", bundle.display()).into()) }
}
