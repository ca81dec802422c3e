//! The robots of a manifest's conditions: a file, what it names, and what the manifest says besides. Every file that is read
//! for it is sealed like any input.

use super::document::{RobotDoc, RobotFile};
use super::input::{InputKind, WrittenIn};
use super::library::{Known, Library, Unread, joined, normalised};
use super::resolver::Resolver;
use crate::document::Source;
use crate::robot::description::{self, Request};
use crate::robot::{FilePath, Files, Robot, Rooted, Unfound};
use crate::world::mesh;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The files that a robot names, from the library of the manifest.
struct Shelf<'r, 'a> {
    library: &'r mut Library<'a>,
    /// Name of the manifest, which paths are shown beside.
    folder: &'r str,
    /// What the robot's own path is relative to, and what those of packages are.
    written_in: [WrittenIn; 2],
    /// Files that are not the ones that are pinned, in words.
    unpinned: Vec<String>,
}

impl Shelf<'_, '_> {
    fn bytes(&mut self, file: &FilePath) -> Result<(String, Arc<[u8]>), Unfound> {
        let path = normalised(&file.path);
        let written_in = self.written_in(file);
        let bytes = match self.library.read(&path, written_in, InputKind::Robot) {
            Ok(bytes) => bytes,
            Err(Unread::Unpinned { bytes, digests, .. }) => {
                self.unpinned.push(format!("`{path}` is not the file that is pinned: {digests}"));
                bytes
            }
            Err(Unread::Missing { reason, published }) => {
                self.unpinned
                    .extend(published.map(|published| {
                        format!("cannot read `{path}`, published as {published}")
                    }));
                return Err(Unfound(reason.to_string()));
            }
        };
        Ok((path, bytes))
    }

    fn written_in(&self, file: &FilePath) -> WrittenIn {
        match file.rooted {
            Rooted::Robot => self.written_in[0],
            Rooted::Packages => self.written_in[1],
        }
    }
}

impl Files for Shelf<'_, '_> {
    fn text(&mut self, file: &FilePath) -> Result<Source, Unfound> {
        let (path, bytes) = self.bytes(file)?;
        let Ok(text) = std::str::from_utf8(&bytes) else {
            return Err(Unfound("it is not UTF-8 text".to_owned()));
        };
        let name = match self.written_in(file) {
            WrittenIn::Manifest => joined(self.folder, &path),
            _ => path,
        };
        Ok(Source::new(name, text))
    }

    fn follows(&mut self, file: &FilePath) -> bool {
        self.library.files.follows(&normalised(&file.path), self.written_in(file))
    }

    fn corners(&mut self, file: &FilePath) -> Result<Vec<[f64; 3]>, Unfound> {
        let (path, bytes) = self.bytes(file)?;
        match mesh::read(&path, &bytes) {
            Ok(mesh) => {
                let triangles = mesh.parts.iter().flat_map(|part| &part.triangles);
                Ok(triangles.flatten().copied().collect())
            }
            Err(faults) => Err(Unfound(
                faults.into_iter().next().map_or_else(String::new, |fault| fault.message),
            )),
        }
    }
}

impl Resolver<'_> {
    /// Returns the robot that `doc`, written at `pointer`, is.
    pub(super) fn robot(&mut self, doc: &RobotDoc, pointer: &str) -> Known<Robot> {
        let (file, file_pointer) = match doc {
            RobotDoc::Path(path) => (RobotFile::plain(path), pointer.to_owned()),
            RobotDoc::File(file) => (RobotFile::clone(file), format!("{pointer}/file")),
        };
        let written_in = ["file", "gazebo", "packages"]
            .map(|key| self.faults.written_in(&format!("{pointer}/{key}")));
        let key = json!([file, written_in, self.faults.written_in(&file_pointer)]).to_string();
        self.once(
            |library| &mut library.robots,
            key,
            |this| this.read_robot(&file, pointer, &file_pointer),
        )
    }

    fn read_robot(&mut self, doc: &RobotFile, pointer: &str, file_pointer: &str) -> Known<Robot> {
        let source = self.text(&doc.file, file_pointer, InputKind::Robot)?;
        let own = FilePath { path: normalised(&doc.file), rooted: Rooted::Robot };
        let mut gazebo = Vec::new();
        for (i, path) in doc.gazebo.iter().enumerate() {
            let added = self.text(path, &format!("{pointer}/gazebo/{i}"), InputKind::Robot);
            let path = FilePath { path: normalised(path), rooted: Rooted::Robot };
            gazebo.extend(added.map(|added| (path, added)));
        }
        if gazebo.len() < doc.gazebo.len() {
            return None;
        }
        let arguments: BTreeMap<String, String> =
            doc.arguments.iter().map(|(name, value)| (name.clone(), value.0.clone())).collect();
        let tree = self.faults.tree;
        let fault = |key: &str, message: &str| {
            let place = tree.place(&format!("{pointer}{key}"));
            tree.fault(place, message)
        };
        let request = Request {
            path: own,
            gazebo,
            packages: &doc.packages,
            arguments: &arguments,
            given: &doc.given(),
            fault: &fault,
        };
        let folders = self.faults.written_in(&format!("{pointer}/packages"));
        let mut shelf = Shelf {
            folder: self.folder,
            written_in: [self.faults.written_in(file_pointer), folders],
            library: &mut self.library,
            unpinned: Vec::new(),
        };
        let read = description::read(&source, &request, &mut shelf);
        for problem in shelf.unpinned {
            self.faults.at(file_pointer, problem, "named by this robot");
        }
        let (robot, warnings) = self.told(read)?;
        self.faults.extend(warnings);
        let meaning = robot.meaning();
        Some((Arc::new(robot), meaning))
    }
}
