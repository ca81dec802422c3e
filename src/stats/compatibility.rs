//! Agreement of our results with the numbers a paper prints, by the strongest method that the printed numbers allow: a
//! reading aid beside tables, never a verdict.
//!
//! - Shares of known numbers of trials: Newcombe's 95 % interval of the difference, at both numbers.
//! - Means with a printed standard deviation and number of runs: the 95 % interval in which the mean of as many runs as
//!   ours of an exact replicate lies; the spread is the paper's alone.
//! - Everything else, including a printed deviation of an unknown number of runs: the relative difference, which knows
//!   no chance and says neither compatible nor not.

use super::agreement::prediction_half_width;
use super::proportion::{Proportion, newcombe};
use super::summary::Summary;
use super::{Interval, real};

/// Confidence of every interval here.
pub const CONFIDENCE: f64 = 0.95;

/// Our result in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ours {
    /// So many of so many trials.
    Share(Proportion),
    /// A mean over trials.
    Mean(Summary),
    /// A number that is neither.
    Bare(f64),
}

/// The paper's number for it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Printed {
    /// The number; shares in percent.
    pub value: f64,
    /// Its standard deviation over runs.
    pub sd: Option<f64>,
    /// The runs behind it.
    pub n: Option<u64>,
}

/// How the two were compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Method {
    /// Newcombe's interval of the difference of two shares.
    Newcombe,
    /// The paper's prediction interval for the mean of a replicate.
    PredictionInterval,
    /// The relative difference alone.
    RelativeDifference,
}

/// The nearness of a number without spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Band {
    /// Within 10 % of the printed value.
    Within10,
    /// Within 20 %.
    Within20,
    /// Farther away.
    Farther,
}

/// Why a cell has no comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Silence {
    /// The paper prints no number.
    #[default]
    NotPrinted,
    /// The design has no such condition.
    NotInDesign,
    /// The design has the condition; this run is partial and left it out.
    NotRun,
    /// There are trials, and none of them has the quantity.
    NotReached,
}

/// The limits of the interval of ours less the paper's, and the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// How it was computed: never the relative difference.
    pub method: Method,
    /// The interval of ours less the paper's (in the unit of the cell; for shares, percentage points).
    pub difference: Interval,
}

/// The agreement of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Agreement {
    /// The interval of the difference holds 0.
    Compatible(Evidence),
    /// It does not.
    Apart(Evidence),
    /// No spread available: nearness, and the relative difference (percent), which a printed 0 has none of.
    Near(Band, Option<f64>),
    /// Nothing to compare.
    Silent(Silence),
}

impl Default for Agreement {
    fn default() -> Self {
        Self::Silent(Silence::NotPrinted)
    }
}

/// Returns why a cell without a number of ours has none.
pub fn absence(is_in_design: bool, trials: u64) -> Silence {
    match (is_in_design, trials) {
        (_, 1..) => Silence::NotReached,
        (true, 0) => Silence::NotRun,
        (false, 0) => Silence::NotInDesign,
    }
}

impl Agreement {
    /// Compares our result, or the reason for its absence, with the paper's.
    pub fn between(ours: Result<Ours, Silence>, printed: Option<Printed>) -> Self {
        let ours = match ours {
            Ok(ours) => ours,
            Err(silence) => return Self::Silent(silence),
        };
        let Some(printed) = printed.filter(|printed| printed.value.is_finite()) else {
            return Self::Silent(Silence::NotPrinted);
        };
        let by = |method, low: f64, high: f64| {
            let difference = Interval { low, high, confidence: CONFIDENCE };
            let evidence = Evidence { method, difference };
            let holds_zero = low <= 0.0 && 0.0 <= high;
            if holds_zero { Self::Compatible(evidence) } else { Self::Apart(evidence) }
        };
        match (ours, printed) {
            (Ours::Share(ours), Printed { value, n: Some(n), .. })
                if ours.trials > 0 && n > 0 && (0.0..=100.0).contains(&value) =>
            {
                let between = newcombe(ours, printed_share(value, n), CONFIDENCE);
                by(Method::Newcombe, 100.0 * between.low, 100.0 * between.high)
            }
            (Ours::Mean(ours), Printed { value, sd: Some(sd), n: Some(n) })
                if n > 1 && sd > 0.0 =>
            {
                let half =
                    prediction_half_width(Summary { n, mean: value, sd }, ours.n, CONFIDENCE);
                let difference = ours.mean - value;
                by(Method::PredictionInterval, difference - half, difference + half)
            }
            (Ours::Share(ours), _) => near(100.0 * ours.share(), printed.value),
            (Ours::Mean(ours), _) => near(ours.mean, printed.value),
            (Ours::Bare(ours), _) => near(ours, printed.value),
        }
    }

