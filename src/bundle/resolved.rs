//! `study.resolved.json`: what the bundle is made of, and the study with nothing left to guess.

use super::{BundleContent, BundlePath, Fault, format, names};
use crate::digest::{FileDigest, Sha256Digest};
use crate::json;
use crate::plan::ResolvedStudy;
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
    /// The study itself.
    pub study: ResolvedStudy,
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
    /// Creates the document for `content`.
    pub(crate) fn of(content: &BundleContent) -> Self {
        Self {
            bundle_format: content.format(),
            conditions: content
                .conditions
                .iter()
                .map(|c| ConditionEntry { slug: c.slug.clone(), trials: c.trials })
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

    /// Writes canonical JSON, indented for people.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        json::indented(&json::canonical_of(self)).into_bytes()
    }

    /// Reads the document; a newer format is recognised before anything else is looked at.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        #[derive(Deserialize)]
        #[serde(rename_all = "kebab-case")]
        struct Version {
            bundle_format: u64,
        }
        let path = BundlePath::payload(format::RESOLVED);
        let fault = |problem: String| {
            Fault::new(&path, "a resolved study (docs/bundle-format.md)", problem)
        };
        let version: Version = serde_json::from_slice(bytes)
            .map_err(|e| fault(e.to_string()).hint(format::NO_FORMAT_HINT))?;
        format::check(&path, version.bundle_format)?;
        let resolved: Self = json::read(bytes).map_err(|e| fault(e.to_string()))?;
        let wrong = match names::hazard(&resolved.name) {
            Some(hazard) => Some(hazard),
            None if resolved.name.contains('/') => Some("a path"),
            None if !names::is_portable(&resolved.name) => Some("other characters"),
            None => None,
        };
        match wrong {
            // It begins the names of files that `export` and `report` write.
            Some(wrong) => Err(Fault::new(&path, "a name of A-Z a-z 0-9 . _ - at /name", wrong)),
            None => Ok(resolved),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_lead_out_of_a_folder() {
        let mut resolved = Resolved::of(&super::super::sample::content());
        for (name, found) in [
            ("../up", "a path that climbs out of its folder"),
            ("/root", "an absolute path"),
            ("a/b", "a path"),
            ("a b", "other characters"),
        ] {
            name.clone_into(&mut resolved.name);
            assert_eq!(
                Resolved::read(&resolved.to_bytes()).unwrap_err().to_string(),
                format!(
                    "data/study.resolved.json: expected a name of A-Z a-z 0-9 . _ - at /name, found {found}"
                )
            );
        }
    }

    #[test]
    fn older_and_missing_formats_are_refused_with_help() {
        assert_eq!(
            Resolved::read(br#"{"bundle-format": 0}"#).unwrap_err().to_string(),
            "data/study.resolved.json: expected bundle format 1 to 5, found bundle format 0 (no release wrote that format: ask the \
             author for the bundle as `reenact run` sealed it, or run its study.yaml again)"
        );
        assert_eq!(
            Resolved::read(b"{}").unwrap_err().to_string(),
            "data/study.resolved.json: expected a resolved study (docs/bundle-format.md), found missing field \
             `bundle-format` at line 1 column 2 (every release writes its format's number: ask the author for the bundle as \
             `reenact run` sealed it)"
        );
    }

    #[test]
    fn a_newer_format_is_refused_with_help() {
        let fault = Resolved::read(br#"{"bundle-format": 7, "unheard-of": []}"#).unwrap_err();
        assert_eq!(
            fault.to_string(),
            format!(
                "data/study.resolved.json: expected bundle format 5 or older, found bundle format 7 (this is reenact {}, \
                 which reads formats 1 to 5; install the version named after `Bag-Software-Agent` in bag-info.txt (or \
                 any newer one) to read format 7)",
                format::VERSION
            )
        );
    }
}
