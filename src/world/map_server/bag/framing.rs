//! Whether the lengths in an MCAP file are true, looked at before anybody asks for so much memory or adds them up: records, and the
//! texts and lists in them (MCAP specification, "Records"). What the records mean is for others to say.

use super::MAGIC;

/// Length of the magic bytes, and of a record's head: its kind and its length.
const MAGIC_LENGTH: usize = 8;
const HEAD: usize = 9;
/// The kind of a chunk, which holds records itself.
const CHUNK: u8 = 6;

/// Part of a record.
#[derive(Clone, Copy)]
enum Part {
    /// So many bytes.
    Bytes(usize),
    /// Bytes behind their number, of 32 bits.
    Short,
    /// Pairs of texts behind the number of all their bytes, of 32 bits.
    Pairs,
    /// Bytes behind their number, of 64 bits.
    Long,
}

/// Returns the parts of a record of this kind as far as lengths are in them.
fn parts(kind: u8) -> &'static [Part] {
    use Part::{Bytes, Long, Pairs, Short};
    match kind {
        // Header: profile, library.
        1 => &[Short, Short],
        // Schema: id, name, encoding, data.
        3 => &[Bytes(2), Short, Short, Short],
        // Channel: id, schema's id, topic, encoding, metadata.
        4 => &[Bytes(4), Short, Short, Pairs],
        // Chunk: times, size, checksum, compression, records.
        CHUNK => &[Bytes(28), Short, Long],
        // Message index: channel, places.
        7 => &[Bytes(2), Short],
        // Chunk index: times and place, places of message indices, their length, compression.
        8 => &[Bytes(32), Short, Bytes(8), Short],
        // Attachment: times, name, type, data, checksum.
        9 => &[Bytes(16), Short, Short, Long, Bytes(4)],
        // Attachment index: place, times, size, name, type.
        10 => &[Bytes(40), Short, Short],
        // Statistics: counts, times, messages of each channel.
        11 => &[Bytes(42), Short],
        // Metadata: name, metadata.
        12 => &[Short, Pairs],
        // Metadata index: place, name.
        13 => &[Bytes(16), Short],
        // Footer, message, summary offset, end of data, and what comes after this version.
        _ => &[],
    }
}

/// Returns whether every length in the MCAP file `bytes` is one of bytes that are there.
pub(super) fn is_sound(bytes: &[u8]) -> bool {
    bytes.get(MAGIC_LENGTH..).is_some_and(are_sound)
}

fn are_sound(mut records: &[u8]) -> bool {
    while let Some((head, rest)) = records.split_first_chunk::<HEAD>() {
        if records.starts_with(MAGIC) {
            return true;
        }
        let [kind, length @ ..] = *head;
        let length = usize::try_from(u64::from_le_bytes(length));
        let Some((content, rest)) = length.ok().and_then(|n| rest.split_at_checked(n)) else {
            return false;
        };
        if !is_record(kind, content) {
            return false;
        }
        records = rest;
    }
    true
}

fn is_record(kind: u8, mut content: &[u8]) -> bool {
    let mut is_compressed = false;
    for part in parts(kind) {
        let (taken, rest) = match part {
            Part::Bytes(count) => {
                let Some(split) = content.split_at_checked(*count) else { return false };
                split
            }
            Part::Short | Part::Pairs => {
                let Some(split) = short(content) else { return false };
                split
            }
            Part::Long => {
                let Some(split) = long(content) else { return false };
                split
            }
        };
        let is_sound = match part {
            Part::Pairs => are_pairs(taken),
            Part::Long if kind == CHUNK && !is_compressed => are_sound(taken),
            _ => true,
        };
        if !is_sound {
            return false;
        }
        is_compressed = matches!(part, Part::Short) && !taken.is_empty();
        content = rest;
    }
    true
}

/// Returns bytes whose number stands before them, and what comes behind.
fn short(content: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = content.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

fn long(content: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = content.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)
}

fn are_pairs(mut content: &[u8]) -> bool {
    while !content.is_empty() {
        let Some((_, rest)) = short(content) else { return false };
        content = rest;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(kind: u8, content: &[u8]) -> Vec<u8> {
        let mut record = vec![kind];
        record.extend((content.len() as u64).to_le_bytes());
        record.extend(content);
        record
    }

    fn bag(records: &[Vec<u8>]) -> Vec<u8> {
        [b"\x89MCAP0\r\n".to_vec(), records.concat(), b"\x89MCAP0\r\n".to_vec()].concat()
    }

    fn text(length: u32, text: &str) -> Vec<u8> {
        [&length.to_le_bytes()[..], text.as_bytes()].concat()
    }

    fn chunk(compression: &str, records: &[u8]) -> Vec<u8> {
        let compression = text(u32::try_from(compression.len()).unwrap(), compression);
        let length = (records.len() as u64).to_le_bytes();
        record(CHUNK, &[&[0; 28][..], &compression, &length, records].concat())
    }

    #[test]
    fn lengths_of_bytes_that_are_there_are_sound() {
        let header = record(1, &[text(4, "ros2"), text(0, "")].concat());
        let metadata = [text(1, "k"), text(1, "v")].concat();
        let pairs = text(u32::try_from(metadata.len()).unwrap(), "");
        let channel = [&[0; 4][..], &text(4, "/map"), &text(3, "cdr"), &pairs, &metadata].concat();
        let channel = record(4, &channel);
        let whole = bag(&[header, channel.clone(), chunk("", &channel), record(0xfe, b"new")]);
        assert!(is_sound(&whole));
        // What is compressed says nothing before it is unpacked.
        assert!(is_sound(&bag(&[chunk("zstd", b"\x04\xff\xff\xff\xff\xff\xff\xff\xff")])));
        assert!(!is_sound(b"\x89MCAP0"));
    }

    #[test]
    fn lengths_beyond_their_record_are_not() {
        let longer = |kind: u8| [&[kind][..], &u64::MAX.to_le_bytes(), b"..."].concat();
        assert!(!is_sound(&bag(&[longer(0xfe)])));
        assert!(!is_sound(&bag(&[chunk("", &longer(5))])));
        assert!(!is_sound(&bag(&[record(1, &text(0xfc00_0700, ""))])));
        let nested = [&[0; 4][..], &text(0, ""), &text(0, ""), &text(4, ""), &text(9, "")].concat();
        assert!(!is_sound(&bag(&[record(4, &nested)])));
        let attached = [&[0; 16][..], &text(0, ""), &text(0, ""), &u64::MAX.to_le_bytes()].concat();
        assert!(!is_sound(&bag(&[record(9, &attached)])));
        // Nor is one whose checksum is not there.
        let attached = [&[0; 16][..], &text(0, ""), &text(0, ""), &[0; 8]].concat();
        assert!(!is_sound(&bag(&[record(9, &attached)])));
        assert!(is_sound(&bag(&[record(9, &[attached, vec![0; 4]].concat())])));
    }
}
