//! How our tables agree with the paper's: by the log ratios of cells to their baseline, never by counting signs, and by
//! the intervals that the paper's own spread and number of runs put around its means.

mod layout;

use super::requests::{AgreementTable, CoverageTable};
use super::results::CoverageCell;
use crate::condition::Condition;
use crate::labels::Labels;
use crate::math::{exp, ln};
use crate::rng::{Seeds, Stream};
use crate::stats::agreement::{Line, line, log_ratio_half_width, rmse, skill_over_constant};
use crate::stats::compatibility::{Agreement, Method};
use crate::stats::rank::{pearson, spearman};
use crate::stats::real;
use crate::stats::summary::{Summary, mean, median};
use crate::stats::unexplained::{Difference, Unexplained, unexplained};
use crate::studies::Findings;

/// Confidence of every interval here.
const CONFIDENCE: f64 = 0.95;

/// How one coverage table, or part of it, agrees with the paper's.
#[derive(Debug, Clone, PartialEq)]
pub struct TableAgreement {
    /// Id of the coverage table.
    pub table: String,
    /// `all`, or the factor value that the part has; all values of a combination of readings.
    pub scope: String,
    /// The same as people read it: the table's id where it is the whole, a combination's values alone.
    pub name: String,
    /// Cells with a log ratio to their baseline on both sides.
    pub ratios: u64,
    /// Printed cells that have none of ours: no run got there.
    pub missing: u64,
    /// Cells with runs that never reached the coverage; their means are of those that did.
    pub censored: u64,
    /// Sets of cells with no run in common: those of one combination of the rows' factors share their baseline, and those
    /// that differ in readings alone the paper's.
    pub blocks: u64,
    /// Our log ratios on the paper's: 1 and 0 agree, a slope below 1 is a gain smaller than printed. Intervals by the
    /// jackknife over blocks.
    pub line: Line,
    /// Pearson's correlation of the log ratios.
    pub pearson: f64,
    /// Spearman's.
    pub spearman: f64,
    /// Root mean square difference of the log ratios: the score, lower is better.
    pub rmse: f64,
    /// Its skill over the one ratio that fits the paper best, the mean of its log ratios.
    pub skill: f64,
    /// Mean of our log ratios.
    pub mean: f64,
    /// Mean of the paper's.
    pub published_mean: f64,
    /// Of the log ratios, how many lie inside the paper's prediction interval, and how many have one.
    pub ratios_inside: (u64, u64),
    /// Of the cells themselves (m or s), how many do, and how many have one.
    pub cells_inside: (u64, u64),
    /// What the cells themselves tell.
    pub absolute: Absolute,
}

/// How cells themselves (m or s) agree with the paper's: judged before any ratio of theirs.
#[derive(Debug, Clone, PartialEq)]
pub struct Absolute {
    /// Each cell with a mean and a spread on both sides, its arm among those of the table.
    pub cells: Vec<Difference>,
    /// tau: what neither side's sampling explains of a cell, as a share of it.
    pub unexplained: Unexplained,
    /// Log of our mean over the paper's, of every cell with a mean on both sides.
    pub logs: Vec<f64>,
    /// Mean of these: above 0 ours are longer.
    pub bias: f64,
    /// Median over cells of our standard deviation over the paper's.
    pub spread: f64,
}

impl Absolute {
    /// Judges `both` sides, arms numbered by `arm_of`.
    fn of(both: &[Both<'_>], arm_of: impl Fn(&CoverageCell) -> usize) -> Self {
        let positive =
            || both.iter().filter(|both| both.ours.mean > 0.0 && both.printed.mean > 0.0);
        let relative = |summary: Summary| {
            let share = summary.sd / summary.mean;
            share * share / real(summary.n)
        };
        let difference = |both: &Both<'_>| Difference {
            arm: arm_of(both.cell),
            log_ratio: ln(both.ours.mean / both.printed.mean),
            variance: relative(both.ours) + relative(both.printed),
        };
        let cells: Vec<Difference> =
            positive().filter(|both| both.spread && both.ours.n >= 2).map(difference).collect();
        let logs: Vec<f64> =
            positive().map(|both| ln(both.ours.mean / both.printed.mean)).collect();
        let spreads: Vec<f64> = both
            .iter()
            .filter(|both| both.spread && both.ours.n >= 2 && both.printed.sd > 0.0)
            .map(|both| both.ours.sd / both.printed.sd)
            .collect();
        let found =
            unexplained(std::slice::from_ref(&cells), RESAMPLES, CONFIDENCE, &mut arms_stream());
        Self { cells, unexplained: found[0], bias: mean(&logs), logs, spread: median(&spreads) }
    }
}

