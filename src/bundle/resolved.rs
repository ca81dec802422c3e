//! `study.resolved.json`: what the bundle is made of, and the study with nothing left to guess.

use super::{BundleContent, Fault, format};
use crate::digest::{FileDigest, Sha256Digest};
use crate::json;
use serde::{Deserialize, Serialize};

/// The document, in the order of its keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Resolved {
    /// Version of the layout.
    pub bundle_format: u64,
    /// Conditions in plan order.
    pub conditions: Vec<ConditionEntry>,
    /// The engine that ran the trials.
    pub engine: String,
    /// Every input by every path it is known by.
    pub inputs: Vec<InputEntry>,
    /// The study's short name.
    pub name: String,
    /// Whether only part of the study was run.
    pub partial: bool,
    /// The study itself: overrides, parameters with all defaults, factors.
    pub study: serde_json::Value,
}

/// A cell of the study.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ConditionEntry {
    /// Its file name under `trials/`, without extension.
    pub slug: String,
    /// How many records it has.
    pub trials: usize,
}

/// An input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InputEntry {
    /// The path by which the study names it.
    pub as_written: String,
    /// Its licence, where it is not the bundle's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub license: Option<String>,
    /// Where it is, relative to `data/`.
    pub path: String,
    /// Digest of its bytes.
    pub sha256: FileDigest,
}

impl Resolved {
    /// The document for `content`.
    pub(crate) fn of(content: &BundleContent) -> Self {
        Self {
            bundle_format: format::FORMAT,
            conditions: content
                .conditions
                .iter()
                .map(|c| ConditionEntry { slug: c.slug.clone(), trials: c.records.len() })
                .collect(),
            engine: content.engine.clone(),
            inputs: content
                .inputs
                .iter()
                .map(|input| InputEntry {
                    as_written: input.as_written.clone(),
                    license: input.license.clone(),
                    path: format!("{}{}", format::INPUTS, input.name),
                    sha256: FileDigest(Sha256Digest::of(&input.bytes)),
                })
                .collect(),
            name: content.name.clone(),
            partial: content.partial,
            study: content.resolved.clone(),
        }
    }

    /// Canonical JSON, indented for people.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        json::indented(&json::canonical_of(self)).into_bytes()
    }

    /// Reads the document; a newer format is told apart before anything else is looked at.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        #[derive(Deserialize)]
        #[serde(rename_all = "kebab-case")]
        struct Version {
            bundle_format: u64,
        }
        let path = format!("{}{}", format::PAYLOAD, format::RESOLVED);
        let fault = |e: serde_json::Error| {
            Fault::new(
                &path,
                "the resolved study of format 1 (docs/bundle-format.md)",
                e.to_string(),
            )
        };
        let version: Version = serde_json::from_slice(bytes).map_err(fault)?;
        if version.bundle_format > format::FORMAT {
            return Err(Fault::new(
                &path,
                format!("bundle format {} or older", format::FORMAT),
                format!("bundle format {}", version.bundle_format),
            )
            .hint(format::newer_format_hint(version.bundle_format)));
        }
        serde_json::from_slice(bytes).map_err(fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newer_format_is_refused_with_help() {
        let fault = Resolved::read(br#"{"bundle-format": 7, "unheard-of": []}"#).unwrap_err();
        assert_eq!(
            fault.to_string(),
            format!(
                "data/study.resolved.json: expected bundle format 1 or older, found bundle format 7 (this is reenact {}, \
                 which reads formats 1 to 1; install the version named after `Bag-Software-Agent` in bag-info.txt (or \
                 any newer one) to read format 7)",
                format::VERSION
            )
        );
    }
}
