//! Several tests at once.

use super::length;

/// Computes Holm's step-down adjustment (Holm 1979): p-values that may each be compared with the same alpha, with the
/// probability of any false rejection kept below it, whatever the dependence between the tests.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&i, &j| p_values[i].total_cmp(&p_values[j]));
    let mut adjusted = vec![0.0; p_values.len()];
    let (mut left, mut largest) = (length(p_values), 0.0_f64);
    for i in order {
        largest = largest.max((left * p_values[i]).min(1.0));
        adjusted[i] = largest;
        left -= 1.0;
    }
    adjusted
}
