//! Warnings of a world: one for each kind of thing, with how many there are, not one for each thing.

use super::files::model_name;
use crate::document::{Diagnostic, Source, listed};
use roxmltree::Node;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

/// A place in one of the files that a world is read from.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) source: Source,
    pub(super) span: Range<usize>,
}

impl Place {
    /// Returns where `node` of `source` begins.
    pub(super) fn of(source: &Source, node: Node<'_, '_>) -> Self {
        Self { source: source.clone(), span: crate::document::xml::tag_span(node) }
    }

    /// Creates a fault here, to be completed.
    pub(super) fn fault(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(&self.source, self.span.clone(), message)
    }
}

/// What is to be told of a thing.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A collision is missing: the mesh `uri` cannot be had, and why.
    Mesh { uri: String, why: String },
    /// A collision is missing: the heightmap `uri` cannot be had, and why.
    Heightmap { uri: String, why: String },
    /// A collision is missing: its shape is one that is not read.
    Shape(String),
    /// A collision is missing: it has no shape.
    NoShape,
    /// A model is missing: the `uri` of an include leads nowhere, and why.
    Include { uri: String, why: String },
    /// A model is missing: there is none in any of these folders. Its name is the URI.
    Unfound(Vec<String>),
    /// An element is missing: `actor`, `population`, `road`.
    Element(String),
    /// A collision is missing: it is as far away as this (m).
    Far(String),
    /// A model can move in Gazebo.
    Moves,
    /// A solid is floor.
    Floor,
    /// A mesh file says that an axis is up.
    UpAxis(char),
    /// A pose turns by more than once around.
    Overturned,
    /// A file says that it is of a version of SDFormat that is not known.
    Version(String),
}

/// How many names a warning tells.
const MOST_NAMES: usize = 4;

#[derive(Debug)]
struct Note {
    names: Vec<String>,
    count: usize,
    place: Option<Place>,
}

/// Everything to be told, each kind once.
#[derive(Debug, Default)]
pub(super) struct Notes {
    order: Vec<Kind>,
    notes: BTreeMap<Kind, Note>,
}

impl Notes {
    /// Notes that `name`, which is written at `place`, is of this `kind`.
    pub(super) fn add(&mut self, kind: &Kind, name: &str, place: Option<&Place>) {
        if let Some(note) = self.notes.get_mut(kind) {
            note.count += 1;
            if note.names.len() <= MOST_NAMES && !note.names.iter().any(|known| known == name) {
                note.names.push(name.to_owned());
            }
            return;
        }
        let note = Note { names: vec![name.to_owned()], count: 1, place: place.cloned() };
        self.order.push(kind.clone());
        self.notes.insert(kind.clone(), note);
    }

    /// Returns the first warning of something that is missing.
    pub(super) fn first_lack(&self) -> Option<Diagnostic> {
        self.finish().find(|warning| warning.message.ends_with(" missing"))
    }

    /// Returns the warnings, in the order in which their kinds were met.
    pub(super) fn finish(&self) -> impl Iterator<Item = Diagnostic> {
        self.order.iter().map(|kind| {
            let note = &self.notes[kind];
            let message = said(kind, note);
            match &note.place {
                Some(place) => place.fault(message).warning(),
                None => Diagnostic::placeless(message).warning(),
            }
        })
    }
}

/// Most characters of a name.
const MOST_NAME: usize = 240;

/// Returns `name` cut where it is endless: paths are long, and it is their end that tells.
fn shortened(name: &str) -> Cow<'_, str> {
    match name.chars().count().checked_sub(MOST_NAME) {
        None | Some(0) => Cow::Borrowed(name),
        Some(more) => Cow::Owned(format!("...{}", name.chars().skip(more).collect::<String>())),
    }
}

