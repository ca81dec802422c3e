//! Finished trials in a directory that many processes share.

use super::lines::files_of_one;
use super::segments::{Segments, decode, encode};
use super::{kind_of, partial, read, reason};
use crate::digest::{Sha256Digest, TrialKey};
use crate::runner::{StoreError, TrialStore};
use crate::studies::{Outcome, TrialRecord};
use fs_err as fs;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Finished trials in a directory, safe to share between processes.
///
/// Each process appends to a file of its own below `segments/`, a line for each record: `{"key":"<of the trial>",
/// "sha256":"<of the record's line>","record":<the line>}`. Nothing waits for the disk: a process that is killed loses nothing
/// that it had appended, and a power cut the last seconds at most. A line that a crash or a failing disk left damaged does not
/// match its digest and counts as absent: the trial is run again, and its record appended.
///
/// Earlier versions kept a file for each record, `ab/<key>.json`: such are still read.
#[derive(Debug, Clone)]
pub struct DirectoryStore {
    root: PathBuf,
    segments: Arc<Segments>,
}

impl DirectoryStore {
    /// Creates a store at `root`; the folder is made when it is first written to.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        let root = root.into();
        let segments = Arc::new(Segments::new(root.join("segments")));
        Self { root, segments }
    }

    /// Returns where the store is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Returns a warning for everything met among the files of records that is no file; each is given once.
    pub fn warnings(&self) -> Vec<String> {
        let warning = |(path, found): (PathBuf, &str)| {
            format!(
                "trial store: expected a file of records at `{}`, found {found}: it is left alone; remove it",
                path.display()
            )
        };
        self.segments.odd().into_iter().map(warning).collect()
    }

    /// Removes what runs of earlier versions that were killed had begun to write and never will end.
    pub fn sweep(&self) {
        for folder in fs::read_dir(&self.root).into_iter().flatten().flatten() {
            if folder.file_type().is_ok_and(|kind| kind.is_dir()) {
                partial::sweep(&folder.path());
            }
        }
    }

    /// Counts the records and their bytes.
    ///
    /// # Errors
    /// Where the directory cannot be read; an absent one is empty.
    pub fn size(&self) -> io::Result<(usize, u64)> {
        let (mut records, mut bytes) = self.segments.size()?;
        if !self.root.exists() {
            return Ok((0, 0));
        }
        for folder in fs::read_dir(&self.root)? {
            let folder = folder?.path();
            if !folder.is_dir() {
                continue;
            }
            for file in fs::read_dir(&folder)? {
                let file = file?;
                let metadata = file.metadata()?;
                if metadata.is_file() && file.path().extension().is_some_and(|e| e == "json") {
                    records += 1;
                    bytes += metadata.len();
                }
            }
        }
        Ok((records, bytes))
    }

    /// Returns the keys of all trials that are there, damaged records among them.
    ///
    /// # Errors
    /// Where the store cannot be read; an absent one is empty.
    pub(super) fn keys(&self) -> Result<Vec<TrialKey>, StoreError> {
        let unread = |e: io::Error| self.refusal("read", &e);
        let mut keys = self.segments.keys().map_err(unread)?;
        for path in files_of_one(&self.root).map_err(unread)? {
            let name = path.file_stem().and_then(|name| name.to_str());
            keys.extend(name.and_then(Sha256Digest::from_hex).map(TrialKey));
        }
        Ok(keys)
    }

    /// Returns what is there now, for many questions at once: a question to the store itself looks for what other processes
    /// finished meanwhile.
    ///
    /// # Errors
    /// Where the store cannot be read; an absent one is empty.
    pub fn look(&self) -> Result<Looked<'_>, StoreError> {
        let unread = |e: io::Error| self.refusal("read", &e);
        self.segments.look().map_err(unread)?;
        let mut folders = BTreeSet::new();
        match fs::read_dir(&self.root) {
            Ok(entries) => {
                for entry in entries {
                    folders.extend(entry.map_err(unread)?.file_name().into_string());
                }
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            Err(e) => return Err(unread(e)),
        }
        Ok(Looked { store: self, folders })
    }

    fn refusal(&self, doing: &str, error: &io::Error) -> StoreError {
        StoreError::Io(format!("cannot {doing} `{}`: {}", self.root.display(), reason(error)))
    }

    /// Returns the record of `key` in a file of its own, as earlier versions kept it.
    fn alone(&self, key: &TrialKey) -> io::Result<Option<TrialRecord>> {
        let hex = key.hex();
        let path = self.root.join(&hex[..2]).join(format!("{hex}.json"));
        // Something else in its place is nobody's record.
        if kind_of(&path).is_some() {
            return Ok(None);
        }
        match read(&path, super::segments::MOST_RECORD) {
            Ok(bytes) => Ok(decode(&bytes)),
            // Too large to be one: damaged.
            Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::FileTooLarge) => {
                Ok(None)
            }
            Err(e) => Err(e),
        }
    }
}

