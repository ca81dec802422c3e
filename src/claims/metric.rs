//! What is measured: a share of outcomes or a column of numbers.

use super::terms::PerRun;
use crate::math::ln;
use crate::stats::summary::mean;
use std::fmt;

/// The outcomes that count as success: the goal reached (deadline study), the map explored or as much of it as was asked for
/// (prior-map study).
pub const SUCCESS: [&str; 3] = ["reached", "explored", "covered"];

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
    /// Mean logarithm of several numeric columns; empty where the run did not reach all of them.
    MeanLog(Vec<String>),
    /// Logarithm of one numeric column over another; empty where the run did not reach both.
    LogRatio(String, String),
}

impl Metric {
    /// Returns the metric of this name.
    pub fn named(name: &str) -> Self {
        match name.strip_prefix("outcome:") {
            Some(outcomes) => Self::Outcome(outcomes.split('|').map(str::to_owned).collect()),
            None if name == "success" => Self::Success,
            None => Self::Measure(name.to_owned()),
        }
    }

    /// Returns whether this is a share of trials, so that tests on proportions apply.
    pub fn is_share(&self) -> bool {
        matches!(self, Self::Success | Self::Outcome(_))
    }

    /// Returns the metrics that a comparison of these columns is of: each on its own, or one of them all together.
    pub(crate) fn of_run(names: &[String], per_run: Option<PerRun>) -> Vec<Self> {
        match (per_run, names) {
            (Some(PerRun::MeanLog), _) => vec![Self::MeanLog(names.to_vec())],
            (Some(PerRun::LogRatio), [above, below, ..]) => {
                vec![Self::LogRatio(above.clone(), below.clone())]
            }
            _ => names.iter().map(|name| Self::named(name)).collect(),
        }
    }

    /// Returns the columns that the value of a run is made of; none for shares.
    pub(crate) fn columns(&self) -> Vec<&String> {
        match self {
            Self::Success | Self::Outcome(_) => Vec::new(),
            Self::Measure(name) => vec![name],
            Self::MeanLog(names) => names.iter().collect(),
            Self::LogRatio(above, below) => vec![above, below],
        }
    }

    /// Returns the value of a run whose columns hold `column`; none where one of them is empty or has no logarithm.
    pub(crate) fn of_columns(&self, column: impl Fn(&str) -> Option<f64>) -> Option<f64> {
        let log = |name: &String| column(name).filter(|x| *x > 0.0).map(ln);
        match self {
            Self::Success | Self::Outcome(_) => None,
            Self::Measure(name) => column(name),
            Self::MeanLog(names) => {
                let logs: Option<Vec<f64>> = names.iter().map(log).collect();
                logs.filter(|logs| !logs.is_empty()).map(|logs| mean(&logs))
            }
            Self::LogRatio(above, below) => Some(log(above)? - log(below)?),
        }
    }

    /// Returns whether a trial of this `outcome` counts; `None` for measures.
    pub(crate) fn counts(&self, outcome: &str) -> Option<bool> {
        match self {
            Self::Success => Some(SUCCESS.contains(&outcome)),
            Self::Outcome(names) => Some(names.iter().any(|name| name == outcome)),
            Self::Measure(_) | Self::MeanLog(_) | Self::LogRatio(..) => None,
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Success => f.write_str("success"),
            Self::Outcome(names) => write!(f, "outcome:{}", names.join("|")),
            Self::Measure(name) => f.write_str(name),
            Self::MeanLog(names) => write!(f, "mean log of {}", names.join(", ")),
            Self::LogRatio(above, below) => write!(f, "log of {above} over {below}"),
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

    #[test]
    fn a_run_counts_once_however_many_coverages_it_has() {
        let names = ["a".to_owned(), "b".to_owned()];
        let [mean] = &Metric::of_run(&names, Some(PerRun::MeanLog))[..] else { panic!("one") };
        let [ratio] = &Metric::of_run(&names, Some(PerRun::LogRatio))[..] else { panic!("one") };
        assert_eq!(Metric::of_run(&names, None).len(), 2);
        let run = |a: f64, b: Option<f64>| move |name: &str| if name == "a" { Some(a) } else { b };
        assert_eq!(mean.of_columns(run(1.0, Some(1.0))), Some(0.0));
        assert!((mean.of_columns(run(2.0, Some(8.0))).unwrap() - ln(4.0)).abs() < 1e-12);
        assert!((ratio.of_columns(run(2.0, Some(8.0))).unwrap() + ln(4.0)).abs() < 1e-12);
        for metric in [mean, ratio] {
            assert_eq!(metric.of_columns(run(2.0, None)), None, "a run that never got there");
            assert_eq!(metric.of_columns(run(2.0, Some(0.0))), None, "zero has no logarithm");
            assert!(!metric.is_share() && metric.columns() == [&names[0], &names[1]]);
        }
    }
}
