//! How much of a quantity's variance the groups of a factor explain: first-order shares, and whether chance would do as well.

use super::summary::mean;
use super::{length, real};
use crate::rng::Stream;
use std::collections::BTreeMap;

/// Groups of observations by their indices: what one factor makes of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Groups {
    /// The group of every observation.
    of: Vec<usize>,
    /// How many there are in each; none is empty.
    sizes: Vec<u64>,
}

impl Groups {
    /// Creates the groups in which observations of the same name are.
    pub fn of_names<T: Ord>(names: &[T]) -> Self {
        let mut known: BTreeMap<&T, usize> = BTreeMap::new();
        let of = names.iter().map(|name| {
            let next = known.len();
            *known.entry(name).or_insert(next)
        });
        Self::new(of.collect())
    }

    /// Creates `bins` groups of the numbers `values` by their ranks, as even as can be; equal numbers share a group.
    pub fn of_ranks(values: &[f64], bins: usize) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let bin = |value: &f64| {
            // Of equal numbers the first decides.
            let rank = sorted.partition_point(|other| other < value);
            rank * bins.max(1) / values.len().max(1)
        };
        // Where many are equal a bin may be empty.
        let bins: Vec<usize> = values.iter().map(bin).collect();
        Self::of_names(&bins)
    }

    fn new(of: Vec<usize>) -> Self {
        let mut sizes = vec![0; of.iter().max().map_or(0, |last| last + 1)];
        for group in &of {
            sizes[*group] += 1;
        }
        Self { of, sizes }
    }

    /// Returns how many groups there are.
    pub fn count(&self) -> usize {
        self.sizes.len()
    }

    /// Computes the share of the variance of `values` that lies between these groups, less what chance would put there: epsilon
    /// squared, (SS between - (k - 1) MS within) / SS total (Kelley 1935), at least 0.
    ///
    /// `None` where the values are all equal, where there is one group, or none holds two.
    pub fn share(&self, values: &[f64]) -> Option<f64> {
        let (n, k) = (length(values), length(&self.sizes));
        let first = values.first()?;
        if k < 2.0 || n <= k || values.iter().all(|value| value == first) {
            return None;
        }
        let deviations = deviations(values);
        Some(self.share_of(&deviations, sum_of_squares(&deviations)))
    }

    /// Computes the same of deviations from the mean, whose squares add up to `total`; there must be something to explain.
    fn share_of(&self, deviations: &[f64], total: f64) -> f64 {
        let (n, k) = (length(deviations), length(&self.sizes));
        let mut sums = vec![0.0; self.sizes.len()];
        for (group, deviation) in self.of.iter().zip(deviations) {
            sums[*group] += deviation;
        }
        let between: f64 =
            sums.iter().zip(&self.sizes).map(|(sum, size)| sum * sum / real(*size)).sum();
        let within = (total - between).max(0.0) / (n - k);
        ((between - (k - 1.0) * within) / total).clamp(0.0, 1.0)
    }
}

/// What a factor explains of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// The share of its variance, at least 0.
    pub share: f64,
    /// How often the largest share of all factors was at least this, of all orders drawn and the one found.
    pub p: f64,
}

/// Computes what each of `factors` explains of `values`, and how likely a share so large is where none explains anything: the
/// values are put in `orders` random orders, and of each the largest share of all factors is compared, so that many factors do
/// not make one stand out (Westfall and Young 1993).
///
/// `None` for a factor that can explain nothing ([`Groups::share`]).
pub fn shares(
    values: &[f64],
    factors: &[Groups],
    orders: u32,
    stream: &mut Stream,
) -> Vec<Option<Share>> {
    let found: Vec<Option<f64>> = factors.iter().map(|groups| groups.share(values)).collect();
    let able: Vec<&Groups> =
        factors.iter().zip(&found).filter(|(_, share)| share.is_some()).map(|(f, _)| f).collect();
    let mut reached = vec![1_u64; factors.len()];
    if !able.is_empty() {
        let mut shuffled = deviations(values);
        let total = sum_of_squares(&shuffled);
        for _ in 0..orders {
            stream.shuffle(&mut shuffled);
            let shares = able.iter().map(|groups| groups.share_of(&shuffled, total));
            // Sums in another order differ in their last bits.
            let largest = shares.fold(0.0, f64::max) + 1e-12;
            for (count, share) in reached.iter_mut().zip(&found) {
                *count += u64::from(share.is_some_and(|share| largest >= share));
            }
        }
    }
    let all = real(u64::from(orders) + 1);
    let of =
        |(share, count): (Option<f64>, u64)| Some(Share { share: share?, p: real(count) / all });
    found.into_iter().zip(reached).map(of).collect()
}

