//! The paper's tables in as many columns as the terminal has, 80 in a pipe.

use crate::cli::fold::{aligned, wrapped};
use crate::stats::compatibility::Agreement;
use crate::studies::deadline::ManeuverTable;
use crate::studies::outcomes::OutcomeTable;
use crate::studies::prior_map::CoverageTable;
use crate::studies::prior_map::results::CoverageCell;
use crate::studies::{Findings, TableLayout, TableRequest, coverage_tables};
use crate::table::{Table, Value};

/// Ours beside the paper's, in `width` characters.
pub(super) fn table(
    findings: &Findings<'_>,
    request: &TableRequest,
    all: &[TableRequest],
    width: usize,
) -> String {
    let note = |text: &str| wrapped(text, 2, width);
    let body = match &request.layout {
        // Hundreds of lines, which agreement and effects sum up.
        TableLayout::CoverageTable(wanted) if findings.readings(wanted).len() > 1 => {
            let cells = findings.coverage_cells(wanted).iter().filter(|c| c.trials > 0).count();
            let readings = findings.readings(wanted).join(", ");
            note(&format!("{cells} cells, by {readings}, in {}.csv", request.id))
        }
        TableLayout::CoverageTable(wanted) => coverage_table(findings, wanted, width),
        TableLayout::AgreementTable(wanted) => {
            let table = findings.agreement_table_in_print(wanted, &coverage_tables(all));
            aligned(&table, 1, &[0], width)
                + &note(
                    "(log ratios to the baseline, ours on the paper's; rmse is the score, skill is over the paper's mean \
                     ratio; in: inside the paper's 95 % prediction interval)",
                )
        }
        TableLayout::EffectsTable(wanted) => {
            let (table, more) = findings.effects_table_in_print(wanted);
            let mut text = aligned(&table, 1, &[0, 1], width);
            if more > 0 {
                text.push_str(&note(&format!("{more} more in {}.csv", request.id)));
            }
            text + &note(
                "(largest first; means of ln over matched conditions; runs that got there of all, of either level; \
                 paper: from our mean at the first level to the paper's)",
            )
        }
        TableLayout::MeasuresTable(wanted) => {
            let (keys, table) = (wanted.rows.len(), findings.measures_table_in_print(wanted));
            aligned(&table, keys, &(0..keys).collect::<Vec<_>>(), width)
                + &note(&match findings.measures_rules(wanted) {
                    Some(rules) => format!(
                        "(mean ± standard deviation of trials; in parentheses: the paper's; {rules})"
                    ),
                    None => "(mean ± standard deviation of trials)".to_owned(),
                })
        }
        TableLayout::OutcomeTable(wanted) => outcome_table(findings, wanted, width),
        TableLayout::ManeuverTable(wanted) => maneuver_table(findings, wanted, width),
    };
    format!("{}{body}", wrapped(&request.title, 0, width))
}

/// One line a row of the table; in each column ours, how they agree, and the paper's.
fn outcome_table(findings: &Findings<'_>, wanted: &OutcomeTable, width: usize) -> String {
    let columns = findings.columns_of(wanted);
    let cells = findings.outcome_cells(wanted);
    let mut table = Table::new(wanted.rows.iter().chain(&columns).cloned());
    for line in cells.chunks(columns.len().max(1)) {
        let Some(first) = line.first() else { continue };
        let mut texts: Vec<Value> =
            first.rows.iter().map(|(_, value)| value.as_str().into()).collect();
        texts.extend(line.iter().map(|cell| {
            let ours = cell.ours.map(|estimate| estimate.value);
            let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.0}"));
            if wanted.published.is_none() {
                return Value::from(number(ours));
            }
            let papers = cell.published.map(|(papers, _)| papers);
            let mark = mark_of(cell.agreement);
            Value::from(format!("{} {mark} {:>2}", number(ours), number(papers)))
        }));
        table.push(texts);
    }
    let keys = wanted.rows.len();
    let mut text = aligned(&table, keys, &[], width);
    if wanted.published.is_some() {
        let rules = findings.outcome_rules(wanted).map(|rules| format!("; {rules}"));
        let note = format!("(ours, then the paper's{})", rules.unwrap_or_default());
        text.push_str(&wrapped(&note, 2, width));
    }
    text
}

/// A mark of one character: where there is nothing to compare, a dot.
fn mark_of(agreement: Agreement) -> &'static str {
    match agreement.mark() {
        "" => "·",
        mark => mark,
    }
}

/// What the planner expects of each maneuver, and what became of it.
fn maneuver_table(findings: &Findings<'_>, wanted: &ManeuverTable, width: usize) -> String {
    let columns =
        ["maneuver", "expected time", "time", "expected failure", "failure", "95 %", "passages"];
    let mut table = Table::new(columns);
    for row in findings.maneuver_rows(wanted) {
        let with =
            |unit: &str, x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1} {unit}"));
        let interval = row
            .met_failure_interval
            .map_or("-".to_owned(), |(low, high)| format!("{low:.1} to {high:.1} %"));
        let passages = Value::from(i64::try_from(row.passages).unwrap_or(i64::MAX));
        table.push(vec![
            row.name.into(),
            with("s", row.expected_time_s).into(),
            with("s", row.met_time_s).into(),
            with("%", row.expected_failure_percent).into(),
            with("%", row.met_failure_percent).into(),
            interval.into(),
            passages,
        ]);
    }
    aligned(&table, 1, &[0], width)
        + &wrapped("(expected: by the calibration; the others: in these trials)", 2, width)
}

