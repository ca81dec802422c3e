//! Inputs that somebody else published: where each is to be had, and what it must hold.

use super::faults::{Faults, step};
use super::inputs::{WrittenIn, normalised};
use super::resolve::{Resolver, relative_to};
use crate::digest::Sha256Digest;
use crate::document::known_or_near;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::Arc;

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
    /// Where the file is to be had, in words.
    pub(super) fn published(&self) -> String {
        let Self { publisher, commit, path, .. } = self;
        format!("`{path}` of {publisher} at commit {commit}")
    }
}

/// All pins of a manifest, by the input's path from the manifest.
#[derive(Debug, Default)]
pub(super) struct Pins(BTreeMap<String, Pin>);

impl Pins {
    /// The pins of `docs`, the value of `/pinned`; faults where they cannot be read.
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

    /// The pin of the input at `path`, which is [`normalised`].
    pub(super) fn of(&self, path: &str) -> Option<&Pin> {
        self.0.get(path)
    }

    /// The paths that are not in `read`, each with where it is pinned.
    fn unused(&self, read: &[&str]) -> Vec<(String, String)> {
        self.0
            .iter()
            .filter(|(path, _)| !read.contains(&path.as_str()))
            .map(|(path, pin)| (path.clone(), pin.pointer.clone()))
            .collect()
    }
}

impl Resolver<'_> {
    /// The bytes of the file at `normalised`, which `pointer` names as `path`; faults where it cannot be read or is
    /// not the one that is pinned.
    pub(super) fn bytes_of(
        &mut self,
        normalised: &str,
        written_in: WrittenIn,
        path: &str,
        pointer: &str,
    ) -> Option<Arc<[u8]>> {
        // On the command line somebody names a file of their own.
        let pin = self.pins.of(normalised).filter(|_| written_in == WrittenIn::Manifest);
        let (message, label, help) = match self.files.read(normalised, written_in) {
            Ok(bytes) => {
                let found = Sha256Digest::of(&bytes);
                let Some(pin) = pin.filter(|pin| pin.digest != found) else {
                    return Some(bytes);
                };
                (
                    format!("`{path}` is not the file that is pinned"),
                    format!("expected SHA-256 {}, found {found}", pin.digest),
                    format!("pinned is {}: put that file there, or pin this one", pin.published()),
                )
            }
            Err(reason) => {
                let help = match pin {
                    Some(pin) => format!(
                        "it is published as {}: put it there, the path is relative to the manifest",
                        pin.published()
                    ),
                    None => relative_to(written_in).to_owned(),
                };
                (format!("cannot read `{path}`"), reason, help)
            }
        };
        let fault = self.faults.fault(pointer, message).label(label).help(help);
        self.faults.push(fault);
        None
    }

    /// Faults of pins that no input has.
    pub(super) fn check_pins(&mut self) {
        let read: Vec<String> = self.files.paths();
        let known: Vec<&str> = read.iter().map(String::as_str).collect();
        for (path, pointer) in self.pins.unused(&known) {
            let fault = self
                .faults
                .key_fault(&pointer, format!("no input is read from `{path}`"))
                .label("expected the path of an input, from the manifest")
                .help(known_or_near(&path, &known));
            self.faults.push(fault);
        }
    }
}
