//! All combinations together: what the printed table says of the choices.

use super::FromTrials;
use super::likelihood::Model;
use super::runs::Combination;
use crate::condition::Condition;
use crate::math::{exp, ln};
use crate::stats::distribution::normal_cdf;
use crate::stats::importance::{effective_size, ln_mean_exp, weights};
use crate::stats::length;
use crate::studies::Findings;
use crate::studies::inference::HoldOut;

/// What follows from the trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer<'a> {
    pub(super) model: Model<'a>,
    /// By combination, then model error: logarithm of the likelihood of the printed table.
    pub(super) ln_likelihoods: Vec<Vec<f64>>,
    /// By combination and model error: the posterior probability.
    joint: Vec<Vec<f64>>,
}

/// A cell as the posterior predicts it, in the unit of its measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// The expectation.
    pub expected: f64,
    /// Between which means nine of ten tables would print.
    pub interval: [f64; 2],
    /// Probability of a mean at least as far out as the printed one, on its side, twice; at most 1.
    pub tail: f64,
    /// Least and largest mean of any combination.
    pub range: [f64; 2],
}

/// A part of the table that was held out: distances are of logarithms, root mean squares.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held<'a> {
    pub part: &'a HoldOut,
    pub cells: usize,
    pub rms: f64,
    pub constant: f64,
    pub means: Option<f64>,
    pub effective: f64,
}

impl<'a> Answer<'a> {
    /// Weighs the trials of `findings`; `None` where nothing is inferred from them, or no combination was run whole.
    pub fn of(findings: &Findings<'a>) -> Option<Self> {
        let question: &'a FromTrials = findings.from_trials?;
        let model = Model::new(findings, question);
        let counts = model.runs.counted.iter().any(|counts| *counts);
        (counts && !model.runs.combinations.is_empty()).then(|| Self::weighed(model))
    }

    fn weighed(model: Model<'a>) -> Self {
        let ln_likelihoods = model.prepared(|_| true).ln_likelihoods(&model.table());
        let joint = joint(&ln_likelihoods);
        Self { model, ln_likelihoods, joint }
    }

