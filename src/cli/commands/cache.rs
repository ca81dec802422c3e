//! `reenact cache`: the store of finished trials.

use crate::cli::args::{CacheAction, CacheArgs, CacheExportArgs, DataFormat, PruneArgs};
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::digest::TrialKey;
use crate::manifest::Experiment;
use crate::plan::Plan;
use crate::provenance::Environment;
use crate::runner::StoreError;
use crate::store::{Audit, Collected, DirectoryStore, Imported, PackError, Pruned, reason};
use serde_json::json;
use std::fs::File;
use std::path::Path;
use std::time::Duration;

/// Faults that are listed for people.
const LISTED: usize = 20;

/// Says where the store is, how large or how whole; makes room in it; or moves its records.
pub(in crate::cli) fn run(
    args: &CacheArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let root = environment.store().map_err(Failure::not_understood)?;
    let store = DirectoryStore::new(root);
    match &args.action {
        CacheAction::Dir => terminal.result(&root.display().to_string()),
        CacheAction::Size(args) => {
            let (trials, bytes) = store.size().map_err(Failure::failed)?;
            terminal.result(&match args.format {
                DataFormat::Human => format!("{}, {bytes} bytes", counted(trials, "trial")),
                DataFormat::Json => {
                    json!({"store": root, "trials": trials, "bytes": bytes}).to_string()
                }
            });
        }
        CacheAction::Prune(PruneArgs { older_than, .. }) => {
            let days = Duration::from_secs(86_400) * older_than.unwrap_or(0);
            let Pruned { files, bytes, busy } = store.prune(days).map_err(Failure::failed)?;
            terminal
                .result(&format!("removed {} of trials, {bytes} bytes", counted(files, "file")));
            tell_busy(busy, terminal);
        }
        CacheAction::Verify(args) => {
            let audit = store.audit().map_err(Failure::failed)?;
            terminal.result(&match args.format {
                DataFormat::Human => in_words(&audit),
                DataFormat::Json => to_json(&audit),
            });
            return Ok(if audit.damage.is_empty() { Exit::Yes } else { Exit::No });
        }
        CacheAction::Gc => {
            let collected = store.collect().map_err(Failure::failed)?;
            let Collected { files, records, repeated, damaged, busy, left, freed } = collected;
            terminal.result(&format!(
                "put {} together: {}, {repeated} more that were there twice, {}; {freed} bytes freed",
                counted(files, "file"),
                counted(records, "record"),
                counted(damaged, "damaged line")
            ));
            tell_busy(busy, terminal);
            if left > 0 {
                let files = counted(left, "file");
                terminal.note(&format!("note: {files} are left for another `reenact cache gc`"));
            }
        }
        CacheAction::Export(args) => export(&store, args, terminal)?,
        CacheAction::Import(args) => {
            for pack in &args.packs {
                let Imported { records, new } = import(&store, pack)?;
                terminal.result(&format!(
                    "{}: {}, {new} of them new",
                    pack.display(),
                    counted(records, "record")
                ));
            }
        }
    }
    Ok(Exit::Yes)
}

fn tell_busy(busy: usize, terminal: Terminal) {
    if busy > 0 {
        let files = counted(busy, "file");
        terminal.warning(&format!("{files} stay: a run is at work on them"));
    }
}

fn in_words(audit: &Audit) -> String {
    let Audit { trials, repeated, files, unfinished, damage } = audit;
    let mut text = String::new();
    for fault in damage.iter().take(LISTED) {
        text.push_str(&format!(
            "{}:{}: expected a whole record, found {}\n",
            fault.path.display(),
            fault.line,
            fault.found
        ));
    }
    if damage.len() > LISTED {
        text.push_str(&format!("... and {} more\n", damage.len() - LISTED));
    }
    text.push_str(&format!(
        "{} in {}, every record has its digest",
        counted(*trials, "trial"),
        counted(*files, "file")
    ));
    if *repeated > 0 {
        text.push_str(&format!("; {} of them again, the same", counted(*repeated, "record")));
    }
    if *unfinished > 0 {
        text.push_str(&format!("; {} being written", counted(*unfinished, "record")));
    }
    match damage.len() {
        0 => text.push('\n'),
        faults => text.push_str(&format!(
            "; {}: no run uses them; `reenact cache gc` removes what is damaged\n",
            counted(faults, "fault")
        )),
    }
    text
}

fn to_json(audit: &Audit) -> String {
    let Audit { trials, repeated, files, unfinished, damage } = audit;
    let fault = |fault: &crate::store::Damage| json!({"file": fault.path, "line": fault.line, "found": fault.found});
    json!({
        "trials": trials,
        "repeated": repeated,
        "files": files,
        "unfinished": unfinished,
        "damage": damage.iter().map(fault).collect::<Vec<_>>(),
    })
    .to_string()
}

fn export(
    store: &DirectoryStore,
    args: &CacheExportArgs,
    terminal: Terminal,
) -> Result<(), Failure> {
    let mut wanted: Vec<TrialKey> = Vec::new();
    for manifest in &args.manifests {
        // What a calibration measured is part of the trials' keys, and draws are what an inference proposed.
        let given = load::Given { set: &args.set, allow: &args.allow };
        let loaded = load::manifest(manifest, given, Calibrator::Stored(store), terminal)?;
        let calibration =
            loaded.experiment.calibration.as_deref().map(|run| run.experiment.clone());
        let inference = loaded.experiment.inference();
        let inference = inference.map(|run| Experiment::clone(&run.experiment));
        let experiments = [Some(loaded.experiment), calibration, inference];
        let plans = experiments.into_iter().flatten().map(Plan::of);
        wanted.extend(plans.flat_map(|plan| plan.trials).map(|spec| spec.key));
    }
    let keys = (!args.manifests.is_empty()).then_some(&wanted[..]);
    let output = args.output.display();
    let exported = store.export(keys, &args.output).map_err(|e| {
        Failure::failed(match e {
            PackError::Io(e) => format!("cannot write `{output}`: {}", reason(&e)),
            e => e.to_string(),
        })
    })?;
    let records = exported.ok_or_else(|| {
        Failure::not_understood(format!(
            "the store has none of these trials, so `{output}` is not written"
        ))
    })?;
    terminal.result(&match keys {
        Some(keys) => format!("{output}: {records} of {}", counted(keys.len(), "trial")),
        None => format!("{output}: {}", counted(records, "trial")),
    });
    Ok(())
}

fn import(store: &DirectoryStore, pack: &Path) -> Result<Imported, Failure> {
    let file = File::open(pack).map_err(|e| {
        Failure::not_understood(format!("cannot read `{}`: {}", pack.display(), reason(&e)))
    })?;
    store.import(file).map_err(|fault| {
        let message = format!("{}: {fault}", pack.display());
        match fault {
            PackError::Io(_) | PackError::Store(StoreError::Io(_)) => Failure::failed(message),
            PackError::NoPack | PackError::Newer(_) => Failure::not_understood(message),
            _ => Failure { exit: Exit::No, message },
        }
    })
}
