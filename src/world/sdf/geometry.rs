//! The shapes of collisions as they are described, before anything places or scales them.

use super::notes::Kind;
use super::reader::{File, Found, Reader};
use super::terrain::Extent;
use crate::document::quoted;
use crate::document::xml::{self, Faults};
use crate::world::Solid;
use crate::world::mesh::Mesh;
use roxmltree::Node;
use std::sync::Arc;

/// Largest extent (m) of one shape.
pub(super) const MAX_SIZE: f64 = 1e5;

/// A shape; lengths in metres.
#[derive(Debug)]
pub(super) enum Shape {
    /// Nothing solid, or a fault that has been told.
    Nothing,
    /// It is missing.
    Lack(Kind),
    Box([f64; 3]),
    Sphere(f64),
    Cylinder {
        radius: f64,
        length: f64,
    },
    Capsule {
        radius: f64,
        length: f64,
    },
    Cone {
        radius: f64,
        length: f64,
    },
    Ellipsoid([f64; 3]),
    Plane {
        normal: [f64; 3],
        size: [f64; 2],
    },
    Polyline {
        corners: Vec<[f64; 2]>,
        height: f64,
    },
    Mesh {
        mesh: Mesh,
        scale: [f64; 3],
    },
    StandIn(Arc<[Solid]>),
}

/// Returns the element that says the shape of a `<collision>`.
pub(super) fn shape_of<'a, 'i>(collision: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    xml::child(collision, "geometry").and_then(|geometry| xml::elements(geometry).next())
}

/// Reads the shape of a `<collision>`.
pub(super) fn read(
    collision: Node<'_, '_>,
    file: &File<'_>,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Shape {
    let Some(shape) = shape_of(collision) else { return Shape::Lack(Kind::NoShape) };
    let read = match shape.tag_name().name() {
        "empty" => Some(Shape::Nothing),
        "mesh" => mesh(shape, file, reader, faults),
        "heightmap" => heightmap(shape, file, reader, faults),
        kind => primitive(shape, kind, faults),
    };
    read.unwrap_or(Shape::Nothing)
}

fn primitive(shape: Node<'_, '_>, kind: &str, faults: &mut Faults<'_>) -> Option<Shape> {
    let round = |faults: &mut Faults<'_>| {
        let radius = faults.required(shape, "radius", "a radius in metres");
        let length = faults.required(shape, "length", "a length in metres");
        let (radius, length) = (radius?, length?);
        check(shape, &[radius, length], faults)?;
        Some((radius, length))
    };
    Some(match kind {
        "box" => {
            let size: [f64; 3] = required(shape, "size", "three lengths", faults)?;
            check(shape, &size, faults)?;
            Shape::Box(size)
        }
        "sphere" => {
            let radius = faults.required(shape, "radius", "a radius in metres")?;
            check(shape, &[radius], faults)?;
            Shape::Sphere(radius)
        }
        "cylinder" => {
            let (radius, length) = round(faults)?;
            Shape::Cylinder { radius, length }
        }
        "capsule" => {
            let (radius, length) = round(faults)?;
            Shape::Capsule { radius, length }
        }
        "cone" => {
            let (radius, length) = round(faults)?;
            Shape::Cone { radius, length }
        }
        "ellipsoid" => {
            let radii: [f64; 3] = required(shape, "radii", "three lengths", faults)?;
            check(shape, &radii, faults)?;
            Shape::Ellipsoid(radii)
        }
        "plane" => {
            let normal = given(shape, "normal", [0.0, 0.0, 1.0], faults)?;
            let size = given(shape, "size", [1.0; 2], faults)?;
            Shape::Plane { normal, size }
        }
        "polyline" => polyline(shape, faults)?,
        other => {
            let what = xml::child(shape, "uri").map(xml::text);
            let what = what.map_or_else(String::new, |uri| format!(" `{}`", quoted(uri)));
            Shape::Lack(Kind::Shape(format!("{}{what}", quoted(other))))
        }
    })
}

