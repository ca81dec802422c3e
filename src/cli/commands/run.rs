//! `reenact run`: plan, simulate, seal.

use super::execution::{Account, Execution, Times, jobs};
use super::kept::Kept;
use super::locked::{self, Held};
use super::probe;
use super::screen::Screen;
use crate::bundle::assemble::{self, Asked};
use crate::bundle::wall_time;
use crate::bundle::{
    Additions, Form, Gathered, Gathering, Sealed, capsule, format, seal_with, shell_word,
};
use crate::claims::{ClaimVerdict, Judgement, compared};
use crate::cli::args::{Format, RunArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::fold::wrapped;
use crate::cli::junit::{self, Came, Case, RUN, Suite};
use crate::cli::terminal::{Terminal, counted};
use crate::cli::{interrupt, load};
use crate::compare::Lock;
use crate::plan::Plan;
use crate::provenance::{Environment, RunClock};
use crate::studies::{Entry, Exhibit, Group, Ledger, Outcome};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Runs every manifest in turn.
pub(in crate::cli) fn run(
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    interrupt::watch(terminal);
    jobs(args.jobs, terminal)?;
    // A missing lock is reported before anything is simulated.
    let locks = locked::locks(args, terminal)?;
    let mut exit = Exit::Yes;
    let mut suites = Vec::new();
    let mut failure = None;
    for (manifest, lock) in args.manifests.iter().zip(locks) {
        let one = match lock {
            Some(lock) if args.lock.probe => {
                probe::run(manifest, &lock, args, environment, terminal)
            }
            lock => run_one(manifest, lock.as_ref(), args, environment, terminal),
        };
        match one {
            Ok((one, suite)) => {
                suites.push(suite);
                if one.code() > exit.code() {
                    exit = one;
                }
            }
            Err(why) => {
                suites.push(unfinished(manifest, &why));
                failure = Some(why);
                break;
            }
        }
    }
    if args.format == Format::Junit {
        terminal.result(&junit::document("run", &suites));
    }
    failure.map_or(Ok(exit), Err)
}

/// Returns what is to be said to CI of a `manifest` that could not be run.
fn unfinished(manifest: &Path, why: &Failure) -> Suite {
    let came = Came::Broken(why.message.clone());
    let case = Case { name: "manifest".to_owned(), class: RUN, came, said: String::new() };
    let name = manifest.display().to_string();
    Suite { name, seconds: 0.0, properties: Vec::new(), cases: vec![case] }
}

fn run_one(
    manifest: &Path,
    lock: Option<&Lock>,
    args: &RunArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<(Exit, Suite), Failure> {
    let clock = RunClock::start();
    let execution = Execution::new(args.jobs, args.no_cache, environment)?;
    let loaded = load::manifest(manifest, args.select.given(), execution.calibrator(), terminal)?;
    let (plan, selection) = load::plan(loaded.experiment, &args.select)?;
    let how = if args.twice { Times::Twice } else { Times::Once };
    if args.no_seal {
        let mut ledger = Ledger::default();
        let account = execution.execute_each(&plan, how, terminal, &mut |record| {
            ledger.enter(&record);
            Ok(())
        })?;
        let Account { cached, doubted, .. } = account;
        let kept = Kept { plan, ledger, cached, doubted, seconds: clock.elapsed_seconds() };
        let root = environment.store().map_err(Failure::not_understood)?;
        return Ok(kept.told(manifest, &selection, root, args.format, terminal));
    }
    let forecast = execution.forecast(&plan)?;
    forecast.admits(&args.limits.limits(), &args.out)?;
    if forecast.is_large() {
        terminal.note(&format!("note: {}", forecast.in_words().trim_end()));
    }
    let scratch = load::scratch(&args.out);
    let mut gathering = Gathering::new(&plan, &scratch);
    let Account { cached, doubted, times } =
        execution.execute_each(&plan, how, terminal, &mut |record| gathering.take(&record))?;
    let unwritten = |e: std::io::Error| load::unwritten(&args.out, &e);
    let Gathered { ledger, conditions } = gathering.finish().map_err(unwritten)?;
    let verdicts = assemble::verdicts_of(&plan, &ledger).map_err(Failure::failed)?;
    let study_yaml = loaded.source.text.as_bytes();
    let asked = Asked { plan: &plan, study_yaml, selection: &selection };
    let content = assemble::assemble_judged(asked, &ledger, conditions, &verdicts, &scratch)
        .map_err(unwritten)?;
    let times = match environment.source_date_epoch {
        None => Ok(&times),
        Some(_) => Err("wall times are not measured where SOURCE_DATE_EPOCH is set"),
    };
    let measured = wall_time::measured(&plan, &ledger, times).map_err(Failure::failed)?;
    let mut circumstance = clock.circumstance(environment, execution.jobs());
    circumstance.files = measured.files;
    if environment.source_date_epoch.is_none() {
        // Without it nobody knows what the run's duration is the duration of.
        let simulated = (ledger.len() - cached).to_string();
        circumstance.environment.push((format::SIMULATED_TRIALS.to_owned(), simulated));
    }
    let capsule = args.capsule.then(capsule::own);
    let additions = Additions { source: capsule.as_ref(), limits: args.limits.limits() };
    let sealed = seal_with(&content, &circumstance, additions).map_err(Failure::failed)?;
    let path = args.out.join(sealed.file_name());
    load::write_with(&path, |out| sealed.write(Form::Bag, out))?;
    let held = lock
        .map(|lock| Held::against(lock, manifest, &sealed, locked::extent(args)))
        .transpose()?;
    let done = Done {
        verdicts,
        machine_verdicts: measured.verdicts,
        plan,
        ledger,
        cached,
        doubted,
        twice: args.twice,
        sealed,
        held,
        path,
        wall_seconds: clock.elapsed_seconds(),
        merged: None,
    };
    match args.format {
        Format::Human => done.tell(terminal),
        Format::Json => terminal.result(&done.to_json()),
        Format::Junit => {}
    }
    let drifted = done.held.as_ref().is_some_and(|held| held.told(terminal));
    if args.format == Format::Human {
        done.suggest(terminal);
    }
    let exit = if done.failed() > 0 {
        Exit::Failed
    } else if drifted {
        Exit::No
    } else {
        Exit::Yes
    };
    Ok((exit, done.to_suite(manifest)))
}

/// A finished run.
pub(super) struct Done {
    pub(super) plan: Plan,
    pub(super) ledger: Ledger,
    pub(super) verdicts: Vec<ClaimVerdict>,
    /// On claims about this machine.
    pub(super) machine_verdicts: Vec<ClaimVerdict>,
    pub(super) cached: usize,
    /// Of those from the store, executed again.
    pub(super) doubted: usize,
    pub(super) twice: bool,
    pub(super) sealed: Sealed,
    pub(super) held: Option<Held>,
    pub(super) path: PathBuf,
    pub(super) wall_seconds: f64,
    /// How many shards the records come from, where none of them was simulated here.
    pub(super) merged: Option<u32>,
}

impl Done {
    pub(super) fn failed(&self) -> usize {
        self.ledger.count(Outcome::PANICKED)
    }

    fn sim_seconds(&self) -> f64 {
        self.ledger.sim_seconds()
    }

    pub(super) fn tell(&self, terminal: Terminal) {
        let columns = terminal.columns();
        let mut head = wrapped(&self.plan.experiment.title, 0, columns);
        if self.plan.partial {
            let partial = "PARTIAL: part of the study only; no claim is judged";
            head.push_str(&wrapped(partial, 0, columns));
        }
        if let Some(compared) = compared(&self.verdicts, &self.plan.experiment.labels) {
            head.push_str(&wrapped(&format!("found: {compared}"), 0, columns));
        }
        let findings = assemble::findings(&self.plan, &self.ledger);
        let tables = &self.plan.experiment.tables;
        let exhibits: Vec<Exhibit> =
            tables.iter().map(|request| request.exhibit(&findings, tables)).collect();
        let mut tail = wrapped(&self.summary(), 0, columns);
        if self.twice {
            tail.push_str("every trial was executed twice and gave the same bytes\n");
        }
        if let Some(held) = &self.held {
            tail.push_str(&held.in_words());
        }
        for trial in self.ledger.entries().filter(|t| t.outcome() == Outcome::PANICKED) {
            let name = format!("{}/{}", trial.condition().slug(), trial.trial());
            terminal.error(&format!("trial {name} failed: {}", trial.cause()));
        }
        tail.push_str(&format!(
            "results sha256:{}\n{}\n",
            self.sealed.results_digest,
            self.path.display()
        ));
        let screen = Screen {
            head,
            exhibits: &exhibits,
            verdicts: &self.verdicts,
            machine: &self.machine_verdicts,
            tail,
            columns,
        };
        terminal.result(&screen.to_text());
    }

    /// Says on stderr what is worth typing next: scripts read digest and path in the last two lines of stdout.
    pub(super) fn suggest(&self, terminal: Terminal) {
        if let Some(path) = shell_word(&self.path.display().to_string()) {
            terminal.note(&format!(
                "next: reenact report {path}\n      reenact verify --level 4 {path}"
            ));
        }
    }

    fn summary(&self) -> String {
        let mut outcomes: Vec<(Outcome, usize)> =
            Outcome::all().into_iter().map(|outcome| (outcome, 0)).collect();
        for (outcome, n) in &mut outcomes {
            *n = self.ledger.count(*outcome);
        }
        outcomes.retain(|(_, n)| *n > 0);
        let outcomes: Vec<_> = outcomes.iter().map(|(o, n)| format!("{n} {}", o.name())).collect();
        if let Some(shards) = self.merged {
            return format!(
                "{}: {}; of {}, none simulated here, {:.0} s of simulated time\n",
                counted(self.ledger.len(), "trial"),
                outcomes.join(", "),
                counted(shards as usize, "shard"),
                self.sim_seconds()
            );
        }
        let fresh = self.ledger.len() - self.cached;
        let mut text = format!(
            "{}: {}; {} simulated in {:.1} s",
            counted(self.ledger.len(), "trial"),
            outcomes.join(", "),
            if fresh == self.ledger.len() { "all".to_owned() } else { format!("{fresh}") },
            self.wall_seconds
        );
        if self.cached > 0 {
            text.push_str(&format!(
                " ({} from the store, {} of them executed again: the same bytes)",
                self.cached, self.doubted
            ));
        }
        text.push_str(&format!(", {:.0} s of simulated time\n", self.sim_seconds()));
        text
    }

    /// Returns what is to be said to CI: a case for each condition, each claim and the lock.
    fn to_suite(&self, manifest: &Path) -> Suite {
        let design = self.plan.experiment.design();
        let conditions = design.filter_map(|(condition, _)| {
            let slug = condition.slug();
            let groups = self.ledger.groups().iter().filter(|g| g.condition() == condition);
            let trials: Vec<Entry<'_>> = groups.flat_map(Group::entries).collect();
            let failed: Vec<String> = trials
                .iter()
                .filter(|trial| trial.outcome() == Outcome::PANICKED)
                .map(|trial| format!("trial {slug}/{} failed: {}", trial.trial(), trial.cause()))
                .collect();
            let came =
                if failed.is_empty() { Came::Passed } else { Came::Broken(failed.join("\n")) };
            let labels = &self.plan.experiment.labels;
            let of = if labels.is_empty() { slug } else { labels.condition(condition) };
            let name = format!("{} of {of}", counted(trials.len(), "trial"));
            let case = Case { name, class: RUN, came, said: String::new() };
            (!trials.is_empty()).then_some(case)
        });
        let verdicts = self.verdicts.iter().chain(&self.machine_verdicts);
        let claims = verdicts.map(|verdict| {
            let said = [Some(verdict.judgement.to_string()), Some(verdict.reason.clone())];
            let said: Vec<String> = said.into_iter().flatten().filter(|s| !s.is_empty()).collect();
            let said = said.join(": ");
            let came = match verdict.judgement {
                Judgement::Supported | Judgement::Contradicted => Came::Passed,
                Judgement::Inconclusive | Judgement::CannotBeTested => Came::Skipped(said.clone()),
            };
            Case { name: format!("claim {}", verdict.id), class: RUN, came, said }
        });
        let lock = self.held.iter().map(Held::case);
        Suite {
            name: manifest.display().to_string(),
            seconds: self.wall_seconds,
            properties: vec![
                ("bundle", self.path.display().to_string()),
                ("results-digest", format!("sha256:{}", self.sealed.results_digest)),
                ("partial", self.plan.partial.to_string()),
            ],
            cases: conditions.chain(claims).chain(lock).collect(),
        }
    }

    pub(super) fn to_json(&self) -> String {
        let by_id = |verdicts: &[ClaimVerdict]| -> Map<String, Value> {
            let entry = |v: &ClaimVerdict| (v.id.clone(), v.judgement.to_string().into());
            verdicts.iter().map(entry).collect()
        };
        let path = std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
        let mut line = json!({
            "bundle": path,
            "bundle_id": format!("sha256:{}", self.sealed.bundle_id),
            "results_digest": format!("sha256:{}", self.sealed.results_digest),
            "study_digest": format!("sha256:{}", self.sealed.study_digest),
            "trials": self.ledger.len(),
            "cached": self.cached,
            "failed": self.failed(),
            "sim_seconds": self.sim_seconds(),
            "wall_seconds": self.wall_seconds,
            "partial": self.plan.partial,
            "claims": by_id(&self.verdicts),
        });
        if !self.machine_verdicts.is_empty() {
            line["circumstance_claims"] = by_id(&self.machine_verdicts).into();
        }
        if let Some(held) = &self.held {
            line["drift"] = held.drift();
        }
        line.to_string()
    }
}