    /// Returns the method that was used; `None` where nothing was compared.
    pub fn method(self) -> Option<Method> {
        match self {
            Self::Compatible(evidence) | Self::Apart(evidence) => Some(evidence.method),
            Self::Near(..) => Some(Method::RelativeDifference),
            Self::Silent(_) => None,
        }
    }

    /// Returns the interval of ours less the paper's, where there is one.
    pub fn difference(self) -> Option<Interval> {
        match self {
            Self::Compatible(evidence) | Self::Apart(evidence) => Some(evidence.difference),
            Self::Near(..) | Self::Silent(_) => None,
        }
    }

    /// Returns the relative difference (percent of the printed value), where that is the method.
    pub fn relative_percent(self) -> Option<f64> {
        if let Self::Near(_, percent) = self { percent } else { None }
    }

    /// Returns the mark beside a cell: a shape, so that colour adds nothing needed; empty where nothing is compared.
    pub fn mark(self) -> &'static str {
        match self {
            Self::Compatible(_) => "\u{2713}",
            Self::Apart(_) => "\u{2260}",
            Self::Near(Band::Within10, _) => "\u{2248}",
            Self::Near(Band::Within20, _) => "~",
            Self::Near(Band::Farther, _) => "\u{2249}",
            Self::Silent(_) => "",
        }
    }

    /// Returns its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compatible(_) => "compatible",
            Self::Apart(_) => "apart",
            Self::Near(Band::Within10, _) => "within-10-percent",
            Self::Near(Band::Within20, _) => "within-20-percent",
            Self::Near(Band::Farther, _) => "farther",
            Self::Silent(Silence::NotPrinted) => "not-printed",
            Self::Silent(Silence::NotInDesign) => "not-in-design",
            Self::Silent(Silence::NotRun) => "not-run",
            Self::Silent(Silence::NotReached) => "not-reached",
        }
    }

    /// Every name, in this order.
    pub const NAMES: [&'static str; 9] = [
        "compatible",
        "apart",
        "within-10-percent",
        "within-20-percent",
        "farther",
        "not-printed",
        "not-in-design",
        "not-run",
        "not-reached",
    ];

    /// Returns the mark in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Compatible(_) => "compatible at 95 %",
            Self::Apart(_) => "not compatible at 95 %",
            Self::Near(Band::Within10, _) => "within 10 % of it",
            Self::Near(Band::Within20, _) => "within 20 % of it",
            Self::Near(Band::Farther, _) => "farther than 20 % from it",
            Self::Silent(silence) => silence.words(),
        }
    }
}

impl Silence {
    /// Returns the reason in words, as they stand in a cell.
    pub fn words(self) -> &'static str {
        match self {
            Self::NotPrinted => "not printed",
            Self::NotInDesign => "not in the design",
            Self::NotRun => "not run",
            Self::NotReached => "not reached",
        }
    }
}

impl Method {
    /// All of them, the strongest first.
    pub const ALL: [Self; 3] = [Self::Newcombe, Self::PredictionInterval, Self::RelativeDifference];

