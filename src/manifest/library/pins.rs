//! Inputs that somebody else published, each held against the digest that the manifest pins.

use super::paths::normalised;
use crate::digest::Sha256Digest;
use crate::manifest::faults::{Faults, step};
use crate::manifest::pinned::PinnedDoc;
use std::collections::BTreeMap;

/// One input: where it is published, and its digest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pin {
    publisher: String,
    commit: String,
    path: String,
    pub(super) digest: Sha256Digest,
    /// Where its key stands in the manifest.
    pointer: String,
}

impl Pin {
    /// Says where the file is to be had, in words.
    pub(super) fn published(&self) -> String {
        let Self { publisher, commit, path, .. } = self;
        format!("`{path}` of {publisher} at commit {commit}")
    }
}

/// All pins of a manifest, by the input's path from the manifest.
#[derive(Debug, Default)]
pub(super) struct Pins(BTreeMap<String, Pin>);

impl Pins {
    /// Reads the pins of `docs`, the value of `/pinned`; collects faults where they cannot be read.
    pub(super) fn read(docs: &[PinnedDoc], faults: &mut Faults<'_>) -> Self {
        let mut pins: BTreeMap<String, Pin> = BTreeMap::new();
        for (i, doc) in docs.iter().enumerate() {
            let at = format!("/pinned/{i}");
            let hex = doc.commit.bytes().all(|b| b.is_ascii_hexdigit());
            if !hex || !(7..=64).contains(&doc.commit.len()) {
                let message = format!("`{}` is no commit", doc.commit);
                faults.at(&format!("{at}/commit"), message, "expected 7 to 64 hex digits");
            }
            for (file, pinned) in &doc.files {
                let pointer = step(&format!("{at}/files"), file);
                let Some(digest) = Sha256Digest::from_hex(&pinned.sha256) else {
                    let message = format!("`{}` is no SHA-256", pinned.sha256);
                    faults.at(&format!("{pointer}/sha256"), message, "expected 64 hex digits");
                    continue;
                };
                let pin = Pin {
                    publisher: doc.publisher.clone(),
                    commit: doc.commit.clone(),
                    path: pinned.path.clone(),
                    digest,
                    pointer: pointer.clone(),
                };
                if pins.insert(normalised(file), pin).is_some() {
                    let message = format!("`{file}` is pinned twice");
                    faults.at_key(&pointer, message, "expected one pin for each input");
                }
            }
        }
        Self(pins)
    }

    /// Returns the pin of the input at `path`, which is [`normalised`].
    pub(super) fn of(&self, path: &str) -> Option<&Pin> {
        self.0.get(path)
    }

    /// Returns the paths that are not in `read`, each with where it is pinned.
    pub(super) fn unused(&self, read: &[String]) -> Vec<(String, String)> {
        self.0
            .iter()
            .filter(|(path, _)| !read.contains(path))
            .map(|(path, pin)| (path.clone(), pin.pointer.clone()))
            .collect()
    }
}
