//! Draws with weights: normalised from logarithms, how many draws they are worth, and where a value stands among them.

use super::length;
use crate::math;
use crate::rng::Stream;

/// Computes the logarithm of the mean of the exponentials of `logarithms`; `-inf` where there is nothing above.
pub fn ln_mean_exp(logarithms: &[f64]) -> f64 {
    let most = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    let sum: f64 = logarithms.iter().map(|ln| math::exp(ln - most)).sum();
    most + math::ln(sum / length(logarithms))
}

/// Returns weights that add up to 1 from their logarithms up to a constant; all equal where none is above `-inf`.
pub fn weights(logarithms: &[f64]) -> Vec<f64> {
    let most = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return vec![1.0 / length(logarithms).max(1.0); logarithms.len()];
    }
    let raw: Vec<f64> = logarithms.iter().map(|ln| math::exp(ln - most)).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|weight| weight / sum).collect()
}

/// Computes how many draws of equal weight `weights` are worth (Kong 1992): 1 over the sum of their squares.
pub fn effective_size(weights: &[f64]) -> f64 {
    let (sum, squares) =
        weights.iter().fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// Draws the places of `count` draws by `weights`, in order, by one uniform number (systematic resampling, Kitagawa 1996).
pub fn resample(weights: &[f64], count: usize, stream: &mut Stream) -> Vec<usize> {
    let sum: f64 = weights.iter().sum();
    let step = sum / length(&vec![(); count]).max(1.0);
    let mut next = stream.uniform() * step;
    let (mut places, mut below) = (Vec::with_capacity(count), 0.0);
    for (place, weight) in weights.iter().enumerate() {
        below += weight;
        while next < below && places.len() < count {
            places.push(place);
            next += step;
        }
    }
    // Rounding may leave the sum a hair below the last step.
    if let Some(last) = weights.iter().rposition(|weight| *weight > 0.0) {
        places.resize(count, last);
    }
    places
}

/// Draws a place by `weights`; `None` where none is above 0.
pub fn draw(weights: &[f64], stream: &mut Stream) -> Option<usize> {
    let sum: f64 = weights.iter().sum();
    if sum.is_nan() || sum <= 0.0 {
        return None;
    }
    let mut left = stream.uniform() * sum;
    let found = weights.iter().position(|weight| {
        left -= weight;
        left < 0.0
    });
    found.or_else(|| weights.iter().rposition(|weight| *weight > 0.0))
}

/// Computes the weighted quantile `share` (0 to 1) of `values`: the least that has so much weight at or below it; NaN where
/// there are none.
pub fn quantile(values: &[f64], weights: &[f64], share: f64) -> f64 {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let sum: f64 = weights.iter().sum();
    let mut below = 0.0;
    for place in &order {
        below += weights[*place];
        if below >= share * sum * (1.0 - 1e-12) {
            return values[*place];
        }
    }
    order.last().map_or(f64::NAN, |last| values[*last])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;
    use crate::stats::assert_close;

    #[test]
    fn weights_add_up_and_survive_tiny_likelihoods() {
        let found = weights(&[-5000.0, -5000.0 + math::ln(3.0), f64::NEG_INFINITY]);
        assert_close(found[0], 0.25, 1e-12);
        assert_close(found[1], 0.75, 1e-12);
        assert_eq!(found[2], 0.0);
        assert_eq!(weights(&[f64::NEG_INFINITY; 2]), [0.5, 0.5]);
        assert_close(ln_mean_exp(&[-900.0, -900.0]), -900.0, 1e-15);
        assert_close(ln_mean_exp(&[0.0, f64::NEG_INFINITY]), math::ln(0.5), 1e-15);
    }

    #[test]
    fn the_effective_size_is_that_of_the_large_ones() {
        assert_close(effective_size(&[0.25; 4]), 4.0, 1e-15);
        assert_close(effective_size(&[1.0, 0.0, 0.0]), 1.0, 1e-15);
        assert_close(effective_size(&[3.0, 1.0]), 1.6, 1e-15);
        assert_eq!(effective_size(&[]), 0.0);
    }

    #[test]
    fn resampling_keeps_every_share_within_one() {
        let weights = [0.1, 0.0, 0.55, 0.35];
        let mut stream = Seeds::new(1, Vec::new()).stream("resampling");
        let places = resample(&weights, 20, &mut stream);
        let count = |place| places.iter().filter(|p| **p == place).count();
        assert_eq!(places.len(), 20);
        assert_eq!([count(0), count(1), count(2), count(3)], [2, 0, 11, 7]);
        assert_eq!(draw(&[0.0, 2.0, 0.0], &mut stream), Some(1));
        assert_eq!(draw(&[0.0], &mut stream), None);
    }

    #[test]
    fn quantiles_count_weight() {
        let (values, weights) = ([3.0, 1.0, 2.0], [0.5, 0.25, 0.25]);
        assert_eq!(quantile(&values, &weights, 0.25), 1.0);
        assert_eq!(quantile(&values, &weights, 0.5), 2.0);
        assert_eq!(quantile(&values, &weights, 0.51), 3.0);
    }
}
