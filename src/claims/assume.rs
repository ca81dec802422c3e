//! The truth that `plan --power` makes studies up from, as a claim states it.

use super::cells::Where;
use super::terms::one;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is taken for the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum Assume {
    /// The paper's cells, as printed.
    Published {
        /// Name of the published table.
        table: String,
        /// Published values times this are in the metric's unit.
        #[serde(default = "one")]
        scale: f64,
    },
    /// Values by cell; the first that matches a condition holds there.
    Cells(Vec<AssumedCell>),
}

/// A supposed truth in some conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct AssumedCell {
    /// Which conditions; default all.
    #[serde(default)]
    pub r#where: Where,
    /// Mean, or share in 0 to 1.
    pub value: f64,
    /// Standard deviation of one trial, for measures.
    pub sd: Option<f64>,
}
