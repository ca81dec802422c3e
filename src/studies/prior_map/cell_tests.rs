//! How a cell of a coverage table differs from its baseline: by all our runs, by as many first runs as the paper has, and
//! by the paper's printed means. Effects stand beside p-values, as thirty runs find significant what ten do not.

use super::requests::CoverageTable;
use super::results::CoverageCell;
use crate::stats::effect::hedges_g;
use crate::stats::means::welch;
use crate::stats::summary::Summary;
use crate::studies::Findings;
use crate::studies::columns::{Columns, whole};
use crate::table::Column;

/// Number of runs taken for the paper's where a cell prints none: what all of its tables have.
const PAPERS_RUNS: u64 = 10;

/// Effect (Hedges' g, cell less baseline) and two-sided p of Welch's test; `None` where a side has fewer than two runs or
/// nothing varies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Hedges' g.
    pub g: f64,
    /// Two-sided p.
    pub p: f64,
}

/// The differences of one cell to its baseline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellTests {
    /// By all runs that got there.
    pub all: Option<Difference>,
    /// The paper's number of runs.
    pub first_n: u64,
    /// How many of that many first trials of this cell got there.
    pub first_reached: u64,
    /// By the first trials alone.
    pub first: Option<Difference>,
    /// By the paper's means, standard deviations and numbers.
    pub published: Option<Difference>,
}

/// Adds to `columns` those of the tests against `baseline`.
pub(super) fn columns<'a>(
    columns: Columns<'a, CoverageCell>,
    baseline: &str,
) -> Columns<'a, CoverageCell> {
    let itself = "it is the baseline itself";
    let tested = "it is the baseline itself, or one of both has fewer than two runs that got there";
    let unprinted = "the paper prints no pair of means with deviations";
    let number = |name: &str, meaning: &str| Column::number(name, "", meaning);
    let tests =
        |of: fn(CellTests) -> Option<f64>| move |cell: &CoverageCell| cell.tests.and_then(of);
    let counts = |of: fn(CellTests) -> u64| {
        move |cell: &CoverageCell| cell.tests.map(|tests| whole(of(tests)))
    };
    let all = format!("Effect against `{baseline}`: Hedges' g, all runs that got there");
    columns
        .number(number("hedges-g", &all).empty_where(tested), tests(|t| t.all.map(|d| d.g)))
        .number(
            Column::probability(
                "welch-p",
                "Two-sided p of Welch's test against the baseline, all runs that got there",
            )
            .empty_where(tested),
            tests(|t| t.all.map(|d| d.p)),
        )
        .with(
            Column::count("first-n", "The paper's number of runs, or 10 where it prints none")
                .empty_where(itself),
            counts(|t| t.first_n),
        )
        .with(
            Column::count("first-n-reached", "How many of the first `first-n` trials got there")
                .empty_where(itself),
            counts(|t| t.first_reached),
        )
        .number(
            number(
                "first-n-hedges-g",
                "Hedges' g against the baseline, the first `first-n` trials only",
            )
            .empty_where(tested),
            tests(|t| t.first.map(|d| d.g)),
        )
        .number(
            Column::probability(
                "first-n-welch-p",
                "p of Welch's test against the baseline, the first `first-n` trials only",
            )
            .empty_where(tested),
            tests(|t| t.first.map(|d| d.p)),
        )
        .number(
            number(
                "published-hedges-g",
                "Hedges' g against the baseline from the paper's printed means and deviations",
            )
            .empty_where(unprinted),
            tests(|t| t.published.map(|d| d.g)),
        )
        .number(
            Column::probability(
                "published-welch-p",
                "p of Welch's test against the baseline from the paper's printed numbers",
            )
            .empty_where(unprinted),
            tests(|t| t.published.map(|d| d.p)),
        )
}

impl Findings<'_> {
    /// Tests `cells`, side by side in one line of `request`, against their baseline, where the request asks for it.
    pub(super) fn test_cells(&self, request: &CoverageTable, cells: &mut [CoverageCell]) {
        let baseline = request.baseline.as_ref().map(|b| b.0.as_str());
        let base = cells.iter().find(|cell| Some(cell.by.as_str()) == baseline).cloned();
        let Some(base) = base.filter(|_| request.tests) else { return };
        for cell in cells.iter_mut().filter(|cell| cell.by != base.by) {
            let first_n = printed(cell).map_or(PAPERS_RUNS, |summary| summary.n);
            let first = self.first_runs(request, cell, first_n);
            let of_base = self.first_runs(request, &base, first_n);
            cell.tests = Some(CellTests {
                all: cell.ours.zip(base.ours).and_then(|(a, b)| difference(a, b)),
                first_n,
                first_reached: first.n,
                first: difference(first, of_base),
                published: printed(cell)
                    .zip(printed(&base))
                    .and_then(|(cell, base)| difference(cell, base)),
            });
        }
    }

    /// Summarises the runs among the first `n` trials of a cell that got there.
    fn first_runs(&self, request: &CoverageTable, cell: &CoverageCell, n: u64) -> Summary {
        let fixed = cell.rows.clone().with(&request.by, &cell.by);
        let measure = request.metric.measure_at(cell.percent);
        let first = self.matching(&fixed).into_iter().filter(|r| u64::from(r.trial()) < n);
        let reached: Vec<f64> = first.filter_map(|r| r.number(&measure)).collect();
        Summary::of(&reached)
    }
}

fn difference(a: Summary, b: Summary) -> Option<Difference> {
    if a.n < 2 || b.n < 2 || !(a.sd > 0.0 || b.sd > 0.0) {
        return None;
    }
    Some(Difference { g: hedges_g(a, b), p: welch(a, b).tails.two_sided })
}

/// Returns what the paper prints of a cell, where it prints a spread.
fn printed(cell: &CoverageCell) -> Option<Summary> {
    let (mean, sd, n) = cell.published?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of runs")]
    let n = n?.max(0.0) as u64;
    Some(Summary { n, mean, sd: sd? })
}
