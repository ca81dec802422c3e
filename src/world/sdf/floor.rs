//! What of a world is floor: a robot stands on it, no lidar and no body meets it.

use super::notes::{Kind, Notes};
use crate::geometry::Bounds;
use crate::world::mesh::section::Standing;
use crate::world::mesh::{Mesh, Triangle};
use crate::world::{Body, Solid};

/// What ends at most so high (m) above the ground, wheels roll over: carpets, sills, cables.
pub const ROLLED_OVER: f64 = 0.02;

/// What ends at most so high (m) above the ground and is [`WIDE`] is stood upon.
pub const STEP: f64 = 0.06;

/// How wide (m), both ways, a floor is: much wider than a robot.
pub const WIDE: f64 = 2.0;

/// Takes the floors from `solids`, of meshes their flat parts, and notes the ones that are no planes.
pub(super) fn take(solids: &mut Vec<Solid>, notes: &mut Notes) {
    solids.retain_mut(|solid| {
        let [_, high] = solid.body.heights();
        let is_floor = high <= ROLLED_OVER || (high <= STEP && is_wide(&solid.body));
        if is_floor {
            if high > THIN {
                notes.add(&Kind::Floor, &solid.name, None);
            }
            return false;
        }
        if let Body::Mesh { mesh, standing } = &mut solid.body {
            without_floor(mesh, standing);
        }
        true
    });
}

/// What ends no higher (m) than this is the ground itself, of which nothing need be told.
const THIN: f64 = 0.001;

fn is_wide(body: &Body) -> bool {
    let shadow = body.shadow(f64::NEG_INFINITY, f64::INFINITY);
    let bounds = shadow.iter().fold(Bounds::EMPTY, |b, o| b.union(o.bounds()));
    bounds.width().min(bounds.height()) >= WIDE
}

/// Takes from a mesh that is a floor with walls on it the triangles of the floor: those that wholly lie where wheels roll,
/// and the flat ones within a step of the ground where the mesh is wide.
fn without_floor(mesh: &mut Mesh, standing: &Standing) {
    let placed: Vec<Triangle> = standing.triangles(mesh).collect();
    let bounds = |axis: usize| {
        let along = placed.as_flattened().iter().map(move |corner| corner[axis]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
    };
    let [x, y, z] = [bounds(0), bounds(1), bounds(2)];
    if z[0] > STEP {
        return;
    }
    let wide = (x[1] - x[0]).min(y[1] - y[0]) >= WIDE;
    let kept = |placed: &Triangle| {
        let high = placed.iter().map(|c| c[2]).fold(f64::NEG_INFINITY, f64::max);
        let low = placed.iter().map(|c| c[2]).fold(f64::INFINITY, f64::min);
        !(high <= ROLLED_OVER || (wide && high <= STEP && high - low <= THIN))
    };
    if placed.iter().all(kept) {
        return;
    }
    let own = mesh.triangles().iter().zip(&placed);
    *mesh = Mesh::new(own.filter(|(_, placed)| kept(placed)).map(|(own, _)| *own).collect());
}
