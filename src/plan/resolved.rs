//! The study with nothing left to guess: `study.resolved.json` as `plan` prints it, and what a bundle seals under `study` there.
//!
//! One type writes it and reads it. A bundle may come from anyone and any release, so whatever stands at a key is kept as it was
//! written ([`AsWritten`]) and has to be of its type only where somebody asks for it; keys of other releases are kept too.

use super::key::levels;
use super::selection::Selection;
use crate::digest::FileDigest;
use crate::document::Node;
use crate::factor::Factor;
use crate::json::{self, AsWritten};
use crate::labels::Labels;
use crate::manifest::{
    Assumption, Author, Cite, Experiment, Meanings, ResolvedCondition, WrittenIn,
};
use crate::studies::{FigureRequest, StudyKind, TableRequest};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Version of the manifest language.
const REENACT: u64 = 1;

/// A resolved study, key by key.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", default, expecting = "a resolved study")]
pub struct ResolvedStudy {
    /// Version of the manifest language.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub reenact: AsWritten<u64>,
    /// Version of what the keys of trials mean.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub engine_version: AsWritten<String>,
    /// Its short name.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub name: AsWritten<String>,
    /// Its title.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub title: AsWritten<String>,
    /// The publication it re-enacts.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub cite: AsWritten<Option<Cite>>,
    /// Authors of the manifest.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub authors: AsWritten<Vec<Author>>,
    /// Licence of the manifest and of what it yields.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub license: AsWritten<Option<String>>,
    /// What its numbers cannot show; absent where the manifest states nothing of the kind, as it was before there was this key.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub limits: AsWritten<Vec<String>>,
    /// Which study this is.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub study: AsWritten<StudyKind>,
    /// Seed of all randomness.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub seed: AsWritten<u64>,
    /// Trials per condition.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub trials: AsWritten<u32>,
    /// Factors whose values see the same noise.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub shared_noise: AsWritten<Vec<String>>,
    /// The factors, in order.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub factors: AsWritten<Vec<Factor>>,
    /// What readers see for factors and their values; absent where the manifest gives no labels.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub labels: AsWritten<Labels>,
    /// The cells of the design, in crossed order.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub conditions: AsWritten<Vec<StudyCondition>>,
    /// The files of the paper's own numbers as written, by name.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub published: AsWritten<BTreeMap<String, String>>,
    /// Tables to produce.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub tables: AsWritten<Vec<TableRequest>>,
    /// What is inferred from the trials; absent where nothing is, as it was before there was this key.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub inference: AsWritten<Value>,
    /// Figures to produce.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub figures: AsWritten<Vec<FigureRequest>>,
    /// Claims, as the manifest writes them.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub claims: AsWritten<Value>,
    /// Values that the paper leaves open, with the reasons for them.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub assumptions: AsWritten<Vec<Assumption>>,
    /// The file of the claims' verdicts at other values of the assumptions, as written; absent where that was not tried.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub sensitivity: AsWritten<String>,
    /// The file of those at draws of all assumptions together, as written; absent where that was not tried.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub multiverse: AsWritten<String>,
    /// `PATH=VALUE` from the command line, in order.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub overrides: AsWritten<Vec<String>>,
    /// Which part was run; absent where the study is whole.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub selection: AsWritten<Selection>,
    /// Every file that was read, once.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub inputs: AsWritten<Vec<AsWritten<StudyInput>>>,
    /// Keys that this release does not write.
    #[serde(flatten)]
    pub further: Map<String, Value>,
}

/// A cell of a resolved study.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", default, expecting = "a resolved condition")]
pub struct StudyCondition {
    /// Its name, for files.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub slug: AsWritten<String>,
    /// The value of every factor.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub condition: AsWritten<BTreeMap<String, String>>,
    /// What it was resolved from, for people.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub described: AsWritten<Value>,
    /// What its things mean.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub meanings: AsWritten<Meanings>,
    /// Where the robot begins, in the world's frame.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub start: AsWritten<Start>,
    /// The study's parameters, defaults written out.
    #[serde(skip_serializing_if = "AsWritten::is_absent")]
    pub parameters: AsWritten<Value>,
    /// What else its trials depend on, by name.
    #[serde(flatten)]
    pub further: Map<String, Value>,
}

/// Where a robot begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Start {
    /// Along the world's x axis (m).
    pub x_m: f64,
    /// Along the world's y axis (m).
    pub y_m: f64,
    /// From the x axis towards the y axis (rad).
    pub heading_rad: f64,
}

/// A file that a resolved study reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct StudyInput {
    /// Its path, as it was asked for.
    pub as_written: String,
    /// What that path is relative to.
    pub written_in: WrittenIn,
    /// Where it is in a bundle, relative to the payload.
    pub file: String,
    /// Digest of what it holds.
    pub sha256: FileDigest,
    /// Its licence, where the manifest states one.
    pub license: Option<String>,
}

