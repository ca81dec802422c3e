//! Two one-sided tests (Schuirmann 1987): evidence that a difference lies inside a margin.
//!
//! A large p-value of a test for a difference is no such evidence: fewer trials make it larger.

use super::distribution::normal_sf;
use super::means::welch_shifted;
use super::proportion::{Proportion, newcombe_limits};
use super::summary::Summary;

/// The position of a difference relative to the margins ± `margin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquivalenceTest {
    /// p-value of "inside": the larger of the two one-sided ones.
    pub inside: f64,
    /// p-value of "beyond": the difference exceeds the margin on the side where it was observed.
    pub beyond: f64,
}

/// Tests the equivalence of two means by Welch's test against both margins.
pub fn tost_means(a: Summary, b: Summary, margin: f64) -> EquivalenceTest {
    let upper = welch_shifted(a, b, margin).tails;
    let lower = welch_shifted(a, b, -margin).tails;
    EquivalenceTest { inside: upper.less.max(lower.greater), beyond: upper.greater.min(lower.less) }
}

/// Tests the equivalence of two shares by Newcombe's interval.
///
/// The p-value belongs to the narrowest interval of confidence 1 - 2p that a margin touches, so `p <= alpha`
/// and "the 1 - 2 alpha interval lies inside" are the same statement. Unlike Wald's test it does not call
/// 0 of 5 and 0 of 5 equal.
pub fn tost_proportions(a: Proportion, b: Proportion, margin: f64) -> EquivalenceTest {
    let (below_upper, beyond_upper) = tails_at(a, b, margin);
    // The lower margin is the upper one of the groups exchanged.
    let (above_lower, beyond_lower) = tails_at(b, a, margin);
    EquivalenceTest { inside: below_upper.max(above_lower), beyond: beyond_upper.min(beyond_lower) }
}

/// Computes the p-values of "the difference is below `margin`" and "above": the limit that faces the margin is moved
/// until it touches.
fn tails_at(a: Proportion, b: Proportion, margin: f64) -> (f64, f64) {
    let difference = a.share() - b.share();
    let beyond = difference > margin;
    // Signed distance left between the facing limit and the margin at `z` standard errors; falls with z.
    let gap = |z: f64| {
        let (low, high) = newcombe_limits(a, b, z);
        if beyond { low - margin } else { margin - high }
    };
    if gap(0.0) <= 0.0 {
        return (0.5, 0.5);
    }
    let (mut inside, mut outside) = (0.0, 40.0);
    if gap(outside) > 0.0 {
        // No confidence reaches a margin of one or more.
        return if beyond { (1.0, 0.0) } else { (0.0, 1.0) };
    }
    for _ in 0..200 {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if gap(middle) > 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    let z = 0.5 * (inside + outside);
    if beyond { (normal_sf(-z), normal_sf(z)) } else { (normal_sf(z), normal_sf(-z)) }
}
