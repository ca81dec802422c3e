//! Which of several alternatives was meant, so that its faults can be told instead of "no alternative fits".

use super::words::{accepts, constants};
use super::{Checker, Content, Entry, Fault, Faults, Spot, quoted, suggestion, unknown_value};
use serde_json::Value;
use std::collections::BTreeSet;

impl<'s> Checker<'s> {
    /// Collects the alternatives of `schema` down to those that have no further ones.
    pub(super) fn leaves(&self, schema: &'s Value, leaves: &mut Vec<&'s Value>, depth: usize) {
        let schema = self.resolve(schema);
        let branches = schema.get("anyOf").or_else(|| schema.get("oneOf"));
        match branches.and_then(Value::as_array) {
            // A mapping with alternatives of its own (a flattened choice) is one leaf.
            Some(branches) if schema.get("properties").is_none() && depth < 16 => {
                for branch in branches {
                    self.leaves(branch, leaves, depth + 1);
                }
            }
            _ => leaves.push(schema),
        }
    }

    /// Checks `spot` against the one of `branches` that was meant. Keys `outside` belong to the mapping that
    /// the alternatives are flattened into.
    pub(super) fn check_branches(
        &self,
        branches: &'s [Value],
        about: &'s Value,
        outside: &BTreeSet<&str>,
        spot: Spot<'_>,
        faults: &mut Faults,
    ) {
        let mut leaves = Vec::new();
        for branch in branches {
            self.leaves(branch, &mut leaves, 0);
        }
        let fitting: Vec<&'s Value> = leaves
            .iter()
            .copied()
            .filter(|leaf| leaf.get("type").is_none_or(|kinds| accepts(kinds, spot.node)))
            .collect();
        if fitting.is_empty() {
            faults.push(|| self.not_any(&leaves, about, &spot));
            return;
        }
        match &spot.node.content {
            Content::Map(entries) => {
                let entries: Vec<&Entry> =
                    entries.iter().filter(|e| !outside.contains(&*e.key)).collect();
                self.check_map_branches(&fitting, &entries, spot, faults);
            }
            Content::Text(text) => {
                let known: Vec<&Value> = fitting.iter().flat_map(|leaf| constants(leaf)).collect();
                if known.iter().any(|value| value.as_str() == Some(text)) {
                    return;
                }
                let free: Vec<&'s Value> =
                    fitting.into_iter().filter(|leaf| constants(leaf).is_empty()).collect();
                if free.is_empty() {
                    faults.push(|| match tagged(&leaves, text) {
                        Some(fault_help) => unknown_value(&known, &spot).help(fault_help),
                        None => unknown_value(&known, &spot),
                    });
                } else {
                    self.check_best(&free, spot, faults);
                }
            }
            _ => self.check_best(&fitting, spot, faults),
        }
    }

    /// Creates the fault that no alternative is of the node's type.
    fn not_any(&self, leaves: &[&'s Value], about: &'s Value, spot: &Spot<'_>) -> Fault {
        let fault = self.wrong_type(leaves, about, spot);
        match &spot.node.content {
            Content::Text(text) => match tagged(leaves, text) {
                Some(help) => fault.help(help),
                None => fault,
            },
            _ => fault,
        }
    }

    fn check_map_branches(
        &self,
        fitting: &[&'s Value],
        entries: &[&Entry],
        spot: Spot<'_>,
        faults: &mut Faults,
    ) {
        let written: BTreeSet<&str> =
            spot.node.entries().iter().map(|entry| entry.key.as_str()).collect();
        let score = |leaf: &'s Value| {
            let mut names = BTreeSet::new();
            self.property_names(leaf, &mut names);
            let open = names.is_empty();
            let known = entries.iter().filter(|e| names.contains(&*e.key)).count();
            let missing = required(leaf).filter(|key| !written.contains(key)).count();
            (open, known, std::cmp::Reverse(missing))
        };
        let scores: Vec<_> = fitting.iter().map(|leaf| score(leaf)).collect();
        let best = scores.iter().map(|s| (s.1, s.2)).max();
        let chosen: Vec<&'s Value> = fitting
            .iter()
            .zip(&scores)
            .filter(|(_, s)| best == Some((s.1, s.2)) || (best.is_some_and(|b| b.0 == 0) && s.0))
            .map(|(leaf, _)| *leaf)
            .collect();
        let recognised = best.is_some_and(|best| best.0 > 0) || scores.iter().any(|s| s.0);
        if fitting.len() == 1 || recognised {
            self.check_best(&chosen, spot, faults);
            return;
        }
        // No key belongs to any alternative: say which keys would choose one.
        let mut names = BTreeSet::new();
        for leaf in fitting {
            self.property_names(leaf, &mut names);
        }
        let mut choices: Vec<&str> = Vec::new();
        for key in fitting.iter().flat_map(|leaf| required(leaf)) {
            if !choices.contains(&key) {
                choices.push(key);
            }
        }
        let list = choices.join("`, `");
        if entries.is_empty() {
            faults.push(|| {
                spot.fault(
                    format!("{} must have one of the keys `{list}`, found none", spot.name()),
                    format!("expected one of `{list}`"),
                )
            });
        }
        for entry in entries {
            faults.push_unknown(entry.key_place, || {
                let label = format!("expected one of `{list}`");
                let key = quoted(&entry.key);
                let fault = spot.fault(format!("unknown key `{key}`"), label);
                fault.at(entry.key_place).help(
                    match suggestion(&entry.key, names.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("known keys: {}", choices.join(", ")),
                    },
                )
            });
        }
    }

    /// Adds the faults against the alternative that has the fewest.
    fn check_best(&self, leaves: &[&'s Value], spot: Spot<'_>, faults: &mut Faults) {
        let mut least: Option<Faults> = None;
        for leaf in leaves {
            let mut found = Faults::default();
            self.check(leaf, spot, &mut found);
            if found.count() == 0 {
                return;
            }
            if least.as_ref().is_none_or(|least| found.count() < least.count()) {
                least = Some(found);
            }
        }
        faults.append(least.unwrap_or_default());
    }
}

fn required(schema: &Value) -> impl Iterator<Item = &str> {
    schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
}

/// Says what to write, where `name` is the tag of an alternative that takes settings.
fn tagged(leaves: &[&Value], name: &str) -> Option<String> {
    leaves
        .iter()
        .any(|leaf| leaf.get("properties").is_some_and(|p| p.get(name).is_some()))
        .then(|| format!("`{name}` takes settings: write `{{{name}: ...}}`"))
}
