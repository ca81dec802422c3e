//! URDF: links and joints as ROS describes them, with the `<gazebo>` blocks of sensors and drives.
//!
//! A strict pass reports, with lines, what is no tree of links with numbers that are numbers; then the parts are told.
//! The floor is where a link called `base_footprint` has its origin (REP-120).

mod strict;

use super::Robot;
use super::description::parts::{Collision, Geometry, Joint, Mounted, Parts, other_form};
use super::description::{self, Request, ShapeKind};
use super::files::{FilePath, NoFiles, Rooted};
use super::given::Given;
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Source, suggestion};
use crate::geometry::Placement;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// The link on the floor, whatever prefix its name has.
const ON_THE_FLOOR: &str = "base_footprint";

/// Reads a robot, URDF or SDF, that needs no file besides its own, and the warnings about it.
///
/// # Errors
/// As [`description::read`].
pub fn read(source: &Source) -> Result<(Robot, Vec<Diagnostic>), Vec<Diagnostic>> {
    let nothing = BTreeMap::new();
    let request = Request {
        path: FilePath { path: source.name.to_string(), rooted: Rooted::Robot },
        gazebo: Vec::new(),
        packages: &nothing,
        arguments: &nothing,
        given: &Given::default(),
        fault: &|_, message| Diagnostic::placeless(message),
    };
    description::read(source, &request, &mut NoFiles)
}

/// Tells the parts of a URDF; `None` with faults where it is none.
pub(super) fn parts<'a, 'i>(
    document: &'a Document<'i>,
    faults: &mut Faults<'_>,
) -> Option<Parts<'a, 'i>> {
    let tree = strict::check(document, faults);
    let (Some(tree), false) = (tree, faults.any_error()) else { return None };
    let root = document.root_element();
    let named =
        |name: &'static str| xml::elements(root).filter(move |e| e.tag_name().name() == name);
    let (links, joints) = place(root, &tree.root);
    let mut parts = Parts {
        name: root.attribute("name").unwrap_or_default().to_owned(),
        root,
        links,
        masses: Vec::new(),
        collisions: Vec::new(),
        joints,
        plugins: Vec::new(),
        sensors: Vec::new(),
        floor: None,
    };
    let on_the_floor = parts.links.iter().find(|(name, _)| name.ends_with(ON_THE_FLOOR));
    parts.floor = on_the_floor.map(|(_, placement)| placement.translation[2]);
    for link in named("link") {
        let name = link.attribute("name").unwrap_or_default();
        let frame = parts.links.get(name).copied().unwrap_or(Placement::IDENTITY);
        let mass = xml::descend(link, "inertial/mass");
        parts.masses.push(mass.map_or(0.0, |mass| numbers(mass, "value", [0.0])[0]));
        for node in xml::elements(link) {
            match node.tag_name().name() {
                "collision" => {
                    let Some(geometry) = xml::child(node, "geometry") else { continue };
                    parts.collisions.push(Collision {
                        node,
                        link: name.to_owned(),
                        geometry: self::geometry(geometry),
                        placement: frame.compose(&origin(node)),
                    });
                }
                "sensor" => {
                    parts.sensors.push(Mounted { node, link: Some(frame), around: link });
                }
                _ => {}
            }
        }
    }
    for block in named("gazebo") {
        read_block(block, &mut parts, faults);
    }
    Some(parts)
}

