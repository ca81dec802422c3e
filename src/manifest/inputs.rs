//! The files a manifest names: asked for once each, by their path as written.

use super::Experiment;
use crate::digest::{FileDigest, Sha256Digest};
use crate::studies::TrialSpec;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Where a path was written, which says what it is relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WrittenIn {
    /// In the manifest (or a file that it names): relative to the manifest.
    Manifest,
    /// On the command line: relative to where the command was given.
    CommandLine,
    /// Nowhere: made from the calibration manifest.
    Calibration,
    /// Nowhere: made by an exploration before the experiment's own.
    PreviousMap,
}

/// Who hands over the bytes of files: the file system, or a bundle.
pub trait Inputs {
    /// The bytes of the file `as_written`: a path with forward slashes and without needless dots.
    ///
    /// # Errors
    /// Why there are none, in words (`no such file`).
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, String>;

    /// The passages of the experiment `calibration`, one row a trial; in bundles they are sealed as `sealed_as`.
    ///
    /// # Errors
    /// Why there are none, in words.
    fn calibrate(&self, calibration: &Experiment, sealed_as: &str) -> Result<Measured, String> {
        let _ = sealed_as;
        Err(format!("nobody here can run `{}`", calibration.name))
    }

    /// The manifest on whose behalf these files are read, where that is a calibration: it has none of its own.
    fn calibrates(&self) -> Option<&str> {
        None
    }

    /// The map that the robot of `spec` ends with, as a `map_server` descriptor and the image that it names; in bundles
    /// they are sealed as `sealed_as`. [`super::explored`] makes them.
    ///
    /// # Errors
    /// Why there is none, in words.
    fn explore(&self, spec: &TrialSpec, sealed_as: &[String; 2]) -> Result<[Vec<u8>; 2], String> {
        let _ = sealed_as;
        Err(format!("nobody here can run the exploration {}", spec.key.short()))
    }
}

/// What calibrating gave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Measured {
    /// The passages, as `studies::deadline::Passages` writes them.
    Passages(Vec<u8>),
    /// Nothing was measured: numbers stand in that enter no result.
    StandIn,
}

/// One file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Its path, as it was asked for.
    pub as_written: String,
    /// What that path is relative to.
    pub written_in: WrittenIn,
    /// Its name in a bundle: flat, of `[A-Za-z0-9._-]`, unique even where case does not count.
    pub name: String,
    /// What it holds.
    pub bytes: Arc<[u8]>,
    /// Digest of what it holds.
    pub digest: FileDigest,
    /// Its licence, where the manifest states one.
    pub license: Option<String>,
}

type Key = (String, WrittenIn);

/// Reads every file once and remembers it.
pub(super) struct InputFiles<'a> {
    source: &'a dyn Inputs,
    files: BTreeMap<Key, Result<Arc<[u8]>, String>>,
}

impl<'a> InputFiles<'a> {
    pub(super) fn new(source: &'a dyn Inputs) -> Self {
        Self { source, files: BTreeMap::new() }
    }

    /// The bytes of `path`, which is [`normalised`].
    pub(super) fn read(&mut self, path: &str, written_in: WrittenIn) -> Result<Arc<[u8]>, String> {
        self.files
            .entry((path.to_owned(), written_in))
            .or_insert_with(|| self.source.read(path, written_in).map(Into::into))
            .clone()
    }

    /// What the experiment `calibration` yields; passages are kept as the input `sealed_as`.
    pub(super) fn calibrate(
        &mut self,
        calibration: &Experiment,
        sealed_as: &str,
    ) -> Result<Measured, String> {
        let measured = self.source.calibrate(calibration, sealed_as)?;
        if let Measured::Passages(bytes) = &measured {
            self.made(sealed_as, WrittenIn::Calibration, bytes);
        }
        Ok(measured)
    }

    /// Keeps what was made from other inputs as the input `sealed_as`.
    pub(super) fn made(&mut self, sealed_as: &str, written_in: WrittenIn, bytes: &[u8]) {
        self.files.insert((sealed_as.to_owned(), written_in), Ok(bytes.into()));
    }

    /// The manifest on whose behalf these files are read, where that is a calibration.
    pub(super) fn calibrates(&self) -> Option<&str> {
        self.source.calibrates()
    }

    /// What the robot of `spec` mapped, kept as the inputs `sealed_as`.
    pub(super) fn explore(
        &mut self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Arc<[u8]>; 2], String> {
        let keys = sealed_as.each_ref().map(|name| (name.clone(), WrittenIn::PreviousMap));
        if !self.files.contains_key(&keys[0]) {
            let files = match self.source.explore(spec, sealed_as) {
                Ok(files) => files.map(|bytes| Ok(bytes.into())),
                Err(problem) => [Err(problem.clone()), Err(problem)],
            };
            self.files.extend(keys.clone().into_iter().zip(files));
        }
        let [descriptor, image] = keys.map(|key| self.files[&key].clone());
        Ok([descriptor?, image?])
    }

