//! Distribution functions with both tails, each tail computed without cancellation, and quantiles.

use super::special::{incomplete_beta, incomplete_gamma, ln_beta};
use crate::math::{exp, ln, ln_1p};
use std::f64::consts::PI;

/// Computes the lower tail of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    normal_sf(-z)
}

/// Computes the upper tail of the standard normal distribution: half of Q(1/2, z²/2) (Abramowitz and Stegun 26.2.30).
pub fn normal_sf(z: f64) -> f64 {
    if z.is_nan() {
        return f64::NAN;
    }
    let (inner, outer) = incomplete_gamma(0.5, 0.5 * z * z);
    if z > 0.0 { 0.5 * outer } else { 0.5 + 0.5 * inner }
}

/// Computes the error function: P(1/2, x²) with the sign of `x` (Abramowitz and Stegun 6.5.16).
pub fn erf(x: f64) -> f64 {
    incomplete_gamma(0.5, x * x).0.copysign(x)
}

/// Computes the complementary error function, accurate in its tail.
pub fn erfc(x: f64) -> f64 {
    2.0 * normal_sf(x * std::f64::consts::SQRT_2)
}

/// Computes the `z` below which a standard normal number falls with probability `p`; NaN outside [0, 1].
///
/// Abramowitz and Stegun 26.2.23 as the start, Newton's method on the logarithm of the tail to the end.
pub fn normal_quantile(p: f64) -> f64 {
    if p > 0.5 { -lower_normal_quantile(1.0 - p) } else { lower_normal_quantile(p) }
}

fn lower_normal_quantile(p: f64) -> f64 {
    if p.is_nan() || p < 0.0 {
        return f64::NAN;
    }
    if p == 0.0 {
        return f64::NEG_INFINITY;
    }
    if p == 0.5 {
        return 0.0;
    }
    let target = ln(p);
    let t = (-2.0 * target).sqrt();
    let mut z = t
        - (2.515_517 + t * (0.802_853 + t * 0.010_328))
            / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)));
    for _ in 0..6 {
        let tail = normal_sf(z);
        let density = exp(-0.5 * z * z) / (2.0 * PI).sqrt();
        let step = (ln(tail) - target) * tail / density;
        z += step;
        if step.abs() < 1e-15 * z.abs() {
            break;
        }
    }
    -z
}

/// Computes the upper tail of Student's t with `df` > 0 degrees of freedom (Abramowitz and Stegun 26.7.1, 26.5.27).
pub fn student_t_sf(t: f64, df: f64) -> f64 {
    if t.is_nan() {
        return f64::NAN;
    }
    let outside = student_t_two_sided(t, df);
    if t > 0.0 { 0.5 * outside } else { 1.0 - 0.5 * outside }
}

/// Computes the lower tail of Student's t.
pub fn student_t_cdf(t: f64, df: f64) -> f64 {
    student_t_sf(-t, df)
}

/// Computes the probability of a t at least as far from zero.
pub fn student_t_two_sided(t: f64, df: f64) -> f64 {
    if t.is_infinite() {
        return 0.0;
    }
    // Divided through by the larger of the two, so that an enormous t does not overflow.
    let ratio = t / df.sqrt();
    let (x, y) = if ratio.abs() > 1.0 {
        let inverse = 1.0 / ratio;
        let square = inverse * inverse;
        (square / (1.0 + square), 1.0 / (1.0 + square))
    } else {
        let square = ratio * ratio;
        (1.0 / (1.0 + square), square / (1.0 + square))
    };
    incomplete_beta(0.5 * df, 0.5, x, y).0
}

/// Computes the `t` below which Student's t falls with probability `p` in (0, 1).
///
/// Newton's method on the logarithm of the tail, kept inside a bracket that is halved where a step leaves it.
pub fn student_t_quantile(p: f64, df: f64) -> f64 {
    // Without a degree of freedom the tails never end.
    if !(0.0..=1.0).contains(&p) || df.is_nan() || df <= 0.0 {
        return f64::NAN;
    }
    if p == 0.5 {
        return 0.0;
    }
    let (tail, sign) = if p > 0.5 { (1.0 - p, 1.0) } else { (p, -1.0) };
    if tail == 0.0 {
        return sign * f64::INFINITY;
    }
    let target = ln(tail);
    let (mut low, mut high) = (0.0, 1.0);
    while student_t_sf(high, df) > tail {
        low = high;
        high *= 2.0;
    }
    let mut t = 0.5 * (low + high);
    for _ in 0..200 {
        let here = student_t_sf(t, df);
        if here > tail {
            low = t;
        } else {
            high = t;
        }
        let density =
            exp(-0.5 * (df + 1.0) * ln_1p(t * t / df) - ln_beta(0.5 * df, 0.5)) / df.sqrt();
        let next = t + (ln(here) - target) * here / density;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let step = (next - t).abs();
        t = next;
        if step <= 1e-15 * t {
            break;
        }
    }
    sign * t
}

/// Computes the upper tail of the F distribution with `df1`, `df2` > 0 (Abramowitz and Stegun 26.6.2).
pub fn f_sf(f: f64, df1: f64, df2: f64) -> f64 {
    f_tails(f, df1, df2).1
}

/// Computes the lower tail of the F distribution.
pub fn f_cdf(f: f64, df1: f64, df2: f64) -> f64 {
    f_tails(f, df1, df2).0
}

fn f_tails(f: f64, df1: f64, df2: f64) -> (f64, f64) {
    if f == f64::INFINITY {
        return (1.0, 0.0);
    }
    let whole = df1 * f + df2;
    incomplete_beta(0.5 * df1, 0.5 * df2, df1 * f / whole, df2 / whole)
}

/// Computes the upper tail of chi-square with `df` > 0 degrees of freedom (Abramowitz and Stegun 26.4.19).
pub fn chi_square_sf(x: f64, df: f64) -> f64 {
    incomplete_gamma(0.5 * df, 0.5 * x).1
}

/// Computes the lower tail of chi-square.
pub fn chi_square_cdf(x: f64, df: f64) -> f64 {
    incomplete_gamma(0.5 * df, 0.5 * x).0
}

/// Computes the probability that at least `k` of `n` independent events of probability `p` occur (Abramowitz and Stegun
/// 26.5.24).
pub fn binomial_sf_inclusive(k: u64, n: u64, p: f64) -> f64 {
    if k == 0 {
        return 1.0;
    }
    if k > n {
        return 0.0;
    }
    incomplete_beta(super::real(k), super::real(n - k) + 1.0, p, 1.0 - p).0
}
