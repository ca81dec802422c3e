//! `reenact cache`: the store of finished trials.

use crate::cli::args::{CacheAction, CacheArgs, PruneArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::{Terminal, counted};
use crate::provenance::Environment;
use crate::store::DirectoryStore;
use std::time::Duration;

/// Says where the store is, or how large; or makes room in it.
pub(in crate::cli) fn run(
    args: &CacheArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let root = environment.store().map_err(Failure::not_understood)?;
    match args.action {
        CacheAction::Dir => terminal.result(&root.display().to_string()),
        CacheAction::Size => {
            let (trials, bytes) = DirectoryStore::new(root).size().map_err(Failure::failed)?;
            terminal.result(&format!("{}, {bytes} bytes", counted(trials, "trial")));
        }
        CacheAction::Prune(PruneArgs { older_than, .. }) => {
            let days = Duration::from_secs(86_400) * older_than.unwrap_or(0);
            let pruned = DirectoryStore::new(root).prune(days).map_err(Failure::failed)?;
            let files = counted(pruned.files, "file");
            terminal.result(&format!("removed {files} of trials, {} bytes", pruned.bytes));
            if pruned.busy > 0 {
                let files = counted(pruned.busy, "file");
                terminal.warning(&format!("{files} stay: a run is at work on them"));
            }
        }
    }
    Ok(Exit::Yes)
}
