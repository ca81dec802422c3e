//! From records to what a reader sees: the curves, the cells of the paper's tables, and figures.

mod layout;

use super::cell_tests::CellTests;
use super::requests::{CoverageCurve, CoverageTable, Metric};
use crate::condition::Condition;
use crate::figure::{LineChart, Medium, PublishedPoint, Series};
use crate::stats::compatibility::{Agreement, Ours, Printed};
use crate::stats::summary::{Summary, median, quantile};
use crate::studies::{Drawn, Findings, Outcome, SeriesPoint, TableRequest, coverage_tables};
use crate::table::{Table, Value};

/// Mean and spread of one cell of a table, beside the paper's.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverageCell {
    /// Values of the row's factors, coverage, and the column's value.
    pub rows: Condition,
    /// Coverage (percent).
    pub percent: u32,
    /// The value of the factor whose values stand side by side.
    pub by: String,
    /// Trials of this cell, whether or not they got there.
    pub trials: u64,
    /// Those that reached the coverage; `None` where none did.
    pub ours: Option<Summary>,
    /// Difference of our mean to our baseline's (percent).
    pub difference_percent: Option<f64>,
    /// The paper's mean, standard deviation and number of runs.
    pub published: Option<(f64, Option<f64>, Option<f64>)>,
    /// Difference of the paper's mean to its baseline's (percent), recomputed from its printed means.
    pub published_difference_percent: Option<f64>,
    /// How our mean agrees with the paper's, or why it cannot.
    pub agreement: Agreement,
    /// Tests against the baseline, where the request asks for them.
    pub tests: Option<CellTests>,
}

impl CoverageCurve {
    /// Draws the figure, where trials have curves.
    pub(in crate::studies) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        tables: &[TableRequest],
        medium: Medium,
    ) -> Option<Drawn> {
        let tables: Vec<_> = coverage_tables(tables).into_iter().map(|(_, table)| table).collect();
        let chart = findings.coverage_figure(title, self, &tables);
        let caption = if tables.iter().any(|table| table.published.is_some()) {
            "Median of the trials with a band from the 10th to the 90th percentile; hollow markers are the paper's \
             means with one standard deviation."
        } else {
            "Median of the trials with a band from the 10th to the 90th percentile."
        };
        (!chart.is_empty()).then(|| {
            let (svg, data) = (chart.to_svg_on(medium), chart.data());
            Drawn::new(("Line chart", title), svg, chart.in_words(), caption, data)
        })
    }
}

