//! Unpacking one entry: never more than it declares, and to the last byte of its stream.

use super::header::Central;
use flate2::{Crc, Decompress, FlushDecompress, Status};
use std::num::TryFromIntError;

/// What was found where an entry's declared size and checksum should be, and no byte behind its stream.
#[derive(Debug, thiserror::Error)]
pub(in crate::bundle) enum UnpackError {
    #[error("{found} bytes where {declared} are declared")]
    Length { found: usize, declared: u64 },
    #[error("CRC-32 {found:08x} where {declared:08x} is declared")]
    Checksum { found: u32, declared: u32 },
    #[error("more than the {0} bytes declared")]
    TooLong(u64),
    #[error(transparent)]
    TooLarge(#[from] TryFromIntError),
    #[error("a damaged stream")]
    Damaged,
    #[error("{0} bytes behind the end of its stream")]
    Behind(usize),
    #[error("a stream without an end")]
    Endless,
}

/// Returns the content of `entry`, whose bytes in the archive are `packed`.
///
/// # Errors
/// As [`UnpackError`] says.
pub(super) fn unpack(entry: &Central<'_>, packed: &[u8]) -> Result<Vec<u8>, UnpackError> {
    let content = if entry.is_stored() { packed.to_vec() } else { inflate(packed, entry.size)? };
    if content.len() as u64 != entry.size {
        return Err(UnpackError::Length { found: content.len(), declared: entry.size });
    }
    let mut crc = Crc::new();
    crc.update(&content);
    if crc.sum() != entry.crc {
        return Err(UnpackError::Checksum { found: crc.sum(), declared: entry.crc });
    }
    Ok(content)
}

/// Bytes that are asked for at least.
const STEP: u64 = 64 << 10;

/// Returns what the deflate stream `packed` holds, which is `declared` bytes at most.
///
/// # Errors
/// Where it holds more, or is damaged, without an end or not the end.
pub(in crate::bundle) fn inflate(packed: &[u8], declared: u64) -> Result<Vec<u8>, UnpackError> {
    let (mut stream, mut content, mut rest) = (Decompress::new(false), Vec::new(), packed);
    loop {
        let have = content.len() as u64;
        if have > declared {
            return Err(UnpackError::TooLong(declared));
        }
        // Memory is taken as bytes come, not as the header asks; and one byte more than declared is enough to refuse.
        let room = have.max(STEP).min(declared + 1 - have);
        content.reserve_exact(usize::try_from(room)?);
        let (read, written) = (stream.total_in(), stream.total_out());
        let status = stream
            .decompress_vec(rest, &mut content, FlushDecompress::None)
            .map_err(|_| UnpackError::Damaged)?;
        let read = stream.total_in() - read;
        rest = &rest[usize::try_from(read)?..];
        match status {
            Status::StreamEnd if rest.is_empty() => return Ok(content),
            Status::StreamEnd => return Err(UnpackError::Behind(rest.len())),
            Status::Ok | Status::BufError if read == 0 && stream.total_out() == written => {
                return Err(UnpackError::Endless);
            }
            Status::Ok | Status::BufError => {}
        }
    }
}
