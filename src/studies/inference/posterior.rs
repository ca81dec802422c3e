//! All proposals together: what the observed table says of what was not known.

use super::setup::draw_counts;
use super::{Drawn, HoldOut, Inference, InferenceSetup, ObservedCell, Proposal, Shared, Times};
use crate::condition::Condition;
use crate::rng::{Seeds, Stream};
use crate::stats::importance::{effective_size, ln_mean_exp, quantile, resample, weights};
use crate::stats::{length, real};
use crate::studies::{Entry, Findings, Setup};

/// Posterior draws that are kept.
pub(super) const DRAWS: u32 = 200;

/// Counts that are drawn for each of them, where a table is predicted.
const REPLICATES: usize = 5;

/// A building that was tried.
struct Tried<'a> {
    condition: &'a Condition,
    setup: &'a Setup,
    proposal: Proposal,
}

/// A posterior draw with its building.
pub struct Kept<'p> {
    /// The building.
    pub condition: &'p Condition,
    /// Its own setup.
    pub setup: &'p Setup,
    /// Weight of its trial among all.
    pub weight: f64,
    /// The draw.
    pub drawn: &'p Drawn,
}

/// What follows from all proposals.
pub struct Posterior<'a> {
    shared: &'a Shared,
    tried: Vec<Tried<'a>>,
    weights: Vec<f64>,
}

