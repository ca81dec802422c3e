//! Files of a bundle, and how those are held that have a line for each trial: as a stream that can be read again, not in memory.
//!
//! A [`Scratch`] lends places to write to; a [`Spool`] is written to and becomes a [`Content`]: in memory while it is small, in a
//! scratch file otherwise. Whoever opens an archive makes [`LargeFile`]s of places in it.

use super::Tree;
use super::archive::inflating;
use crate::digest::{Hasher, Sha256Digest};
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead as _, BufReader, Read, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes that stay as they are and can be read at any place, by several readers at a time.
pub trait Source: fmt::Debug + Send + Sync {
    /// Fills the beginning of `into` with bytes from `at` on; returns how many, none at the end only.
    ///
    /// # Errors
    /// Where they cannot be read.
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize>;
}

impl Source for Vec<u8> {
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        let rest = usize::try_from(at).ok().and_then(|at| self.get(at..)).unwrap_or_default();
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }
}

/// A place for what does not fit into memory. Nothing in it outlives the process.
pub trait Scratch: fmt::Debug {
    /// Writes `bytes` behind all that was written, and returns where they begin.
    ///
    /// # Errors
    /// Where they cannot be written.
    fn append(&self, bytes: &[u8]) -> io::Result<u64>;

    /// Returns all that was and will be written.
    fn source(&self) -> Arc<dyn Source>;

    /// Returns whether it is in memory, so that nothing is won by writing to it.
    fn is_memory(&self) -> bool {
        false
    }
}

/// A place in memory after all, for whoever has no disk.
#[derive(Debug, Clone, Default)]
pub struct InMemory(Arc<Mutex<Vec<u8>>>);

impl Source for Mutex<Vec<u8>> {
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        self.lock().unwrap_or_else(PoisonError::into_inner).read_at(at, into)
    }
}

impl Scratch for InMemory {
    fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let from = all.len() as u64;
        all.extend_from_slice(bytes);
        Ok(from)
    }

    fn source(&self) -> Arc<dyn Source> {
        Arc::<Mutex<Vec<u8>>>::clone(&self.0)
    }

    fn is_memory(&self) -> bool {
        true
    }
}

/// A place that forgets what is written to it: of files in it, sizes and digests are known, which is enough to compare them.
#[derive(Debug, Default)]
pub struct Forgetful(Cell<u64>);

/// What is left in a place that forgets.
#[derive(Debug)]
struct Forgotten;

impl Source for Forgotten {
    fn read_at(&self, _: u64, _: &mut [u8]) -> io::Result<usize> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

impl Scratch for Forgetful {
    fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        let from = self.0.get();
        self.0.set(from + bytes.len() as u64);
        Ok(from)
    }

    fn source(&self) -> Arc<dyn Source> {
        Arc::new(Forgotten)
    }
}

/// Bytes that are written at once.
const BLOCK: usize = 1 << 16;

/// How many bytes of a file are held in memory at most, where it may be large.
pub(super) const HELD: u64 = 1 << 20;

/// Where the bytes of a large file are.
#[derive(Debug, Clone)]
enum Place {
    /// As they are, from this byte on.
    Plain { source: Arc<dyn Source>, from: u64 },
    /// Deflated, from this byte on, so many.
    Packed { source: Arc<dyn Source>, from: u64, packed: u64 },
}

/// A file that is read as a stream. Two are equal where their bytes are.
#[derive(Debug, Clone)]
pub struct LargeFile {
    size: u64,
    digest: Sha256Digest,
    is_text: bool,
    lines: usize,
    last: Option<u8>,
    place: Place,
}

impl PartialEq for LargeFile {
    fn eq(&self, other: &Self) -> bool {
        (self.size, self.digest) == (other.size, other.digest)
    }
}

impl LargeFile {
    /// Returns the file whose bytes stand in `source` as they are from `from` on, and which are `known`.
    pub(super) fn plain(source: Arc<dyn Source>, from: u64, known: Passed) -> Self {
        Self::of(Place::Plain { source, from }, known)
    }

    /// Returns the file that is deflated in `packed` bytes of `source` from `from` on, and whose bytes are `known`.
    pub(super) fn packed(source: Arc<dyn Source>, from: u64, packed: u64, known: Passed) -> Self {
        Self::of(Place::Packed { source, from, packed }, known)
    }

    fn of(place: Place, known: Passed) -> Self {
        let Passed { size, digest, is_text, lines, last } = known;
        Self { size, digest, is_text, lines, last, place }
    }

    /// Returns how many bytes it has.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Returns the digest of its bytes.
    pub fn digest(&self) -> Sha256Digest {
        self.digest
    }

    /// Returns whether it is UTF-8 text.
    pub fn is_text(&self) -> bool {
        self.is_text
    }

