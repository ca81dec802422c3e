//! The tables of an inference, which every manifest that infers has.

use crate::studies::{TableLayout, TableRequest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What an inference found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InferenceTable {
    /// Which part of it.
    pub show: Shown,
}

/// A part of what an inference found.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Shown {
    /// How the posterior fits, what it is worth, and where the prior was.
    Summary,
    /// The odds of every value of a choice.
    Choices,
    /// The quantiles of every number.
    Numbers,
    /// Every cell: printed, expected, and how surprising.
    Cells,
    /// The mean time of every cell: printed, expected, and how surprising.
    Times,
    /// What is predicted of cells that were held out.
    HeldOut,
    /// Where the truth lies among posteriors of simulated tables.
    Simulated,
    /// Draws of the posterior.
    Posterior,
}

impl Shown {
    /// All, in the order in which they are printed.
    pub const ALL: [(Self, &str, &str); 8] = [
        (Self::Summary, "summary", "How well the posterior fits, and what it is worth"),
        (Self::Choices, "choices", "Odds of what the paper leaves unsaid"),
        (Self::Numbers, "numbers", "Numbers that the paper leaves unsaid"),
        (Self::Cells, "cells", "Every cell: printed, expected and how surprising"),
        (Self::Times, "times", "Mean times: printed, expected and how surprising"),
        (Self::HeldOut, "held-out", "Cells predicted from the others"),
        (Self::Simulated, "simulated", "The same inference of tables made by known draws"),
        (Self::Posterior, "posterior", "Draws of the posterior"),
    ];

    /// Returns the requests of all of them, of times only where these are learned from.
    pub fn requests(with_times: bool) -> Vec<TableRequest> {
        let request = |(show, id, title): (Self, &str, &str)| TableRequest {
            id: id.to_owned(),
            title: title.to_owned(),
            layout: TableLayout::InferenceTable(InferenceTable { show }),
        };
        let asked = Self::ALL.into_iter().filter(|(show, ..)| with_times || *show != Self::Times);
        asked.map(request).collect()
    }
}
