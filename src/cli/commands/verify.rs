//! `reenact verify`: climb the ladder and say which rung holds.

use crate::cli::args::{Format, VerifyArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::provenance::{processors, unforeseen_seed};
use crate::verify::{Level, Options, Reenactment, Verdict, climb};

/// Verifies one bundle.
pub(in crate::cli) fn run(args: &VerifyArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let level = Level::from_number(args.level).ok_or_else(|| {
        Failure::not_understood(format!("`--level` goes from 0 to 5, found {}", args.level))
    })?;
    let jobs = args.jobs.unwrap_or_else(processors);
    let pipeline = Reenactment::new(jobs).map_err(Failure::failed)?;
    let seed = args.sample_seed.unwrap_or_else(unforeseen_seed);
    let options = Options { level, sample: args.sample, seed };
    let report = climb(load::archive(&args.bundle)?, &options, &pipeline);
    terminal.result(&match args.format {
        Format::Human => report.to_human(),
        Format::Json => report.to_json(),
        Format::Junit => report.to_junit(),
    });
    Ok(match report.verdict() {
        Verdict::Holds => Exit::Yes,
        Verdict::Broken => Exit::No,
        Verdict::Unanswered => Exit::NotUnderstood,
    })
}
