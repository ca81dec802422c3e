//! What was asked, as paths and values: any study's resolved JSON, without knowing which study it is.

use crate::json::{self, AsWritten};
use crate::plan::{ResolvedStudy, StudyCondition};
use serde_json::Value;
use std::collections::BTreeMap;

/// Values by their paths (`parameters.sensing.range-m`).
pub(super) type Values = BTreeMap<String, Value>;

/// The resolved study in lines that can be compared.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// What holds for the study as a whole.
    pub study: BTreeMap<String, Value>,
    /// What the trials of each condition are run with, by its slug.
    pub conditions: BTreeMap<String, BTreeMap<String, Value>>,
}

/// What of the whole study moves trials, and so belongs in a lock; the rest is words, and what is made of trials.
const OF_TRIALS: [&str; 5] = ["study", "seed", "shared-noise", "trials", "overrides"];

impl Settings {
    /// Reads the settings of the resolved study `resolved` (`study` in `study.resolved.json`).
    pub fn of(resolved: &ResolvedStudy) -> Self {
        let mut settings = Self::default();
        // Compared apart from settings: digests of inputs, the engine, and what only names the document.
        let rest = ResolvedStudy {
            reenact: AsWritten::default(),
            engine_version: AsWritten::default(),
            name: AsWritten::default(),
            inputs: AsWritten::default(),
            conditions: AsWritten::default(),
            ..resolved.clone()
        };
        flatten_each(&json::value_of(&rest), &mut settings.study);
        for condition in resolved.conditions.read().unwrap_or_default() {
            let Ok(slug) = condition.slug.read() else { continue };
            let values = settings.conditions.entry(slug).or_default();
            let rest = StudyCondition {
                slug: AsWritten::default(),
                condition: AsWritten::default(),
                ..condition
            };
            flatten_each(&json::value_of(&rest), values);
        }
        settings
    }

    /// Returns the same without what cannot move a trial.
    #[must_use]
    pub fn of_trials(&self) -> Self {
        let moves = |path: &String| OF_TRIALS.contains(&path.split('.').next().unwrap_or_default());
        let study = self.study.iter().filter(|(path, _)| moves(path));
        Self {
            study: study.map(|(path, value)| (path.clone(), value.clone())).collect(),
            conditions: self.conditions.clone(),
        }
    }

    /// Returns what is the same in every condition.
    pub(super) fn shared(&self) -> Values {
        let mut conditions = self.conditions.values();
        let mut shared = conditions.next().cloned().unwrap_or_default();
        for values in conditions {
            shared.retain(|path, value| values.get(path).is_some_and(|other| same(other, value)));
        }
        shared
    }
}

/// Returns whether two values have the same canonical text: `1` and `1.0` are one number.
pub(super) fn same(a: &Value, b: &Value) -> bool {
    a == b || json::canonical(a) == json::canonical(b)
}

/// Flattens every entry of `value` under its own key.
fn flatten_each(value: &Value, into: &mut Values) {
    for (key, value) in value.as_object().into_iter().flatten() {
        flatten(key, value, into);
    }
}

/// Adds one path a leaf. Items of a list are named by what identifies them, so that one more in the middle is one change.
fn flatten(path: &str, value: &Value, into: &mut Values) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            for (key, value) in map {
                flatten(&format!("{path}.{key}"), value, into);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            let named = ["id", "name", "path", "slug"].into_iter().find_map(|key| {
                let names: Vec<&str> = items.iter().filter_map(|item| item[key].as_str()).collect();
                let mut unique = names.clone();
                unique.sort_unstable();
                unique.dedup();
                (unique.len() == items.len()).then_some(names)
            });
            for (i, item) in items.iter().enumerate() {
                let step = named.as_ref().map_or_else(|| i.to_string(), |n| n[i].to_owned());
                flatten(&format!("{path}.{step}"), item, into);
            }
        }
        leaf => {
            into.insert(path.to_owned(), leaf.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_study_is_paths_and_values_and_lists_are_named() {
        let document = json!({
            "engine-version": "1", "inputs": [{"as-written": "a"}], "seed": 7, "title": "T", "shared-noise": ["a", "b"],
            "claims": [{"id": "D1", "says": "x"}, {"id": "D2", "says": "y"}], "tables": [{"by": 1}, {"by": 2}],
            "conditions": [
                {"slug": "none", "condition": {"p": "none"}, "parameters": {"range-m": 9, "n": {}}, "prior": null},
                {"slug": "plan", "condition": {"p": "plan"}, "parameters": {"range-m": 9.0, "n": {}}, "prior": "x"},
            ],
        });
        let settings = Settings::of(&serde_json::from_value(document).unwrap());
        let shown = |values: &Values| {
            values
                .iter()
                .map(|(path, value)| format!("{path}={value}"))
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(
            shown(&settings.study),
            "claims.D1.id=\"D1\" claims.D1.says=\"x\" claims.D2.id=\"D2\" claims.D2.says=\"y\" seed=7 \
             shared-noise=[\"a\",\"b\"] tables.0.by=1 tables.1.by=2 title=\"T\""
        );
        assert_eq!(shown(&settings.shared()), "parameters.n={} parameters.range-m=9");
        assert_eq!(
            shown(&settings.conditions["plan"]),
            "parameters.n={} parameters.range-m=9.0 prior=\"x\""
        );
        assert_eq!(shown(&settings.of_trials().study), "seed=7 shared-noise=[\"a\",\"b\"]");
    }
}
