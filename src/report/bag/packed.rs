//! A bag whose chunks are compressed by zstd, made of one whose chunks are not: the container's crate compresses with C code alone.
//!
//! A chunk's records are compressed; what points at a record behind it moves with it, and the checksums of what has changed are
//! made anew (MCAP specification, "Records"):
//! 1. Chunk: `compression`, and the length of its records. Size and checksum are of the records uncompressed, and stay.
//! 2. Chunk Index: where the chunk and its message indexes begin, their lengths, `compression` and the compressed size.
//! 3. Metadata Index: where its record begins.
//! 4. Summary Offset: where its group begins, and its length.
//! 5. Data End and Footer: checksums, and where both parts of the summary begin.

use crate::world::map_server::bag::framing::{
    self, CHUNK, CHUNK_HEAD, DATA_END, FOOTER, HEAD, MAGIC_LENGTH, short,
};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::collections::BTreeMap;

/// Kinds of records that no reader of messages needs.
const CHUNK_INDEX: u8 = 8;
const METADATA_INDEX: u8 = 0x0d;
const SUMMARY_OFFSET: u8 = 0x0e;

/// What the chunks are compressed by.
const ZSTD: &[u8] = b"zstd";

/// Compresses the chunks of `plain`, a whole bag; `None` where it is no bag that the container's crate writes. The same bytes give
/// the same bytes on every machine.
pub(super) fn packed(plain: &[u8]) -> Option<Vec<u8>> {
    let mut packing = Packing::default();
    packing.bytes.extend_from_slice(plain.get(..MAGIC_LENGTH)?);
    let mut at = MAGIC_LENGTH;
    while at < plain.len() - MAGIC_LENGTH {
        let (kind, content) = record(plain.get(at..)?)?;
        packing.starts.insert(at as u64, packing.bytes.len() as u64);
        packing.record(at as u64, kind, content)?;
        at += HEAD + content.len();
    }
    packing.bytes.extend_from_slice(plain.get(at..)?);
    Some(packing.bytes)
}

/// Returns the kind and the content of the record that `bytes` begin with.
fn record(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let ([kind, length @ ..], rest) = bytes.split_first_chunk::<HEAD>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    Some((*kind, rest.get(..length)?))
}

/// A bag as far as it is packed.
#[derive(Default)]
struct Packing {
    bytes: Vec<u8>,
    /// Where each record begins that began there in the plain bag.
    starts: BTreeMap<u64, u64>,
    /// The lengths of chunks that were compressed: of the record, and of the records in it.
    chunks: BTreeMap<u64, (u64, u64)>,
}

impl Packing {
    /// Appends the record that began at `at` in the plain bag.
    fn record(&mut self, at: u64, kind: u8, content: &[u8]) -> Option<()> {
        match kind {
            CHUNK => {
                let content = chunk(content)?;
                if let Some(size) = content.compressed {
                    self.chunks.insert(at, ((HEAD + content.bytes.len()) as u64, size));
                }
                self.push(kind, &content.bytes);
            }
            CHUNK_INDEX => {
                let content = self.chunk_index(content)?;
                self.push(kind, &content);
            }
            METADATA_INDEX => {
                let (start, rest) = number(content)?;
                self.push(kind, &[&self.moved(start)?.to_le_bytes(), rest].concat());
            }
            SUMMARY_OFFSET => {
                let (group, rest) = content.split_first()?;
                let (start, rest) = number(rest)?;
                let (length, _) = number(rest)?;
                let (start, end) = (self.moved(start)?, self.moved(start + length)?);
                let length = (end - start).to_le_bytes();
                self.push(kind, &[&[*group][..], &start.to_le_bytes(), &length].concat());
            }
            DATA_END => {
                let sum = crc32fast::hash(&self.bytes);
                self.push(kind, &sum.to_le_bytes());
            }
            FOOTER => {
                let (summary, rest) = number(content)?;
                let (offsets, _) = number(rest)?;
                let summary = self.moved(summary)?;
                let offsets = self.moved(offsets)?;
                self.push(kind, &[summary.to_le_bytes(), offsets.to_le_bytes()].concat());
                // The length counts the checksum, which is of the summary and of the footer up to itself.
                let length = self.bytes.len() - 16 - 8;
                self.bytes[length..length + 8].copy_from_slice(&20_u64.to_le_bytes());
                let sum = crc32fast::hash(self.bytes.get(usize::try_from(summary).ok()?..)?);
                self.bytes.extend_from_slice(&sum.to_le_bytes());
            }
            _ => self.push(kind, content),
        }
        Some(())
    }

    fn push(&mut self, kind: u8, content: &[u8]) {
        self.bytes.push(kind);
        self.bytes.extend_from_slice(&(content.len() as u64).to_le_bytes());
        self.bytes.extend_from_slice(content);
    }

    /// Returns where a record begins that began at `start`; none (0) stays none.
    fn moved(&self, start: u64) -> Option<u64> {
        if start == 0 { Some(0) } else { self.starts.get(&start).copied() }
    }

    fn chunk_index(&self, content: &[u8]) -> Option<Vec<u8>> {
        let (times, rest) = content.split_at_checked(16)?;
        let (start, rest) = number(rest)?;
        let (length, rest) = number(rest)?;
        let (indexes, rest) = short(rest)?;
        let (indexes_length, rest) = rest.split_at_checked(8)?;
        let (compression, rest) = short(rest)?;
        let (size, uncompressed) = rest.split_at_checked(8)?;
        let mut written = times.to_vec();
        written.extend(self.moved(start)?.to_le_bytes());
        let chunk = self.chunks.get(&start);
        written.extend(chunk.map_or(length, |(length, _)| *length).to_le_bytes());
        written.extend(u32::try_from(indexes.len()).ok()?.to_le_bytes());
        for index in indexes.chunks(10) {
            let (channel, at) = index.split_at_checked(2)?;
            written.extend_from_slice(channel);
            written.extend(self.moved(number(at)?.0)?.to_le_bytes());
        }
        written.extend_from_slice(indexes_length);
        let (compression, size) = match chunk {
            Some((_, size)) => (ZSTD, size.to_le_bytes().to_vec()),
            None => (compression, size.to_vec()),
        };
        written.extend(u32::try_from(compression.len()).ok()?.to_le_bytes());
        written.extend_from_slice(compression);
        written.extend(size);
        written.extend_from_slice(uncompressed);
        Some(written)
    }
}

/// A chunk's content.
struct Chunk {
    bytes: Vec<u8>,
    /// How many bytes its records have; `None` where they are as they were.
    compressed: Option<u64>,
}

/// Compresses the records of a chunk that has this `content`, where that makes them shorter.
fn chunk(content: &[u8]) -> Option<Chunk> {
    let (compression, records) = framing::chunk(content)?;
    let head = &content[..CHUNK_HEAD];
    let shorter = compress_to_vec(records, CompressionLevel::Fastest);
    if !compression.is_empty() || shorter.len() >= records.len() {
        return Some(Chunk { bytes: content.to_vec(), compressed: None });
    }
    let size = shorter.len() as u64;
    let name = u32::try_from(ZSTD.len()).ok()?.to_le_bytes();
    let bytes = [head, &name, ZSTD, &size.to_le_bytes(), &shorter].concat();
    Some(Chunk { bytes, compressed: Some(size) })
}

/// Returns the number that `bytes` begin with, and what comes behind it.
fn number(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let (number, rest) = bytes.split_first_chunk()?;
    Some((u64::from_le_bytes(*number), rest))
}
