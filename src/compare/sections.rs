//! A comparison in lines for people: what was compared, and every difference as subject, before, after and note.

use super::{Change, Comparison, Discrepancy, MeasureChange, TrialDifference};
use crate::claims::Judgement;
use crate::json;

/// One kind of thing that was compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// What kind.
    pub name: &'static str,
    /// How many were compared, in words; empty for single things.
    pub compared: String,
    /// What is to be said where nothing differs (or beside what does).
    pub remark: String,
    /// What differs.
    pub rows: Vec<Row>,
}

/// One difference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// What differs.
    pub subject: String,
    /// What stood there; empty where it is new.
    pub from: String,
    /// What stands there; empty where it is gone.
    pub to: String,
    /// More about it.
    pub note: String,
}

/// The section of tables that are compared cell by cell.
const CELLS: &str = "cells of tables";

/// Measures of one trial that are shown; the rest are counted.
const MEASURES_SHOWN: usize = 4;

impl Comparison {
    /// Sorts everything into sections, in the order of [`Comparison::discrepancies`].
    pub fn sections(&self) -> Vec<Section> {
        let tally = &self.tally;
        let trials = self.matching.by_key + self.matching.by_number;
        let tolerated =
            |n: usize| if n == 0 { String::new() } else { format!("{n} within tolerance") };
        let plain = String::new;
        let mut sections = vec![
            section("inputs", tally.inputs.to_string(), plain()),
            section("manifest", plain(), plain()),
            section("engine", plain(), plain()),
            section("settings", tally.settings.to_string(), plain()),
            section("conditions", tally.conditions.to_string(), plain()),
            section("trials", trials.to_string(), tolerated(tally.tolerated_trials)),
        ];
        if tally.records > 0 {
            sections.push(section("records", tally.records.to_string(), plain()));
        }
        if self.extent == super::Extent::Whole {
            let cells = tolerated(tally.tolerated_cells);
            sections.push(section(CELLS, tally.cells.to_string(), cells));
            sections.push(section("files of results", tally.files.to_string(), plain()));
            sections.push(section("claims", tally.claims.to_string(), plain()));
        }
        // A lock holds no tables, and neither does every study.
        sections.retain(|section| section.name != CELLS || tally.cells > 0 || self.has_cells());
        for discrepancy in &self.discrepancies {
            let (name, row) = row(discrepancy);
            if let Some(section) = sections.iter_mut().find(|section| section.name == name) {
                section.rows.push(row);
            }
        }
        sections
    }

    fn has_cells(&self) -> bool {
        self.discrepancies.iter().any(|d| matches!(d, Discrepancy::Cell { .. }))
    }
}

fn section(name: &'static str, compared: String, remark: String) -> Section {
    Section { name, compared, remark, rows: Vec::new() }
}

/// Returns the section a discrepancy belongs to, and its line there.
fn row(discrepancy: &Discrepancy) -> (&'static str, Row) {
    let digest = |d: &crate::digest::FileDigest| format!("sha256:{}", d.short());
    match discrepancy {
        Discrepancy::Input { path, change } => ("inputs", line(path, change, digest)),
        Discrepancy::Manifest { change } => ("manifest", line("its text", change, digest)),
        Discrepancy::Engine { change } => ("engine", line("version", change, String::clone)),
        Discrepancy::Setting { path, change, conditions, everywhere } => {
            let mut row = line(path, change, |value| short(&json::canonical(value)));
            row.note = match conditions.as_slice() {
                [] => String::new(),
                _ if *everywhere => "in every condition".to_owned(),
                [only] => format!("in {only}"),
                [first, second] => format!("in {first} and {second}"),
                [first, second, rest @ ..] => {
                    format!("in {first}, {second} and {} more", rest.len())
                }
            };
            ("settings", row)
        }
        Discrepancy::Condition { condition, change } => {
            let trials = |n: &usize| format!("{n} trial{}", if *n == 1 { "" } else { "s" });
            ("conditions", line(condition, change, trials))
        }
        Discrepancy::Trial(trial) => ("trials", trial_row(trial)),
        Discrepancy::Records { condition, change } => {
            ("records", line(condition, change, |d| format!("sha256:{}", d.short())))
        }
        Discrepancy::Cell { table, row, column, change } => {
            let name = table.strip_prefix("tables/").unwrap_or(table);
            let name = name.strip_suffix(".csv").unwrap_or(name);
            let mut line = line(&format!("{name}, {row}, {column}"), change, String::clone);
            if let (Some(Ok(from)), Some(Ok(to))) =
                (change.from.as_ref().map(|t| t.parse()), change.to.as_ref().map(|t| t.parse()))
            {
                line.note = delta(from, to);
            }
            (CELLS, line)
        }
        Discrepancy::File { path, change } => ("files of results", line(path, change, digest)),
        Discrepancy::Claim { id, change } => {
            let numbers =
                if change.from == change.to { "the same verdict by other numbers" } else { "" };
            ("claims", Row { note: numbers.to_owned(), ..line(id, change, Judgement::to_string) })
        }
    }
}

