//! Zips as no library writes them: every field of every header as the attacker likes it
//! (PKWARE APPNOTE.TXT 6.3, sections 4.3 and 4.4).

/// One entry, with what its two headers say.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// The name in the central directory.
    pub(crate) name: Vec<u8>,
    /// The name in the local header, where it is another one.
    pub(crate) local_name: Option<Vec<u8>>,
    /// The bytes in the archive, compressed or not.
    pub(crate) packed: Vec<u8>,
    /// 0 stored, 8 deflated.
    pub(crate) method: u16,
    /// Bit 0: encrypted.
    pub(crate) flags: u16,
    /// The checksum that is declared.
    pub(crate) crc: u32,
    /// The unpacked size that is declared.
    pub(crate) size: u32,
    /// Unix mode with its type bits; 0 for none.
    pub(crate) mode: u32,
    /// Extra fields of both headers.
    pub(crate) extra: Vec<u8>,
    /// Whether it has no bytes of its own but the local header of the entry before it.
    pub(crate) shared: bool,
}

impl Entry {
    /// An honest, uncompressed file.
    pub(crate) fn stored(name: impl Into<Vec<u8>>, content: impl Into<Vec<u8>>) -> Self {
        let packed = content.into();
        Self {
            name: name.into(),
            local_name: None,
            method: 0,
            flags: 0,
            crc: crc32(&packed),
            size: u32::try_from(packed.len()).unwrap(),
            packed,
            mode: 0o100_644,
            extra: Vec::new(),
            shared: false,
        }
    }

    /// A file of about `size` zeros, compressed by a factor of a hundred and fifty, that declares `declared` bytes.
    pub(crate) fn zeros(name: &str, size: u32, declared: u32) -> Self {
        Self { packed: deflated_zeros(size), method: 8, size: declared, ..Self::stored(name, "") }
    }
}

/// The archive of `entries`.
pub(crate) fn zip(entries: &[Entry]) -> Vec<u8> {
    let (mut bytes, mut central, mut offset) = (Vec::new(), Vec::new(), 0);
    for entry in entries {
        let shape =
            [(entry.crc, 4), (u32::try_from(entry.packed.len()).unwrap(), 4), (entry.size, 4)];
        let lengths = |name: &[u8]| [(length(name), 2), (length(&entry.extra), 2)];
        let begin =
            [(20, 2), (u32::from(entry.flags), 2), (u32::from(entry.method), 2), (0x21_0000, 4)];
        if !entry.shared {
            offset = u32::try_from(bytes.len()).unwrap();
            let name = entry.local_name.as_ref().unwrap_or(&entry.name);
            bytes.extend(b"PK\x03\x04");
            put(&mut bytes, &begin);
            put(&mut bytes, &shape);
            put(&mut bytes, &lengths(name));
            bytes.extend(name);
            bytes.extend(&entry.extra);
            bytes.extend(&entry.packed);
        }
        central.extend(b"PK\x01\x02");
        put(&mut central, &[(0x031e, 2)]);
        put(&mut central, &begin);
        put(&mut central, &shape);
        put(&mut central, &lengths(&entry.name));
        put(&mut central, &[(0, 2), (0, 2), (0, 2), (entry.mode << 16, 4), (offset, 4)]);
        central.extend(&entry.name);
        central.extend(&entry.extra);
    }
    let start = bytes.len();
    bytes.extend(&central);
    let end = end(entries.len(), start, central.len());
    bytes.extend(end);
    bytes
}

/// The end of central directory record.
pub(crate) fn end(entries: usize, start: usize, bytes: usize) -> Vec<u8> {
    // More than fit are declared as many as fit: the true number is for a zip64 record.
    let entries = u32::try_from(entries.min(0xffff)).unwrap();
    let mut end = b"PK\x05\x06".to_vec();
    let (start, bytes) = (u32::try_from(start).unwrap(), u32::try_from(bytes).unwrap());
    put(&mut end, &[(0, 2), (0, 2), (entries, 2), (entries, 2), (bytes, 4), (start, 4), (0, 2)]);
    end
}

fn length(bytes: &[u8]) -> u32 {
    u32::try_from(bytes.len()).unwrap()
}

/// Numbers in as many bytes as said, least first.
fn put(bytes: &mut Vec<u8>, numbers: &[(u32, usize)]) {
    for (number, width) in numbers {
        bytes.extend(&number.to_le_bytes()[..*width]);
    }
}

/// CRC-32 as zip has it.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    })
}

/// `size` zeros (a multiple of 258, and one) as one block of fixed Huffman codes (RFC 1951, section 3.2.6): a literal zero,
/// then "258 bytes, from one byte back" in 13 bits again and again.
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
    /// A number, least bit first.
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

    /// A Huffman code, greatest bit first.
    fn put_code(&mut self, code: u32, width: usize) {
        self.put(code.reverse_bits() >> (32 - width), width);
    }
}