    /// Returns its bytes from the first on.
    pub fn reader(&self) -> Box<dyn Read + '_> {
        match &self.place {
            Place::Plain { source, from } => {
                Box::new(SourceReader { source: &**source, at: *from, left: self.size })
            }
            Place::Packed { source, from, packed } => {
                let packed = SourceReader { source: &**source, at: *from, left: *packed };
                Box::new(inflating(packed).take(self.size))
            }
        }
    }
}

/// Reads some bytes of a source one after another.
pub(super) struct SourceReader<'a> {
    pub(super) source: &'a dyn Source,
    pub(super) at: u64,
    pub(super) left: u64,
}

impl Read for SourceReader<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(into.len());
        let count = self.source.read_at(self.at, &mut into[..most])?;
        self.at += count as u64;
        self.left -= count as u64;
        Ok(count)
    }
}

/// A file that may be large, by what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// All its bytes.
    Held(Vec<u8>),
    /// Where they are.
    Large(LargeFile),
}

impl From<Vec<u8>> for Content {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Held(bytes)
    }
}

impl Content {
    /// Returns it as whatever stands in a bundle.
    pub fn as_file(&self) -> FileRef<'_> {
        match self {
            Self::Held(bytes) => FileRef::Held(bytes),
            Self::Large(large) => FileRef::Large(large),
        }
    }
}

/// A file of a bundle.
#[derive(Debug, Clone, Copy)]
pub enum FileRef<'a> {
    /// All its bytes.
    Held(&'a [u8]),
    /// Where they are.
    Large(&'a LargeFile),
}

impl<'a> FileRef<'a> {
    /// Returns how many bytes it has.
    pub fn size(self) -> u64 {
        match self {
            Self::Held(bytes) => bytes.len() as u64,
            Self::Large(large) => large.size(),
        }
    }

    /// Returns the digest of its bytes.
    pub fn digest(self) -> Sha256Digest {
        match self {
            Self::Held(bytes) => Sha256Digest::of(bytes),
            Self::Large(large) => large.digest(),
        }
    }

    /// Returns whether it is UTF-8 text.
    pub fn is_text(self) -> bool {
        match self {
            Self::Held(bytes) => std::str::from_utf8(bytes).is_ok(),
            Self::Large(large) => large.is_text(),
        }
    }

    /// Returns its bytes from the first on.
    pub fn reader(self) -> Box<dyn Read + 'a> {
        match self {
            Self::Held(bytes) => Box::new(bytes),
            Self::Large(large) => large.reader(),
        }
    }

    /// Returns all its bytes, where they are in memory.
    pub fn held(self) -> Option<&'a [u8]> {
        match self {
            Self::Held(bytes) => Some(bytes),
            Self::Large(_) => None,
        }
    }

    /// Returns its last byte.
    pub fn last_byte(self) -> Option<u8> {
        match self {
            Self::Held(bytes) => bytes.last().copied(),
            Self::Large(large) => large.last,
        }
    }

    /// Counts its lines; text that is none has no lines.
    pub fn line_count(self) -> usize {
        match self {
            Self::Held(bytes) => std::str::from_utf8(bytes).unwrap_or_default().lines().count(),
            Self::Large(large) if large.is_text => large.lines,
            Self::Large(_) => 0,
        }
    }

    /// Reads all its bytes into memory, `most` at most; `None` where there are more or they cannot be read.
    pub fn whole(self, most: u64) -> Option<Cow<'a, [u8]>> {
        match self {
            Self::Held(bytes) => Some(Cow::Borrowed(bytes)),
            Self::Large(large) => {
                let mut bytes = Vec::new();
                let fits = large.size() <= most && large.reader().read_to_end(&mut bytes).is_ok();
                fits.then_some(Cow::Owned(bytes))
            }
        }
    }

    /// Hands each line over, without its line feed, until `take` says not to go on. Text that is none has no lines.
    pub fn lines(self, mut take: impl FnMut(&str) -> bool) {
        match self {
            Self::Held(bytes) => {
                for line in std::str::from_utf8(bytes).unwrap_or_default().lines() {
                    if !take(line) {
                        return;
                    }
                }
            }
            Self::Large(large) if large.is_text() => {
                let mut reader = BufReader::with_capacity(1 << 16, large.reader());
                let mut line = Vec::new();
                loop {
                    line.clear();
                    match reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
                        Ok(0) | Err(_) => return,
                        Ok(_) => {}
                    }
                    // As `str::lines` has them.
                    let ended = line.strip_suffix(b"\n");
                    let text = ended.map_or(&line[..], |l| l.strip_suffix(b"\r").unwrap_or(l));
                    // A line that is cut where it is too long may be cut in a character: it is no record's anyway.
                    if !take(std::str::from_utf8(text).unwrap_or_default()) {
                        return;
                    }
                }
            }
            Self::Large(_) => {}
        }
    }
}

