//! Tables and figures that only a manifest of this study can ask for.

use crate::studies::FactorValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The policy from the start of a condition to the goal, on the graph of the whole building.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PolicyGraph {
    /// The first condition with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
    /// Local deadlines `t_d` (s) to plan for, each 0 or more; by default those that the schedule sets while time is ample, in the
    /// middle and scarce.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(inner(range(min = 0.0)))]
    pub within_s: Vec<f64>,
}

/// The six maneuvers: what the calibration expects of each, and what became of it in the study's own trials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ManeuverTable {
    /// Only trials of conditions with these factor values.
    #[serde(default, rename = "where")]
    pub only: BTreeMap<String, FactorValue>,
}
