//! Records on their way from one store to another, as one file that tells whether it arrived whole.
//!
//! ```text
//! {"reenact-pack":1}
//! {"key":"...","sha256":"...","record":{...}}      a line for each record, as a store has it, by rising key
//! {"records":2,"sha256":"..."}                     how many, and the digest of everything above
//! ```
//!
//! Whoever takes one in believes nothing of it but that its records are what somebody wrote: a run executes a share of the records
//! that it takes from a store again, and `verify` all of them.

use super::directory::DirectoryStore;
use super::gc::Packing;
use super::partial::Partial;
use super::segments::{Ended, decode, encode, key_of, next_line};
use super::{reason, sync_folder};
use crate::digest::{Hasher, Sha256Digest, TrialKey};
use crate::runner::{StoreError, TrialStore as _};
use crate::studies::{Outcome, TrialRecord};
use fs_err as fs;
use std::io::{self, BufRead, BufReader, Write as _};
use std::path::Path;
use thiserror::Error;

/// The first line.
const HEAD: &str = "{\"reenact-pack\":1}\n";

/// How the first line of any version begins.
const ANY_HEAD: &str = "{\"reenact-pack\":";

/// Why a pack is not taken in. Nothing of it is, then.
#[derive(Debug, Error)]
pub enum PackError {
    /// It is something else.
    #[error("line 1: expected a pack of records (`reenact cache export`), found something else")]
    NoPack,
    /// A newer program wrote it.
    #[error("line 1: expected a pack of version 1, found `{0}`: a newer release reads it")]
    Newer(String),
    /// A line is no record.
    #[error("line {line}: expected {expected}, found {found}; fetch the pack again")]
    Line {
        /// Which, from 1.
        line: usize,
        /// What should be there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// The end is missing.
    #[error(
        "line {0}: expected the last line of a pack, found the end of the file: it did not arrive whole; fetch it again"
    )]
    Cut(usize),
    /// It does not hold what its last line says.
    #[error(
        "line {line}: expected {expected}, as its last line says, found {found}; fetch the pack again"
    )]
    Otherwise {
        /// The last line.
        line: usize,
        /// What it says.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A record contradicts one of the store, or the store refuses.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// It cannot be read.
    #[error("cannot be read: {}", reason(.0))]
    Io(#[from] io::Error),
}

/// What was taken in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Imported {
    /// Records in the pack.
    pub records: usize,
    /// How many of them the store had not.
    pub new: usize,
}

/// Reads a pack to its end and hands each record to `on`; every line is checked before the next is read, and only the end says
/// whether all of it is there.
fn read(
    reader: &mut impl BufRead,
    mut on: impl FnMut(TrialRecord) -> Result<(), PackError>,
) -> Result<usize, PackError> {
    let mut line = Vec::new();
    let mut hasher = Hasher::new();
    let (mut records, mut last) = (0, None);
    for number in 1.. {
        let (ended, _) = next_line(reader, &mut line)?;
        if number == 1 {
            head(&line)?;
            hasher.update(&line);
            continue;
        }
        let fault = |expected, found: &str| PackError::Line {
            line: number,
            expected,
            found: found.to_owned(),
        };
        match ended {
            Ended::Nowhere => return Err(PackError::Cut(number)),
            Ended::TooLong => return Err(fault("a record", "a line that is longer than any")),
            Ended::Whole => {}
        }
        let Some(key) = key_of(&line) else {
            return end(number, &line, records, hasher.digest(), reader);
        };
        let record = checked(&line).map_err(|found| fault("a record", found))?;
        if last.is_some_and(|last| last >= key) {
            return Err(fault("a key that is greater than the last one", "another"));
        }
        last = Some(key);
        hasher.update(&line);
        records += 1;
        on(record)?;
    }
    Ok(records)
}

/// Checks the first line.
fn head(line: &[u8]) -> Result<(), PackError> {
    if line == HEAD.as_bytes() {
        return Ok(());
    }
    let text = std::str::from_utf8(line).ok().filter(|text| text.starts_with(ANY_HEAD));
    Err(match text {
        Some(newer) => PackError::Newer(newer.trim_end().chars().take(40).collect()),
        None => PackError::NoPack,
    })
}

/// Returns the record of a line, which must be as this program writes it, and a result.
fn checked(line: &[u8]) -> Result<TrialRecord, &'static str> {
    let record = decode(line).ok_or("one that does not have its digest")?;
    if record.outcome == Outcome::PANICKED {
        return Err("a panic, which is no result");
    }
    // Under its own key, and spelt as records are.
    if encode(&record) == line { Ok(record) } else { Err("one that is spelt otherwise") }
}

