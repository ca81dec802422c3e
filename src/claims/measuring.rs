//! Forms that hold one quantity against bounds, itself elsewhere, or the paper: `between`, `share`, `spread`,
//! `sign-test`, `correlation-with-published`, `rmse-with-published`.

use super::cells::{ForEach, Values, Where};
use super::terms::{Censored, Correction, Pairs, Side, Sides, Statistic, five_percent, one, ten};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `between`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Level {
    /// What is measured.
    pub metric: Values,
    /// The cell or pool.
    #[serde(default)]
    pub r#where: Where,
    /// If given, the bounds are on `mean / mean of this cell - 1`.
    pub relative_to: Option<Where>,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Which number of the sample.
    #[serde(default)]
    pub statistic: Statistic,
    /// Lower bound, if any.
    pub low: Option<f64>,
    /// Upper bound, if any.
    pub high: Option<f64>,
    /// Level of each one-sided test.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Over the comparisons of this claim.
    #[serde(default)]
    pub correction: Correction,
    /// How many of the comparisons must hold; default all.
    pub at_least: Option<usize>,
    /// Runs per cell without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}

/// `sign-test`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SignTest {
    /// What is measured. Several metrics of one pair vote; a drawn vote is a tie.
    pub metric: Values,
    /// Which side the first cell lies on.
    pub direction: Side,
    /// The first of each pair.
    pub r#where: Where,
    /// The second of each pair.
    pub than: Where,
    /// The pairs, or with `pairs: trials` a restriction of them.
    #[serde(default)]
    pub for_each: ForEach,
    /// Pairs of cells (by their means or shares) or of trials.
    #[serde(default)]
    pub pairs: Pairs,
    /// Tails that count.
    #[serde(default)]
    pub sides: Sides,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Pairs that are not ties, without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure; with `pairs: trials`, `worst` ranks them behind.
    #[serde(default)]
    pub censored: Censored,
}

/// `spread`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Spread {
    /// What is measured.
    pub metric: Values,
    /// Holds for every cell.
    #[serde(default)]
    pub r#where: Where,
    /// The cells: every combination.
    pub across: Where,
    /// If given, the spread is below that of the cells with these factors replaced.
    pub than: Option<Where>,
    /// If given, the spread is at most this, in the metric's unit.
    pub at_most: Option<f64>,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Over the comparisons of this claim.
    #[serde(default)]
    pub correction: Correction,
    /// How many of the comparisons must hold; default all.
    pub at_least: Option<usize>,
    /// Runs per cell without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}

/// A condition on one trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct That {
    /// A measure; or `success`, `outcome:NAME`, which need no bound.
    pub metric: String,
    /// The measure is at least this.
    pub at_least: Option<f64>,
    /// The measure is at most this.
    pub at_most: Option<f64>,
}

/// `share`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Share {
    /// What a trial must meet to count.
    pub that: That,
    /// The cell or pool.
    #[serde(default)]
    pub r#where: Where,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Lower bound of the share, if any.
    pub low: Option<f64>,
    /// Upper bound of the share, if any.
    pub high: Option<f64>,
    /// Level of each one-sided test.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Over the comparisons of this claim.
    #[serde(default)]
    pub correction: Correction,
    /// How many of the comparisons must hold; default all.
    pub at_least: Option<usize>,
    /// Runs per cell without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
}

/// `correlation-with-published`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Correlation {
    /// What is measured; several where the published table has a `metric` column.
    pub metric: Values,
    /// Name of the published table.
    pub published: String,
    /// Published values times this are in the metric's unit (0.01 for percent).
    #[serde(default = "one")]
    pub scale: f64,
    /// Which of the published cells; default all.
    #[serde(default)]
    pub r#where: Where,
    /// If given, log ratios to the cell with these factors replaced are compared.
    pub ratio_to: Option<Where>,
    /// Spearman's correlation claimed.
    pub at_least: f64,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Published cells without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}

/// `rmse-with-published`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Rmse {
    /// What is measured; several where the published table has a `metric` column.
    pub metric: Values,
    /// Name of the published table.
    pub published: String,
    /// Published values times this are in the metric's unit (0.01 for percent).
    #[serde(default = "one")]
    pub scale: f64,
    /// Which of the published cells; default all.
    #[serde(default)]
    pub r#where: Where,
    /// Root mean square difference claimed, in the metric's unit.
    pub at_most: f64,
    /// Factors whose published means are the guess that skill is counted over.
    #[serde(default)]
    pub baseline: Vec<String>,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Published cells without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}
