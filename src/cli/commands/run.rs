//! `reenact run`: plan, simulate, seal.

use super::tables;
use crate::bundle::{Form, Sealed, assemble, seal};
use crate::cli::args::{Format, RunArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::progress::Progress;
use crate::cli::terminal::{Terminal, counted};
use crate::plan::Plan;
use crate::provenance::{Environment, RunClock, processors};
use crate::runner::{Observer, RunError, RunEvent, Scheduler, TrialStore};
use crate::store::DirectoryStore;
use crate::studies::{self, Outcome, TrialRecord};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs every manifest in turn.
pub(in crate::cli) fn run(
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    if args.jobs == Some(0) {
        return Err(Failure::not_understood("`--jobs` must be at least 1, found 0"));
    }
    let mut exit = Exit::Yes;
    for manifest in &args.manifests {
        if run_one(manifest, args, environment, terminal)? == Exit::Failed {
            exit = Exit::Failed;
        }
    }
    Ok(exit)
}

fn run_one(
    manifest: &Path,
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let clock = RunClock::start();
    let loaded = load::manifest(manifest, &args.select.set, terminal)?;
    let (plan, selection) = load::plan(loaded.experiment, &args.select)?;
    let scheduler =
        Scheduler::new(args.jobs.unwrap_or_else(processors)).map_err(Failure::failed)?;
    let (records, cached) = execute(&plan, &scheduler, args, environment, terminal)?;
    let content = assemble::assemble(&plan, loaded.source.text.as_bytes(), &selection, &records)
        .map_err(Failure::failed)?;
    let sealed = seal(&content, &clock.circumstance(environment, scheduler.jobs()))
        .map_err(Failure::failed)?;
    let path = args.out.join(sealed.file_name());
    load::write(&path, &sealed.zip(Form::Bag))?;
    let done = Done { plan, records, cached, sealed, path, wall_seconds: clock.elapsed_seconds() };
    match args.format {
        Format::Human => done.tell(terminal),
        Format::Json | Format::Junit => terminal.result(&done.to_json()?),
    }
    Ok(if done.failed() > 0 { Exit::Failed } else { Exit::Yes })
}

fn execute(
    plan: &Plan,
    scheduler: &Scheduler,
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<(Vec<TrialRecord>, usize), Failure> {
    let kept = if args.no_cache {
        None
    } else {
        Some(DirectoryStore::new(environment.store().map_err(Failure::not_understood)?))
    };
    let progress = Progress::new(terminal);
    let cached = AtomicUsize::new(0);
    let observer = |event: &RunEvent<'_>| {
        if let RunEvent::Started { cached: known, .. } = event {
            cached.store(*known, Ordering::Relaxed);
        }
        progress.notice(event);
    };
    let records = scheduler.run(
        &plan.trials,
        &studies::execute,
        kept.as_ref().map(|store| store as &dyn TrialStore),
        &observer,
    );
    progress.finish();
    let records = records.map_err(|e: RunError| Failure::failed(e))?;
    Ok((records, cached.into_inner()))
}

/// A finished run.
struct Done {
    plan: Plan,
    records: Vec<TrialRecord>,
    cached: usize,
    sealed: Sealed,
    path: PathBuf,
    wall_seconds: f64,
}

impl Done {
    fn failed(&self) -> usize {
        self.records.iter().filter(|r| r.outcome == Outcome::Panicked).count()
    }

    fn sim_seconds(&self) -> f64 {
        self.records.iter().map(|r| r.sim_seconds).sum()
    }

    fn verdicts(&self) -> Result<Map<String, Value>, Failure> {
        let verdicts = assemble::verdicts(&self.plan, &self.records).map_err(Failure::failed)?;
        let id_and_verdict = |v: &Value| Some((v["id"].as_str()?.to_owned(), v["verdict"].clone()));
        Ok(verdicts.iter().filter_map(id_and_verdict).collect())
    }

    fn tell(&self, terminal: Terminal) {
        let mut text = format!("{}\n", self.plan.experiment.title);
        if self.plan.partial {
            text.push_str("PARTIAL: part of the study only; no claim is judged\n");
        }
        text.push('\n');
        let factors = assemble::factors(&self.plan);
        let findings = assemble::findings(&self.plan, &self.records, &factors);
        for request in &self.plan.experiment.tables {
            text.push_str(&tables::coverage_table(&findings, request));
            text.push('\n');
        }
        text.push_str(&self.summary());
        for record in self.records.iter().filter(|r| r.outcome == Outcome::Panicked) {
            let name = format!("{}/{}", record.condition().slug(), record.trial);
            terminal.error(&format!("trial {name} failed: {}", record.cause));
        }
        text.push_str(&format!(
            "results sha256:{}\n{}\n",
            self.sealed.results_digest,
            self.path.display()
        ));
        terminal.result(&text);
    }

    fn summary(&self) -> String {
        let mut outcomes: Vec<(Outcome, usize)> = Vec::new();
        for record in &self.records {
            match outcomes.iter_mut().find(|(o, _)| *o == record.outcome) {
                Some((_, n)) => *n += 1,
                None => outcomes.push((record.outcome, 1)),
            }
        }
        outcomes.sort_unstable();
        let outcomes: Vec<_> = outcomes.iter().map(|(o, n)| format!("{n} {}", o.name())).collect();
        let fresh = self.records.len() - self.cached;
        let mut text = format!(
            "{}: {}; {} simulated in {:.1} s",
            counted(self.records.len(), "trial"),
            outcomes.join(", "),
            if fresh == self.records.len() { "all".to_owned() } else { format!("{fresh}") },
            self.wall_seconds
        );
        if self.cached > 0 {
            text.push_str(&format!(" ({} from the store)", self.cached));
        }
        text.push_str(&format!(", {:.0} s of simulated time\n", self.sim_seconds()));
        text
    }

    fn to_json(&self) -> Result<String, Failure> {
        let path = std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
        Ok(json!({
            "bundle": path,
            "bundle_id": format!("sha256:{}", self.sealed.bundle_id),
            "results_digest": format!("sha256:{}", self.sealed.results_digest),
            "study_digest": format!("sha256:{}", self.sealed.study_digest),
            "trials": self.records.len(),
            "cached": self.cached,
            "failed": self.failed(),
            "sim_seconds": self.sim_seconds(),
            "wall_seconds": self.wall_seconds,
            "partial": self.plan.partial,
            "claims": self.verdicts()?,
        })
        .to_string())
    }
}
