//! Triangle meshes: STL, OBJ and COLLADA files, and what a plane or a slab of heights cuts of them.
//!
//! A mesh is a surface, not a solid: files rarely close it. So its sections are lines, drawn [`section::THICKNESS`] thick.

mod collada;
mod files;
pub mod section;

use crate::digest::{Hasher, MeaningDigest};
use crate::document::Diagnostic;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Longest file read (bytes).
pub const MAX_BYTES: usize = 64 << 20;

/// Most triangles of one file, instances counted.
pub const MAX_TRIANGLES: usize = 1 << 20;

/// Largest coordinate (m).
const MAX_DISTANCE: f64 = 1e5;

/// Three corners (m).
pub type Triangle = [[f64; 3]; 3];

/// A named part of a file: what SDF calls a submesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The names that it goes by: its node's and its geometry's in COLLADA, its group's in OBJ.
    pub names: Vec<String>,
    /// Its triangles, in the file's own axes (m).
    pub triangles: Vec<Triangle>,
}

/// The axis that a file says is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// x.
    X,
    /// y.
    Y,
    /// z, or none is named.
    Z,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// Its parts, in the axes in which they are written: Gazebo takes z for up, whatever the file says.
    pub parts: Vec<Part>,
    /// The axis that the file says is up.
    pub up_axis: UpAxis,
}

impl MeshFile {
    /// Turns the parts so that the axis that the file says is up becomes z.
    #[must_use]
    pub fn upright(mut self) -> Self {
        for corner in self.parts.iter_mut().flat_map(|p| p.triangles.as_flattened_mut()) {
            let [x, y, z] = *corner;
            *corner = match self.up_axis {
                UpAxis::X => [-y, -z, x],
                UpAxis::Y => [x, -z, y],
                UpAxis::Z => [x, y, z],
            };
        }
        self.up_axis = UpAxis::Z;
        self
    }
}

/// Triangles in a frame of their own (m).
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    triangles: Arc<[Triangle]>,
    meaning: MeaningDigest,
}

impl Mesh {
    /// Creates a mesh of `triangles`, whose corners are finite.
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let mut hasher = Hasher::new();
        hasher.update(b"reenact-mesh-1\0");
        for number in triangles.as_flattened().as_flattened() {
            // Both zeros are one.
            hasher.update((number + 0.0).to_bits().to_le_bytes());
        }
        Self { meaning: MeaningDigest(hasher.digest()), triangles: triangles.into() }
    }

    /// Returns its triangles (m).
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }
}

impl Serialize for Mesh {
    /// Writes the digest of what it holds: meshes are large.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.meaning.serialize(serializer)
    }
}

/// Why a file is no mesh of ours: the end of a sentence.
#[derive(Debug, thiserror::Error)]
enum MeshError {
    #[error(transparent)]
    Unread(#[from] std::io::Error),
    #[error("it announces {announced} triangles and holds {found}")]
    Announced { announced: u64, found: usize },
    #[error("a face has the corner {index}, of {corners} corners")]
    NoCorner { index: u32, corners: usize },
    #[error("expected .stl, .obj or .dae, found `.{0}`")]
    Ending(String),
    #[error("expected coordinates within {MAX_DISTANCE} m of the origin, found {0}")]
    Far(f64),
    #[error("it has no triangle")]
    Empty,
    #[error("expected at most {MAX_TRIANGLES} triangles, found {0}")]
    TooMany(usize),
}

/// Reads the file `name`, whose ending says its format: `.stl`, `.obj` or `.dae`.
///
/// # Errors
/// Every fault found, with its line where the format has lines.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<Diagnostic>> {
    let refuse = |problem: String| Err(vec![Diagnostic::placeless(problem)]);
    if bytes.len() > MAX_BYTES {
        let found = bytes.len();
        return refuse(format!(
            "`{name}` is too large: expected at most {MAX_BYTES} bytes, found {found}"
        ));
    }
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    let read = match ending.as_str() {
        "stl" => files::stl(bytes),
        "obj" => files::obj(bytes),
        "dae" => return collada::read(name, bytes),
        other => Err(MeshError::Ending(other.to_owned())),
    };
    match read.and_then(|parts| checked(parts.iter()).map(|()| parts)) {
        Ok(parts) => Ok(MeshFile { parts, up_axis: UpAxis::Z }),
        Err(problem) => refuse(format!("cannot read the mesh `{name}`: {problem}")),
    }
}

/// Checks that `parts` are a mesh of ours, or returns what is wrong with them.
fn checked<'p>(parts: impl Iterator<Item = &'p Part>) -> Result<(), MeshError> {
    let mut count = 0;
    for part in parts {
        count += part.triangles.len();
        let corners = part.triangles.iter().flatten().flatten();
        if let Some(wrong) = corners.copied().find(|c| !c.is_finite() || c.abs() > MAX_DISTANCE) {
            return Err(MeshError::Far(wrong));
        }
    }
    match count {
        0 => Err(MeshError::Empty),
        1..=MAX_TRIANGLES => Ok(()),
        _ => Err(MeshError::TooMany(count)),
    }
}

#[cfg(test)]
mod tests;
