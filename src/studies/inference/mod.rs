//! What a paper leaves unsaid, inferred from a table that it prints: priors over declared choices, a likelihood of counts, and
//! proposals that a study makes of one building at a time.
//!
//! A trial of an inference is a proposal: everything that one building has to say, drawn from the prior, held against the
//! observed table ([`Proposal`]). It is recorded, stored and executed again like any trial; what is inferred follows from all of
//! them together ([`Posterior`]), like any table. How a study proposes is its own ([`Proposing`]).

mod cells;
mod columns;
pub mod from_trials;
mod hold_out;
mod likelihood;
mod measures;
mod observed;
mod picked;
mod posterior;
mod proposal;
mod requests;
mod rows;
mod setup;
mod tables;
mod times;
mod words;

pub use cells::Cells;
pub use hold_out::{Guesses, HoldOut};
pub use likelihood::{GRID, Likelihoods, Place};
pub use measures::{measure, of_draws};
pub use observed::{LeftOut, Observed, ObservedCell, Printed};
pub use picked::{InferenceDesign, PickedDraw, PickedPlace};
pub use posterior::Posterior;
pub use proposal::{Below, Drawn, Proposal};
pub use requests::{InferenceTable, Shown};
pub use setup::{InferenceSetup, Shared};
pub use times::Times;

use super::Setup;
use crate::math;
use crate::rng::{Seeds, Stream};
use serde::Serialize;
use serde_json::Value;

/// An inference with everything settled.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Inference {
    /// The table that is to be explained.
    pub observed: Observed,
    /// What is not known, in the order written.
    pub priors: Vec<Prior>,
    /// How mean times are learned from, where they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<Times>,
    /// How much the model is trusted: concentrations of the Dirichlet-multinomial, all as likely before.
    pub concentration: Vec<f64>,
    /// Trajectories behind each probability.
    pub walks: u32,
    /// Draws of what a trajectory can be timed again by, in each round of each trial.
    pub points: u32,
    /// Rounds of such draws: each after the first is drawn near those that explain the table.
    #[serde(skip_serializing_if = "is_one")]
    pub rounds: u32,
    /// Posterior draws that each trial hands on.
    pub draws: u32,
    /// Tables made by known draws, to check the inference by.
    pub simulated_tables: u32,
    /// Which parts of the table are held out in turn. The first holds out nothing.
    pub hold_outs: Vec<HoldOut>,
    /// Factors of the table by whose means a baseline predicts.
    pub baseline: Vec<String>,
}

/// A declared choice that is not known.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Prior {
    /// The parameter's path, without `parameters.`.
    pub path: String,
    /// What is thought of it before.
    pub distribution: Distribution,
    /// Which of several values is the paper's own words, where one is.
    pub literal: Option<usize>,
}

/// What is thought of a choice before the table is looked at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// One of several values, all as likely.
    Values(Vec<Value>),
    /// A number between two.
    Uniform([f64; 2]),
    /// A number whose logarithm is uniform between those of two.
    LogUniform([f64; 2]),
}

impl Prior {
    /// Returns the value at the place `share` of the prior, 0 to 1: the number, or the index of one of several values.
    pub fn at(&self, share: f64) -> f64 {
        match &self.distribution {
            Distribution::Values(values) => {
                let count = crate::stats::length(values);
                (share * count).floor().min(count - 1.0)
            }
            Distribution::Uniform([low, high]) => low + share * (high - low),
            Distribution::LogUniform([low, high]) => low * math::exp(share * math::ln(high / low)),
        }
    }

    /// Returns how the value `number` is written in a manifest.
    pub fn written(&self, number: f64) -> Value {
        match &self.distribution {
            Distribution::Values(values) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "an index, as `at` makes it"
                )]
                let index = number as usize;
                values.get(index).cloned().unwrap_or(Value::Null)
            }
            _ => number.into(),
        }
    }

    /// Returns the values, where there are several to choose from.
    pub fn values(&self) -> &[Value] {
        match &self.distribution {
            Distribution::Values(values) => values,
            _ => &[],
        }
    }

    /// Returns whether it is a number between two.
    pub fn is_continuous(&self) -> bool {
        !matches!(self.distribution, Distribution::Values(_))
    }
}

/// How a study proposes.
pub trait Proposing: Sync {
    /// Returns what it cannot infer of `inference` in a condition of this `setup`, in sentences, each with the path of the prior that
    /// it is about, where it is about one.
    fn refuses(&self, setup: &Setup, inference: &Inference) -> Vec<(Option<String>, String)>;

    /// Returns the names of what is placed in a building besides the priors: goal and starts.
    fn placements(&self, inference: &Inference) -> Vec<String>;

    /// Returns the name and the position (m) of the place `number` in the building of `setup`.
    fn place(&self, setup: &Setup, number: f64) -> Option<(String, [f64; 2])>;

    /// Returns whether the parameter of this `path` is about the model that proposes alone, so that no trial in physics has it.
    fn is_of_the_model(&self, path: &str) -> bool;

    /// Makes a draw of the prior in the building of `setup`, and what it predicts.
    ///
    /// # Errors
    /// Where the building admits none, in words.
    fn predict(&self, setup: &Setup, inference: &Inference, seeds: &Seeds)
    -> Result<Drawn, String>;

    /// Holds the building of `setup` against the tables of `likelihoods`, of which the first is the observed one and the others are
    /// made by the draws `truths`.
    ///
    /// # Errors
    /// Where the building admits nothing, in words.
    fn propose(
        &self,
        setup: &Setup,
        inference: &Inference,
        likelihoods: &Likelihoods,
        truths: &[Drawn],
        seeds: &Seeds,
    ) -> Result<Proposal, String>;
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands it over so")]
fn is_one(rounds: &u32) -> bool {
    *rounds == 1
}

/// Draws `count` places of each of `priors`, one in every of as many equal parts of it, in random order.
pub fn stratified(priors: usize, count: usize, stream: &mut Stream) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; priors]; count];
    for prior in 0..priors {
        let mut strata: Vec<usize> = (0..count).collect();
        stream.shuffle(&mut strata);
        for (point, stratum) in points.iter_mut().zip(strata) {
            let within = crate::stats::real(stratum as u64) + stream.uniform();
            point[prior] = within / crate::stats::real(count as u64);
        }
    }
    points
}

/// Returns the named `value` as it is shown.
pub(crate) fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests;
