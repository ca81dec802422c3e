//! Meshes in all three formats, told by the first byte.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::geometry::Placement;
use reenact::world::Body;
use reenact::world::mesh::section::Standing;
use reenact::world::mesh::{self, Mesh};

fuzz_target!(|data: &[u8]| {
    let Some((kind, bytes)) = data.split_first() else { return };
    let name = ["a.stl", "a.obj", "a.dae"][usize::from(kind % 3)];
    if let Ok(file) = mesh::read(name, bytes) {
        let triangles = file.upright().parts.into_iter().flat_map(|part| part.triangles).collect();
        let standing = Standing { placement: Placement::IDENTITY, scale: [1.0; 3] };
        let body = Body::Mesh { mesh: Mesh::new(triangles), standing };
        body.slice(0.16);
        body.shadow(0.0, 0.5);
    }
});