fn required<const N: usize>(
    shape: Node<'_, '_>,
    name: &str,
    what: &str,
    faults: &mut Faults<'_>,
) -> Option<[f64; N]> {
    let Some(found) = xml::child(shape, name) else {
        let fault = faults
            .at(shape, format!("<{}> has no <{name}>", shape.tag_name().name()))
            .label(format!("expected {what} in metres"));
        faults.push(fault);
        return None;
    };
    faults.numbers(found)
}

/// Returns the numbers of the child `name`, or these where there is none.
fn given<const N: usize>(
    shape: Node<'_, '_>,
    name: &str,
    otherwise: [f64; N],
    faults: &mut Faults<'_>,
) -> Option<[f64; N]> {
    xml::child(shape, name).map_or(Some(otherwise), |found| faults.numbers(found))
}

/// Checks `lengths`; returns `None` where one of them is no length, and collects that as a fault.
fn check(shape: Node<'_, '_>, lengths: &[f64], faults: &mut Faults<'_>) -> Option<()> {
    let possible = |length: &f64| *length > 0.0 && *length <= MAX_SIZE;
    let Some(wrong) = lengths.iter().find(|length| !possible(length)) else { return Some(()) };
    let fault = faults
        .at(shape, format!("{} out of range", shape.tag_name().name()))
        .label(format!("expected lengths above zero and up to {MAX_SIZE} m, found {wrong}"));
    faults.push(fault);
    None
}

fn polyline(shape: Node<'_, '_>, faults: &mut Faults<'_>) -> Option<Shape> {
    let height = faults.required(shape, "height", "a height in metres");
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for point in xml::elements(shape).filter(|e| e.tag_name().name() == "point") {
        corners.push(faults.numbers(point)?);
    }
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    if corners.len() < 3 {
        let fault = faults
            .at(shape, "polyline with too few corners")
            .label(format!("expected at least 3 <point>, found {}", corners.len()));
        faults.push(fault);
        return None;
    }
    let height = height?;
    check(shape, &[height], faults)?;
    Some(Shape::Polyline { corners, height })
}

fn heightmap(
    shape: Node<'_, '_>,
    file: &File<'_>,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Option<Shape> {
    let uri = xml::child(shape, "uri").map_or("", xml::text);
    let size = given(shape, "size", [1.0; 3], faults)?;
    check(shape, &size, faults)?;
    let middle = given(shape, "pos", [0.0; 3], faults)?;
    Some(match reader.heightmap(uri, file.path, Extent { size, middle }) {
        Ok(mesh) => Shape::Mesh { mesh, scale: [1.0; 3] },
        Err(why) => Shape::Lack(Kind::Heightmap { uri: uri.to_owned(), why }),
    })
}

fn mesh(
    shape: Node<'_, '_>,
    file: &File<'_>,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Option<Shape> {
    let uri = xml::child(shape, "uri").map_or("", xml::text);
    let scale = match xml::child(shape, "scale") {
        None => [1.0; 3],
        Some(node) => {
            let scale = faults.numbers::<3>(node)?;
            // A mirror is a factor below zero.
            if !scale.iter().all(|factor| *factor != 0.0 && factor.abs() <= 1e6) {
                let fault = faults.at(node, "scale out of range");
                faults.push(fault.label("expected three factors other than zero"));
                return None;
            }
            scale
        }
    };
    let submesh = xml::child(shape, "submesh");
    let wanted = submesh.map(|submesh| {
        let centred = xml::child(submesh, "center");
        let centred = centred.is_some_and(|n| matches!(xml::text(n), "1" | "true"));
        (xml::child(submesh, "name").map_or("", xml::text).to_owned(), centred)
    });
    let mut unknown = |known: &[&str]| {
        let name = wanted.as_ref().map_or("", |(name, _)| name.as_str());
        let fault = faults.at(submesh.unwrap_or(shape), format!("the mesh has no part `{name}`"));
        faults.push(fault.label(format!("its parts are {}", crate::document::listed(known))));
    };
    Some(match reader.mesh(uri, file.path, &wanted, &mut unknown) {
        Found::Mesh(mesh) => Shape::Mesh { mesh, scale },
        Found::StandIn(solids) => Shape::StandIn(solids),
        Found::Missing(why) => Shape::Lack(Kind::Mesh { uri: uri.to_owned(), why }),
        Found::Nothing => Shape::Nothing,
    })
}
