//! Sealing: content and circumstances become a tree of files whose every byte something vouches for.

use super::path::PAYLOAD;
use super::{
    Bundle, BundleContent, BundlePath, Capsule, Circumstance, Form, Limits, Resolved, Tree,
    archive, bag, citation, crate_metadata, data_package, format, in_payload, names, preview,
    readme, results_digest,
};
use crate::digest::{BundleId, ResultsDigest, Sha256Digest, StudyDigest};
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
         check it; run the study in parts (--only), or make it smaller",
        Limits::default().entries,
        Limits::default().bytes
    )]
    Size {
        /// How many files.
        files: usize,
        /// Their bytes together.
        bytes: u64,
    },
    /// A record that spans lines.
    #[error("{path}: expected one line for each record, found a line feed in record {record}")]
    Record {
        /// The condition's file.
        path: String,
        /// Index of the record.
        record: usize,
    },
}

/// A sealed bundle, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Sealed {
    /// File name without extension: `<name>-<first 8 hex of the results digest>`.
    pub stem: String,
    /// Every file.
    pub tree: Tree,
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

    /// Writes the archive, byte-identical for equal trees.
    pub fn zip(&self, form: Form) -> Vec<u8> {
        archive::write(&self.tree, &self.stem, form)
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
        let path = format::records_path(&condition.slug);
        let mut lines = String::new();
        for (record, line) in condition.records.iter().enumerate() {
            if line.contains('\n') {
                return Err(SealError::Record { path, record });
            }
            lines.push_str(line);
            lines.push('\n');
        }
        payload.add(&path, lines.into_bytes())?;
    }
    for (path, bytes) in &content.results {
        payload.add(&format!("{}{path}", format::RESULTS), bytes.clone())?;
    }
    let results_digest = results_digest(&payload.tree);
    for (path, bytes) in &circumstance.files {
        payload.add(&format!("{}{path}", format::CIRCUMSTANCES), bytes.clone())?;
    }
    let stem = format!("{}-{}", content.name, results_digest.short());
    check_name(&stem)?;

    if let Some(capsule) = additions.source {
        payload.add(&capsule.path, capsule.bytes.clone())?;
    }
    let there = |path: &String| payload.tree.contains_key(&*BundlePath::payload(path));
    let tables: Vec<_> =
        content.tables.iter().filter(|table| there(&table.path)).cloned().collect();
    let package = data_package::package(content, &tables, &payload.tree, results_digest);
    payload.add(format::DATA_PACKAGE, package)?;
    payload.add(format::DICTIONARY, data_package::dictionary(content, &tables).into())?;
    payload.add(format::CITATION, citation::cff(content, circumstance, results_digest).into())?;
    payload.add(format::ZENODO, citation::zenodo(content, results_digest))?;
    let readme = readme::readme(content, circumstance, results_digest, additions);
    payload.add(format::README, readme.into())?;
    payload.add(format::LICENSE, readme::license(content).into())?;
    let metadata = crate_metadata::document(
        content,
        circumstance,
        &payload.tree,
        results_digest,
        study_digest,
    );
    payload.add(format::METADATA, metadata)?;
    let page = preview::page(content, circumstance, &payload.tree, results_digest);
    payload.add(format::PREVIEW, page.into())?;

    let digests = (results_digest, study_digest);
    let (tree, bundle_id) = bagged(payload.tree, Some(circumstance), digests, content.partial);
    check_size(&tree, &Limits::default())?;
    Ok(Sealed { stem, tree, results_digest, study_digest, bundle_id })
}

#[derive(Default)]
struct Payload {
    tree: Tree,
    names: names::Names,
}

impl Payload {
    fn add(&mut self, path: &str, bytes: Vec<u8>) -> Result<(), SealError> {
        check_name(path)?;
        let path = String::from(BundlePath::payload(path));
        if let Some(other) = self.names.enter(&path) {
            return Err(SealError::Clash { path, other });
        }
        self.tree.insert(path, bytes);
        Ok(())
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

/// Returns the files of `bundle` in a bag: as they are, or in a new one where only the crate is there.
pub fn in_bag(bundle: &Bundle) -> Tree {
    if bundle.form() != Form::Crate {
        return bundle.tree().clone();
    }
    let payload = bundle.tree().iter().filter(|(path, _)| in_payload(path).is_some());
    let payload = payload.map(|(path, bytes)| (path.clone(), bytes.clone())).collect();
    let digests = (bundle.results_digest(), bundle.study_digest());
    bagged(payload, None, digests, bundle.is_partial()).0
}

/// Returns what `bag-info.txt` says of `bundle`, with the circumstances of its run or without any.
pub fn in_bag_info(bundle: &Bundle, circumstance: Option<&Circumstance>) -> bag::BagInfo {
    let payload = bundle.tree().iter().filter(|(path, _)| in_payload(path).is_some());
    let payload: Tree = payload.map(|(path, bytes)| (path.clone(), bytes.clone())).collect();
    let digests = (bundle.results_digest(), bundle.study_digest());
    info_of(&payload, circumstance, digests, bundle.is_partial())
}

fn info_of(
    payload: &Tree,
    circumstance: Option<&Circumstance>,
    (results, study): (ResultsDigest, StudyDigest),
    partial: bool,
) -> bag::BagInfo {
    let uuid = uuid(&Sha256Digest::of(bag::manifest(payload)));
    bag::BagInfo::of(payload, circumstance, results, study, partial, &uuid)
}

/// Returns `payload` with the tag files of its bag.
fn bagged(
    payload: Tree,
    circumstance: Option<&Circumstance>,
    digests: (ResultsDigest, StudyDigest),
    partial: bool,
) -> (Tree, BundleId) {
    let mut tree = payload;
    let manifest = bag::manifest(&tree);
    let info = info_of(&tree, circumstance, digests, partial);
    let mut tags = Tree::new();
    tags.insert(format::BAGIT.to_owned(), bag::DECLARATION.into());
    tags.insert(format::BAG_INFO.to_owned(), info.to_text().into_bytes());
    tags.insert(format::MANIFEST.to_owned(), manifest.into_bytes());
    let tag_manifest = bag::manifest(&tags).into_bytes();
    let bundle_id = BundleId(Sha256Digest::of(&tag_manifest));
    tags.insert(format::TAG_MANIFEST.to_owned(), tag_manifest);
    tree.append(&mut tags);
    (tree, bundle_id)
}

/// Checks that readers that keep to `limits` take `tree`.
fn check_size(tree: &Tree, limits: &Limits) -> Result<(), SealError> {
    let bytes = tree.values().map(|bytes| bytes.len() as u64).sum();
    let fits = bytes <= limits.bytes && tree.len() <= limits.entries;
    if fits { Ok(()) } else { Err(SealError::Size { files: tree.len(), bytes }) }
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
        let SealError::Size { files, bytes } = error else { panic!("{error}") };
        assert!(files == 19 && bytes > 48 << 20, "{files} files, {bytes} bytes");
        assert_eq!(
            error.to_string(),
            format!(
                "the bundle would hold 19 files of {bytes} bytes: expected at most 20000 files and 50331648 bytes, so that \
                 anyone can check it; run the study in parts (--only), or make it smaller"
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
        let mut content = sample::content();
        content.conditions[0].records[1].push('\n');
        assert_eq!(
            seal(&content, &sample::circumstance()).unwrap_err().to_string(),
            "trials/none.jsonl: expected one line for each record, found a line feed in record 1"
        );
    }
}
