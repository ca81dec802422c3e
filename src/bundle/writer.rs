//! Sealing: content and circumstances become a tree of files whose every byte something vouches for.

use super::path::PAYLOAD;
use super::{
    Bundle, BundleContent, BundlePath, Capsule, Circumstance, Content, FileRef, Files, Form,
    LargeFile, LargeFiles, Limits, Resolved, Tree, archive, bag, citation, crate_metadata,
    data_package, format, in_payload, index, names, preview, readme, results_digest_of,
};
use crate::digest::{BundleId, ResultsDigest, Sha256Digest, StudyDigest};
use std::io::{self, Seek, Write};
use thiserror::Error;

/// Why content cannot be sealed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SealError {
    /// A name that some system could not unpack or some tool could not read.
    #[error(
        "{path}: expected a name of A-Z a-z 0-9 . _ - that every system can unpack, found {found}; rename it"
    )]
    Name {
        /// The path within the payload.
        path: String,
        /// What is wrong with it.
        found: String,
    },
    /// Two files under one name.
    #[error(
        "{path}: expected every file under its own name, found another of the same name (`{other}`)"
    )]
    Clash {
        /// The later file.
        path: String,
        /// The earlier one.
        other: String,
    },
    /// More than readers take.
    #[error(
        "the bundle would hold {files} files of {bytes} bytes: expected at most {} files and {} bytes, so that anyone can \
         check it; run the study in parts (--only), or allow it more with --max-size, as whoever checks it must too",
        limits.entries,
        limits.bytes
    )]
    Size {
        /// How many files.
        files: usize,
        /// Their bytes together.
        bytes: u64,
        /// What was allowed.
        limits: Limits,
    },
    /// More than readers hold in memory.
    #[error(
        "the bundle would hold {bytes} bytes beside its records and the tables of them: expected at most {}, so that anyone can \
         check it; make its inputs smaller",
        limits.held
    )]
    Held {
        /// The bytes of all files that are held.
        bytes: u64,
        /// What was allowed.
        limits: Limits,
    },
}

/// A sealed bundle, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Sealed {
    /// File name without extension: `<name>-<first 8 hex of the results digest>`.
    pub stem: String,
    /// Every file that is in memory.
    pub tree: Tree,
    /// The others.
    pub large: LargeFiles,
    /// What came out.
    pub results_digest: ResultsDigest,
    /// What was asked.
    pub study_digest: StudyDigest,
    /// This very bundle.
    pub bundle_id: BundleId,
}

impl Sealed {
    /// Returns the bundle's file name.
    pub fn file_name(&self) -> String {
        format!("{}.zip", self.stem)
    }

    /// Returns every file.
    pub fn files(&self) -> Files<'_> {
        Files { tree: &self.tree, large: &self.large }
    }

    /// Returns the archive, byte-identical for equal files.
    pub fn zip(&self, form: Form) -> Vec<u8> {
        archive::write_files(self.files(), &self.stem, form)
    }

    /// Writes the same archive to `out`, file by file.
    ///
    /// # Errors
    /// Where it cannot be written, or a large file not be read.
    pub fn write(&self, form: Form, out: impl Write + Seek) -> io::Result<()> {
        archive::write_to(self.files(), &self.stem, form, out)
    }
}

/// Seals `content`.
///
/// # Errors
/// Where a name is unsafe or taken, a record is not one line, or the whole is more than readers take.
pub fn seal(content: &BundleContent, circumstance: &Circumstance) -> Result<Sealed, SealError> {
    seal_with(content, circumstance, Additions::default())
}

/// What a bundle holds beside content and circumstances.
#[derive(Debug, Clone, Copy, Default)]
pub struct Additions<'a> {
    /// The source of the engine that ran it.
    pub source: Option<&'a Capsule>,
    /// What readers take.
    pub limits: Limits,
}

