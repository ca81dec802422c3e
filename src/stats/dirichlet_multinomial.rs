//! Counts that scatter more than a multinomial's: the Dirichlet-multinomial distribution (Mosimann 1962), here by its
//! concentration κ, to which a model's probabilities are trusted: large κ is a multinomial.

use super::{real, special::ln_gamma};

/// Computes the logarithm of the probability of these `counts`, in their order of appearance, where probabilities are drawn
/// from a Dirichlet distribution of mean `expected` and `concentration`: without the number of orders, which is the same for
/// all that is compared.
///
/// A count that is expected never is impossible: `-inf`.
pub fn ln_probability<const N: usize>(
    counts: [u32; N],
    expected: [f64; N],
    concentration: f64,
) -> f64 {
    let all: u32 = counts.iter().sum();
    let whole = ln_gamma(concentration) - ln_gamma(concentration + f64::from(all));
    counts.iter().zip(expected).fold(whole, |sum, (count, share)| {
        let alpha = concentration * share;
        match (*count, alpha > 0.0) {
            (0, _) => sum,
            (_, false) => f64::NEG_INFINITY,
            (count, true) => sum + ln_gamma(alpha + f64::from(count)) - ln_gamma(alpha),
        }
    })
}

/// Computes the likelihood of three `counts` as [`ln_probability`] does, relative to that of a multinomial which expects just what
/// was counted, by products: for tables that are asked millions of times. The reference knows no concentration, so that
/// likelihoods of different concentrations compare.
pub fn relative_likelihood(counts: [u32; 3], expected: [f64; 3], concentration: f64) -> f64 {
    let all: u32 = counts.iter().sum();
    let mut likelihood = 1.0;
    let mut before = 0_u32;
    for (count, share) in counts.into_iter().zip(expected) {
        let counted = f64::from(count) / real(u64::from(all.max(1)));
        for i in 0..count {
            let drawn =
                (concentration * share + f64::from(i)) / (concentration + f64::from(before));
            likelihood *= drawn / counted;
            before += 1;
        }
    }
    likelihood
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;
    use crate::stats::assert_close;

    #[test]
    fn values_are_those_of_scipy() {
        // scipy.stats.dirichlet_multinomial([6, 3, 1], 10).logpmf([7, 1, 2]) less the logarithm of the 360 orders.
        let found = ln_probability([7, 1, 2], [0.6, 0.3, 0.1], 10.0);
        // By hand: Γ(10)/Γ(20) · Γ(13)/Γ(6) · Γ(4)/Γ(3) · Γ(3)/Γ(1).
        let by_hand = (6.0 * 7.0 * 8.0 * 9.0 * 10.0 * 11.0 * 12.0) * 3.0 * (1.0 * 2.0);
        let rising: f64 = (10..20).map(f64::from).product();
        assert_close(math::exp(found), by_hand / rising, 1e-12);
        // Two sides of a coin with κ = 2: every count is as likely, 1/(n + 1) over C(n, k) orders.
        assert_close(math::exp(ln_probability([3, 2], [0.5, 0.5], 2.0)), 1.0 / 60.0, 1e-12);
        assert_eq!(ln_probability([1, 0], [0.0, 1.0], 5.0), f64::NEG_INFINITY);
    }

    #[test]
    fn a_large_concentration_is_a_multinomial() {
        let expected: [f64; 3] = [0.5, 0.3, 0.2];
        let multinomial = 4.0 * math::ln(0.5) + 3.0 * math::ln(0.3) + 3.0 * math::ln(0.2);
        assert_close(ln_probability([4, 3, 3], expected, 1e7), multinomial, 1e-5);
    }

    #[test]
    fn relative_likelihoods_compare_over_shares_and_concentrations() {
        let counts = [20, 25, 5];
        let counted = [0.4, 0.5, 0.1];
        assert_close(relative_likelihood(counts, counted, 1e9), 1.0, 1e-5);
        let (few, many) =
            (ln_probability(counts, counted, 6.0), ln_probability(counts, counted, 48.0));
        let [least, most] = [6.0, 48.0].map(|kappa| relative_likelihood(counts, counted, kappa));
        assert!(least < most && most < 1.0, "what is trusted and right gains by it");
        assert_close(math::ln(least / most), few - many, 1e-9);
        let (a, b) = ([0.5, 0.4, 0.1], [0.4, 0.4, 0.2]);
        let ln = |expected| ln_probability(counts, expected, 20.0);
        let ratio = relative_likelihood(counts, a, 20.0) / relative_likelihood(counts, b, 20.0);
        assert_close(math::ln(ratio), ln(a) - ln(b), 1e-9);
    }
}