/// Bytes that are read as one line: ten times what a record may have, so that a longer one is refused and not held.
const LONGEST_LINE: u64 = 48 << 20;

/// The files of a bundle that are not in memory, by their path relative to the bag's root.
pub type LargeFiles = BTreeMap<String, LargeFile>;

/// All files of a bundle.
#[derive(Debug, Clone, Copy)]
pub struct Files<'a> {
    /// Those in memory.
    pub tree: &'a Tree,
    /// The others.
    pub large: &'a LargeFiles,
}

impl<'a> Files<'a> {
    /// Returns the file `path`.
    pub fn get(self, path: &str) -> Option<FileRef<'a>> {
        let held = self.tree.get(path).map(|bytes| FileRef::Held(bytes));
        held.or_else(|| self.large.get(path).map(FileRef::Large))
    }

    /// Returns every file, sorted by path.
    pub fn iter(self) -> impl Iterator<Item = (&'a String, FileRef<'a>)> {
        let (mut tree, mut large) = (self.tree.iter().peekable(), self.large.iter().peekable());
        std::iter::from_fn(move || match (tree.peek(), large.peek()) {
            (Some((a, _)), Some((b, _))) if b < a => {
                large.next().map(|(path, file)| (path, FileRef::Large(file)))
            }
            (None, Some(_)) => large.next().map(|(path, file)| (path, FileRef::Large(file))),
            _ => tree.next().map(|(path, bytes)| (path, FileRef::Held(bytes.as_slice()))),
        })
    }

    /// Returns every path, sorted.
    pub fn paths(self) -> impl Iterator<Item = &'a String> {
        self.iter().map(|(path, _)| path)
    }

    /// Returns how many files there are.
    pub fn len(self) -> usize {
        self.tree.len() + self.large.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

/// What is known of bytes that went by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Passed {
    pub(super) size: u64,
    pub(super) digest: Sha256Digest,
    pub(super) is_text: bool,
    pub(super) lines: usize,
    pub(super) last: Option<u8>,
}

/// Takes note of bytes that go by.
pub(super) struct Passing {
    hasher: Hasher,
    size: u64,
    /// Line feeds.
    feeds: usize,
    last: Option<u8>,
    /// The beginning of a character whose end has not come yet.
    open: Vec<u8>,
    is_text: bool,
}

impl Passing {
    pub(super) fn new() -> Self {
        Self {
            hasher: Hasher::new(),
            size: 0,
            feeds: 0,
            last: None,
            open: Vec::new(),
            is_text: true,
        }
    }

    pub(super) fn take(&mut self, mut bytes: &[u8]) {
        self.hasher.update(bytes);
        self.size += bytes.len() as u64;
        self.feeds += bytes.split(|byte| *byte == b'\n').count() - 1;
        self.last = bytes.last().copied().or(self.last);
        while !self.open.is_empty() && self.is_text && !bytes.is_empty() {
            self.open.push(bytes[0]);
            bytes = &bytes[1..];
            match std::str::from_utf8(&self.open) {
                Ok(_) => self.open.clear(),
                Err(error) => self.is_text = error.error_len().is_none(),
            }
        }
        if self.is_text
            && let Err(error) = std::str::from_utf8(bytes)
        {
            self.is_text = error.error_len().is_none();
            self.open = bytes[error.valid_up_to()..].to_vec();
        }
    }

    pub(super) fn done(self) -> Passed {
        let is_text = self.is_text && self.open.is_empty();
        let (digest, last) = (self.hasher.digest(), self.last);
        let lines = self.feeds + usize::from(last.is_some_and(|last| last != b'\n'));
        Passed { size: self.size, digest, is_text, lines, last }
    }
}

/// A file that is being written. Of those that write to one scratch, one is open at a time.
pub struct Spool<'a> {
    scratch: &'a dyn Scratch,
    /// How many bytes it may hold.
    most: u64,
    held: Vec<u8>,
    /// Where it begins in the scratch, and how many bytes are there.
    written: Option<(u64, u64)>,
    passing: Passing,
}

impl fmt::Debug for Spool<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Spool of {} bytes", self.passing.size)
    }
}

impl<'a> Spool<'a> {
    /// Begins one that holds at most a megabyte in memory.
    pub fn new(scratch: &'a dyn Scratch) -> Self {
        Self::holding(scratch, HELD)
    }