/// Seals `content` together with `additions`.
///
/// # Errors
/// As [`seal`].
pub fn seal_with(
    content: &BundleContent,
    circumstance: &Circumstance,
    additions: Additions<'_>,
) -> Result<Sealed, SealError> {
    let mut payload = Payload::default();
    payload.add(format::STUDY, content.study_yaml.clone())?;
    let resolved = Resolved::of(content).to_bytes();
    let study_digest = StudyDigest(Sha256Digest::of(&resolved));
    payload.add(format::RESOLVED, resolved)?;
    for input in &content.inputs {
        payload.add_shared(&format!("{}{}", format::INPUTS, input.name), &input.bytes)?;
    }
    for condition in &content.conditions {
        for (part, lines) in (1..).zip(&condition.parts) {
            payload.add_content(&format::records_part(&condition.slug, part), lines)?;
        }
    }
    for (path, bytes) in &content.results {
        payload.add(&format!("{}{path}", format::RESULTS), bytes.clone())?;
    }
    for (path, file) in &content.large_results {
        payload.add_large(&format!("{}{path}", format::RESULTS), file.clone())?;
    }
    let results_digest = results_digest_of(payload.files());
    for (path, bytes) in &circumstance.files {
        payload.add(&format!("{}{path}", format::CIRCUMSTANCES), bytes.clone())?;
    }
    let stem = format!("{}-{}", content.name, results_digest.short());
    check_name(&stem)?;

    if let Some(capsule) = additions.source {
        payload.add(&capsule.path, capsule.bytes.clone())?;
    }
    let there = |path: &String| payload.files().get(&BundlePath::payload(path)).is_some();
    let tables: Vec<_> =
        content.tables.iter().filter(|table| there(&table.path)).cloned().collect();
    let package = data_package::package(content, &tables, payload.files(), results_digest);
    payload.add(format::DATA_PACKAGE, package)?;
    payload.add(format::DICTIONARY, data_package::dictionary(content, &tables).into())?;
    payload.add(format::CITATION, citation::cff(content, circumstance, results_digest).into())?;
    payload.add(format::ZENODO, citation::zenodo(content, results_digest))?;
    payload.add(format::INDEX, index::page(content, &stem, results_digest).into())?;
    let readme = readme::readme(content, circumstance, results_digest, additions);
    payload.add(format::README, readme.into())?;
    payload.add(format::LICENSE, readme::license(content).into())?;
    let metadata = crate_metadata::document(
        content,
        circumstance,
        payload.files(),
        results_digest,
        study_digest,
    );
    payload.add(format::METADATA, metadata)?;
    let page = preview::page(content, circumstance, payload.files(), results_digest);
    payload.add(format::PREVIEW, page.into())?;

    let digests = (results_digest, study_digest);
    let Payload { tree, large, .. } = payload;
    let facts = Facts { format: content.format(), digests, partial: content.partial };
    let (tree, bundle_id) = bagged(tree, &large, Some(circumstance), facts);
    check_size(Files { tree: &tree, large: &large }, additions.limits)?;
    Ok(Sealed { stem, tree, large, results_digest, study_digest, bundle_id })
}

#[derive(Default)]
struct Payload {
    tree: Tree,
    large: LargeFiles,
    names: names::Names,
}

impl Payload {
    fn files(&self) -> Files<'_> {
        Files { tree: &self.tree, large: &self.large }
    }

    /// Enters the name of a file, and returns its path in the bag.
    fn enter(&mut self, path: &str) -> Result<String, SealError> {
        check_name(path)?;
        let path = String::from(BundlePath::payload(path));
        match self.names.enter(&path) {
            Some(other) => Err(SealError::Clash { path, other }),
            None => Ok(path),
        }
    }

    fn add(&mut self, path: &str, bytes: Vec<u8>) -> Result<(), SealError> {
        let path = self.enter(path)?;
        self.tree.insert(path, bytes);
        Ok(())
    }

    fn add_large(&mut self, path: &str, file: LargeFile) -> Result<(), SealError> {
        let path = self.enter(path)?;
        self.large.insert(path, file);
        Ok(())
    }

    fn add_content(&mut self, path: &str, content: &Content) -> Result<(), SealError> {
        match content {
            Content::Held(bytes) => self.add(path, bytes.clone()),
            Content::Large(file) => self.add_large(path, file.clone()),
        }
    }

    /// Adds a file that may be there already, if its bytes are the same.
    fn add_shared(&mut self, path: &str, bytes: &[u8]) -> Result<(), SealError> {
        match self.tree.get(&*BundlePath::payload(path)) {
            Some(known) if known == bytes => Ok(()),
            _ => self.add(path, bytes.to_vec()),
        }
    }
}

