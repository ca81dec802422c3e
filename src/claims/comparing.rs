//! Forms that hold cells against one another: `less`, `greater`, `equivalent`, `homogeneous`, `rank`, `trend`.

use super::cells::{ForEach, Than, Values, Where};
use super::terms::{
    Censored, Correction, Direction, Order, PerRun, Sides, Test, five_percent, ten,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `less`, `greater`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Comparison {
    /// What is measured; several metrics are several comparisons, unless `per-run` makes one number of them.
    pub metric: Values,
    /// How the metrics of one run become one number: coverages of one run are no independent measurements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per_run: Option<PerRun>,
    /// The first cell or pool.
    #[serde(default)]
    pub r#where: Where,
    /// The other side.
    pub than: Than,
    /// Repeated over these, on both sides.
    #[serde(default)]
    pub for_each: ForEach,
    /// Default: `fisher-exact` for shares, `welch` for measures.
    pub test: Option<Test>,
    /// Tails that count; `anova` and `chi-square` know both only.
    #[serde(default)]
    pub sides: Sides,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Over the comparisons of this claim.
    #[serde(default)]
    pub correction: Correction,
    /// How many of the comparisons must hold; default all.
    pub at_least: Option<usize>,
    /// Runs per cell (that reached the measure) without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// Effect and p of the first so many trials of each condition, to stand beside those of all: the paper's n.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub also_at_n: Option<u64>,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}

/// `equivalent`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Equivalence {
    /// What is measured.
    pub metric: Values,
    /// The first cell or pool.
    #[serde(default)]
    pub r#where: Where,
    /// The other side.
    pub to: Than,
    /// Repeated over these, on both sides.
    #[serde(default)]
    pub for_each: ForEach,
    /// Largest difference that still counts as equal, in the metric's unit (shares: 0.1 is ten points).
    pub margin: f64,
    /// Level of each of the two one-sided tests.
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

/// One step of a trend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Step {
    /// Where it stands along the trend.
    pub score: f64,
    /// The cell or pool there.
    pub r#where: Where,
}

/// `trend`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Trend {
    /// What is measured.
    pub metric: Values,
    /// Holds for every step.
    #[serde(default)]
    pub r#where: Where,
    /// Two or more steps with different scores.
    pub along: Vec<Step>,
    /// Which way.
    pub direction: Direction,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Default: `cochran-armitage` for shares, `spearman` for measures.
    pub test: Option<Test>,
    /// Tails that count.
    #[serde(default)]
    pub sides: Sides,
    /// Level of significance.
    #[serde(default = "five_percent")]
    pub alpha: f64,
    /// Over the comparisons of this claim.
    #[serde(default)]
    pub correction: Correction,
    /// How many of the comparisons must hold; default all.
    pub at_least: Option<usize>,
    /// Runs per step without which nothing is judged.
    #[serde(default = "ten")]
    pub minimum_n: u64,
    /// What becomes of runs that did not reach the measure.
    #[serde(default)]
    pub censored: Censored,
}

/// `homogeneous`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Homogeneity {
    /// What is measured.
    pub metric: Values,
    /// Holds for every cell.
    #[serde(default)]
    pub r#where: Where,
    /// The cells: every combination.
    pub across: Where,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// Largest difference between any two cells that still counts as equal.
    pub margin: f64,
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

/// `rank`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Ranking {
    /// What is measured.
    pub metric: Values,
    /// Holds for every cell.
    #[serde(default)]
    pub r#where: Where,
    /// One factor and the values that are ranked.
    pub across: Where,
    /// The order claimed.
    pub order: Order,
    /// Repeated over these.
    #[serde(default)]
    pub for_each: ForEach,
    /// As for `greater`.
    pub test: Option<Test>,
    /// Tails that count.
    #[serde(default)]
    pub sides: Sides,
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