fn deviations(values: &[f64]) -> Vec<f64> {
    let centre = mean(values);
    values.iter().map(|value| value - centre).collect()
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;
    use crate::stats::latin_hypercube::dimension;

    fn stream(label: &str) -> Stream {
        Seeds::new(7, Vec::new()).stream(label)
    }

    #[test]
    fn a_share_is_that_of_the_formula() {
        // Means 2, 5 and 8 of two each around 5: 36 between, 1 for each value within, 42 in all; of 3 degrees within.
        let values = [1.0, 3.0, 4.0, 6.0, 7.0, 9.0];
        let groups = Groups::of_names(&["a", "a", "b", "b", "c", "c"]);
        let found = groups.share(&values).unwrap();
        assert!((found - (36.0 - 2.0 * 2.0) / 42.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn what_cannot_be_explained_has_no_share() {
        let two = Groups::of_names(&["a", "b", "a", "b"]);
        assert_eq!(two.share(&[2.0; 4]), None, "all are equal");
        assert_eq!(Groups::of_names(&["a"; 4]).share(&[1.0, 2.0, 3.0, 4.0]), None, "one group");
        assert_eq!(Groups::of_names(&[1, 2, 3]).share(&[1.0, 2.0, 4.0]), None, "a group each");
        assert_eq!(Groups::of_names::<u8>(&[]).share(&[]), None);
        assert_eq!(two.share(&[1.0, 1.0, 5.0, 5.0]), Some(0.0), "nothing, less chance");
    }

    #[test]
    fn bins_are_even_and_equal_numbers_share_one() {
        let bins = Groups::of_ranks(&[0.9, 0.1, 0.5, 0.3, 0.7, 0.2], 3);
        assert_eq!((bins.sizes, bins.of), (vec![2, 2, 2], vec![0, 1, 2, 2, 0, 1]));
        let tied = Groups::of_ranks(&[1.0, 1.0, 1.0, 1.0, 2.0, 3.0], 3);
        assert_eq!(tied.sizes, [4, 2]);
    }

    /// Checks the shares of a function that is known: y = 3 a + b with a and b uniform, so nine parts of the variance in ten are a's.
    #[test]
    fn the_shares_of_a_known_function_are_found() {
        let n = 400;
        let [a, b, c] = ["a", "b", "c"].map(|label| dimension(n, &mut stream(label)));
        let y: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 3.0 * a + b).collect();
        let factors = [&a, &b, &c].map(|values| Groups::of_ranks(values, 8));
        let found = shares(&y, &factors, 199, &mut stream("orders"));
        let [a, b, c] = [0, 1, 2].map(|i| found[i].unwrap());
        // What a bin of an eighth leaves within itself is 1/64 of a choice's own.
        assert!((a.share - 0.9).abs() < 0.03, "{a:?}");
        assert!((b.share - 0.1).abs() < 0.04, "{b:?}");
        assert!(c.share < 0.03, "{c:?}");
        assert_eq!((a.p, b.p), (0.005, 0.005));
        assert!(c.p > 0.05, "{c:?}");
    }

    /// Checks that of quantities which nothing explains about one in twenty has a factor that stands out, however many there are.
    #[test]
    fn chance_stands_out_as_seldom_as_it_says() {
        let n = 48;
        let mut out = 0;
        for study in 0..200 {
            let mut drawn = Seeds::new(study, Vec::new()).stream("noise");
            let factors: Vec<Groups> =
                (0..10).map(|_| Groups::of_ranks(&dimension(n, &mut drawn), 6)).collect();
            let y: Vec<f64> = (0..n).map(|_| drawn.normal()).collect();
            let found = shares(&y, &factors, 99, &mut drawn);
            out += u32::from(found.iter().flatten().any(|share| share.p <= 0.05));
        }
        assert!((3..=19).contains(&out), "{out} of 200");
    }
}
