//! What is made of trials: tables cell by cell, verdicts, and everything else by digest.

use super::account::verdicts;
use super::{Account, Change, Discrepancy, ResultFile, Tolerances};
use crate::json::canonical_of;
use crate::table::{Table, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Derived results held against one another.
#[derive(Debug, Default)]
pub(super) struct Derived {
    pub(super) cells: Vec<Discrepancy>,
    pub(super) files: Vec<Discrepancy>,
    pub(super) claims: Vec<Discrepancy>,
    /// Cells that both sides have.
    pub(super) compared_cells: usize,
    /// Cells whose numbers differ by no more than was admitted.
    pub(super) tolerated_cells: usize,
}

/// Compares everything under `results/`. `trials_differ` says whether the records differ already: then the files that
/// only list them anew are not reported a second time.
pub(super) fn compare(
    a: &Account,
    b: &Account,
    tolerances: &Tolerances,
    trials_differ: bool,
) -> Derived {
    let mut derived = Derived::default();
    let mut explained: BTreeSet<String> = BTreeSet::new();
    if trials_differ || !tolerances.is_none() {
        explained.extend(["trials.csv".to_owned(), "series.csv".to_owned()]);
    }
    for (path, file) in &a.results {
        let Some(other) = b.results.get(path) else { continue };
        let Some(stem) = path.strip_suffix(".csv").filter(|stem| stem.starts_with("tables/"))
        else {
            continue;
        };
        let Some((x, y)) = table(file).zip(table(other)) else {
            if file.digest != other.digest {
                explained.insert(format!("{stem}.md"));
            }
            continue;
        };
        let before = derived.cells.len();
        cells(path, &x, &y, tolerances, &mut derived);
        // The table in print says the same again.
        if derived.cells.len() > before || !tolerances.is_none() {
            explained.extend([path.clone(), format!("{stem}.md")]);
        }
    }
    derived.claims = claims(a, b, tolerances);
    if !derived.claims.is_empty() || !tolerances.is_none() {
        explained.extend(["claims.json", "claims.csv", "comparisons.csv"].map(str::to_owned));
    }
    // Drawings follow from tables and curves; with tolerances declared, other bytes alone say nothing.
    let is_drawing = |path: &str| path.starts_with("figures/");
    for path in union(a.results.keys(), b.results.keys()) {
        let digest = |side: &Account| side.results.get(path).map(|file| file.digest);
        let (from, to) = (digest(a), digest(b));
        let both = from.is_some() && to.is_some();
        let silent =
            both && (explained.contains(path) || (is_drawing(path) && !tolerances.is_none()));
        if from != to && !silent {
            derived
                .files
                .push(Discrepancy::File { path: path.clone(), change: Change { from, to } });
        }
    }
    derived
}

/// Reads the table that a file's text is.
pub(super) fn table(file: &ResultFile) -> Option<Table> {
    Table::from_csv(file.text.as_deref()?).ok()
}

fn union<'a>(
    a: impl Iterator<Item = &'a String>,
    b: impl Iterator<Item = &'a String>,
) -> BTreeSet<&'a String> {
    a.chain(b).collect()
}

