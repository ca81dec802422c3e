//! What the tables of an inference say in sentences.

use super::rows::Row;
use crate::table::Value;

/// Below this many buildings' worth, a posterior is a handful of draws.
const HANDFUL: f64 = 10.0;
/// Largest weight of one building that goes without a word.
const HEAVY: f64 = 0.25;
/// Tail below which a cell counts as never matched.
pub(super) const NEVER: f64 = 0.02;

pub(super) fn value_of(rows: &[Row], what: &str) -> Option<f64> {
    rows.iter().find(|row| row[0].to_string() == what)?.get(1)?.as_f64()
}

pub(super) fn summary_in_words(rows: &[Row]) -> Option<String> {
    let (tried, effective) =
        (value_of(rows, "proposals")?, value_of(rows, "effective number of proposals")?);
    let largest = value_of(rows, "largest weight")?;
    let proposals =
        if tried > 1.0 { format!("{tried} proposals are") } else { "1 proposal is".to_owned() };
    let mut words = format!(
        "Everything here is at graph level: proposals, no results. {proposals} worth {effective:.1} of equal weight; the largest has \
         {largest:.3} of it."
    );
    if effective < HANDFUL || largest > HEAVY {
        words.push_str(
            " WARNING: the posterior is a handful of draws; raise `trials` or list more buildings before anything is built on it.",
        );
    }
    words.push_str(if effective > 2.0 {
        " The table does not tell the building: several explain it about as well."
    } else {
        " Whether the table tells the building cannot be said by so few."
    });
    Some(words)
}

pub(super) fn literal_in_words(rows: &[Row]) -> String {
    let literal: Vec<String> = rows
        .iter()
        .filter(|row| row[5] != Value::Missing)
        .map(|row| {
            let after = row[3].as_f64().unwrap_or_default();
            let odds = row[4].as_f64().map_or("infinite".to_owned(), |odds| format!("{odds:.2}"));
            format!("{} = {}: {after:.2}, odds {odds}", row[0], row[1])
        })
        .collect();
    if literal.is_empty() {
        "No value is declared to be the paper's own words.".to_owned()
    } else {
        format!(
            "The paper's own words, where they win and where they lose: {}.",
            literal.join("; ")
        )
    }
}

pub(super) fn never_matched(rows: &[Row]) -> String {
    matched(rows, "cell", 8, |printed, expected| {
        format!("printed {printed:.0} %, expected {expected:.0} %")
    })
}

pub(super) fn times_never_matched(rows: &[Row]) -> String {
    matched(rows, "time", 6, |printed, expected| {
        format!("printed {printed:.0} s, expected {expected:.0} s")
    })
}

/// Names the rows whose tail, the last number, is small; `numbers` columns stand behind their names: printed and expected first.
fn matched(rows: &[Row], what: &str, numbers: usize, told: fn(f64, f64) -> String) -> String {
    let never: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            let first = row.len() - numbers;
            let tail = row[row.len() - 2].as_f64()?;
            let [printed, expected] = [row[first].as_f64()?, row[first + 1].as_f64()?];
            let name: Vec<String> = row[..first].iter().map(ToString::to_string).collect();
            (tail < NEVER).then(|| format!("{} ({})", name.join(" "), told(printed, expected)))
        })
        .collect();
    unmatched(what, &never)
}

/// Says which of `what`, cells or times, `never` have been matched.
pub(super) fn unmatched(what: &str, never: &[String]) -> String {
    if never.is_empty() {
        format!("Every {what} is matched: none has a tail below {NEVER}.")
    } else {
        format!("Never matched, with a tail below {NEVER}: {}.", never.join("; "))
    }
}

/// Returns in how many of how many parts that were held out the inference is better than a constant; `None` where none compares.
pub(super) fn better_than_a_constant(rows: &[Row]) -> Option<(usize, usize)> {
    let compared: Vec<&Row> = rows.iter().filter(|row| row[3].as_f64().is_some()).collect();
    let better = compared.iter().filter(|row| row[3].as_f64() < row[4].as_f64()).count();
    (!compared.is_empty()).then_some((better, compared.len()))
}

pub(super) fn held_in_words(rows: &[Row]) -> Option<String> {
    let (better, of) = better_than_a_constant(rows)?;
    Some(format!(
        "Rules, numbers, buildings and placements were all learned from the other cells alone. Better than a constant in {better} \
         of {of} parts."
    ))
}

pub(super) fn simulated_in_words(rows: &[Row]) -> Option<String> {
    let (mut covered, mut all) = (0.0, 0.0);
    for row in rows {
        let tables = row[1].as_f64()?;
        covered += row[4].as_f64().unwrap_or_default() * tables / 100.0;
        all += tables;
    }
    (all > 0.0).then(|| {
        format!(
            "Of {all} truths {:.0} % lie within the region of 90 %, which is well done between 85 and 95 %.",
            100.0 * covered / all
        )
    })
}
