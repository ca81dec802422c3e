//! The two headers of an entry (PKWARE APPNOTE 6.3, sections 4.3.7 and 4.3.12), and what of them is refused.

use super::extra;
use crate::bundle::Fault;

/// Numbers in a record of known length, least byte first.
pub(super) struct Record<'a>(pub(super) &'a [u8]);

impl Record<'_> {
    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.array(at))
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.array(at))
    }

    pub(super) fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.array(at))
    }

    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        self.0[at..at + N].try_into().expect("the slice is as long as the array")
    }
}

/// A size or an offset that does not stand in its field of four bytes but in the zip64 field.
pub(super) const ELSEWHERE: u32 = u32::MAX;

/// The newest version of the format that all readers know: 4.5, with zip64.
pub(super) const NEWEST: u16 = 45;

const ENCRYPTED: u16 = 1;
/// Sizes and checksum follow the data, because the writer could not go back.
pub(super) const STREAMED: u16 = 1 << 3;
/// Also how hard the compressor tried (two bits), and that the name is in UTF-8.
const KNOWN_FLAGS: u16 = ENCRYPTED | 0b110 | STREAMED | 1 << 11;

const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// Systems whose names and attributes every reader takes alike: FAT, Unix, NTFS (two numbers), VFAT, macOS.
const SYSTEMS: [u8; 6] = [0, 3, 10, 11, 14, 19];

/// An entry as the central directory has it.
#[derive(Debug)]
pub(super) struct Central<'a> {
    pub(super) name: &'a [u8],
    pub(super) flags: u16,
    pub(super) method: u16,
    pub(super) crc: u32,
    /// Size in the archive.
    pub(super) packed: u64,
    /// Size unpacked.
    pub(super) size: u64,
    /// Where its local header begins.
    pub(super) offset: u64,
    made_by: u8,
    version: u16,
    attributes: u32,
    comment: usize,
    disk: u16,
    /// What is wrong with its extra fields.
    extra: Option<extra::ExtraError>,
}

/// Bytes of a central header without name, extra fields and comment.
const CENTRAL: usize = 46;

impl<'a> Central<'a> {
    /// Returns how many bytes the header at the beginning of `directory` takes; `None` where none stands there whole.
    pub(super) fn length(directory: &[u8]) -> Option<usize> {
        let fixed = directory.get(..CENTRAL).filter(|fixed| fixed.starts_with(b"PK\x01\x02"))?;
        let lengths = [28, 30, 32].map(|at| usize::from(Record(fixed).u16(at)));
        let length = CENTRAL + lengths.iter().sum::<usize>();
        (length <= directory.len()).then_some(length)
    }

    /// Reads a header of the length that [`Central::length`] found.
    pub(super) fn read(header: &'a [u8]) -> Self {
        let field = Record(header);
        let [name, extra, comment] = [28, 30, 32].map(|at| usize::from(field.u16(at)));
        let sizes = [field.u32(24), field.u32(20), field.u32(42)];
        let (fields, mut fault) = match extra::read(&header[CENTRAL + name..][..extra]) {
            Ok(fields) => (fields, None),
            Err(found) => (extra::Fields::default(), Some(found)),
        };
        let mut long = fields.zip64.unwrap_or_default();
        let [size, packed, offset] = sizes.map(|size| match long.split_at_checked(8) {
            Some((own, rest)) if size == ELSEWHERE => {
                long = rest;
                Record(own).u64(0)
            }
            _ => u64::from(size),
        });
        if !long.is_empty() || fields.zip64.is_some_and(<[u8]>::is_empty) {
            fault.get_or_insert(extra::ExtraError::Zip64);
        }
        Self {
            name: &header[CENTRAL..][..name],
            flags: field.u16(8),
            method: field.u16(10),
            crc: field.u32(16),
            packed,
            size,
            offset,
            made_by: header[5],
            version: field.u16(6),
            attributes: field.u32(38),
            comment,
            disk: field.u16(34),
            extra: fault,
        }
    }

    /// Returns whether the entry is a folder, by its name.
    pub(super) fn is_folder(&self) -> bool {
        self.name.ends_with(b"/")
    }

    /// Returns whether the entry's bytes stand in the archive as they are.
    pub(super) fn is_stored(&self) -> bool {
        self.method == STORED
    }

    /// Returns the name as it may be shown, whatever its bytes.
    pub(super) fn shown(&self) -> String {
        String::from_utf8_lossy(self.name).escape_debug().to_string()
    }

