//! The in-toto Statement (v1) about a bundle, and its predicate: how far the bundle was executed again, and what of it held.

use crate::bundle::{Moment, format};
use crate::verify::signature::Signed;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Version 1 of the Statement.
pub(super) const STATEMENT: &str = "https://in-toto.io/Statement/v1";

/// The only verdict that is attested.
pub(super) const HOLDS: &str = "holds";

/// Returns version 1 of the predicate, which docs/verification.md describes.
pub(super) fn predicate_type() -> String {
    format!("{}#re-execution/v1", format::HOME)
}

/// The Statement. What in-toto does not name is ignored, as it asks; what it names stands there once.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Statement {
    #[serde(rename = "_type")]
    kind: String,
    pub(super) subject: Vec<Subject>,
    predicate_type: String,
    pub(super) predicate: Predicate,
}

impl Statement {
    pub(super) fn about(subject: Subject, predicate: Predicate) -> Self {
        Self {
            kind: STATEMENT.to_owned(),
            subject: vec![subject],
            predicate_type: predicate_type(),
            predicate,
        }
    }
}

/// What any Statement has, whatever it says.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Head {
    #[serde(rename = "_type")]
    pub(super) kind: String,
    pub(super) predicate_type: String,
}

/// What is attested: the bag's list of digests, whose own digest is the bundle's id.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Subject {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    pub(super) digest: Digests,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Digests {
    pub(super) sha256: String,
}

/// The predicate. Seeds are texts: JSON's numbers do not hold all of them everywhere.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Predicate {
    pub(super) bundle_id: String,
    pub(super) results_digest: String,
    pub(super) study_digest: String,
    pub(super) study: String,
    pub(super) partial: bool,
    pub(super) overrides: Vec<String>,
    pub(super) selection: Option<Value>,
    pub(super) verdict: String,
    pub(super) level: u8,
    pub(super) level_name: String,
    pub(super) levels: Vec<Rung>,
    pub(super) sample: Option<Sampled>,
    /// What runs before the study's own made and was executed again, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) earlier: Vec<String>,
    pub(super) replication: Option<Replicated>,
    pub(super) signed: Option<Signed>,
    pub(super) notes: Vec<Note>,
    pub(super) not_checked: Vec<String>,
    pub(super) engine: String,
    pub(super) program: String,
    pub(super) date: String,
}

/// What became of a level.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Rung {
    pub(super) level: u64,
    pub(super) name: String,
    pub(super) state: String,
}

/// What was executed again.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Sampled {
    pub(super) executed: usize,
    pub(super) equal: usize,
    pub(super) of: usize,
    pub(super) seed: Option<String>,
    pub(super) bound: Option<f64>,
    pub(super) in_words: String,
}

/// What fresh seeds said.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Replicated {
    pub(super) seed: String,
    pub(super) in_words: String,
}

/// Something that was noticed.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Note {
    pub(super) level: u8,
    pub(super) path: String,
    pub(super) expected: String,
    pub(super) found: String,
    pub(super) hint: String,
}

/// Writes an instant as in-toto does.
pub(super) fn written(date: Moment) -> String {
    date.iso().replace("+00:00", "Z")
}

/// Returns whether `text` is such an instant.
pub(super) fn is_instant(text: &str) -> bool {
    Moment::from_iso(&text.replace('Z', "+00:00")).is_some_and(|moment| written(moment) == text)
}
