//! The lock beside a manifest, and what a run holds against it.

use crate::bundle::{Archive, Bundle, Form, Sealed};
use crate::cli::args::RunArgs;
use crate::cli::exit::Failure;
use crate::cli::junit::{Came, Case, RUN};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::compare::{self, Account, Comparison, Extent, Lock, LockError, Tolerances};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Returns where the lock of `manifest` is: `quickstart.lock` beside `quickstart.yaml`.
pub(super) fn path_of(manifest: &Path) -> PathBuf {
    manifest.with_extension("lock")
}

/// Reads the lock of every manifest, where `--locked` asks for them.
pub(super) fn locks(args: &RunArgs, terminal: Terminal) -> Result<Vec<Option<Lock>>, Failure> {
    if !args.lock.locked {
        return Ok(args.manifests.iter().map(|_| None).collect());
    }
    if args.select.trials.is_some() || args.select.shard.is_some() {
        return Err(Failure::not_understood(
            "`--locked` compares whole conditions, so it goes with neither `--trials` nor `--shard`; choose conditions \
             with `--only`, or run trial 0 of each with `--probe`",
        ));
    }
    let lock = |manifest: &PathBuf| {
        let path = path_of(manifest);
        let source = load::text(&path).map_err(|failure| Failure {
            message: format!(
                "{}; `--locked` needs a lock: write it with `reenact lock {}` and commit it",
                failure.message,
                manifest.display()
            ),
            ..failure
        })?;
        read(&source, terminal).map(Some)
    };
    args.manifests.iter().map(lock).collect()
}

/// Reads a lock; every fault goes to stderr.
pub(super) fn read(source: &crate::document::Source, terminal: Terminal) -> Result<Lock, Failure> {
    Lock::read(source).map_err(|error| {
        let (LockError::Newer(faults) | LockError::Unreadable(faults)) = error;
        terminal.diagnostics(&faults);
        Failure::not_understood(format!("{}: {}", source.name, Terminal::count(&faults)))
    })
}

/// Returns what a sealed tree says.
pub(super) fn account_of(sealed: &Sealed) -> Result<Account, Failure> {
    let (tree, large) = (sealed.tree.clone(), sealed.large.clone());
    let archive = Archive { form: Form::Bag, tree, large };
    let bundle = Bundle::open(archive).map_err(Failure::failed)?;
    Account::of_bundle(&bundle).map_err(|faults| {
        Failure::failed(faults.first().map(ToString::to_string).unwrap_or_default())
    })
}

/// Returns how much of the locked study `args` run.
pub(super) fn extent(args: &RunArgs) -> Extent {
    if args.lock.probe {
        Extent::FirstTrials
    } else if args.select.only.is_empty() {
        Extent::Whole
    } else {
        Extent::Conditions
    }
}

/// A run held against the lock of its manifest.
pub(super) struct Held {
    pub(super) comparison: Comparison,
    manifest: String,
    lock: String,
}

impl Held {
    /// Compares what was `sealed` with `lock`.
    pub(super) fn against(
        lock: &Lock,
        manifest: &Path,
        sealed: &Sealed,
        extent: Extent,
    ) -> Result<Self, Failure> {
        let account = account_of(sealed)?;
        let comparison = compare::compare(lock.account(), &account, extent, &Tolerances::default())
            .map_err(Failure::failed)?;
        let lock = path_of(manifest).display().to_string();
        Ok(Self { comparison, manifest: manifest.display().to_string(), lock })
    }

    /// Says in one line that all is as the lock has it, or gives the drift in full.
    pub(super) fn in_words(&self) -> String {
        if self.comparison.is_same() {
            let what = match self.comparison.extent {
                Extent::Whole => "everything is",
                Extent::Conditions => "the records of these conditions are",
                Extent::FirstTrials => "trial 0 of every condition is",
            };
            format!("{what} as in {}\n", self.lock)
        } else {
            format!("\n{}\n", compare::drift(&self.comparison, &self.manifest, &self.lock))
        }
    }

    /// Returns the comparison where there is drift, else nothing.
    pub(super) fn drift(&self) -> Value {
        if self.comparison.is_same() { Value::Null } else { self.comparison.to_json() }
    }

    /// Says on stderr that there is drift, and whether there is.
    pub(super) fn told(&self, terminal: Terminal) -> bool {
        if !self.comparison.is_same() {
            terminal.error(&format!("{} has drifted from {}", self.manifest, self.lock));
        }
        !self.comparison.is_same()
    }

    /// Returns what is to be said of it to CI.
    pub(super) fn case(&self) -> Case {
        let came = if self.comparison.is_same() {
            Came::Passed
        } else {
            Came::Failed(self.in_words().trim().to_owned())
        };
        Case { name: format!("as in {}", self.lock), class: RUN, came, said: String::new() }
    }

    /// Returns the lock's path.
    pub(super) fn lock(&self) -> &str {
        &self.lock
    }
}
