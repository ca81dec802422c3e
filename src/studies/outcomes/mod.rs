//! Outcomes and measures of whole trials by condition, of any study: what a manifest may ask to see of them, the cells, and
//! the charts made of them.

mod cells;
mod charts;
mod layout;

pub use cells::{Band, Estimate, OutcomeCell};
pub(super) use cells::{measured, published_share};

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
    /// A factor whose values every cell takes together: the cell also shows the band from 5 to 95 % of what each of them has by
    /// itself, and their median.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
}

/// How the ways in which trials ended add up to all of them, by condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct OutcomeShares {
    /// The factor whose values get rows.
    pub by: String,
    /// Factors whose values get panels of their own.
    #[serde(default)]
    pub rows: Vec<String>,
    /// Only trials of conditions with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
    /// The paper's own shares, to stand beside; none by default.
    #[serde(default)]
    pub published: Vec<PublishedShare>,
}

/// A share that the paper prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PublishedShare {
    /// Outcomes that it counts together.
    #[schemars(length(min = 1))]
    pub of: Vec<Outcome>,
    /// A key of `published`, in percent.
    pub table: String,
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

impl Quantity {
    /// Says what the cells are, with the unit.
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

    /// Returns the title of an axis along which it runs.
    pub fn axis_title(&self) -> String {
        let told = |measure: &str| measure.replace('-', " ");
        match self {
            Self::Share(outcomes) => {
                let names: Vec<_> = outcomes.iter().map(|o| o.name()).collect();
                format!("{} (% of trials)", names.join(" or "))
            }
            Self::Mean(measure) => {
                let units = [("-m-s", "m/s"), ("-s", "s"), ("-m", "m"), ("-rad", "rad")];
                let unit = units.iter().find_map(|(suffix, unit)| {
                    measure.strip_suffix(suffix).map(|name| format!("{} ({unit})", told(name)))
                });
                format!("{}, mean of trials", unit.unwrap_or_else(|| told(measure)))
            }
            Self::Percent(Percent { part, whole }) => {
                format!("{} (% of {})", told(part), told(whole))
            }
        }
    }

    /// Returns the measures of which it is made.
    pub fn measures(&self) -> Vec<&str> {
        match self {
            Self::Share(_) => Vec::new(),
            Self::Mean(measure) => vec![measure],
            Self::Percent(Percent { part, whole }) => vec![part, whole],
        }
    }
}
