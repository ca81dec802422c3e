//! One thing that differs, as plain data.

use crate::claims::Judgement;
use crate::digest::{FileDigest, Sha256Digest, TrialKey};
use crate::studies::CHAIN_STEP_S;
use serde::Serialize;
use serde_json::Value;

/// What stood there and what stands there; nothing where it is new or gone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change<T> {
    /// On the first side.
    pub from: Option<T>,
    /// On the second.
    pub to: Option<T>,
}

impl<T> Change<T> {
    /// Makes the change from one value to another.
    pub fn new(from: T, to: T) -> Self {
        Self { from: Some(from), to: Some(to) }
    }
}

/// Something that differs, from what could be a cause to what is an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "what", rename_all = "kebab-case")]
pub enum Discrepancy {
    /// An input file's bytes.
    Input {
        /// The path by which the study names it.
        path: String,
        /// Its digest.
        #[serde(flatten)]
        change: Change<FileDigest>,
    },
    /// The manifest's bytes.
    Manifest {
        /// Its digest.
        #[serde(flatten)]
        change: Change<FileDigest>,
    },
    /// The engine that ran the trials.
    Engine {
        /// Its version.
        #[serde(flatten)]
        change: Change<String>,
    },
    /// A value of the resolved study.
    Setting {
        /// Its path.
        path: String,
        /// The value.
        #[serde(flatten)]
        change: Change<Value>,
        /// The conditions it changed in; none for what holds for the whole study.
        conditions: Vec<String>,
        /// Whether it changed alike in every condition that both sides have.
        everywhere: bool,
    },
    /// A condition, or how many trials it has.
    Condition {
        /// Its slug.
        condition: String,
        /// Number of trials; nothing where there is no such condition.
        #[serde(flatten)]
        change: Change<usize>,
    },
    /// A trial.
    Trial(TrialDifference),
    /// The records of a condition as a whole, where a lock knows no more of them.
    Records {
        /// Its slug.
        condition: String,
        /// Digest of all its records.
        #[serde(flatten)]
        change: Change<Sha256Digest>,
    },
    /// A cell of a table.
    Cell {
        /// The table's path under `results/`.
        table: String,
        /// The row, by what names it, or its number.
        row: String,
        /// The column.
        column: String,
        /// What stands there.
        #[serde(flatten)]
        change: Change<String>,
    },
    /// A file under `results/` whose change no cell and no claim shows.
    File {
        /// Its path there.
        path: String,
        /// Its digest.
        #[serde(flatten)]
        change: Change<FileDigest>,
    },
    /// The verdict on a claim, or (with the verdict unchanged) the numbers that decided it.
    Claim {
        /// Its id.
        id: String,
        /// The verdict.
        #[serde(flatten)]
        change: Change<Judgement>,
    },
}

/// How a trial differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct TrialDifference {
    /// The slug of its condition.
    pub condition: String,
    /// Its number there.
    pub number: u32,
    /// Its key on both sides: equal where the very same trial gave other bytes.
    pub key: Change<TrialKey>,
    /// Digest of its record.
    pub sha256: Change<Sha256Digest>,
    /// Why it ended (and how), where that changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcome: Option<Change<String>>,
    /// Measures that changed, by name.
    pub measures: Vec<MeasureChange>,
    /// The first instant (s of simulated time) after which the states differ, by the hash chains.
    #[serde(rename = "diverges_after_s")]
    pub diverges_after: Option<f64>,
}

/// A measure that changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasureChange {
    /// Its name, with the unit.
    pub name: String,
    /// Its value.
    #[serde(flatten)]
    pub change: Change<f64>,
}

impl TrialDifference {
    /// Returns whether the same trial gave other bytes: what must never be.
    pub fn is_broken(&self) -> bool {
        self.key.from == self.key.to
    }

    /// Says where the states part.
    pub fn divergence(&self) -> String {
        match self.diverges_after {
            Some(after) => format!(
                "states first differ between {after} s and {} s of simulated time",
                after + CHAIN_STEP_S
            ),
            None => "the same states throughout".to_owned(),
        }
    }
}
