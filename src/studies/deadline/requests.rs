//! What a manifest of this study may ask to see: shares, means and ratios by condition, as in Tables 1 and 2.

use crate::studies::{FactorValue, Outcome};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One quantity by condition, the values of a factor side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct OutcomeTable {
    /// What is shown.
    pub show: Quantity,
    /// The factor whose values stand side by side.
    pub by: String,
    /// Factors whose values get rows (in figures: groups) of their own.
    #[serde(default)]
    pub rows: Vec<String>,
    /// Only trials of conditions with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
    /// A key of `published`: the paper's own numbers, to stand beside.
    #[serde(default)]
    pub published: Option<String>,
}

/// A quantity of the trials of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Percent of the trials that ended in one of these ways, with Wilson's 95 % interval.
    Share(Vec<Outcome>),
    /// Mean of a measure over the trials that have it, with its standard deviation.
    Mean(String),
    /// Percent that one count is of another, both summed over the trials, with a 95 % interval that takes trials, not
    /// counts, for independent (Cochran 1977, section 2.11).
    Percent(Percent),
}

/// One count as a share of another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Percent {
    /// The measure that is a part.
    pub part: String,
    /// The measure that is the whole.
    pub whole: String,
}

/// The six maneuvers: what the calibration expects of each, and what became of it in the study's own trials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ManeuverTable {
    /// Only trials of conditions with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
}

impl Quantity {
    /// What the cells are, with the unit.
    pub fn describe(&self) -> String {
        match self {
            Self::Share(outcomes) => {
                let names: Vec<_> = outcomes.iter().map(|o| o.name()).collect();
                format!("trials that ended {} (%)", names.join(" or "))
            }
            Self::Mean(measure) => match measure.strip_suffix("-s") {
                Some(name) => format!("{name} (s), mean"),
                None => format!("{measure}, mean"),
            },
            Self::Percent(Percent { part, whole }) => format!("{part} per {whole} (%)"),
        }
    }

    /// The measures it is made of.
    pub fn measures(&self) -> Vec<&str> {
        match self {
            Self::Share(_) => Vec::new(),
            Self::Mean(measure) => vec![measure],
            Self::Percent(Percent { part, whole }) => vec![part, whole],
        }
    }
}
