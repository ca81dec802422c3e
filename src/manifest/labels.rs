//! `labels`: what readers see for factors and their values. They have to tell apart what the names tell apart.

use super::faults::{Faults, step};
use crate::factor::Factor;
use crate::labels::Labels;
use std::collections::BTreeMap;

/// The longest label (characters): it heads columns.
const LONGEST: usize = 60;

/// Collects the faults of `labels`, of which `factors` are those of the manifest.
pub(super) fn check(labels: &Labels, factors: &[Factor], faults: &mut Faults<'_>) {
    for (name, labels) in labels.iter() {
        let pointer = step("/labels", name);
        let Some(factor) = faults.check_factor(factors, name, &pointer, true) else { continue };
        let values = format!("{pointer}/values");
        faults.check_levels(labels.values.keys(), factor, &values, false);
        for (value, label) in &labels.values {
            check_label(label, &step(&values, value), faults);
        }
    }
    let name_of = |factor: &Factor| format!("{}/name", step("/labels", &factor.name));
    let named = |factor: &Factor| labels.factor(&factor.name) != factor.name;
    for (factor, label) in factors.iter().map(|factor| (factor, labels.factor(&factor.name))) {
        if named(factor) {
            check_label(label, &name_of(factor), faults);
        }
    }
    let shown: Vec<Shown<'_>> = factors
        .iter()
        .map(|factor| Shown {
            own: &factor.name,
            label: labels.factor(&factor.name),
            written: named(factor).then(|| name_of(factor)),
        })
        .collect();
    check_apart("factor", &shown, faults);
    for (name, of_factor) in labels.iter() {
        let Some(factor) = factors.iter().find(|factor| factor.name == name) else { continue };
        let values = format!("{}/values", step("/labels", name));
        let written =
            |value: &String| of_factor.values.contains_key(value).then(|| step(&values, value));
        let shown: Vec<Shown<'_>> = factor
            .values
            .iter()
            .map(|value| Shown {
                own: value,
                label: labels.value(name, value),
                written: written(value),
            })
            .collect();
        check_apart("value", &shown, faults);
    }
}

/// A factor or value, and what readers see.
struct Shown<'a> {
    own: &'a str,
    label: &'a str,
    /// Where the label is written, if anywhere.
    written: Option<String>,
}

/// Collects a fault for each that is shown as one before it.
fn check_apart(what: &str, shown: &[Shown<'_>], faults: &mut Faults<'_>) {
    let mut known: BTreeMap<&str, &Shown<'_>> = BTreeMap::new();
    for one in shown {
        let Some(other) = known.insert(one.label, one) else { continue };
        // One of the two labels is written: names themselves are distinct.
        let (pointer, beside) = match (&one.written, &other.written) {
            (Some(pointer), _) => (pointer, other.own),
            (None, Some(pointer)) => (pointer, one.own),
            (None, None) => continue,
        };
        let label = one.label;
        let fault = faults.fault(pointer, format!("two things cannot both be shown as `{label}`"));
        let fault = fault.label(format!("the {what} `{beside}` is shown so, too"));
        faults.push(fault.help("give each its own label, so that readers can tell them apart"));
    }
}

fn check_label(label: &str, pointer: &str, faults: &mut Faults<'_>) {
    let length = label.chars().count();
    let is_plain = label.trim() == label && !label.chars().any(char::is_control);
    if length == 0 || length > LONGEST || !is_plain {
        let fault = faults.fault(pointer, "this cannot be a label");
        let expected =
            format!("expected 1 to {LONGEST} characters on one line, and no blank at either end");
        faults.push(fault.label(expected).help("write it as it is to stand in a table's heading"));
    }
}
