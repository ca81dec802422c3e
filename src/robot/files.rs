//! The files that a description names besides itself: meshes, and what a xacro file includes.
//!
//! Nothing is looked for: a path leads from the file that names it, or from the folder of a package that whoever reads the
//! robot says; never from the root of some machine, and never above the folders that they name.

use crate::document::Source;
use std::collections::BTreeMap;

/// What a path is relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rooted {
    /// To whatever the path of the robot's own file is relative to.
    Robot,
    /// To whatever the folders of packages are relative to.
    Packages,
}

/// Where a file lies.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct FilePath {
    /// The path, with forward slashes.
    pub path: String,
    /// What it is relative to.
    pub rooted: Rooted,
}

/// Why a file cannot be had: the end of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unfound(pub String);

/// Who hands over files.
pub trait Files {
    /// Returns the text of `file`, under the name that people know it by.
    ///
    /// # Errors
    /// Why there is none.
    fn text(&mut self, file: &FilePath) -> Result<Source, Unfound>;

    /// Returns the corners (m) of the mesh in `file`, as its file has them.
    ///
    /// # Errors
    /// Why there are none.
    fn corners(&mut self, file: &FilePath) -> Result<Vec<[f64; 3]>, Unfound>;

    /// Returns whether `file` is read though it lies outside the folders that whoever reads the robot names.
    fn follows(&mut self, file: &FilePath) -> bool {
        let _ = file;
        false
    }
}

/// No file is at hand but the robot's own.
#[derive(Debug, Clone, Copy)]
pub struct NoFiles;

impl Files for NoFiles {
    fn text(&mut self, _: &FilePath) -> Result<Source, Unfound> {
        Err(Unfound("no other file is read here".to_owned()))
    }

    fn corners(&mut self, file: &FilePath) -> Result<Vec<[f64; 3]>, Unfound> {
        self.text(file).map(|_| Vec::new())
    }
}

/// Why a file lies nowhere: the end of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum Unplaced {
    #[error("no folder is given for the package `{0}`")]
    NoFolder(String),
    #[error(
        "its path leads out of the folders that the manifest names, where none of `--allow FOLDER` is"
    )]
    LeadsOut,
    #[error("a path from the root of some machine is not followed without `--allow FOLDER`")]
    FromRoot,
    #[error("nothing is fetched by `{0}://`")]
    Scheme(String),
}

impl Unplaced {
    /// Returns the package that is missed, where one is.
    pub(super) fn package(&self) -> Option<&str> {
        match self {
            Self::NoFolder(name) => Some(name),
            _ => None,
        }
    }
}

/// Where the files that a description names lie.
#[derive(Debug, Clone)]
pub(super) struct Places<'a> {
    /// The robot's own file.
    pub(super) own: FilePath,
    /// Packages by name, and their folders.
    pub(super) packages: &'a BTreeMap<String, String>,
}

impl Places<'_> {
    /// Returns the folder of the package `name`: the given one, or the one of that name in which the robot's own file lies.
    fn folder(&self, name: &str) -> Result<FilePath, Unplaced> {
        if let Some(folder) = self.packages.get(name) {
            let path = folder.trim_end_matches('/').to_owned();
            return Ok(FilePath { path, rooted: Rooted::Packages });
        }
        let folders = self.own.path.match_indices('/').map(|(at, _)| &self.own.path[..at]);
        folders
            .rev()
            .find(|folder| folder.rsplit('/').next() == Some(name))
            .map(|folder| FilePath { path: folder.to_owned(), rooted: self.own.rooted })
            .ok_or_else(|| Unplaced::NoFolder(name.to_owned()))
    }

    /// Returns where the file lies that `beside` names by `uri`. Outside the folders that are named only what `files` follow is
    /// found.
    pub(super) fn find(
        &self,
        uri: &str,
        beside: &FilePath,
        files: &mut dyn Files,
    ) -> Result<FilePath, Unplaced> {
        let mut outside = |path: String, rooted, why| {
            let file = FilePath { path, rooted };
            if files.follows(&file) { Ok(file) } else { Err(why) }
        };
        let uri = uri.trim();
        let bare = uri.strip_prefix("file://").unwrap_or(uri);
        let package = bare.strip_prefix("package://").or_else(|| bare.strip_prefix("model://"));
        if let Some(path) = package {
            let (name, rest) = path.split_once('/').unwrap_or((path, ""));
            let folder = self.folder(name)?;
            let path = format!("{}/{rest}", folder.path);
            if climbs(rest, 0) {
                return outside(path, folder.rooted, Unplaced::LeadsOut);
            }
            return Ok(FilePath { path, rooted: folder.rooted });
        }
        if let Some((scheme, _)) = bare.split_once("://") {
            return Err(Unplaced::Scheme(scheme.to_owned()));
        }
        if bare.starts_with('/') {
            return outside(bare.to_owned(), beside.rooted, Unplaced::FromRoot);
        }
        let folder = beside.path.rsplit_once('/').map_or("", |(folder, _)| folder);
        let named = folder.split('/').filter(|step| !matches!(*step, "" | "." | "..")).count();
        // A path from the root of a file system names all folders of a machine: only a package beside the file's own is meant.
        let named = if folder.starts_with('/') { named.min(2) } else { named };
        let path = if folder.is_empty() { bare.to_owned() } else { format!("{folder}/{bare}") };
        if climbs(bare, named) {
            return outside(path, beside.rooted, Unplaced::LeadsOut);
        }
        Ok(FilePath { path, rooted: beside.rooted })
    }
}

