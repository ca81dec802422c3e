//! What verification asks of the program that ran the study, kept to what levels 3 to 6 need.

use super::{Earlier, Made};
use crate::bundle::{Bundle, BundleContent, Fault};
use crate::digest::TrialKey;

/// The way from a manifest to trials, as `run` goes it.
pub trait Pipeline {
    /// The engine of this program: bundles of another can be judged up to level 2.
    fn engine(&self) -> &str;

    /// Plans the study again from the bundle's manifest, inputs and overrides alone.
    ///
    /// # Errors
    /// Where they do not make a plan, in words.
    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, String>;
}

/// A study planned again from a bundle.
pub trait Replanned {
    /// Every trial, in plan order.
    fn trials(&self) -> Vec<PlannedTrial>;

    /// What `run` would seal, given the bundle's records: the very function that `run` calls, so that whatever is not a
    /// record, an input or the manifest is derived anew.
    ///
    /// # Errors
    /// Where the records do not make results, in words.
    fn content(&self) -> Result<BundleContent, String>;

    /// Executes the trials at `indices` of the plan again, never from a store; their record lines in that order.
    ///
    /// # Errors
    /// Where this program cannot execute them, in words.
    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, String>;

    /// Inputs that runs before the study's own made, of units that [`Self::make_again`] executes.
    fn earlier(&self) -> Vec<Earlier> {
        Vec::new()
    }

    /// Executes the units at `indices` of what was `made` again, never from a store: for each, in their order, nothing where it
    /// gave the same, or what it gave instead.
    ///
    /// # Errors
    /// Where they could not be executed, through no fault of the bundle.
    fn make_again(&self, made: Made, indices: &[usize]) -> Result<Vec<Option<Fault>>, String> {
        let _ = made;
        Err(format!("nobody here can execute {} units", indices.len()))
    }

    /// Runs again the explorations whose maps the study starts from, and tells of every sealed map that came out otherwise.
    fn explore_again(&self) -> Vec<Fault> {
        Vec::new()
    }

    /// Runs the whole study, never from a store, with `seed` in place of the manifest's and everything else as it is, and
    /// gives what `run` would seal.
    ///
    /// # Errors
    /// Where that does not make a plan or results, in words.
    fn replicate(&self, seed: u64) -> Result<BundleContent, String>;
}

/// One trial as the plan has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedTrial {
    /// Its identity.
    pub key: TrialKey,
    /// The slug of its condition.
    pub slug: String,
    /// Its number within the condition.
    pub trial: u32,
}
