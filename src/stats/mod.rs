//! Statistics of the claims engine: distribution functions, summaries, intervals and tests.
//!
//! Everything rests on [`crate::math`], so a p-value has the same bits on every supported platform.
//! Sums run in the order of the values given; random tests take a named [`crate::rng::Stream`].
//! Each function cites its formula, and each is checked against values of scipy, statsmodels or mpmath
//! (the call stands beside the number in the tests).

pub mod agreement;
pub mod bootstrap;
pub mod compatibility;
pub mod dirichlet_multinomial;
pub mod distribution;
pub mod effect;
pub mod equivalence;
pub mod importance;
pub mod latin_hypercube;
pub mod means;
pub mod multinormal;
pub mod multiple;
pub mod proportion;
pub mod rank;
pub mod special;
pub mod summary;
pub mod unexplained;
pub mod variance_share;

/// A range that holds a quantity with the stated confidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower limit.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
    /// Two-sided confidence in (0, 1).
    pub confidence: f64,
}

/// The p-values of one test for the three alternatives.
///
/// For discrete tests `less + greater` exceeds one, and `two_sided` follows the test's own definition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tails {
    /// Probability, under equality, of a first group at least this low.
    pub less: f64,
    /// Probability, under equality, of a first group at least this high.
    pub greater: f64,
    /// Probability, under equality, of a difference at least this extreme.
    pub two_sided: f64,
}

/// Converts a count to a number.
pub(crate) fn real(count: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts of trials stay far below 2^53")]
    let number = count as f64;
    number
}

/// Returns the length of a slice as a number.
pub(crate) fn length<T>(values: &[T]) -> f64 {
    real(values.len() as u64)
}

/// Asserts equality of test values with published ones, relative to the published size.
#[cfg(test)]
pub(crate) fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let scale = if expected == 0.0 { 1.0 } else { expected.abs() };
    assert!(
        (found - expected).abs() <= tolerance * scale,
        "expected {expected:e}, found {found:e} (relative difference {:e})",
        (found - expected).abs() / scale
    );
}

#[cfg(test)]
#[expect(
    clippy::excessive_precision,
    reason = "reference values stand as the reference printed them"
)]
mod tests;
