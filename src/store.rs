//! Files: the only user of the file system besides the command line. Everything is written whole or not at all.

mod partial;

pub use partial::abandon;

use crate::bundle::{Archive, Fault, archive};
use crate::digest::{Sha256Digest, TrialKey};
use crate::runner::{StoreError, TrialStore};
use crate::studies::{Outcome, TrialRecord};
use fs_err as fs;
use partial::Partial;
use std::collections::BTreeSet;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Most bytes of one record: an hour's trial has a hundredth of it.
const MOST_RECORD: u64 = 16 << 20;

/// Finished trials in a directory: `ab/<key>.json`, one file each, safe to share between processes.
///
/// A file is `{"sha256":"<of the record's line>","record":<the line>}`. One that a crash or a failing disk left
/// damaged does not match its digest, counts as absent and is replaced. Whatever is no file at all there is nobody's record:
/// it is left alone and its trial is not kept.
#[derive(Debug, Clone)]
pub struct DirectoryStore {
    root: PathBuf,
    /// What is no file in a record's place, and what it is.
    odd: Arc<Mutex<BTreeSet<(PathBuf, String)>>>,
}

impl DirectoryStore {
    /// Creates a store at `root`; the folder is made when it is first written to.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into(), odd: Arc::default() }
    }

    /// Returns a warning for everything met in a record's place that is no file; each is given once.
    pub fn warnings(&self) -> Vec<String> {
        let odd = std::mem::take(&mut *self.odd.lock().unwrap_or_else(PoisonError::into_inner));
        odd.iter()
            .map(|(path, found)| {
                format!(
                    "trial store: expected the record of a trial in `{}`, found {found}: it is left alone, and its trial is \
                     run each time and not kept; remove it",
                    path.display()
                )
            })
            .collect()
    }

    /// Returns whether something that is no file stands in the place of the record at `path`; it is remembered.
    fn is_odd(&self, path: &Path) -> bool {
        let Some(found) = kind_of(path) else { return false };
        let mut odd = self.odd.lock().unwrap_or_else(PoisonError::into_inner);
        odd.insert((path.to_owned(), found.to_owned()));
        true
    }

    /// Returns where the store is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Removes what runs that were killed had begun to write and never will end.
    pub fn sweep(&self) {
        for folder in fs::read_dir(&self.root).into_iter().flatten().flatten() {
            if folder.file_type().is_ok_and(|kind| kind.is_dir()) {
                partial::sweep(&folder.path());
            }
        }
    }

    fn refusal(&self, doing: &str, error: &io::Error) -> StoreError {
        StoreError::Io(format!("cannot {doing} `{}`: {}", self.root.display(), reason(error)))
    }

    fn path(&self, key: &TrialKey) -> PathBuf {
        let hex = key.hex();
        self.root.join(&hex[..2]).join(format!("{hex}.json"))
    }

    /// Counts the records and their bytes.
    ///
    /// # Errors
    /// Where the directory cannot be read; an absent one is empty.
    pub fn size(&self) -> io::Result<(usize, u64)> {
        let (mut records, mut bytes) = (0, 0);
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
}

impl TrialStore for DirectoryStore {
    fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError> {
        let path = self.path(key);
        if self.is_odd(&path) {
            return Ok(None);
        }
        match read(&path, MOST_RECORD) {
            Ok(bytes) => Ok(decode(&bytes).filter(|record| record.key == *key)),
            // Too large to be one: damaged.
            Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::FileTooLarge) => {
                Ok(None)
            }
            Err(e) => Err(self.refusal("read", &e)),
        }
    }

    fn put(&self, record: &TrialRecord) -> Result<(), StoreError> {
        let key = record.key;
        if record.outcome == Outcome::PANICKED {
            return Err(StoreError::Panicked { key, cause: record.cause.clone() });
        }
        let refused = |e: io::Error| self.refusal("write to", &e);
        let path = self.path(&key);
        if self.is_odd(&path) {
            return Ok(());
        }
        let folder = path.parent().unwrap_or(&self.root);
        fs::create_dir_all(folder).map_err(refused)?;
        let mut file = Partial::new(folder).map_err(refused)?;
        file.write(&encode(record)).map_err(refused)?;
        // Whoever comes second compares: two processes may finish the same trial at once.
        match file.persist_new(&path).map_err(refused)? {
            None => sync_folder(folder).map_err(refused),
            Some(file) => match self.get(&key)? {
                Some(stored) if stored.to_line() == record.to_line() => Ok(()),
                Some(stored) => Err(StoreError::conflict(&stored, record)),
                None if self.is_odd(&path) => Ok(()),
                None => {
                    // Damaged: the fresh record takes its place.
                    file.persist(&path).map_err(refused)?;
                    sync_folder(folder).map_err(refused)
                }
            },
        }
    }
}