    /// Begins one that holds at most so many bytes in memory, and a megabyte.
    pub fn holding(scratch: &'a dyn Scratch, most: u64) -> Self {
        let most = if scratch.is_memory() { u64::MAX } else { most.min(HELD) };
        Self { scratch, most, held: Vec::new(), written: None, passing: Passing::new() }
    }

    /// Returns how many bytes were written.
    pub fn size(&self) -> u64 {
        self.passing.size
    }

    /// Ends it.
    ///
    /// # Errors
    /// Where not all of it could be written.
    pub fn finish(mut self) -> io::Result<Content> {
        if self.written.is_none() && self.held.len() as u64 <= self.most {
            return Ok(Content::Held(self.held));
        }
        self.spill()?;
        let from = self.written.map_or(0, |(from, _)| from);
        Ok(Content::Large(LargeFile::plain(self.scratch.source(), from, self.passing.done())))
    }

    /// Moves what is held to the scratch.
    fn spill(&mut self) -> io::Result<()> {
        let at = self.scratch.append(&self.held)?;
        let (from, length) = self.written.unwrap_or((at, 0));
        if at != from + length {
            return Err(io::Error::other("two files were written to one scratch at once"));
        }
        self.written = Some((from, length + self.held.len() as u64));
        self.held.clear();
        self.held.shrink_to(BLOCK);
        Ok(())
    }
}

impl Write for Spool<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.passing.take(bytes);
        self.held.extend_from_slice(bytes);
        if self.held.len() > BLOCK && (self.written.is_some() || self.held.len() as u64 > self.most)
        {
            self.spill()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place that passes for one on a disk.
    #[derive(Debug, Default)]
    struct Elsewhere(InMemory);

    impl Scratch for Elsewhere {
        fn append(&self, bytes: &[u8]) -> io::Result<u64> {
            self.0.append(bytes)
        }

        fn source(&self) -> Arc<dyn Source> {
            self.0.source()
        }
    }

    fn spooled(lines: usize) -> Content {
        let scratch = Elsewhere::default();
        scratch.append(b"before it").unwrap();
        let mut spool = Spool::new(&scratch);
        for i in 0..lines {
            writeln!(spool, "{i:09}").unwrap();
        }
        spool.finish().unwrap()
    }

    #[test]
    fn a_file_says_the_same_in_memory_and_elsewhere() {
        let text: Vec<String> = (0..200_000).map(|i| format!("{i:09}\n")).collect();
        let text = text.concat();
        let large = spooled(200_000);
        assert!(matches!(large, Content::Large(_)), "2 MB");
        assert!(matches!(spooled(3), Content::Held(_)));
        let memory = InMemory::default();
        let mut spool = Spool::new(&memory);
        spool.write_all(text.as_bytes()).unwrap();
        assert!(
            matches!(spool.finish().unwrap(), Content::Held(bytes) if bytes == text.as_bytes())
        );
        let (held, large) = (FileRef::Held(text.as_bytes()), large.as_file());
        assert_eq!((held.size(), held.digest()), (large.size(), large.digest()));
        assert_eq!((large.last_byte(), large.line_count()), (Some(b'\n'), 200_000));
        assert!(large.is_text() && large.held().is_none());
        let mut bytes = Vec::new();
        large.reader().read_to_end(&mut bytes).unwrap();
        assert!(bytes == text.as_bytes());
        let mut lines = text.lines();
        large.lines(|line| {
            assert_eq!(Some(line), lines.next());
            true
        });
        assert_eq!(lines.next(), None);
    }

    #[test]
    fn text_is_known_however_it_is_cut() {
        let is_text = |bytes: &[u8], step: usize| {
            let mut passing = Passing::new();
            bytes.chunks(step).for_each(|chunk| passing.take(chunk));
            passing.done().is_text
        };
        for step in 1..7 {
            assert!(is_text("a·ß€\u{1d11e}z".as_bytes(), step));
            assert!(!is_text(b"a\xff", step) && !is_text(b"\xe2\x82", step));
            assert!(!is_text(b"\xe2\x28\xa1 ", step) && !is_text(b"ab\x80cd", step));
        }
    }

    #[test]
    fn files_are_listed_in_the_order_of_their_paths() {
        let tree: Tree = ["a", "c", "e"].map(|p| (p.to_owned(), p.into())).into();
        let Content::Large(file) = spooled(200_000) else { panic!("large") };
        let large = ["b", "d", "f"].map(|path| (path.to_owned(), file.clone())).into();
        let files = Files { tree: &tree, large: &large };
        let paths: Vec<&str> = files.paths().map(String::as_str).collect();
        assert_eq!(paths, ["a", "b", "c", "d", "e", "f"]);
        assert_eq!(files.len(), 6);
        assert_eq!(files.get("d").map(FileRef::size), Some(2_000_000));
        assert!(files.get("g").is_none());
    }
}
