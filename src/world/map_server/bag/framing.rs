//! The messages of an MCAP file and what says how they are read, without the rest: indices, attachments, statistics. Every length is
//! held against what is there, before anybody asks for so much memory (MCAP specification, "Records"); what the records mean is for
//! others to say.

use super::MAGIC;
use crate::document::quoted;
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use std::io::Read as _;

/// Length of the magic bytes at both ends, and of a record's head: its kind and its length.
pub(crate) const MAGIC_LENGTH: usize = 8;
pub(crate) const HEAD: usize = 9;

/// Kinds of records.
pub(crate) const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
pub(crate) const CHUNK: u8 = 6;
pub(crate) const DATA_END: u8 = 15;

/// What stands in a chunk before its compression: times, size, checksum.
pub(crate) const CHUNK_HEAD: usize = 28;
/// Where in it size and checksum of its records stand, before compression.
const SIZE: usize = 16;
const CHECKSUM: usize = 24;

/// How much all chunks may come to where they are unpacked (bytes), of which up to four copies are in memory at a time, and how far
/// back a chunk may refer.
const MAX_UNPACKED: u64 = 32 << 20;
const MAX_WINDOW: u64 = 16 << 20;

const LONGER: &str = "a record says that it is longer than it is";

/// Returns the file that holds the messages of `bytes` with their channels and schemas, chunks taken apart.
///
/// # Errors
/// What is wrong with it.
pub(super) fn messages(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let (magic, records) = bytes.split_at_checked(MAGIC_LENGTH).ok_or(LONGER)?;
    let mut kept = magic.to_vec();
    let mut room = MAX_UNPACKED;
    keep(records, &mut kept, Within::File, &mut room)?;
    kept.extend_from_slice(magic);
    Ok(kept)
}

/// What records are in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Within {
    File,
    Chunk,
}

/// Appends to `kept` what is wanted of `records`; chunks in them may be unpacked to so many bytes as there is `room`.
fn keep(
    mut records: &[u8],
    kept: &mut Vec<u8>,
    within: Within,
    room: &mut u64,
) -> Result<(), String> {
    loop {
        if match within {
            Within::File => records.starts_with(MAGIC),
            Within::Chunk => records.is_empty(),
        } {
            return Ok(());
        }
        let (head, rest) = records.split_first_chunk::<HEAD>().ok_or("it ends within a record")?;
        let [kind, length @ ..] = *head;
        let (content, rest) = counted(u64::from_le_bytes(length), rest).ok_or(LONGER)?;
        let is_kept = match kind {
            CHUNK if within == Within::Chunk => return Err("a chunk lies in a chunk".to_owned()),
            CHUNK => {
                let (compression, records) = chunk(content).ok_or(LONGER)?;
                match compression {
                    b"" => keep(records, kept, Within::Chunk, room)?,
                    b"zstd" => keep(&unpacked(content, records, room)?, kept, Within::Chunk, room)?,
                    other => {
                        let name = String::from_utf8_lossy(other);
                        return Err(format!("a chunk is compressed as `{}`", quoted(&name)));
                    }
                }
                false
            }
            SCHEMA => schema(content).map(|()| true).ok_or(LONGER)?,
            CHANNEL => channel(content).map(|()| true).ok_or(LONGER)?,
            MESSAGE | DATA_END | FOOTER => true,
            _ => false,
        };
        if is_kept {
            kept.extend_from_slice(head);
            kept.extend_from_slice(content);
        }
        records = rest;
    }
}

/// Returns so many bytes, and what comes behind them.
fn counted(length: u64, bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    bytes.split_at_checked(usize::try_from(length).ok()?)
}

/// Returns bytes whose number of 32 bits stands before them, and what comes behind.
pub(crate) fn short(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    counted(u32::from_le_bytes(*length).into(), rest)
}

/// Returns how a chunk is compressed, and its records.
pub(crate) fn chunk(content: &[u8]) -> Option<(&[u8], &[u8])> {
    let (compression, rest) = short(content.get(CHUNK_HEAD..)?)?;
    let (length, rest) = rest.split_first_chunk()?;
    let (records, _) = counted(u64::from_le_bytes(*length), rest)?;
    Some((compression, records))
}

