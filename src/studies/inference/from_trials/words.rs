//! What the tables of an inference from trials say in sentences.

use super::tables::odds_in_words;
use crate::studies::inference::rows::Row;
use crate::studies::inference::words::{
    NEVER, better_than_a_constant, literal_in_words, unmatched, value_of,
};
use crate::table::Value;

/// Probability below which no value of a choice counts as told.
const TOLD: f64 = 0.9;
/// Share (%) of tables below which a choice counts as one that no such table could tell.
const TELLABLE: f64 = 75.0;
/// Probability of the largest model error above which nothing explains the table.
const AT_END: f64 = 0.5;
/// Share of farther tables below which the prior did not expect such a table.
const FAR: f64 = 0.05;

pub(super) fn summary(rows: &[Row]) -> Option<String> {
    let value = |what: &str| value_of(rows, what);
    let (combinations, effective) =
        (value("combinations")?, value("effective number of combinations")?);
    let (runs, largest) = (value("runs of them")?, value("largest weight")?);
    let (error, at_end) = (
        value("error of a cell, posterior mean (%)")?,
        value("probability of the largest error of a cell allowed")?,
    );
    let mut words = format!(
        "From {runs:.0} trials in physics: {combinations:.0} combinations, all as likely before, are worth {effective:.1} of equal \
         weight; the largest has {largest:.3} of it. What sampling explains neither of a cell nor of its arm or the table is {error:.0} %."
    );
    if at_end > AT_END {
        words.push_str(
            " WARNING: the largest error of a cell that was allowed is the likeliest: no combination explains the table.",
        );
    }
    if let Some(farther) =
        value("share of tables made by the prior that are farther from it than the print")
        && farther < FAR
    {
        words.push_str(&format!(
            " WARNING: of tables that the prior makes {:.0} % are farther from it than the printed one: it did not expect such a \
             table.",
            100.0 * farther
        ));
    }
    Some(words)
}

pub(super) fn choices(rows: &[Row]) -> Option<String> {
    let (mut told, mut depends, mut open) = (Vec::new(), Vec::new(), Vec::new());
    for part in rows.chunk_by(|a, b| a[0] == b[0]).filter(|part| part.len() > 1) {
        let number = |row: &Row, at: usize| row[at].as_f64().unwrap_or_default();
        let best = part.iter().max_by(|a, b| number(a, 3).total_cmp(&number(b, 3)))?;
        let words = format!("{} = {} ({:.2})", best[0], best[1], number(best, 3));
        if number(best, 6) >= TOLD {
            told.push(words);
        } else if number(best, 3) >= TOLD {
            depends.push(format!("{words}, {:.2} to {:.2}", number(best, 6), number(best, 7)));
        } else {
            open.push(words);
        }
    }
    let listed = |words: &[String]| {
        if words.is_empty() { "nothing".to_owned() } else { words.join("; ") }
    };
    (!rows.is_empty()).then(|| {
        format!(
            "Told by the table, with a probability of {TOLD} or more whatever cells have in common: {}. Told only where that is \
             supposed: {}. Not told: {}. {}",
            listed(&told),
            listed(&depends),
            listed(&open),
            literal_in_words(rows)
        )
    })
}

pub(super) fn never_matched(rows: &[Row]) -> Option<String> {
    let never = rows.iter().filter_map(|row| {
        let end = row.len();
        let tail = row[end - 2].as_f64()?;
        let [printed, expected] = [row[end - 8].as_f64()?, row[end - 7].as_f64()?];
        let [least, most] = [row[end - 4].as_f64()?, row[end - 3].as_f64()?];
        let name: Vec<String> = row[..end - 8].iter().map(ToString::to_string).collect();
        let reach =
            if (least..=most).contains(&printed) { "" } else { ", beyond every combination" };
        (tail < NEVER).then(|| {
            format!("{} (printed {printed}, expected {expected:.1}{reach})", name.join(" "))
        })
    });
    (!rows.is_empty()).then(|| unmatched("cell", &never.collect::<Vec<_>>()))
}

pub(super) fn held_out(rows: &[Row]) -> Option<String> {
    let (better, of) = better_than_a_constant(rows)?;
    let beside: Vec<&Row> = rows.iter().filter(|row| row[5].as_f64().is_some()).collect();
    let means = beside.iter().filter(|row| row[3].as_f64() < row[5].as_f64()).count();
    Some(format!(
        "Settings and model error were learned from the other cells alone. Better than a constant in {better} of {of} parts, better \
         than the means of the other cells in {means} of {}.",
        beside.len()
    ))
}

pub(super) fn simulated(rows: &[Row]) -> Option<String> {
    let tables = rows.first()?[1].as_f64().filter(|tables| *tables > 0.0)?;
    let choices = &rows[..rows.len() - 1];
    let hard: Vec<String> = choices
        .iter()
        .filter(|row| row[2].as_f64().is_some_and(|share| share < TELLABLE))
        .map(|row| format!("{} ({:.0} %)", row[0], row[2].as_f64().unwrap_or_default()))
        .collect();
    let combination = rows.last()?;
    let mut words = format!(
        "Of {tables} tables made by known combinations, with sampling and model error, {:.0} % have their truth among the combinations \
         that hold 90 % of the weight, which is well done from 85 %.",
        combination[5].as_f64()?
    );
    words.push_str(&if hard.is_empty() {
        format!(" Every choice is found in {TELLABLE} % of them or more.")
    } else {
        format!(
            " Such a table cannot tell, since even in these the truth is the likeliest value in fewer than {TELLABLE} %: {}.",
            hard.join(", ")
        )
    });
    Some(words)
}

pub(super) fn replicate(rows: &[Row]) -> Option<String> {
    let row = |what: &str| rows.iter().find(|row| row[0].to_string() == what);
    let [low, median, high] = [3, 4, 5].map(|at| {
        row("log odds, exact replicate to the likeliest").and_then(|row| row[at].as_f64())
    });
    let wavering: Vec<String> = rows
        .iter()
        .filter(|row| row[1] != Value::Missing)
        .filter(|row| row[6].as_f64().is_some_and(|share| (10.0..=90.0).contains(&share)))
        .map(|row| row[0].to_string())
        .collect();
    let mut names = wavering;
    names.dedup();
    let mut words = format!(
        "Against the likeliest combination, an exact replicate of the paper's experiment with as many runs as ours has odds of {} \
         (nine of ten: {} to {}).",
        odds_in_words(median?),
        odds_in_words(low?),
        odds_in_words(high?)
    );
    words.push_str(&if names.is_empty() {
        " No replicate of the printed table would turn which value of a choice is the likeliest, in more than one of ten.".to_owned()
    } else {
        format!(" In more than one of ten replicates of the printed table another value is the likeliest: {}.", names.join(", "))
    });
    Some(words)
}
