//! The paper's tables in 80 columns.

use crate::studies::prior_map::TableRequest;
use crate::studies::prior_map::results::{CoverageCell, Findings};

/// Ours beside the paper's, one line a cell.
pub(super) fn coverage_table(findings: &Findings<'_>, request: &TableRequest) -> String {
    let cells = findings.coverage_cells(&request.coverage_table);
    let name = |cell: &CoverageCell| {
        let mut parts: Vec<&str> = cell.rows.iter().map(|(_, value)| value.as_str()).collect();
        parts.push(&cell.by);
        parts.join(", ")
    };
    let width = cells.iter().map(|c| name(c).chars().count()).max().unwrap_or(0).max(5);
    let mut text = format!("{}\n", request.title);
    let papers = if cells.iter().any(|c| c.published.is_some()) { "paper's" } else { "" };
    let mut line = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    line(format!(
        "  coverage  {:width$}  {:>16} {:>6}   {papers:>16}",
        request.coverage_table.by, "ours", ""
    ));
    let mut last = None;
    for cell in &cells {
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