/// One line a cell.
fn coverage_table(findings: &Findings<'_>, wanted: &CoverageTable, width: usize) -> String {
    let cells = findings.coverage_cells(wanted);
    let name = |cell: &CoverageCell| {
        let mut parts: Vec<&str> = cell.rows.iter().map(|(_, value)| value.as_str()).collect();
        parts.push(&cell.by);
        parts.join(", ")
    };
    let is_published = cells.iter().any(|cell| cell.published.is_some());
    let is_censored = cells.iter().any(|cell| !censored(cell).is_empty());
    let header = wanted.rows.iter().chain([&wanted.by]).cloned().collect::<Vec<_>>().join(", ");
    let mut columns = vec!["coverage".to_owned(), header, "ours".to_owned(), String::new()];
    if is_published {
        columns.extend(["", "paper's", ""].map(str::to_owned));
    }
    if is_censored {
        columns.push("got there".to_owned());
    }
    let mut table = Table { columns, rows: Vec::new() };
    let mut last = None;
    // A design may leave combinations out.
    for cell in cells.iter().filter(|cell| cell.trials > 0) {
        let percent =
            if last == Some(cell.percent) { String::new() } else { format!("{} %", cell.percent) };
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
        table.rows.push(row.into_iter().map(Value::from).collect());
    }
    let mut text = aligned(&table, 2, &[1], width);
    let mut notes = Vec::new();
    let compared = |cell: &CoverageCell| {
        cell.difference_percent.or(cell.published_difference_percent).is_some()
    };
    if let Some(baseline) = wanted.baseline.as_ref().filter(|_| cells.iter().any(compared)) {
        notes.push(format!("%: of the mean against {}", baseline.0));
    }
    notes.extend(findings.coverage_rules(wanted));
    if !notes.is_empty() {
        text.push_str(&wrapped(&format!("({})", notes.join("; ")), 2, width));
    }
    text
}

fn mean_and_sd((mean, sd): (f64, Option<f64>)) -> String {
    sd.map_or_else(|| format!("{mean:.2}"), |sd| format!("{mean:.2} ± {sd:.2}"))
}

fn difference(percent: Option<f64>) -> String {
    percent.map_or_else(String::new, |percent| format!("{percent:+.0} %"))
}

/// Trials that did not get there are told, never dropped.
fn censored(cell: &CoverageCell) -> String {
    let reached = cell.ours.map_or(0, |ours| ours.n);
    if reached < cell.trials { format!("{reached} of {}", cell.trials) } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::{Sha256Digest, TrialKey};
    use crate::studies::outcomes::Quantity;
    use crate::studies::{Outcome, TrialRecord};
    use std::collections::BTreeMap;

    const STRATEGIES: [&str; 5] =
        ["random", "frontier", "normalized-frontier", "corridors-first", "complete-corridor"];

    fn record(deadline: &str, strategy: &str, trial: u32, outcome: Outcome) -> TrialRecord {
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        TrialRecord {
            key: TrialKey(Sha256Digest::of(format!("{deadline}{strategy}{trial}"))),
            condition: vec![
                pair("start", "A"),
                pair("deadline-s", deadline),
                pair("strategy", strategy),
            ],
            trial,
            outcome,
            cause: String::new(),
            measures: BTreeMap::new(),
            series: Vec::new(),
            sim_seconds: 1.0,
            chain: Vec::new(),
        }
    }

    #[test]
    fn five_strategies_beside_the_papers_numbers_fit_into_80_columns() {
        let factor = |name: &str, values: &[&str]| {
            (name.to_owned(), values.iter().map(|v| (*v).to_owned()).collect::<Vec<_>>())
        };
        let factors = [
            factor("start", &["A"]),
            factor("deadline-s", &["680", "68"]),
            factor("strategy", &STRATEGIES),
        ];
        let mut records = Vec::new();
        for deadline in ["680", "68"] {
            for (i, strategy) in (0..).zip(STRATEGIES) {
                for trial in 0..4 {
                    let outcome = if trial < i { Outcome::REACHED } else { Outcome::LATE };
                    records.push(record(deadline, strategy, trial, outcome));
                }
            }
        }
        let csv = "start,deadline-s,strategy,value,n\nA,680,frontier,26,50\nA,680,normalized-frontier,59,50\n\
                   A,680,corridors-first,12,50\nA,680,complete-corridor,100,50\n";
        let published = BTreeMap::from([("success".to_owned(), Table::from_csv(csv).unwrap())]);
        let findings = Findings::new(&factors, &records, &published);
        let request = TableRequest {
            id: "table-1".to_owned(),
            title: "Table 1, success rate (%)".to_owned(),
            layout: TableLayout::OutcomeTable(OutcomeTable {
                show: Quantity::Share(vec![Outcome::REACHED]),
                by: "strategy".to_owned(),
                rows: vec!["start".to_owned(), "deadline-s".to_owned()],
                only: BTreeMap::new(),
                published: Some("success".to_owned()),
            }),
        };
        let text = table(&findings, &request, &[], 80);
        assert_eq!(
            text,
            "Table 1, success rate (%)
         deadline-                    normalized-  corridors-  complete-
  start          s  random  frontier     frontier       first   corridor
      A        680  0 ·  -   25 ✓ 26      50 ✓ 59     75 ≠ 12  100 ✓ 100
      A         68  0 ·  -   25 ·  -      50 ·  -     75 ·  -   100 ·  -
  (ours, then the paper's; shares: ✓ compatible at 95 %, ≠ not, by Newcombe's
  interval of the difference at both numbers of trials)
"
        );
        let narrow = table(&findings, &request, &[], 40);
        assert!(narrow.lines().all(|line| line.chars().count() <= 40), "{narrow}");
    }
}
