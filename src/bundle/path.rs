//! Where a file is in a bundle.

use super::format::{INPUTS, RESULTS, records_path};
use std::fmt;
use std::ops::Deref;

/// The payload folder, which is the RO-Crate's root. Nothing outside this module glues it to a path.
pub(super) const PAYLOAD: &str = "data/";

/// The path of a file or folder of the payload, relative to the bag's root (`data/study.yaml`).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct BundlePath(String);

impl BundlePath {
    /// Returns the path of `path`, which is relative to the payload.
    pub fn payload(path: &str) -> Self {
        Self(format!("{PAYLOAD}{path}"))
    }

    /// Returns the path of the input that is called `name` in the bundle.
    pub fn input(name: &str) -> Self {
        Self::payload(&format!("{INPUTS}{name}"))
    }

    /// Returns the path of a condition's records.
    pub fn records(slug: &str) -> Self {
        Self::payload(&records_path(slug))
    }

    /// Returns the path of `path`, which is relative to `results/`.
    pub fn result(path: &str) -> Self {
        Self::payload(&format!("{RESULTS}{path}"))
    }

    /// Returns the place of a line in this file, counted from 1: `data/trials/none.jsonl:2`.
    pub fn line(&self, number: usize) -> String {
        format!("{self}:{number}")
    }
}

/// Returns `path` relative to the payload; `None` for a tag file.
pub fn in_payload(path: &str) -> Option<&str> {
    path.strip_prefix(PAYLOAD)
}

impl Deref for BundlePath {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for BundlePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<BundlePath> for String {
    fn from(path: BundlePath) -> Self {
        path.0
    }
}

impl From<&BundlePath> for String {
    fn from(path: &BundlePath) -> Self {
        path.0.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_into_the_payload_and_out_again() {
        assert_eq!(&*BundlePath::payload(""), "data/");
        assert_eq!(&*BundlePath::input("a.yaml"), "data/inputs/a.yaml");
        assert_eq!(BundlePath::records("none").line(2), "data/trials/none.jsonl:2");
        assert_eq!(in_payload(&BundlePath::result("trials.csv")), Some("results/trials.csv"));
        assert_eq!(in_payload("bagit.txt"), None);
    }
}
