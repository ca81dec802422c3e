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
use std::path::{Path, PathBuf};

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
    if args.sample == 0 {
        return Err(Failure::not_understood(
            "`--sample` must be 1 or more, found 0: a level that executes nothing shows nothing; `--level 3` is the highest that \
             needs no execution",
        ));
    }
    let trust = args.trust.as_deref().map(trust).transpose()?;
    let signature = match &args.signature {
        Some(path) => Some((path.display().to_string(), load::text_bytes(path)?)),
        None => None,
    };
    let vouching = Vouching {
        // An attestation asks who checked the bundle, not who made it.
        trust: trust.as_ref().filter(|_| args.attestation.is_none() || signature.is_some()),
        signature: signature.as_ref().map(|(name, bytes)| (name.as_str(), bytes.as_slice())),
        now: clock.now(),
    };
    let attestation = match &args.attestation {
        Some(path) => Some((path.display().to_string(), load::attestation(path)?)),
        None => None,
    };
    let jobs = jobs(args.jobs, terminal)?;
    let progress = Progress::unplanned(terminal);
    let pipeline = Reenactment::new(jobs).map_err(Failure::failed)?.observed_by(&progress);
    let seed = args.sample_seed.unwrap_or_else(unforeseen_seed);
    let options = Options { level, sample: args.sample, rows: args.robustness, seed };
    let reviewer = Reviewer { vouching, clock: &|| clock.elapsed_seconds(), judged: &|_| () };
    let mut report =
        climb_for(&reviewer, load::archive(&args.bundle, args.limits)?, &options, &pipeline);
    progress.finish();
    if let (Some((name, bytes)), Some(trust)) = (&attestation, &trust) {
        report.hold_against((name, bytes), trust, clock.now());
    }
    terminal.result(&match args.format {
        Format::Human => report.to_human(),
        Format::Json => report.to_json(),
        Format::Junit => report.to_junit(),
    });
    if let Some(path) = &args.attest {
        match report.attest(clock.circumstance(environment, 1).ended) {
            Ok(envelope) => {
                let mut to_sign = path.clone().into_os_string();
                to_sign.push(".pae");
                let to_sign = PathBuf::from(to_sign);
                load::write(path, envelope.to_json().as_bytes())?;
                load::write(&to_sign, &envelope.to_sign())?;
                let (path, to_sign) = (path.display(), to_sign.display());
                terminal.note(&format!("wrote {path}, unsigned, and {to_sign}, the bytes to sign"));
            }
            Err(why) => terminal.error(&format!("wrote no `{}`: {why}", path.display())),
        }
    }
    Ok(exit(&report, args.attest.is_some()))
}

/// Reads the keys in `path`.
fn trust(path: &Path) -> Result<Trust, Failure> {
    let source = load::text(path)?;
    Trust::read(&source)
        .map_err(|faults| Failure::not_understood(reports(&faults, false).join("\n")))
}

/// Returns how the command ends: an attestation that was asked for and could not be written is no yes, even where the
/// bundle holds.
fn exit(report: &Report, attest: bool) -> Exit {
    match report.verdict() {
        Verdict::Holds if attest && report.bundle_id.is_none() => Exit::NotUnderstood,
        verdict => verdict.into(),
    }
}
