//! `settings: FILE`: parameters that several manifests share, written once with their reasons.

use super::input::{InputKind, WrittenIn};
use super::library::{Library, joined, normalised, relative_to};
use super::overrides;
use super::parameters::{ParametersDoc, is_wrapped, schema_of};
use crate::document::{Diagnostic, Node, Source, Tree, parse_tree_by, read};
use crate::studies::StudyKind;
use schemars::JsonSchema;
use serde::Deserialize;

/// A file of settings.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "Reenact settings")]
struct SettingsDoc {
    /// Version of this format: 1.
    #[serde(rename = "reenact-settings")]
    #[schemars(range(min = 1, max = 1))]
    _version: u32,
    /// The study whose parameters these are.
    #[serde(rename = "study")]
    _study: StudyKind,
    /// As in a manifest.
    #[serde(rename = "parameters")]
    _parameters: ParametersDoc,
}

/// Lays the parameters of the file that `settings` names, where the manifest `tree` has one, beneath its own.
///
/// # Errors
/// Where the file cannot be read, is no file of settings or one of another study.
pub(super) fn underlay(
    tree: &mut Tree,
    overridden: &[String],
    library: &mut Library<'_>,
) -> Result<(), Vec<Diagnostic>> {
    // `--set settings=FILE` has its say first; its other values go over the file's later.
    let mut as_set = tree.clone();
    overrides::apply(&mut as_set, overridden)?;
    let Some(path) = as_set.root.get("settings").and_then(Node::scalar_text) else {
        return Ok(());
    };
    let place = as_set.place("/settings");
    let written_in = if place.source == 0 { WrittenIn::Manifest } else { WrittenIn::CommandLine };
    let fault = |message: String| as_set.fault(place, message);
    let found = library.files.read(&normalised(&path), written_in, InputKind::Settings);
    let bytes = found.map_err(|reason| {
        let fault = fault(format!("cannot read `{path}`"));
        vec![fault.label(reason.to_string()).help(relative_to(written_in))]
    })?;
    let text = std::str::from_utf8(&bytes).map_err(|_| {
        vec![fault(format!("`{path}` is not UTF-8 text")).label("expected a text file")]
    })?;
    let name = match written_in {
        WrittenIn::Manifest => joined(&tree.sources[0].name, &path),
        WrittenIn::CommandLine | WrittenIn::Calibration | WrittenIn::PreviousMap => {
            normalised(&path)
        }
    };
    let source = Source::new(name, text);
    let study_of = |tree: &Tree| tree.root.get("study").and_then(Node::scalar_text);
    let written = read(&source)?;
    let (own, theirs) = (study_of(&as_set), study_of(&written));
    let kind = theirs.as_deref().and_then(StudyKind::named);
    let mut expected = crate::document::schema_of::<SettingsDoc>();
    if let Some(kind) = kind {
        expected["properties"]["parameters"] = schema_of(kind);
    }
    let written = parse_tree_by::<SettingsDoc>(written, &expected)?.tree;
    if let (Some(own), Some(theirs)) = (own, theirs)
        && own != theirs
    {
        let fault = written
            .fault(written.place("/study"), format!("settings of the study `{theirs}`"))
            .label(format!("expected `{own}`, the study of the manifest that names this file"));
        return Err(vec![fault]);
    }
    tree.underlay(&source, "parameters", &is_wrapped)
}