impl Findings<'_> {
    /// Returns the table of the curves without its rows ([`Self::series_rows`]): one row at the first crossing of every whole
    /// percent and at every 10 s.
    pub fn series(&self) -> Table {
        let mut columns = vec!["key".to_owned()];
        columns.extend(self.factors.iter().map(|factor| factor.name.clone()));
        columns.extend(["trial", "time-s", "distance-m", "coverage-percent"].map(str::to_owned));
        Table::new(columns)
    }

    /// Returns the rows of [`Self::series`], in plan order.
    pub fn series_rows(&self) -> impl Iterator<Item = Vec<Value>> {
        self.ledger.entries().flat_map(move |trial| {
            trial.series().iter().map(move |point| {
                let mut row: Vec<Value> = vec![trial.key().hex().into()];
                row.extend(self.factor_values(trial.condition()));
                row.push(i64::from(trial.trial()).into());
                row.extend(
                    [point.time_s, point.distance_m, point.coverage_percent].map(Value::from),
                );
                row
            })
        })
    }

    /// Returns the factors in the rows of a table that its published numbers do not distinguish: choices that the paper
    /// leaves open.
    pub fn readings(&self, request: &CoverageTable) -> Vec<String> {
        let published = request.published.as_ref().and_then(|name| self.published.get(name));
        let open = |factor: &&String| published.is_some_and(|table| table.column(factor).is_none());
        request.rows.iter().filter(open).cloned().collect()
    }

    /// Returns the cells of a table in the paper's order: rows, then coverage, then side by side.
    pub fn coverage_cells(&self, request: &CoverageTable) -> Vec<CoverageCell> {
        let mut cells = Vec::new();
        // A reading that the design does not have is no row of cells that nobody reached.
        let readings = self.readings(request);
        let ran = self.ran(&readings);
        let is_read = |rows: &Condition| {
            readings.is_empty() || ran.iter().any(|reading| rows.has_all(reading))
        };
        for rows in self.crossed(&request.rows).into_iter().filter(is_read) {
            for &percent in &request.at {
                let first = cells.len();
                for by in self.values_of(&request.by) {
                    let fixed = rows.clone().with(&request.by, &by);
                    cells.push(self.coverage_cell(request, rows.clone(), percent, by, &fixed));
                }
                let baseline = request.baseline.as_ref().map(|b| b.0.as_str());
                add_differences(&mut cells[first..], baseline);
                self.test_cells(request, &mut cells[first..]);
            }
        }
        cells
    }

    fn coverage_cell(
        &self,
        request: &CoverageTable,
        rows: Condition,
        percent: u32,
        by: String,
        fixed: &Condition,
    ) -> CoverageCell {
        let measure = request.metric.measure_at(percent);
        let here = self.matching(fixed);
        let reached: Vec<f64> = here.iter().filter_map(|r| r.number(&measure)).collect();
        let published = request.published.as_ref().and_then(|name| {
            let fixed = fixed.clone().with("coverage-percent", percent.to_string());
            let (table, row) = self.published_row(name, &fixed)?;
            let number = |column: &str| table.value(row, column).as_f64();
            Some((number("value")?, number("sd"), number("n")))
        });
        let ours = (!reached.is_empty()).then(|| Summary::of(&reached));
        let found = ours.map(Ours::Mean).ok_or_else(|| self.absence(fixed, here.len() as u64));
        CoverageCell {
            agreement: Agreement::between(found, published.map(printed)),
            rows,
            percent,
            by,
            trials: here.len() as u64,
            ours,
            difference_percent: None,
            published,
            published_difference_percent: None,
            tests: None,
        }
    }

    /// Makes a requested figure: median coverage with a band from the 10th to the 90th percentile of trials, and the
    /// paper's points where a table of the same metric has them.
    fn coverage_figure(
        &self,
        title: &str,
        wanted: &CoverageCurve,
        tables: &[&CoverageTable],
    ) -> LineChart {
        let only: Condition = wanted.only.iter().map(|(f, v)| (f, &v.0)).collect();
        let series = self.values_of(&wanted.by).into_iter().map(|value| {
            let fixed = only.clone().with(&wanted.by, &value);
            let curve = self.curve(wanted, &fixed, &value, tables);
            Series { name: self.labels.value(&wanted.by, &value).to_owned(), ..curve }
        });
        let x_title = match wanted.against {
            Metric::TimeS => "time (s)",
            Metric::DistanceM => "distance travelled (m)",
        };
        LineChart {
            title: title.to_owned(),
            x_title: x_title.to_owned(),
            y_title: "coverage (%)".to_owned(),
            meaning: "median of trials, band 10th to 90th percentile".to_owned(),
            series: series.collect(),
        }
    }

    fn curve(
        &self,
        wanted: &CoverageCurve,
        fixed: &Condition,
        value: &str,
        tables: &[&CoverageTable],
    ) -> Series {
        let runs: Vec<Vec<(f64, f64)>> = self
            .matching(fixed)
            .into_iter()
            .filter(|r| r.outcome() != Outcome::PANICKED)
            .map(|r| {
                let x = |p: &SeriesPoint| match wanted.against {
                    Metric::TimeS => p.time_s,
                    Metric::DistanceM => p.distance_m,
                };
                r.series().iter().map(|p| (x(p), p.coverage_percent)).collect()
            })
            .collect();
        let end = runs.iter().filter_map(|r| r.last().map(|p| p.0)).fold(0.0, f64::max);
        let (mut points, mut band) = (Vec::new(), Vec::new());
        if end > 0.0 {
            for i in 0..=SAMPLES {
                let x = end * f64::from(i) / f64::from(SAMPLES);
                let values: Vec<f64> = runs.iter().map(|run| value_at(run, x)).collect();
                points.push((x, median(&values)));
                band.push((x, quantile(&values, 0.1), quantile(&values, 0.9)));
            }
        }
        let published = tables
            .iter()
            .filter(|t| t.metric == wanted.against && t.by == wanted.by)
            .flat_map(|t| self.coverage_cells(t))
            .filter(|cell| {
                cell.by == value
                    && cell.rows.iter().all(|row| !fixed.iter().any(|f| f.0 == row.0 && f != row))
            })
            .filter_map(|cell| {
                let (x, sd, _) = cell.published?;
                let y = f64::from(cell.percent);
                Some(PublishedPoint { x, y, x_error: sd, y_error: None })
            })
            .collect();
        Series { name: value.to_owned(), points, band, published }
    }
}

/// Returns what the paper prints, as it is compared.
fn printed((value, sd, n): (f64, Option<f64>, Option<f64>)) -> Printed {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of runs")]
    let n = n.map(|n| n.max(0.0) as u64);
    Printed { value, sd, n }
}

/// A curve is drawn through this many pieces.
const SAMPLES: u32 = 120;

/// Returns the coverage of a run at `x`: what it last had, and what it ended with once it has ended.
fn value_at(run: &[(f64, f64)], x: f64) -> f64 {
    run.iter().take_while(|p| p.0 <= x).last().map_or(0.0, |p| p.1)
}

/// Adds to the cells of a line how far (percent) their means lie from that of the `baseline`; nothing where that is 0.
fn add_differences(line: &mut [CoverageCell], baseline: Option<&str>) {
    let Some(base) = line.iter().find(|c| Some(c.by.as_str()) == baseline).cloned() else { return };
    // Of nothing there is no percentage: where one look covers all that is asked for, no way was travelled to it.
    let difference = |of: f64, to: f64| (to > 0.0).then(|| 100.0 * (of / to - 1.0));
    for cell in line.iter_mut().filter(|c| c.by != base.by) {
        if let (Some(ours), Some(theirs)) = (cell.ours, base.ours) {
            cell.difference_percent = difference(ours.mean, theirs.mean);
        }
        if let (Some(ours), Some(theirs)) = (cell.published, base.published) {
            cell.published_difference_percent = difference(ours.0, theirs.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::compatibility::Silence;

    #[test]
    fn of_nothing_there_is_no_percentage() {
        let cell = |by: &str, mean: f64| CoverageCell {
            rows: Condition::default(),
            percent: 50,
            by: by.to_owned(),
            trials: 2,
            ours: Some(Summary::of(&[mean, mean])),
            difference_percent: None,
            published: Some((mean, None, None)),
            published_difference_percent: None,
            agreement: Agreement::Silent(Silence::NotPrinted),
            tests: None,
        };
        for (baseline, expected) in [(0.0, None), (4.0, Some(-50.0))] {
            let mut line = [cell("none", baseline), cell("plan", 2.0)];
            add_differences(&mut line, Some("none"));
            let found = (line[1].difference_percent, line[1].published_difference_percent);
            assert_eq!(found, (expected, expected));
            assert_eq!(line[0].difference_percent, None, "the baseline itself");
        }
    }
}
