//! `reenact run --locked --probe`: trial 0 of every condition anew, held against the lock.

use super::execution::{Execution, Times};
use super::locked::Held;
use crate::bundle::{Circumstance, Moment, assemble, seal};
use crate::cli::args::{Format, RunArgs, SelectArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::junit::{Came, Case, RUN, Suite};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::compare::{Discrepancy, Extent, Lock};
use crate::provenance::{Environment, RunClock};
use crate::studies::{Outcome, TrialRecord};
use serde_json::json;
use std::path::Path;

/// Probes one manifest. The store is not read, since a probe that finds old records proves nothing, and not written.
pub(super) fn run(
    manifest: &Path,
    lock: &Lock,
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<(Exit, Suite), Failure> {
    let clock = RunClock::start();
    // What a calibration showed may come from the store: the trials that are probed never do.
    let execution = Execution::new(args.jobs, args.no_cache, environment)?;
    let loaded = load::manifest(manifest, args.select.given(), execution.calibrator(), terminal)?;
    let first = SelectArgs {
        only: args.select.only.clone(),
        trials: Some(1),
        shard: None,
        set: args.select.set.clone(),
        allow: args.select.allow.clone(),
    };
    let (plan, selection) = load::plan(loaded.experiment, &first)?;
    let how = if args.twice { Times::Twice } else { Times::Anew };
    let records = execution.execute(&plan, how, terminal)?;
    let content = assemble::assemble(&plan, loaded.source.text.as_bytes(), &selection, &records)
        .map_err(Failure::failed)?;
    // Sealed to be read like any other, and thrown away.
    let sealed = seal(&content, &Circumstance::reproducible(Moment(0))).map_err(Failure::failed)?;
    let held = Held::against(lock, manifest, &sealed, Extent::FirstTrials)?;
    let probed: Vec<Probed<'_>> = records.iter().map(|record| Probed::of(record, &held)).collect();
    match args.format {
        Format::Human => terminal.result(&in_words(&probed, &held)),
        Format::Junit => {}
        Format::Json => terminal.result(
            &json!({
                "manifest": manifest.display().to_string(),
                "lock": held.lock(),
                "probe": true,
                "conditions": probed
                    .iter()
                    .map(|p| json!({"condition": p.record.condition.slug(), "same": p.same}))
                    .collect::<Vec<_>>(),
                "drift": held.drift(),
                "wall_seconds": clock.elapsed_seconds(),
            })
            .to_string(),
        ),
    }
    let drifted = held.told(terminal);
    let exit = if records.iter().any(|record| record.outcome == Outcome::PANICKED) {
        Exit::Failed
    } else if drifted {
        Exit::No
    } else {
        Exit::Yes
    };
    let suite = Suite {
        name: manifest.display().to_string(),
        seconds: clock.elapsed_seconds(),
        properties: Vec::new(),
        cases: probed.iter().map(Probed::case).chain([held.case()]).collect(),
    };
    Ok((exit, suite))
}

/// The first trial of a condition, and whether it is as the lock has it.
struct Probed<'a> {
    record: &'a TrialRecord,
    same: bool,
}

impl<'a> Probed<'a> {
    fn of(record: &'a TrialRecord, held: &Held) -> Self {
        let slug = record.condition.slug();
        let concerns = |d: &Discrepancy| match d {
            Discrepancy::Trial(trial) => trial.condition == slug,
            Discrepancy::Condition { condition, .. } => *condition == slug,
            _ => false,
        };
        Self { record, same: !held.comparison.discrepancies.iter().any(concerns) }
    }
}

impl Probed<'_> {
    /// Returns what is to be said of it to CI.
    fn case(&self) -> Case {
        let name = format!("trial {}/{}", self.record.condition.slug(), self.record.trial);
        let came = match (self.record.outcome == Outcome::PANICKED, self.same) {
            (true, _) => Came::Broken(self.record.cause.clone()),
            (false, true) => Came::Passed,
            (false, false) => Came::Failed("it differs from the lock".to_owned()),
        };
        Case { name, class: RUN, came, said: String::new() }
    }
}

/// Writes one line a condition, and the drift in full.
fn in_words(probed: &[Probed<'_>], held: &Held) -> String {
    let name = |p: &Probed<'_>| format!("{}/{}", p.record.condition.slug(), p.record.trial);
    let width = probed.iter().map(|p| name(p).chars().count()).max().unwrap_or_default();
    let mut text = String::new();
    for p in probed {
        text.push_str(&format!(
            "{}  {:width$}  {} after {} s\n",
            if p.same { "same " } else { "DRIFT" },
            name(p),
            p.record.outcome.name(),
            p.record.sim_seconds,
        ));
    }
    text + &held.in_words()
}
