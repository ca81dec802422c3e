//! How likely a combination of choices makes a table of means.
//!
//! The logarithms of the printed means are normal about those of our means. Their covariance is the sum of three:
//!
//! - our sampling: the relative covariance of single runs, pooled over all combinations (a few runs of one cell do not tell it), over
//!   the number of runs that reached the cell. Cells of an arm are of the same runs, so that these vary together as our runs show;
//! - the paper's sampling: the printed relative standard deviations over the printed numbers of runs, correlated as ours are;
//! - the model error: what no sampling explains of a cell by itself, of all cells of an arm together (they are of the same runs), and
//!   of all cells of the table together (a world that is larger moves them all). How large each of the three is nobody knows: they
//!   are weighed with the combinations, so that cells of the same runs count as pieces of evidence only as far as the table says.
//!
//! A cell that no run of a combination came to, though the paper prints a mean of it, counts as one that is [`UNREACHED`] of its
//! standard deviations off: it always costs, and never decides alone.

use super::runs::{Combination, Runs};
use super::{FromTrials, ModelError};
use crate::math::ln;
use crate::stats::multinormal::Covariance;
use crate::stats::real;
use crate::studies::Findings;

/// How many standard deviations off a cell counts that no run of a combination came to.
const UNREACHED: f64 = 3.0;

/// The combinations that were run, and what they make of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model<'a> {
    /// What is inferred.
    pub question: &'a FromTrials,
    /// What our runs say.
    pub runs: Runs,
    /// By pair of cells: the covariance of the printed logarithms that the paper's own sampling accounts for.
    printed: Vec<f64>,
}

/// Combinations and model errors, made ready for tables of which the same cells are learned from.
pub(super) struct Prepared {
    /// By combination, then model error.
    each: Vec<Vec<Likelihood>>,
}

/// One combination with one model error.
struct Likelihood {
    /// The cells that count and that it came to, with the logarithms of its means.
    expected: Vec<(usize, f64)>,
    covariance: Option<Covariance>,
    /// What the cells come to that it did not come to.
    unreached: f64,
}

impl<'a> Model<'a> {
    /// Reads the runs of `findings`.
    pub(super) fn new(findings: &Findings<'_>, question: &'a FromTrials) -> Self {
        let runs = Runs::of(findings, question);
        let cells = &question.observed.cells;
        let deviation = |cell: usize| match cells[cell].sd {
            Some(sd) => sd / cells[cell].mean,
            None => runs.spread(cell, cell, |_| None).sqrt(),
        };
        let mut printed = vec![0.0; cells.len() * cells.len()];
        for a in 0..cells.len() {
            for b in 0..cells.len() {
                if cells[a].arm == cells[b].arm {
                    printed[a * cells.len() + b] =
                        runs.correlation(a, b) * deviation(a) * deviation(b)
                            / (cells[a].n * cells[b].n).sqrt();
                }
            }
        }
        Self { question, runs, printed }
    }

    /// Returns the logarithm of the printed mean of a cell.
    pub(super) fn ln_printed(&self, cell: usize) -> f64 {
        ln(self.question.observed.cells[cell].mean)
    }

    /// Returns the logarithms of all printed means.
    pub(super) fn table(&self) -> Vec<f64> {
        (0..self.question.observed.cells.len()).map(|cell| self.ln_printed(cell)).collect()
    }

    /// Returns the covariance of two printed logarithms by the paper's sampling.
    pub(super) fn printed(&self, a: usize, b: usize) -> f64 {
        self.printed[a * self.question.observed.cells.len() + b]
    }

    /// Returns how often the printed number of runs of a cell is that of ours, `runs` of which there are.
    pub(super) fn as_many(&self, cell: usize, runs: u64) -> f64 {
        self.question.observed.cells[cell].n / real(runs.max(1))
    }

    /// Returns the covariance of two cells by a model error.
    pub(super) fn error(&self, error: ModelError, a: usize, b: usize) -> f64 {
        let cells = &self.question.observed.cells;
        let mut variance = error.table * error.table;
        if cells[a].arm == cells[b].arm {
            variance += error.arm * error.arm;
        }
        if a == b {
            variance += error.cell * error.cell;
        }
        variance
    }

    /// Returns the covariance of two cells between `combination` and the print, with nothing but sampling.
    pub(super) fn sampling(&self, combination: &Combination, a: usize, b: usize) -> f64 {
        let cells = &self.question.observed.cells;
        let relative = |cell: usize| cells[cell].sd.map(|sd| sd / cells[cell].mean);
        let runs = |cell: usize| combination.cells[cell].map_or(1.0, |reached| real(reached.n));
        let ours = if cells[a].arm == cells[b].arm {
            self.runs.spread(a, b, relative) / (runs(a) * runs(b)).sqrt()
        } else {
            0.0
        };
        ours + self.printed(a, b)
    }

    /// Returns the cells that count and that `trains` has.
    pub(super) fn trained(&self, trains: impl Fn(usize) -> bool) -> Vec<usize> {
        let counted = self.runs.counted.iter().enumerate();
        counted.filter(|(cell, counts)| **counts && trains(*cell)).map(|(cell, _)| cell).collect()
    }

    /// Returns the covariance of `cells` between `combination` and the print, with a model error.
    pub(super) fn covariance(
        &self,
        combination: &Combination,
        error: ModelError,
        cells: &[usize],
    ) -> Option<Covariance> {
        Covariance::of(cells.len(), |a, b| {
            self.sampling(combination, cells[a], cells[b]) + self.error(error, cells[a], cells[b])
        })
    }

    /// Makes all combinations ready for tables of whose cells `trains` says which are learned from.
    pub(super) fn prepared(&self, trains: impl Fn(usize) -> bool) -> Prepared {
        let cells = self.trained(trains);
        let one = |combination: &Combination, error: ModelError| {
            let expected: Vec<(usize, f64)> = cells
                .iter()
                .filter_map(|cell| Some((*cell, ln(combination.cells[*cell]?.mean))))
                .collect();
            let reached: Vec<usize> = expected.iter().map(|(cell, _)| *cell).collect();
            let missing = cells.iter().filter(|cell| combination.cells[**cell].is_none());
            let unreached = missing.map(|cell| {
                let variance = self.error(error, *cell, *cell) + self.printed(*cell, *cell);
                -0.5 * (UNREACHED * UNREACHED + ln(2.0 * std::f64::consts::PI * variance))
            });
            Likelihood {
                unreached: unreached.sum(),
                covariance: self.covariance(combination, error, &reached),
                expected,
            }
        };
        let errors = self.question.errors();
        let each = |combination: &Combination| {
            errors.iter().map(|error| one(combination, *error)).collect()
        };
        Prepared { each: self.runs.combinations.iter().map(each).collect() }
    }
}

impl Prepared {
    /// Computes the logarithm of the likelihood of a `table` of logarithms, by combination and model error.
    pub(super) fn ln_likelihoods(&self, table: &[f64]) -> Vec<Vec<f64>> {
        let one = |own: &Likelihood| {
            let off: Vec<f64> =
                own.expected.iter().map(|(cell, expected)| table[*cell] - expected).collect();
            let reached = own.covariance.as_ref().map(|covariance| covariance.ln_density(&off));
            own.unreached + reached.unwrap_or(f64::NEG_INFINITY)
        };
        self.each.iter().map(|errors| errors.iter().map(one).collect()).collect()
    }
}
