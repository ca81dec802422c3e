//! Unpacking one entry: never more than it declares, and to the last byte of its stream.

use super::header::Central;
use flate2::{Crc, Decompress, FlushDecompress, Status};

/// The content of `entry`, whose bytes in the archive are `packed`.
///
/// # Errors
/// What was found where its declared size and checksum should be, and no byte behind its stream.
pub(super) fn unpack(entry: &Central<'_>, packed: &[u8]) -> Result<Vec<u8>, String> {
    let content = if entry.is_stored() { packed.to_vec() } else { inflate(packed, entry.size)? };
    if content.len() as u64 != entry.size {
        return Err(format!("{} bytes where {} are declared", content.len(), entry.size));
    }
    let mut crc = Crc::new();
    crc.update(&content);
    if crc.sum() != entry.crc {
        return Err(format!("CRC-32 {:08x} where {:08x} is declared", crc.sum(), entry.crc));
    }
    Ok(content)
}

/// Bytes that are asked for at least.
const STEP: u64 = 64 << 10;

fn inflate(packed: &[u8], declared: u64) -> Result<Vec<u8>, String> {
    let (mut stream, mut content, mut rest) = (Decompress::new(false), Vec::new(), packed);
    loop {
        let have = content.len() as u64;
        if have > declared {
            return Err(format!("more than the {declared} bytes declared"));
        }
        // Memory is taken as bytes come, not as the header asks; and one byte more than declared is enough to refuse.
        let room = have.max(STEP).min(declared + 1 - have);
        content.reserve_exact(usize::try_from(room).map_err(|e| e.to_string())?);
        let (read, written) = (stream.total_in(), stream.total_out());
        let status = stream
            .decompress_vec(rest, &mut content, FlushDecompress::None)
            .map_err(|_| "a damaged stream".to_owned())?;
        let read = stream.total_in() - read;
        rest = &rest[usize::try_from(read).map_err(|e| e.to_string())?..];
        match status {
            Status::StreamEnd if rest.is_empty() => return Ok(content),
            Status::StreamEnd => {
                return Err(format!("{} bytes behind the end of its stream", rest.len()));
            }
            Status::Ok | Status::BufError if read == 0 && stream.total_out() == written => {
                return Err("a stream without an end".to_owned());
            }
            Status::Ok | Status::BufError => {}
        }
    }
}
