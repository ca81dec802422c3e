//! `reenact lock`: what a manifest's run yields, written down beside it.

use super::execution::{Execution, Times, jobs};
use super::locked::{account_of, path_of, read};
use crate::bundle::{Additions, Circumstance, Limits, Moment, assemble, seal_with};
use crate::cli::args::{DataFormat, LockArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::{Terminal, counted};
use crate::cli::{interrupt, load};
use crate::compare::{Account, Extent, Lock, LockError, Tolerances, compare};
use crate::document::Source;
use crate::plan::{Plan, Selection};
use crate::provenance::Environment;
use serde_json::json;
use std::path::Path;

/// Locks every manifest in turn.
pub(in crate::cli) fn run(
    args: &LockArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    interrupt::watch(terminal);
    jobs(args.jobs, terminal)?;
    for manifest in &args.manifests {
        terminal.result(&lock_one(manifest, args, environment, terminal)?);
    }
    Ok(Exit::Yes)
}

fn lock_one(
    manifest: &Path,
    args: &LockArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<String, Failure> {
    let path = path_of(manifest);
    let old = old_text(&path)?;
    if let Some(old) = &old
        && let Err(LockError::Newer(_)) = Lock::read(old)
    {
        // An older program must not take back what a newer one wrote.
        read(old, terminal)?;
    }
    let execution = Execution::new(args.jobs, args.no_cache, environment)?;
    let given = load::Given { set: &[], allow: &args.allow };
    let loaded = load::manifest(manifest, given, execution.calibrator(), terminal)?;
    let plan = Plan::of(loaded.experiment);
    let records = execution.execute(&plan, Times::Once, terminal)?;
    let whole = Selection::default();
    let content = assemble::assemble(&plan, loaded.source.text.as_bytes(), &whole, &records)
        .map_err(Failure::failed)?;
    // Nobody is handed this bundle: what readers take does not bind it, and its records are in memory as they are.
    let unbound = Limits { held: u64::MAX, ..Limits::default() };
    let additions = Additions { source: None, limits: unbound };
    let sealed = seal_with(&content, &Circumstance::reproducible(Moment(0)), additions)
        .map_err(Failure::failed)?;
    let account = account_of(&sealed)?;
    let lock = Lock::of(&account).map_err(|problem| {
        Failure::failed(format!("{}: cannot lock: {problem}", manifest.display()))
    })?;
    let text = lock.to_text();
    let name = path.display();
    if args.format == DataFormat::Json {
        let state = match &old {
            None => "new",
            Some(old) if *old.text == *text => "unchanged",
            Some(_) => "changed",
        };
        if state != "unchanged" {
            load::write(&path, text.as_bytes())?;
        }
        return Ok(json!({
            "manifest": manifest.display().to_string(),
            "lock": name.to_string(),
            "state": state,
            "trials": records.len(),
            "conditions": account.conditions.len(),
            "results_digest": format!("sha256:{}", account.results_digest),
        })
        .to_string());
    }
    let Some(old) = old else {
        load::write(&path, text.as_bytes())?;
        return Ok(format!(
            "wrote {name}: {} of {}, results sha256:{}\ncommit it; `reenact run --locked --probe {}` finds drift\n",
            counted(records.len(), "trial"),
            counted(account.conditions.len(), "condition"),
            account.results_digest.short(),
            manifest.display(),
        ));
    };
    if *old.text == *text {
        return Ok(format!("{name} is up to date\n"));
    }
    let told = changes(&old, &account, &path, terminal)?;
    load::write(&path, text.as_bytes())?;
    Ok(told)
}

/// Says what the new lock changes, or that the old one says nothing that can be compared.
fn changes(
    old: &Source,
    new: &Account,
    path: &Path,
    terminal: Terminal,
) -> Result<String, Failure> {
    let name = path.display();
    let reason = "the reason belongs in CHANGELOG.md, in the same commit";
    let old = match Lock::read(old) {
        Ok(lock) => lock,
        Err(LockError::Newer(faults) | LockError::Unreadable(faults)) => {
            terminal.diagnostics(&faults);
            return Ok(format!("wrote {name} anew: the old one could not be read; {reason}\n"));
        }
    };
    let comparison = compare(old.account(), new, Extent::Whole, &Tolerances::default())
        .map_err(Failure::failed)?;
    if comparison.is_same() {
        return Ok(format!("wrote {name} anew: its layout changed, and nothing that it pins\n"));
    }
    let told = comparison.to_human(["the old lock", "the new lock"]);
    Ok(format!("{told}\nwrote {name} anew: {reason}\n"))
}

/// Reads the lock's text, where there is one.
fn old_text(path: &Path) -> Result<Option<Source>, Failure> {
    if path.exists() { load::text(path).map(Some) } else { Ok(None) }
}
