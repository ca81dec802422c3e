//! `reenact merge`: the bundles of a study's shards as the one bundle of the whole.

use super::run::Done;
use crate::bundle::assemble::{self, Asked};
use crate::bundle::{Additions, Form, Gathered, Gathering, format, seal_with, wall_time};
use crate::cli::args::{DataFormat, MergeArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::{Terminal, counted};
use crate::cli::{checked, interrupt, load};
use crate::merge::{MergeError, Merged, Shard, merge};
use crate::provenance::{Environment, RunClock};
use crate::verify::Level;

/// Checks every shard to level 2, puts their records together and seals what they come to.
pub(in crate::cli) fn run(
    args: &MergeArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    interrupt::watch(terminal);
    let clock = RunClock::start();
    let mut shards = Vec::with_capacity(args.shards.len());
    for path in &args.shards {
        // What follows from the records is derived anew from all of them, so what follows from some needs no check.
        let checked = checked::to_level(Level::Coherent, path, false, args.limits)?;
        shards.push(Shard { name: path.display().to_string(), bundle: checked.bundle });
    }
    let refused = |fault: MergeError| {
        let exit = if fault.is_misunderstood() { Exit::NotUnderstood } else { Exit::No };
        Failure { exit, message: fault.to_string() }
    };
    let merged = merge(&shards).map_err(refused)?;
    let (of, repeated) = (merged.shards, merged.repeated);
    let unwritten = |e: std::io::Error| load::unwritten(&args.out, &e);
    let scratch = load::scratch(args.out.parent().unwrap_or(&args.out));
    let mut gathering = Gathering::new(&merged.plan, &scratch);
    merged.records(|record| gathering.take(record)).map_err(|fault| match fault {
        MergeError::Unwritten(error) => unwritten(error),
        fault => refused(fault),
    })?;
    if repeated > 0 {
        let bundles = counted(repeated, "bundle");
        terminal.note(&format!("note: {bundles} of shards that were given before say the same"));
    }
    let Gathered { ledger, conditions } = gathering.finish().map_err(unwritten)?;
    let Merged { plan, selection, study_yaml, .. } = merged;
    drop(shards);
    let verdicts = assemble::verdicts_of(&plan, &ledger).map_err(Failure::failed)?;
    let asked = Asked { plan: &plan, study_yaml: &study_yaml, selection: &selection };
    let content = assemble::assemble_judged(asked, &ledger, conditions, &verdicts, &scratch)
        .map_err(unwritten)?;
    let not_here =
        Err("the trials ran on the machines of several shards, so that their times are not of one");
    let measured = wall_time::measured(&plan, &ledger, not_here).map_err(Failure::failed)?;
    let mut circumstance = clock.circumstance(environment, 1);
    circumstance.files = measured.files;
    if environment.source_date_epoch.is_none() {
        let facts =
            [(format::SIMULATED_TRIALS, "0".to_owned()), (format::MERGED_SHARDS, of.to_string())];
        circumstance.environment.extend(facts.map(|(name, value)| (name.to_owned(), value)));
    }
    let additions = Additions { source: None, limits: args.limits.limits() };
    let sealed = seal_with(&content, &circumstance, additions).map_err(Failure::failed)?;
    let path = match args.out.extension() {
        Some(extension) if extension == "zip" && !args.out.is_dir() => args.out.clone(),
        _ => args.out.join(sealed.file_name()),
    };
    load::write_with(&path, |out| sealed.write(Form::Bag, out))?;
    let done = Done {
        verdicts,
        machine_verdicts: measured.verdicts,
        plan,
        cached: ledger.len(),
        ledger,
        doubted: 0,
        twice: false,
        sealed,
        held: None,
        path,
        wall_seconds: clock.elapsed_seconds(),
        merged: Some(of),
    };
    match args.format {
        DataFormat::Human => {
            done.tell(terminal);
            done.suggest(terminal);
        }
        DataFormat::Json => terminal.result(&done.to_json()),
    }
    Ok(if done.failed() > 0 { Exit::Failed } else { Exit::Yes })
}
