//! The models and meshes that a Gazebo world names: files in the folders that the manifest gives, each sealed like any
//! input, or what the manifest puts in their place.

use super::document::{UpAxisDoc, WorldFile};
use super::faults::step;
use super::input::{InputKind, WrittenIn};
use super::library::{Library, Unread, joined, normalised};
use super::resolver::Resolver;
use crate::world::sdf::{FilePath, Folders, Models, Root};
use crate::world::{Solid, document};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a manifest knows of one world's models.
pub(super) struct Shelf<'r, 'a> {
    doc: &'r WorldFile,
    roots: Roots,
    library: &'r mut Library<'a>,
    stand_ins: BTreeMap<&'r str, Arc<[Solid]>>,
    told: Told,
}

/// Where the paths of files begin.
pub(super) struct Roots {
    /// The world's own path, which its relative URIs are beside.
    pub(super) world: (String, WrittenIn),
    /// What the folders of `models` are relative to.
    pub(super) models: WrittenIn,
    /// What those of `model-path` are relative to.
    pub(super) model_path: WrittenIn,
}

/// What came of a shelf.
#[derive(Default)]
pub(super) struct Told {
    /// Files that are not the ones that are pinned, in words.
    unpinned: Vec<String>,
    /// The meshes that were asked for.
    asked: BTreeSet<String>,
    /// The models that the world has.
    models: BTreeSet<String>,
}

impl Resolver<'_> {
    /// Returns what the manifest knows of the meshes of `doc`, written at `pointer`, and collects the faults of its
    /// stand-ins. The world is at `world`.
    pub(super) fn stand_ins<'d>(
        &mut self,
        doc: &'d WorldFile,
        pointer: &str,
    ) -> BTreeMap<&'d str, Arc<[Solid]>> {
        let mut stand_ins = BTreeMap::new();
        for (uri, layer) in doc.stand_ins.iter() {
            let place = step(&format!("{pointer}/stand-ins"), uri);
            let tree = self.faults.tree;
            let fault = |at: &str, message: &str| tree.fault(tree.place(at), message);
            match document::solids(layer, &place, &fault) {
                Ok(solids) => drop(stand_ins.insert(uri.as_str(), solids.into())),
                Err(faults) => self.faults.extend(faults),
            }
        }
        stand_ins
    }

    /// Collects the faults and warnings of what `shelf` had to hand over for the world at `pointer`.
    pub(super) fn told_by(&mut self, told: Told, doc: &WorldFile, pointer: &str) {
        for problem in told.unpinned {
            self.faults.at(&format!("{pointer}/file"), problem, "named by this world");
        }
        for uri in doc.stand_ins.keys().filter(|uri| !told.asked.contains(*uri)) {
            let place = step(&format!("{pointer}/stand-ins"), uri);
            let fault = self.faults.key_fault(&place, "this stands in for nothing");
            let label = "expected the URI of a mesh, as the world writes it";
            self.faults.push(fault.label(label).warning());
        }
        for (i, name) in doc.without.iter().enumerate().filter(|(_, n)| !told.models.contains(*n)) {
            let known: Vec<&str> = told.models.iter().map(String::as_str).collect();
            let message = format!("unknown model `{name}`");
            let label = "expected a model of this world";
            self.faults.unknown(&format!("{pointer}/without/{i}"), message, label, name, &known);
        }
    }
}

impl<'r, 'a> Shelf<'r, 'a> {
    pub(super) fn new(
        doc: &'r WorldFile,
        roots: Roots,
        library: &'r mut Library<'a>,
        stand_ins: BTreeMap<&'r str, Arc<[Solid]>>,
    ) -> Self {
        Self { doc, roots, library, stand_ins, told: Told::default() }
    }

    pub(super) fn told(self) -> Told {
        self.told
    }

    fn path_of(&self, path: &FilePath) -> (String, WrittenIn) {
        match path.root {
            Root::World => (joined(&self.roots.world.0, &path.path), self.roots.world.1),
            Root::Models => (normalised(&path.path), self.roots.models),
            Root::ModelPath => (normalised(&path.path), self.roots.model_path),
        }
    }
}

impl Models for Shelf<'_, '_> {
    fn folders(&self) -> Folders {
        Folders { models: self.doc.models.clone(), path: self.doc.model_path.clone() }
    }

    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String> {
        let (path, written_in) = self.path_of(path);
        match self.library.read(&path, written_in, InputKind::World) {
            Ok(bytes) => Ok(bytes),
            Err(Unread::Unpinned { bytes, digests, .. }) => {
                self.told
                    .unpinned
                    .push(format!("the file `{path}` is not the one that is pinned: {digests}"));
                Ok(bytes)
            }
            Err(Unread::Missing { reason, published }) => {
                self.told.unpinned.extend(published.map(|published| {
                    format!("cannot read the file `{path}`, published as {published}")
                }));
                Err(reason.to_string())
            }
        }
    }

    fn name(&self, path: &FilePath) -> String {
        self.path_of(path).0
    }

    fn follows(&mut self, path: &FilePath) -> bool {
        let (path, written_in) = self.path_of(path);
        self.library.files.follows(&path, written_in)
    }

    fn stand_in(&mut self, uri: &str) -> Option<Arc<[Solid]>> {
        if !self.stand_ins.is_empty() {
            self.told.asked.insert(uri.to_owned());
        }
        self.stand_ins.get(uri).cloned()
    }

    fn wanted(&mut self, name: &str) -> bool {
        if self.doc.without.is_empty() {
            return true;
        }
        self.told.models.insert(name.to_owned());
        !self.doc.without.iter().any(|left_out| left_out == name)
    }

    fn turns_meshes(&self) -> bool {
        self.doc.up_axis == UpAxisDoc::AsWritten
    }
}