/// Returns whether `path` leads above a folder that lies `depth` folders down.
fn climbs(path: &str, mut depth: usize) -> bool {
    for step in path.split(['/', '\\']) {
        match step {
            "" | "." => {}
            ".." if depth == 0 => return true,
            ".." => depth -= 1,
            _ => depth += 1,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_lie_beside_the_robot_or_in_packages_and_never_above() {
        let packages = BTreeMap::from([("arm".to_owned(), "../ros/arm/".to_owned())]);
        let own = FilePath { path: "../ros/husky/urdf/h.xacro".to_owned(), rooted: Rooted::Robot };
        let places = Places { own: own.clone(), packages: &packages };
        let found =
            |uri: &str| places.find(uri, &own, &mut NoFiles).map(|file| (file.path, file.rooted));
        let robot = |path: &str| Ok((path.to_owned(), Rooted::Robot));
        assert_eq!(found("wheel.xacro"), robot("../ros/husky/urdf/wheel.xacro"));
        assert_eq!(found("../meshes/a.stl"), robot("../ros/husky/urdf/../meshes/a.stl"));
        assert_eq!(found("package://husky/meshes/a.stl"), robot("../ros/husky/meshes/a.stl"));
        assert_eq!(
            found("file://package://arm/a.stl"),
            Ok(("../ros/arm/a.stl".to_owned(), Rooted::Packages))
        );
        assert_eq!(found("../../../../secret"), Err(Unplaced::LeadsOut));
        assert_eq!(found("package://arm/../x"), Err(Unplaced::LeadsOut));
        assert_eq!(found("file:///etc/passwd"), Err(Unplaced::FromRoot));
        assert_eq!(found("https://a/b"), Err(Unplaced::Scheme("https".to_owned())));
        assert_eq!(found("package://leg/a"), Err(Unplaced::NoFolder("leg".to_owned())));
    }

    /// Files of which those below `/opt/ros` are allowed.
    struct OptRos;

    impl Files for OptRos {
        fn text(&mut self, file: &FilePath) -> Result<Source, Unfound> {
            NoFiles.text(file)
        }

        fn corners(&mut self, file: &FilePath) -> Result<Vec<[f64; 3]>, Unfound> {
            NoFiles.corners(file)
        }

        fn follows(&mut self, file: &FilePath) -> bool {
            file.path.starts_with("/opt/ros/")
        }
    }

    #[test]
    fn what_is_allowed_is_followed_and_nothing_else() {
        let packages = BTreeMap::from([("arm".to_owned(), "/opt/ros/arm".to_owned())]);
        let own = FilePath { path: "h.urdf".to_owned(), rooted: Rooted::Robot };
        let places = Places { own: own.clone(), packages: &packages };
        let found = |uri: &str| places.find(uri, &own, &mut OptRos).map(|file| file.path);
        assert_eq!(found("file:///opt/ros/b/a.stl"), Ok("/opt/ros/b/a.stl".to_owned()));
        assert_eq!(found("package://arm/../b/a.stl"), Ok("/opt/ros/arm/../b/a.stl".to_owned()));
        assert_eq!(found("/etc/passwd"), Err(Unplaced::FromRoot));
        assert_eq!(found("../a.stl"), Err(Unplaced::LeadsOut));
        let own = FilePath { path: "/opt/ros/arm/urdf/h.urdf".to_owned(), rooted: Rooted::Robot };
        let found = |uri: &str| places.find(uri, &own, &mut OptRos).map(|file| file.path);
        assert!(found("../../leg/a.stl").is_ok());
        assert!(found("../../../leg/a.stl").is_ok(), "allowed as it is written");
        let found = |uri: &str| places.find(uri, &own, &mut NoFiles).map(|file| file.path);
        assert!(found("../../leg/a.stl").is_ok());
        assert_eq!(found("../../../leg/a.stl"), Err(Unplaced::LeadsOut));
    }
}
