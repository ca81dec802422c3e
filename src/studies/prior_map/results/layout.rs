//! What is shown of the cells of a coverage table.

use super::super::cell_tests::{self, CellTests, Difference};
use super::super::requests::{CoverageTable, Metric};
use super::{CoverageCell, printed};
use crate::labels::Labels;
use crate::stats::compatibility::{Agreement, Silence};
use crate::studies::columns::Columns;
use crate::studies::exhibit::{Abreast, Grid, GridCell, Layout, Lines, Measured, Set, Source};
use crate::studies::{Findings, TableRequest};
use crate::table::{Column, Table, Value};

impl Layout for CoverageTable {
    type Cell = CoverageCell;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<CoverageCell> {
        findings.coverage_cells(self)
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, CoverageCell> {
        let (unit, of) = match self.metric {
            Metric::DistanceM => ("m", "way travelled when that coverage was reached"),
            Metric::TimeS => ("s", "simulated time when that coverage was reached"),
        };
        let baseline = self.baseline.as_ref().map_or("the baseline", |value| value.0.as_str());
        let number = |name: &str, meaning: &str| Column::number(name, unit, meaning).at_least(0.0);
        let difference = |name: &str, meaning: &str| Column::number(name, "%", meaning);
        let unprinted = "the paper prints none";
        let columns = Columns::<CoverageCell>::none()
            .factors(&self.rows, findings, |cell| &cell.rows)
            .with(Column::percent("coverage-percent", "Level of coverage"), |cell| {
                i64::from(cell.percent)
            })
            .with(findings.factor_column(&self.by), |cell| cell.by.clone())
            .number(
                number("mean", &format!("Mean over trials of the {of}"))
                    .empty_where("no trial got there"),
                |cell| cell.ours.map(|s| s.mean),
            )
            .number(
                number("sd", "Standard deviation over those trials (n - 1)")
                    .empty_where("fewer than two trials got there"),
                |cell| cell.ours.filter(|s| s.n > 1).map(|s| s.sd),
            )
            .count("n", "Trials that reached the coverage; mean and sd are of these", |cell| {
                cell.ours.map_or(0, |s| s.n)
            })
            .count("trials", "All trials of the cell", |cell| cell.trials)
            .number(
                difference(
                    "difference-percent",
                    &format!("Difference of the mean to that of `{baseline}`"),
                )
                .empty_where("it is the baseline itself, or one of both has no runs that got there"),
                |cell| cell.difference_percent,
            )
            .with(
                number("published", "The mean that the paper prints").empty_where(unprinted),
                |cell| cell.published.map(|p| p.0),
            )
            .with(
                number("published-sd", "The standard deviation that the paper prints")
                    .empty_where(unprinted),
                |cell| cell.published.and_then(|p| p.1),
            )
            .with(
                Column::count("published-n", "The paper's number of runs").empty_where(unprinted),
                |cell| cell.published.and_then(|p| p.2),
            )
            .number(
                difference(
                    "published-difference-percent",
                    &format!(
                        "Difference of the paper's mean to its mean for `{baseline}`, from the printed numbers"
                    ),
                )
                .empty_where("it is the baseline itself, or the paper prints no pair"),
                |cell| cell.published_difference_percent,
            )
            .agreement(unit, |cell| cell.agreement);
        if self.tests { cell_tests::columns(columns, baseline) } else { columns }
    }

    fn set(&self, cells: &[CoverageCell], findings: &Findings<'_>) -> Set {
        let labels = findings.labels;
        let values = findings.values_of(&self.by);
        let side_by_side: Vec<String> =
            values.iter().map(|value| labels.value(&self.by, value).to_owned()).collect();
        let abreast = Abreast {
            cells,
            of: side_by_side.len(),
            label: |cell: &CoverageCell| {
                let mut label = labels.values(&cell.rows);
                label.push(format!("{} %", cell.percent));
                label
            },
        };
        let mut heads = labels.factors(&self.rows);
        heads.push("coverage".to_owned());
        let header = heads.join(", ");
        heads.extend(side_by_side.iter().flat_map(|by| [by.clone(), format!("{by} (paper)")]));
        let readings = findings.readings(self);
        let lines = if readings.len() > 1 {
            let cells = cells.iter().filter(|cell| cell.trials > 0).count();
            Lines::Elsewhere { cells, by: labels.factors(&readings).join(", ") }
        } else {
            self.lines(cells, labels)
        };
        let print = abreast.table(heads, |cell| [ours_in_print(cell), published_in_print(cell)]);
        let mut grid = Grid {
            quantity: match self.metric {
                Metric::DistanceM => "distance travelled (m)".to_owned(),
                Metric::TimeS => "simulated time (s)".to_owned(),
            },
            beside: "paper",
            source: Source::of(self.published.as_ref()),
            decimals: 2,
            of_trials: true,
            row_header: header,
            rows: abreast.rows(grid_cell),
            columns: side_by_side,
        };
        // The page takes the first column for the baseline.
        if let Some(baseline) = self.baseline.as_ref()
            && let Some(i) = values.iter().position(|by| *by == baseline.0)
        {
            grid.columns.swap(0, i);
            grid.rows.iter_mut().for_each(|row| row.cells.swap(0, i));
        }
        Set { grid, print: Some(print), lines, legend: self.legend(cells, labels), more: 0 }
    }
}

impl CoverageTable {
    /// Returns one line a cell.
    fn lines(&self, cells: &[CoverageCell], labels: &Labels) -> Lines {
        let name = |cell: &CoverageCell| {
            let mut parts = labels.values(&cell.rows);
            parts.push(labels.value(&self.by, &cell.by).to_owned());
            parts.join(", ")
        };
        let is_published = cells.iter().any(|cell| cell.published.is_some());
        let is_censored = cells.iter().any(|cell| !censored(cell).is_empty());
        let heads = self.rows.iter().chain([&self.by]).map(|factor| labels.factor(factor));
        let header = heads.collect::<Vec<_>>().join(", ");
        let mut columns = vec!["coverage".to_owned(), header, "ours".to_owned(), String::new()];
        if is_published {
            columns.extend(["", "paper's", ""].map(str::to_owned));
        }
        if is_censored {
            columns.push("got there".to_owned());
        }
        let mut table = Table::new(columns);
        let mut last = None;
        // A design may leave combinations out.
        for cell in cells.iter().filter(|cell| cell.trials > 0) {
            let percent = if last == Some(cell.percent) {
                String::new()
            } else {
                format!("{} %", cell.percent)
            };
            last = Some(cell.percent);
            let ours = cell.ours.map(|ours| (ours.mean, (ours.n > 1).then_some(ours.sd)));
            let published = cell.published.map(|(mean, sd, _)| (mean, sd));
            let mut row = vec![
                percent,
                name(cell),
                ours.map_or_else(|| "not reached".to_owned(), mean_and_sd),
                difference(cell.difference_percent),
            ];
            if is_published {
                row.extend([
                    cell.agreement.mark().to_owned(),
                    published.map_or_else(String::new, mean_and_sd),
                    difference(cell.published_difference_percent),
                ]);
            }
            if is_censored {
                row.push(censored(cell));
            }
            table.push(row.into_iter().map(Value::from).collect());
        }
        Lines::all(table, 2, [1])
    }

