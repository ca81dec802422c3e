//! `reenact verify`: climb the ladder and say which rung holds.

use super::execution::jobs;
use crate::cli::args::{Format, VerifyArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::progress::Progress;
use crate::cli::terminal::Terminal;
use crate::document::reports;
use crate::provenance::{Environment, RunClock, unforeseen_seed};
use crate::verify::{
    Level, Options, Reenactment, Report, Reviewer, Trust, Verdict, Vouching, climb_for,
};
use std::path::Path;

/// Verifies one bundle.
pub(in crate::cli) fn run(
    args: &VerifyArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let clock = RunClock::start();
    let level = Level::from_number(args.level).ok_or_else(|| {
        Failure::not_understood(format!("`--level` goes from 0 to 6, found {}", args.level))
    })?;
    if args.trust.is_some() && level < Level::Fixity {
        return Err(Failure::not_understood(
            "`--trust` needs `--level 1` or more: a signature vouches for digests, and level 0 compares none",
        ));
    }
    let trust = args.trust.as_deref().map(trust).transpose()?;
    let signature = match &args.signature {
        Some(path) => Some((path.display().to_string(), load::text_bytes(path)?)),
        None => None,
    };
    let vouching = Vouching {
        trust: trust.as_ref(),
        signature: signature.as_ref().map(|(name, bytes)| (name.as_str(), bytes.as_slice())),
        now: clock.now(),
    };
    let jobs = jobs(args.jobs, terminal)?;
    let progress = Progress::unplanned(terminal);
    let pipeline = Reenactment::new(jobs).map_err(Failure::failed)?.observed_by(&progress);
    let seed = args.sample_seed.unwrap_or_else(unforeseen_seed);
    let options = Options { level, sample: args.sample, rows: args.robustness, seed };
    let reviewer = Reviewer { vouching, clock: &|| clock.elapsed_seconds() };
    let report = climb_for(&reviewer, load::archive(&args.bundle)?, &options, &pipeline);
    progress.finish();
    terminal.result(&match args.format {
        Format::Human => report.to_human(),
        Format::Json => report.to_json(),
        Format::Junit => report.to_junit(),
    });
    if let Some(path) = &args.attest {
        match report.attestation(clock.circumstance(environment, 1).ended) {
            Ok(record) => {
                load::write(path, record.as_bytes())?;
                terminal.note(&format!("wrote {}", path.display()));
            }
            Err(why) => terminal.error(&format!("wrote no `{}`: {why}", path.display())),
        }
    }
    Ok(exit(&report, args.attest.is_some()))
}

/// The keys in `path`.
fn trust(path: &Path) -> Result<Trust, Failure> {
    let source = load::text(path)?;
    Trust::read(&source)
        .map_err(|faults| Failure::not_understood(reports(&faults, false).join("\n")))
}

/// An attestation that was asked for and could not be written is no yes, even where the bundle holds.
fn exit(report: &Report, attest: bool) -> Exit {
    match report.verdict() {
        Verdict::Holds if attest && report.bundle_id.is_none() => Exit::NotUnderstood,
        Verdict::Holds => Exit::Yes,
        Verdict::Broken | Verdict::NotReplicated => Exit::No,
        Verdict::Unanswered => Exit::NotUnderstood,
    }
}