    /// Returns its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Newcombe => "newcombe",
            Self::PredictionInterval => "prediction-interval",
            Self::RelativeDifference => "relative-difference",
        }
    }

    /// Returns what the marks mean by this method, in a clause.
    pub fn rule(self) -> &'static str {
        match self {
            Self::Newcombe => {
                "shares: \u{2713} compatible at 95 %, \u{2260} not, by Newcombe's interval of the difference at both numbers of \
                 trials"
            }
            Self::PredictionInterval => {
                "means: \u{2713} compatible at 95 %, \u{2260} not, by the interval that the paper's mean, sd and n predict for \
                 the mean of as many runs as ours"
            }
            Self::RelativeDifference => {
                "no sd or no n printed: \u{2248} within 10 % of the paper's, ~ within 20 %, \u{2249} farther, a relative \
                 difference and no test"
            }
        }
    }
}

/// Returns the rules of the methods that occur in `found`, in one sentence; `None` where nothing was compared.
pub fn rules(found: impl IntoIterator<Item = Agreement>) -> Option<String> {
    let used: Vec<Method> = found.into_iter().filter_map(Agreement::method).collect();
    let rules: Vec<&str> =
        Method::ALL.into_iter().filter(|m| used.contains(m)).map(Method::rule).collect();
    (!rules.is_empty()).then(|| rules.join("; "))
}

/// How many cells one method compared, by result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// The method: counts of different ones are never added.
    pub method: Method,
    /// Compatible, or within 10 %.
    pub good: usize,
    /// Within 20 %; none by an interval.
    pub fair: usize,
    /// Not compatible, or farther.
    pub bad: usize,
}

impl Tally {
    /// Counts the cells, one tally per method that occurs in `found`.
    pub fn of(found: &[Agreement]) -> Vec<Self> {
        let tally = |method: Method| {
            let by = || found.iter().filter(|agreement| agreement.method() == Some(method));
            let count = |wanted: fn(&Agreement) -> bool| by().filter(|a| wanted(a)).count();
            Self {
                method,
                good: count(|a| {
                    matches!(a, Agreement::Compatible(_) | Agreement::Near(Band::Within10, _))
                }),
                fair: count(|a| matches!(a, Agreement::Near(Band::Within20, _))),
                bad: count(|a| {
                    matches!(a, Agreement::Apart(_) | Agreement::Near(Band::Farther, _))
                }),
            }
        };
        Method::ALL.into_iter().map(tally).filter(|tally| tally.all() > 0).collect()
    }

    /// Returns the number of cells that the method compared.
    pub fn all(self) -> usize {
        self.good + self.fair + self.bad
    }

    /// Says it in a sentence, for example `118 of 180 published percentages are compatible with ours at 95 %`.
    pub fn in_words(self) -> String {
        let (good, all) = (self.good, self.all());
        let are = if good == 1 { "is" } else { "are" };
        match self.method {
            Method::Newcombe => {
                format!("{good} of {all} published percentages {are} compatible with ours at 95 %")
            }
            Method::PredictionInterval => {
                format!("{good} of {all} published means {are} compatible with ours at 95 %")
            }
            Method::RelativeDifference => format!(
                "of {all} published numbers without spread ours lies within 10 % of {good}, within 20 % of {} more, farther \
                 from {}",
                self.fair, self.bad
            ),
        }
    }
}

/// Converts a printed percentage of `n` trials to a count of them: the nearest there is.
pub fn printed_share(percent: f64, n: u64) -> Proportion {
    let hits = (percent.clamp(0.0, 100.0) / 100.0 * real(n)).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to n")]
    let hits = hits as u64;
    Proportion::new(hits, n)
}

fn near(ours: f64, printed: f64) -> Agreement {
    let distance = (ours - printed).abs();
    // Decimal numbers that lie exactly on a limit are within it.
    let within = |part: f64| distance <= part * printed.abs() * (1.0 + 1e-12);
    let closeness = if within(0.1) {
        Band::Within10
    } else if within(0.2) {
        Band::Within20
    } else {
        Band::Farther
    };
    let relative = (printed != 0.0).then(|| 100.0 * (ours - printed) / printed.abs());
    Agreement::Near(closeness, relative)
}

#[cfg(test)]
mod tests;