impl<'a> Posterior<'a> {
    /// Reads the proposals of `findings`; `None` where none is there, as in no other experiment.
    pub fn of(findings: &Findings<'a>) -> Option<Self> {
        let setups: Vec<(&Condition, &InferenceSetup)> = findings
            .design
            .iter()
            .filter_map(|(condition, setup)| Some((*condition, setup.of::<InferenceSetup>()?)))
            .collect();
        let (_, first) = setups.first()?;
        let shared: &'a Shared = first.shared();
        let quantities = shared.quantities().len();
        let tried = |trial: Entry<'a>| {
            let (_, setup) =
                setups.iter().find(|(condition, _)| **condition == *trial.condition())?;
            let proposal = Proposal::of(trial, &shared.inference, quantities)?;
            Some(Tried { condition: trial.condition(), setup: setup.own(), proposal })
        };
        let tried: Vec<Tried<'a>> = findings.ledger.entries().filter_map(tried).collect();
        let logarithms: Vec<f64> = tried.iter().map(|t| t.proposal.ln_evidence[0]).collect();
        (!tried.is_empty()).then(|| Self { shared, weights: weights(&logarithms), tried })
    }

    /// Returns what was inferred.
    pub fn inference(&self) -> &'a Inference {
        &self.shared.inference
    }

    /// Returns what all conditions share.
    pub fn shared(&self) -> &'a Shared {
        self.shared
    }

    /// Returns how many buildings were tried, the number that their weights are worth, and the largest weight.
    pub fn worth(&self) -> (usize, f64, f64) {
        let largest = self.weights.iter().copied().fold(0.0, f64::max);
        (self.tried.len(), effective_size(&self.weights), largest)
    }

    /// Returns the building of the largest weight.
    pub fn likeliest(&self) -> Option<&Condition> {
        let heaviest = self.weights.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        heaviest.map(|(index, _)| self.tried[index].condition)
    }

    /// Returns the logarithm of the observed table's likelihood averaged over the prior, relative to a model that expects just what
    /// was counted.
    pub fn ln_evidence(&self) -> f64 {
        let logarithms: Vec<f64> = self.tried.iter().map(|t| t.proposal.ln_evidence[0]).collect();
        ln_mean_exp(&logarithms)
    }

    /// Returns the posterior probability of every value of the prior `index`.
    pub fn probabilities(&self, index: usize) -> Vec<f64> {
        let values = self.inference().priors[index].values().len();
        let each = |value: usize| -> f64 {
            let logarithms: Vec<f64> =
                self.tried.iter().map(|t| t.proposal.by_value[index][value]).collect();
            ln_mean_exp(&logarithms)
        };
        weights(&(0..values).map(each).collect::<Vec<_>>())
    }

    /// Returns draws of the posterior, all of the same weight.
    pub fn draws(&self) -> Vec<Kept<'_>> {
        // Draws of one building are as likely as each other.
        let spread: Vec<(usize, usize)> = (0..self.tried.len())
            .flat_map(|t| (0..self.tried[t].proposal.draws.len()).map(move |d| (t, d)))
            .collect();
        let each: Vec<f64> = spread
            .iter()
            .map(|(t, _)| self.weights[*t] / length(&self.tried[*t].proposal.draws))
            .collect();
        let mut stream = Seeds::new(0, Vec::new()).stream("posterior");
        let places = resample(&each, DRAWS as usize, &mut stream);
        let kept = |place: usize| {
            let (t, d) = spread[place];
            let Tried { condition, setup, proposal } = &self.tried[t];
            let drawn = &proposal.draws[d];
            Kept { condition, setup, weight: self.weights[t], drawn }
        };
        if spread.is_empty() { Vec::new() } else { places.into_iter().map(kept).collect() }
    }

    /// Returns the draws of the prior.
    pub fn prior(&self) -> Vec<&Drawn> {
        self.tried.iter().flat_map(|t| &t.proposal.prior).collect()
    }

    /// Returns how far a draw's expectations are from the printed shares of the first outcome: the root mean square (points).
    pub fn distance(&self, drawn: &Drawn) -> f64 {
        let expected: Vec<f64> = drawn.cells.iter().map(|cell| 100.0 * cell[0]).collect();
        self.rmse(|index| Some(expected[index]), |index| !self.left_out(index))
    }

    fn left_out(&self, index: usize) -> bool {
        self.inference().observed.cells[index].left_out
    }

    /// Returns the root mean square of the printed share less the `expected` one (%), over the cells that `count`; NaN where there
    /// are none.
    fn rmse(&self, expected: impl Fn(usize) -> Option<f64>, counts: impl Fn(usize) -> bool) -> f64 {
        let cells = &self.inference().observed.cells;
        let squares: Vec<f64> = (0..cells.len())
            .filter(|index| counts(*index))
            .filter_map(|index| {
                let off = cells[index].percent() - expected(index)?;
                Some(off * off)
            })
            .collect();
        (squares.iter().sum::<f64>() / length(&squares)).sqrt()
    }

    /// Returns what each cell is expected to be, and how it scatters.
    pub fn cells(&self) -> Vec<Predicted> {
        let draws = self.draws();
        let inference = self.inference();
        let mut stream = Seeds::new(0, Vec::new()).stream("predicted");
        let cells = inference.observed.cells.iter().enumerate();
        cells.map(|(index, _)| Predicted::of(inference, index, &draws, &mut stream)).collect()
    }

    /// Returns what the mean time of each cell is expected to be, cell by cell: of those whose time is learned from.
    pub fn times(&self) -> Vec<(&'a ObservedCell, PredictedTime)> {
        let (draws, inference) = (self.draws(), self.inference());
        let Some(how) = &inference.times else { return Vec::new() };
        let mut stream = Seeds::new(0, Vec::new()).stream("predicted-times");
        let mut all = Vec::new();
        for (index, cell) in inference.observed.cells.iter().enumerate() {
            let Some(printed_s) = cell.time_s else { continue };
            all.push((cell, PredictedTime::of(how, index, cell, printed_s, &draws, &mut stream)));
        }
        all
    }

    /// Returns the distance of the posterior's expectations to the print (points), over all cells that are not left out.
    pub fn fit(&self) -> f64 {
        let cells = self.cells();
        self.rmse(|index| Some(cells[index].expected), |index| !self.left_out(index))
    }

    /// Returns what the cells held out come to, part by part.
    pub fn held_out(&self) -> Vec<Held> {
        let parts = self.inference().hold_outs.iter().enumerate().skip(1);
        parts.map(|(index, part)| self.held(index, part)).collect()
    }

    fn held(&self, index: usize, part: &HoldOut) -> Held {
        let observed = &self.inference().observed;
        let logarithms: Vec<f64> =
            self.tried.iter().map(|t| t.proposal.ln_evidence[index]).collect();
        let weights = weights(&logarithms);
        let mut expected = vec![0.0; observed.cells.len()];
        let mut weight = vec![0.0; observed.cells.len()];
        for (tried, own) in self.tried.iter().zip(&weights) {
            for (cell, share) in &tried.proposal.held[index - 1] {
                expected[*cell] += own * 100.0 * share;
                weight[*cell] += own;
            }
        }
        let tests = |cell: usize| part.tests(observed, cell);
        let printed = |cell: usize| observed.cells[cell].percent();
        let guesses = part.guesses(observed, &self.inference().baseline, printed);
        Held {
            kind: part.kind.clone(),
            name: part.name.clone(),
            cells: (0..observed.cells.len()).filter(|cell| tests(*cell)).count(),
            rmse: self
                .rmse(|cell| (weight[cell] > 0.0).then(|| expected[cell] / weight[cell]), tests),
            constant: self.rmse(|_| guesses.constant, tests),
            means: guesses.means.map(|means| self.rmse(|cell| means[cell], tests)),
            effective: effective_size(&weights),
        }
    }

    /// Returns for every continuous prior the ranks (0 to 1) of the truths among the posteriors of simulated tables.
    pub fn ranks(&self) -> Vec<(String, Vec<f64>)> {
        let inference = self.inference();
        let continuous = inference.priors.iter().filter(|prior| prior.is_continuous());
        let rank = |table: usize, prior: usize| {
            let of = |ln: &dyn Fn(&Proposal) -> f64| -> Vec<f64> {
                self.tried.iter().map(|t| ln(&t.proposal)).collect()
            };
            let all = ln_mean_exp(&of(&|p| p.simulated[table].ln_evidence));
            let below = ln_mean_exp(&of(&|p| p.simulated[table].below[prior]));
            crate::math::exp(below - all).min(1.0)
        };
        let tables = 0..inference.simulated_tables as usize;
        continuous
            .enumerate()
            .map(|(p, prior)| (prior.path.clone(), tables.clone().map(|t| rank(t, p)).collect()))
            .collect()
    }

    /// Returns the share of tables made by prior draws that are farther from the other prior draws than the observed one is, in the
    /// mean; NaN where there are too few.
    pub fn prior_tail(&self) -> f64 {
        let prior = self.prior();
        if prior.len() < 3 {
            return f64::NAN;
        }
        let observed = &self.inference().observed.cells;
        let counted: Vec<usize> =
            (0..observed.len()).filter(|cell| !observed[*cell].left_out).collect();
        let distance = |table: &dyn Fn(usize) -> f64, drawn: &Drawn| {
            let squares = counted.iter().map(|cell| {
                let off = table(*cell) - 100.0 * drawn.cells[*cell][0];
                off * off
            });
            (squares.sum::<f64>() / length(&counted)).sqrt()
        };
        let printed = |cell: usize| observed[cell].percent();
        let own: f64 =
            prior.iter().map(|drawn| distance(&printed, drawn)).sum::<f64>() / length(&prior);
        let mut stream = Seeds::new(0, Vec::new()).stream("prior-tables");
        let mut farther = 0_u64;
        for (index, maker) in prior.iter().enumerate() {
            let made: Vec<f64> = maker
                .cells
                .iter()
                .zip(observed)
                .map(|(expected, cell)| {
                    let counts = draw_counts(
                        *expected,
                        self.concentration(maker),
                        cell.trials(),
                        &mut stream,
                    );
                    100.0 * f64::from(counts[0]) / f64::from(cell.trials().max(1))
                })
                .collect();
            let others = prior.iter().enumerate().filter(|(other, _)| *other != index);
            let sum: f64 = others.map(|(_, drawn)| distance(&|cell| made[cell], drawn)).sum();
            farther += u64::from(sum / (length(&prior) - 1.0) >= own);
        }
        real(farther) / length(&prior)
    }

    fn concentration(&self, drawn: &Drawn) -> f64 {
        concentration(self.inference(), drawn)
    }
}

