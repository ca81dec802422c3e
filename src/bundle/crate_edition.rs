//! The crate's metadata in the words of another edition: RO-Crate 1.3 with Workflow RO-Crate 1.1 and the Run Crate profiles 0.6.
//!
//! Bundles are sealed in the edition whose profiles a validator knows ([`super::crate_metadata`]). Of the newer one only what it
//! says otherwise is put otherwise, so that each text can be had from the other, byte for byte, and what `verify` derives holds for
//! both: specifications and profiles by their new addresses; profiles on the crate alone, no longer on the descriptor (RO-Crate 1.2);
//! terms that are in the new context left out of our own; a work without an address as what the crate is based on, since a citation
//! must have one (RO-Crate 1.2).

use super::format;
use crate::json;
use serde_json::{Map, Value, json};

/// An edition of RO-Crate, with the profiles that build on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Edition {
    /// RO-Crate 1.1, Workflow RO-Crate 1.0, Run Crate profiles 0.5: what a bundle is sealed with.
    #[default]
    V1_1,
    /// RO-Crate 1.3, Workflow RO-Crate 1.1, Run Crate profiles 0.6.
    V1_3,
}

const TERMS: &str = "https://w3id.org/ro/terms/workflow-run#";
const CRATE: [&str; 2] = ["https://w3id.org/ro/crate/1.1", "https://w3id.org/ro/crate/1.3"];
const WORKFLOW: [&str; 2] = [
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.1",
];

/// What is called otherwise in the two editions, and its versions.
const RENAMED: [([&str; 2], [&str; 2]); 4] = [
    (WORKFLOW, ["1.0", "1.1"]),
    (
        ["https://w3id.org/ro/wfrun/process/0.5", "https://w3id.org/ro/wfrun/process/0.6"],
        ["0.5", "0.6"],
    ),
    (
        ["https://w3id.org/ro/wfrun/workflow/0.5", "https://w3id.org/ro/wfrun/workflow/0.6"],
        ["0.5", "0.6"],
    ),
    (
        ["https://w3id.org/ro/wfrun/provenance/0.5", "https://w3id.org/ro/wfrun/provenance/0.6"],
        ["0.5", "0.6"],
    ),
];

impl Edition {
    /// Returns its place in the pairs above.
    fn place(self) -> usize {
        match self {
            Self::V1_1 => 0,
            Self::V1_3 => 1,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::V1_1 => Self::V1_3,
            Self::V1_3 => Self::V1_1,
        }
    }

    /// Returns the context of its documents: the specification's own, and the terms that it lacks.
    pub(super) fn context(self) -> Value {
        let environment = format!("{TERMS}environment");
        let own = match self {
            Self::V1_1 => json!({
                "Profile": "http://www.w3.org/ns/dx/prof/Profile",
                "environment": environment,
                "sha256": format!("{TERMS}sha256"),
            }),
            Self::V1_3 => json!({"environment": environment}),
        };
        json!([format!("{}/context", CRATE[self.place()]), own])
    }

    /// Returns what the descriptor says that it conforms to.
    fn conforms_to(self) -> Value {
        let of_crate = json!({"@id": CRATE[self.place()]});
        match self {
            Self::V1_1 => json!([of_crate, {"@id": WORKFLOW[self.place()]}]),
            Self::V1_3 => of_crate,
        }
    }

    /// Returns by which property the crate names a work that has no address.
    fn names_a_work_by(self) -> &'static str {
        match self {
            Self::V1_1 => "citation",
            Self::V1_3 => "isBasedOn",
        }
    }
}

/// Returns `metadata`, a document of this program in one of the editions, in the edition `to`; `None` for what this program does
/// not write.
pub fn in_edition(metadata: &[u8], to: Edition) -> Option<Vec<u8>> {
    let document = json::read::<Value>(metadata).ok()?;
    if document.get("@context")? == &to.context() {
        return Some(metadata.to_vec());
    }
    let put = put_otherwise(document, to)?;
    // Who says the same in other words says something that nobody has looked at.
    let back = put_otherwise(put.clone(), to.other())?;
    (written(&back) == metadata).then(|| written(&put))
}

/// Writes a document, as every one of a bundle is written.
pub(super) fn written(document: &Value) -> Vec<u8> {
    format!("{document:#}\n").into_bytes()
}

fn put_otherwise(mut document: Value, to: Edition) -> Option<Value> {
    let from = to.other();
    let context = document.get_mut("@context").filter(|context| **context == from.context())?;
    *context = to.context();
    for entity in document.get_mut("@graph")?.as_array_mut()? {
        let entity = entity.as_object_mut()?;
        rename(entity, from, to);
        match entity.get("@id").and_then(Value::as_str) {
            Some(format::METADATA) => drop(entity.insert("conformsTo".into(), to.conforms_to())),
            Some("./") => name_the_work(entity, from, to),
            _ => (),
        }
    }
    Some(document)
}

