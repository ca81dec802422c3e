//! Forms that hold one quantity against bounds, itself elsewhere, another of the same trials, or the paper:
//! `between`, `share`, `every`, `spread`, `sign-test`, `rate`, `correlation-with-published`, `rmse-with-published`.

use super::cells::{ForEach, Values, Where};
use super::terms::{Censored, Correction, Pairs, Side, Sides, Statistic, five_percent, one, ten};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

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
    pub at_least: Option<Bound>,
    /// The measure is at most this.
    pub at_most: Option<Bound>,
}

/// What a measure is held against: a number, or the value that a factor has in the trial's condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Bound {
    /// A number in the measure's unit.
    Number(f64),
    /// Name of a factor whose values are numbers in the measure's unit.
    Factor(String),
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Factor(name) => f.write_str(name),
        }
    }
}

impl fmt::Display for That {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.metric)?;
        if let Some(bound) = &self.at_least {
            write!(f, " >= {bound}")?;
        }
        if let Some(bound) = &self.at_most {
            write!(f, " <= {bound}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.metric)?;
        self.per.iter().try_for_each(|per| write!(f, " per {per}"))
    }
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

/// `untestable`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Untestable {
    /// Why nothing that is run could decide the claim.
    pub because: String,
}

/// `every`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Every {
    /// What each trial must meet.
    pub that: That,
    /// Which trials.
    #[serde(default)]
    pub r#where: Where,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Trials without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure; `reached-only` leaves them out.
    #[serde(default)]
    pub censored: Censored,
}

/// A quantity counted over trials: a sum, by default per trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Quantity {
    /// What is summed: a measure, or a share of trials.
    pub metric: String,
    /// What it is divided by; default the number of trials.
    pub per: Option<String>,
}

/// `rate`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Rate {
    /// The first quantity.
    pub of: Quantity,
    /// Which side it lies on.
    pub direction: Side,
    /// The second, of the same trials.
    pub than: Quantity,
    /// The cell or pool.
    #[serde(default)]
    pub r#where: Where,
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
    /// Trials without which nothing is judged.
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
    /// If given, log ratios to the cell with these factors replaced are compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio_to: Option<Where>,
    /// Root mean square difference claimed, in the metric's unit; with `ratio-to`, of the log ratios.
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
