//! Latin hypercubes: designs in which every choice takes each part of its range exactly once (McKay, Beckman and Conover 1979).
//!
//! A dimension is drawn by itself, from a stream of its own, so that a choice more or less moves none of the others.

use super::real;
use crate::rng::Stream;

/// Draws one dimension of a Latin hypercube of `count` draws: numbers in [0, 1), of which every one of the `count` equal parts of
/// that interval holds exactly one, in random order and at a random place in its part.
///
/// ```
/// use reenact::rng::Seeds;
/// use reenact::stats::latin_hypercube::dimension;
///
/// let drawn = dimension(4, &mut Seeds::new(7, Vec::new()).stream("latin-hypercube"));
/// let mut quarters: Vec<u8> = drawn.iter().map(|u| (u * 4.0) as u8).collect();
/// quarters.sort_unstable();
/// assert_eq!(quarters, [0, 1, 2, 3]);
/// ```
pub fn dimension(count: usize, stream: &mut Stream) -> Vec<f64> {
    let mut parts: Vec<u64> = (0..count as u64).collect();
    stream.shuffle(&mut parts);
    let of = real(count as u64);
    parts
        .into_iter()
        .map(|part| {
            let within = (real(part) + stream.uniform()) / of;
            // Rounding may lift the last of a part onto the next one's first, or onto 1.
            within.min((real(part + 1) / of).next_down())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    fn drawn(count: usize, label: &str) -> Vec<f64> {
        dimension(count, &mut Seeds::new(2019, Vec::new()).stream(label))
    }

    #[test]
    fn every_part_is_drawn_exactly_once_in_every_dimension() {
        for count in [1, 2, 3, 7, 64, 1000] {
            for label in ["a", "b", "c"] {
                let of = real(count as u64);
                let mut parts: Vec<f64> =
                    drawn(count, label).iter().map(|u| (u * of).floor()).collect();
                parts.sort_by(f64::total_cmp);
                let expected: Vec<f64> = (0..count as u64).map(real).collect();
                assert_eq!(parts, expected, "{count} of {label}");
            }
        }
        assert_eq!(drawn(0, "a"), [0.0; 0]);
    }

    #[test]
    fn dimensions_are_drawn_apart() {
        assert_ne!(drawn(16, "a"), drawn(16, "b"));
        assert_eq!(drawn(16, "a"), drawn(16, "a"));
    }

    /// Checks the pinned numbers: a change here makes every table of a multiverse one that nobody can draw again.
    #[test]
    fn the_draws_are_pinned() {
        assert_eq!(
            drawn(4, "pin"),
            [
                0.336_656_118_119_826_6,
                0.108_647_408_187_936_39,
                0.685_271_480_811_096_9,
                0.862_931_247_275_518
            ]
        );
    }
}