fn cells(path: &str, a: &Table, b: &Table, tolerances: &Tolerances, derived: &mut Derived) {
    let (a_rows, b_rows) = rows(a, b);
    let labels: Vec<&(usize, String)> = {
        let new = b_rows.keys().filter(|label| !a_rows.contains_key(*label));
        a_rows.keys().chain(new).collect()
    };
    let new_columns = b.columns.iter().filter(|column| a.column(column).is_none());
    let columns: Vec<&String> = a.columns.iter().chain(new_columns).collect();
    let mut push = |row: &str, column: &str, change| {
        let (table, row, column) = (path.to_owned(), row.to_owned(), column.to_owned());
        derived.cells.push(Discrepancy::Cell { table, row, column, change });
    };
    for label in labels {
        let (x, y) = (a_rows.get(label), b_rows.get(label));
        let (Some(x), Some(y)) = (x, y) else {
            let whole = |row: Option<&&Vec<Value>>| row.map(|row| in_words(row));
            push(&label.1, "the whole row", Change { from: whole(x), to: whole(y) });
            continue;
        };
        for column in &columns {
            let value = |table: &Table, row: &[Value]| Some(row[table.column(column)?].clone());
            let (from, to) = (value(a, x), value(b, y));
            derived.compared_cells += usize::from(from.is_some() && to.is_some());
            if from == to {
                continue;
            }
            let numbers = |v: &Option<Value>| v.as_ref().and_then(Value::as_f64);
            if let Some((p, q)) = numbers(&from).zip(numbers(&to))
                && tolerances.admits(column, p, q)
            {
                derived.tolerated_cells += 1;
                continue;
            }
            let text = |v: Option<Value>| v.map(|v| v.to_string());
            push(&label.1, column, Change { from: text(from), to: text(to) });
        }
    }
}

fn in_words(row: &[Value]) -> String {
    row.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Rows by their place in the order of the table that has them first, and what names them.
type Rows<'a> = BTreeMap<(usize, String), &'a Vec<Value>>;

/// Returns the rows of both tables under common names: their leading whole numbers and words, where no two rows of a table
/// have the same; else their numbers.
fn rows<'a>(a: &'a Table, b: &'a Table) -> (Rows<'a>, Rows<'a>) {
    let is_name = |value: &Value| matches!(value, Value::Integer(_) | Value::Text(_));
    let leading = a
        .columns
        .iter()
        .zip(&b.columns)
        .enumerate()
        .take_while(|(i, (x, y))| {
            x == y && a.rows.iter().chain(&b.rows).all(|row| is_name(&row[*i]))
        })
        .count();
    let names = |table: &Table| -> Vec<String> {
        let name = |row: &Vec<Value>| {
            let parts = table.columns.iter().zip(row).take(leading);
            parts.map(|(column, value)| format!("{column}={value}")).collect::<Vec<_>>().join(" ")
        };
        table.rows.iter().map(name).collect()
    };
    let (mut x, mut y) = (names(a), names(b));
    let distinct = |names: &[String]| names.iter().collect::<BTreeSet<_>>().len() == names.len();
    if leading == 0 || !distinct(&x) || !distinct(&y) {
        let numbered = |table: &Table| (1..=table.rows.len()).map(|i| format!("row {i}")).collect();
        (x, y) = (numbered(a), numbered(b));
    }
    let mut order: Vec<&String> = x.iter().collect();
    order.extend(y.iter().filter(|name| !x.contains(name)));
    let place = |name: &String| order.iter().position(|n| *n == name).unwrap_or_default();
    let keyed = |names: &[String], table: &'a Table| {
        let keys = names.iter().map(|name| (place(name), name.clone()));
        keys.zip(&table.rows).collect()
    };
    (keyed(&x, a), keyed(&y, b))
}

/// Returns the verdicts that changed, and, where both sides hold the numbers behind them, those of unchanged verdicts.
fn claims(a: &Account, b: &Account, tolerances: &Tolerances) -> Vec<Discrepancy> {
    // As they are written: NaN is equal to itself there.
    let evidence = |side: &Account| -> BTreeMap<String, String> {
        let list = verdicts(&side.results).unwrap_or_default();
        list.into_iter().map(|verdict| (verdict.id.clone(), canonical_of(&verdict))).collect()
    };
    let (x, y) = (evidence(a), evidence(b));
    let mut changes = Vec::new();
    for id in union(a.claims.keys(), b.claims.keys()) {
        let (from, to) = (a.claims.get(id).copied(), b.claims.get(id).copied());
        let other_numbers =
            tolerances.is_none() && x.get(id).zip(y.get(id)).is_some_and(|(x, y)| x != y);
        if from != to || other_numbers {
            changes.push(Discrepancy::Claim { id: id.clone(), change: Change { from, to } });
        }
    }
    changes
}
