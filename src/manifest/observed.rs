//! Parts of the table that an inference is to explain, by the names that a manifest has for them.

use super::document::LeftOutDoc;
use super::faults::{Faults, step};
use crate::studies::inference::LeftOut;

/// Where an inference stands in a manifest.
pub(super) const PLACE: &str = "/infer";

/// Columns of a table, and what one of them is called.
type Columns<'a> = (&'a [&'a str], &'a str);

/// Collects the faults of what is to be held out: one of `kinds`, or a column.
pub(super) fn check_hold_outs(
    named: &[String],
    kinds: &[&str],
    (columns, called): Columns<'_>,
    faults: &mut Faults<'_>,
) {
    let known: Vec<&str> = kinds.iter().chain(columns).copied().collect();
    let quoted: Vec<String> = kinds.iter().map(|kind| format!("`{kind}`")).collect();
    for (index, kind) in named.iter().enumerate() {
        if !known.contains(&kind.as_str()) {
            let message = format!("nothing is held out by `{kind}`");
            let place = format!("{PLACE}/hold-out/{index}");
            let label = format!("neither {} nor {called}", quoted.join(" nor "));
            faults.unknown(&place, message, &label, kind, &known);
        }
    }
}

/// Collects the faults of the columns by whose means a baseline predicts.
pub(super) fn check_baseline(
    named: &[String],
    (columns, called): Columns<'_>,
    faults: &mut Faults<'_>,
) {
    for (index, name) in named.iter().enumerate() {
        if !columns.contains(&name.as_str()) {
            let message = format!("the observed table has no column `{name}`");
            let place = format!("{PLACE}/baseline/{index}");
            faults.unknown(&place, message, &format!("not {called}"), name, columns);
        }
    }
}

/// Returns what is left out of the `cells`, of which each has a level of every column, and whether each of them is.
pub(super) fn leave_out(
    docs: &[LeftOutDoc],
    (columns, called): (&[String], &str),
    cells: &[&[String]],
    faults: &mut Faults<'_>,
) -> (Vec<LeftOut>, Vec<bool>) {
    let mut is_out = vec![false; cells.len()];
    let mut left_out = Vec::new();
    for (index, out) in docs.iter().enumerate() {
        let place = format!("{PLACE}/left-out/{index}/where");
        let mut only = Vec::new();
        for (name, value) in &out.only {
            let Some(column) = columns.iter().position(|column| column == name) else {
                let known: Vec<&str> = columns.iter().map(String::as_str).collect();
                let message = format!("the observed table has no column `{name}`");
                let place = step(&place, name);
                faults.unknown_key(&place, message, &format!("not {called}"), name, &known);
                continue;
            };
            only.push((column, value.0.clone()));
        }
        let fits = |cell: &[String]| only.iter().all(|(column, value)| cell[*column] == *value);
        let found = cells.iter().zip(&mut is_out).filter(|(cell, _)| fits(cell));
        let count = found.map(|(_, is_out)| *is_out = true).count();
        if count == 0 && only.len() == out.only.len() {
            let has = only.iter().map(|(column, _)| {
                let mut levels: Vec<&str> = Vec::new();
                for cell in cells {
                    if !levels.contains(&cell[*column].as_str()) {
                        levels.push(&cell[*column]);
                    }
                }
                format!("`{}`: {}", columns[*column], levels.join(", "))
            });
            let help = format!("the table has {}", has.collect::<Vec<_>>().join("; "));
            let fault = faults.fault(&place, "nothing is left out by this");
            let fault = fault.label("expected values of a cell of the observed table");
            faults.push(fault.help(help));
        }
        let only = out.only.iter().map(|(name, value)| (name.clone(), value.0.clone())).collect();
        left_out.push(LeftOut { only, why: out.why.clone() });
    }
    (left_out, is_out)
}
