//! Parts of the table that are held out, so that what is inferred from the rest can be held against them.

use super::Cells;
use crate::stats::length;
use serde::Serialize;

/// One part.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct HoldOut {
    /// What kind of part: `chequerboard`, or the factor of which one level is held out; empty for the first, which holds out
    /// nothing.
    pub kind: String,
    /// Which part of that kind, in words.
    pub name: String,
    /// For every cell, whether it is held out.
    pub held: Vec<bool>,
}

impl HoldOut {
    /// The name of the hold-out by every second cell.
    pub const CHEQUERBOARD: &str = "chequerboard";

    /// Returns the one that holds out nothing.
    pub fn nothing(observed: &impl Cells) -> Self {
        let held = vec![false; observed.count()];
        Self { kind: String::new(), name: "everything".to_owned(), held }
    }

    /// Returns both halves of a chequerboard: cells by whether the sum of the ranks of their levels is even.
    pub fn chequerboard(observed: &impl Cells) -> Vec<Self> {
        let mut sums = vec![0; observed.count()];
        for factor in 0..observed.factors().len() {
            for (sum, rank) in sums.iter_mut().zip(observed.ranks(factor)) {
                *sum += rank;
            }
        }
        let half = |odd: usize, name: &str| Self {
            kind: Self::CHEQUERBOARD.to_owned(),
            name: name.to_owned(),
            held: sums.iter().map(|sum| sum % 2 == odd).collect(),
        };
        vec![half(0, "even cells"), half(1, "odd cells")]
    }

    /// Returns one part for every level of `factor`, by rank where its levels differ from one level of the first factor to the
    /// next.
    pub fn levels_of(observed: &impl Cells, factor: usize) -> Vec<Self> {
        let ranks = observed.ranks(factor);
        let levels = observed.levels(factor);
        let most = ranks.iter().max().map_or(0, |most| most + 1);
        let name = &observed.factors()[factor];
        let part = |rank: usize| Self {
            kind: name.clone(),
            name: if most == levels.len() {
                levels[rank].to_owned()
            } else {
                format!("{name} {}", rank + 1)
            },
            held: ranks.iter().map(|own| *own == rank).collect(),
        };
        (0..most).map(part).collect()
    }

    /// Returns whether the cell `index` of `observed` is learned from.
    pub fn trains(&self, observed: &impl Cells, index: usize) -> bool {
        !self.held[index] && !observed.is_left_out(index)
    }

    /// Returns whether what is learned is held against the cell `index` of `observed`.
    pub fn tests(&self, observed: &impl Cells, index: usize) -> bool {
        self.held[index] && !observed.is_left_out(index)
    }

    /// Returns what somebody would predict of the cells who knows no more than the `printed` values of those that are learned from.
    pub fn guesses(
        &self,
        observed: &impl Cells,
        baseline: &[String],
        printed: impl Fn(usize) -> f64,
    ) -> Guesses {
        let cells = observed.count();
        let trained: Vec<usize> = (0..cells).filter(|cell| self.trains(observed, *cell)).collect();
        let mean = |like: &dyn Fn(usize) -> bool| {
            let values: Vec<f64> =
                trained.iter().filter(|cell| like(**cell)).map(|cell| printed(*cell)).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / length(&values))
        };
        let factors: Vec<usize> =
            baseline.iter().filter_map(|name| observed.factor(name)).collect();
        let alike = |cell: usize, other: usize| {
            let same = |f: &usize| observed.levels_at(other)[*f] == observed.levels_at(cell)[*f];
            factors.iter().all(same)
        };
        let means: Vec<Option<f64>> =
            (0..cells).map(|cell| mean(&|other| alike(cell, other))).collect();
        let known =
            (0..cells).filter(|cell| self.tests(observed, *cell)).all(|c| means[c].is_some());
        Guesses {
            constant: mean(&|_| true),
            means: (known && !factors.is_empty()).then_some(means),
        }
    }
}

/// What predictions of cells that are held out stand beside.
#[derive(Debug, Clone, PartialEq)]
pub struct Guesses {
    /// The mean of the cells that are learned from.
    pub constant: Option<f64>,
    /// By cell: the mean of those of them that share its levels of the baseline's factors; `None` where some cell has none.
    pub means: Option<Vec<Option<f64>>>,
}
