//! What a claim expects, as data. One example of each form:
//!
//! `less`, `greater`: one cell or pool against another, or against several one by one (`each`), repeated
//! over `for-each`. Tests: `fisher-exact`, `chi-square` (shares); `welch`, `anova`, `mann-whitney`,
//! `brown-forsythe` (measures).
//! ```yaml
//! id: D1
//! says: >-
//!   the random strategy is the most effective when starting from location A, except when the shortest
//!   deadline is enforced
//! paper-table: supports
//! expect:
//!   greater:
//!     metric: success
//!     where: {start: A, strategy: random}
//!     than: {where: {start: A, strategy: [frontier, normalized-frontier]}, each: [strategy]}
//!     for-each: {deadline-s: [680, 477, 272]}
//!     test: fisher-exact
//!     alpha: 0.01
//! ```
//! ```yaml
//! id: P1
//! says: >-
//!   The use of the floor plan ... allows to explore the environment travelling a significantly shorter
//!   distance
//! paper-table: supports
//! expect:
//!   less:
//!     metric: [distance-m-at-70, distance-m-at-80]
//!     where: {prior: floor-plan}
//!     than: {where: {prior: none}}
//!     for-each: {furnished: [true, false]}
//!     test: anova
//!     sides: two
//!     at-least: 3
//!     censored: reached-only
//! ```
//! `equivalent`: the difference of two cells lies inside a margin (two one-sided tests: Newcombe's interval
//! for shares, Welch's test for measures). A large p-value of a test for a difference is never taken for equality.
//! ```yaml
//! id: D4
//! says: >-
//!   as the deadline becomes more stringent its advantage seems to vanish and it becomes more or less
//!   comparable to the topological frontier
//! paper-table: contradicts
//! expect:
//!   equivalent:
//!     metric: success
//!     where: {strategy: normalized-frontier}
//!     to: {where: {strategy: frontier}}
//!     margin: 0.1
//!     minimum-n: 50
//! ```
//! `between`: the mean (or `median`, `p95`) of a cell lies between bounds; with `relative-to`, its relative
//! difference from another cell.
//! ```yaml
//! id: P6
//! says: >-
//!   a speed-up for covering 70 % of the free area of 25 % wrt the use of no prior knowledge for the
//!   furnished version and of almost 40 % for the unfurnished one
//! paper-table: supports
//! expect:
//!   between:
//!     metric: time-s-at-70
//!     where: {prior: floor-plan}
//!     relative-to: {prior: none}
//!     low: -0.45
//!     high: -0.10
//! ```
//! `trend`: the metric rises or falls along scored cells (`cochran-armitage` for shares, `spearman` with a
//! permutation p for measures).
//! ```yaml
//! id: D6
//! says: the temporal deadlines are strict, and this boosts failure rates for all algorithms
//! paper-table: supports
//! expect:
//!   trend:
//!     metric: success
//!     direction: rising
//!     along:
//!       - {score: 0.1, where: {deadline-s: 68}}
//!       - {score: 0.4, where: {deadline-s: 272}}
//!       - {score: 0.7, where: {deadline-s: 477}}
//!       - {score: 1.0, where: {deadline-s: 680}}
//!     for-each: {strategy: [random, frontier]}
//! ```
//! `homogeneous`: all cells across a factor lie within a margin of one another.
//! ```yaml
//! id: D1b
//! ours: at the shortest deadline all strategies do alike
//! expect:
//!   homogeneous:
//!     metric: success
//!     where: {start: A, deadline-s: 68}
//!     across: {strategy: [random, frontier, normalized-frontier]}
//!     margin: 0.1
//!     minimum-n: 50
//! ```
//! `rank`: one cell is `first` (highest) or `last` of those across a factor, or all stand in `descending` order.
//! ```yaml
//! id: D2b
//! ours: from B random is the worst
//! paper-table: supports
//! expect:
//!   rank:
//!     metric: success
//!     where: {start: B}
//!     across: {strategy: [random, frontier, normalized-frontier]}
//!     order: {last: random}
//! ```
//! `sign-test`: over many pairs of cells, or over trials that share their noise, one side is lower more often
//! than not. Several metrics of the same runs vote together: they are one pair, not several.
//! ```yaml
//! id: P11
//! says: Using a priori knowledge improves considerably the performance in all the three cases
//! paper-table: supports
//! expect:
//!   sign-test:
//!     metric: [distance-m-at-80, distance-m-at-90]
//!     direction: less
//!     where: {prior: floor-plan}
//!     than: {prior: none}
//!     for-each: {environment: [basic, office, open], furnished: [true, false]}
//!     minimum-n: 6
//!     censored: reached-only
//! ```
//! `spread`: largest less smallest cell mean across a factor is below that of another pool, or `at-most` a
//! bound; by bootstrap.
//! ```yaml
//! id: D5
//! says: >-
//!   The semantic strategies, on the contrary, appear to have a performance that is less dependent on the
//!   start location
//! paper-table: contradicts
//! expect:
//!   spread:
//!     metric: success
//!     where: {strategy: corridors-first}
//!     across: {start: [A, B, C]}
//!     than: {strategy: frontier}
//! ```
//! `share`: the share of trials that meet a condition lies between bounds. A run that never reached the
//! measure does not meet it.
//! ```yaml
//! id: D11
//! ours: half of the runs of frontier arrive within five minutes
//! expect:
//!   share:
//!     that: {metric: time-s, at-most: 300}
//!     where: {strategy: frontier}
//!     low: 0.5
//! ```
//! `every`: each single trial meets a condition, which may be the value of a factor. No test: one trial that does
//! not meet it contradicts the claim.
//! ```yaml
//! id: D10
//! says: a trial is considered a failure if the robot has not reached the target location by the given deadline
//! paper-table: supports
//! expect: {every: {that: {metric: time-s, at-most: deadline-s}, censored: reached-only}}
//! ```
//! `rate`: of the same trials, one quantity is lower or higher than another, each summed per trial or `per` something
//! else; by bootstrap over trials.
//! ```yaml
//! id: D7b
//! says: >-
//!   more aggressive maneuvers, thus possibly also increasing the number of failures due to collisions
//!   with the environment
//! paper-table: silent
//! expect:
//!   rate:
//!     of: {metric: fast-collisions, per: fast-maneuvers}
//!     direction: greater
//!     than: {metric: slow-collisions, per: slow-maneuvers}
//! ```
//! `correlation-with-published`: Spearman's correlation over the published cells, optionally of log ratios to
//! a base cell.
//! ```yaml
//! id: D15
//! says: reaching the same conclusions in terms of relative value of the exploration strategies
//! paper-table: silent
//! expect:
//!   correlation-with-published:
//!     metric: success
//!     published: success-percent
//!     scale: 0.01
//!     at-least: 0.6
//! ```
//! `rmse-with-published`: root mean square difference over the published cells, in the metric's unit, with the
//! skill over a constant and over `baseline` means beside it.
//! ```yaml
//! id: D15b
//! ours: success rates within 18 points of the paper's
//! expect:
//!   rmse-with-published:
//!     metric: success
//!     published: success-percent
//!     scale: 0.01
//!     at-most: 0.18
//!     baseline: [start, strategy]
//! ```
//! `untestable`: nothing that this manifest runs could decide it, for the reason given. The claim stands among the
//! others, so that nobody takes it for overlooked; its verdict is `cannot-be-tested`.
//! ```yaml
//! id: P22
//! says: >-
//!   The performance improvement ... is more evident in the real world, which is inherently more complex
//!   and noisy, than in simulations
//! paper-table: silent
//! expect: {untestable: {because: there is no real world in a simulation}}
//! ```

