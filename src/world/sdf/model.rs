//! Models as they are described: links with their collisions, and models within, each placed in the model's own frame.
//! A description is read once, however often a world includes it.

use super::frames::{Frames, Unplaceable};
use super::geometry::{self, Shape};
use super::include;
use super::notes::Place;
use super::reader::{File, Reader};
use crate::document::sdf::{Pose, pose};
use crate::document::xml::{self, Faults};
use crate::document::{MOST_FAULTS, quoted};
use crate::geometry::Placement;
use roxmltree::Node;
use std::collections::BTreeMap;
use std::sync::Arc;

/// How deep models may stand in one another, included ones too.
pub(super) const MAX_DEPTH: usize = 32;

/// A model, or the world itself.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) name: String,
    /// Where it stands in whatever it is part of.
    pub(super) pose: Pose,
    /// The frame whose place `pose` says; its own where empty.
    pub(super) placement_frame: String,
    /// Whether nothing moves it.
    pub(super) fixed: bool,
    pub(super) parts: Vec<Part>,
    /// Its frames, those of merged models among them.
    frames: BTreeMap<String, Placement>,
    /// The models within, likewise.
    models: BTreeMap<String, (Placement, Arc<Model>)>,
}

/// A part of a model, in the order written.
#[derive(Debug)]
pub(super) enum Part {
    Link(Link),
    Model(Child),
    /// Something that is missing.
    Lack(Lack),
}

/// What is missing of a model.
#[derive(Debug)]
pub(super) struct Lack {
    pub(super) name: String,
    /// What it is called where it is told; its name with those of the models that it is in where this is none.
    pub(super) told_as: Option<String>,
    pub(super) kind: super::notes::Kind,
    pub(super) place: Place,
}

/// A link.
#[derive(Debug)]
pub(super) struct Link {
    pub(super) name: String,
    /// Its place in the model.
    pub(super) placement: Placement,
    pub(super) collisions: Vec<Collision>,
    pub(super) place: Place,
}

/// A collision.
#[derive(Debug)]
pub(super) struct Collision {
    pub(super) name: String,
    /// Its place in the link.
    pub(super) placement: Placement,
    pub(super) shape: Shape,
    pub(super) place: Place,
}

/// A model within another.
#[derive(Debug)]
pub(super) struct Child {
    pub(super) model: Arc<Model>,
    pub(super) name: String,
    /// The place of its own frame in the outer model.
    pub(super) placement: Placement,
    pub(super) fixed: bool,
    /// Whether its parts are parts of the outer model.
    pub(super) merged: bool,
    pub(super) place: Place,
}

impl Model {
    /// Returns where the frame `name` (`link`, or `model::link`) is in this model.
    pub(super) fn frame(&self, name: &str) -> Option<Placement> {
        if name.is_empty() || name == "__model__" {
            return Some(Placement::IDENTITY);
        }
        if let Some(placement) = self.frames.get(name) {
            return Some(*placement);
        }
        let (model, rest) = name.split_once("::")?;
        let (placement, model) = self.models.get(model)?;
        Some(placement.compose(&model.frame(rest)?))
    }
}

/// A model within, before it is placed.
pub(super) struct Nested {
    pub(super) model: Arc<Model>,
    pub(super) name: String,
    pub(super) pose: Pose,
    pub(super) placement_frame: String,
    pub(super) fixed: bool,
    pub(super) merged: bool,
}

/// A part before it is placed.
enum Unplaced<'a, 'i> {
    Link(Node<'a, 'i>, Pose),
    Model(Node<'a, 'i>, Nested),
    Lack(Lack),
}

/// Returns whether the child `name` of `node` says yes.
pub(super) fn says_yes(node: Node<'_, '_>, name: &str) -> Option<bool> {
    xml::child(node, name).map(|n| matches!(xml::text(n), "1" | "true"))
}

