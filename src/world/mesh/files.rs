//! STL and OBJ: the one place that names the crate which reads them. Both hold metres, z up, as Gazebo takes them.

use super::{MeshError, Part};

/// Reads the triangles of an STL file, in text or binary.
///
/// # Errors
/// What is wrong with it.
pub(super) fn stl(bytes: &[u8]) -> Result<Vec<Part>, MeshError> {
    let scene = mesh_loader::stl::from_slice(bytes)?;
    let parts = parts(scene)?;
    let found: usize = parts.iter().map(|part| part.triangles.len()).sum();
    // A binary file announces its triangles; the reader takes what there is of them.
    if let (false, Some(announced)) =
        (bytes.trim_ascii_start().starts_with(b"solid"), bytes.get(80..84))
    {
        let announced = announced.iter().rev().fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
        if announced != found as u64 {
            return Err(MeshError::Announced { announced, found });
        }
    }
    Ok(parts)
}

/// Reads the triangles of an OBJ file. Its materials are of no concern here, and no other file is read.
///
/// # Errors
/// What is wrong with it.
pub(super) fn obj(bytes: &[u8]) -> Result<Vec<Part>, MeshError> {
    let nothing = |_: &std::path::Path| -> std::io::Result<Vec<u8>> {
        Err(std::io::ErrorKind::NotFound.into())
    };
    parts(mesh_loader::obj::from_slice(bytes, None, nothing)?)
}

fn parts(scene: mesh_loader::Scene) -> Result<Vec<Part>, MeshError> {
    let part = |mesh: mesh_loader::Mesh| {
        let corner = |index: u32| -> Result<[f64; 3], MeshError> {
            let found = usize::try_from(index).ok().and_then(|i| mesh.vertices.get(i));
            let corners = mesh.vertices.len();
            let [x, y, z] = *found.ok_or(MeshError::NoCorner { index, corners })?;
            Ok([f64::from(x), f64::from(y), f64::from(z)])
        };
        let triangle = |face: &[u32; 3]| -> Result<super::Triangle, MeshError> {
            Ok([corner(face[0])?, corner(face[1])?, corner(face[2])?])
        };
        let triangles = mesh.faces.iter().map(triangle).collect::<Result<_, MeshError>>()?;
        Ok(Part { names: vec![mesh.name.clone()], triangles })
    };
    scene.meshes.into_iter().map(part).collect()
}
