//! Gamma and beta functions and their regularised incomplete forms.

use crate::math::{exp, ln, ln_1p};
use std::cell::RefCell;
use std::f64::consts::PI;

/// Coefficients B(2k) / (2k (2k - 1)) of Stirling's series (Abramowitz and Stegun 6.1.41).
const STIRLING: [f64; 7] = [
    1.0 / 12.0,
    -1.0 / 360.0,
    1.0 / 1260.0,
    -1.0 / 1680.0,
    1.0 / 1188.0,
    -691.0 / 360_360.0,
    1.0 / 156.0,
];

/// From here on Stirling's series is exact to the last bit or two with the terms above.
const STIRLING_FROM: f64 = 10.0;

/// Relative change at which a continued fraction or a series has settled.
const SETTLED: f64 = 1e-16;

/// More terms than any argument in use needs (about the square root of the largest shape).
const MOST_TERMS: u32 = 1_000_000;

/// Computes `ln Γ(x) - ((x - 1/2) ln x - x + ln √(2π))` for `x` of at least [`STIRLING_FROM`].
fn stirling_rest(x: f64) -> f64 {
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    STIRLING.iter().rev().fold(0.0, |sum, c| sum * square + c) * inverse
}

/// Returns half the logarithm of 2π.
fn ln_root_two_pi() -> f64 {
    0.5 * ln(2.0 * PI)
}

/// Computes the logarithm of the gamma function for `x` > 0; NaN elsewhere.
///
/// Stirling's series (Abramowitz and Stegun 6.1.41), small arguments lifted by Γ(x + 1) = x Γ(x).
pub fn ln_gamma(x: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return f64::NAN;
    }
    if x == 1.0 || x == 2.0 {
        return 0.0;
    }
    let (mut lifted, mut product) = (x, 1.0);
    while lifted < STIRLING_FROM {
        product *= lifted;
        lifted += 1.0;
    }
    (lifted - 0.5) * ln(lifted) - lifted + ln_root_two_pi() + stirling_rest(lifted) - ln(product)
}

/// Computes the logarithm of the beta function for `a`, `b` > 0.
///
/// Large arguments by Stirling's series with its leading terms cancelled by hand (as SLATEC's `DLBETA`).
pub fn ln_beta(a: f64, b: f64) -> f64 {
    let (p, q) = if a < b { (a, b) } else { (b, a) };
    let share = p / (p + q);
    if p >= STIRLING_FROM {
        let rest = stirling_rest(p) + stirling_rest(q) - stirling_rest(p + q);
        -0.5 * ln(q) + ln_root_two_pi() + rest + (p - 0.5) * ln(share) + q * ln_1p(-share)
    } else if q >= STIRLING_FROM {
        let rest = stirling_rest(q) - stirling_rest(p + q);
        ln_gamma(p) + rest + p - p * ln(p + q) + (q - 0.5) * ln_1p(-share)
    } else {
        ln_gamma(p) + ln_gamma(q) - ln_gamma(p + q)
    }
}

/// Computes the logarithm of the number of combinations of `k` out of `n`; `k` at most `n`.
pub fn ln_choose(n: u64, k: u64) -> f64 {
    let (n, k) = (super::real(n), super::real(k));
    if k == 0.0 || k == n {
        return 0.0;
    }
    // C(n, k) = 1 / ((n + 1) B(k + 1, n - k + 1))
    -ln_beta(k + 1.0, n - k + 1.0) - ln_1p(n)
}

/// Most combinations of which the logarithms are remembered, and most rows of them: a few megabytes.
const LONGEST_ROW: usize = 1 << 16;
const MOST_ROWS: usize = 8;

/// [`ln_choose`] of one `n` and every `k`, each computed when it is first asked for.
///
/// Sums over tables ask for the same logarithms for every table with the same margins, and studies that are made up have
/// them in common by the hundred.
#[derive(Debug)]
pub(super) struct LnChoose {
    n: u64,
    /// By `k`; NaN where nobody asked yet. Empty where it would be too long.
    known: Vec<f64>,
}

thread_local! {
    /// Rows that were used, the last one at the end. What is in them depends on nothing but their `n`.
    static ROWS: RefCell<Vec<LnChoose>> = const { RefCell::new(Vec::new()) };
}

impl LnChoose {
    /// Returns the row of `n`, with what is remembered of it.
    pub(super) fn of(n: u64) -> Self {
        let remembered = ROWS.with_borrow_mut(|rows| {
            rows.iter().position(|row| row.n == n).map(|place| rows.remove(place))
        });
        remembered.unwrap_or_else(|| {
            let length = usize::try_from(n).ok().filter(|n| *n < LONGEST_ROW).map_or(0, |n| n + 1);
            Self { n, known: vec![f64::NAN; length] }
        })
    }

