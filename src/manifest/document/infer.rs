//! `infer:` as written: the table that is to be explained, and what is not known.

use crate::manifest::choice::Ordered;
use crate::studies::FactorValue;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// What is to be inferred: from counts of outcomes, of which a study makes proposals, or from ordinary trials of every combination
/// of `choices`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum InferenceDoc {
    /// From trials.
    FromTrials(FromTrialsDoc),
    /// From counts.
    FromCounts(InferDoc),
}

impl InferenceDoc {
    /// Returns what is inferred from counts, where that is asked for.
    pub fn from_counts(&self) -> Option<&InferDoc> {
        match self {
            Self::FromCounts(doc) => Some(doc),
            Self::FromTrials(_) => None,
        }
    }

    /// Returns what is inferred from trials, where that is asked for.
    pub fn from_trials(&self) -> Option<&FromTrialsDoc> {
        match self {
            Self::FromTrials(doc) => Some(doc),
            Self::FromCounts(_) => None,
        }
    }
}

/// What is to be inferred of factors, from trials of all their combinations and a table of means that the paper prints.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FromTrialsDoc {
    /// The settings that are not known: factors. All combinations of their values are as likely before.
    #[schemars(extend("minProperties" = 1))]
    pub choices: Ordered<ChoiceDoc>,
    /// The table that is to be explained: measures of trials, each with the published numbers that are its means. Where those are by
    /// coverage, the measure is the one at that coverage: `distance-m` is `distance-m-at-70`.
    #[schemars(extend("minProperties" = 1))]
    pub observed: Ordered<String>,
    /// The factors that tell its arms apart: cells of one arm are of the same runs.
    #[schemars(length(min = 1))]
    pub by: Vec<String>,
    /// Cells that are left out of the likelihood, with the reason for it.
    #[serde(default)]
    pub left_out: Vec<LeftOutDoc>,
    /// What sampling does not explain of a cell and is its own: relative standard deviations, all as likely before.
    #[serde(default = "model_error")]
    #[schemars(length(min = 1, max = 20), inner(range(min = 0.001, max = 2.0)))]
    pub model_error: Vec<f64>,
    /// What it does not explain of all cells of an arm together, likewise.
    #[serde(default = "arm_error")]
    #[schemars(length(min = 1, max = 20), inner(range(min = 0.0, max = 2.0)))]
    pub arm_error: Vec<f64>,
    /// What it does not explain of all cells of the table together, likewise.
    #[serde(default = "table_error")]
    #[schemars(length(min = 1, max = 20), inner(range(min = 0.0, max = 2.0)))]
    pub table_error: Vec<f64>,
    /// Tables made by known combinations, to check the inference by, and as many replicates of the printed one.
    #[serde(default)]
    #[schemars(range(max = 1000))]
    pub simulated_tables: u32,
    /// Which parts of the table are held out in turn: `chequerboard`, `arm`, or a column of which one level is held out at a time.
    #[serde(default)]
    pub hold_out: Vec<String>,
    /// The columns by whose means a baseline predicts what is held out.
    #[serde(default)]
    pub baseline: Vec<String>,
}

/// A factor that is not known.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ChoiceDoc {
    /// The value that is the paper's own words.
    #[serde(default)]
    pub literal: Option<FactorValue>,
    /// Why it is not known.
    #[serde(default)]
    pub why: Option<String>,
}