use super::comparing::{Comparison, Equivalence, Homogeneity, Ranking, Trend};
use super::measuring::{
    Correlation, Every, Level, Rate, Rmse, Share, SignTest, Spread, Untestable,
};
use super::terms::{Censored, Correction, Sides, Test, five_percent};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A checkable expectation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Expect {
    /// The first cell is lower.
    Less(Comparison),
    /// The first cell is higher.
    Greater(Comparison),
    /// Two cells are equal within a margin.
    Equivalent(Equivalence),
    /// A cell lies between bounds.
    Between(Level),
    /// A metric rises or falls along scores.
    Trend(Trend),
    /// Cells are equal within a margin.
    Homogeneous(Homogeneity),
    /// Cells stand in an order.
    Rank(Ranking),
    /// One side is lower more often than not.
    SignTest(SignTest),
    /// Cells across a factor lie close together.
    Spread(Spread),
    /// A share of trials meets a condition.
    Share(Share),
    /// Every trial meets a condition.
    Every(Every),
    /// Of the same trials, one quantity is lower or higher than another.
    Rate(Rate),
    /// Our cells correlate with the published ones.
    CorrelationWithPublished(Correlation),
    /// Our cells lie near the published ones.
    RmseWithPublished(Rmse),
    /// Nothing that is run could decide it.
    Untestable(Untestable),
}