/// Unpacks `records`, those of the chunk with this `content`, into what there is `room` for.
fn unpacked(content: &[u8], records: &[u8], room: &mut u64) -> Result<Vec<u8>, String> {
    let size = content.get(SIZE..).and_then(|rest| rest.first_chunk()).ok_or(LONGER)?;
    let sum = content.get(CHECKSUM..).and_then(|rest| rest.first_chunk()).ok_or(LONGER)?;
    let (size, sum) = (u64::from_le_bytes(*size), u32::from_le_bytes(*sum));
    *room = room.checked_sub(size).ok_or_else(|| {
        format!("its chunks are larger than {} MiB when unpacked", MAX_UNPACKED >> 20)
    })?;
    let damaged = || "a chunk is not what it says, once it is unpacked".to_owned();
    let mut decoder = FrameDecoder::new();
    decoder.set_max_window_size(MAX_WINDOW);
    let decoder = StreamingDecoder::new_with_decoder(records, decoder).map_err(|_| damaged())?;
    // Memory is asked for as bytes come, not as the chunk says.
    let mut unpacked = Vec::new();
    decoder.take(size + 1).read_to_end(&mut unpacked).map_err(|_| damaged())?;
    // A checksum of 0 says that there is none.
    let is_whole = unpacked.len() as u64 == size && (sum == 0 || crc32fast::hash(&unpacked) == sum);
    if is_whole { Ok(unpacked) } else { Err(damaged()) }
}

/// Looks at the lengths in a schema: behind its number its name, encoding and text.
fn schema(content: &[u8]) -> Option<()> {
    let mut rest = content.get(2..)?;
    for _ in 0..3 {
        (_, rest) = short(rest)?;
    }
    Some(())
}

