//! What identifies a trial.
//!
//! [`key_content`] is the documented content; the [`TrialKey`] is the SHA-256 of its canonical JSON. Paths,
//! comments, order of keys, layouts of files and the number of trials planned are not part of it: a trial that
//! means the same has the same key, whoever planned it.

use super::resolved::ResolvedStudy;
use crate::condition::Condition;
use crate::digest::{Hasher, Sha256Digest, StudyDigest, TrialKey};
use crate::json;
use crate::manifest::{Experiment, Meanings};
use crate::studies::{Setup, StudyKind, TrialSpec};
use serde_json::{Map, Value, json};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Version of everything that turns a trial's content into its bytes, whatever its study. Raised whenever any trial's record
/// changes; the golden digests in `tests/` fail when that is forgotten. Where only one study's trials change, its revision
/// ([`Study::revision`](crate::studies::Study::revision)) is raised instead, and what the others yielded stays good.
pub const ENGINE_VERSION: &str = "2";

/// Returns the version of what turns the content of a trial of `kind` into its bytes: [`ENGINE_VERSION`] with the study's
/// revision, `2.1`; without it where it has none.
pub fn engine_version(kind: StudyKind) -> String {
    match kind.revision() {
        0 => ENGINE_VERSION.to_owned(),
        revision => format!("{ENGINE_VERSION}.{revision}"),
    }
}

/// The key that holds the number of the trial.
const TRIAL: &str = "trial";

/// Returns the content of a trial's key.
///
/// | field | holds |
/// |---|---|
/// | `engine-version` | [`engine_version`] of the study |
/// | `study` | the study's kind |
/// | `seed` | the experiment's seed |
/// | `shared-noise` | the factors that share noise, sorted |
/// | `condition` | factor to value |
/// | `trial` | number within the condition, from 0 |
/// | `robot`, `world`, `prior` | digests of what they mean; `prior` is `null` where there is none |
/// | `start` | x (m), y (m), heading (rad) |
/// | `parameters` | the study's parameters, defaults written out but for those of parameters that came later |
/// | `maneuvers` | deadline study: the calibrated times and failure probabilities that its planner uses |
pub fn key_content(
    kind: StudyKind,
    seed: u64,
    shared_noise: &[String],
    condition: &Condition,
    trial: u32,
    setup: &Setup,
    meanings: &Meanings,
) -> Value {
    let start = setup.start();
    let mut shared: Vec<&String> = shared_noise.iter().collect();
    shared.sort();
    let mut content = json!({
        "engine-version": engine_version(kind),
        "study": kind.name(),
        "seed": seed,
        "shared-noise": shared,
        "condition": levels(condition),
        TRIAL: trial,
        "robot": meanings.robot,
        "world": meanings.world,
        "prior": meanings.prior,
        "start": [start.x, start.y, start.heading],
        "parameters": setup.parameters(),
    });
    if let Value::Object(content) = &mut content {
        content.extend(setup.further());
    }
    content
}

/// Returns the value of every factor, by its name.
pub(super) fn levels(condition: &Condition) -> BTreeMap<String, String> {
    condition.iter().cloned().collect()
}

/// The keys of the trials of one condition: what their contents have in common is written and hashed once.
pub(super) struct Keys {
    /// Fed with the canonical JSON up to the number of the trial.
    before: Hasher,
    /// What follows the number.
    after: String,
}

impl Keys {
    /// Begins the keys of contents that are `content` but for the number of the trial.
    pub(super) fn of(content: Value) -> Self {
        let (mut first, mut last) = (Map::new(), Map::new());
        if let Value::Object(content) = content {
            for (name, value) in content {
                match name.as_str().cmp(TRIAL) {
                    Ordering::Less => first.insert(name, value),
                    Ordering::Equal => None,
                    Ordering::Greater => last.insert(name, value),
                };
            }
        }
        // Canonical JSON has its keys in order: two objects, joined in the middle.
        let (first, last) =
            (json::canonical(&Value::Object(first)), json::canonical(&Value::Object(last)));
        let mut before = Hasher::new();
        before.update(&first[..first.len() - 1]).update(if first == "{}" { "" } else { "," });
        before.update(format!("\"{TRIAL}\":"));
        let after = if last == "{}" { "}".to_owned() } else { format!(",{}", &last[1..]) };
        Self { before, after }
    }

    /// Computes the key of the trial with this number.
    pub(super) fn key(&self, trial: u32) -> TrialKey {
        let mut hasher = self.before.clone();
        TrialKey(hasher.update(trial.to_string()).update(&self.after).digest())
    }
}

/// Computes the digest of what was asked: of `study.resolved.json`, and so of the manifest's meaning and all input
/// files.
pub fn study_digest(experiment: &Experiment) -> StudyDigest {
    StudyDigest(Sha256Digest::of(
        ResolvedStudy::of(experiment, &engine_version(experiment.kind)).to_text(),
    ))
}

/// Writes the content of a trial's key in lines that two people can compare.
pub fn explain(experiment: &Experiment, spec: &TrialSpec) -> String {
    let mut conditions = experiment.conditions.iter();
    let Some(resolved) = conditions.find(|resolved| resolved.condition == spec.condition) else {
        return format!("trial {} is not of this experiment\n", spec.key);
    };
    let content = key_content(
        experiment.kind,
        experiment.seed,
        &experiment.shared_noise,
        &spec.condition,
        spec.trial,
        &spec.setup,
        &resolved.meanings,
    );
    let mut text = format!(
        "trial {}/{}\nkey   {}\n\nThe key is the SHA-256 of the canonical JSON of:\n",
        spec.condition.slug(),
        spec.trial,
        spec.key
    );
    lines("", &content, &mut text);
    text
}

/// Appends one `path = value` line per leaf, sorted by path.
fn lines(path: &str, value: &Value, text: &mut String) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            let mut keys: Vec<&String> = map.keys().collect();
            keys.sort();
            for key in keys {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                lines(&path, &map[key], text);
            }
        }
        leaf => text.push_str(&format!("  {path} = {}\n", json::canonical(leaf))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that keys are the digests of their contents' canonical JSON, whatever stands before and behind the number.
    #[test]
    fn keys_of_a_condition_are_those_of_each_content() {
        let full = json!({"condition": {"prior": "none"}, "maneuvers": {}, "start": [0.5, {}], "trial": 0, "world": "w"});
        for content in
            [full, json!({"trial": 0}), json!({"a": {}, "trial": 0}), json!({"trial": 0, "z": []})]
        {
            let keys = Keys::of(content.clone());
            for trial in [0, 7, 1_999_999] {
                let mut content = content.clone();
                content[TRIAL] = trial.into();
                let digest = Sha256Digest::of(json::canonical(&content));
                assert_eq!(keys.key(trial), TrialKey(digest), "{content}");
            }
        }
    }
}
