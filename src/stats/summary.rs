//! Location and spread of a sample. Sums run in the order given.

use super::{length, real};

/// Number, mean and spread of a sample, all that a test on means needs; also what papers print.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// How many values.
    pub n: u64,
    /// Arithmetic mean; NaN where `n` is zero.
    pub mean: f64,
    /// Sample standard deviation (divisor n - 1); NaN where `n` is below two.
    pub sd: f64,
}

impl Summary {
    /// Computes the summary of `values`.
    pub fn of(values: &[f64]) -> Self {
        Self { n: values.len() as u64, mean: mean(values), sd: sample_sd(values) }
    }

    /// Computes the variance of the mean, sd² / n.
    pub fn variance_of_mean(&self) -> f64 {
        self.sd * self.sd / real(self.n)
    }
}

/// Computes the arithmetic mean; NaN for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / length(values)
}

/// Computes the sample standard deviation, divisor n - 1, in two passes; NaN for fewer than two values.
pub fn sample_sd(values: &[f64]) -> f64 {
    let centre = mean(values);
    // A sum of deviations that are zero on paper corrects the rounding of the mean (Chan et al. 1983).
    let (mut squares, mut rest) = (0.0, 0.0);
    for value in values {
        let deviation = value - centre;
        squares += deviation * deviation;
        rest += deviation;
    }
    if values.len() < 2 {
        return f64::NAN;
    }
    ((squares - rest * rest / length(values)).max(0.0) / (length(values) - 1.0)).sqrt()
}

/// Computes the middle value; the mean of the two middle ones for an even number; NaN for no values.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Computes the `p` quantile, linear between order statistics (Hyndman and Fan 1996, type 7); NaN for no values.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted_quantile(&sorted, p)
}

/// Computes the [`quantile`] of values that ascend already.
pub(crate) fn sorted_quantile(sorted: &[f64], p: f64) -> f64 {
    if sorted.is_empty() {
        return f64::NAN;
    }
    let position = p.clamp(0.0, 1.0) * (length(sorted) - 1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a position inside the slice"
    )]
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - position.floor()) * (sorted[above] - sorted[below])
}
