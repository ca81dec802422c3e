//! Zips as no library writes them: every field of every header as the attacker likes it
//! (PKWARE APPNOTE.TXT 6.3, sections 4.3 and 4.4).

use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::Write as _;

/// What a header says of an entry.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    /// The name.
    pub(crate) name: Vec<u8>,
    /// The version of the format that a reader needs, times ten.
    pub(crate) version: u16,
    /// Bit 0: encrypted; bit 3: checksum and sizes follow the data.
    pub(crate) flags: u16,
    /// 0 stored, 8 deflated.
    pub(crate) method: u16,
    /// The checksum that is declared.
    pub(crate) crc: u32,
    /// The size in the archive that is declared.
    pub(crate) packed: u32,
    /// The unpacked size that is declared.
    pub(crate) size: u32,
    /// Extra fields.
    pub(crate) extra: Vec<u8>,
}

/// One entry: its bytes, and what its two headers say of them.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// What the central directory says.
    pub(crate) central: Header,
    /// What the header in front of the data says, where it is something else.
    pub(crate) local: Option<Header>,
    /// Bytes in front of the local header that belong to nothing.
    pub(crate) before: Vec<u8>,
    /// The bytes in the archive, compressed or not.
    pub(crate) data: Vec<u8>,
    /// What stands behind them: a data descriptor, or none.
    pub(crate) descriptor: Vec<u8>,
    /// Unix mode with its type bits; 0 for none.
    pub(crate) mode: u32,
    /// Attributes of MS-DOS.
    pub(crate) attributes: u32,
    /// The system that its attributes are of: 3 is Unix.
    pub(crate) system: u16,
    /// The comment in the central directory.
    pub(crate) comment: Vec<u8>,
    /// Whether it has no bytes of its own but the local header of the entry before it.
    pub(crate) shared: bool,
    /// Bytes by which the directory misses its local header.
    pub(crate) shift: i32,
}

impl Entry {
    /// Creates an honest, uncompressed file.
    pub(crate) fn stored(name: impl Into<Vec<u8>>, content: impl Into<Vec<u8>>) -> Self {
        let data = content.into();
        let central = Header {
            name: name.into(),
            version: 20,
            flags: 0,
            method: 0,
            crc: crc32(&data),
            packed: length(&data),
            size: length(&data),
            extra: Vec::new(),
        };
        Self {
            central,
            local: None,
            before: Vec::new(),
            data,
            descriptor: Vec::new(),
            mode: 0o100_644,
            attributes: 0,
            system: 3,
            comment: Vec::new(),
            shared: false,
            shift: 0,
        }
    }

    /// Creates an honest, compressed file.
    pub(crate) fn deflated(name: impl Into<Vec<u8>>, content: impl AsRef<[u8]>) -> Self {
        let mut deflater = DeflateEncoder::new(Vec::new(), Compression::default());
        deflater.write_all(content.as_ref()).unwrap();
        let mut entry = Self::stored(name, content.as_ref());
        entry.central.method = 8;
        entry.replaced(deflater.finish().unwrap())
    }

    /// Creates a folder's own entry.
    pub(crate) fn folder(name: impl Into<Vec<u8>>) -> Self {
        Self { mode: 0o040_755, attributes: 0x10, ..Self::stored(name, "") }
    }

    /// Creates a file of about `size` zeros, compressed by a factor of a hundred and fifty, that declares `declared`
    /// bytes.
    pub(crate) fn zeros(name: &str, size: u32, declared: u32) -> Self {
        let mut entry = Self::stored(name, "").replaced(deflated_zeros(size));
        (entry.central.method, entry.central.size) = (8, declared);
        entry
    }

    /// Returns the same entry with other bytes in the archive.
    pub(crate) fn replaced(mut self, data: Vec<u8>) -> Self {
        self.central.packed = length(&data);
        self.data = data;
        self
    }

