//! Tests on ranks and signs.

use super::distribution::{binomial_sf_inclusive, normal_sf};
use super::summary::mean;
use super::{Tails, length, real};
use crate::math::{exp, ln};
use crate::rng::Stream;

/// Computes ranks from one, ties sharing their mean rank.
pub fn midranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut begin = 0;
    for tie in order.chunk_by(|&i, &j| values[i] == values[j]) {
        let shared = real(begin as u64) + 0.5 * (length(tie) + 1.0);
        for &i in tie {
            ranks[i] = shared;
        }
        begin += tie.len();
    }
    ranks
}

/// The result of a Mann-Whitney test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MannWhitney {
    /// Pairs in which the first group's value is the greater, ties counting one half.
    pub u: f64,
    /// p-values; "less" means that the first group tends to lower values.
    pub tails: Tails,
    /// Whether the p-values count arrangements or use the normal approximation.
    pub exact: bool,
}

/// Computes the Mann-Whitney (Wilcoxon rank sum) test of two groups (Mann and Whitney 1947).
///
/// Exact where the smaller group has at most eight values and none are tied; otherwise normal with the
/// correction for ties and for continuity (the rule and the formulas of `scipy.stats.mannwhitneyu`).
pub fn mann_whitney(a: &[f64], b: &[f64]) -> MannWhitney {
    let both: Vec<f64> = a.iter().chain(b).copied().collect();
    let ranks = midranks(&both);
    let (na, nb, n) = (length(a), length(b), length(&both));
    let u = ranks[..a.len()].iter().sum::<f64>() - na * (na + 1.0) / 2.0;
    let mut sorted = both;
    sorted.sort_by(f64::total_cmp);
    let ties: f64 = sorted
        .chunk_by(|x, y| x == y)
        .map(|tie| {
            let t = length(tie);
            t * t * t - t
        })
        .sum();
    if ties == 0.0 && a.len().min(b.len()) <= 8 && !a.is_empty() && !b.is_empty() {
        return MannWhitney { u, tails: exact_tails(u, a.len(), b.len()), exact: true };
    }
    let variance = na * nb / 12.0 * ((n + 1.0) - ties / (n * (n - 1.0)));
    if variance.is_nan() || variance <= 0.0 {
        return MannWhitney {
            u,
            tails: Tails { less: 1.0, greater: 1.0, two_sided: 1.0 },
            exact: false,
        };
    }
    let (centre, sd) = (na * nb / 2.0, variance.sqrt());
    let tails = Tails {
        greater: normal_sf((u - centre - 0.5) / sd),
        less: normal_sf((centre - u - 0.5) / sd),
        two_sided: (2.0 * normal_sf(((u - centre).abs() - 0.5) / sd)).min(1.0),
    };
    MannWhitney { u, tails, exact: false }
}

/// Computes the tails of U from the numbers of arrangements: the coefficients of the Gaussian binomial, in which one
/// group's values choose their places among the other's.
fn exact_tails(u: f64, na: usize, nb: usize) -> Tails {
    let (few, many) = (na.min(nb), na.max(nb));
    // ways[j][s]: j values of the smaller group that exceed s values of the larger in all, each at least
    // one; f64, as the numbers exceed 2^64.
    let most = few * many;
    let mut ways = vec![vec![0.0_f64; most + 1]; few + 1];
    ways[0][0] = 1.0;
    // Partitions into at most `few` parts of at most `many`: one part size after the other.
    for size in 1..=many {
        for parts in 1..=few {
            for sum in size..=most {
                let fewer = ways[parts - 1][sum - size];
                ways[parts][sum] += fewer;
            }
        }
    }
    let counts: Vec<f64> = (0..=most).map(|s| (0..=few).map(|j| ways[j][s]).sum()).collect();
    let all: f64 = counts.iter().sum();
    let upper = |from: f64| {
        (0..=most).filter(|&s| real(s as u64) >= from).map(|s| counts[s]).sum::<f64>() / all
    };
    let greater = upper(u);
    let less = upper(real(most as u64) - u);
    Tails { less, greater, two_sided: (2.0 * less.min(greater)).min(1.0) }
}

/// Computes the sign test: whether of `positive + negative` differences (zeros left out) the positive are half
/// (Arbuthnot 1710). "greater" means more positive ones.
pub fn sign_test(positive: u64, negative: u64) -> Tails {
    let n = positive + negative;
    let greater = binomial_sf_inclusive(positive, n, 0.5);
    let less = binomial_sf_inclusive(negative, n, 0.5);
    Tails { less, greater, two_sided: (2.0 * less.min(greater)).min(1.0) }
}

/// Computes Pearson's product-moment correlation, in [-1, 1]; NaN where either side does not vary.
pub fn pearson(x: &[f64], y: &[f64]) -> f64 {
    let (mx, my) = (mean(x), mean(y));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (a, b) in x.iter().zip(y) {
        xy += (a - mx) * (b - my);
        xx += (a - mx) * (a - mx);
        yy += (b - my) * (b - my);
    }
    // Rounding may carry a perfect correlation beyond one, where Fisher's z ends.
    (xy / (xx.sqrt() * yy.sqrt())).clamp(-1.0, 1.0)
}