/// Holds the last line, at `number`, against what was above it, and makes sure that it is the last.
fn end(
    number: usize,
    line: &[u8],
    records: usize,
    digest: Sha256Digest,
    reader: &mut impl BufRead,
) -> Result<usize, PackError> {
    let otherwise =
        |expected: String, found: String| PackError::Otherwise { line: number, expected, found };
    let told = std::str::from_utf8(line).ok().and_then(|text| {
        let rest = text.strip_prefix("{\"records\":")?.strip_suffix("\"}\n")?;
        let (count, hex) = rest.split_once(",\"sha256\":\"")?;
        Some((count.parse::<usize>().ok()?, Sha256Digest::from_hex(hex)?))
    });
    let Some((count, stated)) = told else {
        let found = "something else".to_owned();
        let expected = "a record, or the last line of a pack";
        return Err(PackError::Line { line: number, expected, found });
    };
    if count != records {
        return Err(otherwise(format!("{count} records"), records.to_string()));
    }
    if stated != digest {
        return Err(otherwise(format!("sha256:{stated}"), format!("sha256:{digest}")));
    }
    if !reader.fill_buf()?.is_empty() {
        return Err(otherwise("nothing behind it".to_owned(), "more".to_owned()));
    }
    Ok(records)
}

/// Returns how many records a pack holds, where it is whole.
///
/// # Errors
/// The first thing that is wrong with it.
pub fn check_pack(bytes: &[u8]) -> Result<usize, PackError> {
    read(&mut BufReader::new(bytes), |_| Ok(()))
}

