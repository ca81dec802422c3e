//! Parts of the table that are held out, so that what is inferred from the rest can be held against them.

use super::Observed;
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
    pub fn nothing(observed: &Observed) -> Self {
        let held = vec![false; observed.cells.len()];
        Self { kind: String::new(), name: "everything".to_owned(), held }
    }

    /// Returns both halves of a chequerboard: cells by whether the sum of the ranks of their levels is even.
    pub fn chequerboard(observed: &Observed) -> Vec<Self> {
        let mut sums = vec![0; observed.cells.len()];
        for factor in 0..observed.factors.len() {
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
    pub fn levels_of(observed: &Observed, factor: usize) -> Vec<Self> {
        let ranks = observed.ranks(factor);
        let levels = observed.levels(factor);
        let most = ranks.iter().max().map_or(0, |most| most + 1);
        let name = &observed.factors[factor];
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
    pub fn trains(&self, observed: &Observed, index: usize) -> bool {
        !self.held[index] && !observed.cells[index].left_out
    }

    /// Returns whether what is learned is held against the cell `index` of `observed`.
    pub fn tests(&self, observed: &Observed, index: usize) -> bool {
        self.held[index] && !observed.cells[index].left_out
    }
}
