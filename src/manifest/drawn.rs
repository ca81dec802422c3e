//! Draws of a posterior: what each sets, by the condition that has it.

use super::experiment::Assumption;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The draws that are the values of a factor.
pub(super) struct Draws {
    /// The factor.
    pub(super) factor: String,
    /// The manifest of the inference, as written.
    pub(super) file: String,
    /// Paths of what its trials take as it is.
    pub(super) parameters: Vec<String>,
    /// Paths of the numbers that were inferred.
    pub(super) numbers: Vec<String>,
    pub(super) each: Vec<Draw>,
}

/// One of them.
pub(super) struct Draw {
    /// Its building, with goal and starts.
    pub(super) world: UsedWorld,
    /// By path.
    pub(super) values: BTreeMap<String, Value>,
}

impl Draws {
    /// Returns whether `factor` is the one whose values they are.
    pub(super) fn are_of(&self, factor: &str) -> bool {
        self.factor == factor
    }

    fn of(&self, condition: &Condition) -> Option<&Draw> {
        let number: usize = condition.value(&self.factor)?.parse().ok()?;
        self.each.get(number.checked_sub(1)?)
    }

    /// Returns the building of the draw of `condition`, with its goal and starts.
    pub(super) fn world(&self, condition: &Condition) -> Option<UsedWorld> {
        self.of(condition).map(|draw| draw.world.clone())
    }

    /// Returns the number that `reference` (`draw.graph.time-scale`) names, in the draw of `condition`.
    pub(super) fn number(&self, reference: &str, condition: &Condition) -> Option<f64> {
        self.of(condition)?.values.get(self.path(reference)?)?.as_f64()
    }

    /// Returns the path in a reference; `None` where that is none of numbers that were inferred.
    fn path<'r>(&self, reference: &'r str) -> Option<&'r str> {
        let path = reference.strip_prefix(self.factor.as_str())?.strip_prefix('.')?;
        self.numbers.iter().any(|known| known == path).then_some(path)
    }

    /// Returns all references to numbers that were inferred.
    pub(super) fn references(&self) -> Vec<String> {
        self.numbers.iter().map(|path| format!("{}.{path}", self.factor)).collect()
    }

    /// Returns what `reference` names in each draw, from the first.
    pub(super) fn each(&self, reference: &str) -> Vec<f64> {
        let Some(path) = self.path(reference) else { return Vec::new() };
        self.each.iter().filter_map(|draw| draw.values.get(path)?.as_f64()).collect()
    }

    /// Puts what the draw of `condition` sets into `parameters`, over what settings say.
    pub(super) fn put_into(&self, parameters: &mut Value, condition: &Condition) {
        let Some(draw) = self.of(condition) else { return };
        for path in &self.parameters {
            let Some(value) = draw.values.get(path) else { continue };
            let mut group = &mut *parameters;
            for step in path.split('.') {
                if !group.is_object() {
                    *group = Value::Object(Map::new());
                }
                group = &mut group[step];
            }
            *group = value.clone();
        }
    }

    /// Returns whether the assumption at `path` is one that draws stand in place of.
    pub(super) fn replace(&self, path: &str) -> bool {
        let path = path.strip_prefix("parameters.").unwrap_or(path);
        self.parameters.iter().any(|set| {
            path.strip_prefix(set.as_str())
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })
    }

    /// Returns what the draws set, as values with a reason.
    pub(super) fn assumptions(&self) -> impl Iterator<Item = Assumption> + '_ {
        self.parameters.iter().map(|path| {
            let drawn = self.each.iter().zip(1..).filter_map(|(draw, number): (_, u32)| {
                Some((number.to_string(), draw.values.get(path)?.clone()))
            });
            Assumption {
                path: format!("parameters.{path}"),
                value: json!({ "by": self.factor, "values": drawn.collect::<Map<_, _>>() }),
                why: format!("drawn from the posterior of {}", self.file),
                range: Vec::new(),
            }
        })
    }
}
