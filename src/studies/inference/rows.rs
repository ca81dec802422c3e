//! Rows of what an inference found, whatever it inferred from: as a table, for a terminal and for a page.

use crate::studies::Columns;
use crate::studies::exhibit::{Grid, GridCell, GridRow, Lines, Measured, Set};
use crate::table::{Column, Table, Value};

/// One row: what stands in the columns that the table declares.
pub(super) type Row = Vec<Value>;

/// Returns columns whose cells stand in the rows in the same order.
pub(super) fn of_rows<'a>(declared: Vec<Column>) -> Columns<'a, Row> {
    let each = |columns: Columns<'a, Row>, (at, column): (usize, Column)| {
        columns.with(column, move |row: &Row| row.get(at).cloned().unwrap_or(Value::Missing))
    };
    declared.into_iter().enumerate().fold(Columns::none(), each)
}

/// How rows are set.
pub(super) struct Shape {
    /// The columns.
    pub declared: Vec<Column>,
    /// How many of them name a row.
    pub keys: usize,
    /// How many rows readers see.
    pub most: usize,
    /// What kind of numbers these are.
    pub about: &'static str,
    /// Decimals of a page.
    pub decimals: u8,
}

impl Shape {
    /// Sets the rows `cells`.
    pub(super) fn set(&self, cells: &[Row]) -> Set {
        let Self { declared, keys, most, about, decimals } = self;
        let mut lines = Table::new(declared.iter().map(|column| column.name.clone()));
        for row in cells.iter().take(*most) {
            lines.push(row.iter().map(brief).collect());
        }
        let left: Vec<usize> = (0..declared.len())
            .filter(|at| cells.iter().any(|row| matches!(row.get(*at), Some(Value::Text(_)))))
            .collect();
        // A page has numbers in its cells, so that all words name the row.
        let naming: Vec<usize> =
            (0..declared.len()).filter(|at| at < keys || left.contains(at)).collect();
        let numeric: Vec<usize> = (*keys..declared.len())
            .filter(|at| cells.iter().any(|row| row[*at].as_f64().is_some()))
            .collect();
        let row = |row: &Row| GridRow {
            label: naming
                .iter()
                .filter(|at| row[**at] != Value::Missing)
                .map(|at| in_label(&declared[*at].name, &row[*at]))
                .collect::<Vec<_>>()
                .join(", "),
            cells: numeric
                .iter()
                .map(|at| GridCell {
                    ours: row[*at].as_f64().map(|mean| Measured { mean, sd: None, n: None }),
                    ..GridCell::default()
                })
                .collect(),
        };
        let meanings = numeric.iter().map(|at| {
            let Column { name, meaning, .. } = &declared[*at];
            format!("; {name}: {}{}", meaning[..1].to_lowercase(), &meaning[1..])
        });
        let grid = Grid {
            quantity: std::iter::once((*about).to_owned()).chain(meanings).collect(),
            decimals: *decimals,
            row_header: naming
                .iter()
                .map(|at| declared[*at].name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
            columns: numeric.iter().map(|at| declared[*at].name.clone()).collect(),
            rows: cells.iter().take(*most).map(row).collect(),
            ..Grid::default()
        };
        Set {
            grid,
            print: None,
            lines: Lines::all(lines, *keys, left),
            legend: Vec::new(),
            more: cells.len().saturating_sub(*most),
        }
    }
}

/// Returns a word as it stands in the name of a row: a bare `yes` says what is so.
fn in_label(column: &str, value: &Value) -> String {
    let word = value.to_string();
    if word == "yes" { column.to_owned() } else { word }
}

fn brief(value: &Value) -> Value {
    match value.as_f64() {
        Some(number) if number.fract() == 0.0 => value.clone(),
        // Hazards are small: two digits of them rather than none.
        Some(number) if number.abs() < 0.1 => {
            format!("{number:.1e}").parse::<f64>().unwrap_or(number).into()
        }
        Some(number) => format!("{number:.3}").into(),
        None => value.clone(),
    }
}

/// Returns a number as a table has it, nothing where it is none.
pub(super) fn rounded(number: f64) -> Value {
    number.is_finite().then(|| crate::studies::findings::rounded(number)).into()
}

/// Returns a row for each of the `values` of the choice `name`: how likely it was `before` and is `after`, its odds, and whether it
/// is the `literal` one.
pub(super) fn odds(
    name: &str,
    values: &[String],
    before: &[f64],
    after: &[f64],
    literal: Option<usize>,
) -> Vec<Row> {
    let row = |at: usize| {
        let (before, after) = (before[at], after[at]);
        let odds = (after / (1.0 - after)) / (before / (1.0 - before));
        let literal = (literal == Some(at)).then(|| "yes".to_owned());
        vec![
            name.into(),
            values[at].as_str().into(),
            rounded(before),
            rounded(after),
            rounded(odds),
            literal.into(),
        ]
    };
    (0..values.len()).map(row).collect()
}
