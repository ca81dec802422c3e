//! Factors crossed into conditions, with include and exclude as in CI matrices.

use super::choice::{DrawsFactor, FactorDoc};
use super::document::ManifestDoc;
use super::faults::{Faults, step};
use super::names::{is_kebab, kebab};
use crate::condition::Condition;
use crate::factor::Factor;
use crate::studies::FactorValue;
use crate::studies::inference::InferenceDesign;
use std::collections::{BTreeMap, BTreeSet};

/// More conditions than any study has: a crossing gone wrong.
const MOST_CONDITIONS: usize = 20_000;

/// More factors than any study has: every condition holds a value of each.
const MOST_FACTORS: usize = 100;

/// More entries of `exclude` than anyone writes: each is held against every condition.
const MOST_EXCLUSIONS: usize = 1000;

/// Columns of tables that no factor may be named after.
const RESERVED: [&str; 7] = ["key", "trial", "outcome", "coverage-percent", "value", "sd", "n"];

/// Crosses the factors of `doc`: returns them and the conditions, last factor fastest, those of `include` at the end.
pub(super) fn cross(doc: &ManifestDoc, faults: &mut Faults<'_>) -> (Vec<Factor>, Vec<Condition>) {
    let mut factors: Vec<Factor> = Vec::new();
    let mut cells = vec![Condition::default()];
    if doc.factors.0.len() > MOST_FACTORS {
        let found = doc.factors.0.len();
        let message = format!("expected at most {MOST_FACTORS} factors, found {found}");
        faults.at_key("/factors", message, "these are crossed with one another");
        return (factors, Vec::new());
    }
    for (name, written) in &doc.factors.0 {
        let pointer = step("/factors", name);
        check_name(name, &pointer, faults);
        let mut values: Vec<String> = Vec::new();
        let mut known_values = BTreeSet::new();
        let mut note = |list: &[FactorValue], pointer: &str, faults: &mut Faults<'_>| {
            if list.is_empty() {
                faults.at(pointer, "a factor needs at least one value", "expected values");
            }
            let mut here = BTreeSet::new();
            for (i, value) in list.iter().enumerate() {
                if !here.insert(value) {
                    let message = format!("value `{value}` is written twice");
                    faults.at(&format!("{pointer}/{i}"), message, "already in this list");
                }
                if known_values.insert(value.0.clone()) {
                    values.push(value.0.clone());
                }
            }
        };
        let mut next = Vec::new();
        match written {
            FactorDoc::List(list) => {
                note(list, &pointer, faults);
                for cell in &cells {
                    next.extend(list.iter().map(|value| cell.clone().with(name, &value.0)));
                }
            }
            FactorDoc::By(by) => {
                let known: Vec<&str> = factors.iter().map(|f| f.name.as_str()).collect();
                let Some(other) = factors.iter().find(|f| f.name == by.by) else {
                    let message = format!("unknown factor `{}`", by.by);
                    let label = "expected a factor written before this one";
                    faults.unknown(&format!("{pointer}/by"), message, label, &by.by, &known);
                    continue;
                };
                faults.check_levels(by.values.keys(), other, &format!("{pointer}/values"), true);
                for (level, list) in &by.values {
                    note(list, &step(&format!("{pointer}/values"), level), faults);
                }
                for cell in &cells {
                    let list = cell.value(&by.by).and_then(|level| by.values.get(level));
                    next.extend(
                        list.into_iter().flatten().map(|value| cell.clone().with(name, &value.0)),
                    );
                }
            }
            FactorDoc::Draws(wanted) => {
                let second = factors.iter().find(|factor| draws(doc, &factor.name).is_some());
                if let Some(first) = second {
                    let message = format!("`{name}` is a second factor of draws");
                    let fault = faults.key_fault(&pointer, message);
                    let fault = fault.label(format!("`{}` is one already", first.name));
                    faults.push(fault.help("a trial has one draw: remove one of them"));
                    continue;
                }
                if wanted.n > InferenceDesign::MOST {
                    let message = format!(
                        "the posterior of `{}` has {} draws",
                        wanted.posterior,
                        InferenceDesign::MOST
                    );
                    let label = "asked for more than there are";
                    faults.at(&format!("{pointer}/n"), message, label);
                    continue;
                }
                values.extend((1..=wanted.n).map(|draw| draw.to_string()));
                for cell in &cells {
                    next.extend(values.iter().map(|value| cell.clone().with(name, value)));
                }
            }
        }
        if next.len() > MOST_CONDITIONS {
            let message = format!("the factors cross to more than {MOST_CONDITIONS} conditions");
            faults.at(&pointer, message, "with this factor");
            return (factors, Vec::new());
        }
        if !next.is_empty() {
            cells = next;
        }
        factors.push(Factor { name: name.clone(), values });
    }
    exclude(doc, &factors, &mut cells, faults);
    include(doc, &factors, &mut cells, faults);
    if cells.is_empty() {
        faults.at_key("/exclude", "no condition is left", "everything is excluded");
    }
    // Faults of values written twice have been collected.
    let mut seen = BTreeSet::new();
    cells.retain(|cell| seen.insert(cell.clone()));
    let mut slugs: BTreeMap<String, &Condition> = BTreeMap::new();
    for cell in &cells {
        if let Some(other) = slugs.insert(cell.slug().to_ascii_lowercase(), cell) {
            let message = format!("the conditions `{other}` and `{cell}` have the same file name");
            let fault = faults.key_fault("/factors", message).label("in these factors");
            faults.push(fault.help("use values that differ in their letters and digits"));
            break;
        }
    }
    (factors, cells)
}

