//! `<mesh>`: a file or what stands for it, where the collision is.

use super::{Found, Models};
use crate::document::xml::{self, Faults};
use crate::geometry::{Outline, Placement, Pose};
use crate::world::mesh::section::Standing;
use crate::world::mesh::{Mesh, Part, Triangle};
use crate::world::{Body, Solid};
use roxmltree::Node;

/// Returns the bodies of a `<mesh>` of the collision `name`, lengths multiplied by its own `<scale>` and by `scale`.
pub(super) fn read(
    shape: Node<'_, '_>,
    name: &str,
    placement: Placement,
    scale: [f64; 3],
    models: &mut dyn Models,
    faults: &mut Faults<'_>,
) -> Vec<Body> {
    let uri = xml::child(shape, "uri").map_or("", xml::text);
    let missing = |why: &str| match why {
        "" => format!("collision `{name}` is a mesh `{uri}`, which cannot be read: it is missing"),
        why => format!("collision `{name}` is a mesh `{uri}`; {why}: it is missing"),
    };
    match models.find(uri) {
        Found::Missing(why) => {
            let fault = faults.at(shape, missing(&why)).warning();
            faults.push(fault);
            Vec::new()
        }
        Found::StandIn(solids) => stand_in(shape, &solids, &placement, faults),
        Found::Mesh(file) => match &*file {
            Err(problems) => {
                // The faults of a file that many collisions name are collected once.
                for problem in problems {
                    if !faults.kept().contains(problem) {
                        faults.push(problem.clone());
                    }
                }
                Vec::new()
            }
            Ok(parts) => of_parts(shape, parts, placement, scale, faults).into_iter().collect(),
        },
    }
}

fn of_parts(
    shape: Node<'_, '_>,
    parts: &[Part],
    placement: Placement,
    scale: [f64; 3],
    faults: &mut Faults<'_>,
) -> Option<Body> {
    let own = match xml::child(shape, "scale") {
        None => [1.0; 3],
        Some(node) => {
            let own = faults.numbers::<3>(node)?;
            if !own.iter().all(|factor| *factor > 0.0 && *factor <= 1e6) {
                let fault = faults.at(node, "scale out of range");
                faults.push(fault.label("expected three factors above zero"));
                return None;
            }
            own
        }
    };
    let mut triangles: Vec<Triangle> = Vec::new();
    match xml::child(shape, "submesh") {
        None => triangles.extend(parts.iter().flat_map(|part| &part.triangles)),
        Some(submesh) => {
            let wanted = xml::child(submesh, "name").map_or("", xml::text);
            let named = |part: &&Part| part.names.iter().any(|name| name == wanted);
            triangles.extend(parts.iter().filter(named).flat_map(|part| &part.triangles));
            if triangles.is_empty() {
                let known: Vec<&str> =
                    parts.iter().filter_map(|p| p.names.first()).map(String::as_str).collect();
                let fault = faults.at(submesh, format!("the mesh has no part `{wanted}`"));
                faults.push(fault.label(format!("its parts are {}", known.join(", "))));
                return None;
            }
            if xml::child(submesh, "center").is_some_and(|n| matches!(xml::text(n), "1" | "true")) {
                center(&mut triangles);
            }
        }
    }
    let scale = [own[0] * scale[0], own[1] * scale[1], own[2] * scale[2]];
    Some(Body::Mesh { mesh: Mesh::new(triangles), standing: Standing { placement, scale } })
}

/// Moves the middle of the box around `triangles` to the origin.
fn center(triangles: &mut [Triangle]) {
    for axis in 0..3 {
        let along = triangles.as_flattened().iter().map(|corner| corner[axis]);
        let (low, high) =
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let middle = f64::midpoint(low, high);
        triangles.as_flattened_mut().iter_mut().for_each(|corner| corner[axis] -= middle);
    }
}

/// How far (cosine) a stand-in's frame may lean: a degree.
const UPRIGHT: f64 = 0.9998;

/// Returns the stand-in `solids` where `placement` is.
fn stand_in(
    shape: Node<'_, '_>,
    solids: &[Solid],
    placement: &Placement,
    faults: &mut Faults<'_>,
) -> Vec<Body> {
    if placement.rotation[2][2] < UPRIGHT {
        let fault = faults.at(shape, "what stands in for this mesh would lean");
        faults.push(fault.label("expected an upright pose: stand-ins are upright"));
        return Vec::new();
    }
    let [x, y, up] = placement.translation;
    let frame = Pose::new(x, y, placement.yaw());
    let place = |solid: &Solid| match &solid.body {
        Body::Prism { outline, z } => {
            let outline = match outline {
                Outline::Circle { center, radius } => {
                    Outline::Circle { center: frame.transform(*center), radius: *radius }
                }
                Outline::Polygon(corners) => {
                    Outline::Polygon(corners.iter().map(|c| frame.transform(*c)).collect())
                }
            };
            Body::Prism { outline, z: [z[0] + up, z[1] + up] }
        }
        other => other.clone(),
    };
    solids.iter().map(place).collect()
}