    fn legend(&self, cells: &[CoverageCell], labels: &Labels) -> Vec<String> {
        let is_compared = cells
            .iter()
            .any(|cell| cell.difference_percent.or(cell.published_difference_percent).is_some());
        let baseline = self.baseline.as_ref().filter(|_| is_compared);
        let against = baseline.map(|value| labels.value(&self.by, &value.0));
        against.map(|value| format!("%: of the mean against {value}")).into_iter().collect()
    }
}

fn grid_cell(cell: &CoverageCell) -> GridCell {
    let measured = |mean, sd, n| Measured { mean, sd, n: Some(n) };
    GridCell {
        ours: cell.ours.map(|s| measured(s.mean, (s.n > 1).then_some(s.sd), s.n)),
        difference_percent: cell.difference_percent,
        published: cell.published.map(|published| printed(published).into()),
        published_difference_percent: cell.published_difference_percent,
        agreement: cell.agreement,
        band: None,
    }
}

fn mean_and_sd((mean, sd): (f64, Option<f64>)) -> String {
    sd.map_or_else(|| format!("{mean:.2}"), |sd| format!("{mean:.2} ± {sd:.2}"))
}

fn difference(percent: Option<f64>) -> String {
    percent.map_or_else(String::new, |percent| format!("{percent:+.0} %"))
}

/// Counts the trials that got there, where not all did: the others are named, never dropped.
fn censored(cell: &CoverageCell) -> String {
    let reached = cell.ours.map_or(0, |ours| ours.n);
    if reached < cell.trials { format!("{reached} of {}", cell.trials) } else { String::new() }
}

fn ours_in_print(cell: &CoverageCell) -> String {
    let Some(ours) = &cell.ours else {
        return match cell.agreement {
            Agreement::Silent(silence) if silence != Silence::NotReached => silence.words().into(),
            _ => format!("not reached (0 of {})", cell.trials),
        };
    };
    let mut text = mean_and_sd((ours.mean, (ours.n > 1).then_some(ours.sd)));
    if let Some(difference) = cell.difference_percent {
        text.push_str(&format!(" ({difference:+.0} %)"));
    }
    if ours.n < cell.trials {
        text.push_str(&format!(" [{} of {}]", ours.n, cell.trials));
    }
    if let Some(tests) = cell.tests {
        text.push_str(&tests_in_print(&tests));
    }
    text
}

/// Returns effects with p at all runs, and at the paper's number of them.
fn tests_in_print(tests: &CellTests) -> String {
    let words = |difference: Option<Difference>| {
        difference.map_or_else(|| "-".to_owned(), |d| format!("{:+.2}, p {:.1e}", d.g, d.p))
    };
    format!("; g {}; first {}: {}", words(tests.all), tests.first_n, words(tests.first))
}

fn published_in_print(cell: &CoverageCell) -> String {
    let Some((mean, sd, _)) = cell.published else { return String::new() };
    let mut text = match cell.agreement.mark() {
        "" => String::new(),
        mark => format!("{mark} "),
    };
    text += &mean_and_sd((mean, sd));
    if let Some(difference) = cell.published_difference_percent {
        text.push_str(&format!(" ({difference:+.0} %)"));
    }
    text
}
