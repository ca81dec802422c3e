//! Random damage to valid documents: the parsers' tests see that nothing panics.

use proptest::prelude::*;
use proptest::sample::Index;

/// One damage: where, which kind, and a number to choose by.
pub(crate) type Edit = (Index, u8, u8);

/// Draws some damages.
pub(crate) fn edits() -> impl Strategy<Value = Vec<Edit>> {
    prop::collection::vec(any::<Edit>(), 1..8)
}

/// Pieces that parsers trip over.
const PIECES: [&[u8]; 16] = [
    b"NaN",
    b"-1",
    b"0",
    b"1e308",
    b"1e-320",
    b"99999999999",
    b"",
    b"<",
    b">",
    b"\"",
    b"\n",
    b" ",
    b"/",
    b": ",
    b"[",
    b"\xff\xfe",
];

/// Returns `bytes` with `edits` applied.
pub(crate) fn mutate(bytes: &[u8], edits: &[Edit]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, kind, choice) in edits {
        if bytes.is_empty() {
            break;
        }
        let i = at.index(bytes.len());
        let piece = PIECES[usize::from(*choice) % PIECES.len()];
        match kind % 8 {
            0 => bytes[i] = *choice,
            1 => bytes.truncate(i),
            2 => {
                let end = (i + usize::from(*choice)).min(bytes.len());
                bytes.drain(i..end);
            }
            3 => {
                let copied = bytes[i..(i + usize::from(*choice)).min(bytes.len())].to_vec();
                bytes.splice(i..i, copied);
            }
            4 => {
                bytes.splice(i..i, piece.iter().copied());
            }
            // Most often: another number in the place of a number.
            _ => {
                let number = |b: &u8| b.is_ascii_digit() || b"+-.e".contains(b);
                let Some(start) = bytes[i..].iter().position(u8::is_ascii_digit).map(|n| i + n)
                else {
                    continue;
                };
                let length = bytes[start..].iter().take_while(|b| number(b)).count();
                bytes.splice(start..start + length, piece.iter().copied());
            }
        }
    }
    bytes
}
