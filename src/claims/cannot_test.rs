//! Why a comparison cannot be tested: each reason is the sentence that stands in the verdict.

use super::metric::Metric;
use super::published::PublishedTableError;
use thiserror::Error;

/// Why a comparison cannot be tested.
#[derive(Debug, Clone, PartialEq, Error)]
pub(super) enum CannotTest {
    /// A reason that somebody stated.
    #[error("{0}")]
    Stated(String),
    /// A metric of the machine in a claim that is judged by the study's results.
    #[error(
        "`{0}` depends on the machine: such claims are marked `circumstance: true` and judged apart from the results"
    )]
    OfTheMachine(String),

    // What may be wrong with the trials.
    /// The trials hold no such measure.
    #[error("the trials table has no column `{0}`")]
    NoColumn(String),
    /// A cell is empty.
    #[error("no trial matches ({0})")]
    NoTrial(String),
    /// The engine failed to run some trials of a cell.
    #[error("{failed} of {trials} trials of ({cell}) failed to run")]
    FailedTrials { failed: u64, trials: u64, cell: String },
    /// The engine failed to run one trial of a pair.
    #[error("trial {number} of ({condition}) failed to run")]
    FailedTrial { number: i64, condition: String },
    /// Some runs of a cell never reached the measure.
    #[error(
        "{censored} of {trials} runs of ({cell}) never reached {metric}; say with `censored` whether those that did are \
         compared (reached-only) or the others rank last (worst)"
    )]
    CensoredRuns { censored: usize, trials: u64, cell: String, metric: Metric },
    /// In some pairs a run never reached the measure.
    #[error(
        "in {0} pairs a run never reached the measure; say with `censored` whether such pairs are left out (reached-only) \
         or rank last (worst)"
    )]
    CensoredPairs(u64),
    /// A cell has fewer runs than the claim asks for.
    #[error("({cell}) has {n} runs to compare, fewer than the minimum of {minimum}")]
    FewRuns { cell: String, n: u64, minimum: u64 },
    /// There are fewer pairs without a tie than the claim asks for.
    #[error("{pairs} pairs differ, fewer than the minimum of {minimum} ({ties} are tied)")]
    FewPairs { pairs: u64, minimum: u64, ties: u64 },
    /// There are fewer published cells with runs of ours than the claim asks for.
    #[error("{cells} cells to compare, fewer than the minimum of {minimum}")]
    FewCells { cells: usize, minimum: u64 },
    /// A correlation needs more independent conditions.
    #[error(
        "the cells are of {0} independent conditions, fewer than the 4 that a correlation needs"
    )]
    FewConditions(usize),

    // What keeps trials from being independent.
    /// A condition is in two of the cells compared.
    #[error("the condition {0} is in two of the cells compared")]
    InTwoCells(String),
    /// Two published cells are held against runs of one condition.
    #[error("two published cells pool the condition {0}")]
    InTwoPublishedCells(String),
    /// A condition has its trials, or their noise, in two pairs.
    #[error("the condition {0} shares its trials or their noise with another pair")]
    InTwoPairs(String),
    /// Trials of one number have their noise in common.
    #[error(
        "trials of ({one}) and ({other}) share their noise (over {factors}), and this test needs independent trials; a \
         sign-test with `pairs: trials` does not"
    )]
    SharedNoise { one: String, other: String, factors: String },
    /// Trials have their noise in common over a factor that the pairs do not differ in.
    #[error("noise is shared over `{0}` too, which this test does not compare")]
    NoiseOver(String),
    /// One side of a pair is there several times.
    #[error("trial {number} of ({cell}) is there in several conditions: pin all factors compared")]
    SeveralPartners { number: i64, cell: String },

    // What keeps numbers from being tested.
    /// The test is one of other metrics.
    #[error("{0} does not apply to this metric")]
    OtherMetric(&'static str),
    /// A spread needs two runs.
    #[error("a mean of {0} runs has no known spread")]
    NoSpread(u64),
    /// All runs of a cell are equal.
    #[error("no value varies within its cell: nothing was drawn at random, so no test applies")]
    NothingVaries,
    /// All values are equal along a trend.
    #[error("no value varies, so nothing can rise or fall")]
    NothingRisesOrFalls,
    /// All values of one side of a correlation are equal.
    #[error("one side is the same in every cell, so there is no correlation")]
    NoCorrelation,
    /// A ratio of means needs two positive ones.
    #[error("a relative difference needs two positive means")]
    NotPositive,
    /// Every run of both cells counts, or none does.
    #[error("both shares are one, so their ratio has no known spread")]
    RatioOfOnes,
    /// A rate per something that never was.
    #[error("there are no {per}, so {quantity} is no number")]
    NoRate { per: String, quantity: String },
    /// A bound is the value of a factor, which is not a number there.
    #[error("the factor `{factor}` is no number in ({condition})")]
    BoundIsNoNumber { factor: String, condition: String },
    /// Nothing is measured.
    #[error("there is no cell to measure")]
    NoCell,
    /// Homogeneity needs two cells.
    #[error("one cell has nothing to be alike to")]
    OneCell,
    /// A spread needs two cells.
    #[error("one cell has no spread")]
    OneCellHasNoSpread,
    /// A trend needs two steps.
    #[error("a trend needs two steps or more")]
    OneStep,

    // What may be wrong with the paper's numbers.
    /// There is no such table.
    #[error("there is no published table `{0}`")]
    NoPublishedTable(String),
    /// The table cannot be read.
    #[error("published table `{table}`: {error}")]
    PublishedTable { table: String, error: PublishedTableError },
    /// The table has a coverage in each row, and the metric has none.
    #[error(
        "the published table `{table}` tells coverages, and `{metric}` is at none; name metrics as `{metric}-at-80`"
    )]
    NoCoverage { table: String, metric: String },
    /// The table does not say which quantity a row is of.
    #[error(
        "the published table `{table}` holds one quantity, and the claim compares it with {quantities}"
    )]
    OneQuantity { table: String, quantities: String },
}
