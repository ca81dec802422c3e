//! What editors and scripts read files and answers by: the committed JSON Schemas are those of the program, and what is shipped
//! validates against them. The validator is another one than the program's own.

use crate::sandbox::{Sandbox, repository};
use reenact::document::{self, Source};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// The first line of a manifest, before the path of its schema.
const MODELINE: &str = "# yaml-language-server: $schema=";

/// Returns every manifest that is shipped.
fn shipped() -> Vec<PathBuf> {
    let mut manifests = Vec::new();
    for folder in ["manifests", "manifests/original"] {
        for entry in fs::read_dir(repository().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "yaml") {
                manifests.push(path);
            }
        }
    }
    manifests.sort();
    manifests
}

fn schema(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Returns what of `instance` differs from `schema`, a line each.
fn differences(schema: &Value, instance: &Value) -> Vec<String> {
    let validator = jsonschema::draft202012::new(schema).unwrap_or_else(|e| panic!("{e}"));
    let differences = validator.iter_errors(instance);
    differences.map(|e| format!("{}: {e}", e.instance_path())).collect()
}

/// Reads the manifest at `path` and returns the path of the schema that its first line names, and what differs from it.
fn by_its_own_schema(path: &Path) -> (PathBuf, Vec<String>) {
    let text = fs::read_to_string(path).unwrap();
    let named = text.lines().next().and_then(|line| line.strip_prefix(MODELINE));
    let named = named.unwrap_or_else(|| panic!("{}: no schema is named", path.display()));
    let of = path.parent().unwrap().join(named);
    let tree = document::read(&Source::new("manifest.yaml", text.as_str())).unwrap();
    let differences = differences(&schema(&of), &tree.root.to_json());
    (of, differences)
}

#[test]
fn the_committed_schema_of_manifests_is_the_one_that_is_printed() {
    let printed = Sandbox::new().run(&["schema"]);
    let committed = fs::read_to_string(repository().join("schemas/manifest.schema.json")).unwrap();
    assert!(
        printed.stdout == committed,
        "reenact schema > schemas/manifest.schema.json writes it anew"
    );
    let schema: Value = serde_json::from_str(&committed).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema["$id"], "urn:reenact:manifest:1");
    jsonschema::meta::validate(&schema).unwrap();
}

#[test]
fn every_shipped_manifest_validates_against_the_schema_that_it_names() {
    let manifests = shipped();
    assert!(manifests.len() > 25, "{}", manifests.len());
    let committed = repository().join("schemas/manifest.schema.json").canonicalize().unwrap();
    for path in manifests {
        let (of, differences) = by_its_own_schema(&path);
        assert_eq!(of.canonicalize().unwrap(), committed, "{}", path.display());
        assert!(differences.is_empty(), "{}: {differences:#?}", path.display());
    }
}

#[test]
fn a_starter_study_names_a_schema_that_lies_beside_it() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&["init", "first"]).code, 0);
    let (_, differences) = by_its_own_schema(&sandbox.path("first/first.yaml"));
    assert_eq!(differences, [""; 0]);
}

#[test]
fn an_editor_is_told_of_what_is_no_manifest() {
    let schema = schema(&repository().join("schemas/manifest.schema.json"));
    let path = repository().join("manifests/quickstart.yaml");
    let text = fs::read_to_string(path).unwrap().replace("trials: 10", "trials: none\nbags: 2");
    let tree = document::read(&Source::new("manifest.yaml", text.as_str())).unwrap();
    let mut told = differences(&schema, &tree.root.to_json());
    told.sort();
    assert_eq!(
        told,
        [
            ": Additional properties are not allowed ('bags' was unexpected)",
            "/trials: \"none\" is not of type \"integer\"",
        ]
    );
}
