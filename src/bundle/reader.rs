//! A bundle by meaning: what an opened archive says, with every reference inside it resolved.

use super::{
    Archive, BundlePath, Circumstance, ConditionEntry, Fault, FileRef, Files, Form, Gathered,
    Gathering, InputEntry, LargeFiles, Limits, Lines, Resolved, Scratch, Tree, archive, bag,
    format, in_payload, results_digest_of, told,
};
use crate::digest::{BundleId, ResultsDigest, Sha256Digest, StudyDigest, TrialKey};
use crate::plan::{Plan, ResolvedStudy, StudyInput};
use crate::studies::TrialRecord;
use thiserror::Error;

/// Why a bundle cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum OpenError {
    /// The archive is broken, hostile or no bundle.
    #[error("this is no archive to read: {}", list(.0))]
    Unsafe(Vec<Fault>),
    /// A newer program wrote it.
    #[error("{0}")]
    Newer(Fault),
    /// Something without which the rest makes no sense is missing or unreadable.
    #[error("the bundle is damaged: {}", list(.0))]
    Damaged(Vec<Fault>),
}

fn list(faults: &[Fault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// The most memory (bytes) that a bundle's records may take: honest ones take about as much as their text, of which
/// [`Limits`] leaves less.
const HEAVIEST_RECORDS: usize = 80 << 20;

/// A readable bundle. That it is what it says is for `verify` to find out.
///
/// ```
/// use reenact::bundle::{Bundle, Limits};
///
/// let zip = std::fs::read("artifacts/quickstart-published.zip").unwrap();
/// let bundle = Bundle::read(&zip, &Limits::default()).unwrap();
/// let records = bundle.records().unwrap();
/// assert_eq!(records[0].condition.value("prior"), Some("none"));
/// assert!(records.iter().all(|record| record.measures["distance-m"] > Some(0.0)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bundle {
    form: Form,
    tree: Tree,
    large: LargeFiles,
    resolved: Resolved,
    study_inputs: Vec<StudyInput>,
}

impl Bundle {
    /// Reads a zip.
    ///
    /// # Errors
    /// As [`OpenError`] says.
    pub fn read(bytes: &[u8], limits: &Limits) -> Result<Self, OpenError> {
        Self::open(archive::read(bytes, limits).map_err(OpenError::Unsafe)?)
    }

    /// Reads an opened archive or folder.
    ///
    /// # Errors
    /// [`OpenError::Newer`] for a newer format, [`OpenError::Damaged`] where the manifest, the resolved study or a
    /// file that it names is missing or unreadable.
    pub fn open(archive: Archive) -> Result<Self, OpenError> {
        let Archive { form, tree, large } = archive;
        let files = Files { tree: &tree, large: &large };
        check_version(&tree).map_err(OpenError::Newer)?;
        let missing = |path: &str, of: &str| Fault::new(BundlePath::payload(path), of, "no file");
        let payload = |path: &str| tree.get(&*BundlePath::payload(path));
        let mut faults = Vec::new();
        if payload(format::STUDY).is_none() {
            faults.push(missing(format::STUDY, "the manifest"));
        }
        let resolved = match payload(format::RESOLVED).map(|bytes| Resolved::read(bytes)) {
            Some(Ok(resolved)) => resolved,
            Some(Err(fault)) => return Err(OpenError::Damaged(vec![fault])),
            None => {
                faults.push(missing(format::RESOLVED, "the resolved study"));
                return Err(OpenError::Damaged(faults));
            }
        };
        for input in resolved.inputs.iter().filter(|input| payload(&input.path).is_none()) {
            faults.push(missing(&input.path, &format!("the input `{}`", input.as_written)));
        }
        for condition in &resolved.conditions {
            let mut parts = record_parts(files, &condition.slug).peekable();
            if parts.peek().is_none() {
                let path = format::records_path(&condition.slug);
                faults.push(missing(&path, "the condition's records"));
            }
            for (path, _) in parts.filter(|(_, file)| !file.is_text()) {
                faults.push(Fault::new(path, "UTF-8 text", "other bytes"));
            }
        }
        if faults.is_empty() {
            // What is no input is reported at level 3, where the whole document is derived again.
            let inputs = resolved.study.inputs.read().unwrap_or_default();
            let study_inputs = inputs.iter().filter_map(|input| input.read().ok()).collect();
            Ok(Self { form, tree, large, resolved, study_inputs })
        } else {
            Err(OpenError::Damaged(faults))
        }
    }

    /// Returns how the bundle was laid out.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Returns every file that is in memory, by its path in the bag.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Returns every file that is not in memory, by its path in the bag: of records, and of tables that have a line for each trial.
    pub fn large(&self) -> &LargeFiles {
        &self.large
    }

    /// Returns every file, by its path in the bag.
    pub fn files(&self) -> Files<'_> {
        Files { tree: &self.tree, large: &self.large }
    }

    /// Returns the study's short name.
    pub fn name(&self) -> &str {
        &self.resolved.name
    }

    /// Returns the engine that ran it.
    pub fn engine(&self) -> &str {
        &self.resolved.engine
    }

    /// Returns the version of the bundle's layout and of what is derived.
    pub fn format(&self) -> u64 {
        self.resolved.bundle_format
    }

    /// Returns whether only part of the study was run.
    pub fn is_partial(&self) -> bool {
        self.resolved.partial
    }

    /// Returns the manifest, byte for byte.
    pub fn study_yaml(&self) -> &[u8] {
        self.payload(format::STUDY).unwrap_or_default()
    }

    /// Returns the study with everything resolved, as `run` sealed it.
    pub fn resolved(&self) -> &ResolvedStudy {
        &self.resolved.study
    }

    /// Returns every input by every path it is known by.
    pub fn inputs(&self) -> &[InputEntry] {
        &self.resolved.inputs
    }

    /// Returns what the resolved study says of the input at `path` within the payload.
    pub fn resolved_input(&self, path: &str) -> Option<&StudyInput> {
        let known = &self.resolved.inputs;
        let entry = known.iter().find(|input| input.path == path)?;
        self.study_inputs.iter().find(|input| input.as_written == entry.as_written)
    }

    /// Returns the bytes of the input that the study calls `as_written`.
    pub fn input(&self, as_written: &str) -> Option<&[u8]> {
        let entry = self.resolved.inputs.iter().find(|input| input.as_written == as_written)?;
        self.payload(&entry.path)
    }

    /// Returns the conditions in plan order.
    pub fn conditions(&self) -> &[ConditionEntry] {
        &self.resolved.conditions
    }

    /// Returns the files of a condition's records, in their order, by their paths in the bag; none where there is no such condition.
    pub fn record_parts(&self, slug: &str) -> impl Iterator<Item = (String, FileRef<'_>)> {
        record_parts(self.files(), slug)
    }

    /// Hands over the record lines of a condition, in plan order, until `take` says not to go on; none where there is no such
    /// condition.
    pub fn record_lines(&self, slug: &str, mut take: impl FnMut(RecordLine<'_>) -> bool) {
        let mut lines = self.record_reader(slug);
        while let Some(line) = lines.next_line() {
            if !take(line) {
                return;
            }
        }
    }

    /// Returns the record lines of a condition one by one, in plan order; none where there is no such condition.
    pub fn record_reader(&self, slug: &str) -> RecordLines<'_> {
        let parts: Vec<_> = self.record_parts(slug).collect();
        RecordLines { parts: parts.into_iter(), open: None }
    }

    /// Counts the record lines of a condition.
    pub fn record_count(&self, slug: &str) -> usize {
        self.record_parts(slug).map(|(_, file)| file.line_count()).sum()
    }

    /// Gathers all records, in plan order, for the content of the bundle of `plan`; what of it is large is written to `scratch`.
    ///
    /// # Errors
    /// Every line that is no record, up to a hundred; and where all of them together would take more memory than honest ones can,
    /// or cannot be written.
    pub fn gathered(&self, plan: &Plan, scratch: &dyn Scratch) -> Result<Gathered, Vec<Fault>> {
        const MOST_FAULTS: usize = 100;
        let unwritten = |error: std::io::Error| {
            let path = BundlePath::payload(format::TRIALS);
            vec![Fault::new(path, "records that can be written again", error.to_string())]
        };
        let mut gathering = Gathering::new(plan, scratch);
        let (mut faults, mut ended, mut weight, mut text) = (Vec::new(), None, 0, 0);
        for condition in &self.resolved.conditions {
            self.record_lines(&condition.slug, |line| {
                text += line.text.len();
                match TrialRecord::from_line(line.text) {
                    Ok(record) => {
                        weight += gathering.weight_of(&record);
                        if weight > HEAVIEST_RECORDS + text {
                            ended = Some(vec![too_heavy()]);
                        } else if let Err(error) = gathering.take(&record) {
                            ended = Some(unwritten(error));
                        }
                    }
                    Err(problem) => {
                        faults.push(Fault::new(
                            line.place(),
                            "a trial record",
                            problem.to_string(),
                        ));
                    }
                }
                ended.is_none() && faults.len() < MOST_FAULTS
            });
            if let Some(ended) = ended {
                return Err(ended);
            }
        }
        if faults.is_empty() { gathering.finish().map_err(unwritten) } else { Err(faults) }
    }

    /// Reads all records into memory, in plan order.
    ///
    /// # Errors
    /// Every line that is no record; and where all of them together would take more memory than honest ones can.
    pub fn records(&self) -> Result<Vec<TrialRecord>, Vec<Fault>> {
        let (mut records, mut faults) = (Vec::new(), Vec::new());
        let mut weight = 0;
        for condition in &self.resolved.conditions {
            self.record_lines(&condition.slug, |line| {
                match TrialRecord::from_line(line.text) {
                    Ok(record) => {
                        weight += record.weight();
                        records.push(record);
                    }
                    Err(problem) => {
                        faults.push(Fault::new(
                            line.place(),
                            "a trial record",
                            problem.to_string(),
                        ));
                    }
                }
                weight <= HEAVIEST_RECORDS
            });
            if weight > HEAVIEST_RECORDS {
                return Err(vec![too_heavy()]);
            }
        }
        if faults.is_empty() { Ok(records) } else { Err(faults) }
    }

    /// Returns the record of the trial with this key; none where there is no such trial.
    ///
    /// # Errors
    /// The first line before it that is no record.
    pub fn record(&self, key: &TrialKey) -> Result<Option<TrialRecord>, Fault> {
        let mut found = Ok(None);
        for condition in &self.resolved.conditions {
            self.record_lines(&condition.slug, |line| {
                match TrialRecord::from_line(line.text) {
                    Ok(record) if record.key == *key => found = Ok(Some(record)),
                    Ok(_) => return true,
                    Err(problem) => {
                        let problem = problem.to_string();
                        found = Err(Fault::new(line.place(), "a trial record", problem));
                    }
                }
                false
            });
            if !matches!(found, Ok(None)) {
                break;
            }
        }
        found
    }

    /// Returns the file `path` under `results/`.
    pub fn result(&self, path: &str) -> Option<&[u8]> {
        self.payload(&format!("{}{path}", format::RESULTS))
    }

    /// Returns every file under `results/`, also those that are not in memory, by its path there.
    pub fn result_files(&self) -> impl Iterator<Item = (&str, FileRef<'_>)> {
        self.files().iter().filter_map(|(path, file)| {
            Some((in_payload(path)?.strip_prefix(format::RESULTS)?, file))
        })
    }

    /// Returns every file under `results/` that is in memory, by its path there.
    pub fn results(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.under(format::RESULTS)
    }

    fn under(&self, folder: &'static str) -> impl Iterator<Item = (&str, &[u8])> {
        self.tree.iter().filter_map(move |(path, bytes)| {
            let path = in_payload(path)?.strip_prefix(folder)?;
            Some((path, bytes.as_slice()))
        })
    }

    /// Computes the digest of what came out from the files themselves.
    pub fn results_digest(&self) -> ResultsDigest {
        results_digest_of(self.files())
    }

    /// Computes the digest of what was asked from the resolved study.
    pub fn study_digest(&self) -> StudyDigest {
        StudyDigest(Sha256Digest::of(self.payload(format::RESOLVED).unwrap_or_default()))
    }

    /// Returns the identifier of this very bundle; a bare crate has no bag to identify.
    pub fn bundle_id(&self) -> Option<BundleId> {
        self.tree.get(format::TAG_MANIFEST).map(|bytes| BundleId(Sha256Digest::of(bytes)))
    }

    /// Returns the circumstances of the run, where the crate's metadata states them as this program writes them.
    pub fn circumstance(&self) -> Option<Circumstance> {
        let told = told::circumstance(&self.tree)?;
        let files = self.circumstance_files();
        let files = files.map(|(path, bytes)| (path.to_owned(), bytes.to_vec())).collect();
        Some(Circumstance { files, ..told })
    }

    /// Returns every file under `circumstances/`, by its path there: what the machine of the run measured.
    pub fn circumstance_files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.under(format::CIRCUMSTANCES)
    }

    /// Returns the first file where the engine's own source lies, by its path in the bag. It is data, never to be run.
    pub fn capsule(&self) -> Option<&str> {
        let folder = BundlePath::payload(format::ENGINE);
        self.tree.keys().find(|path| path.starts_with(&*folder)).map(String::as_str)
    }

    fn payload(&self, path: &str) -> Option<&[u8]> {
        self.tree.get(&*BundlePath::payload(path)).map(Vec::as_slice)
    }
}