fn said(kind: &Kind, note: &Note) -> String {
    let (name, n) = (shortened(&note.names[0]), note.count);
    let told = &note.names[..note.names.len().min(MOST_NAMES)];
    let names: Vec<String> = told.iter().map(|name| format!("`{}`", shortened(name))).collect();
    let dots = if note.names.len() > MOST_NAMES { ", ..." } else { "" };
    let names = names.join(", ") + dots;
    // A world counts what it lacks by how these end.
    let missing = if n == 1 { "it is missing".to_owned() } else { format!("{n} are missing") };
    match kind {
        Kind::Mesh { uri, why } | Kind::Heightmap { uri, why } => {
            let uri = shortened(uri);
            let shape = if matches!(kind, Kind::Mesh { .. }) { "mesh" } else { "heightmap" };
            let subject = match n {
                1 => format!("collision `{name}` is a {shape} `{uri}`"),
                _ => format!("{n} collisions ({names}) are a {shape} `{uri}`"),
            };
            match why.as_str() {
                "" => format!("{subject}, which cannot be read: {missing}"),
                why => format!("{subject}; {why}: {missing}"),
            }
        }
        Kind::Shape(shape) => {
            let a = if shape.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
            match n {
                1 => format!("collision `{name}` is {a} {shape}, which cannot be read: {missing}"),
                _ => format!(
                    "{n} collisions ({names}) are {a} {shape}, which cannot be read: {missing}"
                ),
            }
        }
        Kind::NoShape if n == 1 => format!("collision `{name}` has no geometry: {missing}"),
        Kind::NoShape => format!("{n} collisions ({names}) have no geometry: {missing}"),
        Kind::Include { uri, why } if n == 1 => {
            format!("<include> of `{}`: {why}: the model is missing", shortened(uri))
        }
        Kind::Include { uri, why } => {
            format!("{n} times <include> of `{}`: {why}: {missing}", shortened(uri))
        }
        Kind::Unfound(folders) => {
            let folders: Vec<String> =
                folders.iter().map(|f| format!("`{}`", shortened(f))).collect();
            let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
            let where_to = match folders[..] {
                [] => "no folder of models is given".to_owned(),
                _ => format!("none of that name in {}", listed(&folders)),
            };
            let model = model_name(&note.names[0]);
            match n {
                1 => format!(
                    "<include> of `{name}`: {where_to}; name its own folder (`models: {{{model}: FOLDER}}`) or one that holds it (`model-path: [FOLDER]`): the model is missing"
                ),
                _ => format!(
                    "{n} times <include> ({names}): {where_to}; name the folder of each (`models: {{{model}: FOLDER, ...}}`) or one that holds them (`model-path: [FOLDER]`): {missing}"
                ),
            }
        }
        Kind::Element(kind) if n == 1 => {
            format!("<{kind}> `{name}` cannot be read: {missing}")
        }
        Kind::Element(kind) => format!("{n} times <{kind}> ({names}) cannot be read: {missing}"),
        Kind::Far(far) if n == 1 => format!("`{name}` is {far} m away: {missing}"),
        Kind::Far(far) => format!("{n} collisions ({names}) are {far} m away: {missing}"),
        Kind::Moves if n == 1 => format!("model `{name}` can move in Gazebo and stands still here"),
        Kind::Moves => format!("{n} models ({names}) can move in Gazebo and stand still here"),
        Kind::Floor if n == 1 => format!("`{name}` lies flat on the ground: it is floor"),
        Kind::Floor => format!("{n} solids ({names}) lie flat on the ground: they are floor"),
        Kind::UpAxis(axis) => {
            let meshes = if n == 1 { "the mesh" } else { "the meshes" };
            let say = if n == 1 { "says" } else { "say" };
            format!(
                "{meshes} {names} {say} that {axis} is up: taken as Gazebo does, which turns no mesh by that"
            )
        }
        Kind::Overturned if n == 1 => format!(
            "the pose of `{name}` turns by more than once around: angles are read as radians, are these degrees? SDFormat has `<pose degrees=\"true\">`"
        ),
        Kind::Overturned => format!(
            "{n} poses (of {names}) turn by more than once around: angles are read as radians, are these degrees? SDFormat has `<pose degrees=\"true\">`"
        ),
        Kind::Version(version) => format!(
            "`{name}` is of SDFormat {}, which is not known (1.3 to 1.12 are): read as 1.12",
            shortened(version)
        ),
    }
}
