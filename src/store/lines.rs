//! Every record of a store, line by line, for whoever looks at all of them.

use super::segments::{Ended, decode, key_of, locked, next_line, segments_in};
use super::{DirectoryStore, kind_of, open};
use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::TrialRecord;
use fs_err as fs;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

/// Something in a file of records that is no whole record.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Damage {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub found: String,
}

/// What a store holds, every record held against its digest.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Audit {
    /// Trials that have a whole record.
    pub trials: usize,
    /// Whole records of trials that have another one, which is equal: two processes finished them at once.
    pub repeated: usize,
    /// Files of records.
    pub files: usize,
    /// Last lines without an end, of files that a process writes to: they are being written.
    pub unfinished: usize,
    /// What is no whole record, and what contradicts another one.
    pub damage: Vec<Damage>,
}

/// What is known of the records that were seen, to tell which are there twice.
#[derive(Debug, Default)]
pub(super) struct Seen(BTreeMap<TrialKey, Sha256Digest>);

/// How a whole record stands to those seen before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// The first of its trial.
    First,
    /// Another one is the same.
    Repeated,
    /// Another one differs.
    Contradicts,
}

impl Seen {
    /// Takes note of a record.
    pub(super) fn note(&mut self, record: &TrialRecord) -> Standing {
        let digest = Sha256Digest::of(record.to_line());
        match self.0.entry(record.key) {
            Entry::Vacant(place) => {
                place.insert(digest);
                Standing::First
            }
            Entry::Occupied(known) if *known.get() == digest => Standing::Repeated,
            Entry::Occupied(_) => Standing::Contradicts,
        }
    }
}

/// A line of a file of records.
#[derive(Debug)]
pub(super) enum Found {
    /// A whole record.
    Record(Box<TrialRecord>),
    /// No record: why not.
    Damaged(String),
    /// The end of the file without that of the line.
    Unfinished,
}

/// Goes through the lines of the file of records at `path`.
pub(super) fn each_line(
    file: impl Read,
    mut on: impl FnMut(usize, Found) -> io::Result<()>,
) -> io::Result<()> {
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut line = Vec::new();
    for number in 1.. {
        match next_line(&mut reader, &mut line)? {
            (Ended::Nowhere, 0) => break,
            (Ended::Nowhere, _) => {
                on(number, Found::Unfinished)?;
                break;
            }
            (Ended::TooLong, length) => {
                on(number, Found::Damaged(format!("a line of {length} bytes")))?;
            }
            (Ended::Whole, _) => on(number, of_line(&line))?,
        }
    }
    Ok(())
}

/// Returns what a line with its end is.
fn of_line(line: &[u8]) -> Found {
    match (decode(line), key_of(line)) {
        (Some(record), Some(key)) if key != record.key => {
            Found::Damaged(format!("the record of {} under the key {key}", record.key))
        }
        (Some(record), _) => Found::Record(Box::new(record)),
        (None, Some(key)) => {
            Found::Damaged(format!("a record of {key} that does not have its digest"))
        }
        (None, None) => Found::Damaged("something that is no record".to_owned()),
    }
}

/// Returns the files that earlier versions kept, one for each record: `ab/<key>.json`.
pub(super) fn files_of_one(root: &Path) -> io::Result<Vec<PathBuf>> {
    let folders = match fs::read_dir(root) {
        Ok(folders) => folders,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(e),
    };
    let mut files = Vec::new();
    for folder in folders {
        let folder = folder?;
        let name = folder.file_name();
        let is_ours =
            name.len() == 2 && name.to_str().is_some_and(|n| u8::from_str_radix(n, 16).is_ok());
        if !is_ours || !folder.file_type()?.is_dir() {
            continue;
        }
        for file in fs::read_dir(folder.path())? {
            let path = file?.path();
            if path.extension().is_some_and(|extension| extension == "json") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

impl DirectoryStore {
    /// Holds every record against its digest and against the others of its trial.
    ///
    /// # Errors
    /// Where the store cannot be read; an absent one is empty.
    pub fn audit(&self) -> io::Result<Audit> {
        let mut audit = Audit::default();
        let mut seen = Seen::default();
        let segments = segments_in(&self.root().join("segments"))?;
        for path in segments.iter().chain(&files_of_one(self.root())?) {
            if kind_of(path).is_some() {
                continue;
            }
            // Asked before it is read: a line that has no end then is being written.
            let is_busy = matches!(locked(path), Ok(None) | Err(_));
            let file = match open(path) {
                Ok(file) => file,
                Err(e) if e.kind() == io::ErrorKind::NotFound => continue,
                Err(e) => return Err(e),
            };
            audit.files += 1;
            each_line(file, |line, found| {
                let damage = |found: String| Damage { path: path.clone(), line, found };
                match found {
                    Found::Record(record) => match seen.note(&record) {
                        Standing::First => audit.trials += 1,
                        Standing::Repeated => audit.repeated += 1,
                        Standing::Contradicts => audit.damage.push(damage(format!(
                            "another record of {} than before: one of the two is not what its trial gives",
                            record.key
                        ))),
                    },
                    Found::Damaged(found) => audit.damage.push(damage(found)),
                    Found::Unfinished if is_busy => audit.unfinished += 1,
                    Found::Unfinished => {
                        audit.damage.push(damage("a line that was never finished".to_owned()));
                    }
                }
                Ok(())
            })?;
        }
        Ok(audit)
    }
}
