//! What a study rests on and runs before it made: the passages of its calibration, the proposals of the inference whose draws it
//! runs, the runs behind its tables of robustness and of a multiverse. They are executed again like trials: a sample at level 4, all
//! passages and proposals at level 5, rows of these tables as many as asked.

use super::asked::{Options, Rows};
use super::{Level, Replanned, reexecution};
use crate::bundle::Fault;
use crate::rng::Seeds;
use serde::Serialize;

/// What was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Made {
    /// Isolated passages, from which the planner's expectations follow.
    Passages,
    /// Proposals of an inference, from which the draws follow that are run.
    Proposals,
    /// Verdicts at other values of the assumptions.
    Robustness,
    /// Verdicts at draws of all assumptions together.
    Multiverse,
}

impl Made {
    /// Returns the name of the table, where it is one whose rows are runs of the whole study; passages and proposals are judged like records.
    fn table(self) -> Option<&'static str> {
        match self {
            Self::Passages | Self::Proposals => None,
            Self::Robustness => Some("robustness table"),
            Self::Multiverse => Some("multiverse table"),
        }
    }
}

/// An input that runs before the study's own made, of units that can be executed again one by one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Earlier {
    /// What it is.
    pub made: Made,
    /// Where it is in the bag.
    pub path: String,
    /// How many trials each unit is.
    pub units: Vec<u64>,
}

/// What was executed again of one such input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct EarlierAgain {
    /// What it is.
    pub made: Made,
    /// Where it is in the bag.
    pub path: String,
    /// Units executed.
    pub executed: usize,
    /// Units that gave the same.
    pub equal: usize,
    /// Units there are.
    pub of: usize,
}

impl EarlierAgain {
    /// Says in words what it means.
    pub fn in_words(&self) -> String {
        let (executed, of, equal) = (self.executed, self.of, self.equal);
        let what = match (self.made, self.made.table()) {
            (Made::Proposals, _) => "proposals of the inference".to_owned(),
            (_, None) => "passages of the calibration".to_owned(),
            (_, Some(table)) => format!("rows of the {table}"),
        };
        if equal == executed && executed == of {
            format!("all {of} {what} gave the same again")
        } else if equal == executed {
            format!("{executed} of {of} {what} gave the same again")
        } else {
            format!(
                "{} of {executed} {what} gave something else than the bundle holds",
                executed - equal
            )
        }
    }
}

/// Rows of such a table that a level runs again where nothing is said.
const ROWS: [(Level, usize); 2] = [(Level::Sampled, 1), (Level::Full, 3)];

/// What executing some of an input again brought.
#[derive(Default)]
pub(super) struct Again {
    pub(super) executed: Option<EarlierAgain>,
    pub(super) faults: Vec<Fault>,
    /// Why nothing could be executed, through no fault of the bundle.
    pub(super) failure: Option<Fault>,
    /// What stays the author's word, in words.
    pub(super) on_trust: Option<String>,
}

impl Earlier {
    /// Says in words what is the author's word before anything is executed; passages and proposals are judged like records.
    pub(super) fn on_trust(&self) -> Option<String> {
        self.made.table().map(|table| format!("the {table} is the author's word"))
    }

    /// Returns the units that `level` executes again.
    pub(super) fn drawn(&self, level: Level, options: &Options) -> Vec<usize> {
        let of = self.units.len();
        let count = match (self.made.table(), level, options.rows) {
            (None, Level::Full, _) | (Some(_), _, Some(Rows::All)) => of,
            (None, ..) => options.sample.min(of),
            (Some(_), _, Some(Rows::Drawn(rows))) => rows.min(of),
            (Some(_), ..) => {
                let rows = ROWS.iter().find(|(of, _)| *of == level).map_or(0, |(_, rows)| *rows);
                rows.min(of)
            }
        };
        let label = match self.made {
            Made::Passages => "verify-passages",
            Made::Proposals => "verify-proposals",
            Made::Robustness => "verify-robustness",
            Made::Multiverse => "verify-multiverse",
        };
        Seeds::new(options.seed, Vec::new()).stream(label).places(count, of)
    }

    /// Executes at `level` what it takes of this, from `replanned`.
    pub(super) fn again(
        &self,
        replanned: &dyn Replanned,
        level: Level,
        options: &Options,
    ) -> Again {
        let (of, drawn) = (self.units.len(), self.drawn(level, options));
        if drawn.is_empty() {
            return Again { on_trust: self.on_trust(), ..Again::default() };
        }
        let compared = match replanned.make_again(self.made, &drawn) {
            Ok(compared) if compared.len() == drawn.len() => compared,
            other => {
                let found = match other {
                    Err(problem) => problem.to_string(),
                    Ok(fewer) => format!("{} of them", fewer.len()),
                };
                let expected = format!("{} executed again", drawn.len());
                let failure = Some(Fault::new(&self.path, expected, found));
                return Again { failure, on_trust: self.on_trust(), ..Again::default() };
            }
        };
        let faults: Vec<Fault> = compared.into_iter().flatten().collect();
        let equal = drawn.len() - faults.len();
        let on_trust = self.on_trust().filter(|_| drawn.len() < of);
        let on_trust =
            on_trust.map(|words| format!("{words} but for {} of its {of} rows", drawn.len()));
        let executed = EarlierAgain {
            made: self.made,
            path: self.path.clone(),
            executed: drawn.len(),
            equal,
            of,
        };
        Again {
            executed: Some(executed),
            faults: reexecution::capped(faults),
            failure: None,
            on_trust,
        }
    }
}