fn line<T>(subject: &str, change: &Change<T>, text: impl Fn(&T) -> String) -> Row {
    let shown = |value: &Option<T>| value.as_ref().map(&text).unwrap_or_default();
    Row {
        subject: subject.to_owned(),
        from: shown(&change.from),
        to: shown(&change.to),
        note: String::new(),
    }
}

fn trial_row(trial: &TrialDifference) -> Row {
    let subject = format!("{}/{}", trial.condition, trial.number);
    let mut row = line(&subject, &trial.sha256, |d| format!("sha256:{}", d.short()));
    if trial.key.from.is_none() || trial.key.to.is_none() {
        return row;
    }
    let mut notes = Vec::new();
    if trial.is_broken() {
        let key = trial.key.from.map(|key| key.short()).unwrap_or_default();
        notes.push(format!("same key {key}, other bytes"));
    }
    if let Some(Change { from: Some(from), to: Some(to) }) = &trial.outcome {
        notes.push(format!("outcome {from} -> {to}"));
    }
    notes.push(trial.divergence());
    notes.extend(trial.measures.iter().take(MEASURES_SHOWN).map(measure));
    if trial.measures.len() > MEASURES_SHOWN {
        let more = trial.measures.len() - MEASURES_SHOWN;
        notes.push(format!("{more} more measure{}", if more == 1 { "" } else { "s" }));
    }
    row.note = notes.join("; ");
    row
}

fn measure(measure: &MeasureChange) -> String {
    let name = &measure.name;
    match (measure.change.from, measure.change.to) {
        (Some(from), Some(to)) => {
            let (a, b) = (rounded(from), rounded(to));
            // A change too small to be seen in six digits is shown in full.
            if a == b {
                format!("{name} {from} -> {to}")
            } else {
                format!("{name} {a} -> {b}{}", parenthesis(&delta(from, to)))
            }
        }
        (from, to) => {
            let text = |x: Option<f64>| x.map_or("not reached".to_owned(), rounded);
            format!("{name} {} -> {}", text(from), text(to))
        }
    }
}

fn parenthesis(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(" ({text})") }
}

/// Returns the relative change, signed; empty where it has none.
fn delta(from: f64, to: f64) -> String {
    if from == 0.0 || !(from.is_finite() && to.is_finite()) {
        return String::new();
    }
    let percent = 100.0 * (to - from) / from.abs();
    match percent.abs() {
        p if p < 0.005 => String::new(),
        p if p < 1000.0 => format!("{percent:+.2} %"),
        _ => format!("{percent:+.0} %"),
    }
}

/// Writes a number with six significant digits, without trailing zeros.
fn rounded(x: f64) -> String {
    let text = format!("{x:.5e}");
    text.parse::<f64>().map_or(text, |x| x.to_string())
}

/// Cuts a value of a setting, which may be a long list or text.
fn short(text: &str) -> String {
    if text.chars().count() <= 60 {
        return text.to_owned();
    }
    text.chars().take(57).chain("...".chars()).collect()
}