impl ResolvedStudy {
    /// Returns `experiment` as resolved by the engine of that version: nothing of this machine is in it.
    pub fn of(experiment: &Experiment, engine_version: &str) -> Self {
        let inputs = experiment.inputs.iter().map(|input| {
            AsWritten::of(&StudyInput {
                as_written: input.as_written.clone(),
                written_in: input.written_in,
                file: format!("inputs/{}", input.name),
                sha256: input.digest,
                license: input.license.clone(),
            })
        });
        let conditions: Vec<_> = experiment.conditions.iter().map(StudyCondition::of).collect();
        let claims = experiment.document.node("/claims");
        let mut study = Self {
            reenact: AsWritten::of(&REENACT),
            engine_version: AsWritten::of(&engine_version.to_owned()),
            name: AsWritten::of(&experiment.name),
            title: AsWritten::of(&experiment.title),
            cite: AsWritten::of(&experiment.cite),
            authors: AsWritten::of(&experiment.authors),
            license: AsWritten::of(&experiment.license),
            study: AsWritten::of(&experiment.kind),
            seed: AsWritten::of(&experiment.seed),
            trials: AsWritten::of(&experiment.trials),
            shared_noise: AsWritten::of(&experiment.shared_noise),
            factors: AsWritten::of(&experiment.factors),
            conditions: AsWritten::of(&conditions),
            published: AsWritten::of(&experiment.published_files),
            tables: AsWritten::of(&experiment.tables),
            figures: AsWritten::of(&experiment.figures),
            claims: AsWritten::of(&claims.map_or_else(|| Value::Array(Vec::new()), Node::to_json)),
            assumptions: AsWritten::of(&experiment.assumptions),
            overrides: AsWritten::of(&experiment.overrides),
            inputs: AsWritten::of(&inputs.collect()),
            ..Self::default()
        };
        if !experiment.limits.is_empty() {
            study.limits = AsWritten::of(&experiment.limits);
        }
        if !experiment.labels.is_empty() {
            study.labels = AsWritten::of(&experiment.labels);
        }
        if let Some(inference) = &experiment.from_trials {
            study.inference = AsWritten::of(&json::value_of(inference));
        }
        if let Some(known) = &experiment.sensitivity {
            study.sensitivity = AsWritten::of(&known.as_written);
        }
        if let Some(known) = &experiment.multiverse {
            study.multiverse = AsWritten::of(&known.as_written);
        }
        study
    }

    /// Returns the document as one canonical text, with a final line feed.
    pub fn to_text(&self) -> String {
        let mut text = json::canonical_of(self);
        text.push('\n');
        text
    }

    /// Returns the document as plain JSON.
    pub fn to_json(&self) -> Value {
        json::value_of(self)
    }
}

impl StudyCondition {
    fn of(resolved: &ResolvedCondition) -> Self {
        let ResolvedCondition { condition, setup, meanings, described } = resolved;
        let start = setup.start();
        Self {
            slug: AsWritten::of(&condition.slug()),
            condition: AsWritten::of(&levels(condition)),
            described: AsWritten::of(described),
            meanings: AsWritten::of(meanings),
            start: AsWritten::of(&Start { x_m: start.x, y_m: start.y, heading_rad: start.heading }),
            parameters: AsWritten::of(&setup.parameters()),
            further: setup.further(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_others_wrote_is_kept_and_read_only_where_it_is_asked_for() {
        let written = json!({
            "seed": "seven", "overrides": [7], "license": null, "approved": true,
            "conditions": [{"slug": "none", "start": {"x-m": 0, "y-m": 1.5, "heading-rad": 0}, "maneuvers": {}}],
        });
        let study: ResolvedStudy = serde_json::from_value(written.clone()).unwrap();
        assert_eq!(study.to_json(), written);
        let fault = study.overrides.read().unwrap_err().to_string();
        assert_eq!(fault, "invalid type: integer `7`, expected a string");
        let fault = study.limits.read().unwrap_err().to_string();
        assert_eq!(fault, "invalid type: null, expected a sequence");
        assert!(study.seed.read().is_err());
        let [none] = &study.conditions.read().unwrap()[..] else { panic!("one condition") };
        assert_eq!(none.start.read().unwrap().y_m, 1.5);
        assert_eq!(none.further.keys().collect::<Vec<_>>(), ["maneuvers"]);
    }

    #[test]
    fn a_study_is_an_object() {
        let fault = serde_json::from_value::<ResolvedStudy>(json!([])).unwrap_err().to_string();
        assert_eq!(fault, "invalid type: sequence, expected a resolved study");
    }
}