fn check_name(path: &str) -> Result<(), SealError> {
    let found = match names::hazard(path) {
        Some(hazard) => hazard.to_owned(),
        None if !names::is_portable(path) => format!("`{}`", path.escape_default()),
        // roc-validator resolves payload paths that hold `data/` against the wrong folder.
        None if path.contains(PAYLOAD) => "a folder whose name ends in `data`".to_owned(),
        None => return Ok(()),
    };
    Err(SealError::Name { path: path.to_owned(), found })
}

/// Returns the files of `bundle` in a bag, those in memory and the others: as they are, or in a new one where only the crate is
/// there.
pub fn in_bag(bundle: &Bundle) -> (Tree, LargeFiles) {
    let (tree, large) = (bundle.tree(), bundle.large());
    if bundle.form() != Form::Crate {
        return (tree.clone(), large.clone());
    }
    (bagged(payload_of(tree), large, None, facts_of(bundle)).0, large.clone())
}

/// Returns what `bag-info.txt` says of `bundle`, with the circumstances of its run or without any.
pub fn in_bag_info(bundle: &Bundle, circumstance: Option<&Circumstance>) -> bag::BagInfo {
    let payload = payload_of(bundle.tree());
    info_of(Files { tree: &payload, large: bundle.large() }, circumstance, facts_of(bundle))
}

/// Returns the files of the payload that are in memory.
fn payload_of(tree: &Tree) -> Tree {
    let payload = tree.iter().filter(|(path, _)| in_payload(path).is_some());
    payload.map(|(path, bytes)| (path.clone(), bytes.clone())).collect()
}

/// What a bag says of its payload.
#[derive(Clone, Copy)]
struct Facts {
    format: u64,
    digests: (ResultsDigest, StudyDigest),
    partial: bool,
}

fn facts_of(bundle: &Bundle) -> Facts {
    let digests = (bundle.results_digest(), bundle.study_digest());
    // A bundle that claims another format than ours is bagged by us all the same.
    let format = bundle.format().clamp(format::WHOLE, format::FORMAT);
    Facts { format, digests, partial: bundle.is_partial() }
}

fn info_of(payload: Files<'_>, circumstance: Option<&Circumstance>, facts: Facts) -> bag::BagInfo {
    let Facts { format, digests: (results, study), partial } = facts;
    let uuid = uuid(&Sha256Digest::of(bag::manifest(payload.iter())));
    bag::BagInfo::of(payload, format, circumstance, results, study, partial, &uuid)
}

/// Returns `payload` with the tag files of its bag, which covers the `large` files of the payload too.
fn bagged(
    payload: Tree,
    large: &LargeFiles,
    circumstance: Option<&Circumstance>,
    facts: Facts,
) -> (Tree, BundleId) {
    let mut tree = payload;
    let files = Files { tree: &tree, large };
    let manifest = bag::manifest(files.iter());
    let info = info_of(files, circumstance, facts);
    let mut tags = Tree::new();
    tags.insert(format::BAGIT.to_owned(), bag::DECLARATION.into());
    tags.insert(format::BAG_INFO.to_owned(), info.to_text().into_bytes());
    tags.insert(format::MANIFEST.to_owned(), manifest.into_bytes());
    let listed = tags.iter().map(|(path, bytes)| (path, FileRef::Held(bytes)));
    let tag_manifest = bag::manifest(listed).into_bytes();
    let bundle_id = BundleId(Sha256Digest::of(&tag_manifest));
    tags.insert(format::TAG_MANIFEST.to_owned(), tag_manifest);
    tree.append(&mut tags);
    (tree, bundle_id)
}

/// Checks that readers that keep to `limits` take `files`.
fn check_size(files: Files<'_>, limits: Limits) -> Result<(), SealError> {
    let bytes = files.iter().map(|(_, file)| file.size()).sum();
    let held = files.tree.values().map(|bytes| bytes.len() as u64).sum();
    let count = files.len();
    if held > limits.held {
        Err(SealError::Held { bytes: held, limits })
    } else if bytes > limits.bytes || count > limits.entries {
        Err(SealError::Size { files: count, bytes, limits })
    } else {
        Ok(())
    }
}