/// Says what went wrong, without the numbers of one operating system.
pub fn reason(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::NotFound => "no such file".to_owned(),
        Kind::PermissionDenied => "no permission".to_owned(),
        Kind::IsADirectory => "it is a folder".to_owned(),
        Kind::NotADirectory => "a part of its path is a file".to_owned(),
        Kind::ReadOnlyFilesystem => "the file system is for reading only".to_owned(),
        Kind::StorageFull => "the disk is full".to_owned(),
        Kind::QuotaExceeded => "the quota of this disk is used up".to_owned(),
        _ => error.to_string(),
    }
}

fn encode(record: &TrialRecord) -> Vec<u8> {
    let line = record.to_line();
    format!("{{\"sha256\":\"{}\",\"record\":{line}}}\n", Sha256Digest::of(&line)).into_bytes()
}

fn decode(bytes: &[u8]) -> Option<TrialRecord> {
    let text = std::str::from_utf8(bytes).ok()?;
    let (digest, rest) = text.strip_prefix("{\"sha256\":\"")?.split_at_checked(64)?;
    let line = rest.strip_prefix("\",\"record\":")?.strip_suffix("}\n")?;
    let whole = Sha256Digest::from_hex(digest)? == Sha256Digest::of(line);
    whole.then(|| TrialRecord::from_line(line).ok())?
}

/// Publishes `bytes` as `directory/name`: written beside it, made durable, renamed. A reader sees the old file or the
/// new one, never a part.
///
/// # Errors
/// Where the file system refuses.
pub fn publish(directory: &Path, name: &str, bytes: &[u8]) -> io::Result<PathBuf> {
    fs::create_dir_all(directory)?;
    let path = directory.join(name);
    partial::sweep(directory);
    let mut file = Partial::new(directory)?;
    file.write(bytes)?;
    file.persist(&path)?;
    sync_folder(directory)?;
    Ok(path)
}

/// Makes a rename last through a power cut. Windows has no such call and needs none.
fn sync_folder(directory: &Path) -> io::Result<()> {
    if cfg!(unix) { fs::File::open(directory)?.sync_all() } else { Ok(()) }
}

/// Reads an input file of at most `most` bytes: a file on a disk, for a device has no end and a pipe may never begin.
///
/// # Errors
/// Where it cannot be read, is no such file or too large, naming it.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Asked before it is opened: a socket cannot be, and a device may do something.
    if let Some(found) = kind_of(path) {
        return Err(no_file(found));
    }
    content(path, most)?.map_err(|length| {
        let found = length.map_or_else(|| "more".to_owned(), |length| length.to_string());
        let problem = format!("it is too large: expected at most {most} bytes, found {found}");
        io::Error::new(io::ErrorKind::FileTooLarge, problem)
    })
}

fn no_file(found: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("expected a file, found {found}"))
}

/// Reads the bytes of the file at `path`; where they are more than `most`, returns how many, as far as the file says.
fn content(path: &Path, most: u64) -> io::Result<Result<Vec<u8>, Option<u64>>> {
    let file = open(path)?;
    let metadata = file.metadata()?;
    // Or it is another thing by now.
    if let Some(found) = odd(&metadata) {
        return Err(no_file(found));
    }
    if metadata.len() > most {
        return Ok(Err(Some(metadata.len())));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
    // It may have grown meanwhile, and some files say nothing of their length.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(if bytes.len() as u64 > most { Err(None) } else { Ok(bytes) })
}

/// Opens a file to read it. Should a pipe have taken its place meanwhile, that does not wait for whoever writes to it.
fn open(path: &Path) -> io::Result<fs::File> {
    let mut options = fs::OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use fs_err::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(libc::O_NONBLOCK);
    }
    options.open(path)
}

/// Returns what stands at `path`, where it is something that is no file.
fn kind_of(path: &Path) -> Option<&'static str> {
    let leads_nowhere = || {
        let link = fs::symlink_metadata(path).ok()?;
        link.is_symlink().then_some("a symbolic link that leads nowhere")
    };
    match fs::metadata(path) {
        Ok(metadata) => odd(&metadata),
        Err(e) if e.kind() == io::ErrorKind::PermissionDenied => None,
        Err(_) => leads_nowhere(),
    }
}

