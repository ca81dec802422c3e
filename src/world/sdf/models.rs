//! Where a world's meshes come from. Nothing is fetched: whoever reads the world says what a URI stands for.

use crate::document::Diagnostic;
use crate::world::Solid;
use crate::world::mesh::Part;
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
    /// What `uri` stands for.
    fn find(&mut self, uri: &str) -> Found;
}

/// No mesh is at hand.
#[derive(Debug, Clone, Copy)]
pub struct NoModels;

impl Models for NoModels {
    fn find(&mut self, _: &str) -> Found {
        Found::Missing(String::new())
    }
}
