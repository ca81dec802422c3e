//! The paper's own numbers, as manifests keep them.
//!
//! A published table is tidy: one row per printed number. Columns, in any order: factors by the manifest's
//! names (a factor that is not a column is pooled), `value`, and where the paper prints them `sd` (sample
//! standard deviation, in the unit of `value`), `n` (runs), `metric` (the claim's metric name, where one
//! table holds several) and `coverage-percent`: a row at 70 then speaks of the metric that ends in `-at-70`,
//! so that `distance-m-at-70` is found in a table of distances. Other columns (`note`, `page`) are for readers and are ignored. An empty `value` is
//! a number the paper does not print.

use super::cells::{Values, Where};
use crate::factor::Factor;
use crate::table::{Table, Value};
use std::collections::BTreeMap;
use thiserror::Error;

/// One printed number.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedCell {
    /// The factor values of its row.
    pub pins: BTreeMap<String, String>,
    /// Metric of its row, where the table says.
    pub metric: Option<String>,
    /// Coverage of its row (percent), where the table says.
    pub coverage: Option<String>,
    /// The number, in the table's unit; `None` where the paper prints none.
    pub value: Option<f64>,
    /// Its sample standard deviation.
    pub sd: Option<f64>,
    /// Its runs.
    pub n: Option<u64>,
}

impl PublishedCell {
    /// Returns whether the number is one of `metric`.
    pub fn speaks_of(&self, metric: &str) -> bool {
        let (quantity, coverage) = match &self.coverage {
            None => (metric, None),
            Some(_) => match metric.rsplit_once("-at-") {
                Some((quantity, coverage)) => (quantity, Some(coverage)),
                None => return false,
            },
        };
        let named = |m: &String| m == quantity || m == metric;
        coverage == self.coverage.as_deref() && self.metric.as_ref().is_none_or(named)
    }
}

/// Why a published table cannot be read. Rows are counted from 1, without the header.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PublishedTableError {
    /// It has no column of values.
    #[error("no column `value` (there are {0})")]
    NoValues(String),
    /// A number is something else.
    #[error("row {row}: `{column}` is `{found}`, expected a number")]
    NotANumber {
        /// The row.
        row: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        found: String,
    },
    /// A number of runs is no positive whole number.
    #[error("row {row}: `n` is `{found}`, expected runs")]
    NotRuns {
        /// The row.
        row: usize,
        /// What stands there.
        found: String,
    },
    /// Two rows are of the same cell.
    #[error("rows {first} and {second} speak of the same cell")]
    SameCell {
        /// The first of them.
        first: usize,
        /// The second.
        second: usize,
    },
}

/// Reads the rows of a published table over the factors `factors`.
///
/// # Errors
/// Where there is no `value` column, a number is no number, or two rows speak of one cell.
pub fn read(table: &Table, factors: &[String]) -> Result<Vec<PublishedCell>, PublishedTableError> {
    if table.column("value").is_none() {
        return Err(PublishedTableError::NoValues(table.columns.join(", ")));
    }
    let mut cells: Vec<PublishedCell> = Vec::new();
    for (i, row) in table.rows.iter().enumerate() {
        let number = |name: &str| match table.value(row, name) {
            Value::Missing => Ok(None),
            value => value.as_f64().map(Some).ok_or_else(|| PublishedTableError::NotANumber {
                row: i + 1,
                column: name.to_owned(),
                found: value.to_string(),
            }),
        };
        let n = match table.value(row, "n") {
            Value::Missing => None,
            Value::Integer(n) if *n > 0 => Some(n.unsigned_abs()),
            other => {
                return Err(PublishedTableError::NotRuns { row: i + 1, found: other.to_string() });
            }
        };
        let metric = match table.value(row, "metric") {
            Value::Missing => None,
            name => Some(name.to_string()),
        };
        let coverage = match table.value(row, "coverage-percent") {
            Value::Missing => None,
            percent => Some(percent.to_string()),
        };
        let pins: BTreeMap<String, String> = factors
            .iter()
            .filter(|factor| table.column(factor).is_some())
            .filter(|factor| *table.value(row, factor) != Value::Missing)
            .map(|factor| (factor.clone(), table.value(row, factor).to_string()))
            .collect();
        let same =
            |c: &PublishedCell| c.pins == pins && c.metric == metric && c.coverage == coverage;
        if let Some(first) = cells.iter().position(same) {
            return Err(PublishedTableError::SameCell { first: first + 1, second: i + 1 });
        }
        let (value, sd) = (number("value")?, number("sd")?);
        cells.push(PublishedCell { pins, metric, coverage, value, sd, n });
    }
    Ok(cells)
}

/// Returns the faults of the published table `name`, for `check`: those of [`read`] and values no factor has.
pub fn check_table(name: &str, table: &Table, factors: &[Factor]) -> Vec<String> {
    let names: Vec<String> = factors.iter().map(|factor| factor.name.clone()).collect();
    let cells = match read(table, &names) {
        Ok(cells) => cells,
        Err(fault) => return vec![format!("published table `{name}`: {fault}")],
    };
    let mut problems = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        for (factor, value) in &cell.pins {
            let known = factors.iter().find(|known| known.name == *factor);
            if known.is_some_and(|known| !known.values.contains(value)) {
                problems.push(format!(
                    "published table `{name}`: row {}: factor `{factor}` has no value `{value}`",
                    i + 1
                ));
            }
        }
    }
    problems
}

/// Returns the selection of a row's trials.
pub(super) fn selection(pins: &BTreeMap<String, String>) -> Where {
    Where(pins.iter().map(|(f, v)| (f.clone(), Values::one(v.clone()))).collect())
}
