//! The tables of an inference from trials, which every manifest has that makes one.

use crate::studies::{TableLayout, TableRequest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What an inference from trials found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FromTrialsTable {
    /// Which part of it.
    pub show: Part,
}

/// A part of what an inference from trials found.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// How the posterior fits, what it is worth, and where the prior was.
    Summary,
    /// The odds of every value of a choice.
    Choices,
    /// The combinations of choices by their weights.
    Combinations,
    /// Every cell: printed, expected, and how surprising.
    Cells,
    /// What is predicted of cells that were held out.
    HeldOut,
    /// How often the truth is found in tables that known combinations made.
    Simulated,
    /// What an exact replicate of the paper's experiment would give.
    Replicate,
}

impl Part {
    /// All, in the order in which they are printed.
    pub const ALL: [(Self, &str, &str); 7] = [
        (
            Self::Summary,
            "summary",
            "How well the settings explain the table, and what that is worth",
        ),
        (Self::Choices, "choices", "Odds of the settings that the paper leaves open"),
        (Self::Combinations, "combinations", "Combinations of settings by their weight"),
        (Self::Cells, "cells", "Every cell: printed, expected and how surprising"),
        (Self::HeldOut, "held-out", "Cells predicted from the others"),
        (Self::Simulated, "simulated", "The same inference of tables made by known combinations"),
        (Self::Replicate, "replicate", "What an exact replicate of the printed table would give"),
    ];

    /// Returns the requests of all of them.
    pub fn requests() -> Vec<TableRequest> {
        let request = |(show, id, title): (Self, &str, &str)| TableRequest {
            id: id.to_owned(),
            title: title.to_owned(),
            layout: TableLayout::FromTrialsTable(FromTrialsTable { show }),
        };
        Self::ALL.map(request).to_vec()
    }
}