/// What is to be inferred from which of the paper's tables.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InferDoc {
    /// The table that is to be explained: two outcomes of trials, each with the published numbers that say in what share (%) they
    /// end so. Every row says of how many (`n`).
    #[schemars(extend("minProperties" = 2, "maxProperties" = 2))]
    pub observed: Ordered<String>,
    /// Mean times of the trials that ended in the first outcome, which the table prints beside: learned from where this is given.
    #[serde(default)]
    pub times: Option<TimesDoc>,
    /// The columns that tell its cells apart; rows of different levels of the first are of different starts.
    #[schemars(length(min = 1))]
    pub by: Vec<String>,
    /// Cells that are left out of the likelihood, with the reason for it.
    #[serde(default)]
    pub left_out: Vec<LeftOutDoc>,
    /// What is thought of parameters before the table is looked at, by path as in `rules.frontier.ties`.
    pub priors: Ordered<ChoicePriorDoc>,
    /// How much the model is trusted: concentrations of the Dirichlet-multinomial, all as likely before.
    #[serde(default = "concentration")]
    #[schemars(length(min = 1), inner(range(min = 0.1, max = 1000.0)))]
    pub concentration: Vec<f64>,
    /// Trajectories behind each probability.
    #[serde(default = "walks")]
    #[schemars(range(min = 1, max = 1000))]
    pub walks: u32,
    /// Draws of the numbers that trajectories can be timed again by, in each round.
    #[serde(default = "points")]
    #[schemars(range(min = 1, max = 10_000))]
    pub points: u32,
    /// Rounds of such draws in each trial: each after the first is drawn near those that explain the table, and all are weighed by
    /// how likely they were to be drawn.
    #[serde(default = "rounds")]
    #[schemars(range(min = 1, max = 20))]
    pub rounds: u32,
    /// Posterior draws that each trial hands on.
    #[serde(default = "draws")]
    #[schemars(range(min = 1, max = 20))]
    pub draws: u32,
    /// Tables made by known draws, to check the inference by.
    #[serde(default)]
    #[schemars(range(max = 100))]
    pub simulated_tables: u32,
    /// Which parts of the table are held out in turn: `chequerboard`, or a column of which one level is held out at a time.
    #[serde(default)]
    pub hold_out: Vec<String>,
    /// The columns by whose means a baseline predicts what is held out.
    #[serde(default)]
    pub baseline: Vec<String>,
}

/// How mean times are learned from.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TimesDoc {
    /// The published numbers: the mean (s), and of how many trials (`n`).
    pub published: String,
    /// Relative error of an expected mean that no sampling explains: one for each concentration, in their order, for both say how
    /// far the model is trusted.
    #[schemars(length(min = 1), inner(range(min = 0.01, max = 2.0)))]
    pub model_error: Vec<f64>,
    /// Standard deviation of a single time, over the mean.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub scatter: f64,
    /// From how many times on a mean is learned from.
    #[serde(default = "at_least")]
    #[schemars(range(min = 1))]
    pub at_least: u32,
    /// Where these come from.
    #[serde(default)]
    pub why: Option<String>,
}

/// Cells that are left out.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct LeftOutDoc {
    /// Their values.
    #[serde(rename = "where")]
    #[schemars(extend("minProperties" = 1))]
    pub only: BTreeMap<String, FactorValue>,
    /// Why they are left out.
    #[schemars(length(min = 1))]
    pub why: String,
}

/// What is thought of one parameter: one of `values`, `uniform` and `log-uniform`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct ChoicePriorDoc {
    /// Several values, all as likely.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub values: Option<Vec<Value>>,
    /// A number between two.
    #[serde(default)]
    pub uniform: Option<[f64; 2]>,
    /// A number above 0 whose logarithm is uniform between those of two.
    #[serde(default)]
    pub log_uniform: Option<[f64; 2]>,
    /// The one of the values that is the paper's own words.
    #[serde(default)]
    pub literal: Option<Value>,
    /// Why it is not known.
    #[serde(default)]
    pub why: Option<String>,
}

fn model_error() -> Vec<f64> {
    vec![0.02, 0.05, 0.1, 0.15, 0.2, 0.3]
}

fn arm_error() -> Vec<f64> {
    vec![0.0, 0.1, 0.2, 0.3]
}

fn table_error() -> Vec<f64> {
    vec![0.0, 0.1, 0.2]
}

fn concentration() -> Vec<f64> {
    vec![6.0, 12.0, 24.0, 48.0]
}

fn at_least() -> u32 {
    8
}

fn walks() -> u32 {
    32
}

fn points() -> u32 {
    48
}

fn rounds() -> u32 {
    1
}

fn draws() -> u32 {
    4
}
