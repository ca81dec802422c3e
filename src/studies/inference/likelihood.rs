//! The likelihood of every cell at every prediction, computed once: proposals ask for it millions of times.

use super::{Inference, Printed, Times};
use crate::math;
use crate::stats::dirichlet_multinomial::relative_likelihood;
use crate::stats::real;

/// Steps between the probabilities 0 and 1 at which likelihoods are computed. Predictions rest on a few dozen trajectories, which
/// tell no more.
pub const GRID: usize = 32;

const SIDE: usize = GRID + 1;

/// Steps of expected times: each a twentieth longer than the one before, from one second to six hours.
const STEPS: usize = 200;
const STEP: f64 = 0.05;

/// Where the likelihoods of a prediction stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Those of counts.
    pub counts: usize,
    /// Those of the mean time.
    pub time: usize,
}

/// Likelihoods of several tables: relative to a model that predicts just what was counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Likelihoods {
    cells: usize,
    concentrations: usize,
    /// By table, concentration, cell, first and second probability.
    values: Vec<f32>,
    /// By table, concentration, cell and expected time; empty where no times are learned from.
    times: Vec<f32>,
    tables: usize,
}

impl Likelihoods {
    /// Computes those of `tables`, cell by cell.
    pub fn of(inference: &Inference, tables: &[Vec<Printed>]) -> Self {
        let cells = inference.observed.cells.len();
        let mut values =
            Vec::with_capacity(tables.len() * inference.concentration.len() * cells * SIDE * SIDE);
        for table in tables {
            for concentration in &inference.concentration {
                for printed in table {
                    for first in 0..SIDE {
                        for second in 0..SIDE {
                            let expected = softened(first, second);
                            let counts = printed.counts;
                            let value = relative_likelihood(counts, expected, *concentration);
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
        let mut times = Vec::new();
        if let Some(how) = &inference.times {
            for table in tables {
                for trust in 0..inference.concentration.len() {
                    times.extend(table.iter().flat_map(|printed| of_times(how, *printed, trust)));
                }
            }
        }
        let concentrations = inference.concentration.len();
        Self { cells, concentrations, values, times, tables: tables.len() }
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

    /// Returns the likelihoods of the mean time in one cell of a table, by [`Self::place`]; `None` where no times are learned from.
    pub fn of_time(&self, table: usize, concentration: usize, cell: usize) -> Option<&[f32]> {
        let at = ((table * self.concentrations + concentration) * self.cells + cell) * (STEPS + 1);
        self.times.get(at..at + STEPS + 1)
    }

    /// Returns where the likelihoods stand of the probabilities of the first and the second outcome, and of the mean time (s) of
    /// the first.
    pub fn place(first: f64, second: f64, time_s: Option<f64>) -> Place {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a small whole number"
        )]
        let step = |share: f64| (share * GRID as f64 + 0.5) as usize;
        let first = step(first).min(GRID);
        let counts = first * SIDE + step(second).min(GRID - first);
        Place { counts, time: time_s.map_or(STEPS, time_place) }
    }
}

/// Returns the likelihoods of what is `printed`, by the expected time, and last where nothing is expected: of a cell that is never
/// reached.
fn of_times(how: &Times, printed: Printed, trust: usize) -> Vec<f32> {
    let expected = (0..STEPS).map(|step| math::exp(STEP * real(step as u64)));
    #[expect(clippy::cast_possible_truncation, reason = "what is too small for it is impossible")]
    let mut all: Vec<f32> =
        expected.map(|expected_s| how.likelihood(printed, expected_s, trust) as f32).collect();
    all.push(1.0);
    all
}

fn time_place(time_s: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative, and a small whole number"
    )]
    let step = (math::ln(time_s.max(1.0)) / STEP).round() as usize;
    step.min(STEPS - 1)
}

/// Returns probabilities that leave every outcome possible: half a step each, as a few dozen trajectories cannot rule one out.
fn softened(first: usize, second: usize) -> [f64; 3] {
    #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
    let (first, second, grid) = (first as f64, second as f64, GRID as f64);
    let third = (grid - first - second).max(0.0);
    [first, second, third].map(|steps| (steps + 0.5) / (first + second + third + 1.5))
}