/// Makes a UUID of version 8 of the first bits of `digest` (RFC 9562, section 5.8 and appendix B.2).
fn uuid(digest: &Sha256Digest) -> String {
    let mut bytes = digest.0;
    bytes[6] = bytes[6] & 0x0f | 0x80;
    bytes[8] = bytes[8] & 0x3f | 0x80;
    let hex = Sha256Digest(bytes).hex();
    format!("{}-{}-{}-{}-{}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..32])
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn the_results_digest_can_be_had_from_the_manifest_alone() {
        let sealed = sample::sealed();
        let manifest = String::from_utf8(sealed.tree[format::MANIFEST].clone()).unwrap();
        let mut lines: Vec<String> = manifest
            .lines()
            .map(|line| line.replacen("  data/", "  ", 1))
            .filter(|line| super::super::in_result_half(&line[66..]))
            .map(|line| line + "\n")
            .collect();
        lines.sort();
        assert_eq!(Sha256Digest::of(lines.concat()), sealed.results_digest.0);
        assert_eq!(sealed.stem, format!("corridors-{}", sealed.results_digest.short()));
    }

    #[test]
    fn circumstances_do_not_touch_the_result_half() {
        let content = sample::content();
        let mut circumstance = sample::circumstance();
        let first = seal(&content, &circumstance).unwrap();
        circumstance.ended = super::super::Moment(2_000_000_000);
        circumstance.environment = vec![("jobs".into(), "64".into())];
        let second = seal(&content, &circumstance).unwrap();
        assert_eq!(first.results_digest, second.results_digest);
        assert_eq!(first.study_digest, second.study_digest);
        assert_ne!(first.bundle_id, second.bundle_id);
        let changed: Vec<_> =
            first.tree.iter().filter(|(p, b)| second.tree[*p] != **b).map(|(p, _)| p).collect();
        let expected = [
            "bag-info.txt",
            "data/CITATION.cff",
            "data/ro-crate-metadata.json",
            "data/ro-crate-preview.html",
            "manifest-sha256.txt",
            "tagmanifest-sha256.txt",
        ];
        assert_eq!(changed, expected);
    }

    #[test]
    fn what_readers_would_refuse_is_not_sealed() {
        let mut content = sample::content();
        content.results = vec![("big".into(), vec![b'x'; 48 << 20])];
        let error = seal(&content, &sample::circumstance()).unwrap_err();
        let SealError::Held { bytes, .. } = error else { panic!("{error}") };
        assert!(bytes > 48 << 20, "{bytes} bytes");
        assert_eq!(
            error.to_string(),
            format!(
                "the bundle would hold {bytes} bytes beside its records and the tables of them: expected at most 50331648, so \
                 that anyone can check it; make its inputs smaller"
            )
        );
        let limits = Limits { bytes: 1000, ..Limits::default() };
        let additions = Additions { limits, ..Additions::default() };
        let small = sample::content();
        let error = seal_with(&small, &sample::circumstance(), additions).unwrap_err();
        let SealError::Size { files, bytes, .. } = error else { panic!("{error}") };
        assert_eq!(
            error.to_string(),
            format!(
                "the bundle would hold {files} files of {bytes} bytes: expected at most 20000 files and 1000 bytes, so that anyone can \
                 check it; run the study in parts (--only), or allow it more with --max-size, as whoever checks it must too"
            )
        );
    }

    #[test]
    fn unsafe_names_are_refused() {
        let refusal = |path: &str| {
            let mut content = sample::content();
            content.results = vec![(path.into(), Vec::new())];
            seal(&content, &sample::circumstance()).unwrap_err().to_string()
        };
        assert_eq!(
            refusal("../x"),
            "results/../x: expected a name of A-Z a-z 0-9 . _ - that every system can unpack, found a path that climbs \
             out of its folder; rename it"
        );
        assert_eq!(
            refusal("table 1.csv"),
            "results/table 1.csv: expected a name of A-Z a-z 0-9 . _ - that every system can unpack, found `results/table \
             1.csv`; rename it"
        );
        assert_eq!(
            refusal("metadata/x"),
            "results/metadata/x: expected a name of A-Z a-z 0-9 . _ - that every system can unpack, found a folder whose \
             name ends in `data`; rename it"
        );
        let mut content = sample::content();
        content.results = vec![("a".into(), Vec::new()), ("A".into(), Vec::new())];
        assert_eq!(
            seal(&content, &sample::circumstance()).unwrap_err().to_string(),
            "data/results/A: expected every file under its own name, found another of the same name (`data/results/a`)"
        );
    }
}
