//! The likelihood of every cell at every prediction, computed once: proposals ask for it millions of times.

use super::Inference;
use crate::stats::dirichlet_multinomial::relative_likelihood;

/// Steps between the probabilities 0 and 1 at which likelihoods are computed. Predictions rest on a few dozen trajectories, which
/// tell no more.
pub const GRID: usize = 32;

const SIDE: usize = GRID + 1;

/// Likelihoods of several tables: relative to a model that predicts just what was counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Likelihoods {
    cells: usize,
    concentrations: usize,
    /// By table, concentration, cell, first and second probability.
    values: Vec<f32>,
    tables: usize,
}

impl Likelihoods {
    /// Computes those of `tables` of counts, cell by cell.
    pub fn of(inference: &Inference, tables: &[Vec<[u32; 3]>]) -> Self {
        let cells = inference.observed.cells.len();
        let mut values =
            Vec::with_capacity(tables.len() * inference.concentration.len() * cells * SIDE * SIDE);
        for table in tables {
            for concentration in &inference.concentration {
                for counts in table {
                    for first in 0..SIDE {
                        for second in 0..SIDE {
                            let expected = softened(first, second);
                            let value = relative_likelihood(*counts, expected, *concentration);
                            #[expect(
                                clippy::cast_possible_truncation,
                                reason = "what is too small for it is impossible"
                            )]
                            values.push(value as f32);
                        }
                    }
                }
            }
        }
        Self { cells, concentrations: inference.concentration.len(), values, tables: tables.len() }
    }

    /// Returns how many tables there are.
    pub fn tables(&self) -> usize {
        self.tables
    }

    /// Returns the likelihoods of one cell of a table at one concentration, by [`Self::place`].
    pub fn of_cell(&self, table: usize, concentration: usize, cell: usize) -> &[f32] {
        let at = (table * self.concentrations + concentration) * self.cells + cell;
        &self.values[at * SIDE * SIDE..(at + 1) * SIDE * SIDE]
    }

    /// Returns where the likelihood stands of the probabilities of the first and the second outcome.
    pub fn place(first: f64, second: f64) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a small whole number"
        )]
        let step = |share: f64| (share * GRID as f64 + 0.5) as usize;
        let first = step(first).min(GRID);
        first * SIDE + step(second).min(GRID - first)
    }
}

/// Returns probabilities that leave every outcome possible: half a step each, as a few dozen trajectories cannot rule one out.
fn softened(first: usize, second: usize) -> [f64; 3] {
    #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
    let (first, second, grid) = (first as f64, second as f64, GRID as f64);
    let third = (grid - first - second).max(0.0);
    [first, second, third].map(|steps| (steps + 0.5) / (first + second + third + 1.5))
}
