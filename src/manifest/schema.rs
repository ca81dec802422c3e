//! The JSON Schema of manifests.

use super::document::ManifestDoc;
use super::parameters;
use crate::studies::StudyKind;

/// Returns the JSON Schema (2020-12) of manifests: of one study, or of any.
pub fn schema(kind: Option<StudyKind>) -> serde_json::Value {
    let mut schema = crate::document::schema_of::<ManifestDoc>();
    if let Some(kind) = kind {
        schema["properties"]["parameters"] = parameters::schema_of(kind);
    }
    schema
}
