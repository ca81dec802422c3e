//! A study's tables in as many columns as the terminal has, 80 in a pipe.

use crate::cli::fold::{aligned, wrapped};
use crate::studies::{Exhibit, Lines};

/// Returns the table, ours beside the paper's, in `width` characters.
pub(super) fn in_lines(exhibit: &Exhibit, width: usize) -> String {
    let note = |text: &str| wrapped(text, 2, width);
    let mut title = wrapped(&exhibit.title, 0, width);
    if let Some(answer) = &exhibit.answer {
        title.push_str(&note(answer));
    }
    let (table, keys, left) = match &exhibit.set.lines {
        Lines::All { table, keys, left } => (table, *keys, left),
        Lines::Elsewhere { cells, by } => {
            return title + &note(&format!("{cells} cells, by {by}, in {}.csv", exhibit.id));
        }
    };
    let mut text = title + &aligned(table, keys, left, width);
    if exhibit.set.more > 0 {
        text.push_str(&note(&format!("{} more in {}.csv", exhibit.set.more, exhibit.id)));
    }
    let legend: Vec<String> = exhibit.set.legend.iter().cloned().chain(exhibit.rules()).collect();
    if !legend.is_empty() {
        text.push_str(&note(&format!("({})", legend.join("; "))));
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
  (ours, then the paper's; shares: ✓ compatible at 95 %, ≠ not, by Newcombe's
  interval of the difference at both numbers of trials)
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
