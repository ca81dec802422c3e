//! SDF: a `<model>` with its links, joints, sensors and plugins, as Gazebo's robots are described.
//!
//! The base frame is the model's own, wherever the file puts the model. Nested models count; what is included does not, and
//! says so.

mod frames;

use super::description::ShapeKind;
use super::description::parts::{Collision, Geometry, Joint, Mounted, Parts, other_form};
use super::urdf;
use crate::document::Diagnostic;
use crate::document::sdf;
use crate::document::xml::{self, Faults};
use crate::geometry::Placement;
use frames::Frames;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// How deep models may nest.
const MAX_MODELS: usize = 8;

/// Tells the parts of the model in an SDF file; `None` with faults where there is none.
pub(super) fn parts<'a, 'i>(
    document: &'a Document<'i>,
    faults: &mut Faults<'_>,
) -> Option<Parts<'a, 'i>> {
    let root = document.root_element();
    let mut models = xml::elements(root).filter(|e| e.tag_name().name() == "model");
    let Some(model) = models.next() else {
        let fault = faults.at(root, "the SDF file holds no robot").label("expected a <model>");
        faults.push(match xml::child(root, "world") {
            Some(_) => fault.help("it holds a <world>: name it under `world`"),
            None => fault.help("a robot is one <model> with links, a drive plugin and sensors"),
        });
        return None;
    };
    if let Some(second) = models.next() {
        let fault = faults.at(second, "second <model>").label("expected one, the robot");
        faults.push(fault);
    }
    let mut parts = Parts {
        name: model.attribute("name").unwrap_or_default().to_owned(),
        root: model,
        links: BTreeMap::new(),
        masses: Vec::new(),
        collisions: Vec::new(),
        joints: Vec::new(),
        plugins: Vec::new(),
        sensors: Vec::new(),
        floor: None,
    };
    if parts.name.is_empty() {
        let fault = faults.at(model, "<model> without a name");
        faults.push(fault.label("expected an attribute `name`"));
    }
    for pose in sdf::overturned(model) {
        faults.push(overturned(faults.at(pose, "a pose turns by more than once around")));
    }
    let mut frames = Frames::default();
    frames.collect(model, "", MAX_MODELS, faults);
    let mut reader = Reader { frames, parts: &mut parts, faults };
    reader.model(model, "", MAX_MODELS);
    let blocks = xml::elements(root).chain(xml::elements(model));
    for block in blocks.filter(|e| e.tag_name().name() == "gazebo") {
        urdf::read_block(block, &mut parts, faults);
    }
    Some(parts)
}

/// Completes the warning of angles that seem to be degrees.
pub(super) fn overturned(fault: Diagnostic) -> Diagnostic {
    fault.label("angles are in radians: are these degrees?").warning()
}

struct Reader<'r, 'a, 'i, 's> {
    frames: Frames<'a, 'i>,
    parts: &'r mut Parts<'a, 'i>,
    faults: &'r mut Faults<'s>,
}

impl<'a, 'i> Reader<'_, 'a, 'i, '_> {
    /// Reads a model whose parts' names begin with `prefix`.
    fn model(&mut self, model: Node<'a, 'i>, prefix: &str, depth: usize) {
        for node in xml::elements(model) {
            let name = || format!("{prefix}{}", node.attribute("name").unwrap_or_default());
            match node.tag_name().name() {
                "link" => self.link(node, &name()),
                "joint" => {
                    let child = xml::child(node, "child").map(xml::text).unwrap_or_default();
                    let Some(placement) = self.frames.placement(&name(), self.faults) else {
                        continue;
                    };
                    self.parts.joints.push(Joint {
                        name: name(),
                        child: format!("{prefix}{child}"),
                        placement,
                        turns: matches!(node.attribute("type"), Some("continuous" | "revolute")),
                    });
                }
                "plugin" => self.parts.plugins.push(node),
                "model" if depth > 0 => self.model(node, &(name() + "::"), depth - 1),
                "include" => {
                    let uri = xml::child(node, "uri").map(xml::text).unwrap_or_default();
                    let fault = self
                        .faults
                        .at(node, format!("`{}` is not included", crate::document::quoted(uri)))
                        .label("models that a robot's model includes are not read");
                    self.faults.push(fault.warning());
                }
                _ => {}
            }
        }
    }

