//! What resolving a manifest works with: the manifest, its faults, its library, its factors.

use super::choice::{By, Choice};
use super::document::ManifestDoc;
use super::drawn::Draws;
use super::experiment::{CalibrationRun, InferenceRun};
use super::faults::{Faults, step};
use super::input::{InputKind, WrittenIn};
use super::library::{Library, Made, Unread, joined, normalised, relative_to};
use super::parameters::Groups;
use crate::condition::Condition;
use crate::digest::MeaningDigest;
use crate::document::{Diagnostic, Source};
use crate::factor::Factor;
use crate::world::formats::Foreign;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A manifest while it is resolved. What a kind of thing needs besides is in the file of that thing.
pub(super) struct Resolver<'a> {
    pub(super) doc: &'a ManifestDoc,
    /// Name of the manifest, which relative paths are shown beside.
    pub(super) folder: &'a str,
    pub(super) faults: Faults<'a>,
    pub(super) library: Library<'a>,
    pub(super) factors: Vec<Factor>,
    /// Pairs of world and prior that have been held against each other.
    pub(super) aligned: BTreeSet<(MeaningDigest, MeaningDigest, String)>,
    /// Robots, worlds and starts (bits of x, y and heading) that have been looked at.
    pub(super) started: BTreeSet<(MeaningDigest, MeaningDigest, [u64; 3])>,
    /// The groups that the study's parameters are in.
    pub(super) groups: Groups,
    /// The experiment that measured what planners expect, once it was asked for.
    pub(super) calibration_run: Option<Arc<CalibrationRun>>,
    /// The draws that are the values of a factor, where there is one and they could be had.
    pub(super) draws: Option<Draws>,
    /// The inference that they are of.
    pub(super) inference_run: Option<InferenceRun>,
}

impl<'a> Resolver<'a> {
    /// Returns what `make` makes of what `key` names, made once and kept on a shelf of the library.
    pub(super) fn once<T: Clone>(
        &mut self,
        shelf: for<'r> fn(&'r mut Library<'a>) -> &'r mut Made<T>,
        key: String,
        make: impl FnOnce(&mut Self) -> T,
    ) -> T {
        if let Some(made) = shelf(&mut self.library).get(&key) {
            return made.clone();
        }
        let made = make(self);
        shelf(&mut self.library).insert(key, made.clone());
        made
    }

    /// Returns what `read` yields; `None` where it has faults, which are collected.
    pub(super) fn told<T>(&mut self, read: Result<T, Vec<Diagnostic>>) -> Option<T> {
        read.map_err(|faults| self.faults.extend(faults)).ok()
    }

    /// Returns what `choice` is for `condition`, and where that is written.
    pub(super) fn choose<'c, T>(
        &mut self,
        choice: &'c Choice<T>,
        pointer: &str,
        condition: &Condition,
    ) -> Option<(&'c T, String)> {
        match choice {
            Choice::Plain(value) => Some((value, pointer.to_owned())),
            Choice::By(By { by, values }) => {
                let place = format!("{pointer}/by");
                let factor = self.faults.check_factor(&self.factors, by, &place, false)?;
                let place = format!("{pointer}/values");
                self.faults.check_levels(values.keys(), factor, &place, true);
                let level = condition.value(by)?;
                let pointer = step(&format!("{pointer}/values"), level);
                self.choose(values.get(level)?, &pointer, condition)
            }
        }
    }

    /// Returns the bytes of the file at `normalised`, a `kind`, which `pointer` names as `path`; faults where it cannot be
    /// read or is not the one that is pinned.
    pub(super) fn bytes(
        &mut self,
        normalised: &str,
        kind: InputKind,
        path: &str,
        pointer: &str,
    ) -> Option<Arc<[u8]>> {
        let written_in = self.faults.written_in(pointer);
        let (message, label, help) = match self.library.read(normalised, written_in, kind) {
            Ok(bytes) => return Some(bytes),
            Err(Unread::Unpinned { digests, published, .. }) => (
                format!("`{path}` is not the file that is pinned"),
                digests,
                format!("pinned is {published}: put that file there, or pin this one"),
            ),
            Err(Unread::Missing { reason, published }) => {
                let help = match published {
                    Some(published) => format!(
                        "it is published as {published}: put it there, the path is relative to the manifest"
                    ),
                    None => relative_to(written_in).to_owned(),
                };
                (format!("cannot read `{path}`"), reason.to_string(), help)
            }
        };
        let fault = self.faults.fault(pointer, message).label(label).help(help);
        self.faults.push(fault);
        None
    }

    /// Returns the text of the file `path`, a `kind`, written at `pointer`; faults where there is none.
    pub(super) fn text(&mut self, path: &str, pointer: &str, kind: InputKind) -> Option<Source> {
        let bytes = self.bytes(&normalised(path), kind, path, pointer)?;
        let Ok(text) = std::str::from_utf8(&bytes) else {
            let fault = self.faults.fault(pointer, format!("`{path}` is not UTF-8 text"));
            let fault = fault.label("expected a text file");
            self.faults.push(match Foreign::of(&bytes) {
                Some(format) => fault.help(format.help()),
                None => fault,
            });
            return None;
        };
        let name = match self.faults.written_in(pointer) {
            WrittenIn::Manifest => joined(self.folder, path),
            WrittenIn::CommandLine
            | WrittenIn::Calibration
            | WrittenIn::Inference
            | WrittenIn::PreviousMap => normalised(path),
        };
        Some(Source::new(name, text))
    }
}
