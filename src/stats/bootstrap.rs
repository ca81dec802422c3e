//! Bootstrap intervals (Efron 1979) from a named stream: the same seed, the same interval.

use super::proportion::Proportion;
use super::special::LnChoose;
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
    let tables: Vec<Cumulative> = groups.iter().map(|group| Cumulative::of(*group)).collect();
    let mut shares: Vec<f64> = groups.iter().map(Proportion::share).collect();
    let estimate = statistic(&shares);
    let resample = || {
        for ((share, group), table) in shares.iter_mut().zip(groups).zip(&tables) {
            *share = real(table.successes(stream.uniform())) / real(group.trials);
        }
        statistic(&shares)
    };
    summed_up(estimate, std::iter::repeat_with(resample).take(resamples as usize), confidence)
}

/// The probabilities of at most 0, 1, ... successes among as many trials as were seen, each with the share seen.
struct Cumulative {
    trials: u64,
    /// The first number of successes whose probability is not zero, even if it is one only on paper.
    first: u64,
    /// From the first on, each the sum of those before; from the last on they do not change any more.
    sums: Vec<f64>,
}

/// Exponents below this have a power of zero: the smallest number is above e^-745.2.
const VANISHES: f64 = -750.0;

impl Cumulative {
    fn of(seen: Proportion) -> Self {
        let (n, p) = (seen.trials, seen.share());
        if seen.successes == 0 || seen.successes == n {
            return Self { trials: n, first: seen.successes, sums: vec![1.0] };
        }
        let mut choose = LnChoose::of(n);
        let (ln_p, ln_q) = (ln(p), ln(1.0 - p));
        let mut ln_probability = |k: u64| choose.at(k) + real(k) * ln_p + real(n - k) * ln_q;
        // Up to the number seen, the most probable one, they rise.
        let (mut first, mut last) = (0, seen.successes);
        while first < last {
            let middle = u64::midpoint(first, last);
            if ln_probability(middle) < VANISHES {
                first = middle + 1;
            } else {
                last = middle;
            }
        }
        let (mut sum, mut sums) = (0.0, Vec::new());
        for k in first..=n {
            let probability = exp(ln_probability(k));
            sum += probability;
            sums.push(sum);
            // From there on they fall, and what is so small is lost in the sum.
            if k > seen.successes && probability < sum * (f64::EPSILON / 8.0) {
                break;
            }
        }
        choose.remember();
        Self { trials: n, first, sums }
    }

    /// Returns the number of successes at the quantile `u`, in [0, 1): how many of the sums are not above it.
    fn successes(&self, u: f64) -> u64 {
        let below = self.sums.partition_point(|below| *below <= u);
        if below == self.sums.len() { self.trials } else { self.first + below as u64 }
    }
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

#[cfg(test)]
mod tests {
    use super::super::special::ln_choose;
    use super::*;

    /// Every sum, one after the other.
    fn plainly(seen: Proportion) -> Vec<f64> {
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

    #[test]
    fn successes_are_drawn_as_from_all_sums() {
        for (successes, trials) in [
            (0, 5),
            (5, 5),
            (0, 0),
            (1, 2),
            (3, 10),
            (1, 4000),
            (3999, 4000),
            (700, 2000),
            (2900, 9000),
        ] {
            let seen = Proportion::new(successes, trials);
            let (sums, table) = (plainly(seen), Cumulative::of(seen));
            let around = |sum: &f64| [sum.next_down(), *sum, sum.next_up()];
            let edges = sums.iter().flat_map(around).chain([0.0, f64::EPSILON / 2.0]);
            for u in edges.filter(|u| (0.0..1.0).contains(u)) {
                let expected = sums.partition_point(|below| *below <= u) as u64;
                assert_eq!(table.successes(u), expected.min(trials), "{u} of {seen:?}");
            }
        }
    }
}
