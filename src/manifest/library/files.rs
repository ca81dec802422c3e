//! The files a manifest names: asked for once each, by their path as written.

use super::inputs::{CalibrationTrials, InputError, Inputs, ProposalTrials};
use crate::digest::{FileDigest, Sha256Digest};
use crate::manifest::experiment::Experiment;
use crate::manifest::input::{Input, InputKind, Nested, WrittenIn};
use crate::studies::TrialSpec;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

type Key = (String, WrittenIn);

/// A file that was asked for.
#[derive(Clone)]
struct File {
    bytes: Result<Arc<[u8]>, InputError>,
    kind: InputKind,
}

impl File {
    /// Sets the file's kind where it is known only as one that another manifest reads.
    fn say(&mut self, kind: InputKind) {
        if matches!(self.kind, InputKind::Calibration | InputKind::Inference) {
            self.kind = kind;
        }
    }
}

/// Reads every file once and remembers it.
pub(in crate::manifest) struct InputFiles<'a> {
    source: &'a dyn Inputs,
    files: BTreeMap<Key, File>,
}

impl<'a> InputFiles<'a> {
    pub(super) fn new(source: &'a dyn Inputs) -> Self {
        Self { source, files: BTreeMap::new() }
    }

    /// Returns the bytes of `path`, which is [`super::normalised`]: a file that is a `kind`.
    ///
    /// # Errors
    /// Why there are none.
    pub(in crate::manifest) fn read(
        &mut self,
        path: &str,
        written_in: WrittenIn,
        kind: InputKind,
    ) -> Result<Arc<[u8]>, InputError> {
        let file = self.files.entry((path.to_owned(), written_in)).or_insert_with(|| File {
            bytes: self.source.read(path, written_in).map(Into::into),
            kind,
        });
        file.say(kind);
        file.bytes.clone()
    }

    /// Returns whether `path` is read though it leads out of the folders that the manifest names.
    pub(in crate::manifest) fn follows(&self, path: &str, written_in: WrittenIn) -> bool {
        self.source.follows(path, written_in)
    }

    /// Notes that the file `path`, which another manifest read, is a `kind`.
    pub(in crate::manifest) fn say(&mut self, path: &str, written_in: WrittenIn, kind: InputKind) {
        if let Some(file) = self.files.get_mut(&(path.to_owned(), written_in)) {
            file.say(kind);
        }
    }

    /// Returns what the experiment `calibration` yields; passages are kept as the input `sealed_as`.
    pub(in crate::manifest) fn calibrate(
        &mut self,
        calibration: &Experiment,
        sealed_as: &str,
    ) -> Result<CalibrationTrials, InputError> {
        let measured = self.source.calibrate(calibration, sealed_as)?;
        if let CalibrationTrials::Csv(bytes) = &measured {
            self.made(sealed_as, InputKind::Passages, bytes);
        }
        Ok(measured)
    }

    /// Returns what the experiment `inference` proposes; it is kept as the input `sealed_as`.
    pub(in crate::manifest) fn propose(
        &mut self,
        inference: &Experiment,
        sealed_as: &str,
    ) -> Result<ProposalTrials, InputError> {
        // A manifest and its calibration may run the same draws.
        let key = (sealed_as.to_owned(), WrittenIn::Inference);
        if let Some(File { bytes: Ok(bytes), .. }) = self.files.get(&key) {
            return Ok(ProposalTrials::Lines(bytes.to_vec()));
        }
        let proposed = self.source.propose(inference, sealed_as)?;
        if let ProposalTrials::Lines(bytes) = &proposed {
            self.made(sealed_as, InputKind::Proposals, bytes);
        }
        Ok(proposed)
    }

    /// Keeps what was made from a calibration or an inference as the input `sealed_as`.
    pub(in crate::manifest) fn made(&mut self, sealed_as: &str, kind: InputKind, bytes: &[u8]) {
        let written_in = match kind {
            InputKind::Proposals | InputKind::Draws => WrittenIn::Inference,
            _ => WrittenIn::Calibration,
        };
        let key = (sealed_as.to_owned(), written_in);
        self.files.insert(key, File { bytes: Ok(bytes.into()), kind });
    }

    /// Returns the manifest on whose behalf these files are read, where another names it, and as what.
    pub(in crate::manifest) fn read_as(&self) -> Option<(Nested, &str)> {
        self.source.read_as()
    }

    /// Returns what the robot of `spec` mapped, kept as the inputs `sealed_as`.
    pub(in crate::manifest) fn explore(
        &mut self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Arc<[u8]>; 2], InputError> {
        let keys = sealed_as.each_ref().map(|name| (name.clone(), WrittenIn::PreviousMap));
        if !self.files.contains_key(&keys[0]) {
            let files = match self.source.explore(spec, sealed_as) {
                Ok(files) => files.map(|bytes| Ok(bytes.into())),
                Err(problem) => [Err(problem.clone()), Err(problem)],
            };
            let files = files.map(|bytes| File { bytes, kind: InputKind::Prior });
            self.files.extend(keys.clone().into_iter().zip(files));
        }
        let [descriptor, image] = keys.map(|key| self.files[&key].bytes.clone());
        Ok([descriptor?, image?])
    }

    /// Returns the paths of all files that were asked for.
    pub(in crate::manifest) fn paths(&self) -> Vec<String> {
        self.files.keys().map(|(path, _)| path.clone()).collect()
    }

    /// Returns everything that could be read, in the order of paths.
    pub(in crate::manifest) fn finish(self, licenses: &BTreeMap<String, String>) -> Vec<Input> {
        let mut names = BTreeSet::new();
        self.files
            .into_iter()
            .filter_map(|(key, File { bytes, kind })| Some((key, kind, bytes.ok()?)))
            .map(|((as_written, written_in), kind, bytes)| Input {
                kind,
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

/// Returns a flat name for `path` that `taken` (lower case) does not hold yet.
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

#[cfg(test)]
mod tests {
    use super::*;

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
