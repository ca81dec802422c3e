//! Where the files of a world's models lie. Nothing is fetched: whoever reads the world hands over their bytes.

use crate::world::Solid;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the path of a file begins at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Root {
    /// The folder of the world's file.
    World,
    /// Where the folders of `models` are relative to.
    Models,
    /// Where the folders of `model-path` are relative to.
    ModelPath,
}

/// The path of a file, with forward slashes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct FilePath {
    /// What it begins at.
    pub root: Root,
    /// The way from there; empty of the world's file itself.
    pub path: String,
}

impl FilePath {
    /// The world's file.
    pub const WORLD: Self = Self { root: Root::World, path: String::new() };

    /// Returns the file `path` in the folder of this file.
    fn beside(&self, path: &str) -> Self {
        let path = match self.path.rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/{path}"),
            None => path.to_owned(),
        };
        Self { root: self.root, path }
    }

    /// Returns the file `path` in this folder.
    pub(super) fn within(&self, path: &str) -> Self {
        let path =
            if path.is_empty() { self.path.clone() } else { format!("{}/{path}", self.path) };
        Self { root: self.root, path }
    }
}

/// Who knows the files of a world's models, and which models are wanted.
pub trait Models {
    /// Returns the folders of models.
    fn folders(&self) -> Folders {
        Folders::default()
    }

    /// Returns the bytes of a file.
    ///
    /// # Errors
    /// Why there are none, to end a sentence: `no such file`.
    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String>;

    /// Returns what messages call a file.
    fn name(&self, path: &FilePath) -> String {
        path.path.clone()
    }

    /// Returns whether the file at `path` is read though it lies outside the folders that whoever reads the world names.
    fn follows(&mut self, path: &FilePath) -> bool {
        let _ = path;
        false
    }

    /// Returns the solids that stand for the mesh `uri`, as the world writes it: upright, in the frame of the collision
    /// that names the mesh (m).
    fn stand_in(&mut self, uri: &str) -> Option<Arc<[Solid]>> {
        let _ = uri;
        None
    }

    /// Returns whether the model `name` stands in the world: `table`, or `table/lamp` of one within another. Each is asked
    /// for.
    fn wanted(&mut self, name: &str) -> bool {
        let _ = name;
        true
    }

    /// Returns whether meshes are turned so that the axis that their file says is up becomes z. Gazebo turns none.
    fn turns_meshes(&self) -> bool {
        false
    }
}

/// No file is at hand.
#[derive(Debug, Clone, Copy)]
pub struct NoModels;

impl Models for NoModels {
    fn read(&mut self, _: &FilePath) -> Result<Arc<[u8]>, String> {
        Err("no such file".to_owned())
    }
}

/// The folders in which models are looked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Folders {
    /// Of models by name: `NAME` of `model://NAME/mesh.dae`.
    pub models: BTreeMap<String, String>,
    /// Folders that hold folders of models, searched in this order after those.
    pub path: Vec<String>,
}

/// Why the file that a URI names lies nowhere: the end of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unplaced {
    /// It is elsewhere, or no folder of models is given at all: there is nothing to say.
    #[error("")]
    Untold,
    /// It leads out of its folder.
    #[error("its path leads out of the folder, where none of `--allow FOLDER` is")]
    LeadsOut,
    /// It begins at the root of a file system.
    #[error("a path from the root of some machine is not followed without `--allow FOLDER`")]
    FromRoot,
    /// Of its model no folder is given.
    #[error("no folder is given for the model `{0}`")]
    NoFolder(String),
}

/// A URI taken apart.
#[derive(Debug, PartialEq, Eq)]
enum Parted<'u> {
    /// A model by name, and the way from its folder.
    Model { name: String, rest: &'u str },
    /// A path.
    Path(&'u str),
}

fn part(uri: &str) -> Result<Parted<'_>, Unplaced> {
    let model = uri.strip_prefix("model://").or_else(|| uri.strip_prefix("package://"));
    if let Some(path) = model {
        let path = path.trim_start_matches('/');
        let (name, rest) = path.split_once('/').unwrap_or((path, ""));
        return Ok(Parted::Model { name: name.to_owned(), rest });
    }
    let path = uri.strip_prefix("file://").unwrap_or(uri);
    if path.is_empty() {
        return Err(Unplaced::Untold);
    }
    let Some((_, address)) = path.split_once("://") else { return Ok(Parted::Path(path)) };
    // https://fuel.gazebosim.org/1.0/OWNER/models/NAME, with a version and a file behind it or not.
    let (_, model) = address.split_once("/models/").ok_or(Unplaced::Untold)?;
    let (name, rest) = model.split_once('/').unwrap_or((model, ""));
    let (version, file) = rest.split_once('/').unwrap_or((rest, ""));
    let is_version = version == "tip" || version.bytes().all(|b| b.is_ascii_digit());
    let rest = if is_version { file } else { rest };
    let rest = rest.strip_prefix("files/").unwrap_or(rest);
    Ok(Parted::Model { name: name.replace("%20", " "), rest })
}

