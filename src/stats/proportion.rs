//! Proportions: k successes of n trials each.

use super::distribution::{chi_square_sf, normal_quantile, normal_sf};
use super::special::{LnChoose, ln_choose};
use super::{Interval, Tails, real};
use crate::math::exp;

/// `successes` of `trials`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Proportion {
    /// How many succeeded.
    pub successes: u64,
    /// The number of trials.
    pub trials: u64,
}

impl Proportion {
    /// Creates the proportion of `successes` in `trials`.
    ///
    /// # Panics
    /// Where there are more successes than trials.
    pub fn new(successes: u64, trials: u64) -> Self {
        assert!(successes <= trials, "{successes} successes of {trials} trials");
        Self { successes, trials }
    }

    /// Computes the share that succeeded; NaN without trials.
    pub fn share(&self) -> f64 {
        real(self.successes) / real(self.trials)
    }
}

/// A quarter of the distance from one to the next smaller number: added to one or more it is lost.
const NOTHING: f64 = f64::EPSILON / 8.0;

/// Computes Fisher's exact test of two proportions; "less" means that `a` has the lower share.
///
/// The two-sided value sums all tables at most as probable as the one observed (Fisher 1935, as scipy and R do, with
/// their relative tolerance of 1e-7 for ties).
pub fn fisher_exact(a: Proportion, b: Proportion) -> Tails {
    let successes = a.successes + b.successes;
    let all = a.trials + b.trials;
    let (first, last) = (successes.saturating_sub(b.trials), successes.min(a.trials));
    let (mut of_a, mut of_b) = (LnChoose::of(a.trials), LnChoose::of(b.trials));
    let of_all = ln_choose(all, successes);
    let mut ln_probability = |k: u64| of_a.at(k) + of_b.at(successes - k) - of_all;
    let seen = ln_probability(a.successes);
    let (mut less, mut greater, mut two_sided) = (0.0, 0.0, 0.0);
    let mut before = 0.0;
    for k in first..=last {
        // Relative to the table observed, so that far tails keep their digits.
        let ratio = if k == a.successes { 1.0 } else { exp(ln_probability(k) - seen) };
        if k <= a.successes {
            less += ratio;
        }
        if k >= a.successes {
            greater += ratio;
        }
        if ratio <= 1.0 + 1e-7 {
            two_sided += ratio;
        }
        // Beyond the most probable table each is less probable than the one before; both sums are one or more by now, and
        // nothing so small changes them.
        if k > a.successes && ratio < before && ratio < NOTHING {
            break;
        }
        before = ratio;
    }
    of_a.remember();
    of_b.remember();
    let scale = exp(seen);
    Tails {
        less: (less * scale).min(1.0),
        greater: (greater * scale).min(1.0),
        two_sided: (two_sided * scale).min(1.0),
    }
}

/// The result of a test on one statistic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquare {
    /// Pearson's statistic.
    pub statistic: f64,
    /// Degrees of freedom, groups less one.
    pub df: f64,
    /// Upper tail.
    pub p: f64,
}

/// Computes Pearson's chi-square test that all groups have one share (Pearson 1900), without continuity correction.
///
/// Where none or all succeeded there is nothing to distinguish: statistic 0, p 1.
pub fn chi_square_homogeneity(groups: &[Proportion]) -> ChiSquare {
    let pooled = pool(groups);
    let df = super::length(groups) - 1.0;
    let share = pooled.share();
    if pooled.successes == 0 || pooled.successes == pooled.trials {
        return ChiSquare { statistic: 0.0, df, p: 1.0 };
    }
    let statistic = groups
        .iter()
        .map(|group| {
            let deviation = real(group.successes) - real(group.trials) * share;
            deviation * deviation / (real(group.trials) * share * (1.0 - share))
        })
        .sum();
    ChiSquare { statistic, df, p: chi_square_sf(statistic, df) }
}

