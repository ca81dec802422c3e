//! The shapes of collisions.

use super::{Models, mesh};
use crate::document::xml::{self, Faults};
use crate::geometry::{Outline, Placement, Point};
use crate::world::Body;
use roxmltree::Node;

/// Largest extent (m) of one shape.
const MAX_SIZE: f64 = 1e5;

/// Returns the bodies of a `<collision>` at `placement`, sizes multiplied by `scale` as Gazebo does; none for planes
/// and, with a warning or fault, for what cannot be read.
pub(super) fn read(
    collision: Node<'_, '_>,
    name: &str,
    placement: Placement,
    scale: [f64; 3],
    models: &mut dyn Models,
    faults: &mut Faults<'_>,
) -> Vec<Body> {
    let shape = xml::child(collision, "geometry").and_then(|g| xml::elements(g).next());
    match shape {
        Some(shape) if shape.tag_name().name() == "mesh" => {
            mesh::read(shape, name, placement, scale, models, faults)
        }
        _ => primitive(collision, name, placement, scale, faults).into_iter().collect(),
    }
}

fn primitive(
    collision: Node<'_, '_>,
    name: &str,
    placement: Placement,
    scale: [f64; 3],
    faults: &mut Faults<'_>,
) -> Option<Body> {
    let Some(shape) = xml::child(collision, "geometry").and_then(|g| xml::elements(g).next())
    else {
        let fault = faults
            .at(collision, format!("collision `{name}` has no geometry and is missing"))
            .warning();
        faults.push(fault);
        return None;
    };
    match shape.tag_name().name() {
        "plane" | "empty" => None,
        "box" => {
            let sizes = read_sizes(shape, "size", faults)?;
            let size = [sizes[0] * scale[0], sizes[1] * scale[1], sizes[2] * scale[2]];
            check(shape, &size, faults)?;
            Some(Body::Box { size, placement })
        }
        "cylinder" => {
            let radius = faults.required(shape, "radius", "a radius in metres");
            let length = faults.required(shape, "length", "a length in metres");
            // Gazebo scales a cylinder's radius by the larger of x and y.
            let (radius, length) = (radius? * scale[0].max(scale[1]), length? * scale[2]);
            check(shape, &[radius, length], faults)?;
            Some(Body::Cylinder { radius, length, placement })
        }
        "polyline" => polyline(shape, name, placement, scale, faults),
        kind => {
            let what = xml::child(shape, "uri").map(xml::text);
            let what = what.map_or_else(String::new, |uri| format!(" `{uri}`"));
            let fault = faults
                .at(
                    shape,
                    format!(
                        "collision `{name}` is a {kind}{what}, which cannot be read: it is missing"
                    ),
                )
                .warning();
            faults.push(fault);
            None
        }
    }
}

fn read_sizes(shape: Node<'_, '_>, name: &str, faults: &mut Faults<'_>) -> Option<[f64; 3]> {
    let Some(size) = xml::child(shape, name) else {
        let fault = faults
            .at(shape, format!("<{}> has no <{name}>", shape.tag_name().name()))
            .label("expected three lengths in metres");
        faults.push(fault);
        return None;
    };
    faults.numbers(size)
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

fn polyline(
    shape: Node<'_, '_>,
    name: &str,
    placement: Placement,
    scale: [f64; 3],
    faults: &mut Faults<'_>,
) -> Option<Body> {
    let height = faults.required(shape, "height", "a height in metres");
    let mut corners = Vec::new();
    for point in xml::elements(shape).filter(|e| e.tag_name().name() == "point") {
        let [x, y] = faults.numbers(point)?;
        let [x, y, _] = placement.apply([x * scale[0], y * scale[1], 0.0]);
        corners.push(Point::new(x, y));
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
    let height = height? * scale[2];
    check(shape, &[height], faults)?;
    if placement.rotation[2][2] < 1.0 - 1e-9 {
        let fault = faults
            .at(
                shape,
                format!(
                    "collision `{name}` is a tilted polyline, which cannot be read: it is missing"
                ),
            )
            .warning();
        faults.push(fault);
        return None;
    }
    let low = placement.translation[2];
    Some(Body::Prism { outline: Outline::Polygon(corners), z: [low, low + height] })
}
