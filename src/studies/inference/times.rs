//! Mean times of the trials that ended in the first outcome, as a table prints them beside counts.

use super::Printed;
use crate::math;
use crate::rng::Stream;
use serde::Serialize;

/// How they are learned from: the logarithm of a printed mean is normal about that of the expected one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Times {
    /// Relative error of an expected mean that no sampling explains: one for each concentration, for both say how far the model is
    /// trusted.
    pub model_error: Vec<f64>,
    /// Standard deviation of a single time, over the mean.
    pub scatter: f64,
    /// From how many times on a mean is learned from.
    pub at_least: u32,
}

impl Times {
    /// Returns the standard deviation of the logarithm of a mean over `trials`, where the model is trusted as the concentration
    /// `trust` says.
    pub fn deviation(&self, trials: u32, trust: usize) -> f64 {
        let model = self.model_error.get(trust).copied().unwrap_or_default();
        let sampling = self.sampling(trials);
        (model * model + sampling * sampling).sqrt()
    }

    fn sampling(&self, trials: u32) -> f64 {
        self.scatter / f64::from(trials.max(1)).sqrt()
    }

    /// Returns the likelihood of what is `printed` where `expected_s` (s) is expected, relative to a model without error that expects
    /// just that; 1 where no time is printed that is learned from.
    pub fn likelihood(&self, printed: Printed, expected_s: f64, trust: usize) -> f64 {
        let Some(time_s) = printed.time_s else { return 1.0 };
        let deviation = self.deviation(printed.counts[0], trust);
        let off = math::ln(time_s / expected_s) / deviation;
        math::exp(-0.5 * off * off) * self.sampling(printed.counts[0]) / deviation
    }

    /// Draws the mean time (s) of `trials` of which `expected_s` is expected; `None` where too few are there to learn from.
    pub fn draw(
        &self,
        expected_s: f64,
        trials: u32,
        trust: usize,
        stream: &mut Stream,
    ) -> Option<f64> {
        (trials >= self.at_least)
            .then(|| expected_s * math::exp(self.deviation(trials, trust) * stream.normal()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    fn times() -> Times {
        Times { model_error: vec![0.3, 0.6], scatter: 0.8, at_least: 4 }
    }

    #[test]
    fn a_mean_of_many_is_as_sure_as_the_model() {
        assert!((times().deviation(4, 0) - 0.5).abs() < 1e-12, "0.09 + 0.64 / 4 = 0.25");
        assert!((times().deviation(1_000_000, 1) - 0.6).abs() < 1e-5);
    }

    #[test]
    fn a_time_one_deviation_off_on_either_side_costs_the_same_and_trust_is_paid_for() {
        let printed = Printed { counts: [4, 0, 0], time_s: Some(100.0) };
        let step = math::exp(0.5);
        let found = [100.0, 100.0 * step, 100.0 / step].map(|s| times().likelihood(printed, s, 0));
        // By sampling alone 0.4, by both 0.5.
        let (right, off) = (0.8, 0.8 * math::exp(-0.5));
        for (found, expected) in found.iter().zip([right, off, off]) {
            assert!((found - expected).abs() < 1e-12, "{found}");
        }
        let doubtful = |s| times().likelihood(printed, s, 1);
        assert!(doubtful(100.0) < right && doubtful(300.0) > times().likelihood(printed, 300.0, 0));
        assert_eq!(times().likelihood(Printed { time_s: None, ..printed }, 7.0, 0), 1.0);
    }

    #[test]
    fn made_means_scatter_as_they_are_believed_to() {
        let mut stream = Seeds::new(4, Vec::new()).stream("times");
        let logs: Vec<f64> = (0..4000)
            .map(|_| math::ln(times().draw(50.0, 4, 0, &mut stream).unwrap() / 50.0))
            .collect();
        let mean = logs.iter().sum::<f64>() / 4000.0;
        let square = logs.iter().map(|x| x * x).sum::<f64>() / 4000.0;
        assert!(mean.abs() < 0.03 && (square - 0.25).abs() < 0.02, "{mean}, {square}");
        assert_eq!(times().draw(50.0, 3, 0, &mut stream), None);
    }
}
