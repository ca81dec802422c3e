//! The JSON Schema of manifests.

use super::document::ManifestDoc;
use super::parameters::ParametersSchema;
use crate::studies::StudyKind;

/// What the JSON Schema of manifests of any study is known by; the number is that of the manifest language.
const ID: &str = "urn:reenact:manifest:1";

/// Returns the JSON Schema (2020-12) of manifests: of one study, or of any. That of any has the `$id` `urn:reenact:manifest:1`.
pub fn schema(kind: Option<StudyKind>) -> serde_json::Value {
    let mut schema = crate::document::schema_of::<ManifestDoc>();
    match kind {
        Some(kind) => ParametersSchema::of(kind).put_into(&mut schema),
        None => schema["$id"] = ID.into(),
    }
    schema
}
