//! Documents that people write (manifests, worlds, robots, maps), read with faults that say where.
//!
//! The only door to the YAML crate and to the crate that draws source excerpts. [`parse`] takes a text to a
//! typed value in three steps: a tree with places, a check against the type's JSON Schema that finds every
//! fault, and serde.

mod deserialize;
mod diagnostic;
#[cfg(test)]
pub(crate) mod mutation;
mod node;
mod reader;
mod schema_check;
pub mod sdf;
mod secret;
pub mod xml;

pub use diagnostic::{
    Diagnostic, FaultList, MOST_FAULTS, Severity, Source, known_or_near, listed, quoted, reports,
    steers, suggestion,
};
pub use node::{Content, Entry, Node, Place, Tree};
pub use reader::read;
pub use schema_check::check;
pub use secret::secret;

use schemars::{JsonSchema, SchemaGenerator, generate::SchemaSettings};
use serde::de::DeserializeOwned;

/// A document's value and where each part of it is written.
#[derive(Debug, Clone)]
pub struct Parsed<T> {
    /// What the document says.
    pub value: T,
    /// Where it says so.
    pub tree: Tree,
}

impl<T> Parsed<T> {
    /// Creates an error that says `message` at the value that the JSON pointer `pointer` names (`/factors/prior/1`), or
    /// at the nearest thing around it that is written.
    pub fn fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        self.tree.fault(self.tree.place(pointer), message)
    }

    /// Creates an error that says `message` at the key of the value that `pointer` names.
    pub fn key_fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        self.tree.fault(self.tree.key_place(pointer), message)
    }
}

/// Reads the YAML document `source` as a `T`.
///
/// # Errors
/// Every fault of the text; where there is none, every difference from `T`'s schema; where there is none,
/// what `T` itself refuses.
pub fn parse<T: DeserializeOwned + JsonSchema>(
    source: &Source,
) -> Result<Parsed<T>, Vec<Diagnostic>> {
    parse_tree(read(source)?)
}

/// Takes a tree, already read and perhaps changed, to a `T`.
///
/// # Errors
/// As [`parse`], but for faults of the text.
pub fn parse_tree<T: DeserializeOwned + JsonSchema>(
    tree: Tree,
) -> Result<Parsed<T>, Vec<Diagnostic>> {
    let schema = schema_of::<T>();
    parse_tree_by(tree, &schema)
}

/// Takes a tree to a `T` by a schema that is narrower than the type's own.
///
/// # Errors
/// As [`parse_tree`].
pub fn parse_tree_by<T: DeserializeOwned>(
    tree: Tree,
    schema: &serde_json::Value,
) -> Result<Parsed<T>, Vec<Diagnostic>> {
    let faults = check(schema, &tree);
    if !faults.is_empty() {
        return Err(faults);
    }
    match T::deserialize(deserialize::Reading(&tree.root)) {
        Ok(value) => Ok(Parsed { value, tree }),
        Err(refusal) => {
            let place = refusal.place.unwrap_or(tree.root.place);
            Err(vec![tree.fault(place, refusal.message)])
        }
    }
}

/// Returns the JSON Schema (2020-12) of documents of the type `T`, as they are read.
pub fn schema_of<T: JsonSchema>() -> serde_json::Value {
    let generator: SchemaGenerator =
        SchemaSettings::draft2020_12().for_deserialize().into_generator();
    generator.into_root_schema_for::<T>().to_value()
}

#[cfg(test)]
mod tests;
