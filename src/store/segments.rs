//! Files of records to which one process at a time appends.
//!
//! A lock says that a segment's writer lives: the kernel takes it away with the process, and the next writer goes on where it
//! ended. So from one start of a machine to the next there are as many segments as processes were ever at work at once. Locks
//! of another kernel prove nothing, so that a segment's name says which kernel its writers run on; where a kernel gives itself no
//! name (any but Linux), every process that has something to append begins a segment.

use super::{kind_of, open};
use crate::digest::{Sha256Digest, TrialKey};
use crate::provenance;
use crate::studies::TrialRecord;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, TryLockError};
use std::io::{self, BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Most bytes of one record: an hour's trial has a hundredth of it.
pub(super) const MOST_RECORD: u64 = 16 << 20;

/// How the line of a record begins, up to the trial's key, and how it goes on behind it.
const HEAD: &str = "{\"key\":\"";
const BEHIND: &str = "\",\"sha256\":\"";

/// All segments of a store, as far as they were read, and the one that this process appends to.
#[derive(Debug)]
pub(super) struct Segments {
    folder: PathBuf,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// Where the lines of each trial are: one, but for what is damaged or two processes finished at once.
    places: BTreeMap<TrialKey, Vec<Place>>,
    /// How much of each segment was read.
    read: BTreeMap<PathBuf, Segment>,
    own: Option<Own>,
    /// What is no file, and what it is.
    odd: BTreeSet<(PathBuf, &'static str)>,
}

/// A segment that was read.
#[derive(Debug)]
struct Segment {
    file: Arc<Mutex<File>>,
    identity: Identity,
    /// Up to the end of its last whole line.
    to: u64,
}

/// A line in a segment.
#[derive(Debug, Clone)]
struct Place {
    file: Arc<Mutex<File>>,
    from: u64,
    length: usize,
}

/// The segment that this process appends to, as long as it holds the lock.
#[derive(Debug)]
struct Own(File);

impl Drop for Own {
    fn drop(&mut self) {
        // Only a power cut could take what was appended; from here on not even that.
        let _ = self.0.sync_data();
    }
}

impl Segments {
    /// Creates those in `folder`, which is made when it is first written to.
    pub(super) fn new(folder: PathBuf) -> Self {
        Self { folder, state: Mutex::default() }
    }

    /// Takes note of what was appended to any segment so far.
    pub(super) fn look(&self) -> io::Result<()> {
        self.lock().read_on(&self.folder)
    }

    /// Returns every whole record that stands under `key`.
    pub(super) fn get(&self, key: &TrialKey) -> io::Result<Vec<TrialRecord>> {
        let known = self.lock().places.contains_key(key);
        if !known {
            // Another process may have finished it since.
            self.look()?;
        }
        let records = self.seen(key)?;
        if known && records.is_empty() {
            // What was there is gone, as when another machine put files together: it may be in another one now.
            self.look()?;
            return self.seen(key);
        }
        Ok(records)
    }

    /// Returns every whole record that stood under `key` at the last look.
    pub(super) fn seen(&self, key: &TrialKey) -> io::Result<Vec<TrialRecord>> {
        let places = self.lock().places.get(key).cloned().unwrap_or_default();
        let mut records = Vec::new();
        for place in places {
            match place.read() {
                Ok(line) => records.extend(decode(&line)),
                Err(e) if is_gone(&e) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(records)
    }

    /// Appends the line of a record.
    pub(super) fn append(&self, line: &[u8]) -> io::Result<()> {
        let mut state = self.lock();
        let own = match state.own.take() {
            Some(own) => own,
            None => Own::in_folder(&self.folder)?,
        };
        let own = state.own.insert(own);
        let before = own.0.metadata()?.len();
        // One call for the whole line.
        if let Err(error) = own.0.write_all(line) {
            // A part would stay in the way of the next line.
            let _ = own.0.set_len(before);
            return Err(error);
        }
        state.read_on(&self.folder)
    }

    /// Counts the trials that have a line, and the bytes of all lines.
    pub(super) fn size(&self) -> io::Result<(usize, u64)> {
        let mut state = self.lock();
        state.read_on(&self.folder)?;
        Ok((state.places.len(), state.read.values().map(|segment| segment.to).sum()))
    }

    /// Returns the keys of all trials that have a line.
    pub(super) fn keys(&self) -> io::Result<Vec<TrialKey>> {
        let mut state = self.lock();
        state.read_on(&self.folder)?;
        Ok(state.places.keys().copied().collect())
    }

    /// Returns what was met that is no file, and what it is; each once.
    pub(super) fn odd(&self) -> BTreeSet<(PathBuf, &'static str)> {
        std::mem::take(&mut self.lock().odd)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Reads what was appended to any segment since the last time.
    fn read_on(&mut self, folder: &Path) -> io::Result<()> {
        for path in segments_in(folder)? {
            if let Some(found) = kind_of(&path) {
                self.odd.insert((path, found));
                continue;
            }
            match self.read_file(path) {
                // Between the listing and the opening another process removed it.
                Err(e) if is_gone(&e) => {}
                read => read?,
            }
        }
        Ok(())
    }

    fn read_file(&mut self, path: PathBuf) -> io::Result<()> {
        let metadata = fs::metadata(&path)?;
        let opened = |path: &Path| -> io::Result<Segment> {
            let (file, _) = open(path)?.into_parts();
            let identity = identity(&file.metadata()?);
            Ok(Segment { file: Arc::new(Mutex::new(file)), identity, to: 0 })
        };
        let segment = match self.read.entry(path) {
            Entry::Occupied(mut known) => {
                // A tool that copies stores puts a new file in the place of the old one.
                if known.get().identity != identity(&metadata) {
                    let anew = opened(known.key())?;
                    known.insert(anew);
                }
                known.into_mut()
            }
            Entry::Vacant(new) => {
                let segment = opened(new.key())?;
                new.insert(segment)
            }
        };
        if metadata.len() > segment.to {
            for (key, place) in segment.read_on()? {
                // One is all there is of nearly every trial, and there may be a million.
                self.places.entry(key).or_insert_with(|| Vec::with_capacity(1)).push(place);
            }
        }
        Ok(())
    }
}

impl Segment {
    /// Returns the lines behind those that were read, as far as they are whole and begin as a record's does.
    fn read_on(&mut self) -> io::Result<Vec<(TrialKey, Place)>> {
        let file = Arc::clone(&self.file);
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.to))?;
        let mut reader = BufReader::with_capacity(1 << 16, &mut *file);
        let (mut places, mut line) = (Vec::new(), Vec::new());
        loop {
            let (ended, length) = next_line(&mut reader, &mut line)?;
            if ended == Ended::Nowhere {
                return Ok(places);
            }
            if let Some(key) = key_of(&line) {
                let file = Arc::clone(&self.file);
                places.push((key, Place { file, from: self.to, length: line.len() }));
            }
            self.to += length;
        }
    }
}

impl Place {
    /// Returns the line; less where the file is not what it was.
    fn read(&self) -> io::Result<Vec<u8>> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let mut line = Vec::with_capacity(self.length);
        file.seek(SeekFrom::Start(self.from))?;
        (&mut *file).take(self.length as u64).read_to_end(&mut line)?;
        Ok(line)
    }
}

impl Own {
    /// Returns one that no other process appends to: one that is there, or a new one.
    fn in_folder(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let kernel = provenance::kernel();
        for number in 0..u32::MAX {
            let name = match &kernel {
                Some(kernel) => format!("{kernel}-{number}.jsonl"),
                None => format!("{number}.jsonl"),
            };
            let path = folder.join(name);
            if kind_of(&path).is_some() {
                continue;
            }
            let mut options = fs::OpenOptions::new();
            options.read(true).append(true);
            let is_new = !path.exists();
            // Without a name for the kernel nobody knows whether a lock proves anything: never one that is there.
            let file = match options.clone().create_new(is_new).open(&path) {
                Ok(_) if !is_new && kernel.is_none() => continue,
                // Another process was quicker; it may be another's, too.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(e) if !is_new && e.kind() == io::ErrorKind::PermissionDenied => continue,
                opened => opened?,
            };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => continue,
                // Where there are no locks, nobody takes what is there.
                Err(TryLockError::Error(_)) if !is_new => continue,
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            if !is_at(&file, &path) {
                continue;
            }
            let mut own = Self(file);
            own.end_line()?;
            return Ok(own);
        }
        Err(io::ErrorKind::StorageFull.into())
    }

    /// Ends a last line that was torn, so that the next one is whole.
    fn end_line(&mut self) -> io::Result<()> {
        let mut last = [b'\n'];
        if self.0.metadata()?.len() > 0 {
            self.0.seek(SeekFrom::End(-1))?;
            self.0.read_exact(&mut last)?;
        }
        if last == [b'\n'] { Ok(()) } else { self.0.write_all(b"\n") }
    }
}

/// How a line of a file of records ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// With a line feed.
    Whole,
    /// With a line feed, and longer than a record can be: nothing of it was kept.
    TooLong,
    /// With the file: there is none, or it is being written, or it never will be whole.
    Nowhere,
}

/// Reads the next line, with its end, into `line`; returns how it ends, and its length in the file (bytes).
pub(super) fn next_line(
    reader: &mut impl io::BufRead,
    line: &mut Vec<u8>,
) -> io::Result<(Ended, u64)> {
    line.clear();
    let length = reader.by_ref().take(MOST_RECORD).read_until(b'\n', line)? as u64;
    if line.last() == Some(&b'\n') {
        return Ok((Ended::Whole, length));
    }
    if length < MOST_RECORD {
        return Ok((Ended::Nowhere, length));
    }
    line.clear();
    let rest = reader.skip_until(b'\n')? as u64;
    Ok((Ended::TooLong, length + rest))
}

/// Says whether an error means that a file is there no more: removed here, or on another machine of a network file system.
pub(super) fn is_gone(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::StaleNetworkFileHandle)
}

