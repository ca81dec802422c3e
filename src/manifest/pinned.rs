//! Inputs that somebody else published: where each is to be had, and what it must hold.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// What one publisher published at one commit, and which inputs are files of it.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PinnedDoc {
    /// Who published it: the address of a repository, or a name.
    pub publisher: String,
    /// The commit, in 7 to 64 hex digits.
    pub commit: String,
    /// The inputs by their path as written; images that a map names by their path from the manifest.
    pub files: BTreeMap<String, PinnedFileDoc>,
}

/// One published file.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PinnedFileDoc {
    /// Its path in what was published.
    pub path: String,
    /// SHA-256 of what it holds, in 64 hex digits.
    pub sha256: String,
}
