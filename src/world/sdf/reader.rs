//! What the reading of one world shares: files read once each, faults and warnings of all of them.

use super::files::{FilePath, Folders, Models};
use super::include::{self, Loaded};
use super::model::{self, Model};
use super::notes::{Kind, Notes, Place};
use super::terrain::{Extent, Heights};
use super::{MAX_BYTES, check_macros, known_version};
use crate::document::sdf;
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, FaultList, Source, quoted};
use crate::world::Solid;
use crate::world::mesh::{self, MAX_TRIANGLES, Mesh, MeshFile, UpAxis};
use roxmltree::Node;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A file while it is read.
#[derive(Clone, Copy)]
pub(super) struct File<'s> {
    pub(super) path: &'s FilePath,
    pub(super) source: &'s Source,
}

/// Formats of meshes that Gazebo reads and this does not.
const OTHER_MESHES: [&str; 6] = [".glb", ".gltf", ".fbx", ".ply", ".blend", ".mesh"];

/// The highest version of a model of Fuel that is looked for; most have fewer than five.
const MAX_VERSION: u32 = 9;

/// Which part of a mesh file: its name, and whether it is moved to the origin.
type Submesh = Option<(String, bool)>;

/// What stands for a mesh.
pub(super) enum Found {
    Mesh(Mesh),
    StandIn(Arc<[Solid]>),
    /// It is missing, and why, to end a sentence.
    Missing(String),
    /// Its faults have been told.
    Nothing,
}

/// What the reading of one world shares.
pub(super) struct Reader<'m> {
    pub(super) models: &'m mut dyn Models,
    pub(super) folders: Folders,
    pub(super) notes: Notes,
    faults: FaultList,
    /// Descriptions by file; none where their faults have been told.
    read: BTreeMap<FilePath, Option<Arc<Model>>>,
    /// The file that describes the model in a folder.
    described: BTreeMap<FilePath, Option<FilePath>>,
    /// The files that are being read, each included by the one before.
    open: Vec<FilePath>,
    files: BTreeMap<FilePath, Option<Arc<MeshFile>>>,
    meshes: BTreeMap<(FilePath, Submesh), Option<Mesh>>,
    /// Heightmaps by their file, or why they are none.
    heights: BTreeMap<FilePath, Result<Heights, String>>,
    /// Triangles of all surfaces of heightmaps: each stands where it stands, and shares none with another.
    drawn: usize,
}

impl<'m> Reader<'m> {
    pub(super) fn new(models: &'m mut dyn Models) -> Self {
        Self {
            folders: models.folders(),
            models,
            notes: Notes::default(),
            faults: FaultList::default(),
            read: BTreeMap::new(),
            described: BTreeMap::new(),
            open: Vec::new(),
            files: BTreeMap::new(),
            meshes: BTreeMap::new(),
            heights: BTreeMap::new(),
            drawn: 0,
        }
    }

    /// Returns what messages call the file `path`.
    pub(super) fn name(&self, path: &FilePath) -> String {
        self.models.name(path)
    }

    /// Returns whether a file beside the world's own cannot be used.
    pub(super) fn any_error(&self) -> bool {
        self.faults.any_error()
    }