/// What tells a file from another one of the same name; nothing where the system does not say.
type Identity = Option<(u64, u64)>;

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "other systems do not say")]
fn identity(metadata: &fs::Metadata) -> Identity {
    use std::os::unix::fs::MetadataExt as _;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn identity(_: &fs::Metadata) -> Identity {
    None
}

/// Opens the file of records at `path` and takes its lock; `None` where another process has it, or where it is there no more.
pub(super) fn locked(path: &Path) -> io::Result<Option<File>> {
    // Network file systems lock only what is open for writing.
    let file = match fs::OpenOptions::new().read(true).append(true).open(path) {
        Ok(file) => file,
        Err(e) if is_gone(&e) => return Ok(None),
        Err(e) => return Err(e),
    };
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) || !is_at(&file, path) {
        return Ok(None);
    }
    Ok(Some(file))
}

/// Returns whether an opened file is still the one at `path`: whoever tidies up may have come between opening and locking, and
/// what is written to a file without a name is lost.
fn is_at(file: &File, path: &Path) -> bool {
    let of = |metadata: io::Result<fs::Metadata>| metadata.ok().map(|found| identity(&found));
    of(file.metadata()) == of(fs::metadata(path))
}

/// Returns everything in `folder` that is called as a segment is, in the order of the names; nothing where it is absent.
pub(super) fn segments_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(e),
    };
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Returns the line of a record.
pub(super) fn encode(record: &TrialRecord) -> Vec<u8> {
    let line = record.to_line();
    let digest = Sha256Digest::of(&line);
    format!("{HEAD}{}{BEHIND}{digest}\",\"record\":{line}}}\n", record.key).into_bytes()
}

/// Returns the key that a line begins with.
pub(super) fn key_of(line: &[u8]) -> Option<TrialKey> {
    let hex = line.strip_prefix(HEAD.as_bytes())?.get(..64)?;
    Some(TrialKey(Sha256Digest::from_hex(std::str::from_utf8(hex).ok()?)?))
}

/// Returns the record of a line, with its key before it or not, where it is whole.
pub(super) fn decode(bytes: &[u8]) -> Option<TrialRecord> {
    let text = std::str::from_utf8(bytes).ok()?;
    let rest = match text.strip_prefix(HEAD) {
        Some(keyed) => keyed.get(64..)?.strip_prefix(BEHIND)?,
        None => text.strip_prefix("{\"sha256\":\"")?,
    };
    let (digest, rest) = rest.split_at_checked(64)?;
    let line = rest.strip_prefix("\",\"record\":")?.strip_suffix("}\n")?;
    let whole = Sha256Digest::from_hex(digest)? == Sha256Digest::of(line);
    whole.then(|| TrialRecord::from_line(line).ok())?
}
