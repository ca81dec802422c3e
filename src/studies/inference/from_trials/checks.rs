//! What an inference from trials is worth: tables that known combinations made, replicates of the printed table, and where the
//! printed table lies among those that were thought possible before.

use super::posterior::Answer;
use super::runs::Combination;
use crate::rng::Seeds;
use crate::stats::importance::ln_mean_exp;
use crate::stats::multinormal::Covariance;
use crate::stats::{length, real};

/// What of the posterior's probability the most likely values are taken for that are held to contain the truth.
pub(super) const REGION: f64 = 0.9;

/// A table that a known combination made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Made {
    /// The combination.
    pub truth: usize,
    /// Its logarithms, cell by cell.
    pub table: Vec<f64>,
    /// What each combination is worth by it.
    pub weights: Vec<f64>,
}

/// How well a choice, or the whole combination, was found in tables of which the truth is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// The factor; `None` for the whole combination.
    pub choice: Option<usize>,
    /// Share of the tables by which the truth is the most likely value.
    pub likeliest: f64,
    /// Mean probability of the most likely value: the same where all is well.
    pub promised: f64,
    /// Share of the tables whose region of 90 % has the truth.
    pub covered: f64,
    /// Mean number of values in that region.
    pub region: f64,
    /// Share that a guess would find.
    pub by_chance: f64,
}

/// Replicates of the printed table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Replicates {
    /// Logarithm of the evidence for our combinations together, by replicate of the table.
    pub ln_evidence: Vec<f64>,
    /// By choice, then value, then replicate: its probability.
    pub probabilities: Vec<Vec<Vec<f64>>>,
    /// Logarithm of the evidence for a laboratory that repeats the paper's experiment exactly, with as many runs as ours, in the
    /// place of our runs; by draw.
    pub ln_exact: Vec<f64>,
}

