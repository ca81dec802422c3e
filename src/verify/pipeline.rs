//! What verification asks of the program that ran the study, kept to what levels 3 to 6 need.

use super::{Earlier, Made};
use crate::bundle::{Bundle, BundleContent, Fault};
use crate::claims::observations::TrialsTableError;
use crate::digest::TrialKey;
use crate::document::{Diagnostic, MOST_FAULTS, reports};
use crate::plan::SelectionError;
use crate::runner::RunError;
use std::sync::Arc;
use thiserror::Error;

/// Why a bundle's manifest makes no plan.
#[derive(Debug, Error)]
pub enum ReplanError {
    /// What was overridden cannot be read.
    #[error("overrides: {0}")]
    Overrides(serde_json::Error),
    /// Which part was run cannot be read.
    #[error("selection: {0}")]
    Selection(serde_json::Error),
    /// The manifest is no text.
    #[error("study.yaml is not UTF-8 text")]
    NotText,
    /// It cannot be resolved.
    #[error("{}", counted(.0))]
    Faulty(Vec<Diagnostic>),
    /// It asks for far more than the bundle holds.
    #[error("one of {planned} trials, where the bundle holds {sealed} records")]
    TooMany {
        /// Trials that it asks for.
        planned: u64,
        /// Records in the bundle.
        sealed: usize,
    },
    /// It has no such part as was run.
    #[error(transparent)]
    NoPart(#[from] SelectionError),
}

/// Writes every fault of a manifest as a fault of its bundle states them.
fn counted(faults: &[Diagnostic]) -> String {
    let (reports, count) = (reports(faults, false), faults.iter().map(|f| f.count).sum());
    // A fault of a bundle is cut where it is long, so the count comes first.
    let counted = match count {
        0..=MOST_FAULTS => String::new(),
        _ => format!("{count} faults; the first are\n"),
    };
    counted + &reports.concat()
}

/// Why a bundle's records make no results.
#[derive(Debug, Error)]
pub enum ContentError {
    /// Lines of it are no records.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Records(Vec<Fault>),
    /// No claim can be judged by them.
    #[error(transparent)]
    Unjudged(#[from] TrialsTableError),
}

/// Why what runs before the study's own made cannot be made again.
#[derive(Debug, Error)]
pub enum MakeAgainError {
    /// This pipeline executes nothing of the kind.
    #[error("this program cannot execute {0} units")]
    Nobody(usize),
    /// The study has no calibration.
    #[error("there is no calibration")]
    NoCalibration,
    /// Its calibration was not measured.
    #[error("the calibration holds no passages")]
    NoPassages,
    /// The calibration has no such passage.
    #[error("no passage {0}")]
    NoPassage(usize),
    /// The study runs no draws, or of no proposals.
    #[error("there are no proposals")]
    NoInference,
    /// The inference has no such proposal.
    #[error("no proposal {0}")]
    NoProposal(usize),
    /// The study has no robustness table.
    #[error("there is no such table")]
    NoTable,
    /// The table has no such row.
    #[error("no row {0}")]
    NoRow(usize),
    /// A run of the table makes no plan, for another reason than its values.
    #[error("no plan {0}: {1}")]
    Unplanned(String, ReplanError),
    /// The trials could not be executed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No claim can be judged by them.
    #[error(transparent)]
    Unjudged(#[from] TrialsTableError),
}

/// Why a study cannot be run with another seed.
#[derive(Debug, Error)]
pub enum ReplicateError {
    /// That does not make a plan.
    #[error(transparent)]
    Replan(#[from] ReplanError),
    /// The trials could not be executed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No claim can be judged by them.
    #[error(transparent)]
    Unjudged(#[from] TrialsTableError),
}

/// The way from a manifest to trials, as `run` goes it.
pub trait Pipeline {
    /// Returns the engine of this program for the study of `bundle`: bundles of another can be judged up to level 2.
    fn engine(&self, bundle: &Bundle) -> String;

    /// Plans the study again from the bundle's manifest, inputs and overrides alone.
    ///
    /// # Errors
    /// Where they do not make a plan.
    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, ReplanError>;
}

/// A study planned again from a bundle.
pub trait Replanned {
    /// Returns every trial, in plan order.
    fn trials(&self) -> Vec<PlannedTrial>;

    /// Makes what `run` would seal, given the bundle's records: by the very function that `run` calls, so that whatever
    /// is not a record, an input or the manifest is derived anew.
    ///
    /// # Errors
    /// Where the records do not make results.
    fn content(&self) -> Result<BundleContent, ContentError>;

    /// Executes the trials at `indices` of the plan again, never from a store; their record lines in that order.
    ///
    /// # Errors
    /// Where this program cannot execute them.
    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, RunError>;

    /// Returns the inputs that runs before the study's own made, of units that [`Self::make_again`] executes.
    fn earlier(&self) -> Vec<Earlier> {
        Vec::new()
    }

    /// Executes the units at `indices` of what was `made` again, never from a store: for each, in their order, nothing where it
    /// gave the same, or what it gave instead.
    ///
    /// # Errors
    /// Where they could not be executed, through no fault of the bundle.
    fn make_again(
        &self,
        made: Made,
        indices: &[usize],
    ) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        let _ = made;
        Err(MakeAgainError::Nobody(indices.len()))
    }

    /// Runs again the explorations whose maps the study starts from, and returns a fault for every sealed map that came
    /// out otherwise.
    fn explore_again(&self) -> Vec<Fault> {
        Vec::new()
    }

    /// Runs the whole study, never from a store, with `seed` in place of the manifest's and everything else as it is, and
    /// gives what `run` would seal.
    ///
    /// # Errors
    /// Where that does not make a plan or results.
    fn replicate(&self, seed: u64) -> Result<BundleContent, ReplicateError>;
}

/// One trial as the plan has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedTrial {
    /// Its identity.
    pub key: TrialKey,
    /// The slug of its condition.
    pub slug: Arc<str>,
    /// Its number within the condition.
    pub trial: u32,
}
