//! Places for what does not fit into memory: a [`Scratch`] lends them, a [`Spool`] is written to and becomes a [`Content`], in memory
//! while it is small.

use super::{Content, LargeFile};
use crate::digest::{Hasher, Sha256Digest};
use std::cell::Cell;
use std::fmt;
use std::io::{self, Write};
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
}
