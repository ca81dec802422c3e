//! Many small files of records as one, without what is there twice or damaged.
//!
//! Safe beside whoever reads and writes: a file that a process appends to is left alone, the new one is there before the old ones
//! go, and a record that is in both for a moment is the same in both.

use super::lines::{Found, Seen, Standing, each_line, files_of_one};
use super::partial::Partial;
use super::segments::{encode, locked, segments_in};
use super::{DirectoryStore, kind_of, open, sync_folder};
use crate::digest::{Hasher, Sha256Digest};
use crate::provenance;
use crate::studies::TrialRecord;
use fs_err as fs;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How the names of files begin that nobody appends to.
const PACKED: &str = "pack-";

/// How long nobody may have written to a file of another machine before it is taken for abandoned: not every network file
/// system tells one machine of the locks of another.
const STALE: Duration = Duration::from_secs(24 * 3600);

/// Files that are locked at once: a process may have a thousand open, as a rule.
const AT_ONCE: usize = 500;

/// Bytes that are gathered before they are written.
const GATHERED: usize = 1 << 20;

/// What became of a store.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Collected {
    /// Files that were put together.
    pub files: usize,
    /// Records that are in the new one.
    pub records: usize,
    /// Records that were there twice.
    pub repeated: usize,
    /// Lines that were no whole records.
    pub damaged: usize,
    /// Files beyond as many as can be put together at once: another call takes them.
    pub left: usize,
    /// Files of running processes, or of other machines that may be at work, which stay as they are.
    pub busy: usize,
    /// Bytes that are free now.
    pub freed: u64,
}

/// A new file of whole records, under way in the folder of segments.
pub(super) struct Packing {
    folder: PathBuf,
    file: Partial,
    gathered: Vec<u8>,
    hasher: Hasher,
    length: u64,
}

impl Packing {
    /// Begins one in `folder`, which is made where it is not there.
    pub(super) fn in_folder(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let file = Partial::new(folder)?;
        let hasher = Hasher::new();
        Ok(Self { folder: folder.to_owned(), file, gathered: Vec::new(), hasher, length: 0 })
    }

    /// Adds a record.
    pub(super) fn add(&mut self, record: &TrialRecord) -> io::Result<()> {
        let line = encode(record);
        self.hasher.update(&line);
        self.length += line.len() as u64;
        self.gathered.extend(line);
        if self.gathered.len() >= GATHERED {
            self.file.begin(&self.gathered)?;
            self.gathered.clear();
        }
        Ok(())
    }

    /// Makes it last, named after what is in it; returns its path and length (bytes).
    pub(super) fn publish(mut self) -> io::Result<(PathBuf, u64)> {
        self.file.write_with(|out| out.write_all(&self.gathered))?;
        let digest: Sha256Digest = self.hasher.digest();
        let path = self.folder.join(format!("{PACKED}{}.jsonl", &digest.hex()[..16]));
        self.file.persist(&path)?;
        sync_folder(&self.folder)?;
        Ok((path, self.length))
    }
}

impl DirectoryStore {
    /// Puts the files of records that no process writes to together, without records that are there twice and lines that are
    /// damaged.
    ///
    /// # Errors
    /// Where the store cannot be read or written; an absent one is empty.
    pub fn collect(&self) -> io::Result<Collected> {
        let mut collected = Collected::default();
        let folder = self.root().join("segments");
        // Held until all is done: whoever wants to append meanwhile begins a file of its own.
        let mut taken: Vec<(PathBuf, Option<File>)> = Vec::new();
        for path in segments_in(&folder)? {
            if kind_of(&path).is_some() {
                continue;
            }
            if taken.len() == AT_ONCE {
                collected.left += 1;
                continue;
            }
            match locked(&path)? {
                Some(file) if is_abandoned(&path, &file)? => taken.push((path, Some(file))),
                _ => collected.busy += 1,
            }
        }
        // To those of earlier versions nobody appends.
        let alone = files_of_one(self.root())?.into_iter().filter(|path| kind_of(path).is_none());
        taken.extend(alone.map(|path| (path, None)));
        let mut seen = Seen::default();
        let mut before = 0;
        let mut packing = None;
        for (path, _) in &taken {
            let file = open(path)?;
            before += file.metadata()?.len();
            each_line(file, |_, found| {
                let Found::Record(record) = found else {
                    collected.damaged += 1;
                    return Ok(());
                };
                if seen.note(&record) == Standing::Repeated {
                    collected.repeated += 1;
                    return Ok(());
                }
                // Of two that differ both stay: it is not for us to say which is right.
                collected.records += 1;
                let packing = match &mut packing {
                    Some(packing) => packing,
                    none => none.insert(Packing::in_folder(&folder)?),
                };
                packing.add(&record)
            })?;
        }
        if taken.len() < 2 && collected.damaged + collected.repeated == 0 {
            let Collected { left, busy, .. } = collected;
            return Ok(Collected { left, busy, ..Collected::default() });
        }
        let (path, after) = match packing {
            Some(packing) => packing.publish().map(|(path, length)| (Some(path), length))?,
            None => (None, 0),
        };
        for (old, file) in taken {
            collected.files += 1;
            if path.as_ref() != Some(&old) {
                fs::remove_file(old)?;
            }
            drop(file);
        }
        collected.freed = before.saturating_sub(after);
        Ok(collected)
    }
}

