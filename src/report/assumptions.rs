//! What the paper leaves open: every choice with its reason, the values it was tried at, and the verdicts that hang on it.

use super::content::{Assumption, FlipRow, Tried};
use crate::claims::Sensitivity;
use crate::claims::sensitivity::in_words;
use crate::manifest::Experiment;
use serde_json::Value;

/// Returns the assumptions of `experiment`, each with what became of the claims at the other values of its range.
pub(super) fn assumptions(experiment: &Experiment) -> Vec<Assumption> {
    let row = |assumption: &crate::manifest::Assumption| Assumption {
        path: assumption.path.clone(),
        value: told(&assumption.value),
        why: assumption.why.clone(),
        range: assumption.range.iter().map(in_words).collect(),
        tried: experiment.sensitivity.as_ref().and_then(|found| tried(&found.table, assumption)),
    };
    experiment.assumptions.iter().map(row).collect()
}

/// Returns what `found` says about `assumption` at the value it has; `None` where it says nothing.
fn tried(found: &Sensitivity, assumption: &crate::manifest::Assumption) -> Option<Vec<Tried>> {
    let chosen = in_words(&assumption.value);
    let attempts = found.attempts();
    let of_it = attempts.iter().filter(|a| a.setting == assumption.path && a.chosen == chosen);
    let tried = of_it.map(|attempt| {
        let flip = |flip: crate::claims::sensitivity::Flip| FlipRow {
            claim: flip.claim,
            from: flip.from.to_string(),
            to: flip.to.to_string(),
        };
        let flips = found.flips(attempt).into_iter().map(flip).collect();
        Tried { at: attempt.tried.clone(), flips }
    });
    Some(tried.collect::<Vec<_>>()).filter(|tried| !tried.is_empty())
}

/// Returns in words how the values were tried.
pub(super) fn tried_with(experiment: &Experiment) -> Option<String> {
    let attempts = experiment.sensitivity.as_ref()?.table.attempts();
    let trials = attempts.iter().map(|attempt| attempt.trials).min()?;
    let plural = if trials == 1 { "" } else { "s" };
    Some(format!(
        "{trials} trial{plural} per condition, at the chosen value too, one setting at a time with the same noise"
    ))
}

/// Writes a value as one would say it; one that depends on a factor as `17.5 for department-south, 5.6 for house`.
fn told(value: &Value) -> String {
    let Some(values) = value.get("by").and(value.get("values")).and_then(Value::as_object) else {
        return in_words(value);
    };
    let mut words: Vec<String> =
        values.iter().map(|(level, value)| format!("{} for {level}", told(value))).collect();
    if let Some(otherwise) = value.get("otherwise").filter(|otherwise| !otherwise.is_null()) {
        words.push(format!("{} otherwise", told(otherwise)));
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_that_depend_on_a_factor_are_told_level_by_level() {
        assert_eq!(told(&json!("nearest")), "nearest");
        assert_eq!(told(&json!(0.25)), "0.25");
        let by = json!({"by": "start", "values": {"A": 60, "B": {"by": "prior", "values": {"none": 1}}}, "otherwise": 15});
        assert_eq!(told(&by), "60 for A, 1 for none for B, 15 otherwise");
    }
}