/// Reads a `<model>`, or a `<world>` (`<sdf>`), and all that is in it.
pub(super) fn read(
    node: Node<'_, '_>,
    file: &File<'_>,
    depth: usize,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Model {
    let is_world = node.tag_name().name() != "model";
    let own = if is_world { "world" } else { "__model__" };
    let mut frames = Frames::new(own);
    let mut unplaced = Vec::new();
    let mut fixed = says_yes(node, "static").unwrap_or(false);
    for element in xml::elements(node) {
        let name = element.attribute("name").unwrap_or("");
        match element.tag_name().name() {
            "link" if !is_world => {
                let pose = pose(element, faults);
                frames.add(name, &pose, own);
                unplaced.push(Unplaced::Link(element, pose));
            }
            "frame" => {
                let pose = pose(element, faults);
                frames.add(name, &pose, element.attribute("attached_to").unwrap_or(own));
            }
            "joint" => {
                let child = xml::child(element, "child").map_or("", xml::text);
                let parent = xml::child(element, "parent").map_or("", xml::text);
                fixed |= element.attribute("type") == Some("fixed") && parent == "world";
                frames.add(name, &pose(element, faults), child);
            }
            kind @ ("model" | "include") => {
                if depth >= MAX_DEPTH {
                    let fault = faults.at(element, "models nested too deeply");
                    faults.push(fault.label(format!("expected at most {MAX_DEPTH} levels")));
                    continue;
                }
                if kind == "include" {
                    match include::read(element, file, depth + 1, reader, faults) {
                        include::Read::Nothing => {}
                        include::Read::Lack(lack) => unplaced.push(Unplaced::Lack(lack)),
                        include::Read::Model(nested) => {
                            unplaced.push(Unplaced::Model(element, nested));
                        }
                    }
                } else {
                    let model = read(element, file, depth + 1, reader, faults);
                    unplaced.push(Unplaced::Model(element, nested(Arc::new(model))));
                }
            }
            kind @ ("actor" | "population" | "road") => {
                let kind = super::notes::Kind::Element(kind.to_owned());
                let place = Place::of(file.source, element);
                unplaced.push(Unplaced::Lack(Lack {
                    name: name.to_owned(),
                    told_as: None,
                    kind,
                    place,
                }));
            }
            _ => {}
        }
    }
    let mut model = Model {
        name: node.attribute("name").unwrap_or("").to_owned(),
        pose: pose(node, faults),
        placement_frame: node.attribute("placement_frame").unwrap_or("").to_owned(),
        fixed,
        parts: Vec::with_capacity(unplaced.len()),
        frames: BTreeMap::new(),
        models: BTreeMap::new(),
    };
    place(unplaced, frames, &mut model, file, reader, faults);
    model
}

/// Returns a model within, as it is described.
pub(super) fn nested(model: Arc<Model>) -> Nested {
    let (name, pose) = (model.name.clone(), model.pose.clone());
    let (placement_frame, fixed) = (model.placement_frame.clone(), model.fixed);
    Nested { model, name, pose, placement_frame, fixed, merged: false }
}

/// Places the parts of `model` by its `frames`.
fn place(
    unplaced: Vec<Unplaced<'_, '_>>,
    mut frames: Frames,
    model: &mut Model,
    file: &File<'_>,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) {
    // Frames of models within can be named by any part, so all are known first.
    let mut ready = Vec::with_capacity(unplaced.len());
    for mut part in unplaced {
        if let Unplaced::Model(node, nested) = &mut part {
            if !nested.placement_frame.is_empty() {
                if let Some(inner) = nested.model.frame(&nested.placement_frame) {
                    nested.pose.placement = nested.pose.placement.compose(&inner.inverse());
                } else {
                    let unknown = format!("unknown frame `{}`", quoted(&nested.placement_frame));
                    let fault = faults.at(*node, unknown).label("placed by it");
                    faults.push(fault.help("expected a link, joint, frame or model within"));
                }
            }
            frames.add_model(&nested.name, &nested.pose, &nested.model, nested.merged);
        }
        ready.push(part);
    }
    let mut merged_in = Vec::new();
    for part in ready {
        let part = match part {
            Unplaced::Lack(lack) => Part::Lack(lack),
            Unplaced::Link(node, pose) => {
                let placement = placed(frames.place(&pose, None), node, &frames, faults);
                let (placement, link) = (placement, node.attribute("name").unwrap_or(""));
                let collisions = collisions(node, placement, &mut frames, file, reader, faults);
                let (name, place) = (link.to_owned(), Place::of(file.source, node));
                Part::Link(Link { name, placement, collisions, place })
            }
            Unplaced::Model(node, nested) => {
                let placement = placed(frames.place(&nested.pose, None), node, &frames, faults);
                let Nested { model: inner, name, fixed, merged, .. } = nested;
                if merged {
                    merged_in.push((placement, Arc::clone(&inner)));
                } else {
                    let known = (placement, Arc::clone(&inner));
                    model.models.entry(name.clone()).or_insert(known);
                }
                let place = Place::of(file.source, node);
                Part::Model(Child { model: inner, name, placement, fixed, merged, place })
            }
        };
        model.parts.push(part);
    }
    model.frames = frames.into_placed();
    // Once for each level, so that a name is never looked for in every model that was ever merged.
    for (at, inner) in merged_in {
        for (name, placement) in &inner.frames {
            model.frames.entry(name.clone()).or_insert_with(|| at.compose(placement));
        }
        for (name, (placement, nested)) in &inner.models {
            let known = || (at.compose(placement), Arc::clone(nested));
            model.models.entry(name.clone()).or_insert_with(known);
        }
    }
}

fn collisions(
    link: Node<'_, '_>,
    placement: Placement,
    frames: &mut Frames,
    file: &File<'_>,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Vec<Collision> {
    let own = link.attribute("name").unwrap_or("");
    let of_link = xml::elements(link).filter(|e| e.tag_name().name() == "collision");
    let read = |element| {
        let pose = pose(element, faults);
        let within = match pose.frame.as_deref() {
            None => pose.placement,
            Some(frame) if frame == own => pose.placement,
            Some(_) => {
                let in_model = placed(frames.place(&pose, None), element, frames, faults);
                placement.inverse().compose(&in_model)
            }
        };
        Collision {
            name: element.attribute("name").unwrap_or("").to_owned(),
            placement: within,
            shape: geometry::read(element, file, reader, faults),
            place: Place::of(file.source, geometry::shape_of(element).unwrap_or(element)),
        }
    };
    of_link.map(read).collect()
}

/// Returns a placement, or none with a fault at the pose of `node`.
fn placed(
    found: Result<Placement, Unplaceable>,
    node: Node<'_, '_>,
    frames: &Frames,
    faults: &mut Faults<'_>,
) -> Placement {
    let why = match found {
        Ok(placement) => return placement,
        Err(why) => why,
    };
    let at = xml::child(node, "pose").unwrap_or(node);
    let fault = match why {
        Unplaceable::Told => return Placement::IDENTITY,
        Unplaceable::Unknown(name) => {
            let unknown = format!("pose relative to the unknown frame `{}`", quoted(&name));
            let fault = faults.at(at, unknown);
            let fault = fault.label("expected a link, joint, frame or model of the same model");
            // To look for what was meant takes longer than all the rest.
            if faults.kept().len() < MOST_FAULTS { fault.help(frames.near(&name)) } else { fault }
        }
        Unplaceable::Cycle(mut names) => {
            names.extend(names.first().cloned());
            let names: Vec<String> = names.iter().map(|n| format!("`{}`", quoted(n))).collect();
            let shown: Vec<&str> = names.iter().take(8).map(String::as_str).collect();
            faults
                .at(at, format!("poses in a circle: {}", shown.join(" relative to ")))
                .label("expected a pose that leads to the model's own frame")
        }
    };
    faults.push(fault);
    Placement::IDENTITY
}