/// Returns the name of the model in whose folder `uri` lies: its first step where it is a path.
pub(super) fn model_name(uri: &str) -> String {
    match part(uri) {
        Ok(Parted::Model { name, .. }) => name,
        Ok(Parted::Path(path)) => path.split('/').next().unwrap_or_default().to_owned(),
        Err(_) => uri.rsplit('/').next().unwrap_or_default().to_owned(),
    }
}

/// Returns the last step of what `uri` names.
pub(super) fn last_name(uri: &str) -> String {
    match part(uri) {
        Ok(Parted::Model { name, rest: "" }) => name,
        Ok(Parted::Model { rest: path, .. } | Parted::Path(path)) => {
            path.trim_end_matches('/').rsplit('/').next().unwrap_or_default().to_owned()
        }
        Err(_) => uri.rsplit('/').next().unwrap_or_default().to_owned(),
    }
}

/// Returns how folders of the model `name` may be called: published names have capitals and blanks, folders often not.
fn spellings(name: &str) -> Vec<String> {
    let small = name.to_ascii_lowercase();
    let mut all = vec![name.to_owned(), small.clone(), small.replace(' ', "_")];
    all.dedup();
    all
}

impl Folders {
    /// Returns where the file that `uri` names may lie, the first place first; `beside` is the file in which that is
    /// written. Outside the folders that are named only what `models` follow is found.
    ///
    /// # Errors
    /// Why it lies nowhere.
    pub fn places(
        &self,
        uri: &str,
        beside: &FilePath,
        models: &mut dyn Models,
    ) -> Result<Vec<FilePath>, Unplaced> {
        let parted = part(uri)?;
        let mut outside = |place: FilePath, why| {
            if models.follows(&place) { Ok(vec![place]) } else { Err(why) }
        };
        let (Parted::Model { rest: path, .. } | Parted::Path(path)) = &parted;
        let mut steps = path.split(['/', '\\']);
        if steps.any(|step| step == "..") || uri.contains("://../") {
            return match &parted {
                Parted::Path(path) => outside(beside.beside(path), Unplaced::LeadsOut),
                Parted::Model { .. } => Err(Unplaced::LeadsOut),
            };
        }
        let mut places = Vec::new();
        let mut push = |place: FilePath| {
            if !places.contains(&place) {
                places.push(place);
            }
        };
        match &parted {
            Parted::Path(path) if path.starts_with('/') => {
                let place = FilePath { root: Root::World, path: (*path).to_owned() };
                return outside(place, Unplaced::FromRoot);
            }
            Parted::Path(path) => {
                push(beside.beside(path));
                push(FilePath::WORLD.beside(path));
                for folder in &self.path {
                    let folder = FilePath { root: Root::ModelPath, path: folder.clone() };
                    // `models/NAME` seen from the folder above `models`.
                    let own = folder.path.trim_end_matches('/').rsplit('/').next().unwrap_or("");
                    if let Some((first, rest)) = path.split_once('/')
                        && first == own
                    {
                        push(folder.within(rest));
                    }
                    push(folder.within(path));
                }
            }
            Parted::Model { name, .. } if matches!(name.as_str(), "" | "." | "..") => {
                return Err(Unplaced::LeadsOut);
            }
            Parted::Model { name, rest } => {
                for name in spellings(name) {
                    if let Some(folder) = self.models.get(&name) {
                        push(FilePath { root: Root::Models, path: folder.clone() }.within(rest));
                    }
                }
                for folder in &self.path {
                    let folder = FilePath { root: Root::ModelPath, path: folder.clone() };
                    for name in spellings(name) {
                        push(folder.within(&name).within(rest));
                    }
                }
                if places.is_empty() {
                    let none = self.models.is_empty();
                    return Err(if none {
                        Unplaced::Untold
                    } else {
                        Unplaced::NoFolder(name.clone())
                    });
                }
            }
        }
        Ok(places)
    }
}
