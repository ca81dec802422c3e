//! Numbers packed small into text: zigzag variable-length integers (as in Protocol Buffers' `sint`), then
//! base64 (RFC 4648, section 4). The page unpacks them with the twenty lines of `templates/unpack.js`.

use crate::geometry::Point;
use crate::grid::{Grid, GridFrame, Occupancy};

/// A stream of integers under construction.
#[derive(Debug, Default)]
pub(super) struct Pack(Vec<u8>);

impl Pack {
    /// Appends an integer: small magnitudes take one byte.
    pub(super) fn push(&mut self, value: i64) {
        #[expect(clippy::cast_sign_loss, reason = "zigzag: the sign goes to the lowest bit")]
        let mut rest = ((value << 1) ^ (value >> 63)) as u64;
        loop {
            let low = (rest & 0x7f) as u8;
            rest >>= 7;
            if rest == 0 {
                self.0.push(low);
                return;
            }
            self.0.push(low | 0x80);
        }
    }

    /// Returns the text.
    pub(super) fn text(&self) -> String {
        base64(&self.0)
    }
}

/// Encodes `bytes` as RFC 4648 base64 with padding.
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

/// Returns `value` in whole `unit`s, rounded; not a number counts as zero.
pub(super) fn whole(value: f64, unit: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "saturates; worlds are smaller")]
    let whole = (value / unit).round() as i64;
    whole
}

/// Writes values as differences to their predecessors, in whole `unit`s.
pub(super) fn deltas(values: impl IntoIterator<Item = f64>, unit: f64) -> String {
    let (mut pack, mut before) = (Pack::default(), 0);
    for value in values {
        let now = whole(value, unit);
        pack.push(now.saturating_sub(before));
        before = now;
    }
    pack.text()
}

/// Writes points as differences to their predecessors, x then y, in whole `unit`s.
pub(super) fn points<'a>(points: impl IntoIterator<Item = &'a Point>, unit: f64) -> String {
    let (mut pack, mut x, mut y) = (Pack::default(), 0, 0);
    for point in points {
        let (u, v) = (whole(point.x, unit), whole(point.y, unit));
        pack.push(u.saturating_sub(x));
        pack.push(v.saturating_sub(y));
        (x, y) = (u, v);
    }
    pack.text()
}

/// Writes changed cells as runs along rows: for each of unknown, free and occupied the number of runs, then per run the
/// gap since the last one's end and its length. Cells outside of `frame` are left out.
pub(super) fn runs(
    frame: &GridFrame,
    changes: impl IntoIterator<Item = (usize, Occupancy)>,
) -> String {
    let mut indices = [Vec::new(), Vec::new(), Vec::new()];
    for (index, value) in changes {
        if index < frame.len() {
            indices[value as usize].push(i64::try_from(index).unwrap_or(i64::MAX));
        }
    }
    let mut pack = Pack::default();
    for mut cells in indices {
        cells.sort_unstable();
        cells.dedup();
        let runs: Vec<_> = cells.chunk_by(|a, b| b - a == 1).collect();
        pack.push(i64::try_from(runs.len()).unwrap_or(i64::MAX));
        let mut end = 0;
        for run in runs {
            pack.push(run[0] - end);
            end = run[run.len() - 1] + 1;
            pack.push(end - run[0]);
        }
    }
    pack.text()
}

/// Writes a whole grid as [`runs`] of its free and occupied cells.
pub(super) fn grid(grid: &Grid<Occupancy>) -> String {
    let known = grid.values().iter().copied().enumerate();
    runs(grid.frame(), known.filter(|(_, value)| *value != Occupancy::Unknown))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Does the inverse, as the page's script does it.
    fn unpack(text: &str) -> Vec<i64> {
        let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let (mut bytes, mut bits, mut held) = (Vec::new(), 0_u32, 0);
        for digit in text.chars().filter(|c| *c != '=') {
            bits = bits << 6 | u32::try_from(digits.find(digit).unwrap()).unwrap();
            held += 6;
            if held >= 8 {
                held -= 8;
                bytes.push(u8::try_from(bits >> held & 0xff).unwrap());
            }
        }
        let (mut values, mut value, mut shift) = (Vec::new(), 0_u64, 0);
        for byte in bytes {
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 {
                let sign = if value & 1 == 1 { -1 } else { 0 };
                values.push(i64::try_from(value >> 1).unwrap() ^ sign);
                (value, shift) = (0, 0);
            }
        }
        values
    }

    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn a_map_change_is_three_lists_of_runs() {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 10, height: 2 };
        let changes = [(12, Occupancy::Free), (3, Occupancy::Free), (2, Occupancy::Free)];
        let outside = [(20, Occupancy::Occupied), (0, Occupancy::Occupied)];
        let text = runs(&frame, changes.into_iter().chain(outside));
        assert_eq!(unpack(&text), [0, 2, 2, 2, 8, 1, 1, 0, 1]);
    }

    proptest! {
        #[test]
        fn integers_survive(values in prop::collection::vec(-1_i64 << 60..1 << 60, 0..20)) {
            let mut pack = Pack::default();
            for value in &values {
                pack.push(*value);
            }
            prop_assert_eq!(unpack(&pack.text()), values);
        }

        #[test]
        fn values_survive_to_their_unit(values in prop::collection::vec(-1e4_f64..1e4, 0..20)) {
            let mut sum = 0;
            let back: Vec<_> = unpack(&deltas(values.iter().copied(), 0.001))
                .into_iter()
                .map(|d| { sum += d; sum })
                .collect();
            prop_assert_eq!(back, values.iter().map(|v| whole(*v, 0.001)).collect::<Vec<_>>());
        }
    }
}