/// Computes Spearman's rank correlation: Pearson's of the midranks (Spearman 1904).
pub fn spearman(x: &[f64], y: &[f64]) -> f64 {
    pearson(&midranks(x), &midranks(y))
}

/// Up to this many pairs all orders are enumerated instead of drawn: 8! = 40320.
const EXACT_PAIRS: usize = 8;

/// Computes permutation p-values of Spearman's correlation; "greater" is a positive one.
///
/// All orders for up to eight pairs; otherwise `permutations` orders drawn from `stream`, with the order observed
/// counted in, so that p is never zero (Phipson and Smyth 2010).
pub fn spearman_permutation(x: &[f64], y: &[f64], permutations: u32, stream: &mut Stream) -> Tails {
    let (rx, mut ry) = (midranks(x), midranks(y));
    // Only the cross product changes with the order.
    let product = |ry: &[f64]| product_of_ranks(&rx, ry);
    let n = length(x);
    let centre = n * (n + 1.0) * (n + 1.0) / 4.0;
    let seen = product(&ry) - centre;
    let tolerance = 1e-9 * (1.0 + seen.abs());
    let (mut at_least, mut at_most, mut as_far, mut all) = (0_u64, 0_u64, 0_u64, 0_u64);
    let mut count = |ry: &[f64]| {
        let here = product(ry) - centre;
        at_least += u64::from(here >= seen - tolerance);
        at_most += u64::from(here <= seen + tolerance);
        as_far += u64::from(here.abs() >= seen.abs() - tolerance);
        all += 1;
    };
    if x.len() <= EXACT_PAIRS {
        every_order(&mut ry, &mut count);
    } else {
        count(&ry);
        for _ in 0..permutations {
            stream.shuffle(&mut ry);
            count(&ry);
        }
    }
    let share = |k: u64| real(k) / real(all);
    Tails { less: share(at_most), greater: share(at_least), two_sided: share(as_far) }
}

/// Up to so many ranks their products, multiples of one quarter, add up without rounding, in whatever order.
const EXACT_SUM: usize = 1 << 17;

/// Computes the cross product of two lists of midranks.
fn product_of_ranks(x: &[f64], y: &[f64]) -> f64 {
    const LANES: usize = 8;
    if x.len() > EXACT_SUM {
        return x.iter().zip(y).map(|(a, b)| a * b).sum();
    }
    // Several sums at once: one would wait for each addition.
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (x, y) in x.iter().zip(y) {
        for ((sum, a), b) in sums.iter_mut().zip(x).zip(y) {
            *sum += a * b;
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Visits every order of `values` by Heap's algorithm (1963), without recursion.
fn every_order(values: &mut [f64], visit: &mut impl FnMut(&[f64])) {
    let mut counters = vec![0; values.len()];
    visit(values);
    let mut i = 1;
    while i < values.len() {
        if counters[i] < i {
            values.swap(if i % 2 == 0 { 0 } else { counters[i] }, i);
            visit(values);
            counters[i] += 1;
            i = 1;
        } else {
            counters[i] = 0;
            i += 1;
        }
    }
}

/// Computes the interval of Spearman's correlation by Fisher's z with the standard error √((1 + r²/2) / (n - 3))
/// (Bonett and Wright 2000). The whole range for fewer than four pairs.
pub fn spearman_interval(r: f64, n: u64, confidence: f64) -> super::Interval {
    if n < 4 || r.is_nan() {
        return super::Interval { low: -1.0, high: 1.0, confidence };
    }
    let standard_error = ((1.0 + r * r / 2.0) / (real(n) - 3.0)).sqrt();
    let half = super::distribution::normal_quantile(0.5 + 0.5 * confidence) * standard_error;
    let z = 0.5 * ln((1.0 + r) / (1.0 - r));
    // tanh, saturating at the ends where z is infinite
    let back = |z: f64| {
        if z > 20.0 {
            1.0
        } else if z < -20.0 {
            -1.0
        } else {
            (exp(2.0 * z) - 1.0) / (exp(2.0 * z) + 1.0)
        }
    };
    super::Interval { low: back(z - half), high: back(z + half), confidence }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    #[test]
    fn products_of_ranks_have_no_rounding_in_whatever_order() {
        let mut stream = Seeds::new(5, Vec::new()).stream("ranks");
        for n in [0, 1, 7, 8, 9, 1001, EXACT_SUM, EXACT_SUM + 1] {
            let mut ranks = || {
                // Half of them tied with others.
                let bound = (n as u64).max(1);
                let values: Vec<f64> = (0..n).map(|_| real(stream.below(bound))).collect();
                midranks(&values)
            };
            let (x, y) = (ranks(), ranks());
            let plain: f64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();
            assert_eq!(product_of_ranks(&x, &y), plain, "{n}");
            // The largest there is: every quarter of it is a number.
            let ranks: Vec<f64> = (1..=n as u64).map(real).collect();
            let n = n as u128;
            let exact = n * (n + 1) * (2 * n + 1) / 6;
            assert!(exact < 1 << 51, "{exact}");
            #[expect(clippy::cast_precision_loss, reason = "below 2^51")]
            let exact = exact as f64;
            assert_eq!(product_of_ranks(&ranks, &ranks), exact);
        }
    }
}
