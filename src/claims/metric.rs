//! What is measured: a share of outcomes or a column of numbers.

use std::fmt;

/// The outcomes that count as success: the goal reached (deadline study), the map explored (prior-map study).
pub const SUCCESS: [&str; 2] = ["reached", "explored"];

/// The outcome of a trial that the engine failed to run: no result of any kind.
pub const FAILED: &str = "panicked";

/// How the names of metrics begin that depend on the machine, not on the study.
pub const WALL_TIME: &str = "wall-time";

/// A metric of the trials table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Metric {
    /// `success`: share of trials whose outcome is in [`SUCCESS`].
    Success,
    /// `outcome:NAME`: share of trials with that outcome.
    Outcome(String),
    /// A numeric column by its name; empty where the run did not reach it.
    Measure(String),
}

impl Metric {
    /// The metric of this name.
    pub fn named(name: &str) -> Self {
        match name.strip_prefix("outcome:") {
            Some(outcome) => Self::Outcome(outcome.to_owned()),
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
            Self::Outcome(name) => Some(name == outcome),
            Self::Measure(_) => None,
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Success => f.write_str("success"),
            Self::Outcome(name) => write!(f, "outcome:{name}"),
            Self::Measure(name) => f.write_str(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for name in ["success", "outcome:collided", "time-s"] {
            assert_eq!(Metric::named(name).to_string(), name);
        }
        assert_eq!(Metric::Success.counts("explored"), Some(true));
        assert_eq!(Metric::named("outcome:late").counts("reached"), Some(false));
        assert!(!Metric::named("time-s").is_share());
    }
}
