//! Unpacking one entry: never more than it declares, and to the last byte of its stream.

use super::header::Central;
use super::raw::Raw;
use flate2::read::DeflateDecoder;
use flate2::{Crc, Decompress, FlushDecompress, Status};
use std::io::Read;
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

/// Hands over the content of `entry`, whose bytes in the archive are `packed`, block by block. What was taken counts for nothing
/// where that fails.
///
/// # Errors
/// As [`UnpackError`] says.
pub(super) fn unpack(
    entry: &Central<'_>,
    packed: &Raw<'_>,
    take: &mut dyn FnMut(&[u8]),
) -> Result<(), UnpackError> {
    let (mut crc, mut length) = (Crc::new(), 0);
    let mut next = |block: &[u8]| {
        crc.update(block);
        length += block.len() as u64;
        take(block);
    };
    if entry.is_stored() {
        let mut at = 0;
        while at < packed.len() {
            let block = packed.up_to(at, STEP);
            if block.is_empty() {
                break;
            }
            next(&block);
            at += block.len() as u64;
        }
    } else {
        inflate_blocks(packed, entry.size, &mut next)?;
    }
    if length != entry.size {
        let found = usize::try_from(length)?;
        return Err(UnpackError::Length { found, declared: entry.size });
    }
    if crc.sum() != entry.crc {
        return Err(UnpackError::Checksum { found: crc.sum(), declared: entry.crc });
    }
    Ok(())
}

/// Hands over what the deflate stream `packed` holds, which is `declared` bytes at most.
fn inflate_blocks(
    packed: &Raw<'_>,
    declared: u64,
    next: &mut dyn FnMut(&[u8]),
) -> Result<(), UnpackError> {
    let (mut stream, mut unpacked) = (Decompress::new(false), Vec::new());
    let (mut block, mut at) = (packed.up_to(0, STEP), 0);
    loop {
        // One byte more than declared is enough to refuse.
        let room = STEP.min(declared + 1 - stream.total_out());
        unpacked.clear();
        unpacked.reserve_exact(usize::try_from(room)?);
        let read = stream.total_in();
        let status = stream
            .decompress_vec(&block[at..], &mut unpacked, FlushDecompress::None)
            .map_err(|_| UnpackError::Damaged)?;
        let read = stream.total_in() - read;
        at += usize::try_from(read)?;
        if stream.total_out() > declared {
            return Err(UnpackError::TooLong(declared));
        }
        next(&unpacked);
        match status {
            Status::StreamEnd => {
                return match packed.len() - stream.total_in() {
                    0 => Ok(()),
                    behind => Err(UnpackError::Behind(usize::try_from(behind)?)),
                };
            }
            Status::Ok | Status::BufError => {}
        }
        if at == block.len() {
            (block, at) = (packed.up_to(stream.total_in(), STEP), 0);
        } else if read == 0 && unpacked.is_empty() {
            return Err(UnpackError::Endless);
        }
        if block.is_empty() && unpacked.is_empty() {
            return Err(UnpackError::Endless);
        }
    }
}

/// Returns a reader of what the deflate stream that `packed` reads holds: of a stream that [`unpack`] found good.
pub(in crate::bundle) fn inflating(packed: impl Read) -> impl Read {
    DeflateDecoder::new(packed)
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
