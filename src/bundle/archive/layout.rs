//! The account of an archive's bytes: each belongs to one entry, to the directory or to the end record, and to nothing
//! else. Libraries forgive whatever stands between; what they skip is where a second truth can hide.
//!
//! ```text
//! (local header, data, data descriptor of streams)*  central header*  (zip64 end record and locator)?  end record
//! ```

use super::Limits;
use super::extra;
use super::header::{Central, Local, NEWEST, Record, STREAMED};
use super::raw::Raw;
use super::told::Faults;
use crate::bundle::Fault;
use std::ops::Range;

/// Bytes of the end record without a comment.
const END: u64 = 22;
/// Bytes of the zip64 end record without an extension, and of the locator behind it.
const LONG_END: u64 = 56;
const LOCATOR: u64 = 20;

/// Most bytes of a directory that is read: twenty thousand entries with names of a thousand bytes have half of it.
const MOST_DIRECTORY: u64 = 48 << 20;

fn archive(expected: impl Into<String>, found: impl Into<String>) -> Fault {
    Fault::new("(archive)", expected, found)
}

fn too_many(limits: &Limits, found: u64) -> Fault {
    archive(format!("at most {} entries", limits.entries), format!("{found} entries"))
}

/// Where the central directory stands, and how many entries it is said to have.
#[derive(Debug)]
pub(super) struct Directory {
    range: Range<u64>,
    entries: u64,
}

/// What an end record states.
#[derive(Debug, PartialEq, Eq)]
struct Stated {
    entries: u64,
    bytes: u64,
    start: u64,
}

impl Directory {
    /// Finds it by the end record, which must be the last bytes.
    pub(super) fn find(raw: &Raw<'_>) -> Result<Self, Fault> {
        let at = end_record(raw)?;
        let record = raw.get(at, END).unwrap_or_default();
        if record.len() as u64 != END {
            return Err(archive("a whole zip archive", "an end record that is cut"));
        }
        let field = Record(&record);
        if (field.u16(4), field.u16(6), field.u16(8)) != (0, 0, field.u16(10)) {
            return Err(archive("an archive in one piece", "an end record of several"));
        }
        let short = Stated {
            entries: field.u16(10).into(),
            bytes: field.u32(12).into(),
            start: field.u32(16).into(),
        };
        let (end, stated) = match long_end(raw, at)? {
            Some((end, long)) => {
                // Numbers that do not fit stand as the greatest that does.
                let fits = |short, long, most| short == long || short == u64::from(most);
                if !fits(short.entries, long.entries, u32::from(u16::MAX))
                    || !fits(short.bytes, long.bytes, u32::MAX)
                    || !fits(short.start, long.start, u32::MAX)
                {
                    return Err(archive("two end records that agree", "others"));
                }
                (end, long)
            }
            None => (at, short),
        };
        let Some(start) = end.checked_sub(stated.bytes) else {
            return Err(archive(
                "a whole zip archive",
                format!("a directory of {} bytes in {end}", stated.bytes),
            ));
        };
        let shift = start - stated.start.min(start);
        if shift > 0 {
            // Either the whole archive was moved, or something was put behind the directory.
            let stays = raw.up_to(stated.start, MOST_HEADER);
            return Err(if Central::length(&stays).is_some() {
                archive(
                    "a directory that ends where the end record begins",
                    format!("{shift} bytes between them"),
                )
                .hint(UNLISTED)
            } else {
                bytes_before(shift)
            });
        }
        if stated.start > start {
            return Err(archive(
                format!("a directory at byte {start}, where its size puts it"),
                format!("byte {} stated", stated.start),
            ));
        }
        if stated.bytes > MOST_DIRECTORY {
            return Err(archive(
                format!("a directory of at most {MOST_DIRECTORY} bytes"),
                format!("one of {}", stated.bytes),
            ));
        }
        Ok(Self { range: start..end, entries: stated.entries })
    }

    /// Reads the bytes of the directory.
    pub(super) fn bytes(&self, raw: &Raw<'_>) -> Vec<u8> {
        raw.up_to(self.range.start, self.range.end - self.range.start)
    }