/// Returns a log as a difference in percent.
pub(super) fn percent(log: f64) -> f64 {
    100.0 * (exp(log) - 1.0)
}

/// Resamples of arms behind an interval of tau.
pub(super) const RESAMPLES: u32 = 2000;

/// Returns the stream by which arms are resampled: the same for every table, whatever the experiment's seed, so that a
/// table's interval depends on its cells alone.
pub(super) fn arms_stream() -> Stream {
    Seeds::new(0, Vec::new()).stream("agreement/arms")
}

/// A log ratio on both sides.
struct Ratio {
    block: Condition,
    ours: f64,
    published: f64,
    inside: Option<bool>,
}

/// A cell on both sides.
struct Both<'a> {
    cell: &'a CoverageCell,
    ours: Summary,
    printed: Summary,
    spread: bool,
}

impl Findings<'_> {
    /// Computes the agreement of each of `tables` (with its id) that a request asks for: as a whole, by each factor of
    /// its rows, by what stands side by side.
    pub fn agreement(
        &self,
        wanted: &AgreementTable,
        tables: &[(&str, &CoverageTable)],
    ) -> Vec<TableAgreement> {
        let mut found = Vec::new();
        for (id, table) in tables.iter().filter(|(id, _)| wanted.tables.iter().any(|t| t == id)) {
            let (cells, readings) = (self.coverage_cells(table), self.readings(table));
            let agreement = |id: &str, names: (&str, &str), cells: &[CoverageCell]| {
                agreement(
                    id,
                    names,
                    (cells, cells),
                    table.baseline.as_ref().map(|b| b.0.as_str()),
                    &readings,
                )
            };
            found.push(agreement(id, ("all", id), &cells));
            for factor in &table.rows {
                for value in self.values_of(factor) {
                    let level = (factor.clone(), value);
                    let part: Vec<CoverageCell> =
                        cells.iter().filter(|cell| cell.rows.contains(&level)).cloned().collect();
                    let scope = format!("{factor}={}", level.1);
                    let shown = in_scope(&scope, self.labels);
                    found.push(agreement(id, (&scope, &shown), &part));
                }
            }
            // The levels of a single factor have been compared above.
            for reading in self.ran(&readings).iter().filter(|reading| reading.len() > 1) {
                let has = |cell: &&CoverageCell| cell.rows.has_all(reading);
                let part: Vec<CoverageCell> = cells.iter().filter(has).cloned().collect();
                let pairs: Vec<String> = reading.iter().map(|(f, v)| format!("{f}={v}")).collect();
                let values = self.labels.values(reading);
                let names = (pairs.join(", "), values.join(", "));
                found.push(agreement(id, (&names.0, &names.1), &part));
            }
            let baseline = table.baseline.as_ref().map(|b| b.0.clone());
            let others = self.values_of(&table.by);
            for value in others.into_iter().filter(|value| Some(value) != baseline.as_ref()) {
                let part: Vec<CoverageCell> = cells
                    .iter()
                    .filter(|cell| cell.by == value || Some(&cell.by) == baseline.as_ref())
                    .cloned()
                    .collect();
                let scope = format!("{}={value}", table.by);
                let shown = in_scope(&scope, self.labels);
                found.push(agreement(id, (&scope, &shown), &part));
            }
        }
        found.retain(|part| part.ratios > 0 || part.scope == "all");
        found
    }
}

/// Returns the part of a table that `scope` names (`all`, or `factor=value` once or more often) as readers see it.
pub(super) fn in_scope(scope: &str, labels: &Labels) -> String {
    let shown = |pair: &str| {
        let label = pair.split_once('=').and_then(|(factor, value)| labels.label(factor, value));
        label.unwrap_or(pair).to_owned()
    };
    scope.split(", ").map(shown).collect::<Vec<_>>().join(", ")
}

