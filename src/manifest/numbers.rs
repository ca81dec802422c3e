//! The paper's own numbers, read from tidy CSV files.

use super::faults::Faults;
use crate::document::{Diagnostic, Source, known_or_near, listed, suggestion};
use crate::factor::Factor;
use crate::studies::StudyKind;
use crate::table::{Table, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Returns the columns of a tidy CSV of published numbers besides the factors', and whether each must be there: tables
/// of the prior-map study are by coverage, or by measure.
fn columns(kind: StudyKind, by_measure: bool) -> [(&'static str, bool); 5] {
    let by_coverage = kind.has_series() && !by_measure;
    [
        ("coverage-percent", by_coverage),
        ("value", true),
        ("sd", false),
        ("n", false),
        (MEASURE, false),
    ]
}

/// The column that names what is measured, in numbers that are not by coverage.
pub(super) const MEASURE: &str = "measure";

/// No paper prints more (bytes); a table takes many times its text.
const MOST_BYTES: usize = 1 << 19;

/// Of how many values that no factor has it is asked whether one was meant.
const MOST_UNKNOWN: usize = 1000;

/// Reads a tidy CSV: columns named after factors, then `coverage-percent`, `value`, and where known `sd` and
/// `n`; one row per published number. Where a column `measure` says what was measured, there need be no coverage.
pub(super) fn read(
    source: &Source,
    kind: StudyKind,
    factors: &[Factor],
    faults: &mut Faults<'_>,
) -> Option<Table> {
    if source.text.len() > MOST_BYTES {
        faults.push(Diagnostic::placeless(format!(
            "`{}` is too large: expected at most {MOST_BYTES} bytes, found {}",
            source.name,
            source.text.len()
        )));
        return None;
    }
    let table = Table::from_csv(&source.text);
    let by_measure = table.as_ref().is_ok_and(|table| table.column(MEASURE).is_some());
    let numbers = columns(kind, by_measure);
    let mut fine = true;
    let known: Vec<&str> = factors
        .iter()
        .map(|f| f.name.as_str())
        .chain(numbers.iter().map(|(name, _)| *name))
        .collect();
    let mut header = source.text.lines().next().unwrap_or_default().split(',');
    if !header.any(|column| known.contains(&column.trim_matches(['"', '\u{feff}']))) {
        // Nothing of it is quoted: it may be any file, named by a slip.
        let message = format!(
            "`{}`: expected a CSV of published numbers, found text whose first line names none of its columns",
            source.name
        );
        faults.push(Diagnostic::placeless(message).help(format!("known: {}", listed(&known))));
        return None;
    }
    let table = match table {
        Ok(table) => table,
        Err(error) => {
            faults.push(Diagnostic::error(source, line(source, error.line), error.problem));
            return None;
        }
    };
    for column in table.columns.iter().filter(|c| !known.contains(&c.as_str())) {
        let fault =
            Diagnostic::error(source, line(source, 1), format!("unknown column `{column}`"))
                .label("expected factors of the manifest and the columns of numbers");
        faults.push(fault.help(known_or_near(column, &known)));
        fine = false;
    }
    for (name, _) in numbers.iter().filter(|(name, needed)| *needed && table.column(name).is_none())
    {
        let fault = Diagnostic::error(source, line(source, 1), format!("missing column `{name}`"));
        faults.push(fault.label(format!("expected a column `{name}`")));
        fine = false;
    }
    let levels: BTreeMap<&str, BTreeSet<&str>> = factors
        .iter()
        .map(|factor| (factor.name.as_str(), factor.values.iter().map(String::as_str).collect()))
        .collect();
    let mut unknown = BTreeSet::new();
    // Exact while no field spans lines; a place one line off is still a help then.
    let mut rest = 0;
    let lines = source.text.split_inclusive('\n').map(|line| {
        rest += line.len();
        rest - line.len()..rest - line.len() + line.trim_end_matches(['\n', '\r']).len()
    });
    let lines = lines.skip(1).chain(std::iter::repeat(source.text.len()..source.text.len()));
    for (row, place) in table.rows.iter().zip(lines) {
        for (column, value) in table.columns.iter().zip(row) {
            if let Some(factor) = factors.iter().find(|f| f.name == *column) {
                // A paper may have more levels than are run; one that is nearly a level is a slip.
                let level = value.to_string();
                let names = &levels[factor.name.as_str()];
                if !names.contains(level.as_str())
                    && unknown.len() < MOST_UNKNOWN
                    && unknown.insert((column, level.clone()))
                    && suggestion(&level, names.iter().copied()).is_some()
                {
                    let names: Vec<&str> = factor.values.iter().map(String::as_str).collect();
                    let message = format!("`{level}` is not a value of the factor `{column}`");
                    let fault = Diagnostic::error(source, place.clone(), message)
                        .label("this row will stand beside nothing")
                        .help(known_or_near(&level, &names));
                    faults.push(fault.warning());
                }
            } else if numbers.iter().any(|(name, needed)| name == column && *needed)
                && value.as_f64().is_none()
            {
                let found = match value {
                    Value::Missing => "nothing".to_owned(),
                    other => format!("`{other}`"),
                };
                let message = format!("`{column}` must be a number, found {found}");
                faults.push(Diagnostic::error(source, place.clone(), message));
                fine = false;
            }
        }
    }
    fine.then_some(table)
}

/// Returns the bytes of the one-based line `number`.
fn line(source: &Source, number: usize) -> std::ops::Range<usize> {
    let start = source
        .text
        .split_inclusive('\n')
        .take(number.saturating_sub(1))
        .map(str::len)
        .sum::<usize>();
    let length = source.text[start..].lines().next().map_or(0, str::len);
    start..start + length
}