/// Puts the identifiers in `entity`, its own and those it refers to, into the words of `to`.
fn rename(entity: &mut Map<String, Value>, from: Edition, to: Edition) {
    let renamed = |id: &Value| {
        RENAMED
            .iter()
            .find(|(ids, _)| id == ids[from.place()])
            .map(|(ids, versions)| (ids, versions))
    };
    if let Some((ids, versions)) = entity.get("@id").and_then(renamed) {
        if let Some(version) =
            entity.get_mut("version").filter(|old| **old == versions[from.place()])
        {
            *version = json!(versions[to.place()]);
        }
        entity.insert("@id".into(), json!(ids[to.place()]));
    }
    let references = entity.values_mut().flat_map(|value| match value {
        Value::Array(values) => values.iter_mut().collect::<Vec<_>>(),
        value => vec![value],
    });
    for id in references.filter_map(|reference| reference.get_mut("@id")) {
        if let Some((ids, _)) = renamed(id) {
            *id = json!(ids[to.place()]);
        }
    }
}

fn name_the_work(root: &mut Map<String, Value>, from: Edition, to: Edition) {
    let is_local = |work: &Value| work["@id"].as_str().is_some_and(|id| id.starts_with('#'));
    let by = from.names_a_work_by();
    if root.get(by).is_some_and(is_local)
        && let Some(work) = root.remove(by)
    {
        root.insert(to.names_a_work_by().into(), work);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BundlePath, sample};
    use super::*;

    fn metadata() -> Vec<u8> {
        sample::sealed().tree[&*BundlePath::payload(format::METADATA)].clone()
    }

    #[test]
    fn each_edition_is_had_from_the_other() {
        let old = metadata();
        let new = in_edition(&old, Edition::V1_3).unwrap();
        assert_eq!(in_edition(&new, Edition::V1_1).unwrap(), old);
        assert_eq!(in_edition(&new, Edition::V1_3).unwrap(), new);
        let document: Value = serde_json::from_slice(&new).unwrap();
        assert_eq!(document["@context"][0], "https://w3id.org/ro/crate/1.3/context");
        let graph = document["@graph"].as_array().unwrap();
        let entity = |id: &str| graph.iter().find(|entity| entity["@id"] == id).unwrap();
        let expected = json!({"@id": "https://w3id.org/ro/crate/1.3"});
        assert_eq!(entity(format::METADATA)["conformsTo"], expected);
        let profiles = [
            "https://w3id.org/ro/wfrun/process/0.6",
            "https://w3id.org/ro/wfrun/workflow/0.6",
            "https://w3id.org/ro/wfrun/provenance/0.6",
            "https://w3id.org/workflowhub/workflow-ro-crate/1.1",
        ];
        assert_eq!(entity("./")["conformsTo"], json!(profiles.map(|id| json!({"@id": id}))));
        assert_eq!(profiles.map(|id| &entity(id)["version"]), ["0.6", "0.6", "0.6", "1.1"]);
        let text = String::from_utf8(new).unwrap();
        assert!(!text.contains("/0.5\"") && !text.contains("/ro/crate/1.1"), "{text}");
    }

    #[test]
    fn a_work_without_an_address_is_what_the_crate_is_based_on() {
        let text = String::from_utf8(metadata()).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        let root = |document: &Value| {
            let graph = document["@graph"].as_array().unwrap();
            graph.iter().find(|entity| entity["@id"] == "./").unwrap().clone()
        };
        let cited = root(&document)["citation"]["@id"].as_str().unwrap().to_owned();
        let local = text.replace(&cited, "#reproduced-work");
        let new = in_edition(local.as_bytes(), Edition::V1_3).unwrap();
        let new: Value = serde_json::from_slice(&new).unwrap();
        assert_eq!(root(&new)["isBasedOn"], json!({"@id": "#reproduced-work"}));
        assert_eq!(root(&new).get("citation"), None);
        // One that has an address is cited in both.
        let new = in_edition(text.as_bytes(), Edition::V1_3).unwrap();
        let new: Value = serde_json::from_slice(&new).unwrap();
        assert_eq!(root(&new)["citation"]["@id"] == cited.as_str(), !cited.starts_with('#'));
    }

    #[test]
    fn what_this_program_does_not_write_is_in_no_edition() {
        let old = String::from_utf8(metadata()).unwrap();
        let spaced = old.replacen("\"@graph\"", " \"@graph\"", 1);
        for foreign in [&spaced, "", "{}", "[]", "{\"@context\": [], \"@graph\": []}"] {
            assert_eq!(in_edition(foreign.as_bytes(), Edition::V1_3), None, "{foreign:.80}");
        }
        // Words of the newer one that lead to none of the older.
        let new = String::from_utf8(in_edition(old.as_bytes(), Edition::V1_3).unwrap()).unwrap();
        let mixed = new.replacen("process/0.6", "process/0.5", 1);
        assert_eq!(in_edition(mixed.as_bytes(), Edition::V1_1), None);
    }
}
