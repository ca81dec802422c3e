//! What goes into a bundle, as values: the content, the same for everyone, and the circumstances of one run.

use super::{Account, Content, LargeFile, Moment, format, names};
use crate::digest::FileDigest;
use crate::digest::Sha256Digest;
use crate::plan::ResolvedStudy;
use crate::table::DescribedTable;
use std::collections::{BTreeMap, BTreeSet};

/// Everything a bundle says but for who ran it, where and when.
#[derive(Debug, Clone, PartialEq)]
pub struct BundleContent {
    /// The study's short name; begins the bundle's file name.
    pub name: String,
    /// Its title.
    pub title: String,
    /// What it is about, in a sentence or two.
    pub description: String,
    /// What it reproduces.
    pub cite: Option<Publication>,
    /// Who wrote the manifest.
    pub authors: Vec<Person>,
    /// Licence of the bundle: an SPDX identifier, or the address of a text.
    pub license: String,
    /// The experiment's seed.
    pub seed: u64,
    /// The engine that ran it: results are the same only under the same engine.
    pub engine: String,
    /// The manifest, byte for byte.
    pub study_yaml: Vec<u8>,
    /// The manifest with every default, override and factor written out.
    pub resolved: ResolvedStudy,
    /// Every file the manifest names, directly or through another.
    pub inputs: Vec<SealedInput>,
    /// The records, by condition in plan order.
    pub conditions: Vec<SealedCondition>,
    /// Tables, figures and verdicts: paths relative to `results/`, and bytes.
    pub results: Vec<(String, Vec<u8>)>,
    /// Tables of a line for each trial that are not held in memory: paths relative to `results/`.
    pub large_results: Vec<(String, LargeFile)>,
    /// What the columns of CSV files say, also of such as are there only where the machine was measured: paths relative to
    /// the payload.
    pub tables: Vec<DescribedTable>,
    /// Where the table of verdicts at other values of the assumptions is, relative to the payload.
    pub robustness: Option<String>,
    /// Where the table of those at draws of all assumptions together is, relative to the payload.
    pub multiverse: Option<String>,
    /// Whether only part of the study was run.
    pub partial: bool,
    /// What it found, in words.
    pub account: Account,
}

impl BundleContent {
    /// Returns the version of the layout that holds it: the oldest that can.
    pub fn format(&self) -> u64 {
        if in_parts(&self.conditions) { format::IN_PARTS } else { format::WHOLE }
    }
}

/// Returns whether the records of some condition go on in further files. Then no table repeats the curves that are in them.
pub(super) fn in_parts(conditions: &[SealedCondition]) -> bool {
    conditions.iter().any(|condition| condition.parts.len() > 1)
}

/// A person who wrote the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Person {
    /// Full name.
    pub name: String,
    /// Institution.
    pub affiliation: Option<String>,
    /// Its web address, such as `https://ror.org/00wjc7c48`; a search for its name stands in where none is given.
    pub affiliation_url: Option<String>,
    /// Address such as `https://orcid.org/0000-0000-0000-0000`.
    pub orcid: Option<String>,
}

/// The work that the study reproduces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Publication {
    /// The reference in full.
    pub text: String,
    /// Its DOI or other web address.
    pub url: Option<String>,
}

/// A file that the study reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SealedInput {
    /// File name under `inputs/`, unique and portable.
    pub name: String,
    /// The path by which the manifest, or the file that refers to it, names it.
    pub as_written: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Its licence, where it is not the bundle's: an SPDX identifier, an address or words.
    pub license: Option<String>,
}

/// The records of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct SealedCondition {
    /// File name of the cell, as `Condition::slug` makes it.
    pub slug: String,
    /// The cell in words.
    pub label: String,
    /// How many records it has.
    pub trials: usize,
    /// How many of them panicked.
    pub failed: usize,
    /// Canonical record lines in plan order, each ended by a line feed, in files of at most [`super::format::PART`] bytes.
    pub parts: Vec<Content>,
}

/// Gives every file (path as written, bytes, licence) its name under `inputs/`. Files of equal bytes share a name; files
/// whose names clash get a number, in the order given, so that the same study names them alike everywhere.
pub fn seal_inputs(
    files: impl IntoIterator<Item = (String, Vec<u8>, Option<String>)>,
) -> Vec<SealedInput> {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut by_digest: BTreeMap<FileDigest, String> = BTreeMap::new();
    let mut inputs = Vec::new();
    for (as_written, bytes, license) in files {
        let digest = FileDigest(Sha256Digest::of(&bytes));
        let name = by_digest
            .entry(digest)
            .or_insert_with(|| {
                let wanted = names::portable(&as_written);
                let (stem, extension) = wanted.rsplit_once('.').unwrap_or((&wanted, ""));
                let dot = if extension.is_empty() { "" } else { "." };
                let mut name = wanted.clone();
                let mut number = 2;
                while !taken.insert(name.to_ascii_lowercase()) {
                    name = format!("{stem}-{number}{dot}{extension}");
                    number += 1;
                }
                name
            })
            .clone();
        inputs.push(SealedInput { name, as_written, bytes, license });
    }
    inputs
}

/// What differs between two runs of the same study: outside the results digest, inside the checksums.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Circumstance {
    /// Version of the program that sealed the bundle.
    pub version: String,
    /// When the run began.
    pub started: Moment,
    /// When it ended.
    pub ended: Moment,
    /// Host, jobs, toolchain: names and values of one line each. Empty under `SOURCE_DATE_EPOCH`.
    pub environment: Vec<(String, String)>,
    /// What was measured on the machine, and verdicts on it: paths relative to `circumstances/`, and bytes.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Circumstance {
    /// Returns the circumstances of a run that must be byte-identical everywhere: nothing but the given instant.
    pub fn reproducible(at: Moment) -> Self {
        Self {
            version: format::VERSION.to_owned(),
            started: at,
            ended: at,
            environment: Vec::new(),
            files: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_are_named_flat_once_and_apart() {
        let inputs = seal_inputs([
            ("../robots/kobuki.urdf".into(), b"a".to_vec(), None),
            ("other/Kobuki.urdf".into(), b"b".to_vec(), None),
            ("same/again.urdf".into(), b"a".to_vec(), None),
            ("../maps/dépôt 1.pgm".into(), b"c".to_vec(), None),
            ("LICENSE".into(), b"d".to_vec(), None),
            ("x/LICENSE".into(), b"e".to_vec(), None),
        ]);
        let names: Vec<_> = inputs.iter().map(|i| i.name.as_str()).collect();
        let expected =
            ["kobuki.urdf", "Kobuki-2.urdf", "kobuki.urdf", "d-p-t-1.pgm", "LICENSE", "LICENSE-2"];
        assert_eq!(names, expected);
    }
}