/// A store as it was when it was looked at.
#[derive(Debug)]
pub struct Looked<'a> {
    store: &'a DirectoryStore,
    /// What is in it by name: the folders of earlier versions among them.
    folders: BTreeSet<String>,
}

impl Looked<'_> {
    /// Returns the record of a trial; `None` where it was not there.
    ///
    /// # Errors
    /// Where the store cannot be read, or holds two different ones.
    pub fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError> {
        let unread = |e: io::Error| self.store.refusal("read", &e);
        let mut records = self.store.segments.seen(key).map_err(unread)?;
        if records.is_empty() && self.folders.contains(&key.hex()[..2]) {
            records.extend(self.store.alone(key).map_err(unread)?);
        }
        the_one(key, records)
    }
}

/// Returns what all `records` under one key are.
fn the_one(
    key: &TrialKey,
    mut records: Vec<TrialRecord>,
) -> Result<Option<TrialRecord>, StoreError> {
    records.retain(|record| record.key == *key);
    let mut records = records.into_iter();
    let Some(first) = records.next() else { return Ok(None) };
    // Two processes may have finished the same trial at once.
    match records.find(|other| other.to_line() != first.to_line()) {
        Some(other) => Err(StoreError::conflict(&first, &other)),
        None => Ok(Some(first)),
    }
}

impl TrialStore for DirectoryStore {
    fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError> {
        let unread = |e: io::Error| self.refusal("read", &e);
        let mut records = self.segments.get(key).map_err(unread)?;
        if records.is_empty() {
            records.extend(self.alone(key).map_err(unread)?);
        }
        the_one(key, records)
    }

