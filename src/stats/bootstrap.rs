//! Bootstrap intervals (Efron 1979) from a named stream: the same seed, the same interval.

use super::Interval;
use super::summary::{sample_sd, sorted_quantile};
use crate::rng::Stream;

/// A statistic with what resampling says of its spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrapped {
    /// The statistic of the samples as seen.
    pub estimate: f64,
    /// Percentile interval (Efron and Tibshirani 1993, section 13.3).
    pub interval: Interval,
    /// Standard deviation over the resamples.
    pub standard_error: f64,
    /// The statistic of each resample, ascending.
    pub statistics: Vec<f64>,
}

/// Resamples each of `samples` on its own, with replacement, `resamples` times, and takes `statistic` of all.
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
    let mut statistics = Vec::with_capacity(resamples as usize);
    for _ in 0..resamples {
        for (into, from) in drawn.iter_mut().zip(samples) {
            for value in into.iter_mut() {
                #[expect(clippy::cast_possible_truncation, reason = "an index below the length")]
                let index = stream.below(from.len() as u64) as usize;
                *value = from[index];
            }
        }
        statistics.push(statistic(&drawn));
    }
    let standard_error = sample_sd(&statistics);
    statistics.sort_by(f64::total_cmp);
    let interval = Interval {
        low: sorted_quantile(&statistics, 0.5 - 0.5 * confidence),
        high: sorted_quantile(&statistics, 0.5 + 0.5 * confidence),
        confidence,
    };
    Bootstrapped { estimate, interval, standard_error, statistics }
}
