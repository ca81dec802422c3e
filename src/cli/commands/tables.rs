//! The paper's tables in 80 columns.

use crate::studies::outcomes::OutcomeTable;
use crate::studies::prior_map::CoverageTable;
use crate::studies::prior_map::results::CoverageCell;
use crate::studies::{Findings, TableLayout, TableRequest, coverage_tables};
use crate::table::{Table, Value};

/// Ours beside the paper's.
pub(super) fn table(
    findings: &Findings<'_>,
    request: &TableRequest,
    all: &[TableRequest],
) -> String {
    let body = match &request.layout {
        // Hundreds of lines, which agreement and effects sum up.
        TableLayout::CoverageTable(wanted) if findings.readings(wanted).len() > 1 => {
            let cells = findings.coverage_cells(wanted).iter().filter(|c| c.trials > 0).count();
            let readings = findings.readings(wanted).join(", ");
            format!("  {cells} cells, by {readings}, in {}.csv\n", request.id)
        }
        TableLayout::CoverageTable(wanted) => coverage_table(findings, wanted),
        TableLayout::AgreementTable(wanted) => {
            aligned(&findings.agreement_table_in_print(wanted, &coverage_tables(all)))
                + "  (log ratios to the baseline, ours on the paper's; rmse is the score, skill is over the\n  paper's mean ratio; in: inside the paper's 95 % prediction interval)\n"
        }
        TableLayout::EffectsTable(wanted) => {
            let (table, more) = findings.effects_table_in_print(wanted);
            let mut text = aligned(&table);
            if more > 0 {
                text.push_str(&format!("  {more} more in {}.csv\n", request.id));
            }
            text + "  (largest first; means of ln over matched conditions; runs that got there of all, of either level;\n  paper: from our mean at the first level to the paper's)\n"
        }
        TableLayout::MeasuresTable(wanted) => {
            aligned(&findings.measures_table_in_print(wanted))
                + "  (mean ± standard deviation of trials; in parentheses: the paper's)\n"
        }
        TableLayout::OutcomeTable(wanted) => outcome_table(findings, wanted),
        TableLayout::ManeuverTable(wanted) => aligned(&findings.maneuver_table(wanted)),
    };
    format!("{}\n{body}", request.title)
}

/// One line a row of the table; in each column ours, and the paper's in parentheses.
fn outcome_table(findings: &Findings<'_>, wanted: &OutcomeTable) -> String {
    let columns = findings.columns_of(wanted);
    let cells = findings.outcome_cells(wanted);
    let mut table = Table::new(wanted.rows.iter().chain(&columns).cloned());
    for line in cells.chunks(columns.len().max(1)) {
        let Some(first) = line.first() else { continue };
        let mut texts: Vec<Value> =
            first.rows.iter().map(|(_, value)| value.as_str().into()).collect();
        texts.extend(line.iter().map(|cell| {
            let ours = cell.ours.map_or("-".to_owned(), |e| format!("{:.0}", e.value));
            Value::from(match cell.published {
                Some((papers, _)) => format!("{ours} ({papers:.0})"),
                None if wanted.published.is_some() => format!("{ours} (-)"),
                None => ours,
            })
        }));
        table.push(texts);
    }
    let mut text = aligned(&table);
    if wanted.published.is_some() {
        text.push_str("  (in parentheses: the paper's)\n");
    }
    text
}

/// A table as lines, its columns aligned to the right.
fn aligned(table: &Table) -> String {
    let mut lines = vec![table.columns.clone()];
    lines.extend(table.rows.iter().map(|row| row.iter().map(ToString::to_string).collect()));
    let width = |i: usize| lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        let padded: Vec<String> =
            line.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}")).collect();
        text.push_str(&format!("  {}\n", padded.join("  ")));
    }
    text
}

/// One line a cell.
fn coverage_table(findings: &Findings<'_>, wanted: &CoverageTable) -> String {
    let cells = findings.coverage_cells(wanted);
    let name = |cell: &CoverageCell| {
        let mut parts: Vec<&str> = cell.rows.iter().map(|(_, value)| value.as_str()).collect();
        parts.push(&cell.by);
        parts.join(", ")
    };
    let width = cells.iter().map(|c| name(c).chars().count()).max().unwrap_or(0).max(5);
    let mut text = String::new();
    let papers = if cells.iter().any(|c| c.published.is_some()) { "paper's" } else { "" };
    let mut line = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    let header = wanted.rows.iter().chain([&wanted.by]).cloned().collect::<Vec<_>>().join(", ");
    let width = width.max(header.chars().count());
    line(format!("  coverage  {header:width$}  {:>16} {:>6}   {papers:>16}", "ours", ""));
    let mut last = None;
    // A design may leave combinations out.
    for cell in cells.iter().filter(|cell| cell.trials > 0) {
        let percent =
            if last == Some(cell.percent) { String::new() } else { format!("{} %", cell.percent) };
        last = Some(cell.percent);
        line(format!(
            "  {percent:>8}  {:width$}  {:>16} {:>6}   {:>16} {:>6}{}",
            name(cell),
            cell.ours.map_or_else(
                || "not reached".to_owned(),
                |ours| mean_and_sd(ours.mean, (ours.n > 1).then_some(ours.sd))
            ),
            difference(cell.difference_percent),
            cell.published.map_or_else(String::new, |(mean, sd, _)| mean_and_sd(mean, sd)),
            difference(cell.published_difference_percent),
            censored(cell),
        ));
    }
    text
}

fn mean_and_sd(mean: f64, sd: Option<f64>) -> String {
    sd.map_or_else(|| format!("{mean:.2}"), |sd| format!("{mean:.2} ± {sd:.2}"))
}

fn difference(percent: Option<f64>) -> String {
    percent.map_or_else(String::new, |percent| format!("{percent:+.0} %"))
}

/// Trials that did not get there are told, never dropped.
fn censored(cell: &CoverageCell) -> String {
    let reached = cell.ours.map_or(0, |ours| ours.n);
    if reached < cell.trials { format!("  {reached} of {}", cell.trials) } else { String::new() }
}
