//! Entities of an RO-Crate's graph, built so that the traps of its validator cannot be stepped into.

use serde_json::{Map, Value, json};

/// One node of the JSON-LD graph.
#[derive(Debug, Clone)]
pub(super) struct Entity(Map<String, Value>);

impl Entity {
    /// Creates an entity with its identifier and type or types.
    pub(super) fn new(id: &str, kinds: &[&str]) -> Self {
        let kinds = collapse(kinds.iter().map(|kind| json!(kind)).collect());
        Self(Map::from_iter([("@id".into(), json!(id)), ("@type".into(), kinds)]))
    }

    /// Adds a text.
    #[must_use]
    pub(super) fn text(mut self, key: &str, value: impl Into<String>) -> Self {
        self.0.insert(key.into(), Value::String(value.into()));
        self
    }

    /// Adds a reference to another entity.
    #[must_use]
    pub(super) fn refer(self, key: &str, id: &str) -> Self {
        self.refer_all(key, [id])
    }

    /// Adds references. One-element arrays are flagged by the validator (ro-crate-1.1_24.1), empty ones say nothing.
    #[must_use]
    pub(super) fn refer_all<S: AsRef<str>>(
        mut self,
        key: &str,
        ids: impl IntoIterator<Item = S>,
    ) -> Self {
        let references: Vec<_> = ids.into_iter().map(|id| json!({"@id": id.as_ref()})).collect();
        if !references.is_empty() {
            self.0.insert(key.into(), collapse(references));
        }
        self
    }

    /// Applies `change` where `wanted` is there, and returns the entity as it is otherwise.
    #[must_use]
    pub(super) fn with<T>(self, wanted: Option<T>, change: impl FnOnce(Self, T) -> Self) -> Self {
        match wanted {
            Some(value) => change(self, value),
            None => self,
        }
    }

    pub(super) fn into_value(self) -> Value {
        Value::Object(self.0)
    }
}

fn collapse(mut values: Vec<Value>) -> Value {
    if values.len() == 1 { values.remove(0) } else { Value::Array(values) }
}
