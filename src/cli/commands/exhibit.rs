//! A study's tables in as many columns as the terminal has, 80 in a pipe.

use crate::cli::fold::{aligned, fits, wrapped};
use crate::studies::{Exhibit, Lines};
use crate::table::{Table, Value};

/// What marks a number of ours that lies apart from the paper's.
const APART: char = '\u{2260}';

/// Returns the table, ours beside the paper's, in `width` characters.
pub(super) fn in_lines(exhibit: &Exhibit, width: usize) -> String {
    let mut text = head(exhibit, width);
    let Lines::All { table, keys, left } = &exhibit.set.lines else { return text };
    text += &body(table, *keys, left, width);
    if exhibit.set.more > 0 {
        text += &note(&format!("{} more in {}.csv", exhibit.set.more, exhibit.id), width);
    }
    if let Some(legend) = legend_of(exhibit) {
        text += &note(&format!("({legend})"), width);
    }
    text
}

/// Returns how the lines of a table are to be read; `None` where they say it themselves.
pub(super) fn legend_of(exhibit: &Exhibit) -> Option<String> {
    let is_shown = matches!(exhibit.set.lines, Lines::All { .. });
    let legend: Vec<String> = exhibit.set.legend.iter().cloned().chain(exhibit.rules()).collect();
    (is_shown && !legend.is_empty()).then(|| legend.join("; "))
}

/// As much of a table as there is room for, without its legend.
pub(super) struct Shown {
    pub(super) text: String,
    /// How many of its lines are shown.
    pub(super) rows: usize,
    /// Whether those are all.
    pub(super) is_whole: bool,
}

impl Shown {
    /// Shows the table in at most `lines` lines of `width` characters: all of it, or the lines in which ours and the paper's lie
    /// apart before others; `None` where not one line has room.
    pub(super) fn within(exhibit: &Exhibit, width: usize, lines: usize) -> Option<Self> {
        let head = head(exhibit, width);
        let Lines::All { table, keys, left } = &exhibit.set.lines else {
            let fits = head.lines().count() <= lines;
            return fits.then_some(Self { text: head, rows: 0, is_whole: true });
        };
        let all = table.rows.len();
        let mut telling: Vec<usize> = (0..all).collect();
        let apart = |row: &usize| {
            let cells = table.rows[*row].iter();
            cells.map(|cell| cell.to_string().matches(APART).count()).sum::<usize>()
        };
        // Stable: alike lines stay in the order of the table.
        telling.sort_by_key(|row| std::cmp::Reverse(apart(row)));
        for rows in (1..=all.min(lines)).rev() {
            let mut chosen = telling[..rows].to_vec();
            chosen.sort_unstable();
            let mut text = head.clone() + &body(&part(table, &chosen), *keys, left, width);
            let more = exhibit.set.more + all - rows;
            if more > 0 {
                text += &note(&format!("{more} more in {}.csv", exhibit.id), width);
            }
            if text.lines().count() <= lines {
                return Some(Self { text, rows, is_whole: rows == all });
            }
        }
        None
    }
}

/// Returns the title, and what stands before any line.
fn head(exhibit: &Exhibit, width: usize) -> String {
    let mut text = wrapped(&exhibit.title, 0, width);
    if let Some(answer) = &exhibit.answer {
        text += &note(answer, width);
    }
    if let Lines::Elsewhere { cells, by } = &exhibit.set.lines {
        text += &note(&format!("{cells} cells, by {by}, in {}.csv", exhibit.id), width);
    }
    text
}

fn note(text: &str, width: usize) -> String {
    wrapped(text, 2, width)
}

/// Returns these rows of `table`; what a line leaves to the line above it in the first column is said where that is not there.
fn part(table: &Table, rows: &[usize]) -> Table {
    let mut first = Vec::new();
    let mut last = String::new();
    for row in &table.rows {
        let own = row.first().map(ToString::to_string).unwrap_or_default();
        if !own.is_empty() {
            last = own;
        }
        first.push(last.clone());
    }
    let mut part = Table::new(table.columns.iter().cloned());
    let mut above: Option<&String> = None;
    for &row in rows {
        let mut cells = table.rows[row].clone();
        let is_left_out = cells.first().is_some_and(|cell| cell.to_string().is_empty());
        if is_left_out && above != Some(&first[row]) {
            cells[0] = first[row].as_str().into();
        }
        above = Some(&first[row]);
        part.push(cells);
    }
    part
}

