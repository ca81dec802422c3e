//! `reenact cache`: the store of finished trials.

use crate::cli::args::{CacheAction, CacheArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::{Terminal, counted};
use crate::provenance::Environment;
use crate::store::DirectoryStore;

/// Says where the store is, or how large.
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
    }
    Ok(Exit::Yes)
}
