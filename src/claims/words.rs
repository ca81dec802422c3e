//! Whose words a claim is in, and what the paper's own table shows of it: two of the three facts that stay apart.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Whose words a claim is in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Words {
    /// The paper's.
    Says(String),
    /// Our own: the paper does not say so.
    Ours(String),
}

impl Words {
    /// Returns the words themselves.
    pub fn text(&self) -> &str {
        match self {
            Self::Says(text) | Self::Ours(text) => text,
        }
    }
}

/// What the paper's own table shows of a claim: a statement of the manifest's author, never computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PaperTable {
    /// The printed numbers bear the claim out.
    Supports,
    /// The printed numbers speak against it.
    Contradicts,
    /// There are no printed numbers on it, or they decide nothing.
    #[default]
    Silent,
}

impl fmt::Display for PaperTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Supports => "supports",
            Self::Contradicts => "contradicts",
            Self::Silent => "silent",
        })
    }
}