/// Returns the lines. Where they are too wide, what the names in the second column have in common heads its lines, so that ours and
/// the paper's stay in one line.
fn body(table: &Table, keys: usize, left: &[usize], width: usize) -> String {
    let is_named = keys == 2 && left.contains(&1);
    if fits(table, width) || !is_named {
        return aligned(table, keys, left, width);
    }
    let split = |name: &str| {
        let (group, own) = name.rsplit_once(", ").unwrap_or(("", name));
        (group.to_owned(), own.to_owned())
    };
    let mut heads = table.columns.clone();
    heads[1] = split(&heads[1]).1;
    let mut narrow = Table::new(heads);
    let mut groups = Vec::new();
    for row in &table.rows {
        let (group, own) = split(&row[1].to_string());
        groups.push(group);
        let mut row = row.clone();
        row[1] = Value::from(own);
        narrow.push(row);
    }
    let text = aligned(&narrow, keys, left, width);
    let lines: Vec<&str> = text.lines().collect();
    if !fits(&narrow, width) || lines.len() < groups.len() {
        return aligned(table, keys, left, width);
    }
    let (heads, rows) = lines.split_at(lines.len() - groups.len());
    let mut text = String::new();
    for line in heads {
        text += &format!("{line}\n");
    }
    let mut last = "";
    for (group, row) in groups.iter().zip(rows) {
        if group != last {
            text += &note(group, width);
            last = group;
        }
        text += &format!("{row}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::assemble;
    use crate::condition::Condition;
    use crate::digest::{Sha256Digest, TrialKey};
    use crate::factor::Factor;
    use crate::report::ReportTable;
    use crate::studies::fixture::with_findings;
    use crate::studies::outcomes::{OutcomeTable, Quantity};
    use crate::studies::{
        Findings, Ledger, Measures, Outcome, TableLayout, TableRequest, TrialRecord,
    };
    use crate::table::{Table, Value};
    use std::collections::BTreeMap;

    const STRATEGIES: [&str; 5] =
        ["random", "frontier", "normalized-frontier", "corridors-first", "complete-corridor"];

    fn record(deadline: &str, strategy: &str, trial: u32, outcome: Outcome) -> TrialRecord {
        TrialRecord {
            key: TrialKey(Sha256Digest::of(format!("{deadline}{strategy}{trial}"))),
            condition: Condition::from([
                ("start", "A"),
                ("deadline-s", deadline),
                ("strategy", strategy),
            ]),
            trial,
            outcome,
            cause: String::new(),
            measures: Measures::new(),
            series: Vec::new(),
            sim_seconds: 1.0,
            chain: Vec::new(),
        }
    }

    #[test]
    fn five_strategies_beside_the_papers_numbers_fit_into_80_columns() {
        let factor = |name: &str, values: &[&str]| Factor::new(name, values.iter().copied());
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
        let ledger = Ledger::of(&records);
        let findings = Findings::new(&factors, &ledger, &published);
        let request = TableRequest {
            id: "table-1".to_owned(),
            title: "Table 1, success rate (%)".to_owned(),
            layout: TableLayout::OutcomeTable(OutcomeTable {
                show: Quantity::Share(vec![Outcome::REACHED]),
                by: "strategy".to_owned(),
                rows: vec!["start".to_owned(), "deadline-s".to_owned()],
                only: BTreeMap::new(),
                published: Some("success".to_owned()),
                over: None,
            }),
        };
        let exhibit = request.exhibit(&findings, &[]);
        let text = in_lines(&exhibit, 80);
        assert_eq!(
            text,
            "Table 1, success rate (%)
         deadline-                    normalized-  corridors-  complete-
  start          s  random  frontier     frontier       first   corridor
      A        680  0 ·  -   25 ✓ 26      50 ✓ 59     75 ≠ 12  100 ✓ 100
      A         68  0 ·  -   25 ·  -      50 ·  -     75 ·  -   100 ·  -
  (ours, then the paper's, after · where there is nothing to compare; shares: ✓
  compatible at 95 %, ≠ not, by Newcombe's interval of the difference at both
  numbers of trials)
"
        );
        let narrow = in_lines(&exhibit, 40);
        assert!(narrow.lines().all(|line| line.chars().count() <= 40), "{narrow}");
    }

    /// Checks each layout of tables, of made-up findings.
    fn with_exhibits(check: impl Fn(&TableLayout, &Exhibit)) {
        with_findings(|findings, requests| {
            for request in requests {
                check(&request.layout, &request.exhibit(findings, requests));
            }
        });
    }

    #[test]
    fn the_dictionary_says_what_stands_in_every_column_of_the_csv() {
        with_exhibits(|_, exhibit| {
            let id = &exhibit.id;
            let told = assemble::described_table(exhibit, format!("results/tables/{id}.csv"));
            assert!(!exhibit.tidy.rows.is_empty(), "{id}");
            let names: Vec<&str> = told.columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, exhibit.tidy.columns, "{id}");
            for (i, column) in told.columns.iter().enumerate() {
                let place = format!("{id}, {}", column.name);
                assert!(!column.meaning.is_empty(), "{place}");
                for value in exhibit.tidy.rows.iter().map(|row| &row[i]) {
                    let is_known = match value {
                        Value::Missing => column.empty.is_some(),
                        Value::Text(text) => column.among.is_empty() || column.among.contains(text),
                        number => number.as_f64().is_some_and(|x| {
                            column.least.is_none_or(|least| least <= x)
                                && column.most.is_none_or(|most| x <= most)
                        }),
                    };
                    assert!(is_known, "{place}: {value}");
                }
            }
        });
    }

    /// Returns the numbers of the tidy form's column `name`, the least first.
    fn numbers(exhibit: &Exhibit, name: &str) -> Vec<f64> {
        let values = exhibit.tidy.rows.iter().map(|row| exhibit.tidy.value(row, name));
        sorted(values.filter_map(Value::as_f64))
    }

    fn sorted(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut numbers: Vec<f64> = numbers.collect();
        numbers.sort_by(f64::total_cmp);
        numbers
    }

    /// Compares numbers; the page shows more digits of computed numbers than the CSV.
    fn assert_same(page: &[f64], csv: &[f64], place: &str) {
        assert_eq!(page.len(), csv.len(), "{place}");
        for (a, b) in page.iter().zip(csv) {
            assert!((a - b).abs() <= 1e-5 * b.abs(), "{place}: {a} on the page, {b} in the CSV");
        }
    }

    #[test]
    fn the_page_has_the_numbers_of_the_csv() {
        with_exhibits(|layout, exhibit| {
            let id = &exhibit.id;
            let page = ReportTable::of(exhibit.clone(), "section 4.2", 10);
            assert!(page.rows.iter().all(|row| row.cells.len() == page.columns.len()), "{id}");
            let cells = || page.rows.iter().flat_map(|row| &row.cells);
            let (ours, published) = match layout {
                TableLayout::CoverageTable(_) | TableLayout::MeasuresTable(_) => {
                    ("mean", "published")
                }
                TableLayout::OutcomeTable(_) => ("value", "published"),
                TableLayout::EffectsTable(_) => ("effect-percent", "gap-percent"),
                // These have a row where the tidy form has one.
                TableLayout::AgreementTable(_)
                | TableLayout::ReadingsTable(_)
                | TableLayout::InferenceTable(_)
                | TableLayout::FromTrialsTable(_)
                | TableLayout::ManeuverTable(_) => {
                    assert_eq!(page.rows.len(), exhibit.tidy.rows.len(), "{id}");
                    return;
                }
            };
            assert_eq!(cells().count(), exhibit.tidy.rows.len(), "{id}");
            let shown = sorted(cells().filter_map(|cell| Some(cell.ours?.mean)));
            assert_same(&shown, &numbers(exhibit, ours), id);
            let shown = sorted(cells().filter_map(|cell| Some(cell.published?.mean)));
            assert_same(&shown, &numbers(exhibit, published), id);
            if exhibit.tidy.column("agreement").is_some() {
                let mut shown: Vec<&str> = cells().map(|cell| cell.agreement.name()).collect();
                let rows = exhibit.tidy.rows.iter();
                let mut told: Vec<String> =
                    rows.map(|row| exhibit.tidy.value(row, "agreement").to_string()).collect();
                shown.sort_unstable();
                told.sort_unstable();
                assert_eq!(shown, told, "{id}");
            }
        });
    }

    #[test]
    fn terminal_and_document_say_alike_what_marks_mean_and_what_is_left_out() {
        let on_one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        with_exhibits(|_, exhibit| {
            let id = &exhibit.id;
            let document = assemble::in_markdown(exhibit);
            let lines = document.lines().filter(|line| line.starts_with('|')).count();
            assert_eq!(lines, exhibit.print().rows.len() + 2, "{id}: a line a row, below two");
            let terminal = in_lines(exhibit, 80);
            if matches!(exhibit.set.lines, Lines::Elsewhere { .. }) {
                assert!(on_one_line(&terminal).ends_with(&format!("in {id}.csv")), "{terminal}");
                return;
            }
            for text in [&document, &terminal] {
                let text = on_one_line(text);
                if let Some(answer) = &exhibit.answer {
                    assert!(text.contains(answer.as_str()), "{id}: {text}");
                }
                if let Some(rules) = exhibit.rules() {
                    assert!(text.contains(&rules), "{id}: {text}");
                }
                let more = format!("{} more in {id}.csv", exhibit.set.more);
                assert_eq!(text.contains(&more), exhibit.set.more > 0, "{id}: {text}");
            }
        });
    }
}