    /// Returns the same entry with something else in the central directory, and in front of the data where nothing else
    /// stands there.
    pub(crate) fn says(mut self, change: impl FnOnce(&mut Header)) -> Self {
        change(&mut self.central);
        self
    }

    /// Returns the same entry with something else in front of the data only.
    pub(crate) fn says_locally(mut self, change: impl FnOnce(&mut Header)) -> Self {
        let central = &self.central;
        change(self.local.get_or_insert_with(|| central.clone()));
        self
    }

    /// Returns the same entry as written by a program that could not go back: sizes and checksum stand behind the data.
    pub(crate) fn streamed(self) -> Self {
        let mut streamed = self
            .says(|header| header.flags |= 1 << 3)
            .says_locally(|header| (header.crc, header.packed, header.size) = (0, 0, 0));
        let Header { crc, packed, size, .. } = streamed.central;
        streamed.descriptor = descriptor(crc, packed, size);
        streamed
    }
}

/// Returns a data descriptor.
pub(crate) fn descriptor(crc: u32, packed: u32, size: u32) -> Vec<u8> {
    let mut bytes = b"PK\x07\x08".to_vec();
    put(&mut bytes, &[(crc, 4), (packed, 4), (size, 4)]);
    bytes
}

/// Returns an extra field.
pub(crate) fn extra(id: u16, field: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    put(&mut bytes, &[(u32::from(id), 2), (length(field), 2)]);
    bytes.extend(field);
    bytes
}

/// Returns Info-ZIP's field 0x7075 or 0x6375: for readers that know it, `text` stands for `original`.
pub(crate) fn unicode(id: u16, original: &[u8], text: &[u8]) -> Vec<u8> {
    let mut field = vec![1];
    put(&mut field, &[(crc32(original), 4)]);
    field.extend(text);
    extra(id, &field)
}

/// What follows the entries.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tail {
    /// Bytes between the last entry and the directory.
    pub(crate) gap: Vec<u8>,
    /// Bytes between the directory and the end record.
    pub(crate) behind: Vec<u8>,
    /// The archive's comment.
    pub(crate) comment: Vec<u8>,
    /// Entries that the end record counts too many.
    pub(crate) miscount: i32,
    /// Whether there is a zip64 end record, and entries that it counts too many.
    pub(crate) long: Option<i32>,
    /// Whether the directory lists the entries from the last to the first.
    pub(crate) reversed: bool,
}

/// Writes the archive of `entries`.
pub(crate) fn zip(entries: &[Entry]) -> Vec<u8> {
    zip_with(entries, &Tail::default())
}

/// Writes the archive of `entries`, and what follows them.
pub(crate) fn zip_with(entries: &[Entry], tail: &Tail) -> Vec<u8> {
    let (mut bytes, mut listed, mut offset) = (Vec::new(), Vec::new(), 0_u32);
    for entry in entries {
        if !entry.shared {
            bytes.extend(&entry.before);
            offset = length(&bytes);
            let local = entry.local.as_ref().unwrap_or(&entry.central);
            bytes.extend(b"PK\x03\x04");
            put_header(&mut bytes, local);
            bytes.extend(&local.name);
            bytes.extend(&local.extra);
            bytes.extend(&entry.data);
            bytes.extend(&entry.descriptor);
        }
        let header = &entry.central;
        let mut central = b"PK\x01\x02".to_vec();
        put(&mut central, &[(0x1e, 1), (u32::from(entry.system), 1)]);
        put_header(&mut central, header);
        let attributes = entry.mode << 16 | entry.attributes;
        let offset = offset.wrapping_add_signed(entry.shift);
        put(
            &mut central,
            &[(length(&entry.comment), 2), (0, 2), (0, 2), (attributes, 4), (offset, 4)],
        );
        central.extend(&header.name);
        central.extend(&header.extra);
        central.extend(&entry.comment);
        listed.push(central);
    }
    if tail.reversed {
        listed.reverse();
    }
    bytes.extend(&tail.gap);
    let (start, central) = (bytes.len(), listed.concat());
    bytes.extend(&central);
    bytes.extend(&tail.behind);
    if let Some(miscount) = tail.long {
        let (at, entries) = (length(&bytes), length(entries).wrapping_add_signed(miscount));
        bytes.extend(b"PK\x06\x06");
        put(&mut bytes, &[(44, 8), (45, 2), (45, 2), (0, 4), (0, 4), (entries, 8), (entries, 8)]);
        put(&mut bytes, &[(length(&central), 8), (u32::try_from(start).unwrap(), 8)]);
        bytes.extend(b"PK\x06\x07");
        put(&mut bytes, &[(0, 4), (at, 8), (1, 4)]);
    }
    let count = entries.len().saturating_add_signed(isize::try_from(tail.miscount).unwrap());
    bytes.extend(end(count, start, central.len()));
    let comment = bytes.len() - 2;
    bytes.truncate(comment);
    put(&mut bytes, &[(length(&tail.comment), 2)]);
    bytes.extend(&tail.comment);
    bytes
}