    /// Returns [`ln_choose`] of `k`, at most `n`.
    pub(super) fn at(&mut self, k: u64) -> f64 {
        let place = usize::try_from(k).ok().and_then(|k| self.known.get_mut(k));
        let Some(known) = place else { return ln_choose(self.n, k) };
        if known.is_nan() {
            *known = ln_choose(self.n, k);
        }
        *known
    }

    /// Keeps it for whoever asks next.
    pub(super) fn remember(self) {
        if self.known.is_empty() {
            return;
        }
        ROWS.with_borrow_mut(|rows| {
            if rows.len() == MOST_ROWS {
                rows.remove(0);
            }
            rows.push(self);
        });
    }
}

/// Computes the regularised lower and upper incomplete gamma functions (P, Q) for `a` > 0, `x` >= 0.
///
/// P by its power series below `a + 1`, Q by its continued fraction above (Abramowitz and Stegun 6.5.29
/// and 6.5.31, the latter by Lentz's method); the other is the complement, which is then never the small one.
pub fn incomplete_gamma(a: f64, x: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (0.0, 1.0);
    }
    if x == f64::INFINITY {
        return (1.0, 0.0);
    }
    let scale = exp(a * ln(x) - x - ln_gamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut shape) = (1.0 / a, 1.0 / a, a);
        for _ in 0..MOST_TERMS {
            shape += 1.0;
            term *= x / shape;
            sum += term;
            if term < sum * SETTLED {
                break;
            }
        }
        let p = scale * sum;
        (p, 1.0 - p)
    } else {
        let mut b = x + 1.0 - a;
        let (mut c, mut d) = (f64::MAX, 1.0 / b);
        let mut h = d;
        for i in 1..MOST_TERMS {
            let i = f64::from(i);
            let factor = i * (a - i);
            b += 2.0;
            d = 1.0 / away_from_zero(factor * d + b);
            c = away_from_zero(b + factor / c);
            h *= c * d;
            if (c * d - 1.0).abs() < SETTLED {
                break;
            }
        }
        let q = scale * h;
        (1.0 - q, q)
    }
}

/// Computes the regularised incomplete beta function `I_x(a, b)` and its complement, for `a`, `b` > 0 and `x` in [0,
/// 1].
///
/// The complement `y` = 1 - `x` is an argument of its own, so that a caller that has it exactly loses nothing near one.
/// Continued fraction of Abramowitz and Stegun 26.5.8 by Lentz's method, on whichever side of the mean it converges
/// fast.
pub fn incomplete_beta(a: f64, b: f64, x: f64, y: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (0.0, 1.0);
    }
    if y <= 0.0 {
        return (1.0, 0.0);
    }
    if x < (a + 1.0) / (a + b + 2.0) {
        let lower = beta_fraction(a, b, x, y);
        (lower, 1.0 - lower)
    } else {
        let upper = beta_fraction(b, a, y, x);
        (1.0 - upper, upper)
    }
}

fn beta_fraction(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let ln_x = if x < 0.5 { ln(x) } else { ln_1p(-y) };
    let ln_y = if y < 0.5 { ln(y) } else { ln_1p(-x) };
    let scale = exp(a * ln_x + b * ln_y - ln_beta(a, b)) / a;
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..MOST_TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        h *= c * d;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        h *= c * d;
        if (c * d - 1.0).abs() < SETTLED {
            break;
        }
    }
    scale * h
}

/// Moves `x` away from zero: Lentz's method divides by its partial results, which may pass through it.
fn away_from_zero(x: f64) -> f64 {
    if x.abs() < 1e-300 { 1e-300 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remembered_logarithms_are_those_that_are_computed() {
        let long = LONGEST_ROW as u64;
        for n in [0, 1, 7, 600, long - 1, long, 3 * long].into_iter().cycle().take(21) {
            let mut row = LnChoose::of(n);
            for k in [0, 1, n / 3, n / 2, n].into_iter().filter(|k| *k <= n) {
                assert_eq!(row.at(k).to_bits(), ln_choose(n, k).to_bits(), "{k} of {n}");
            }
            row.remember();
        }
        // Two at a time, and more than are kept.
        let (mut one, mut other) = (LnChoose::of(5), LnChoose::of(5));
        assert_eq!(one.at(2), other.at(2));
        one.remember();
        other.remember();
        (0..100).for_each(|n| LnChoose::of(n).remember());
        assert_eq!(ROWS.with_borrow(Vec::len), MOST_ROWS);
    }
}