    /// Returns what is inferred.
    pub fn question(&self) -> &'a FromTrials {
        self.model.question
    }

    /// Returns the combinations.
    pub(super) fn combinations(&self) -> &[Combination] {
        &self.model.runs.combinations
    }

    /// Returns the posterior probability of every combination.
    pub(super) fn weights(&self) -> Vec<f64> {
        self.joint.iter().map(|errors| errors.iter().sum()).collect()
    }

    /// Returns the posterior probability of every model error.
    pub(super) fn errors(&self) -> Vec<f64> {
        let of = |error: usize| self.joint.iter().map(|errors| errors[error]).sum();
        (0..self.question().errors().len()).map(of).collect()
    }

    /// Returns the weights of combinations by each alternative of what cells have in common, with its probability.
    pub(super) fn by_shared_error(&self) -> Vec<(f64, Vec<f64>)> {
        let sizes = self.question().model_error.len();
        let part = |index: usize| {
            let own = index * sizes..(index + 1) * sizes;
            let alone: Vec<Vec<f64>> =
                self.ln_likelihoods.iter().map(|errors| errors[own.clone()].to_vec()).collect();
            let probability =
                self.joint.iter().map(|errors| errors[own.clone()].iter().sum::<f64>());
            (probability.sum(), Self::weights_by(&alone))
        };
        (0..self.question().errors().len() / sizes.max(1)).map(part).collect()
    }

    /// Returns the probability of every value of the choice `index`: before, and where combinations have the `weights`.
    pub(super) fn probabilities(&self, index: usize, weights: &[f64]) -> Vec<f64> {
        let of = |value: usize| {
            let own = self.combinations().iter().zip(weights);
            own.filter(|(own, _)| own.values[index] == value).map(|(_, weight)| weight).sum()
        };
        (0..self.question().choices[index].values.len()).map(of).collect()
    }

    /// Returns the weights that combinations had before: all the same.
    pub(super) fn before(&self) -> Vec<f64> {
        let combinations = self.combinations();
        vec![1.0 / length(combinations).max(1.0); combinations.len()]
    }

    /// Returns the weights of combinations by a table whose logarithms of likelihoods these are.
    pub(super) fn weights_by(ln_likelihoods: &[Vec<f64>]) -> Vec<f64> {
        joint(ln_likelihoods).iter().map(|errors| errors.iter().sum()).collect()
    }

    /// Returns the logarithm of the evidence: the likelihood averaged over combinations and model errors.
    pub(super) fn ln_evidence(ln_likelihoods: &[Vec<f64>]) -> f64 {
        ln_mean_exp(&ln_likelihoods.concat())
    }

    /// Returns how far `expected` logarithms are from those of `table`: the root mean square over those of `cells` that both have.
    pub(super) fn distance(
        cells: &[usize],
        table: &[f64],
        expected: impl Fn(usize) -> Option<f64>,
    ) -> f64 {
        let squares: Vec<f64> = cells
            .iter()
            .filter_map(|cell| {
                let off = table[*cell] - expected(*cell)?;
                Some(off * off)
            })
            .collect();
        (squares.iter().sum::<f64>() / length(&squares)).sqrt()
    }

    /// Returns how far each combination is from the print.
    pub(super) fn distances(&self) -> Vec<f64> {
        let (cells, table) = (self.model.trained(|_| true), self.model.table());
        let of = |own: &Combination| Self::distance(&cells, &table, |cell| own.ln_mean(cell));
        self.combinations().iter().map(of).collect()
    }

    /// Returns what is expected of a cell, as a logarithm, where combinations have the `weights`; `None` where none came to it.
    pub(super) fn expected(&self, cell: usize, weights: &[f64]) -> Option<f64> {
        let (mut sum, mut all) = (0.0, 0.0);
        for (own, weight) in self.combinations().iter().zip(weights) {
            if let Some(mean) = own.ln_mean(cell) {
                sum += weight * mean;
                all += weight;
            }
        }
        (all > 0.0).then(|| sum / all)
    }

    /// Returns how every cell is predicted; `None` where no combination that the posterior believes in came to it, or it was not run.
    pub fn cells(&self) -> Vec<Option<Predicted>> {
        (0..self.question().observed.cells.len()).map(|cell| self.predicted(cell)).collect()
    }

    fn predicted(&self, cell: usize) -> Option<Predicted> {
        // A mixture of normal distributions of logarithms.
        let mut parts: Vec<(f64, f64, f64)> = Vec::new();
        let all_errors = self.question().errors();
        for (own, errors) in self.combinations().iter().zip(&self.joint) {
            let Some(mean) = own.ln_mean(cell) else { continue };
            let sampling = self.model.sampling(own, cell, cell);
            for (weight, error) in errors.iter().zip(&all_errors) {
                let variance = sampling + self.model.error(*error, cell, cell);
                parts.push((*weight, mean, variance.sqrt()));
            }
        }
        let all: f64 = parts.iter().map(|(weight, ..)| weight).sum();
        if all <= 0.0 {
            return None;
        }
        parts.retain(|(weight, ..)| *weight > all * 1e-9);
        let all: f64 = parts.iter().map(|(weight, ..)| weight).sum();
        let below = |at: f64| -> f64 {
            parts.iter().map(|(w, mean, sd)| w * normal_cdf((at - mean) / sd)).sum::<f64>() / all
        };
        let reach = |end: f64| {
            let ends = parts.iter().map(|(_, mean, sd)| mean + end * 6.0 * sd);
            if end < 0.0 {
                ends.fold(f64::INFINITY, f64::min)
            } else {
                ends.fold(f64::NEG_INFINITY, f64::max)
            }
        };
        let quantile = |share: f64| {
            let (mut low, mut high) = (reach(-1.0), reach(1.0));
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if below(middle) < share { low = middle } else { high = middle }
            }
            exp(0.5 * (low + high))
        };
        let below_printed = below(self.model.ln_printed(cell));
        let expected: f64 = parts.iter().map(|(weight, mean, _)| weight * exp(*mean)).sum();
        let means = || self.combinations().iter().filter_map(|own| own.cells[cell]);
        Some(Predicted {
            expected: expected / all,
            interval: [quantile(0.05), quantile(0.95)],
            tail: (2.0 * below_printed.min(1.0 - below_printed)).min(1.0),
            range: [
                means().map(|reached| reached.mean).fold(f64::INFINITY, f64::min),
                means().map(|reached| reached.mean).fold(f64::NEG_INFINITY, f64::max),
            ],
        })
    }

    /// Returns what the cells held out come to, part by part.
    pub(super) fn held_out(&self) -> Vec<Held<'a>> {
        let question = self.question();
        question.hold_outs.iter().skip(1).map(|part| self.held(part)).collect()
    }

    fn held(&self, part: &'a HoldOut) -> Held<'a> {
        let question = self.question();
        let observed = &question.observed;
        let table = self.model.table();
        let prepared = self.model.prepared(|cell| part.trains(observed, cell));
        let weights = Self::weights_by(&prepared.ln_likelihoods(&table));
        let cells = self.model.trained(|cell| part.tests(observed, cell));
        // What was not run is of no help to the guesses either.
        let run = |cell: usize| if self.model.runs.counted[cell] { table[cell] } else { f64::NAN };
        let guesses = part.guesses(observed, &question.baseline, run);
        let rms =
            |expected: &dyn Fn(usize) -> Option<f64>| Self::distance(&cells, &table, expected);
        Held {
            part,
            cells: cells.len(),
            rms: rms(&|cell| self.expected(cell, &weights)),
            constant: rms(&|_| guesses.constant),
            means: guesses.means.map(|means| rms(&|cell| means[cell])),
            effective: effective_size(&weights),
        }
    }

    /// Returns the combination `index` as a condition.
    pub(super) fn named(&self, index: usize) -> Condition {
        let choices = &self.question().choices;
        let values = &self.combinations()[index].values;
        choices
            .iter()
            .zip(values)
            .map(|(choice, value)| (choice.name.clone(), choice.values[*value].clone()))
            .collect()
    }
}

/// Halvings of an interval of some ten standard deviations: more tell nothing that a table shows.
const BISECTIONS: u32 = 48;

impl Combination {
    /// Returns the logarithm of its mean in a cell.
    pub(super) fn ln_mean(&self, cell: usize) -> Option<f64> {
        self.cells[cell].map(|reached| ln(reached.mean))
    }
}

/// Returns probabilities, all combinations and model errors being as likely before.
fn joint(ln_likelihoods: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let errors = ln_likelihoods.first().map_or(1, Vec::len).max(1);
    weights(&ln_likelihoods.concat()).chunks(errors).map(<[f64]>::to_vec).collect()
}
