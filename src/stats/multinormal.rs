//! The normal distribution of several quantities that vary together, by the Cholesky factor of their covariance.
//!
//! Written here rather than taken from a crate of linear algebra: those choose their kernels by the processor that they run on, so
//! that the last bits differ from machine to machine.

use crate::math::ln;
use crate::rng::Stream;
use crate::stats::length;

/// A covariance, factored: the lower triangle whose product with its transpose it is (Golub and Van Loan, "Matrix Computations",
/// 4th edition, algorithm 4.2.1).
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    size: usize,
    /// Row by row.
    lower: Vec<f64>,
}

impl Covariance {
    /// Factors the symmetric matrix of which `entry` returns an entry; `None` where it is not positive definite.
    pub fn of(size: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let mut lower = vec![0.0; size * size];
        for row in 0..size {
            for column in 0..=row {
                let known: f64 =
                    (0..column).map(|k| lower[row * size + k] * lower[column * size + k]).sum();
                let rest = entry(row, column) - known;
                lower[row * size + column] = if row > column {
                    rest / lower[column * size + column]
                } else if rest > 0.0 {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
        }
        Some(Self { size, lower })
    }

    /// Computes the logarithm of the density at `deviations` from the mean.
    pub fn ln_density(&self, deviations: &[f64]) -> f64 {
        let mut standard: Vec<f64> = Vec::with_capacity(self.size);
        let mut ln_root = 0.0;
        for (row, deviation) in deviations.iter().enumerate().take(self.size) {
            let own = &self.lower[row * self.size..=row * self.size + row];
            let known: f64 = own.iter().zip(&standard).map(|(l, z)| l * z).sum();
            standard.push((deviation - known) / own[row]);
            ln_root += ln(own[row]);
        }
        let square: f64 = standard.iter().map(|z| z * z).sum();
        -0.5 * (square + length(&standard) * ln(2.0 * std::f64::consts::PI)) - ln_root
    }

    /// Draws deviations from the mean.
    pub fn draw(&self, stream: &mut Stream) -> Vec<f64> {
        let standard: Vec<f64> = (0..self.size).map(|_| stream.normal()).collect();
        let row = |row: usize| -> f64 {
            let own = &self.lower[row * self.size..=row * self.size + row];
            own.iter().zip(&standard).map(|(l, z)| l * z).sum()
        };
        (0..self.size).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;
    use crate::stats::{assert_close, real};

    const MATRIX: [[f64; 3]; 3] = [[4.0, 2.0, 0.6], [2.0, 3.0, 0.5], [0.6, 0.5, 1.0]];

    fn covariance() -> Covariance {
        Covariance::of(3, |a, b| MATRIX[a][b]).unwrap()
    }

    #[test]
    fn a_density_is_that_of_scipy() {
        // scipy.stats.multivariate_normal([0, 0, 0], MATRIX).logpdf([1, -0.5, 2])
        assert_close(covariance().ln_density(&[1.0, -0.5, 2.0]), -6.249_505_417_382_140_5, 1e-12);
        // One quantity: -ln(2 sqrt(2 pi)) - 1/2.
        let one = Covariance::of(1, |_, _| 4.0).unwrap();
        let expected = -0.5 - ln(2.0) - 0.5 * ln(2.0 * std::f64::consts::PI);
        assert_close(one.ln_density(&[2.0]), expected, 1e-15);
        assert_eq!(Covariance::of(0, |_, _| 1.0).unwrap().ln_density(&[]), 0.0);
    }

    #[test]
    fn draws_vary_together_as_they_should() {
        let mut stream = Seeds::new(4, Vec::new()).stream("multinormal");
        let draws: Vec<Vec<f64>> = (0..20_000).map(|_| covariance().draw(&mut stream)).collect();
        for a in 0..3 {
            for b in 0..3 {
                let product: f64 = draws.iter().map(|draw| draw[a] * draw[b]).sum();
                assert!((product / real(20_000) - MATRIX[a][b]).abs() < 0.1, "{a} {b}");
            }
        }
    }

    #[test]
    fn what_is_no_covariance_is_refused() {
        assert_eq!(Covariance::of(2, |a, b| if a == b { 1.0 } else { 1.5 }), None);
        assert_eq!(Covariance::of(1, |_, _| 0.0), None);
        assert_eq!(Covariance::of(1, |_, _| f64::NAN), None);
    }
}
