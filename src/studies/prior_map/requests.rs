//! What a manifest of this study may ask to see: tables and figures in the paper's layout.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// One table to produce.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TableRequest {
    /// Name of its file: lower-case letters, digits and hyphens, unique.
    pub id: String,
    /// Its title.
    #[serde(default)]
    pub title: String,
    /// Mean and standard deviation of a metric at levels of coverage, as in Tables 1 to 10.
    pub coverage_table: CoverageTable,
}

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
    /// The name in manifests, tables and records, with its unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::DistanceM => "distance-m",
            Self::TimeS => "time-s",
        }
    }

    /// The measure of a trial record that holds this metric at `percent` of coverage.
    pub fn measure_at(self, percent: u32) -> String {
        format!("{}-at-{percent}", self.name())
    }
}

/// One figure to produce.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FigureRequest {
    /// Name of its file: lower-case letters, digits and hyphens, unique.
    pub id: String,
    /// Its title.
    #[serde(default)]
    pub title: String,
    /// Coverage over time or distance, one curve per value of a factor, as in Figure 4.
    pub coverage_curve: CoverageCurve,
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

/// A factor's value as text, whatever scalar it was written as: `0.50` is `0.5`, `true` is `true`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct FactorValue(pub String);

impl std::fmt::Display for FactorValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for FactorValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Scalar;
        impl de::Visitor<'_> for Scalar {
            type Value = FactorValue;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, text, `true` or `false`")
            }
            fn visit_bool<E: de::Error>(self, value: bool) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<FactorValue, E> {
                Ok(FactorValue(if value == 0.0 { 0.0 } else { value }.to_string()))
            }
            fn visit_str<E: de::Error>(self, value: &str) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_owned()))
            }
        }
        deserializer.deserialize_any(Scalar)
    }
}

impl JsonSchema for FactorValue {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "FactorValue".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": ["string", "number", "boolean"] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_however_it_is_written() {
        let read = |json: &str| serde_json::from_str::<FactorValue>(json).unwrap().0;
        assert_eq!(
            ["0.50", "5e-1", "-0.0", "7", "true", "\"x\""].map(read),
            ["0.5", "0.5", "0", "7", "true", "x"]
        );
    }

    #[test]
    fn requests_survive_a_round_trip() {
        let json = serde_json::json!({
            "id": "figure-4", "title": "", "coverage-curve":
            {"against": "time-s", "by": "prior", "where": {"furnished": "false"}}
        });
        let request: FigureRequest = serde_json::from_value(json.clone()).unwrap();
        assert_eq!(serde_json::to_value(request).unwrap(), json);
        assert_eq!(Metric::DistanceM.measure_at(70), "distance-m-at-70");
    }
}