/// Says in words what `metadata` describes, where it is no file.
fn odd(metadata: &std::fs::Metadata) -> Option<&'static str> {
    let kind = metadata.file_type();
    if kind.is_file() {
        return None;
    }
    if kind.is_dir() {
        return Some("a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    Some("a device")
}

/// Opens a bundle: a zip, or a folder that holds a bag or a crate. What is wrong with it is data, not an error.
///
/// # Errors
/// Where the path cannot be read at all.
pub fn open_bundle(
    path: &Path,
    limits: &archive::Limits,
) -> io::Result<Result<Archive, Vec<Fault>>> {
    let too_big = |found: Option<u64>| {
        let expected = format!("at most {} bytes", limits.bytes);
        let found = found.map_or_else(|| "more".to_owned(), |bytes| format!("{bytes} bytes"));
        Err(vec![Fault::new("(archive)", expected, found)])
    };
    let metadata = fs::metadata(path)?;
    if !metadata.is_dir() {
        if !metadata.is_file() {
            return Ok(Err(vec![Fault::new(
                "(archive)",
                "a file or a folder",
                "a device or a pipe",
            )]));
        }
        return Ok(match content(path, limits.bytes)? {
            Ok(bytes) => archive::read(&bytes, limits),
            Err(found) => too_big(found),
        });
    }
    let (mut files, mut faults, mut total, mut entries) = (Vec::new(), Vec::new(), 0, 0);
    let mut folders = vec![(path.to_owned(), String::new())];
    while let Some((folder, prefix)) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            // Folders count as well: there may be no end of empty ones.
            entries += 1;
            if entries > limits.entries {
                let expected = format!("at most {} files and folders", limits.entries);
                return Ok(Err(vec![Fault::new("(archive)", expected, "more")]));
            }
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type()?;
            if kind.is_dir() {
                // Its entry says that it is there, should nothing be in it.
                files.push((format!("{name}/"), Vec::new()));
                folders.push((entry.path(), format!("{name}/")));
            } else if kind.is_file() {
                match content(&entry.path(), limits.bytes - total)? {
                    Ok(bytes) => {
                        total += bytes.len() as u64;
                        files.push((name, bytes));
                    }
                    Err(found) => {
                        return Ok(too_big(found.map(|bytes| total.saturating_add(bytes))));
                    }
                }
            } else {
                let found = if kind.is_symlink() { "a symbolic link" } else { "a special file" };
                faults.push(Fault::new(name, "a plain file", found));
            }
        }
    }
    if faults.is_empty() {
        Ok(archive::from_files(files, limits))
    } else {
        faults.sort();
        Ok(Err(archive::told(faults)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::{Form, Limits, sample};

    #[test]
    fn records_survive_and_damage_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(directory.path().join("new/store"));
        let record = sample::record(7, "none", 0);
        assert_eq!(store.size().unwrap(), (0, 0));
        assert_eq!(store.get(&record.key).unwrap(), None);
        store.put(&record).unwrap();
        store.put(&record).unwrap();
        assert_eq!(store.get(&record.key).unwrap().as_ref(), Some(&record));
        assert_eq!(store.size().unwrap().0, 1);
        let path = store.path(&record.key);
        assert!(path.ends_with(format!("{}/{}.json", &record.key.hex()[..2], record.key)));
        let whole = fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(store.get(&record.key).unwrap(), None, "torn at {cut}, it is no record");
            let mut zeroed = whole.clone();
            zeroed[cut..].fill(0);
            fs::write(&path, &zeroed).unwrap();
            assert_eq!(store.get(&record.key).unwrap(), None, "with zeros from {cut} neither");
        }
        store.put(&record).unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole);
        let left: Vec<_> = fs::read_dir(path.parent().unwrap()).unwrap().collect();
        assert_eq!(left.len(), 1, "no temporary file stays");
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
    fn many_writers_agree() {
        let directory = tempfile::tempdir().unwrap();
        let store = DirectoryStore::new(directory.path());
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for trial in 0..20 {
                        store.put(&sample::record(7, "none", trial)).unwrap();
                    }
                });
            }
        });
        assert_eq!(store.size().unwrap().0, 20);
    }

    #[test]
    fn bundles_are_published_whole_and_opened_as_zip_or_folder() {
        let directory = tempfile::tempdir().unwrap();
        let sealed = sample::sealed();
        let zip = sealed.zip(Form::Bag);
        let path = publish(&directory.path().join("out"), &sealed.file_name(), &zip).unwrap();
        publish(&directory.path().join("out"), &sealed.file_name(), &zip).unwrap();
        assert_eq!(fs::read_dir(directory.path().join("out")).unwrap().count(), 1);
        let opened = open_bundle(&path, &Limits::default()).unwrap().unwrap();
        assert_eq!(opened.tree, sealed.tree);

        let folder = directory.path().join("folder");
        for (path, bytes) in &sealed.tree {
            fs::create_dir_all(folder.join(path).parent().unwrap()).unwrap();
            fs::write(folder.join(path), bytes).unwrap();
        }
        let opened = open_bundle(&folder, &Limits::default()).unwrap().unwrap();
        assert_eq!(opened.tree, sealed.tree);
        let small = Limits { bytes: 1000, ..Limits::default() };
        let faults = open_bundle(&path, &small).unwrap().unwrap_err();
        assert!(
            faults[0].to_string().starts_with("(archive): expected at most 1000 bytes, found ")
        );
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("/etc/passwd", folder.join("data/link")).unwrap();
            let faults = open_bundle(&folder, &Limits::default()).unwrap().unwrap_err();
            assert_eq!(
                faults[0].to_string(),
                "data/link: expected a plain file, found a symbolic link"
            );
        }
        #[cfg(unix)]
        {
            let endless = open_bundle(Path::new("/dev/zero"), &Limits::default()).unwrap();
            let fault = endless.unwrap_err()[0].to_string();
            assert_eq!(fault, "(archive): expected a file or a folder, found a device or a pipe");
        }
        assert!(open_bundle(&directory.path().join("absent"), &Limits::default()).is_err());
    }
}
