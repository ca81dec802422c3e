//! What readers see in the place of a factor's name and of its values.
//!
//! Files for programs (records, CSV, JSON) keep names and values as the manifest writes them; tables for readers, figures, pages
//! and titles show labels.

use crate::condition::Condition;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Labels of factors, by their names.
///
/// ```
/// use reenact::condition::Condition;
/// use reenact::labels::Labels;
///
/// let labels: Labels = serde_json::from_str(r#"{"furnished": {"values": {"false": "unfurnished"}}}"#).unwrap();
/// let cell = Condition::from([("environment", "basic"), ("furnished", "false")]);
/// assert_eq!(labels.values(&cell), ["basic", "unfurnished"]);
/// assert_eq!(labels.condition(&cell), "environment basic, unfurnished");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Labels(BTreeMap<String, FactorLabels>);

/// Labels of a factor and of its values.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FactorLabels {
    /// What readers see in the place of the factor's name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What readers see in the place of a value; values that are not named here are shown as they are.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<String, String>,
}

/// No labels at all.
pub static NONE: Labels = Labels(BTreeMap::new());

/// Units that the name of a factor may end in, and how they are written.
const UNITS: [(&str, &str); 5] =
    [("-m-s", "m/s"), ("-s", "s"), ("-m", "m"), ("-deg", "°"), ("-percent", "%")];

impl Labels {
    /// Returns whether nothing has a label.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns every factor that has labels, by its name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &FactorLabels)> {
        self.0.iter().map(|(factor, labels)| (factor.as_str(), labels))
    }

    /// Returns what stands for the factor `name`.
    pub fn factor<'a>(&'a self, name: &'a str) -> &'a str {
        self.0.get(name).and_then(|labels| labels.name.as_deref()).unwrap_or(name)
    }

    /// Returns what stands for several factors.
    pub fn factors(&self, names: &[String]) -> Vec<String> {
        names.iter().map(|name| self.factor(name).to_owned()).collect()
    }

    /// Returns what stands for `value` of `factor`.
    pub fn value<'a>(&'a self, factor: &str, value: &'a str) -> &'a str {
        self.label(factor, value).unwrap_or(value)
    }

    /// Returns what stands for every value of `condition`.
    pub fn values(&self, condition: &Condition) -> Vec<String> {
        condition.iter().map(|(factor, value)| self.value(factor, value).to_owned()).collect()
    }

    /// Returns a value in words. Where the factor's values have labels, they say themselves what they are; else the factor and
    /// the value, with the unit that the factor's name ends in (`deadline 680 s`, `prior none`).
    pub fn in_words(&self, factor: &str, value: &str) -> String {
        let own = self.0.get(factor);
        if own.is_some_and(|labels| !labels.values.is_empty()) {
            return self.value(factor, value).to_owned();
        }
        if let Some(name) = own.and_then(|labels| labels.name.as_deref()) {
            // `deadline (s)` heads a column of numbers; in words the unit comes behind the number.
            let with_unit = name.strip_suffix(')').and_then(|name| name.rsplit_once(" ("));
            return match with_unit {
                Some((name, unit)) => format!("{name} {value} {unit}"),
                None => format!("{name} {value}"),
            };
        }
        for (suffix, unit) in UNITS {
            if let Some(name) = factor.strip_suffix(suffix)
                && value.parse::<f64>().is_ok()
            {
                return format!("{} {value} {unit}", name.replace('-', " "));
            }
        }
        format!("{} {value}", factor.replace('-', " "))
    }

    /// Returns `condition` in words: each value after the other, `all` where there is no factor.
    pub fn condition(&self, condition: &Condition) -> String {
        let words: Vec<String> =
            condition.iter().map(|(factor, value)| self.in_words(factor, value)).collect();
        if words.is_empty() { "all".to_owned() } else { words.join(", ") }
    }

    /// Returns the title of a trial of `condition`: `no prior, trial 3`; `None` where nothing has a label.
    pub fn title(&self, condition: &Condition, trial: u32) -> Option<String> {
        (!self.is_empty()).then(|| format!("{}, trial {trial}", self.condition(condition)))
    }

    /// Returns the label of `value` of `factor`, where it has one.
    pub fn label(&self, factor: &str, value: &str) -> Option<&str> {
        self.0.get(factor)?.values.get(value).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_label_is_told_by_factor_and_value_with_the_unit() {
        let told = [
            ("deadline-s", "68"),
            ("node-noise-m", "0.5"),
            ("prior", "none"),
            ("ray-stop", "even"),
        ]
        .map(|(factor, value)| NONE.in_words(factor, value));
        assert_eq!(told, ["deadline 68 s", "node noise 0.5 m", "prior none", "ray stop even"]);
    }

    #[test]
    fn labels_stand_for_factors_and_values() {
        let labels: Labels = serde_json::from_str(
            r#"{"prior": {"name": "prior knowledge", "values": {"floor-plan": "floor plan"}}}"#,
        )
        .unwrap();
        assert_eq!(labels.factor("prior"), "prior knowledge");
        assert_eq!(labels.factor("start"), "start");
        assert_eq!(labels.value("prior", "floor-plan"), "floor plan");
        assert_eq!(labels.value("prior", "none"), "none");
        assert_eq!(labels.in_words("prior", "floor-plan"), "floor plan");
        assert_eq!(labels.in_words("prior", "none"), "none", "beside values with labels");
        let named = |name: &str| {
            serde_json::from_str::<Labels>(&format!(r#"{{"limit": {{"name": "{name}"}}}}"#))
                .unwrap()
        };
        assert_eq!(named("time limit (s)").in_words("limit", "68"), "time limit 68 s");
        assert_eq!(named("time limit").in_words("limit", "68"), "time limit 68");
        assert_eq!(labels.condition(&Condition::default()), "all");
        let cell = Condition::from([("prior", "floor-plan"), ("start", "A")]);
        assert_eq!(labels.title(&cell, 3).as_deref(), Some("floor plan, start A, trial 3"));
        assert_eq!(NONE.title(&cell, 3), None);
    }
}