/// What all forms have in common, with the form's own defaults filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Terms {
    pub(crate) alpha: f64,
    pub(crate) correction: Correction,
    pub(crate) sides: Sides,
    pub(crate) test: Option<Test>,
    pub(crate) at_least: Option<usize>,
    pub(crate) minimum_n: u64,
    /// Runs that each single cell needs: `minimum_n`, or one where that counts pairs or cells.
    pub(crate) minimum_runs: u64,
    pub(crate) censored: Censored,
    /// The number of first trials of each condition that effect and p are told of as well.
    pub(crate) also_at_n: Option<u64>,
}

impl Terms {
    fn new(alpha: f64, minimum_n: u64) -> Self {
        Self {
            alpha,
            minimum_n,
            minimum_runs: minimum_n,
            correction: Correction::None,
            sides: Sides::One,
            test: None,
            at_least: None,
            censored: Censored::Refuse,
            also_at_n: None,
        }
    }
}

impl Expect {
    /// The form's name in manifests.
    pub fn form(&self) -> &'static str {
        match self {
            Self::Less(_) => "less",
            Self::Greater(_) => "greater",
            Self::Equivalent(_) => "equivalent",
            Self::Between(_) => "between",
            Self::Trend(_) => "trend",
            Self::Homogeneous(_) => "homogeneous",
            Self::Rank(_) => "rank",
            Self::SignTest(_) => "sign-test",
            Self::Spread(_) => "spread",
            Self::Share(_) => "share",
            Self::Every(_) => "every",
            Self::Rate(_) => "rate",
            Self::CorrelationWithPublished(_) => "correlation-with-published",
            Self::RmseWithPublished(_) => "rmse-with-published",
            Self::Untestable(_) => "untestable",
        }
    }

    pub(crate) fn terms(&self) -> Terms {
        macro_rules! corrected {
            ($f:expr) => {
                Terms {
                    correction: $f.correction,
                    at_least: $f.at_least,
                    ..Terms::new($f.alpha, $f.minimum_n)
                }
            };
        }
        match self {
            Self::Less(f) | Self::Greater(f) => Terms {
                sides: f.sides,
                test: f.test,
                censored: f.censored,
                also_at_n: f.also_at_n,
                ..corrected!(f)
            },
            Self::Rank(f) => {
                Terms { sides: f.sides, test: f.test, censored: f.censored, ..corrected!(f) }
            }
            Self::Trend(f) => {
                Terms { sides: f.sides, test: f.test, censored: f.censored, ..corrected!(f) }
            }
            Self::Equivalent(f) => Terms { censored: f.censored, ..corrected!(f) },
            Self::Between(f) => Terms { censored: f.censored, ..corrected!(f) },
            Self::Homogeneous(f) => Terms { censored: f.censored, ..corrected!(f) },
            Self::Spread(f) => Terms { censored: f.censored, ..corrected!(f) },
            Self::Share(f) => Terms { censored: Censored::Worst, ..corrected!(f) },
            // Nothing is estimated, so there is no level; the usual one stands for it.
            Self::Every(f) => {
                Terms { censored: f.censored, ..Terms::new(five_percent(), f.minimum_n) }
            }
            Self::Rate(f) => corrected!(f),
            Self::SignTest(f) => Terms {
                sides: f.sides,
                censored: f.censored,
                minimum_runs: 1,
                ..Terms::new(f.alpha, f.minimum_n)
            },
            Self::CorrelationWithPublished(f) => {
                Terms { censored: f.censored, minimum_runs: 1, ..Terms::new(f.alpha, f.minimum_n) }
            }
            Self::RmseWithPublished(f) => {
                Terms { censored: f.censored, minimum_runs: 1, ..Terms::new(f.alpha, f.minimum_n) }
            }
            Self::Untestable(_) => Terms::new(five_percent(), 1),
        }
    }
}
