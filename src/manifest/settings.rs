//! `settings: FILE`, a list of files, or one for every value of a factor: parameters that several manifests share, written once with
//! their reasons.

use super::faults::step;
use super::input::{InputKind, WrittenIn};
use super::library::{Library, joined, normalised, relative_to};
use super::overrides;
use super::parameters::{ParametersDoc, ParametersSchema, is_wrapped};
use crate::document::{Content, Diagnostic, Node, Source, Tree, parse_tree_by, read};
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

/// Lays the parameters of the files that `settings` names, where the manifest `tree` has one, beneath its own.
///
/// # Errors
/// Where a file cannot be read, is no file of settings, one of another study, or leaves out what another one sets.
pub(super) fn underlay(
    tree: &mut Tree,
    overridden: &[String],
    library: &mut Library<'_>,
) -> Result<(), Vec<Diagnostic>> {
    // `--set settings=FILE` has its say first; its other values go over the file's later.
    let mut as_set = tree.clone();
    overrides::apply(&mut as_set, overridden)?;
    let Some(written) = as_set.root.get("settings") else { return Ok(()) };
    if let Some(path) = written.scalar_text() {
        let (source, _) = settings_file(&as_set, "/settings", &path, library)?;
        return tree.underlay(&source, "parameters", &is_wrapped);
    }
    // The last one lies uppermost: what it says is there before the others are laid beneath.
    let paths: Vec<Option<String>> = written.items().iter().map(Node::scalar_text).collect();
    for (index, path) in paths.into_iter().enumerate().rev() {
        let Some(path) = path else { return Ok(()) };
        let pointer = format!("/settings/{index}");
        let (source, _) = settings_file(&as_set, &pointer, &path, library)?;
        tree.underlay(&source, "parameters", &is_wrapped)?;
    }
    // What is no such mapping is told with the rest of the manifest, by its schema.
    let by = written.get("by").and_then(Node::scalar_text);
    let files = written.get("values").map_or(&[][..], Node::entries);
    let Some(factor) = by else { return Ok(()) };
    let mut levels = Vec::new();
    for entry in files {
        let Some(path) = entry.value.scalar_text() else { return Ok(()) };
        let pointer = step("/settings/values", &entry.key);
        let (source, parameters) = settings_file(&as_set, &pointer, &path, library)?;
        levels.push((entry.key.clone(), source, parameters));
    }
    let faults = left_out(&levels);
    if !faults.is_empty() {
        return Err(faults);
    }
    let sources: Vec<(String, Source)> =
        levels.into_iter().map(|(level, source, _)| (level, source)).collect();
    tree.underlay_by(&factor, &sources, "parameters", &is_wrapped)
}

/// Returns the file of settings that `pointer` names as `path`, and its tree.
fn settings_file(
    tree: &Tree,
    pointer: &str,
    path: &str,
    library: &mut Library<'_>,
) -> Result<(Source, Tree), Vec<Diagnostic>> {
    let place = tree.place(pointer);
    let written_in = if place.source == 0 { WrittenIn::Manifest } else { WrittenIn::CommandLine };
    let fault = |message: String| tree.fault(place, message);
    let found = library.files.read(&normalised(path), written_in, InputKind::Settings);
    let bytes = found.map_err(|reason| {
        let fault = fault(format!("cannot read `{path}`"));
        vec![fault.label(reason.to_string()).help(relative_to(written_in))]
    })?;
    let text = std::str::from_utf8(&bytes).map_err(|_| {
        vec![fault(format!("`{path}` is not UTF-8 text")).label("expected a text file")]
    })?;
    let name = match written_in {
        WrittenIn::Manifest => joined(&tree.sources[0].name, path),
        WrittenIn::CommandLine
        | WrittenIn::Calibration
        | WrittenIn::Inference
        | WrittenIn::PreviousMap => normalised(path),
    };
    let source = Source::new(name, text);
    let study_of = |tree: &Tree| tree.root.get("study").and_then(Node::scalar_text);
    let written = read(&source)?;
    let (own, theirs) = (study_of(tree), study_of(&written));
    let kind = theirs.as_deref().and_then(StudyKind::named);
    let mut expected = crate::document::schema_of::<SettingsDoc>();
    if let Some(kind) = kind {
        ParametersSchema::of(kind).put_into(&mut expected);
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
    Ok((source, written))
}

/// Returns a fault for every parameter that one of these files sets and another leaves out: what would hold there then is
/// nowhere to be read.
fn left_out(levels: &[(String, Source, Tree)]) -> Vec<Diagnostic> {
    let set: Vec<Vec<String>> = levels
        .iter()
        .map(|(_, _, tree)| {
            let mut paths = Vec::new();
            if let Some(parameters) = tree.root.get("parameters") {
                values_below(parameters, "/parameters", &mut paths);
            }
            paths
        })
        .collect();
    let mut faults = Vec::new();
    for (i, (_, _, tree)) in levels.iter().enumerate() {
        for path in &set[i] {
            let lacking = set.iter().position(|others| !others.contains(path));
            if let Some((level, source, _)) = lacking.map(|j| &levels[j]) {
                let name = path.trim_start_matches("/parameters/").replace('/', ".");
                let message = format!("`{name}` is set here and not in `{}`", source.name);
                let fault = tree.fault(tree.key_place(path), message);
                let help = format!("say there what holds for `{level}`");
                faults.push(fault.label("expected in all of `settings`").help(help));
            }
        }
    }
    faults
}

/// Collects the pointers of the values in the group `node` at `pointer`.
fn values_below(node: &Node, pointer: &str, paths: &mut Vec<String>) {
    if is_wrapped(node) || !matches!(node.content, Content::Map(_)) {
        paths.push(pointer.to_owned());
        return;
    }
    for entry in node.entries() {
        values_below(&entry.value, &step(pointer, &entry.key), paths);
    }
}