    /// Returns everything about the entry that makes it another thing for some reader, or no file at all.
    pub(super) fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut fault = |expected: &str, found: String| {
            faults.push(Fault::new(self.shown(), expected, found));
        };
        for found in self.no_plain_file() {
            fault("a plain file", found.to_owned());
        }
        if let Some(bit) = (0..16).find(|bit| self.flags & !KNOWN_FLAGS & 1 << bit != 0) {
            fault("no flags but for streaming, UTF-8 and effort", format!("bit {bit}"));
        }
        if self.version > NEWEST {
            let (major, minor) = (self.version / 10, self.version % 10);
            fault("an entry that needs zip 4.5 or less", format!("one of {major}.{minor}"));
        }
        if !SYSTEMS.contains(&self.made_by) {
            fault("an entry made on Unix, Windows or macOS", format!("system {}", self.made_by));
        }
        if self.disk != 0 {
            fault("an archive in one piece", format!("piece {}", self.disk));
        }
        if self.comment > 0 {
            fault("no comment", format!("one of {} bytes", self.comment));
        }
        if self.is_stored() && self.packed != self.size {
            fault(
                "equal sizes packed and unpacked, as it is not compressed",
                format!("{} and {}", self.packed, self.size),
            );
        }
        if let Some(found) = &self.extra {
            fault(extra::EXPECTED, found.to_string());
        }
        faults
    }

    fn no_plain_file(&self) -> Vec<&'static str> {
        let mut found = Vec::new();
        if self.flags & ENCRYPTED != 0 {
            found.push("encryption");
        }
        if !matches!(self.method, STORED | DEFLATED) {
            found.push("another compression");
        }
        // Python's `writestr` leaves the type bits empty. The low byte is MS-DOS's.
        let (mode, dos) = (self.attributes >> 16 & 0o170_000, self.attributes & 0xff);
        match mode {
            0o120_000 => found.push("a symbolic link"),
            0o040_000 if !self.is_folder() => {
                found.push("a folder by its mode and a file by its name");
            }
            0o100_000 if self.is_folder() => {
                found.push("a file by its mode and a folder by its name");
            }
            0 | 0o100_000 | 0o040_000 => {}
            _ => found.push("a special file"),
        }
        if dos & 0x08 != 0 {
            found.push("the name of a disk");
        }
        if dos & 0x10 != 0 && !self.is_folder() && mode != 0o040_000 {
            found.push("a folder by its attributes and a file by its name");
        }
        if self.is_folder() && self.size > 0 {
            found.push("a folder with content");
        }
        found
    }
}

/// An entry as the header in front of its data has it.
pub(super) struct Local<'a> {
    pub(super) name: &'a [u8],
    pub(super) flags: u16,
    pub(super) method: u16,
    pub(super) crc: u32,
    pub(super) packed: u64,
    pub(super) size: u64,
    pub(super) version: u16,
    /// Whether sizes are written in eight bytes, also in the descriptor behind the data.
    pub(super) is_long: bool,
    /// What is wrong with its extra fields.
    pub(super) extra: Option<extra::ExtraError>,
    /// Bytes that the header takes.
    pub(super) length: usize,
}

/// Bytes of a local header without name and extra fields.
const LOCAL: usize = 30;

impl<'a> Local<'a> {
    /// Returns how many bytes the header at the beginning of `bytes` takes, as far as they tell.
    pub(super) fn length(bytes: &[u8]) -> u64 {
        let told = bytes.get(..LOCAL).map_or(0, |fixed| {
            let field = Record(fixed);
            u64::from(field.u16(26)) + u64::from(field.u16(28))
        });
        LOCAL as u64 + told
    }

    /// Reads the header at the beginning of `bytes`; `None` where none stands there whole.
    pub(super) fn read(bytes: &'a [u8]) -> Option<Self> {
        let field = Record(bytes.get(..LOCAL).filter(|fixed| fixed.starts_with(b"PK\x03\x04"))?);
        let [name, extra] = [26, 28].map(|at| usize::from(field.u16(at)));
        let length = LOCAL + name + extra;
        let header = bytes.get(..length)?;
        let (fields, mut fault) = match extra::read(&header[LOCAL + name..]) {
            Ok(fields) => (fields, None),
            Err(found) => (extra::Fields::default(), Some(found)),
        };
        let short = [field.u32(22), field.u32(18)];
        let is_long = short == [ELSEWHERE; 2];
        let [size, packed] = match fields.zip64 {
            Some(long) if is_long && long.len() == 16 => [0, 8].map(|at| Record(long).u64(at)),
            None if !is_long => short.map(u64::from),
            _ => {
                fault.get_or_insert(extra::ExtraError::Zip64);
                short.map(u64::from)
            }
        };
        Some(Self {
            name: &header[LOCAL..][..name],
            flags: field.u16(6),
            method: field.u16(8),
            crc: field.u32(14),
            packed,
            size,
            version: field.u16(4),
            is_long,
            extra: fault,
            length,
        })
    }
}
