//! Claims of a paper as data, and what the trials say of them.
//!
//! [`Claim::check`] finds the faults of a claim before anything runs, [`judge`] holds it against the trials
//! table, [`power::power`] says beforehand what a number of trials would decide.
//!
//! A verdict is supported, contradicted, inconclusive or cannot-be-tested. What the paper says
//! ([`Claim::words`]), what its own table shows ([`Claim::paper_table`]) and what we find
//! ([`Verdict::judgement`]) stay three facts: none is computed from another.
//!
//! The rules (`docs/claims.md`): a p-value above alpha is never evidence of equality; runs that did not reach a
//! measure are counted and never silently dropped; trials that share their noise are refused by tests that
//! need independence; wall times belong to the circumstance half and cannot decide a result.

mod agreement;
pub mod cells;
mod check;
pub mod comparing;
mod comparison;
mod equality;
pub mod expect;
mod gather;
mod judge;
mod level;
pub mod measuring;
pub mod metric;
pub mod observations;
mod pairing;
pub mod power;
pub mod published;
mod rate;
mod scope;
pub mod sensitivity;
mod sign;
mod spread;
pub mod terms;
pub mod verdict;

pub use check::{Fault, Known, check_all};
pub use expect::Expect;
pub use judge::{Context, judge, judge_observations, not_measured};
pub use observations::Observations;
pub use sensitivity::Sensitivity;
pub use verdict::{Judgement, Score, Verdict};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A claim of the paper, as a manifest states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(extend(
    "not" = {"required": ["says", "ours"]},
    "if" = {"required": ["ours"]},
    "then" = {},
    "else" = {"required": ["says", "paper-table"]}
))]
pub struct Claim {
    /// Short name, unique in the manifest.
    pub id: String,
    /// What the paper says, in its own words, `...` where some are left out. Either this or `ours`.
    pub says: Option<String>,
    /// What we check besides, which the paper does not say, in our words. Shown and counted apart.
    pub ours: Option<String>,
    /// Where the paper says so.
    pub cite: Option<String>,
    /// The statement that is judged.
    pub expect: Expect,
    /// Whether the paper's own table bears it out; `silent` for a check of ours that does not say.
    pub paper_table: Option<PaperTable>,
    /// Whether it is about the machine (wall times) rather than the study. Judged apart from the results.
    #[serde(default)]
    pub circumstance: bool,
    /// What `plan --power` takes for the truth.
    pub power: Option<power::Assume>,
    /// Why this form, these cells or this margin, where the paper leaves it open.
    pub why: Option<String>,
}

/// Whose words a claim is in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Words {
    /// The paper's.
    Says(String),
    /// Our own: the paper does not say so.
    Ours(String),
}

impl Words {
    /// The key under which they stand.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Says(_) => "says",
            Self::Ours(_) => "ours",
        }
    }

    /// The words themselves.
    pub fn text(&self) -> &str {
        match self {
            Self::Says(text) | Self::Ours(text) => text,
        }
    }
}

impl Claim {
    /// Its words: the paper's where there are any. [`Claim::check`] refuses a claim with both or neither.
    pub fn words(&self) -> Words {
        match (&self.says, &self.ours) {
            (Some(says), _) => Words::Says(says.clone()),
            (None, ours) => Words::Ours(ours.clone().unwrap_or_default()),
        }
    }

    /// What the paper's own table shows of it.
    pub fn papers_table(&self) -> PaperTable {
        self.paper_table.unwrap_or(PaperTable::Silent)
    }
}

/// What the paper's own table shows of a claim: a statement of the manifest's author, never computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PaperTable {
    /// The printed numbers bear the claim out.
    Supports,
    /// The printed numbers speak against it.
    Contradicts,
    /// There are no printed numbers on it, or they decide nothing.
    Silent,
}

impl fmt::Display for PaperTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Supports => "supports",
            Self::Contradicts => "contradicts",
            Self::Silent => "silent",
        })
    }
}

#[cfg(test)]
mod tests;
