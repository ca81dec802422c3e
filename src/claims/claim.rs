//! A claim as a manifest states it.

use super::assume::Assume;
use super::cells::{Values, Where};
use super::forms::Expect;
use super::words::{PaperTable, Words};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    pub power: Option<Assume>,
    /// Only trials of conditions with these factor values: the claim is judged as if no others had been run.
    #[serde(default, skip_serializing_if = "Where::is_all")]
    pub only: Where,
    /// Why this form, these cells or this margin, where the paper leaves it open.
    pub why: Option<String>,
}

impl Claim {
    /// Returns its words: the paper's where there are any. [`Claim::check`] refuses a claim with both or neither.
    pub fn words(&self) -> Words {
        match (&self.says, &self.ours) {
            (Some(says), _) => Words::Says(says.clone()),
            (None, ours) => Words::Ours(ours.clone().unwrap_or_default()),
        }
    }

    /// Returns the same claim judged in the conditions alone in which `factor` has the value `level`.
    #[must_use]
    pub fn within(&self, factor: &str, level: &str) -> Self {
        let mut claim = self.clone();
        claim.id = format!("{}-{level}", self.id);
        claim.only.0.insert(factor.to_owned(), Values::one(level));
        claim
    }

    /// Returns what the paper's own table shows of it.
    pub fn papers_table(&self) -> PaperTable {
        self.paper_table.unwrap_or(PaperTable::Silent)
    }
}
