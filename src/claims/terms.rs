//! Words that several forms of expectation share, and their defaults.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a difference is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// Fisher's exact test of two shares.
    FisherExact,
    /// Pearson's chi-square test of shares; two-sided.
    ChiSquare,
    /// Cochran-Armitage trend of shares.
    CochranArmitage,
    /// Welch's t test of two means.
    Welch,
    /// One-way analysis of variance of two means; two-sided.
    Anova,
    /// Mann-Whitney test of two samples.
    MannWhitney,
    /// Brown and Forsythe's test of two spreads: Student's test of the distances from each cell's median.
    BrownForsythe,
    /// Spearman's correlation with a permutation p-value.
    Spearman,
}

impl Test {
    /// The test's name in manifests and verdicts.
    pub fn name(self) -> &'static str {
        match self {
            Self::FisherExact => "fisher-exact",
            Self::ChiSquare => "chi-square",
            Self::CochranArmitage => "cochran-armitage",
            Self::Welch => "welch",
            Self::Anova => "anova",
            Self::MannWhitney => "mann-whitney",
            Self::BrownForsythe => "brown-forsythe",
            Self::Spearman => "spearman",
        }
    }
}

/// How several metrics of one run become one number, so that a run counts once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PerRun {
    /// Mean of the logarithms: differences of its means are log ratios, whatever the size of each metric.
    MeanLog,
    /// Logarithm of the first of two metrics over the second.
    LogRatio,
}

/// Which tails of a test count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// The tail on the side claimed.
    #[default]
    One,
    /// Both tails, and the difference on the side claimed.
    Two,
}

/// What keeps several comparisons in one claim honest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// Holm's step-down adjustment over the claim's comparisons.
    #[default]
    Holm,
    /// Every p-value as it is.
    None,
}

/// What becomes of runs that never reached a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Censored {
    /// One such run and the comparison cannot be tested.
    #[default]
    Refuse,
    /// Runs that reached it are compared; how many did is part of the verdict.
    ReachedOnly,
    /// They rank behind every run that reached it (`mann-whitney`, `median`, `p95`).
    Worst,
}

/// One side or the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The first is lower.
    Less,
    /// The first is higher.
    Greater,
}

/// Which way a trend goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Up with the score.
    Rising,
    /// Down with the score.
    Falling,
}

/// Which number of a sample is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Statistic {
    /// The mean, or the share.
    #[default]
    Mean,
    /// The median.
    Median,
    /// The 95th percentile.
    P95,
}

/// What a sign is taken of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Pairs {
    /// Two cells of each `for-each` combination.
    #[default]
    Cells,
    /// Two trials of the same number in conditions that differ only in the factors compared.
    Trials,
}

/// The order of cells across a factor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// This value has the highest metric.
    First(String),
    /// This value has the lowest metric.
    Last(String),
    /// Each of these is higher than the next.
    Descending(Vec<String>),
}

pub(super) fn five_percent() -> f64 {
    0.05
}

/// Trials (or pairs, or cells) without which nothing is judged.
pub(super) fn ten() -> u64 {
    10
}

pub(super) fn one() -> f64 {
    1.0
}
