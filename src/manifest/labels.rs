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
    check_names(labels, factors, faults);
    for (name, of_factor) in labels.iter() {
        let Some(factor) = factors.iter().find(|factor| factor.name == name) else { continue };
        let mut shown: BTreeMap<&str, &str> = BTreeMap::new();
        for value in &factor.values {
            let label = labels.value(name, value);
            if let Some(other) = shown.insert(label, value)
                && of_factor.values.contains_key(value)
            {
                let pointer = step(&format!("{}/values", step("/labels", name)), value);
                clash(&pointer, label, &format!("the value `{other}`"), faults);
            }
        }
    }
}

/// Collects the faults of what stands for the factors themselves.
fn check_names(labels: &Labels, factors: &[Factor], faults: &mut Faults<'_>) {
    let mut shown: BTreeMap<&str, &str> = BTreeMap::new();
    let own: BTreeMap<&str, &str> =
        labels.iter().filter_map(|(name, labels)| Some((name, labels.name.as_deref()?))).collect();
    for factor in factors {
        let label = labels.factor(&factor.name);
        let other = shown.insert(label, &factor.name);
        if let Some(written) = own.get(factor.name.as_str()) {
            let pointer = format!("{}/name", step("/labels", &factor.name));
            check_label(written, &pointer, faults);
            if let Some(other) = other {
                clash(&pointer, label, &format!("the factor `{other}`"), faults);
            }
        }
    }
}

fn check_label(label: &str, pointer: &str, faults: &mut Faults<'_>) {
    let length = label.chars().count();
    let is_plain = label.trim() == label && !label.chars().any(char::is_control);
    if length == 0 || length > LONGEST || !is_plain {
        let fault = faults.fault(pointer, "this cannot be a label");
        let expected = format!(
            "expected one line of 1 to {LONGEST} characters without blanks around it, found {length}"
        );
        faults.push(fault.label(expected).help("write it as it is to stand in a table's heading"));
    }
}

fn clash(pointer: &str, label: &str, other: &str, faults: &mut Faults<'_>) {
    let message = format!("two things cannot both be called `{label}`");
    let fault = faults.fault(pointer, message).label(format!("{other} is shown so, too"));
    faults.push(fault.help("readers could not tell them apart: give each its own label"));
}
