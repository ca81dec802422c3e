//! Bootstrap intervals (Efron 1979) from a named stream: the same seed, the same interval.

use super::proportion::Proportion;
use super::special::ln_choose;
use super::summary::{sample_sd, sorted_quantile};
use super::{Interval, real};
use crate::math::{exp, ln};
use crate::rng::Stream;

/// A statistic with its spread by resampling.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrapped {
    /// The statistic of the samples as observed.
    pub estimate: f64,
    /// Percentile interval (Efron and Tibshirani 1993, section 13.3).
    pub interval: Interval,
    /// Standard deviation over the resamples.
    pub standard_error: f64,
    /// The statistic of each resample, ascending.
    pub statistics: Vec<f64>,
}

/// Resamples each of `samples` on its own, with replacement, `resamples` times, and computes `statistic` of all.
///
/// Samples are non-empty; draws come in the order of samples and values.
pub fn bootstrap(
    samples: &[&[f64]],
    statistic: impl Fn(&[Vec<f64>]) -> f64,
    resamples: u32,
    confidence: f64,
    stream: &mut Stream,
) -> Bootstrapped {
    let mut drawn: Vec<Vec<f64>> = samples.iter().map(|s| s.to_vec()).collect();
    let estimate = statistic(&drawn);
    let resample = || {
        for (into, from) in drawn.iter_mut().zip(samples) {
            for value in into.iter_mut() {
                #[expect(clippy::cast_possible_truncation, reason = "an index below the length")]
                let index = stream.below(from.len() as u64) as usize;
                *value = from[index];
            }
        }
        statistic(&drawn)
    };
    summed_up(estimate, std::iter::repeat_with(resample).take(resamples as usize), confidence)
}

/// Does [`bootstrap`] of the shares of `groups`: a resample of zeros and ones has a binomial number of ones, which is
/// drawn at once.
pub fn bootstrap_shares(
    groups: &[Proportion],
    statistic: impl Fn(&[f64]) -> f64,
    resamples: u32,
    confidence: f64,
    stream: &mut Stream,
) -> Bootstrapped {
    let tables: Vec<Vec<f64>> = groups.iter().map(|group| cumulative(*group)).collect();
    let mut shares: Vec<f64> = groups.iter().map(Proportion::share).collect();
    let estimate = statistic(&shares);
    let resample = || {
        for ((share, group), table) in shares.iter_mut().zip(groups).zip(&tables) {
            let u = stream.uniform();
            let successes = table.partition_point(|below| *below <= u) as u64;
            *share = real(successes.min(group.trials)) / real(group.trials);
        }
        statistic(&shares)
    };
    summed_up(estimate, std::iter::repeat_with(resample).take(resamples as usize), confidence)
}

/// Computes the probabilities of at most 0, 1, ... successes among as many trials as `seen` has, each with its share.
fn cumulative(seen: Proportion) -> Vec<f64> {
    let (n, p) = (seen.trials, seen.share());
    if seen.successes == 0 || seen.successes == n {
        return (0..=n).map(|k| f64::from(u8::from(k >= seen.successes))).collect();
    }
    let ln_probability = |k: u64| ln_choose(n, k) + real(k) * ln(p) + real(n - k) * ln(1.0 - p);
    let mut sum = 0.0;
    let sums = (0..=n).map(|k| {
        sum += exp(ln_probability(k));
        sum
    });
    sums.collect()
}

fn summed_up(
    estimate: f64,
    statistics: impl Iterator<Item = f64>,
    confidence: f64,
) -> Bootstrapped {
    let mut statistics: Vec<f64> = statistics.collect();
    let standard_error = sample_sd(&statistics);
    statistics.sort_by(f64::total_cmp);
    let interval = Interval {
        low: sorted_quantile(&statistics, 0.5 - 0.5 * confidence),
        high: sorted_quantile(&statistics, 0.5 + 0.5 * confidence),
        confidence,
    };
    Bootstrapped { estimate, interval, standard_error, statistics }
}
