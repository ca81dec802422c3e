//! Extra fields of headers. Some give a file another name, size or kind, for those readers that know them; so only those
//! are let through that ordinary programs write and that change nothing.

use super::header::Record;

/// What may stand there.
pub(super) const EXPECTED: &str = "extra fields for times, owners and zip64 only";

/// The fields that matter.
#[derive(Debug, Default)]
pub(super) struct Fields<'a> {
    /// Sizes and offsets of eight bytes.
    pub(super) zip64: Option<&'a [u8]>,
}

/// What was found that is not [`EXPECTED`].
#[derive(Debug, Clone, thiserror::Error)]
pub(super) enum ExtraError {
    #[error("{0} bytes that are none")]
    None(usize),
    #[error("field 0x{0:04x} twice")]
    Twice(u16),
    #[error("field 0x{0:04x}, {1}")]
    Misleading(u16, &'static str),
    #[error("field 0x{0:04x}, whose meaning is unknown")]
    Unknown(u16),
    #[error("field 0x{0:04x} of {1} bytes that are not its own")]
    Other(u16, usize),
    #[error("a zip64 field of other sizes than are missing")]
    Zip64,
}

/// Reads them all.
///
/// # Errors
/// As [`ExtraError`] says.
pub(super) fn read(mut extra: &[u8]) -> Result<Fields<'_>, ExtraError> {
    let (mut fields, mut seen) = (Fields::default(), Vec::new());
    while !extra.is_empty() {
        let (id, field, rest) = split(extra).ok_or(ExtraError::None(extra.len()))?;
        if seen.contains(&id) {
            return Err(ExtraError::Twice(id));
        }
        seen.push(id);
        if id == ZIP64 {
            fields.zip64 = Some(field);
        } else if let Some(meaning) = misleading(id) {
            return Err(ExtraError::Misleading(id, meaning));
        } else if !KNOWN.contains(&id) {
            return Err(ExtraError::Unknown(id));
        } else if !is_whole(id, field) {
            return Err(ExtraError::Other(id, field.len()));
        }
        extra = rest;
    }
    Ok(fields)
}

fn split(extra: &[u8]) -> Option<(u16, &[u8], &[u8])> {
    let (head, rest) = extra.split_at_checked(4)?;
    let (field, rest) = rest.split_at_checked(usize::from(Record(head).u16(2)))?;
    Some((Record(head).u16(0), field, rest))
}

const ZIP64: u16 = 0x0001;

/// Fields of times and owners: Info-ZIP's, as it writes them today and as it wrote them first, and that of NTFS.
const KNOWN: [u16; 5] = [0x5455, 0x7875, 0x7855, 0x5855, 0x000a];

/// Returns whether a known field holds what it is for, and no byte more.
fn is_whole(id: u16, field: &[u8]) -> bool {
    match id {
        // Flags, and for each of the lowest three a time; the central directory has but the first, whatever the flags.
        0x5455 => field.split_first().is_some_and(|(flags, times)| {
            let announced = (flags & 0b111).count_ones() as usize * 4;
            flags & !0b111 == 0 && (times.len() == announced || times.len() == announced.min(4))
        }),
        // A version, then user and group, each with its length before it.
        0x7875 => match field {
            [1, rest @ ..] => owner(rest).and_then(owner).is_some_and(<[u8]>::is_empty),
            _ => false,
        },
        0x7855 => matches!(field.len(), 0 | 4),
        0x5855 => matches!(field.len(), 8 | 12),
        // Four bytes for later use, then one attribute: number 1, three times of eight bytes.
        _ => field.len() == 32 && field[4..].starts_with(&[1, 0, 24, 0]),
    }
}

/// Returns what follows a number behind its length.
fn owner(field: &[u8]) -> Option<&[u8]> {
    let (length, rest) = field.split_first()?;
    if *length > 8 { None } else { rest.get(usize::from(*length)..) }
}

/// Returns what other readers take a field of kind `id` for; `None` where it misleads none.
fn misleading(id: u16) -> Option<&'static str> {
    Some(match id {
        0x7075 => "which gives the file another name",
        0x6375 => "which holds a comment",
        0x9901 | 0x0017 => "which is for encryption",
        0x000d | 0x756e => "which can make it a link",
        _ => return None,
    })
}
