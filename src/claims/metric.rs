//! What is measured: a share of outcomes or a column of numbers.

use std::fmt;

/// The outcomes that count as success: the goal reached (deadline study), the map explored (prior-map study).
pub const SUCCESS: [&str; 2] = ["reached", "explored"];

/// The outcome of a trial that the engine failed to run: no result of any kind.
pub const FAILED: &str = "panicked";

/// How the names of metrics begin that depend on the machine, not on the study.
pub const WALL_TIME: &str = "wall-time";

/// The metrics that a run measures of the machine, one value a trial (s): the whole trial, the mean over the
/// mind's choices of where to go, and the longest of these.
pub const WALL_TIME_COLUMNS: [&str; 3] =
    ["wall-time-s", "wall-time-s-per-selection", "wall-time-s-longest-selection"];

/// A metric of the trials table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Metric {
    /// `success`: share of trials whose outcome is in [`SUCCESS`].
    Success,
    /// `outcome:NAME`, `outcome:NAME|NAME`: share of trials with that outcome, or one of those.
    Outcome(Vec<String>),
    /// A numeric column by its name; empty where the run did not reach it.
    Measure(String),
}

impl Metric {
    /// The metric of this name.
    pub fn named(name: &str) -> Self {
        match name.strip_prefix("outcome:") {
            Some(outcomes) => Self::Outcome(outcomes.split('|').map(str::to_owned).collect()),
            None if name == "success" => Self::Success,
            None => Self::Measure(name.to_owned()),
        }
    }

    /// Whether this is a share of trials, so that tests on proportions apply.
    pub fn is_share(&self) -> bool {
        !matches!(self, Self::Measure(_))
    }

    /// Whether a trial of this `outcome` counts; `None` for measures.
    pub(crate) fn counts(&self, outcome: &str) -> Option<bool> {
        match self {
            Self::Success => Some(SUCCESS.contains(&outcome)),
            Self::Outcome(names) => Some(names.iter().any(|name| name == outcome)),
            Self::Measure(_) => None,
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Success => f.write_str("success"),
            Self::Outcome(names) => write!(f, "outcome:{}", names.join("|")),
            Self::Measure(name) => f.write_str(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for name in ["success", "outcome:collided", "outcome:late|stalled", "time-s"] {
            assert_eq!(Metric::named(name).to_string(), name);
        }
        assert_eq!(Metric::Success.counts("explored"), Some(true));
        assert_eq!(Metric::named("outcome:late").counts("reached"), Some(false));
        let either = Metric::named("outcome:late|stalled");
        assert_eq!(
            ["late", "stalled", "reached"].map(|o| either.counts(o)),
            [true, true, false].map(Some)
        );
        assert!(!Metric::named("time-s").is_share());
    }
}
