//! Inference from ordinary trials: settings that a paper leaves open are factors of the manifest, every combination of them is run,
//! and a table of means that the paper prints says which of them explain it.
//!
//! Nothing is proposed and nothing stands in for the study: what is weighed are its own trials. What each of them showed is in the
//! records, so that every number of the tables follows from these ([`Answer`]).

mod checks;
mod columns;
mod likelihood;
mod posterior;
mod requests;
mod runs;
mod tables;
mod words;

pub use posterior::{Answer, Predicted};
pub use requests::{FromTrialsTable, Part};

use super::{Cells, HoldOut, LeftOut};
use crate::condition::Condition;
use serde::Serialize;

/// An inference from trials with everything settled.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FromTrials {
    /// The table that is to be explained.
    pub observed: Means,
    /// The settings that are not known, in the order written.
    pub choices: Vec<Choice>,
    /// What sampling does not explain of a cell and is its own: relative standard deviations, all as likely before.
    pub model_error: Vec<f64>,
    /// What it does not explain of all cells of an arm together, likewise: they are of the same runs.
    pub arm_error: Vec<f64>,
    /// What it does not explain of all cells of the table together, likewise: a world that is larger moves them all.
    pub table_error: Vec<f64>,
    /// Tables made by known combinations, to check the inference by; as many replicates of the printed one.
    pub simulated_tables: u32,
    /// Which parts of the table are held out in turn. The first holds out nothing.
    pub hold_outs: Vec<HoldOut>,
    /// Columns of the table by whose means a baseline predicts.
    pub baseline: Vec<String>,
}

/// A setting that is not known: a factor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Choice {
    /// The factor.
    pub name: String,
    /// Its values.
    pub values: Vec<String>,
    /// Which of them is the paper's own words, where one is.
    pub literal: Option<usize>,
    /// Why it is not known.
    pub why: Option<String>,
}

/// What sampling may leave unexplained: relative standard deviations, one of each kind.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ModelError {
    /// Of a cell by itself.
    cell: f64,
    /// Of all cells of an arm.
    arm: f64,
    /// Of all cells.
    table: f64,
}

impl FromTrials {
    /// Returns what sampling may leave unexplained: errors of cells, by what cells have in common.
    fn errors(&self) -> Vec<ModelError> {
        let mut errors = Vec::new();
        for table in &self.table_error {
            for arm in &self.arm_error {
                for cell in &self.model_error {
                    errors.push(ModelError { cell: *cell, arm: *arm, table: *table });
                }
            }
        }
        errors
    }
}

/// The table that is to be explained: means of trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Means {
    /// The columns that tell its cells apart.
    pub factors: Vec<String>,
    /// Its arms: the values of factors that runs have.
    pub arms: Vec<Condition>,
    /// The cells, in the order of the table.
    pub cells: Vec<PrintedMean>,
    /// What is left out, and why.
    pub left_out: Vec<LeftOut>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PrintedMean {
    /// Its values of the factors.
    pub levels: Vec<String>,
    /// The measure of trials that it is the mean of.
    pub measure: String,
    /// Its arm.
    pub arm: usize,
    /// The mean, above 0.
    pub mean: f64,
    /// The standard deviation of single trials, where it is printed.
    pub sd: Option<f64>,
    /// How many trials it is of.
    pub n: f64,
    /// Whether it is left out.
    pub left_out: bool,
}

impl Cells for Means {
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

impl Means {
    /// The name of the hold-out by one arm at a time.
    pub const ARM: &str = "arm";

    /// Returns one part for every arm.
    pub fn by_arm(&self) -> Vec<HoldOut> {
        let part = |(index, arm): (usize, &Condition)| {
            let values: Vec<&str> = arm.iter().map(|(_, value)| value.as_str()).collect();
            HoldOut {
                kind: Self::ARM.to_owned(),
                name: values.join(", "),
                held: self.cells.iter().map(|cell| cell.arm == index).collect(),
            }
        };
        self.arms.iter().enumerate().map(part).collect()
    }
}

#[cfg(test)]
mod tests;