/// A line of a file of records.
#[derive(Debug, Clone, Copy)]
pub struct RecordLine<'a> {
    /// The file, by its path in the bag.
    pub path: &'a str,
    /// The line's number in it, from 1.
    pub number: usize,
    /// The line.
    pub text: &'a str,
}

impl RecordLine<'_> {
    /// Returns where it stands: `data/trials/none.jsonl:2`.
    pub fn place(&self) -> String {
        format!("{}:{}", self.path, self.number)
    }
}

/// The record lines of a condition, over all its files.
#[derive(Debug)]
pub struct RecordLines<'a> {
    parts: std::vec::IntoIter<(String, FileRef<'a>)>,
    open: Option<(String, usize, Lines<'a>)>,
}

impl RecordLines<'_> {
    /// Returns the next one; `None` at the end.
    pub fn next_line(&mut self) -> Option<RecordLine<'_>> {
        while !self.open.as_mut().is_some_and(|(_, number, lines)| {
            *number += 1;
            lines.advance()
        }) {
            let (path, file) = self.parts.next()?;
            self.open = Some((path, 0, file.line_reader()));
        }
        let (path, number, lines) = self.open.as_ref()?;
        Some(RecordLine { path, number: *number, text: lines.line() })
    }
}

fn record_parts<'f>(
    files: Files<'f>,
    slug: &str,
) -> impl Iterator<Item = (String, FileRef<'f>)> + use<'f> {
    let slug = slug.to_owned();
    (1..).map_while(move |part| {
        let path = BundlePath::payload(&format::records_part(&slug, part));
        let file = files.get(&path)?;
        Some((path.into(), file))
    })
}

fn too_heavy() -> Fault {
    let expected = format!("records that take at most {} MiB of memory", HEAVIEST_RECORDS >> 20);
    Fault::new(BundlePath::payload(format::TRIALS), expected, "more")
}

/// Checks that this program reads the version, which stands in the bag's facts and in the resolved study; either may
/// ask for a newer program.
pub(crate) fn check_version(tree: &Tree) -> Result<(), Fault> {
    #[derive(serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    struct Version {
        bundle_format: u64,
    }
    let resolved_path = BundlePath::payload(format::RESOLVED);
    let info = tree.get(format::BAG_INFO).map(|bytes| bag::BagInfo::parse(bytes));
    let stated = [
        (format::BAG_INFO, info.as_ref().and_then(|info| info.get("Bundle-Format")?.parse().ok())),
        (
            &*resolved_path,
            tree.get(&*resolved_path)
                .and_then(|bytes| serde_json::from_slice::<Version>(bytes).ok())
                .map(|version| version.bundle_format),
        ),
    ];
    for (path, version) in stated {
        if let Some(newer) = version.filter(|version| *version > format::FORMAT) {
            return format::check(path, newer);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn what_was_sealed_is_read_back_by_meaning() {
        let (content, sealed) = (sample::content(), sample::sealed());
        let bundle = Bundle::read(&sealed.zip(Form::Bag), &Limits::default()).unwrap();
        assert_eq!(bundle.name(), "corridors");
        assert_eq!(bundle.study_yaml(), content.study_yaml);
        assert_eq!(bundle.resolved(), &content.resolved);
        assert_eq!(bundle.input("../worlds/a.yaml"), Some(&b"walls: [1]\n"[..]));
        assert_eq!(bundle.input("../worlds/none.yaml"), None);
        let slugs: Vec<_> = bundle.conditions().iter().map(|c| c.slug.as_str()).collect();
        assert_eq!(slugs, ["none", "floor-plan"], "plan order, not alphabetical");
        let lines: Vec<String> = content
            .conditions
            .iter()
            .flat_map(|c| &c.parts)
            .flat_map(|part| {
                let mut lines = Vec::new();
                part.as_file().lines(|line| {
                    lines.push(line.to_owned());
                    true
                });
                lines
            })
            .collect();
        let back: Vec<_> = bundle.records().unwrap().iter().map(TrialRecord::to_line).collect();
        assert_eq!(back, lines);
        assert_eq!(bundle.results().count(), content.results.len());
        assert_eq!(bundle.result("trials.csv"), Some(content.results[0].1.as_slice()));
        assert_eq!(bundle.results_digest(), sealed.results_digest);
        assert_eq!(bundle.study_digest(), sealed.study_digest);
        assert_eq!(bundle.bundle_id(), Some(sealed.bundle_id));
        assert_eq!(bundle.circumstance(), Some(sample::circumstance()));
    }

    #[test]
    fn a_newer_format_is_not_mistaken_for_damage() {
        let mut archive = archive::read(sample::zip(), &Limits::default()).unwrap();
        let info = String::from_utf8(archive.tree["bag-info.txt"].clone()).unwrap();
        let info = info.replace("Bundle-Format: 4", "Bundle-Format: 6");
        archive.tree.insert("bag-info.txt".into(), info.into_bytes());
        let error = Bundle::open(archive).unwrap_err();
        assert!(matches!(error, OpenError::Newer(_)));
        assert!(error.to_string().starts_with(
            "bag-info.txt: expected bundle format 5 or older, found bundle format 6 (this is reenact "
        ));
    }

    #[test]
    fn missing_parts_are_named_all_at_once() {
        let mut archive = archive::read(sample::zip(), &Limits::default()).unwrap();
        for path in ["data/study.yaml", "data/inputs/a.yaml", "data/trials/none.jsonl"] {
            archive.tree.remove(path).unwrap();
        }
        assert_eq!(
            Bundle::open(archive).unwrap_err().to_string(),
            "the bundle is damaged: data/study.yaml: expected the manifest, found no file; data/inputs/a.yaml: expected \
             the input `../worlds/a.yaml`, found no file; data/trials/none.jsonl: expected the condition's records, found \
             no file"
        );
    }
}