impl Answer<'_> {
    /// Makes tables by known combinations that came to every cell, each with its sampling and a model error, and infers from them.
    pub(super) fn simulated(&self) -> Vec<Made> {
        let cells = self.model.trained(|_| true);
        let came = |own: &Combination| cells.iter().all(|cell| own.cells[*cell].is_some());
        let whole: Vec<usize> = self
            .combinations()
            .iter()
            .enumerate()
            .filter(|(_, own)| came(own))
            .map(|(index, _)| index)
            .collect();
        if whole.is_empty() {
            return Vec::new();
        }
        let prepared = self.model.prepared(|_| true);
        let errors = self.question().errors();
        let one = |number: u32| {
            let coordinates = vec![("simulated-table".to_owned(), number.to_string())];
            let mut stream = Seeds::new(0, coordinates).stream("inference-from-trials/simulated");
            let truth = whole[pick(stream.below(length_of(&whole)))];
            let error = errors[pick(stream.below(length_of(&errors)))];
            let own = &self.combinations()[truth];
            let mut table = self.model.table();
            let off = self.model.covariance(own, error, &cells)?.draw(&mut stream);
            for (cell, off) in cells.iter().zip(off) {
                table[*cell] = own.ln_mean(*cell)? + off;
            }
            let weights = Self::weights_by(&prepared.ln_likelihoods(&table));
            Some(Made { truth, table, weights })
        };
        (0..self.question().simulated_tables).filter_map(one).collect()
    }

    /// Returns how well each choice was found in `made`, and at last the whole combination.
    pub(super) fn found(&self, made: &[Made]) -> Vec<Found> {
        let choices = 0..self.question().choices.len();
        let mut found: Vec<Found> = choices
            .map(|choice| {
                let judged = made.iter().map(|own| {
                    let truth = self.combinations()[own.truth].values[choice];
                    (truth, self.probabilities(choice, &own.weights))
                });
                let before = self.probabilities(choice, &self.before());
                Found { choice: Some(choice), ..judge(judged, &before) }
            })
            .collect();
        let judged = made.iter().map(|own| (own.truth, own.weights.clone()));
        found.push(judge(judged, &self.before()));
        found
    }

    /// Returns the share of the tables `made` by what was thought possible before that are farther from it than the printed one is;
    /// NaN where there are none.
    pub(super) fn prior_tail(&self, made: &[Made]) -> f64 {
        let cells = self.model.trained(|_| true);
        let distance = |table: &[f64]| {
            let of = |own: &Combination| Self::distance(&cells, table, |cell| own.ln_mean(cell));
            self.combinations().iter().map(of).sum::<f64>() / length(self.combinations())
        };
        let own = distance(&self.model.table());
        let farther = made.iter().filter(|made| distance(&made.table) >= own).count();
        real(farther as u64) / length(made)
    }

    /// Draws replicates of the printed table by its own sampling, and of the paper's runs in the place of ours.
    pub(super) fn replicates(&self) -> Replicates {
        let model = &self.model;
        let cells = model.trained(|_| true);
        let printed = model.table();
        // Nothing but sampling tells a replicate from the print; a hair keeps the factor where a printed spread is 0.
        let hair = |a: usize, b: usize| if a == b { 1e-12 } else { 0.0 };
        let sampling =
            Covariance::of(cells.len(), |a, b| model.printed(cells[a], cells[b]) + hair(a, b));
        let reached = self.combinations().iter().flat_map(|own| own.cells.iter().flatten());
        let runs = reached.map(|reached| reached.n).max().unwrap_or_default();
        let of_both = |a: usize, b: usize| {
            let more = (model.as_many(cells[a], runs) * model.as_many(cells[b], runs)).sqrt();
            model.printed(cells[a], cells[b]) * (1.0 + more) + hair(a, b)
        };
        let exact = Covariance::of(cells.len(), of_both);
        let with_error: Vec<Option<Covariance>> = self
            .question()
            .errors()
            .iter()
            .map(|error| {
                Covariance::of(cells.len(), |a, b| {
                    of_both(a, b) + model.error(*error, cells[a], cells[b])
                })
            })
            .collect();
        let prepared = model.prepared(|_| true);
        let choices = &self.question().choices;
        let mut found = Replicates {
            ln_evidence: Vec::new(),
            probabilities: choices.iter().map(|own| vec![Vec::new(); own.values.len()]).collect(),
            ln_exact: Vec::new(),
        };
        let (Some(sampling), Some(exact)) = (sampling, exact) else { return found };
        for number in 0..self.question().simulated_tables {
            let coordinates = vec![("replicate".to_owned(), number.to_string())];
            let mut stream = Seeds::new(0, coordinates).stream("inference-from-trials/replicate");
            let mut table = printed.clone();
            for (cell, off) in cells.iter().zip(sampling.draw(&mut stream)) {
                table[*cell] += off;
            }
            let ln_likelihoods = prepared.ln_likelihoods(&table);
            found.ln_evidence.push(Self::ln_evidence(&ln_likelihoods));
            let weights = Self::weights_by(&ln_likelihoods);
            for (choice, values) in found.probabilities.iter_mut().enumerate() {
                for (value, share) in values.iter_mut().zip(self.probabilities(choice, &weights)) {
                    value.push(share);
                }
            }
            let off = exact.draw(&mut stream);
            let by_error: Vec<f64> =
                with_error.iter().flatten().map(|own| own.ln_density(&off)).collect();
            found.ln_exact.push(ln_mean_exp(&by_error));
        }
        found
    }
}

#[expect(clippy::cast_possible_truncation, reason = "an index below a length")]
fn pick(index: u64) -> usize {
    index as usize
}

fn length_of<T>(of: &[T]) -> u64 {
    of.len() as u64
}

/// Returns the most likely of `values`: the first of equals.
pub(super) fn likeliest(values: &[f64]) -> usize {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    values.iter().position(|value| *value >= most).unwrap_or_default()
}

/// Judges probabilities by the truths beside them.
fn judge(judged: impl Iterator<Item = (usize, Vec<f64>)>, before: &[f64]) -> Found {
    let (mut right, mut promised, mut covered, mut region, mut all) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (truth, after) in judged {
        let best = likeliest(&after);
        let mut order: Vec<usize> = (0..after.len()).collect();
        order.sort_by(|a, b| after[*b].total_cmp(&after[*a]));
        let mut sum = 0.0;
        let needed = order.iter().take_while(|value| {
            let more = sum < REGION;
            sum += after[**value];
            more
        });
        let needed: Vec<usize> = needed.copied().collect();
        right += f64::from(u8::from(best == truth));
        promised += after[best];
        covered += f64::from(u8::from(needed.contains(&truth)));
        region += length(&needed);
        all += 1.0;
    }
    let squares: f64 = before.iter().map(|share| share * share).sum();
    Found {
        choice: None,
        likeliest: right / all,
        promised: promised / all,
        covered: covered / all,
        region: region / all,
        by_chance: squares,
    }
}