/// Reads a `<gazebo>` block.
pub(super) fn read_block<'a, 'i>(
    block: Node<'a, 'i>,
    parts: &mut Parts<'a, 'i>,
    faults: &mut Faults<'_>,
) {
    let elements = |name: &'static str| {
        block.descendants().filter(move |e| e.is_element() && e.tag_name().name() == name)
    };
    parts.plugins.extend(xml::elements(block).filter(|e| e.tag_name().name() == "plugin"));
    let sensors: Vec<Node<'a, 'i>> = elements("sensor").collect();
    let reference = block.attribute("reference");
    if let Some(link) = reference
        && !parts.links.contains_key(link)
    {
        if parts.joints.iter().any(|joint| joint.name == link) && sensors.is_empty() {
            return;
        }
        let mut fault = faults.at(block, format!("reference to an unknown link `{link}`"));
        if let Some(near) = suggestion(link, parts.links.keys().map(String::as_str)) {
            fault = fault.help(format!("did you mean `{near}`?"));
        }
        // A block that only colours a missing link does no harm.
        faults.push(if sensors.is_empty() { fault.warning() } else { fault });
        return;
    }
    for node in sensors {
        // A block may hold a link or a model of SDF.
        let around = node.ancestors().find(|e| e.tag_name().name() == "link");
        let name = around.and_then(|link| link.attribute("name")).or(reference);
        let link = name.and_then(|name| parts.links.get(name)).copied();
        parts.sensors.push(Mounted { node, link, around: block });
    }
}

/// Returns the placement of every link in the root link's frame, joints at zero, and the joints.
fn place(robot: Node<'_, '_>, root: &str) -> (BTreeMap<String, Placement>, Vec<Joint>) {
    let mut frames = BTreeMap::from([(root.to_owned(), Placement::IDENTITY)]);
    let all: Vec<_> = xml::elements(robot)
        .filter(|e| e.tag_name().name() == "joint")
        .filter_map(|joint| {
            let end = |role| xml::child(joint, role)?.attribute("link");
            Some((joint, end("parent")?, end("child")?))
        })
        .collect();
    let mut joints = Vec::new();
    let mut open = vec![root];
    while let Some(parent) = open.pop() {
        for (joint, _, child) in all.iter().filter(|(_, from, _)| *from == parent) {
            let placement = frames[parent].compose(&origin(*joint));
            frames.insert((*child).to_owned(), placement);
            joints.push(Joint {
                name: joint.attribute("name").unwrap_or_default().to_owned(),
                child: (*child).to_owned(),
                placement,
                turns: matches!(joint.attribute("type"), Some("continuous" | "revolute")),
            });
            open.push(child);
        }
    }
    (frames, joints)
}

/// Returns the placement that the `<origin>` of `node` says.
fn origin(node: Node<'_, '_>) -> Placement {
    let written = |name| {
        xml::child(node, "origin").map_or([0.0; 3], |origin| numbers(origin, name, [0.0; 3]))
    };
    let ([x, y, z], [roll, pitch, yaw]) = (written("xyz"), written("rpy"));
    Placement::from_xyz_rpy([x, y, z, roll, pitch, yaw])
}

/// Returns the numbers of the attribute `name`, which the strict pass has read before; `otherwise` where there is none.
fn numbers<const N: usize>(node: Node<'_, '_>, name: &str, otherwise: [f64; N]) -> [f64; N] {
    let written = node.attribute(name).unwrap_or_default().split_whitespace();
    let found: Vec<f64> = written.filter_map(|number| number.parse().ok()).collect();
    found.try_into().unwrap_or(otherwise)
}

fn geometry(node: Node<'_, '_>) -> Geometry {
    let Some(form) = xml::elements(node).next() else { return Geometry::Other("geometry") };
    let number = |name| numbers(form, name, [0.0])[0];
    Geometry::Simple(match form.tag_name().name() {
        "box" => ShapeKind::Box { size: numbers(form, "size", [0.0; 3]) },
        "cylinder" => ShapeKind::Cylinder { radius: number("radius"), length: number("length") },
        "capsule" => {
            let (radius, length) = (number("radius"), number("length"));
            ShapeKind::Cylinder { radius, length: length + 2.0 * radius }
        }
        "sphere" => ShapeKind::Sphere { radius: number("radius") },
        "mesh" => {
            let uri = form.attribute("filename").unwrap_or_default().to_owned();
            return Geometry::Mesh { uri, scale: numbers(form, "scale", [1.0; 3]) };
        }
        other => return Geometry::Other(other_form(other)),
    })
}

#[cfg(test)]
mod tests;