    fn put(&self, record: &TrialRecord) -> Result<(), StoreError> {
        let key = record.key;
        if record.outcome == Outcome::PANICKED {
            return Err(StoreError::Panicked { key, cause: record.cause.clone() });
        }
        match self.get(&key)? {
            Some(stored) if stored.to_line() == record.to_line() => Ok(()),
            Some(stored) => Err(StoreError::conflict(&stored, record)),
            None => {
                let appended = self.segments.append(&encode(record));
                appended.map_err(|e| self.refusal("write to", &e))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::sample;

    /// Returns the only segment of the store.
    fn segment(store: &DirectoryStore) -> PathBuf {
        let files: Vec<_> = fs::read_dir(store.root().join("segments")).unwrap().collect();
        assert_eq!(files.len(), 1);
        files.into_iter().next().unwrap().unwrap().path()
    }

    #[test]
    fn records_survive_and_damage_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let root = directory.path().join("new/store");
        let opened = || DirectoryStore::new(&root);
        let store = opened();
        let record = sample::record(7, "none", 0);
        assert_eq!(store.size().unwrap(), (0, 0));
        let empty = store.look().unwrap();
        assert_eq!(store.get(&record.key).unwrap(), None);
        assert_eq!(empty.get(&record.key).unwrap(), None);
        store.put(&record).unwrap();
        store.put(&record).unwrap();
        assert_eq!(store.get(&record.key).unwrap().as_ref(), Some(&record));
        assert_eq!(opened().get(&record.key).unwrap().as_ref(), Some(&record));
        assert_eq!(opened().look().unwrap().get(&record.key).unwrap().as_ref(), Some(&record));
        let path = segment(&store);
        let whole = fs::read(&path).unwrap();
        assert_eq!(store.size().unwrap(), (1, whole.len() as u64));
        drop(store);
        for cut in 0..whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(opened().get(&record.key).unwrap(), None, "torn at {cut}, it is no record");
            let mut zeroed = whole.clone();
            zeroed[cut..].fill(0);
            fs::write(&path, &zeroed).unwrap();
            assert_eq!(opened().get(&record.key).unwrap(), None, "with zeros from {cut} neither");
        }
        // The next record begins a line of its own behind what is torn.
        fs::write(&path, &whole[..20]).unwrap();
        let store = opened();
        store.put(&record).unwrap();
        assert_eq!(segment(&store), path);
        assert_eq!(fs::read(&path).unwrap(), [&whole[..20], b"\n", &whole].concat());
        assert_eq!(opened().get(&record.key).unwrap(), Some(record));
    }

    #[test]
    fn two_results_for_one_key_are_a_hard_error() {
        let directory = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(directory.path());
        let stored = sample::record(7, "none", 0);
        store.put(&stored).unwrap();
        let mut fresh = stored.clone();
        fresh.chain[1] = "0".repeat(16);
        let expected = format!(
            "trial {}: expected the record in the store (sha256:{}), found another (sha256:{}) whose states first differ \
             between 10 s and 20 s of simulated time; equal keys must give equal bytes, so please report it, with both \
             records",
            stored.key,
            Sha256Digest::of(stored.to_line()),
            Sha256Digest::of(fresh.to_line())
        );
        assert_eq!(store.put(&fresh).unwrap_err().to_string(), expected);
        assert_eq!(store.get(&stored.key).unwrap(), Some(stored.clone()), "the first stays");
        // Two processes that finished at once: whoever asks next finds both.
        let other = DirectoryStore::new(directory.path());
        other.segments.append(&encode(&fresh)).unwrap();
        let opened = DirectoryStore::new(directory.path());
        let differ = opened.get(&stored.key).unwrap_err().to_string();
        let looked = opened.look().unwrap().get(&stored.key);
        assert_eq!(looked.unwrap_err().to_string(), differ);
        assert!(differ.starts_with(&format!("trial {}: expected the record", stored.key)));
        fresh.outcome = Outcome::PANICKED;
        fresh.cause = "index out of bounds".into();
        assert_eq!(
            store.put(&fresh).unwrap_err().to_string(),
            format!(
                "trial {}: expected a result to store, found a panic (index out of bounds); panics are never stored",
                stored.key
            )
        );
    }

    #[test]
    fn many_writers_agree_and_see_each_other() {
        let directory = tempfile::tempdir().unwrap();
        // Each as a process of its own.
        let stores = [0; 4].map(|_| DirectoryStore::new(directory.path()));
        let record = |trial| sample::record(7, "none", trial);
        std::thread::scope(|scope| {
            for store in &stores {
                scope.spawn(|| (0..20).for_each(|trial| store.put(&record(trial)).unwrap()));
            }
        });
        assert!(stores.iter().all(|store| store.size().unwrap().0 == 20));
        for store in &stores {
            stores[0].put(&record(99)).unwrap();
            assert_eq!(store.get(&record(99).key).unwrap(), Some(record(99)));
        }
        let segments = || fs::read_dir(directory.path().join("segments")).unwrap().count();
        assert!((1..=4).contains(&segments()));
        drop(stores);
        // Whoever comes later goes on in what nobody writes to.
        let (before, later) = (segments(), DirectoryStore::new(directory.path()));
        later.put(&record(100)).unwrap();
        assert!(crate::provenance::kernel().is_none() || segments() == before);
    }

    /// As a network file system or a tool that copies stores shows it.
    #[cfg(unix)]
    #[test]
    fn a_file_of_another_machine_that_comes_by_halves_or_anew_is_read_as_far_as_it_is_whole() {
        let directory = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(directory.path());
        let folder = directory.path().join("segments");
        fs::create_dir_all(&folder).unwrap();
        let record = |trial| sample::record(7, "none", trial);
        let lines = [0, 1, 2].map(|trial| encode(&record(trial)));
        let path = folder.join("0badcafe-0.jsonl");
        let (half, rest) = lines[0].split_at(200);
        fs::write(&path, half).unwrap();
        assert_eq!(store.get(&record(0).key).unwrap(), None);
        let append = |bytes: &[u8]| {
            use std::io::Write as _;
            let mut file = fs::OpenOptions::new().append(true).open(&path).unwrap();
            file.write_all(bytes).unwrap();
        };
        append(rest);
        append(&lines[1][..50]);
        assert_eq!(store.get(&record(0).key).unwrap(), Some(record(0)));
        assert_eq!(store.get(&record(1).key).unwrap(), None);
        // Copied anew, whole, and longer than before.
        fs::write(folder.join("copy"), lines.concat()).unwrap();
        fs::rename(folder.join("copy"), &path).unwrap();
        for trial in [1, 2, 0] {
            assert_eq!(store.get(&record(trial).key).unwrap(), Some(record(trial)));
        }
        fs::remove_file(&path).unwrap();
        assert_eq!(store.get(&record(9).key).unwrap(), None, "nor does its end disturb anybody");
    }

    #[test]
    fn a_store_of_a_file_for_each_record_is_read() {
        let directory = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(directory.path());
        let record = sample::record(7, "none", 0);
        let line = record.to_line();
        let hex = record.key.hex();
        let folder = directory.path().join(&hex[..2]);
        fs::create_dir(&folder).unwrap();
        let text = format!("{{\"sha256\":\"{}\",\"record\":{line}}}\n", Sha256Digest::of(&line));
        fs::write(folder.join(format!("{hex}.json")), &text).unwrap();
        assert_eq!(store.get(&record.key).unwrap().as_ref(), Some(&record));
        let looked = store.look().unwrap();
        assert_eq!(looked.get(&record.key).unwrap().as_ref(), Some(&record));
        assert_eq!(looked.get(&sample::record(7, "none", 1).key).unwrap(), None);
        assert_eq!(store.size().unwrap(), (1, text.len() as u64));
        store.put(&record).unwrap();
        assert!(!directory.path().join("segments").exists(), "it is there already");
        fs::write(folder.join(format!("{hex}.json")), &text[..100]).unwrap();
        assert_eq!(store.get(&record.key).unwrap(), None);
        store.put(&record).unwrap();
        assert_eq!(store.get(&record.key).unwrap(), Some(record));
    }
}
