//! The studies that Reenact re-enacts, behind one door: what a trial needs, what it yields.
//!
//! A study is a folder here and one arm of [`Setup`]; the two never import one another. What all of them
//! share, the trial's identity and its record, is in this module.

pub mod prior_map;
mod record;
pub mod recording;

pub use record::{CHAIN_STEP_S, Outcome, SeriesPoint, TrialRecord, first_divergence};

use crate::digest::TrialKey;
use crate::rng::Seeds;
use std::sync::Arc;

/// Which study a manifest describes: a closed set.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum StudyKind {
    /// Luperto et al. 2020: exploration with prior knowledge.
    PriorMap,
}

/// One cell of the design: a value for every factor, in the manifest's order.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Condition(pub Vec<(String, String)>);

impl Condition {
    /// The value of `factor`.
    pub fn value(&self, factor: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == factor).map(|(_, value)| value.as_str())
    }

    /// A file name for this cell: the values joined by underscores, `all` where there is no factor.
    /// Only `[A-Za-z0-9.-]` of each value survive; resolution refuses manifests where two cells clash.
    pub fn slug(&self) -> String {
        let safe = |value: &String| {
            value
                .chars()
                .map(|c| if c.is_ascii_alphanumeric() || ".-".contains(c) { c } else { '-' })
                .collect::<String>()
        };
        let parts: Vec<_> = self.0.iter().map(|(_, value)| safe(value)).collect();
        if parts.is_empty() { "all".to_owned() } else { parts.join("_") }
    }
}

impl std::fmt::Display for Condition {
    /// `prior=floor-plan environment=basic`, as people read it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts: Vec<_> = self.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
        f.write_str(&parts.join(" "))
    }
}

/// Everything one trial needs, by study.
#[derive(Debug, Clone)]
pub enum Setup {
    /// A trial of the prior-knowledge study.
    PriorMap(Arc<prior_map::Setup>),
}

/// One trial, self-contained: executing it is a pure function of this value.
#[derive(Debug, Clone)]
pub struct TrialSpec {
    /// Identity: digest of everything below and the engine version.
    pub key: TrialKey,
    /// The cell it belongs to.
    pub condition: Condition,
    /// Number within the cell, from 0.
    pub trial: u32,
    /// Where its random streams come from.
    pub seeds: Seeds,
    /// What it runs.
    pub setup: Setup,
}

/// Runs a trial: a pure function of `spec`.
pub fn execute(spec: &TrialSpec) -> TrialRecord {
    match &spec.setup {
        Setup::PriorMap(setup) => prior_map::run(spec, setup, None),
    }
}

/// Runs a trial and writes everything down. The record is the one that [`execute`] yields.
pub fn reenact(spec: &TrialSpec) -> (TrialRecord, recording::Recording) {
    let mut recording = recording::Recording::default();
    let record = match &spec.setup {
        Setup::PriorMap(setup) => prior_map::run(spec, setup, Some(&mut recording)),
    };
    (record, recording)
}