    /// Reads the headers in the `directory`, whose bytes these are, in the order in which they stand there.
    pub(super) fn headers<'a>(
        &self,
        directory: &'a [u8],
        limits: &Limits,
    ) -> Result<Vec<Central<'a>>, Fault> {
        let lengths = |mut rest: &'a [u8]| {
            std::iter::from_fn(move || {
                let length = Central::length(rest)?;
                let (header, behind) = rest.split_at(length);
                rest = behind;
                Some(header)
            })
        };
        // Counted before they are kept: a header that is read takes three times its bytes.
        let (count, read) = lengths(directory)
            .fold((0_u64, 0), |(count, read), header| (count + 1, read + header.len()));
        if count.max(self.entries) > limits.entries as u64 {
            return Err(too_many(limits, count.max(self.entries)));
        }
        if (count, read) != (self.entries, directory.len()) {
            let left = directory.len() - read;
            return Err(archive(
                format!("a directory of {} entries and no more", self.entries),
                format!("{count} entries and {left} other bytes"),
            ));
        }
        Ok(lengths(directory).map(Central::read).collect())
    }

    /// Returns where the packed bytes of every entry begin, in the directory's order; each fault where a byte belongs to none of
    /// them, to two, or where an entry's headers disagree.
    pub(super) fn account(
        &self,
        raw: &Raw<'_>,
        entries: &[Central<'_>],
    ) -> Result<Vec<u64>, Faults> {
        let mut order: Vec<usize> = (0..entries.len()).collect();
        order.sort_by_key(|i| entries[*i].offset);
        let (mut data, mut faults) = (vec![0; entries.len()], Faults::default());
        let (mut next, mut before) = (0_u64, None::<&Central<'_>>);
        for i in order {
            let entry = &entries[i];
            let start = entry.offset;
            match (start.checked_sub(next), before) {
                (Some(0), _) => {}
                (Some(gap), None) => faults.push(bytes_before(gap)),
                (Some(gap), Some(_)) => faults.push(gap_before(entry.shown(), "an entry", gap)),
                (None, _) => {
                    let other = before.map(Central::shown).unwrap_or_default();
                    faults.push(Fault::new(
                        entry.shown(),
                        "bytes of its own",
                        format!("those of `{other}`"),
                    ));
                    continue;
                }
            }
            match Place::read(entry, &raw.part(start, self.range.start)) {
                Ok(place) => {
                    faults.extend(place.faults);
                    data[i] = start + place.data;
                    next = start + place.length;
                    before = Some(entry);
                }
                Err(fault) => {
                    // Where it ends is unknown, so what comes after cannot be judged.
                    faults.push(fault);
                    return Err(faults);
                }
            }
        }
        let gap = self.range.start - next;
        if gap > 0 {
            faults.push(gap_before("(archive)".to_owned(), "a directory", gap));
        }
        faults.or(data)
    }
}

/// Most bytes of a header: what is fixed, and three parts of two bytes' length each.
const MOST_HEADER: u64 = 46 + 3 * u16::MAX as u64;

/// Bytes of a data descriptor whose sizes have eight bytes.
const LONGEST_DESCRIPTOR: u64 = 24;

const UNLISTED: &str = "no entry lists them, so no checksum covers them";

fn bytes_before(count: u64) -> Fault {
    archive("a zip that begins at the first byte", format!("{count} bytes before it"))
}

fn gap_before(path: String, what: &str, gap: u64) -> Fault {
    let expected = format!("{what} that begins where the entry before it ends");
    Fault::new(path, expected, format!("{gap} bytes between them")).hint(UNLISTED)
}

/// Returns where the end record begins: the last one, without comment, and nothing behind it.
fn end_record(raw: &Raw<'_>) -> Result<u64, Fault> {
    let whole = |found: &str| archive("a whole zip archive", found);
    let is_end = |at: &u64| {
        raw.get(*at, END).is_some_and(|r| r.starts_with(b"PK\x05\x06") && r.ends_with(&[0, 0]))
    };
    if let Some(at) = raw.len().checked_sub(END).filter(is_end) {
        return Ok(at);
    }
    let Some(at) = raw.last(*b"PK\x05\x06") else {
        return Err(whole("no end record").hint("is it a zip, and did all of it arrive?"));
    };
    let Some(record) = raw.get(at, END) else {
        return Err(whole("an end record that is cut"));
    };
    let comment = u64::from(Record(&record).u16(20));
    match raw.len().checked_sub(at + END + comment) {
        None => Err(whole("a comment that is cut")),
        Some(0) => Err(archive("no comment", format!("one of {comment} bytes"))),
        Some(behind) => {
            Err(archive("a zip that ends at the last byte", format!("{behind} bytes behind it")))
        }
    }
}

/// Finds the zip64 end record before the end record at `at`, and reads what it states; `None` where there is none.
fn long_end(raw: &Raw<'_>, at: u64) -> Result<Option<(u64, Stated)>, Fault> {
    let locator = at.checked_sub(LOCATOR).and_then(|from| Some((from, raw.get(from, LOCATOR)?)));
    let Some((from, locator)) = locator.filter(|(_, l)| l.starts_with(b"PK\x06\x07")) else {
        return Ok(None);
    };
    let other = |found: &str| archive("a zip64 end record right before its locator", found);
    let start = from.checked_sub(LONG_END).ok_or_else(|| other("none"))?;
    let record = raw.get(start, LONG_END).ok_or_else(|| other("none"))?;
    let (record, pointer) = (Record(&record), Record(&locator));
    if !record.0.starts_with(b"PK\x06\x06") || pointer.u64(8) != start {
        return Err(other("none"));
    }
    let extension = record.u64(4) != LONG_END - 12;
    let pieces = (pointer.u32(4), pointer.u32(16), record.u32(16), record.u32(20)) != (0, 1, 0, 0);
    if extension || pieces || record.u16(14) > NEWEST || record.u64(24) != record.u64(32) {
        return Err(other("one with an extension, of a later version or of several pieces"));
    }
    let stated = Stated { entries: record.u64(32), bytes: record.u64(40), start: record.u64(48) };
    Ok(Some((start, stated)))
}

/// What stands where an entry begins.
struct Place {
    /// Bytes from its local header to its data.
    data: u64,
    /// Bytes from its local header to the end of its descriptor.
    length: u64,
    faults: Vec<Fault>,
}

impl Place {
    /// Reads the entry at the beginning of `raw`, which ends where the directory begins.
    fn read(entry: &Central<'_>, raw: &Raw<'_>) -> Result<Self, Fault> {
        let fault = |expected: &str, found: &str| Fault::new(entry.shown(), expected, found);
        let header = raw.up_to(0, Local::length(&raw.up_to(0, 30)));
        let local = Local::read(&header)
            .ok_or_else(|| fault("a local header where the directory says", "none"))?;
        let is_streamed = entry.flags & STREAMED != 0;
        let mut faults = disagreements(entry, &local, is_streamed);
        let data = local.length as u64;
        let end = data.checked_add(entry.packed).filter(|end| *end <= raw.len());
        let mut length = end.ok_or_else(|| {
            Fault::new(
                entry.shown(),
                format!("{} bytes of data before the directory", entry.packed),
                format!("{}", raw.len() - data),
            )
        })?;
        if is_streamed {
            let behind = raw.up_to(length, LONGEST_DESCRIPTOR);
            let (more, found) = descriptor(entry, &behind, local.is_long);
            length += more as u64;
            if let Some(found) = found {
                faults.push(fault("a data descriptor that agrees with the directory", &found));
            }
            if entry.is_stored()
                && local.packed == 0
                && ends_within(&raw.part(data, data + entry.packed))
            {
                faults.push(fault(
                    "data without a mark of its own end",
                    "one that readers of streams stop at",
                ));
            }
        }
        Ok(Self { data, length, faults })
    }
}

/// Returns what the local header says otherwise than the directory. A streaming writer leaves checksum and sizes zero
/// there.
fn disagreements(entry: &Central<'_>, local: &Local<'_>, is_streamed: bool) -> Vec<Fault> {
    let mut faults = Vec::new();
    if local.name != entry.name {
        let other = String::from_utf8_lossy(local.name).escape_debug().to_string();
        faults.push(Fault::new(
            entry.shown(),
            "the same name in its local header",
            format!("`{other}`"),
        ));
    }
    let unknown = |number: u64| is_streamed && number == 0;
    let crc = u64::from(local.crc);
    for (what, central, local, differs) in [
        ("flags", entry.flags.into(), local.flags.into(), local.flags != entry.flags),
        ("method", entry.method.into(), local.method.into(), local.method != entry.method),
        ("CRC-32", entry.crc.into(), crc, local.crc != entry.crc && !unknown(crc)),
        (
            "packed size",
            entry.packed,
            local.packed,
            local.packed != entry.packed && !unknown(local.packed),
        ),
        ("size", entry.size, local.size, local.size != entry.size && !unknown(local.size)),
    ] {
        if differs {
            let shown = |n: u64| if what == "CRC-32" { format!("{n:08x}") } else { n.to_string() };
            faults.push(Fault::new(
                entry.shown(),
                format!("{what} {} in both of its headers", shown(central)),
                format!("{} in the local one", shown(local)),
            ));
        }
    }
    if local.version > NEWEST {
        let found =
            format!("one of {}.{} in its local header", local.version / 10, local.version % 10);
        faults.push(Fault::new(entry.shown(), "an entry that needs zip 4.5 or less", found));
    }
    if let Some(found) = &local.extra {
        faults.push(Fault::new(
            entry.shown(),
            extra::EXPECTED,
            format!("{found} in its local header"),
        ));
    }
    faults
}

/// Returns the length of the data descriptor at the beginning of `bytes`, and what is wrong with it.
fn descriptor(entry: &Central<'_>, bytes: &[u8], is_long: bool) -> (usize, Option<String>) {
    let length = if is_long { 24 } else { 16 };
    let Some(record) = bytes.get(..length).filter(|record| record.starts_with(b"PK\x07\x08"))
    else {
        return (0, Some("none".to_owned()));
    };
    let record = Record(record);
    let (packed, size) = if is_long {
        (record.u64(8), record.u64(16))
    } else {
        (record.u32(8).into(), record.u32(12).into())
    };
    let found = if record.u32(4) != entry.crc {
        Some(format!("CRC-32 {:08x} where it has {:08x}", record.u32(4), entry.crc))
    } else if packed != entry.packed {
        Some(format!("packed size {packed} where it has {}", entry.packed))
    } else if size != entry.size {
        Some(format!("size {size} where it has {}", entry.size))
    } else {
        None
    };
    (length, found)
}

/// Returns whether `data`, whose length a reader of a stream does not know yet, holds a descriptor of what stands
/// before it.
fn ends_within(data: &Raw<'_>) -> bool {
    data.any_window(16, |at, w| w.starts_with(b"PK\x07\x08") && u64::from(Record(w).u32(8)) == at)
}