impl DirectoryStore {
    /// Takes in the records of a pack: all of them, or none where anything is wrong with it.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn import(&self, pack: impl io::Read) -> Result<Imported, PackError> {
        let mut imported = Imported::default();
        let mut packing = None;
        let mut reader = BufReader::with_capacity(1 << 16, pack);
        imported.records = read(&mut reader, |record| {
            match self.get(&record.key)? {
                Some(stored) if stored.to_line() == record.to_line() => return Ok(()),
                Some(stored) => return Err(StoreError::conflict(&stored, &record).into()),
                None => {}
            }
            imported.new += 1;
            let packing = match &mut packing {
                Some(packing) => packing,
                none => none.insert(Packing::in_folder(&self.root().join("segments"))?),
            };
            Ok(packing.add(&record)?)
        })?;
        if let Some(packing) = packing {
            packing.publish()?;
        }
        Ok(imported)
    }

    /// Writes the records of `keys` that are there, or all, to a pack at `path`; returns how many, or `None` where there is none
    /// of them: then nothing is written.
    ///
    /// # Errors
    /// Where the store cannot be read, holds two different records of a trial, or the pack cannot be written.
    pub fn export(
        &self,
        keys: Option<&[TrialKey]>,
        path: &Path,
    ) -> Result<Option<usize>, PackError> {
        let mut keys = match keys {
            Some(keys) => keys.to_vec(),
            None => self.keys()?,
        };
        keys.sort_unstable();
        keys.dedup();
        let looked = self.look()?;
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        fs::create_dir_all(folder)?;
        let mut file = Partial::new(folder)?;
        let mut hasher = Hasher::new();
        let mut add = |line: &[u8]| {
            hasher.update(line);
            file.begin(line)
        };
        add(HEAD.as_bytes())?;
        let mut records = 0;
        for key in &keys {
            if let Some(record) = looked.get(key)? {
                add(&encode(&record))?;
                records += 1;
            }
        }
        if records == 0 {
            return Ok(None);
        }
        let digest = hasher.digest();
        file.write_with(|out| writeln!(out, "{{\"records\":{records},\"sha256\":\"{digest}\"}}"))?;
        file.persist(path)?;
        sync_folder(folder)?;
        Ok(Some(records))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::sample;

    fn packed(trials: std::ops::Range<u32>) -> Vec<u8> {
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path().join("store"));
        trials.for_each(|trial| store.put(&sample::record(7, "none", trial)).unwrap());
        let path = desk.path().join("a.pack");
        store.export(None, &path).unwrap().unwrap();
        fs::read(path).unwrap()
    }

    #[test]
    fn a_pack_moves_records_and_is_the_same_wherever_they_were() {
        let desk = tempfile::tempdir().unwrap();
        let record = |trial| sample::record(7, "none", trial);
        let here = DirectoryStore::new(desk.path().join("here"));
        let path = desk.path().join("packs/a.pack");
        assert_eq!(here.export(None, &path).unwrap(), None);
        assert!(!path.exists(), "a pack of nothing is none");
        for trial in [3, 0, 2, 1] {
            here.put(&record(trial)).unwrap();
        }
        assert_eq!(here.export(None, &path).unwrap(), Some(4));
        assert_eq!(fs::read(&path).unwrap(), packed(0..4), "in whatever order they came");
        let there = DirectoryStore::new(desk.path().join("there"));
        there.put(&record(2)).unwrap();
        let import = || there.import(fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(import(), Imported { records: 4, new: 3 });
        assert_eq!(import(), Imported { records: 4, new: 0 });
        for trial in 0..4 {
            assert_eq!(there.get(&record(trial).key).unwrap(), Some(record(trial)));
        }
        let some = [record(1).key, record(9).key];
        assert_eq!(there.export(Some(&some), &path).unwrap(), Some(1));
        assert_eq!(check_pack(&fs::read(&path).unwrap()).unwrap(), 1);
    }

    #[test]
    fn a_pack_that_is_not_whole_is_refused_whole() {
        let pack = packed(0..3);
        assert_eq!(check_pack(&pack).unwrap(), 3);
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path());
        for cut in (0..pack.len()).step_by(7) {
            store.import(&pack[..cut]).unwrap_err();
            assert_eq!(store.size().unwrap(), (0, 0), "cut at {cut}");
        }
        for at in (0..pack.len()).step_by(11) {
            let mut other = pack.clone();
            other[at] ^= 1;
            store.import(&other[..]).unwrap_err();
        }
        assert_eq!(store.size().unwrap(), (0, 0));
        let left = fs::read_dir(desk.path().join("segments")).map_or(0, Iterator::count);
        assert_eq!(left, 0, "nothing half written stays");
    }

    #[test]
    fn what_is_wrong_with_a_pack_is_told() {
        let pack = String::from_utf8(packed(0..3)).unwrap();
        let lines: Vec<&str> = pack.split_inclusive('\n').collect();
        let told = |lines: &[&str]| check_pack(lines.concat().as_bytes()).unwrap_err().to_string();
        assert_eq!(
            told(&[]),
            "line 1: expected a pack of records (`reenact cache export`), found something else"
        );
        assert_eq!(
            told(&["{\"reenact-pack\":2}\n"]),
            "line 1: expected a pack of version 1, found `{\"reenact-pack\":2}`: a newer release reads it"
        );
        assert_eq!(
            told(&lines[..3]),
            "line 4: expected the last line of a pack, found the end of the file: it did not arrive whole; fetch it again"
        );
        assert_eq!(
            told(&[lines[0], lines[2], lines[1], lines[3], lines[4]]),
            "line 3: expected a key that is greater than the last one, found another; fetch the pack again"
        );
        assert_eq!(
            told(&[lines[0], lines[1], lines[4]]),
            "line 3: expected 3 records, as its last line says, found 1; fetch the pack again"
        );
        let twice = told(&[&lines[..], &lines[4..]].concat());
        assert_eq!(
            twice,
            "line 5: expected nothing behind it, as its last line says, found more; fetch the pack again"
        );
        let damaged = lines[1].replace("none", "nine");
        assert_eq!(
            told(&[lines[0], &damaged, lines[4]]),
            "line 2: expected a record, found one that does not have its digest; fetch the pack again"
        );
        let mut panicked = sample::record(7, "none", 0);
        panicked.outcome = Outcome::PANICKED;
        let panicked = String::from_utf8(encode(&panicked)).unwrap();
        assert_eq!(
            told(&[lines[0], &panicked, lines[4]]),
            "line 2: expected a record, found a panic, which is no result; fetch the pack again"
        );
        assert_eq!(
            told(&[lines[0], "{}\n"]),
            "line 2: expected a record, or the last line of a pack, found something else; fetch the pack again"
        );
        // The store's own record stays.
        let desk = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(desk.path());
        let mut other = sample::record(7, "none", 1);
        other.chain[1] = "0".repeat(16);
        store.put(&other).unwrap();
        let conflict = store.import(pack.as_bytes()).unwrap_err().to_string();
        assert!(
            conflict.starts_with(&format!("trial {}: expected the record in the store", other.key))
        );
        assert_eq!(store.size().unwrap().0, 1);
    }
}
