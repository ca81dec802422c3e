//! Where a world's meshes come from. Nothing is fetched: whoever reads the world says what a URI stands for.

use crate::document::Diagnostic;
use crate::world::Solid;
use crate::world::mesh::Part;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What stands for a URI.
#[derive(Debug, Clone)]
pub enum Found {
    /// A mesh file: its parts, or every fault of it.
    Mesh(Arc<Result<Vec<Part>, Vec<Diagnostic>>>),
    /// Solids in its place: upright, in the frame of the collision that names the mesh (m).
    StandIn(Arc<[Solid]>),
    /// Nothing, and why, to end a sentence (`no folder is given for models`).
    Missing(String),
}

/// Who knows what a mesh's URI stands for.
pub trait Models {
    /// Returns what `uri` stands for.
    fn find(&mut self, uri: &str) -> Found;
}

/// Where the file that a URI names lies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeshPath {
    /// In the folder of a model: that folder and the way from there.
    Model(String),
    /// By a path from the folder of the world's file.
    Beside(String),
}

/// Why the file that a URI names lies nowhere: the end of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unplaced {
    /// It is elsewhere, or no folder of models is given at all: there is nothing to say.
    #[error("")]
    Untold,
    /// It leads out of its folder.
    #[error("its path leads out of the folder")]
    LeadsOut,
    /// It begins at the root of a file system.
    #[error("a path from the root of some machine is not followed")]
    FromRoot,
    /// Of its model no folder is given.
    #[error("no folder is given for the model `{0}`")]
    NoFolder(String),
}

/// Returns where the file `uri` lies, when `folders` are those of the models: `NAME` of `model://NAME/mesh.dae` to its folder.
///
/// # Errors
/// Why it lies nowhere.
pub fn mesh_path(uri: &str, folders: &BTreeMap<String, String>) -> Result<MeshPath, Unplaced> {
    let model = uri.strip_prefix("model://");
    let path = model.or_else(|| uri.strip_prefix("file://")).unwrap_or(uri);
    if path.contains("://") || path.is_empty() {
        return Err(Unplaced::Untold);
    }
    if path.split(['/', '\\']).any(|step| step == "..") {
        return Err(Unplaced::LeadsOut);
    }
    if model.is_none() {
        if path.starts_with('/') {
            return Err(Unplaced::FromRoot);
        }
        return Ok(MeshPath::Beside(path.to_owned()));
    }
    if folders.is_empty() {
        return Err(Unplaced::Untold);
    }
    let path = path.trim_start_matches('/');
    let (name, rest) = path.split_once('/').unwrap_or((path, ""));
    match folders.get(name) {
        Some(folder) => Ok(MeshPath::Model(format!("{folder}/{rest}"))),
        None => Err(Unplaced::NoFolder(name.to_owned())),
    }
}

/// No mesh is at hand.
#[derive(Debug, Clone, Copy)]
pub struct NoModels;

impl Models for NoModels {
    fn find(&mut self, _: &str) -> Found {
        Found::Missing(String::new())
    }
}
