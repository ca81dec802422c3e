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
    /// Returns whether it is a test of shares, and not of measures.
    pub(crate) fn is_of_shares(self) -> bool {
        matches!(self, Self::FisherExact | Self::ChiSquare | Self::CochranArmitage)
    }

    /// Returns the test's name in manifests and verdicts.
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

/// What all forms have in common, with the form's own defaults filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Terms {
    pub(crate) alpha: f64,
    pub(crate) correction: Correction,
    pub(crate) sides: Sides,
    pub(crate) test: Option<Test>,
    pub(crate) at_least: Option<usize>,
    pub(crate) minimum_n: u64,
    /// Runs that each single cell needs: `minimum_n`, or one where that counts pairs or cells.
    pub(crate) minimum_runs: u64,
    pub(crate) censored: Censored,
    /// The number of first trials of each condition for which effect and p are given as well.
    pub(crate) also_at_n: Option<u64>,
}

impl Default for Terms {
    /// Returns those of a form that says nothing: one estimate, tested as it is.
    fn default() -> Self {
        Self {
            alpha: five_percent(),
            correction: Correction::None,
            sides: Sides::One,
            test: None,
            at_least: None,
            minimum_n: 1,
            minimum_runs: 1,
            censored: Censored::Refuse,
            also_at_n: None,
        }
    }
}

pub(super) fn five_percent() -> f64 {
    0.05
}

/// Returns the trials (or pairs, or cells) without which nothing is judged.
pub(super) fn ten() -> u64 {
    10
}

pub(super) fn one() -> f64 {
    1.0
}
