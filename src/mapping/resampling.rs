//! Weights of particles, and the choice of those that survive.

use crate::math;

/// Computes weights (summing to 1) of particles from their log weights, smoothed by `gain` and by their number, as
/// GMapping does (`obsSigmaGain`): w_i is proportional to exp((l_i - l_max) / (gain n)).
pub(super) fn normalised(log_weights: &[f64], gain: f64) -> Vec<f64> {
    let highest = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    #[expect(clippy::cast_precision_loss, reason = "few")]
    let scale = gain * log_weights.len() as f64;
    let mut weights: Vec<f64> =
        log_weights.iter().map(|l| math::exp((l - highest) / scale)).collect();
    let sum: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}

/// Computes the effective number of particles: 1 / sum of squared weights (Grisetti et al. 2007, equation 20), between
/// 1 and their number.
pub(super) fn effective(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|w| w * w).sum::<f64>()
}

/// Chooses the particles that survive, in order: systematic (low-variance) resampling with the one draw `offset`, in
/// [0, 1). Particle i comes n w_i times, rounded up or down.
pub(super) fn systematic(weights: &[f64], offset: f64) -> Vec<usize> {
    #[expect(clippy::cast_precision_loss, reason = "few")]
    let interval = 1.0 / weights.len() as f64;
    let mut chosen = Vec::with_capacity(weights.len());
    let (mut i, mut sum) = (0, weights.first().copied().unwrap_or(0.0));
    let mut pointer = offset * interval;
    for _ in 0..weights.len() {
        while pointer >= sum && i + 1 < weights.len() {
            i += 1;
            sum += weights[i];
        }
        chosen.push(i);
        pointer += interval;
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn each_lives_on_as_often_as_it_weighs_give_or_take_less_than_one(
            log_weights in prop::collection::vec(-300.0..0.0, 1..40),
            offset in 0.0..1.0,
        ) {
            let weights = normalised(&log_weights, 3.0);
            let n = f64::from(u32::try_from(weights.len()).unwrap());
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let effective = effective(&weights);
            prop_assert!((1.0 - 1e-9..=n + 1e-9).contains(&effective));
            let chosen = systematic(&weights, offset);
            prop_assert_eq!(chosen.len(), weights.len());
            prop_assert!(chosen.is_sorted());
            for (i, weight) in weights.iter().enumerate() {
                let times = chosen.iter().filter(|&&c| c == i).map(|_| 1.0).sum::<f64>();
                prop_assert!((times - weight * n).abs() < 1.0 + 1e-6);
            }
        }
    }

    #[test]
    fn equal_particles_all_live_on() {
        let weights = normalised(&[-5.0; 30], 3.0);
        assert!((effective(&weights) - 30.0).abs() < 1e-9);
        assert_eq!(systematic(&weights, 0.4), (0..30).collect::<Vec<_>>());
        assert_eq!(systematic(&normalised(&[0.0, -1e9], 1.0), 0.99), [0, 0]);
    }
}