fn concentration(inference: &Inference, drawn: &Drawn) -> f64 {
    inference.concentration.get(drawn.trust()).copied().unwrap_or(1.0)
}

/// A cell as the posterior predicts it: shares of the first outcome (%).
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// The expectation.
    pub expected: f64,
    /// Between which shares nine of ten tables would lie.
    pub interval: [f64; 2],
    /// Probability of a share at least as far out as the printed one, on its side, twice; at most 1.
    pub tail: f64,
    /// Least and largest expectation of any posterior draw.
    pub range: [f64; 2],
}

impl Predicted {
    fn of(inference: &Inference, index: usize, draws: &[Kept<'_>], stream: &mut Stream) -> Self {
        let cell = &inference.observed.cells[index];
        let shares: Vec<f64> = draws.iter().map(|k| 100.0 * k.drawn.cells[index][0]).collect();
        let mut made = Vec::with_capacity(REPLICATES * draws.len());
        for kept in draws {
            for _ in 0..REPLICATES {
                let kappa = concentration(inference, kept.drawn);
                let counts = draw_counts(kept.drawn.cells[index], kappa, cell.trials(), stream);
                made.push(100.0 * f64::from(counts[0]) / f64::from(cell.trials().max(1)));
            }
        }
        let alike = vec![1.0; made.len()];
        Self {
            expected: shares.iter().sum::<f64>() / length(&shares).max(1.0),
            interval: [0.05, 0.95].map(|at| quantile(&made, &alike, at)),
            tail: two_sided(&made, cell.percent()),
            range: [
                shares.iter().copied().fold(f64::INFINITY, f64::min),
                shares.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ],
        }
    }
}

/// The mean time of a cell as the posterior predicts it (s).
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedTime {
    /// The median.
    pub expected: f64,
    /// Between which times nine of ten tables would lie.
    pub interval: [f64; 2],
    /// Probability of a time at least as far out as the printed one, on its side, twice; at most 1.
    pub tail: f64,
}

impl PredictedTime {
    fn of(
        how: &Times,
        index: usize,
        cell: &ObservedCell,
        printed_s: f64,
        draws: &[Kept<'_>],
        stream: &mut Stream,
    ) -> Self {
        let mut made = Vec::with_capacity(REPLICATES * draws.len());
        for kept in draws {
            let Some(expected_s) = kept.drawn.times.get(index).copied().flatten() else { continue };
            for _ in 0..REPLICATES {
                let trials = cell.counts[0].max(how.at_least);
                made.extend(how.draw(expected_s, trials, kept.drawn.trust(), stream));
            }
        }
        let alike = vec![1.0; made.len()];
        let at = |share| quantile(&made, &alike, share);
        Self {
            expected: at(0.5),
            interval: [0.05, 0.95].map(at),
            tail: two_sided(&made, printed_s),
        }
    }
}

/// Returns the share of `made` at least as far out as `printed`, on its side, twice; at most 1.
fn two_sided(made: &[f64], printed: f64) -> f64 {
    let share = |counts: &dyn Fn(f64) -> bool| {
        real(made.iter().filter(|made| counts(**made)).count() as u64) / length(made).max(1.0)
    };
    let (low, high) = (share(&|made| made <= printed), share(&|made| made >= printed));
    (2.0 * low.min(high)).min(1.0)
}

/// A part of the table that was held out.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// What kind of part.
    pub kind: String,
    /// Which.
    pub name: String,
    /// How many cells it has that are not left out.
    pub cells: usize,
    /// Distance of what is predicted to the print (points): by the inference from the other cells,
    pub rmse: f64,
    /// by their mean,
    pub constant: f64,
    /// and by their means of the baseline's factors; `None` where these do not tell.
    pub means: Option<f64>,
    /// The number of buildings that the weights are worth.
    pub effective: f64,
}