/// Computes the agreement of `cells` with the paper's; their arms are numbered `among` others.
pub(super) fn agreement(
    id: &str,
    (scope, name): (&str, &str),
    (cells, among): (&[CoverageCell], &[CoverageCell]),
    baseline: Option<&str>,
    readings: &[String],
) -> TableAgreement {
    let both: Vec<Both<'_>> = cells.iter().filter_map(on_both_sides).collect();
    let mut ratios: Vec<Ratio> = Vec::new();
    for above in both.iter().filter(|both| Some(both.cell.by.as_str()) != baseline) {
        let base = both.iter().find(|below| {
            Some(below.cell.by.as_str()) == baseline
                && below.cell.rows == above.cell.rows
                && below.cell.percent == above.cell.percent
        });
        let Some(below) = base else { continue };
        let positive = [above.ours, above.printed, below.ours, below.printed];
        if !positive.iter().all(|summary| summary.mean > 0.0) {
            continue;
        }
        let (ours, published) =
            (ln(above.ours.mean / below.ours.mean), ln(above.printed.mean / below.printed.mean));
        let inside = (above.spread && below.spread).then(|| {
            let (above, below) = ((above.printed, above.ours.n), (below.printed, below.ours.n));
            (ours - published).abs() <= log_ratio_half_width(above, below, CONFIDENCE)
        });
        // Readings share the paper's numbers.
        let block = above.cell.rows.iter().filter(|(factor, _)| !readings.contains(factor));
        ratios.push(Ratio { block: block.cloned().collect(), ours, published, inside });
    }
    let mut blocks: Vec<&Condition> = Vec::new();
    let mut places: Vec<Vec<usize>> = Vec::new();
    for (i, ratio) in ratios.iter().enumerate() {
        if let Some(known) = blocks.iter().position(|block| **block == ratio.block) {
            places[known].push(i);
        } else {
            blocks.push(&ratio.block);
            places.push(vec![i]);
        }
    }
    let (x, y): (Vec<f64>, Vec<f64>) = ratios.iter().map(|r| (r.published, r.ours)).unzip();
    let points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    let cells_inside: Vec<bool> = both
        .iter()
        .map(|both| both.cell.agreement)
        .filter(|agreement| agreement.method() == Some(Method::PredictionInterval))
        .map(|agreement| matches!(agreement, Agreement::Compatible(_)))
        .collect();
    let ratios_inside: Vec<bool> = ratios.iter().filter_map(|ratio| ratio.inside).collect();
    let tally =
        |inside: &[bool]| (inside.iter().filter(|is| **is).count() as u64, inside.len() as u64);
    let printed = cells.iter().filter(|cell| cell.published.is_some());
    TableAgreement {
        table: id.to_owned(),
        scope: scope.to_owned(),
        name: name.to_owned(),
        ratios: ratios.len() as u64,
        missing: printed.filter(|cell| cell.ours.is_none() && cell.trials > 0).count() as u64,
        censored: both.iter().filter(|both| both.ours.n < both.cell.trials).count() as u64,
        blocks: places.len() as u64,
        line: line(&points, &places, CONFIDENCE),
        pearson: pearson(&x, &y),
        spearman: spearman(&x, &y),
        rmse: rmse(&x, &y),
        skill: skill_over_constant(&y, &x),
        mean: mean(&y),
        published_mean: mean(&x),
        ratios_inside: tally(&ratios_inside),
        cells_inside: tally(&cells_inside),
        absolute: Absolute::of(&both, |cell| arm_of(among, cell, readings)),
    }
}

/// Returns the number of the arm of `cell` among those of `cells`: cells that differ in coverage are of the same runs, and
/// those that differ in readings alone of the same arm in print.
fn arm_of(cells: &[CoverageCell], cell: &CoverageCell, readings: &[String]) -> usize {
    let printed = |rows: &Condition| -> Condition {
        rows.iter().filter(|(factor, _)| !readings.contains(factor)).cloned().collect()
    };
    let own = (printed(&cell.rows), &cell.by);
    let mut arms: Vec<(Condition, &String)> = Vec::new();
    for other in cells {
        let arm = (printed(&other.rows), &other.by);
        if arm == own {
            return arms.len();
        }
        if !arms.contains(&arm) {
            arms.push(arm);
        }
    }
    arms.len()
}

fn on_both_sides(cell: &CoverageCell) -> Option<Both<'_>> {
    let (ours, (mean, sd, n)) = (cell.ours?, cell.published?);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of runs")]
    let n = n.map_or(0, |n| n.max(0.0) as u64);
    let printed = Summary { n, mean, sd: sd.unwrap_or(f64::NAN) };
    Some(Both { cell, ours, printed, spread: sd.is_some() && n >= 2 })
}

#[cfg(test)]
mod tests;
