//! Tables and figures in the paper's layout that a manifest of this study can ask for.

use crate::studies::FactorValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Mean and standard deviation of a metric at levels of coverage, and differences to a baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct CoverageTable {
    /// What is tabulated.
    pub metric: Metric,
    /// Levels of coverage (percent): multiples of 5 from 50 to 95.
    #[schemars(length(min = 1))]
    pub at: Vec<u32>,
    /// The factor whose values stand side by side.
    pub by: String,
    /// The value of `by` that the others are compared with.
    #[serde(default)]
    pub baseline: Option<FactorValue>,
    /// Factors whose values get rows of their own.
    #[serde(default)]
    pub rows: Vec<String>,
    /// A key of `published`: the paper's own numbers, to stand beside.
    #[serde(default)]
    pub published: Option<String>,
    /// Whether each cell tells how it differs from its baseline: effect, and p at all runs and at the paper's number.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tests: bool,
}

/// How coverage tables agree with the paper's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct AgreementTable {
    /// Ids of the coverage tables, each with a `baseline` and `published` numbers.
    #[schemars(length(min = 1))]
    pub tables: Vec<String>,
}

/// Which reading explains the paper's coverage tables: what each leaves of a cell unexplained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ReadingsTable {
    /// Ids of the coverage tables, each with a `baseline` and `published` numbers and with `by` among its rows.
    #[schemars(length(min = 1))]
    pub tables: Vec<String>,
    /// The factor whose values are readings of the paper.
    pub by: String,
    /// Factors of the tables' rows for each of whose values readings are compared besides the whole.
    #[serde(default)]
    pub within: Vec<String>,
    /// Only cells with these factor values.
    #[serde(default, rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    pub only: BTreeMap<String, FactorValue>,
}

/// Mean and standard deviation of whole trials' measures, side by side, one row for every cell that was run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct MeasuresTable {
    /// Measures of trials, as columns of `results/trials.csv`: `distance-m`, `coverage-percent-at-239-m`; or the least of one
    /// over the trials of a cell: `least:distance-m`.
    #[schemars(length(min = 1))]
    pub measures: Vec<String>,
    /// Factors whose values get rows of their own; trials that differ in other factors are one cell.
    #[schemars(length(min = 1))]
    pub rows: Vec<String>,
    /// A key of `published`, a file with a column `measure`: the paper's own numbers, to stand beside.
    #[serde(default)]
    pub published: Option<String>,
}

/// What each choice moves: effects of factors' levels on a metric, over matched conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct EffectsTable {
    /// What is moved.
    pub metric: Metric,
    /// Levels of coverage (percent): multiples of 5 from 50 to 95.
    #[schemars(length(min = 1))]
    pub at: Vec<u32>,
    /// The factors whose levels are compared, each with the factor's first level.
    #[schemars(length(min = 1))]
    pub factors: Vec<String>,
    /// Factors for each combination of whose values effects are told apart.
    #[serde(default)]
    pub within: Vec<String>,
    /// A key of `published`: the paper's own numbers, to tell how far the first level is from them.
    #[serde(default)]
    pub published: Option<String>,
}

/// What a trial's progress is measured in.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Distance travelled (m).
    DistanceM,
    /// Simulated time (s).
    TimeS,
}

impl Metric {
    /// Returns the name in manifests, tables and records, with its unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::DistanceM => "distance-m",
            Self::TimeS => "time-s",
        }
    }

    /// Returns the measure of a trial record that holds this metric at `percent` of coverage.
    pub fn measure_at(self, percent: u32) -> String {
        format!("{}-at-{percent}", self.name())
    }
}

/// Mean coverage over time or distance, one curve per value of a factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct CoverageCurve {
    /// What runs along the horizontal axis.
    pub against: Metric,
    /// The factor that has one curve per value.
    pub by: String,
    /// Only trials of conditions with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
}

/// The building of a condition from above, with its dimensions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PlanFigure {
    /// The first condition with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
    /// Layers that are drawn as red crosses, such as closed doors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub crossed: Vec<String>,
}