/// Looks at the lengths in a channel: behind two numbers its topic, encoding, and names and values of its metadata.
fn channel(content: &[u8]) -> Option<()> {
    let (_, rest) = short(content.get(4..)?)?;
    let (_, rest) = short(rest)?;
    let (mut metadata, _) = short(rest)?;
    while !metadata.is_empty() {
        let (_, value) = short(metadata)?;
        (_, metadata) = short(value)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    const ENDS: &[u8] = b"\x89MCAP0\r\n";

    fn record(kind: u8, content: &[u8]) -> Vec<u8> {
        [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat()
    }

    fn bag(records: &[Vec<u8>]) -> Vec<u8> {
        [ENDS, &records.concat(), ENDS].concat()
    }

    fn text(text: &[u8]) -> Vec<u8> {
        [&u32::try_from(text.len()).unwrap().to_le_bytes()[..], text].concat()
    }

    fn chunk_of(compression: &[u8], records: &[u8]) -> Vec<u8> {
        let length = (records.len() as u64).to_le_bytes();
        record(CHUNK, &[&[0; CHUNK_HEAD][..], &text(compression), &length, records].concat())
    }

    fn channel_of(metadata: &[u8]) -> Vec<u8> {
        let parts = [&[0; 4][..], &text(b"/map"), &text(b"cdr"), &text(metadata)];
        record(CHANNEL, &parts.concat())
    }

    #[test]
    fn messages_are_kept_with_what_says_how_they_are_read() {
        let schema = record(SCHEMA, &[&[0; 2][..], &text(b"a"), &text(b"b"), &text(b"c")].concat());
        let channel = channel_of(&[text(b"k"), text(b"v")].concat());
        let message = record(MESSAGE, &[7; 30]);
        let header = record(1, &[text(b"ros2"), text(b"")].concat());
        // What nobody needs may say what it likes.
        let index = record(8, &[0xff; 90]);
        let end = [record(DATA_END, &[0; 4]), index, record(FOOTER, &[0; 20])].concat();
        let inner = [channel.clone(), message.clone()].concat();
        let whole = bag(&[header, schema.clone(), chunk_of(b"", &inner), end]);
        let kept = [schema, inner, record(DATA_END, &[0; 4]), record(FOOTER, &[0; 20])];
        assert_eq!(messages(&whole), Ok(bag(&kept)));
    }

    #[test]
    fn what_is_longer_than_it_is_or_packed_is_refused() {
        let why = |records: &[Vec<u8>]| messages(&bag(records)).unwrap_err();
        let longer = |kind: u8| [&[kind][..], &u64::MAX.to_le_bytes(), b"..."].concat();
        assert_eq!(why(&[longer(0xfe)]), LONGER);
        assert_eq!(why(&[chunk_of(b"", &longer(MESSAGE))]), LONGER);
        assert_eq!(why(&[record(CHANNEL, &[0xff; 40])]), LONGER);
        assert_eq!(why(&[record(SCHEMA, &[0; 13])]), LONGER);
        // A name without a value.
        assert_eq!(why(&[channel_of(&text(b"k"))]), LONGER);
        let nested = chunk_of(b"", &chunk_of(b"", b""));
        assert_eq!(why(&[nested]), "a chunk lies in a chunk");
        assert_eq!(why(&[chunk_of(b"lz4", b"...")]), "a chunk is compressed as `lz4`");
        let cut = [ENDS, &record(MESSAGE, &[0; 30])].concat();
        assert_eq!(messages(&cut).unwrap_err(), "it ends within a record");
        assert_eq!(messages(b"\x89MCAP").unwrap_err(), LONGER);
    }

    /// Returns a chunk that says that `records` have this `size` and checksum.
    fn packed_chunk(records: &[u8], size: u64, sum: u32) -> Vec<u8> {
        let packed = compress_to_vec(records, CompressionLevel::Fastest);
        let head = [&[0; SIZE][..], &size.to_le_bytes(), &sum.to_le_bytes()].concat();
        let length = (packed.len() as u64).to_le_bytes();
        record(CHUNK, &[&head[..], &text(b"zstd"), &length, &packed].concat())
    }

    #[test]
    fn chunks_of_zstd_are_unpacked_and_held_against_what_they_say() {
        let inner = [channel_of(b""), record(MESSAGE, &[7; 3000])].concat();
        let (size, sum) = (inner.len() as u64, crc32fast::hash(&inner));
        let ends = [record(DATA_END, &[0; 4]), record(FOOTER, &[0; 20])].concat();
        let read = |chunk: Vec<u8>| messages(&bag(&[chunk, ends.clone()]));
        let kept = bag(&[inner.clone(), ends.clone()]);
        assert_eq!(read(packed_chunk(&inner, size, sum)), Ok(kept.clone()));
        assert_eq!(read(packed_chunk(&inner, size, 0)), Ok(kept), "a checksum of 0 is none");
        let damaged = Err("a chunk is not what it says, once it is unpacked".to_owned());
        assert_eq!(read(packed_chunk(&inner, size, sum ^ 1)), damaged);
        assert_eq!(read(packed_chunk(&inner, size - 1, sum)), damaged, "it is longer");
        assert_eq!(read(packed_chunk(&inner, size + 1, sum)), damaged, "it is shorter");
        let mut broken = packed_chunk(&inner, size, sum);
        let last = broken.len() - 1;
        broken.truncate(last);
        broken[1..9].copy_from_slice(&(last as u64 - 9).to_le_bytes());
        assert_eq!(read(broken), Err(LONGER.to_owned()));
        let too_large = Err("its chunks are larger than 32 MiB when unpacked".to_owned());
        assert_eq!(read(packed_chunk(b"", MAX_UNPACKED + 1, 0)), too_large);
        // Chunks share what there is room for.
        let mut room = 2 * size - 1;
        let two = [packed_chunk(&inner, size, sum), packed_chunk(&inner, size, sum)].concat();
        let told = keep(&[&two[..], ENDS].concat(), &mut Vec::new(), Within::File, &mut room);
        assert_eq!(told, too_large.map(|_: Vec<u8>| ()));
    }
}
