//! `reenact submit`: the shards of a study as a job of an engine that the laboratory has.
//!
//! Workers finish their shards into one store (`run --no-seal --shard I/N`); whoever comes last runs the study as it is, finds
//! every trial there, and seals. Nothing of this is needed for the result: it is the store and the manifest that say it.

mod kubernetes;
mod slurm;

use crate::cli::args::{Engine, SelectArgs, SubmitArgs};
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::plan::{Plan, Selection};
use crate::provenance::{self, Environment};
use std::path::{Path, PathBuf};

/// What all engines are told.
struct Work {
    /// The study's name.
    name: String,
    /// How many trials are divided.
    trials: u64,
    shards: u32,
    /// `--set`, `--allow`, `--only` and `--trials` as the command line writes them.
    options: Vec<String>,
}

/// Checks the manifest, and submits its shards or prints how.
pub(in crate::cli) fn run(
    args: &SubmitArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    // What would fail in every shard is told before anything waits in a queue.
    let given = load::Given { set: &args.set, allow: &args.allow };
    let loaded = load::manifest(&args.manifest, given, Calibrator::StandIn, terminal)?;
    let select = SelectArgs::from(args);
    let selection = Selection::parse(&select.only, select.trials, None);
    let selection = selection.map_err(Failure::not_understood)?;
    let name = loaded.experiment.name.clone();
    let (plan, _) = load::plan(loaded.experiment, &select)?;
    let trials = Plan::size(&plan.experiment, &selection);
    let shards = args.shards.get();
    if u64::from(shards) > trials {
        let trials = counted(usize::try_from(trials).unwrap_or(usize::MAX), "trial");
        return Err(Failure::not_understood(format!(
            "`--shards` must be at most as many as there are trials, found {shards} of {trials}"
        )));
    }
    let set = args.set.iter().flat_map(|set| ["--set".to_owned(), set.clone()]);
    let allowed = args.allow.iter().map(|folder| folder.display().to_string());
    let allow = allowed.flat_map(|folder| ["--allow".to_owned(), folder]);
    let options = set.chain(allow).chain(selection.options()).collect();
    let work = Work { name, trials, shards, options };
    match args.engine {
        Engine::Slurm => slurm::submit(&work, args, environment, terminal),
        Engine::Kubernetes => kubernetes::print(&work, args, terminal),
    }
}

/// Returns `path` from the root, as another machine with the same file system finds it.
fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|e| Failure::failed(format!("cannot tell where `{}` is: {e}", path.display())))
}

/// Returns where this program is.
fn program() -> Result<PathBuf, Failure> {
    provenance::program()
        .map_err(|e| Failure::failed(format!("cannot tell where this program is: {e}")))
}