    /// Takes the faults of files beside the world's own.
    pub(super) fn take_faults(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.faults).finish()
    }

    /// Notes the version of an `<sdf>` where it is none that is known, and poses whose angles seem to be degrees.
    pub(super) fn note_oddities(&mut self, root: Node<'_, '_>, source: &Source) {
        for pose in sdf::overturned(root) {
            let whose = pose.parent_element().unwrap_or(pose);
            let name = whose.attribute("name").unwrap_or(whose.tag_name().name());
            self.notes.add(&Kind::Overturned, name, Some(&Place::of(source, pose)));
        }
        if let Some(version) = root.attribute("version")
            && known_version(version).is_none()
        {
            self.notes.add(&Kind::Version(version.trim().to_owned()), &source.name, None);
        }
    }

    /// Returns the model that `uri`, written in the file `beside`, names; `fault` makes a fault of the include.
    pub(super) fn model(
        &mut self,
        uri: &str,
        beside: &FilePath,
        depth: usize,
        fault: &dyn Fn(String) -> Diagnostic,
    ) -> Loaded {
        let places = self.folders.places(uri, beside, self.models);
        let mut found = None;
        for place in places.iter().flatten() {
            found = self.description(place);
            if found.is_some() {
                break;
            }
        }
        let Some(path) = found else {
            return Loaded::Absent(include::absent(uri, &places, self));
        };
        if let Some(at) = self.open.iter().position(|open| *open == path) {
            let circle = self.open[at..].iter().chain([&path]);
            let names: Vec<String> = circle.map(|p| format!("`{}`", self.name(p))).collect();
            let message = format!("files that include each other: {}", names.join(" includes "));
            self.faults.push(fault(message).label("included here"));
            return Loaded::Nothing;
        }
        if let Some(known) = self.read.get(&path) {
            return known.as_ref().map_or(Loaded::Nothing, |m| Loaded::Model(Arc::clone(m)));
        }
        let bytes = match self.models.read(&path) {
            Ok(bytes) => bytes,
            Err(why) => {
                let why = format!("`{}`: {why}", self.name(&path));
                return Loaded::Absent(Kind::Include { uri: uri.to_owned(), why });
            }
        };
        self.open.push(path.clone());
        let loaded = self.described_by(uri, &path, &bytes, depth);
        self.open.pop();
        let kept = match &loaded {
            Loaded::Model(model) => Some(Arc::clone(model)),
            Loaded::Nothing => None,
            Loaded::Absent(_) => return loaded,
        };
        self.read.insert(path, kept);
        loaded
    }

    /// Returns the file that describes the model at `place`: a file itself, or what the `model.config` of a folder says.
    fn description(&mut self, place: &FilePath) -> Option<FilePath> {
        let ending = place.path.rsplit('/').next().and_then(|file| file.rsplit_once('.'));
        if ending.is_some_and(|(_, e)| ["sdf", "world", "xml", "urdf"].contains(&e)) {
            let is_there = self.read.contains_key(place) || self.models.read(place).is_ok();
            return is_there.then(|| place.clone());
        }
        if let Some(known) = self.described.get(place) {
            return known.clone();
        }
        let config = place.within("model.config");
        let found = if let Ok(bytes) = self.models.read(&config) {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let file = include::description(&Source::new(self.name(&config), text));
            Some(place.within(file.as_deref().unwrap_or("model.sdf")))
        } else {
            let own = place.within("model.sdf");
            self.models.read(&own).is_ok().then_some(own)
        };
        // Downloads of Fuel lie in folders of their versions.
        let is_version = place.path.rsplit('/').next().is_some_and(|v| v.parse::<u32>().is_ok());
        let found = match found {
            None if !is_version => {
                let mut versions = (1..=MAX_VERSION).rev().map(|v| place.within(&v.to_string()));
                versions.find_map(|version| self.description(&version))
            }
            found => found,
        };
        self.described.insert(place.clone(), found.clone());
        found
    }

    /// Reads the model in the file `path`.
    fn described_by(&mut self, uri: &str, path: &FilePath, bytes: &[u8], depth: usize) -> Loaded {
        let name = self.name(path);
        let absent = |why: String| Loaded::Absent(Kind::Include { uri: uri.to_owned(), why });
        let Ok(text) = std::str::from_utf8(bytes) else {
            return absent(format!("`{name}` is not text"));
        };
        let source = Source::new(name.clone(), text);
        let document = match xml::parse(&source, MAX_BYTES) {
            Ok(document) => document,
            Err(faults) => {
                self.faults.extend(faults);
                return Loaded::Nothing;
            }
        };
        let root = document.root_element();
        let kind = root.tag_name().name();
        if kind != "sdf" {
            return absent(format!("`{name}` holds <{}>, not <sdf>", quoted(kind)));
        }
        self.note_oddities(root, &source);
        let mut faults = Faults::new(&source);
        check_macros(root, &mut faults);
        let loaded = match xml::child(root, "model") {
            Some(node) => {
                let file = File { path, source: &source };
                let model = model::read(node, &file, depth, self, &mut faults);
                Loaded::Model(Arc::new(model))
            }
            None if xml::child(root, "light").is_some() => Loaded::Nothing,
            None => absent(format!("`{name}` holds no model")),
        };
        let broken = faults.any_error();
        self.faults.extend(faults.finish());
        if broken { Loaded::Nothing } else { loaded }
    }

    /// Returns what stands for the mesh `uri`, written in the file `beside`; of its parts those that `submesh` wants.
    pub(super) fn mesh(
        &mut self,
        uri: &str,
        beside: &FilePath,
        submesh: &Submesh,
        unknown: &mut dyn FnMut(&[&str]),
    ) -> Found {
        if let Some(solids) = self.models.stand_in(uri) {
            return Found::StandIn(solids);
        }
        let small = uri.to_ascii_lowercase();
        if let Some(other) = OTHER_MESHES.iter().find(|ending| small.ends_with(*ending)) {
            return Found::Missing(format!("`{other}` is not read (.stl, .obj and .dae are)"));
        }
        let places = match self.folders.places(uri, beside, self.models) {
            Ok(places) => places,
            Err(why) => return Found::Missing(why.to_string()),
        };
        let mut why = Vec::new();
        for path in &places {
            match self.file(path) {
                Ok(None) => return Found::Nothing,
                Ok(Some(file)) => {
                    let key = (path.clone(), submesh.clone());
                    let mesh = self.meshes.entry(key).or_insert_with(|| part(&file, submesh));
                    let Some(mesh) = mesh else {
                        let names = file.parts.iter().filter_map(|p| p.names.first());
                        unknown(&names.map(String::as_str).collect::<Vec<_>>());
                        return Found::Nothing;
                    };
                    return Found::Mesh(mesh.clone());
                }
                Err(problem) => why.push((path, problem)),
            }
        }
        Found::Missing(self.absence(&why))
    }

    /// Returns the surface of the heightmap `uri`, written in the file `beside`.
    pub(super) fn heightmap(
        &mut self,
        uri: &str,
        beside: &FilePath,
        extent: Extent,
    ) -> Result<Mesh, String> {
        let places =
            self.folders.places(uri, beside, self.models).map_err(|why| why.to_string())?;
        let mut why = Vec::new();
        for path in &places {
            if !self.heights.contains_key(path) {
                match self.models.read(path) {
                    Ok(bytes) => drop(self.heights.insert(path.clone(), Heights::read(&bytes))),
                    Err(problem) => {
                        why.push((path, problem));
                        continue;
                    }
                }
            }
            let heights = self.heights[path].as_ref();
            let heights = heights.map_err(|problem| format!("`{}`: {problem}", self.name(path)))?;
            if self.drawn + heights.triangles() > MAX_TRIANGLES {
                return Err(format!(
                    "the heightmaps of the world have more than {MAX_TRIANGLES} triangles with it"
                ));
            }
            let surface = heights.surface(extent);
            self.drawn += surface.triangles().len();
            return Ok(surface);
        }
        Err(self.absence(&why))
    }

    /// Says why none of these places holds a file.
    fn absence(&self, why: &[(&FilePath, String)]) -> String {
        match why {
            [(path, problem)] => format!("`{}`: {problem}", self.name(path)),
            [(first, _), (second, _), others @ ..] => {
                let more = match others.len() {
                    0 => String::new(),
                    n => format!(" and {n} more"),
                };
                format!("no such file: `{}`, `{}`{more}", self.name(first), self.name(second))
            }
            [] => "no such file".to_owned(),
        }
    }

    /// Returns the mesh file at `path`; none where its faults have been told.
    fn file(&mut self, path: &FilePath) -> Result<Option<Arc<MeshFile>>, String> {
        if let Some(known) = self.files.get(path) {
            return Ok(known.clone());
        }
        let bytes = self.models.read(path)?;
        if bytes.starts_with(b"version https://git-lfs") {
            return Err("it is a pointer of Git LFS, not the file".to_owned());
        }
        let name = self.name(path);
        let found = match mesh::read(&name, &bytes) {
            Ok(file) if self.models.turns_meshes() => Some(Arc::new(file.upright())),
            Ok(file) => {
                match file.up_axis {
                    UpAxis::X => self.notes.add(&Kind::UpAxis('x'), &name, None),
                    UpAxis::Y => self.notes.add(&Kind::UpAxis('y'), &name, None),
                    UpAxis::Z => {}
                }
                Some(Arc::new(file))
            }
            Err(faults) => {
                self.faults.extend(faults);
                None
            }
        };
        self.files.insert(path.clone(), found.clone());
        Ok(found)
    }
}

/// Returns the part of `file` that `submesh` wants; none where it has no such part.
fn part(file: &MeshFile, submesh: &Submesh) -> Option<Mesh> {
    let Some((wanted, centred)) = submesh else {
        return Some(Mesh::new(file.parts.iter().flat_map(|p| p.triangles.clone()).collect()));
    };
    let named = file.parts.iter().filter(|part| part.names.iter().any(|name| name == wanted));
    let mut triangles: Vec<_> = named.flat_map(|part| part.triangles.clone()).collect();
    if triangles.is_empty() {
        return None;
    }
    if *centred {
        for axis in 0..3 {
            let along = triangles.as_flattened().iter().map(|corner| corner[axis]);
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            let middle = f64::midpoint(low, high);
            triangles.as_flattened_mut().iter_mut().for_each(|corner| corner[axis] -= middle);
        }
    }
    Some(Mesh::new(triangles))
}