/// A trend of shares along scores.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendTest {
    /// Standard normal under no trend; positive where the share rises with the score.
    pub z: f64,
    /// p-values: "greater" is a rising share, "less" a falling one.
    pub tails: Tails,
}

/// Computes the Cochran-Armitage test for a trend of shares along `scores` (Cochran 1954, Armitage 1955).
///
/// z = Σ sᵢ (kᵢ - nᵢ p) / √(p (1 - p) (Σ nᵢ sᵢ² - (Σ nᵢ sᵢ)² / N)). Where none or all succeeded, or all scores are
/// equal, z is 0.
pub fn cochran_armitage(groups: &[Proportion], scores: &[f64]) -> TrendTest {
    let pooled = pool(groups);
    let (n, share) = (real(pooled.trials), pooled.share());
    let pairs = || groups.iter().zip(scores);
    let centre = pairs().map(|(g, s)| real(g.trials) * s).sum::<f64>() / n;
    let slope: f64 = pairs().map(|(g, s)| (s - centre) * real(g.successes)).sum();
    let spread: f64 = pairs().map(|(g, s)| real(g.trials) * (s - centre) * (s - centre)).sum();
    let variance = share * (1.0 - share) * spread;
    let z = if variance > 0.0 { slope / variance.sqrt() } else { 0.0 };
    TrendTest { z, tails: normal_tails(z) }
}

/// Pools all groups.
pub fn pool(groups: &[Proportion]) -> Proportion {
    Proportion::new(groups.iter().map(|g| g.successes).sum(), groups.iter().map(|g| g.trials).sum())
}

/// Computes the p-values of a statistic that is standard normal under equality.
pub(crate) fn normal_tails(z: f64) -> Tails {
    Tails {
        less: normal_sf(-z),
        greater: normal_sf(z),
        two_sided: (2.0 * normal_sf(z.abs())).min(1.0),
    }
}

/// Computes Wilson's score interval of a share (Wilson 1927).
///
/// ```
/// use reenact::stats::proportion::{Proportion, wilson};
///
/// let interval = wilson(Proportion::new(10, 10), 0.95);
/// // z^2 = 3.8415 at 95 %, and 10 / (10 + z^2) = 0.7225.
/// assert!((interval.low - 0.7225).abs() < 1e-4);
/// assert_eq!(interval.high, 1.0);
/// ```
pub fn wilson(k: Proportion, confidence: f64) -> Interval {
    let z = normal_quantile(0.5 + 0.5 * confidence);
    let (low, high) = wilson_limits(k, z);
    Interval { low, high, confidence }
}

fn wilson_limits(k: Proportion, z: f64) -> (f64, f64) {
    let (n, p) = (real(k.trials), k.share());
    let widened = 1.0 + z * z / n;
    let centre = (p + z * z / (2.0 * n)) / widened;
    let half = z / widened * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    // At none and at all the limit is exact, which rounding would blur.
    let low = if k.successes == 0 { 0.0 } else { centre - half };
    let high = if k.successes == k.trials { 1.0 } else { centre + half };
    (low, high)
}

/// Computes Newcombe's hybrid score interval of the difference of two shares, `a` less `b` (Newcombe 1998, method 10).
pub fn newcombe(a: Proportion, b: Proportion, confidence: f64) -> Interval {
    let z = normal_quantile(0.5 + 0.5 * confidence);
    let (low, high) = newcombe_limits(a, b, z);
    Interval { low, high, confidence }
}

pub(crate) fn newcombe_limits(a: Proportion, b: Proportion, z: f64) -> (f64, f64) {
    let (p, q) = (a.share(), b.share());
    let ((p_low, p_high), (q_low, q_high)) = (wilson_limits(a, z), wilson_limits(b, z));
    let below = ((p - p_low) * (p - p_low) + (q_high - q) * (q_high - q)).sqrt();
    let above = ((p_high - p) * (p_high - p) + (q - q_low) * (q - q_low)).sqrt();
    (p - q - below, p - q + above)
}