/// Returns whether nobody will append to a file of which we have the lock.
fn is_abandoned(path: &Path, file: &File) -> io::Result<bool> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let is_own = provenance::kernel().is_some_and(|kernel| name.starts_with(&format!("{kernel}-")));
    if is_own || name.starts_with(PACKED) {
        return Ok(true);
    }
    Ok(provenance::age(file.metadata()?.modified()?) >= STALE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::sample;
    use crate::runner::TrialStore as _;
    use crate::store::Audit;

    #[test]
    fn small_files_become_one_beside_whoever_writes_and_reads() {
        let desk = tempfile::tempdir().unwrap();
        let opened = || DirectoryStore::new(desk.path());
        let record = |trial| sample::record(7, "none", trial);
        assert_eq!(opened().collect().unwrap(), Collected::default(), "an absent store");
        let (a, b) = (opened(), opened());
        (0..3).for_each(|trial| a.put(&record(trial)).unwrap());
        (3..6).for_each(|trial| b.put(&record(trial)).unwrap());
        let reader = opened();
        assert_eq!(reader.get(&record(4).key).unwrap(), Some(record(4)));
        // Both are at work.
        let untouched = opened().collect().unwrap();
        assert_eq!((untouched.files, untouched.busy), (0, 2));
        drop(a);
        let folder = desk.path().join("segments");
        let mut torn = encode(&record(9));
        torn.truncate(100);
        let twice = [encode(&record(1)), b"{}\n".to_vec(), torn].concat();
        fs::write(folder.join("pack-0.jsonl"), &twice).unwrap();
        let audit = opened().audit().unwrap();
        assert_eq!((audit.trials, audit.repeated, audit.files, audit.unfinished), (6, 1, 3, 0));
        let found: Vec<_> = audit.damage.iter().map(|d| (d.line, d.found.as_str())).collect();
        let says = [(2, "something that is no record"), (3, "a line that was never finished")];
        assert_eq!(found, says);
        let collected = opened().collect().unwrap();
        assert_eq!(
            collected,
            Collected {
                files: 2,
                records: 3,
                repeated: 1,
                damaged: 2,
                left: 0,
                busy: 1,
                freed: twice.len() as u64
            }
        );
        // Who had the old files open reads on; who writes on is found; who comes later finds all.
        b.put(&record(6)).unwrap();
        assert_eq!(reader.get(&record(0).key).unwrap(), Some(record(0)));
        assert_eq!(reader.get(&record(6).key).unwrap(), Some(record(6)));
        drop(b);
        for trial in 0..7 {
            assert_eq!(opened().get(&record(trial).key).unwrap(), Some(record(trial)));
        }
        assert_eq!(opened().collect().unwrap().files, 2);
        let whole = Audit { trials: 7, files: 1, ..Audit::default() };
        assert_eq!(opened().audit().unwrap(), whole);
        assert_eq!(opened().collect().unwrap(), Collected::default(), "there is nothing to do");
    }

    #[test]
    fn a_file_of_another_machine_is_taken_only_when_it_is_old() {
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path());
        let folder = desk.path().join("segments");
        fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, trial| {
            fs::write(folder.join(name), encode(&sample::record(7, "none", trial))).unwrap();
            File::options().append(true).open(folder.join(name)).unwrap()
        };
        let files = [write("0badcafe-0.jsonl", 0), write("0badcafe-1.jsonl", 1)];
        assert_eq!(store.collect().unwrap(), Collected { busy: 2, ..Collected::default() });
        for file in files {
            file.set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
        }
        let collected = store.collect().unwrap();
        assert_eq!((collected.files, collected.records, collected.busy), (2, 2, 0));
    }

    #[test]
    fn of_two_that_differ_both_stay() {
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path());
        let one = sample::record(7, "none", 0);
        let mut other = one.clone();
        other.chain[1] = "0".repeat(16);
        let folder = desk.path().join("segments");
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("pack-0.jsonl"), encode(&one)).unwrap();
        fs::write(folder.join("pack-1.jsonl"), encode(&other)).unwrap();
        let says = format!(
            "another record of {} than before: one of the two is not what its trial gives",
            one.key
        );
        let damage = store.audit().unwrap().damage;
        assert_eq!((damage.len(), damage[0].found.as_str()), (1, says.as_str()));
        assert_eq!(store.collect().unwrap().records, 2);
        assert_eq!(store.audit().unwrap().damage.len(), 1);
        assert!(store.get(&one.key).is_err());
    }
}
