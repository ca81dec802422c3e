//! Effect sizes, which p-values do not give.

use super::proportion::Proportion;
use super::rank::midranks;
use super::special::ln_gamma;
use super::summary::Summary;
use super::{length, real};
use crate::math::{exp, ln};

/// Computes the difference of the means in pooled standard deviations (Cohen 1988); NaN where neither group varies.
pub fn cohen_d(a: Summary, b: Summary) -> f64 {
    let (na, nb) = (real(a.n), real(b.n));
    let pooled = ((na - 1.0) * a.sd * a.sd + (nb - 1.0) * b.sd * b.sd) / (na + nb - 2.0);
    (a.mean - b.mean) / pooled.sqrt()
}

/// Computes Cohen's d without its bias in small samples, by the exact factor J(m) = Γ(m/2) / (√(m/2) Γ((m - 1)/2)), m =
/// n₁ + n₂ - 2 (Hedges 1981).
pub fn hedges_g(a: Summary, b: Summary) -> f64 {
    let m = real(a.n + b.n) - 2.0;
    let factor = exp(ln_gamma(m / 2.0) - ln_gamma((m - 1.0) / 2.0) - 0.5 * ln(m / 2.0));
    if m < 2.0 { f64::NAN } else { factor * cohen_d(a, b) }
}

/// Computes the difference of the shares.
pub fn risk_difference(a: Proportion, b: Proportion) -> f64 {
    a.share() - b.share()
}

/// Computes Cliff's delta (1993): how much likelier a value of `a` exceeds one of `b` than the reverse, in [-1, 1].
pub fn cliff_delta(a: &[f64], b: &[f64]) -> f64 {
    let both: Vec<f64> = a.iter().chain(b).copied().collect();
    let (na, nb) = (length(a), length(b));
    let u = midranks(&both)[..a.len()].iter().sum::<f64>() - na * (na + 1.0) / 2.0;
    2.0 * u / (na * nb) - 1.0
}
