//! Gamma and beta functions and their regularised incomplete forms.

use crate::math::{exp, ln, ln_1p};
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
