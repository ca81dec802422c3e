//! Files of a bundle, and how those are held that have a line for each trial: as a stream that can be read again, not in memory.
//!
//! Whoever writes one makes it of what it wrote ([`super::Spool`]); whoever opens an archive makes it of a place in that.

use super::archive::inflating;
use super::scratch::Passed;
use super::{Source, Tree};
use crate::digest::Sha256Digest;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead as _, BufReader, Read};
use std::sync::Arc;

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
        let mut lines = self.line_reader();
        while let Some(line) = lines.next_line() {
            if !take(line) {
                return;
            }
        }
    }

    /// Returns its lines one by one, without their line feeds. Text that is none has no lines.
    pub fn line_reader(self) -> Lines<'a> {
        let reader = self.is_text().then(|| BufReader::with_capacity(1 << 16, self.reader()));
        Lines { reader, line: Vec::new() }
    }
}

/// The lines of a file.
pub struct Lines<'a> {
    reader: Option<BufReader<Box<dyn Read + 'a>>>,
    line: Vec<u8>,
}

impl fmt::Debug for Lines<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Lines")
    }
}

impl Lines<'_> {
    /// Returns the next one; `None` at the end, or where the file cannot be read on.
    pub fn next_line(&mut self) -> Option<&str> {
        self.advance().then(|| self.line())
    }

    /// Reads the next one, and returns whether there is one.
    pub(super) fn advance(&mut self) -> bool {
        self.line.clear();
        let Some(reader) = &mut self.reader else { return false };
        reader.take(LONGEST_LINE).read_until(b'\n', &mut self.line).is_ok_and(|read| read > 0)
    }

    /// Returns the line that was read last, as `str::lines` has it.
    pub(super) fn line(&self) -> &str {
        let ended = self.line.strip_suffix(b"\n");
        let text = ended.map_or(&self.line[..], |line| line.strip_suffix(b"\r").unwrap_or(line));
        // A line that is cut where it is too long may be cut in a character: it is no record's anyway.
        std::str::from_utf8(text).unwrap_or_default()
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

#[cfg(test)]
mod tests {
    use super::super::{InMemory, Scratch, Spool};
    use super::*;
    use std::io::Write as _;

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
