//! The meshes that a Gazebo world names: files in the folders that the manifest gives, each sealed like any input, or what
//! the manifest puts in their place.

use super::document::WorldFile;
use super::faults::step;
use super::input::{InputKind, WrittenIn};
use super::library::{Library, Unread, joined, normalised};
use super::resolver::Resolver;
use crate::world::sdf::{Found, MeshPath, Models, Unplaced, mesh_path};
use crate::world::{Solid, document, mesh};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a manifest knows of one world's meshes.
pub(super) struct Shelf<'r, 'a> {
    doc: &'r WorldFile,
    /// The world's own path, which relative URIs are beside.
    world: (String, WrittenIn),
    /// What the folders of models are relative to.
    folders: WrittenIn,
    library: &'r mut Library<'a>,
    stand_ins: BTreeMap<&'r str, Arc<[Solid]>>,
    known: BTreeMap<String, Found>,
    /// Files that are not the ones that are pinned, in words.
    unpinned: Vec<String>,
}

impl Shelf<'_, '_> {
    /// Returns the path of the file that `uri` names.
    fn path_of(&self, uri: &str) -> Result<(String, WrittenIn), Unplaced> {
        Ok(match mesh_path(uri, &self.doc.models)? {
            MeshPath::Model(path) => (normalised(&path), self.folders),
            MeshPath::Beside(path) => (joined(&self.world.0, &path), self.world.1),
        })
    }

    fn look_up(&mut self, uri: &str) -> Found {
        if let Some(solids) = self.stand_ins.get(uri) {
            return Found::StandIn(Arc::clone(solids));
        }
        let (path, written_in) = match self.path_of(uri) {
            Ok(found) => found,
            Err(why) => return Found::Missing(why.to_string()),
        };
        let bytes = match self.library.read(&path, written_in, InputKind::World) {
            Ok(bytes) => bytes,
            Err(Unread::Unpinned { bytes, digests, .. }) => {
                self.unpinned
                    .push(format!("the mesh `{path}` is not the file that is pinned: {digests}"));
                bytes
            }
            Err(Unread::Missing { reason, published }) => {
                self.unpinned.extend(published.map(|published| {
                    format!("cannot read the mesh `{path}`, published as {published}")
                }));
                return Found::Missing(format!("`{path}`: {reason}"));
            }
        };
        Found::Mesh(Arc::new(mesh::read(&path, &bytes)))
    }
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
        for (uri, layer) in &doc.stand_ins {
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
    }
}

/// What came of a shelf.
pub(super) struct Told {
    unpinned: Vec<String>,
    asked: BTreeSet<String>,
}

impl<'r, 'a> Shelf<'r, 'a> {
    pub(super) fn new(
        doc: &'r WorldFile,
        world: (String, WrittenIn),
        folders: WrittenIn,
        library: &'r mut Library<'a>,
        stand_ins: BTreeMap<&'r str, Arc<[Solid]>>,
    ) -> Self {
        let (known, unpinned) = (BTreeMap::new(), Vec::new());
        Self { doc, world, folders, library, stand_ins, known, unpinned }
    }

    pub(super) fn told(self) -> Told {
        Told { unpinned: self.unpinned, asked: self.known.into_keys().collect() }
    }
}

impl Models for Shelf<'_, '_> {
    fn find(&mut self, uri: &str) -> Found {
        if let Some(found) = self.known.get(uri) {
            return found.clone();
        }
        let found = self.look_up(uri);
        self.known.insert(uri.to_owned(), found.clone());
        found
    }
}
