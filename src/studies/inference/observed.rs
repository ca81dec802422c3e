//! The table that is to be explained: counts of three outcomes in every cell.

use super::Cells;
use serde::Serialize;

/// Counts by cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Observed {
    /// Names of the two outcomes that are counted; whatever else happens is the third.
    pub outcomes: [String; 2],
    /// The columns that tell cells apart.
    pub factors: Vec<String>,
    /// The cells, in the order of the table.
    pub cells: Vec<ObservedCell>,
    /// What is left out, and why.
    pub left_out: Vec<LeftOut>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ObservedCell {
    /// Its values of the factors.
    pub levels: Vec<String>,
    /// How many trials ended in the first outcome, the second, and otherwise.
    pub counts: [u32; 3],
    /// The mean time (s) of those that ended in the first, where it is learned from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Whether it is left out.
    pub left_out: bool,
}

/// What a table prints in one cell, the observed one or one that was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    /// How many trials ended in the first outcome, the second, and otherwise.
    pub counts: [u32; 3],
    /// The mean time (s) of those that ended in the first, where it is learned from.
    pub time_s: Option<f64>,
}

/// Cells that are left out by declaration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LeftOut {
    /// Their values of factors.
    #[serde(rename = "where")]
    pub only: Vec<(String, String)>,
    /// Why.
    pub why: String,
}

impl ObservedCell {
    /// Returns what is printed in it.
    pub fn printed(&self) -> Printed {
        Printed { counts: self.counts, time_s: self.time_s }
    }

    /// Returns how many trials there were.
    pub fn trials(&self) -> u32 {
        self.counts.iter().sum()
    }

    /// Returns the share of the first outcome (%).
    pub fn percent(&self) -> f64 {
        100.0 * f64::from(self.counts[0]) / f64::from(self.trials().max(1))
    }

    /// Returns its name: `C, 563, random`.
    pub fn name(&self) -> String {
        self.levels.join(", ")
    }
}

impl Cells for Observed {
    fn factors(&self) -> &[String] {
        &self.factors
    }

    fn count(&self) -> usize {
        self.cells.len()
    }

    fn levels_at(&self, index: usize) -> &[String] {
        &self.cells[index].levels
    }

    fn is_left_out(&self, index: usize) -> bool {
        self.cells[index].left_out
    }
}