fn put_header(bytes: &mut Vec<u8>, header: &Header) {
    let [version, flags, method] = [header.version, header.flags, header.method].map(u32::from);
    put(bytes, &[(version, 2), (flags, 2), (method, 2), (0x21_0000, 4)]);
    put(bytes, &[(header.crc, 4), (header.packed, 4), (header.size, 4)]);
    put(bytes, &[(length(&header.name), 2), (length(&header.extra), 2)]);
}

/// Returns the end of central directory record.
pub(crate) fn end(entries: usize, start: usize, bytes: usize) -> Vec<u8> {
    // More than fit are declared as many as fit: the true number is for a zip64 record.
    let entries = u32::try_from(entries.min(0xffff)).unwrap();
    let mut end = b"PK\x05\x06".to_vec();
    let (start, bytes) = (u32::try_from(start).unwrap(), u32::try_from(bytes).unwrap());
    put(&mut end, &[(0, 2), (0, 2), (entries, 2), (entries, 2), (bytes, 4), (start, 4), (0, 2)]);
    end
}

fn length<T>(items: &[T]) -> u32 {
    u32::try_from(items.len()).unwrap()
}

/// Writes numbers in as many bytes as said, least first.
fn put(bytes: &mut Vec<u8>, numbers: &[(u32, usize)]) {
    for (number, width) in numbers {
        bytes.extend(&u64::from(*number).to_le_bytes()[..*width]);
    }
}

/// Computes the CRC-32 as zip has it.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    })
}

/// Returns `size` zeros (a multiple of 258, and one) as one block of fixed Huffman codes (RFC 1951, section 3.2.6): a
/// literal zero, then "258 bytes, from one byte back" in 13 bits again and again.
fn deflated_zeros(size: u32) -> Vec<u8> {
    let mut bits = Bits::default();
    bits.put(0b1, 1); // the last block
    bits.put(0b01, 2); // fixed codes
    bits.put_code(0b0011_0000, 8); // literal 0
    for _ in 0..size / 258 {
        bits.put_code(0b1100_0101, 8); // length 258
        bits.put_code(0, 5); // distance 1
    }
    bits.put_code(0, 7); // the end
    bits.bytes
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    filled: usize,
}

impl Bits {
    /// Appends a number, least bit first.
    fn put(&mut self, number: u32, width: usize) {
        for bit in 0..width {
            if self.filled.is_multiple_of(8) {
                self.bytes.push(0);
            }
            if number >> bit & 1 == 1 {
                *self.bytes.last_mut().unwrap() |= 1 << (self.filled % 8);
            }
            self.filled += 1;
        }
    }

    /// Appends a Huffman code, greatest bit first.
    fn put_code(&mut self, code: u32, width: usize) {
        self.put(code.reverse_bits() >> (32 - width), width);
    }
}
