//! Making room: the records that no run appended to for long.

use super::lines::files_of_one;
use super::segments::segments_in;
use super::{DirectoryStore, kind_of};
use crate::provenance;
use fs_err as fs;
use std::fs::TryLockError;
use std::io;
use std::path::Path;
use std::time::Duration;

/// What was removed from a store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pruned {
    /// Files of records.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
    /// Files that a run is at work on, which stay.
    pub busy: usize,
}

impl DirectoryStore {
    /// Removes every file of records that nothing was written to for `unwritten`. What is no file of records stays, and
    /// so does a file that a run appends to. Whoever reads one meanwhile reads on.
    ///
    /// # Errors
    /// Where the store cannot be read or a file of it not removed; an absent one is empty.
    pub fn prune(&self, unwritten: Duration) -> io::Result<Pruned> {
        let mut pruned = Pruned::default();
        for path in segments_in(&self.root().join("segments"))? {
            prune_file(&path, unwritten, &mut pruned)?;
        }
        for path in files_of_one(self.root())? {
            prune_file(&path, unwritten, &mut pruned)?;
        }
        Ok(pruned)
    }
}

fn prune_file(path: &Path, unwritten: Duration, pruned: &mut Pruned) -> io::Result<()> {
    if kind_of(path).is_some() {
        return Ok(());
    }
    let metadata = fs::metadata(path)?;
    if provenance::age(metadata.modified()?) < unwritten {
        return Ok(());
    }
    // Network file systems lock only what is open for writing.
    let file = std::fs::OpenOptions::new().read(true).append(true).open(path)?;
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        pruned.busy += 1;
        return Ok(());
    }
    fs::remove_file(path)?;
    pruned.files += 1;
    pruned.bytes += metadata.len();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn old_files_of_records_go_and_what_is_in_use_or_nobody_s_stays() {
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path().join("store"));
        assert_eq!(store.prune(Duration::ZERO).unwrap(), Pruned::default(), "an absent store");
        let segments = store.root().join("segments");
        for folder in [&segments, &store.root().join("ab"), &store.root().join("notes")] {
            fs::create_dir_all(folder).unwrap();
        }
        let files = ["segments/k-0.jsonl", "segments/k-1.jsonl", "ab/abcd.json", "notes/x.json"];
        for name in files {
            fs::write(store.root().join(name), "12345").unwrap();
        }
        let day = Duration::from_secs(86_400);
        assert_eq!(store.prune(day).unwrap(), Pruned::default(), "all of it is new");
        let busy = File::options().append(true).open(segments.join("k-1.jsonl")).unwrap();
        busy.lock().unwrap();
        let pruned = store.prune(Duration::ZERO).unwrap();
        assert_eq!(pruned, Pruned { files: 2, bytes: 10, busy: 1 });
        let left = files.map(|name| store.root().join(name).exists());
        assert_eq!(left, [false, true, false, true]);
    }
}