    /// Returns where the frame `of` is, that the pose of `node` on the link `link` names; a fault where there is none.
    fn named(&mut self, node: Node<'a, 'i>, link: &str, of: &str) -> Option<Placement> {
        let scope = link.rsplit_once("::").map_or("", |(scope, _)| scope);
        let name = if scope.is_empty() { of.to_owned() } else { format!("{scope}::{of}") };
        if !self.frames.has(&name) {
            let message = format!("a collision on `{link}` is relative to an unknown frame `{of}`");
            let fault = self.faults.at(node, message);
            self.faults.push(fault);
            return None;
        }
        self.frames.placement(&name, self.faults)
    }

    fn link(&mut self, link: Node<'a, 'i>, name: &str) {
        let Some(frame) = self.frames.placement(name, self.faults) else { return };
        let mass = xml::descend(link, "inertial/mass");
        let mass = mass.and_then(|mass| self.faults.number(mass)).unwrap_or(0.0);
        if mass < 0.0 {
            let fault = self.faults.at(link, format!("link `{name}` has a negative mass"));
            self.faults.push(fault.label(format!("expected zero or more, found {mass}")));
        }
        self.parts.masses.push(mass);
        for node in xml::elements(link) {
            match node.tag_name().name() {
                "collision" => {
                    let sdf::Pose { frame: of, placement } = sdf::pose(node, self.faults);
                    let Some(within) = of.map_or(Some(frame), |of| self.named(node, name, &of))
                    else {
                        continue;
                    };
                    let Some(geometry) = xml::child(node, "geometry") else { continue };
                    let Some(geometry) = self.geometry(geometry) else { continue };
                    self.parts.collisions.push(Collision {
                        node,
                        link: name.to_owned(),
                        geometry,
                        placement: within.compose(&placement),
                    });
                }
                "sensor" => {
                    self.parts.sensors.push(Mounted { node, link: Some(frame), around: link });
                }
                _ => {}
            }
        }
        if self.parts.links.insert(name.to_owned(), frame).is_some() {
            let fault = self.faults.at(link, format!("duplicate link `{name}`"));
            self.faults.push(fault.help("give every link a name of its own"));
        }
    }

    fn geometry(&mut self, node: Node<'a, 'i>) -> Option<Geometry> {
        let form = xml::elements(node).next()?;
        let mut size = |name: &str| {
            let found = self.faults.required(form, name, "a length in metres")?;
            if found > 0.0 {
                return Some(found);
            }
            let fault =
                self.faults.at(form, format!("{} {name} out of range", form.tag_name().name()));
            self.faults.push(fault.label(format!("expected more than zero, found {found}")));
            None
        };
        Some(Geometry::Simple(match form.tag_name().name() {
            "box" => {
                let Some(node) = xml::child(form, "size") else {
                    let fault = self.faults.at(form, "<box> has no <size>");
                    self.faults.push(fault.label("expected three lengths in metres"));
                    return None;
                };
                let size: [f64; 3] = self.faults.numbers(node)?;
                if size.iter().any(|length| *length < 0.0) {
                    let fault = self.faults.at(node, "box size out of range");
                    self.faults.push(fault.label("expected lengths of more than zero"));
                }
                // As converters write what has no form.
                if size.iter().all(|length| *length == 0.0) {
                    return None;
                }
                ShapeKind::Box { size }
            }
            "cylinder" => {
                let (radius, length) = (size("radius"), size("length"));
                ShapeKind::Cylinder { radius: radius?, length: length? }
            }
            "capsule" => {
                let (radius, length) = (size("radius"), size("length"));
                ShapeKind::Cylinder { radius: radius?, length: length? + 2.0 * radius? }
            }
            "sphere" => ShapeKind::Sphere { radius: size("radius")? },
            "mesh" => {
                let uri = xml::child(form, "uri").map(xml::text).unwrap_or_default().to_owned();
                let scale = match xml::child(form, "scale") {
                    Some(scale) => self.faults.numbers(scale)?,
                    None => [1.0; 3],
                };
                return Some(Geometry::Mesh { uri, scale });
            }
            other => return Some(Geometry::Other(other_form(other))),
        }))
    }
}

/// No placement: where there is nothing to say.
const NOWHERE: Placement = Placement::IDENTITY;

#[cfg(test)]
mod tests;
