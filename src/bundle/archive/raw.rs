//! Bytes of an archive that are read as they are needed, wherever they are.

use crate::bundle::Source;
use std::cell::RefCell;
use std::io;

/// Bytes of a source from one place to another.
#[derive(Debug)]
pub(super) struct Raw<'a> {
    source: &'a dyn Source,
    from: u64,
    to: u64,
    /// The first failure to read: from then on nothing that was found says anything of the archive.
    failed: &'a RefCell<Option<io::Error>>,
}

/// Bytes that are looked through at once.
const BLOCK: u64 = 1 << 16;

impl<'a> Raw<'a> {
    /// Returns all `length` bytes of `source`. Where one of them cannot be read, `failed` is told, and they end there.
    pub(super) fn new(
        source: &'a dyn Source,
        length: u64,
        failed: &'a RefCell<Option<io::Error>>,
    ) -> Self {
        Self { source, from: 0, to: length, failed }
    }

    /// Returns the part from one place in these bytes to another.
    pub(super) fn part(&self, from: u64, to: u64) -> Self {
        let place = |at: u64| self.from.saturating_add(at).min(self.to);
        let to = place(to);
        Self { source: self.source, from: place(from).min(to), to, failed: self.failed }
    }

    /// Returns how many there are.
    pub(super) fn len(&self) -> u64 {
        self.to - self.from
    }

    /// Returns the bytes from `at` on, `count` at most: less where they end.
    pub(super) fn up_to(&self, at: u64, count: u64) -> Vec<u8> {
        let count = count.min(self.len().saturating_sub(at));
        let mut bytes = vec![0; usize::try_from(count).unwrap_or(0)];
        let mut have = 0;
        while have < bytes.len() {
            match self.source.read_at(self.from + at + have as u64, &mut bytes[have..]) {
                Ok(0) => break,
                Ok(read) => have += read,
                Err(error) => {
                    self.failed.borrow_mut().get_or_insert(error);
                    break;
                }
            }
        }
        bytes.truncate(have);
        bytes
    }

    /// Returns the `count` bytes from `at` on; `None` where they end before.
    pub(super) fn get(&self, at: u64, count: u64) -> Option<Vec<u8>> {
        Some(self.up_to(at, count)).filter(|bytes| bytes.len() as u64 == count)
    }

    /// Returns the last place where `mark` stands.
    pub(super) fn last(&self, mark: [u8; 4]) -> Option<u64> {
        let mut to = self.len();
        loop {
            let from = to.saturating_sub(BLOCK);
            // Three bytes more, for a mark across the border.
            let block = self.up_to(from, to - from + 3);
            if let Some(at) = block.windows(4).rposition(|w| w == mark) {
                return Some(from + at as u64);
            }
            if from == 0 {
                return None;
            }
            to = from;
        }
    }

    /// Returns whether `is_it` says so of any window of so many bytes, and of where it begins.
    pub(super) fn any_window(&self, size: u64, is_it: impl Fn(u64, &[u8]) -> bool) -> bool {
        let (mut from, width) = (0, usize::try_from(size).unwrap_or(1));
        while from < self.len() {
            let block = self.up_to(from, BLOCK + size - 1);
            if block.windows(width).zip(from..).any(|(window, at)| is_it(at, window)) {
                return true;
            }
            from += BLOCK;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_looked_for_is_found_across_blocks() {
        let failed = RefCell::new(None);
        for at in [0, 1, 65_533, 65_534, 65_535, 65_536, 70_000, 131_070, 140_000 - 4] {
            let mut bytes = vec![0_u8; 140_000];
            bytes[at..at + 4].copy_from_slice(b"PK\x05\x06");
            let raw = Raw::new(&bytes, 140_000, &failed);
            assert_eq!(raw.last(*b"PK\x05\x06"), Some(at as u64));
            assert!(raw.any_window(4, |place, w| w == b"PK\x05\x06" && place == at as u64));
            assert_eq!(raw.last(*b"PK\x01\x02"), None);
            let part = raw.part(at as u64, at as u64 + 2);
            assert_eq!(
                (part.len(), part.get(0, 2), part.get(0, 3)),
                (2, Some(b"PK".to_vec()), None)
            );
        }
        assert!(failed.into_inner().is_none());
    }
}
