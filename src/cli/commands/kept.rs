//! What a run without a bundle says: its trials are kept in the store, and whoever runs the study next seals it.

use crate::cli::args::Format;
use crate::cli::exit::Exit;
use crate::cli::junit::{Came, Case, RUN, Suite};
use crate::cli::terminal::{Terminal, counted};
use crate::plan::{Plan, Selection};
use crate::studies::{Ledger, Outcome};
use serde_json::json;
use std::path::Path;

/// A finished run that seals nothing.
pub(super) struct Kept {
    pub(super) plan: Plan,
    pub(super) ledger: Ledger,
    /// How many of them the store had before.
    pub(super) cached: usize,
    /// Of those, executed again.
    pub(super) doubted: usize,
    /// How long it took (s).
    pub(super) seconds: f64,
}

impl Kept {
    /// Says what was done in `format` and returns how the command ends, and what is to be said of it to CI.
    pub(super) fn told(
        &self,
        manifest: &Path,
        selection: &Selection,
        store: &Path,
        format: Format,
        terminal: Terminal,
    ) -> (Exit, Suite) {
        let failed: Vec<String> = self
            .ledger
            .entries()
            .filter(|trial| trial.outcome() == Outcome::PANICKED)
            .map(|trial| {
                let slug = trial.condition().slug();
                format!("trial {slug}/{} failed: {}", trial.trial(), trial.cause())
            })
            .collect();
        match format {
            Format::Human => {
                terminal.result(&self.in_words(selection, store, failed.len()));
                for failure in &failed {
                    terminal.error(failure);
                }
            }
            Format::Json => {
                terminal.result(&self.to_json(manifest, selection, store, failed.len()));
            }
            Format::Junit => {}
        }
        let exit = if failed.is_empty() { Exit::Yes } else { Exit::Failed };
        let came = if failed.is_empty() { Came::Passed } else { Came::Broken(failed.join("\n")) };
        let name = format!("{} kept", counted(self.ledger.len(), "trial"));
        let suite = Suite {
            name: manifest.display().to_string(),
            seconds: self.seconds,
            properties: vec![("partial", self.plan.partial.to_string())],
            cases: vec![Case { name, class: RUN, came, said: String::new() }],
        };
        (exit, suite)
    }

    fn in_words(&self, selection: &Selection, store: &Path, failed: usize) -> String {
        let part = match selection.shard {
            Some((i, n)) => format!("shard {i}/{n} of "),
            None => String::new(),
        };
        let again = match self.cached {
            0 => String::new(),
            cached => {
                let doubted = self.doubted;
                format!(", {cached} were there ({doubted} of them executed again: the same bytes)")
            }
        };
        let lost = match failed {
            0 => String::new(),
            failed => format!(", {failed} failed and are not"),
        };
        format!(
            "{part}{}: {}, {} simulated in {:.1} s{again}; kept in {}{lost}; nothing is sealed\n",
            self.plan.experiment.name,
            counted(self.ledger.len(), "trial"),
            self.ledger.len() - self.cached,
            self.seconds,
            store.display(),
        )
    }

    fn to_json(&self, manifest: &Path, part: &Selection, store: &Path, failed: usize) -> String {
        json!({
            "manifest": manifest,
            "store": store,
            "shard": part.shard.map(|(i, n)| format!("{i}/{n}")),
            "trials": self.ledger.len(),
            "cached": self.cached,
            "failed": failed,
            "sim_seconds": self.ledger.sim_seconds(),
            "wall_seconds": self.seconds,
            "partial": self.plan.partial,
            "sealed": false,
        })
        .to_string()
    }
}