    /// The paths of all files that were asked for.
    pub(super) fn paths(&self) -> Vec<String> {
        self.files.keys().map(|(path, _)| path.clone()).collect()
    }

    /// Everything that could be read, in the order of paths.
    pub(super) fn finish(self, licenses: &BTreeMap<String, String>) -> Vec<Input> {
        let mut names = BTreeSet::new();
        self.files
            .into_iter()
            .filter_map(|((as_written, written_in), bytes)| {
                Some((as_written, written_in, bytes.ok()?))
            })
            .map(|(as_written, written_in, bytes)| Input {
                name: unique_name(&as_written, &mut names),
                digest: FileDigest(Sha256Digest::of(&bytes)),
                license: licenses.get(&as_written).cloned(),
                as_written,
                written_in,
                bytes,
            })
            .collect()
    }
}

/// The files of the calibration manifest `manifest`, which are inputs of the manifest that names it, too.
pub(super) struct OfCalibration<'f, 'a> {
    files: RefCell<&'f mut InputFiles<'a>>,
    manifest: String,
    written_in: WrittenIn,
}

impl<'f, 'a> OfCalibration<'f, 'a> {
    /// Files beside `manifest`, which is [`normalised`] and was written in `written_in`.
    pub(super) fn new(
        files: &'f mut InputFiles<'a>,
        manifest: &str,
        written_in: WrittenIn,
    ) -> Self {
        Self { files: RefCell::new(files), manifest: manifest.to_owned(), written_in }
    }
}

impl Inputs for OfCalibration<'_, '_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, String> {
        let path = joined(&self.manifest, as_written);
        self.files.borrow_mut().read(&path, self.written_in).map(|bytes| bytes.to_vec())
    }

    fn calibrates(&self) -> Option<&str> {
        Some(&self.manifest)
    }
}

/// A flat name for `path` that `taken` (lower case) does not hold yet.
fn unique_name(path: &str, taken: &mut BTreeSet<String>) -> String {
    let file = path.rsplit('/').next().unwrap_or_default();
    let safe = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '-' };
    let mut name: String = file.chars().map(safe).collect();
    // Neither hidden files nor options of some command.
    if !name.starts_with(|c: char| c.is_ascii_alphanumeric()) {
        name.insert_str(0, "input");
    }
    let (stem, extension) = match name.rfind('.') {
        Some(dot) => name.split_at(dot),
        None => (name.as_str(), ""),
    };
    let mut unique = name.clone();
    let mut number = 2;
    while !taken.insert(unique.to_ascii_lowercase()) {
        unique = format!("{stem}-{number}{extension}");
        number += 1;
    }
    unique
}

/// `path` without `.` steps, doubled slashes and steps that `..` undoes.
pub(super) fn normalised(path: &str) -> String {
    let mut steps: Vec<&str> = Vec::new();
    for step in path.split('/') {
        match step {
            "" | "." => {}
            ".." if steps.last().is_some_and(|last| *last != "..") => {
                steps.pop();
            }
            ".." if path.starts_with('/') => {}
            other => steps.push(other),
        }
    }
    let root = if path.starts_with('/') { "/" } else { "" };
    format!("{root}{}", steps.join("/"))
}

/// `path`, written in the file `beside`, from where `beside` is written.
pub(super) fn joined(beside: &str, path: &str) -> String {
    match beside.rsplit_once('/') {
        Some((folder, _)) if !path.starts_with('/') => normalised(&format!("{folder}/{path}")),
        _ => normalised(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_joined_and_normalised() {
        assert_eq!(normalised("./a//b/../c.yaml"), "a/c.yaml");
        assert_eq!(normalised("../../x"), "../../x");
        assert_eq!(normalised("/a/../../b"), "/b");
        assert_eq!(joined("../worlds/basic.yaml", "priors/a.png"), "../worlds/priors/a.png");
        assert_eq!(joined("../worlds/basic.yaml", "/abs.png"), "/abs.png");
        assert_eq!(joined("basic.yaml", "a.png"), "a.png");
    }

    #[test]
    fn names_are_flat_safe_and_unique() {
        let mut taken = BTreeSet::new();
        let names = ["a/basic.yaml", "b/Basic.yaml", "c/.hidden", "d/with space.png", "e/"]
            .map(|path| unique_name(path, &mut taken));
        assert_eq!(
            names,
            ["basic.yaml", "Basic-2.yaml", "input.hidden", "with-space.png", "input"]
        );
    }
}