/// Returns what is written of the factor of draws `name`; `None` where it is no such factor.
pub(super) fn draws<'d>(doc: &'d ManifestDoc, name: &str) -> Option<&'d DrawsFactor> {
    doc.factors.0.iter().find_map(|(known, written)| match written {
        FactorDoc::Draws(draws) if known == name => Some(draws),
        _ => None,
    })
}

fn check_name(name: &str, pointer: &str, faults: &mut Faults<'_>) {
    if !is_kebab(name) {
        let fault = faults
            .key_fault(pointer, format!("`{name}` cannot be the name of a factor"))
            .label("expected lower-case letters, digits and single hyphens");
        faults.push(fault.help(format!("for example `{}`", kebab(name))));
    }
    if RESERVED.contains(&name) {
        let message = format!("`{name}` is a column of every table and cannot name a factor");
        faults.at_key(pointer, message, "choose another name");
    }
}

/// Collects the faults of a partial condition in `include` or `exclude`; returns whether there was none.
fn check_cell(
    cell: &BTreeMap<String, FactorValue>,
    factors: &[Factor],
    pointer: &str,
    faults: &mut Faults<'_>,
) -> bool {
    let mut fine = true;
    for (name, value) in cell {
        let place = step(pointer, name);
        fine &= faults.check_level(factors, name, value, &place);
    }
    fine
}

fn exclude(
    doc: &ManifestDoc,
    factors: &[Factor],
    cells: &mut Vec<Condition>,
    faults: &mut Faults<'_>,
) {
    if doc.exclude.len() > MOST_EXCLUSIONS {
        let found = doc.exclude.len();
        let message = format!("`exclude` has at most {MOST_EXCLUSIONS} entries, found {found}");
        faults.at_key("/exclude", message, "leave values out of `factors` instead");
        return;
    }
    for (i, cell) in doc.exclude.iter().enumerate() {
        let pointer = format!("/exclude/{i}");
        if !check_cell(cell, factors, &pointer, faults) {
            continue;
        }
        let before = cells.len();
        cells.retain(|c| !cell.iter().all(|(name, value)| c.value(name) == Some(&value.0)));
        if cells.len() == before {
            let fault = faults.fault(&pointer, "this excludes no condition");
            faults.push(fault.label("no condition has all these values").warning());
        }
    }
}

fn include(
    doc: &ManifestDoc,
    factors: &[Factor],
    cells: &mut Vec<Condition>,
    faults: &mut Faults<'_>,
) {
    let mut there: BTreeSet<Condition> = cells.iter().cloned().collect();
    for (i, cell) in doc.include.iter().enumerate() {
        let pointer = format!("/include/{i}");
        if cells.len() > MOST_CONDITIONS {
            let message = format!("these are more than {MOST_CONDITIONS} conditions");
            faults.at(&pointer, message, "with this condition");
            return;
        }
        let missing: Vec<&str> =
            factors.iter().map(|f| f.name.as_str()).filter(|f| !cell.contains_key(*f)).collect();
        if !missing.is_empty() {
            let message = format!("an included condition has no value for `{}`", missing[0]);
            faults.at(&pointer, message, "expected a value for every factor");
        }
        if !check_cell(cell, factors, &pointer, faults) || !missing.is_empty() {
            continue;
        }
        let added: Condition = factors.iter().map(|f| (&f.name, &cell[&f.name].0)).collect();
        if there.insert(added.clone()) {
            cells.push(added);
        } else {
            let fault = faults.fault(&pointer, "this condition is there already");
            faults.push(fault.label(format!("`{added}`")).warning());
        }
    }
}
