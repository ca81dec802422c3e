//! Gazebo worlds: SDF `.world` and `.sdf` files (SDFormat 1.4 to 1.9) as solids of one layer, [`LAYER`].
//!
//! Collisions count, visuals do not. Where the file has a `<state>`, its poses and scales are the truth, as in
//! Gazebo; a scale multiplies sizes, not the poses within a model. What moves in Gazebo stands still here.
//! Ground planes are left out. Whatever else cannot be read is a warning that names it.

mod geometry;
mod mesh;
mod model;
mod models;

pub use models::{Found, MeshPath, Models, NoModels, Unplaced, mesh_path};

use super::World;
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Severity, Source};
use crate::geometry::Placement;
use model::State;
use roxmltree::Node;
use std::collections::BTreeMap;

/// Longest file read (bytes).
pub const MAX_BYTES: usize = 16 << 20;

/// The layer of every solid of an SDF world.
pub const LAYER: &str = "walls";

/// Reads a world without its meshes; its `warnings` say what could not be read.
///
/// # Errors
/// Every fault found, warnings among them, where the file is no SDF world.
pub fn read(source: &Source) -> Result<World, Vec<Diagnostic>> {
    read_with(source, &mut NoModels)
}

/// Reads a world with the meshes that `models` hands over.
///
/// # Errors
/// As [`read`]; also where a mesh is there and cannot be read.
pub fn read_with(source: &Source, models: &mut dyn Models) -> Result<World, Vec<Diagnostic>> {
    let document = xml::parse(source, MAX_BYTES)?;
    let mut faults = Faults::new(source);
    let mut solids = Vec::new();
    if let Some(world) = world_of(document.root_element(), &mut faults) {
        let states: BTreeMap<&str, Node<'_, '_>> = xml::child(world, "state")
            .into_iter()
            .flat_map(xml::elements)
            .filter(|e| e.tag_name().name() == "model")
            .filter_map(|e| Some((e.attribute("name")?, e)))
            .collect();
        for element in xml::elements(world) {
            match element.tag_name().name() {
                "model" => {
                    let name = element.attribute("name").unwrap_or("");
                    let state = State::read(states.get(name).copied(), &mut faults);
                    let place = model::Place { outer: Placement::IDENTITY, prefix: String::new() };
                    model::read(element, &place, &state, models, &mut solids, &mut faults);
                }
                "include" => model::warn_of_include(element, &mut faults),
                kind @ ("actor" | "population" | "road") => {
                    let name = element.attribute("name").unwrap_or("");
                    let fault = faults
                        .at(element, format!("<{kind}> `{name}` cannot be read and is missing"))
                        .warning();
                    faults.push(fault);
                }
                _ => {}
            }
        }
        if solids.is_empty() {
            let fault = faults
                .at(world, "the world has nothing solid that can be read")
                .label("expected a model with box, cylinder or polyline collisions");
            faults.push(fault);
        }
    }
    if faults.any_error() {
        return Err(faults.finish());
    }
    Ok(World {
        name: stem(&source.name).to_owned(),
        solids,
        regions: Vec::new(),
        tags: Vec::new(),
        starts: BTreeMap::new(),
        goals: BTreeMap::new(),
        warnings: faults
            .finish()
            .iter()
            .filter(|f| f.severity == Severity::Warning)
            .map(said)
            .collect(),
    })
}

/// Returns the one `<world>`, or the `<sdf>` itself where it holds bare models.
fn world_of<'a, 'i>(root: Node<'a, 'i>, faults: &mut Faults<'_>) -> Option<Node<'a, 'i>> {
    let found = root.tag_name().name();
    if found != "sdf" {
        let mut fault =
            faults.at(root, "not an SDF world").label(format!("expected <sdf>, found <{found}>"));
        if found == "robot" {
            fault = fault.help("a URDF describes a robot; name it under `robot`");
        }
        faults.push(fault);
        return None;
    }
    let mut worlds = xml::elements(root).filter(|e| e.tag_name().name() == "world");
    let (first, second) = (worlds.next(), worlds.next());
    if let Some(second) = second {
        let fault = faults.at(second, "second <world>").label("expected one");
        faults.push(fault);
    }
    Some(first.unwrap_or(root))
}

/// Returns a warning as one line.
fn said(warning: &Diagnostic) -> String {
    let place = warning.location().map(|place| place + ": ").unwrap_or_default();
    format!("{place}{}", warning.message)
}

/// Returns the file's name without folders and extension.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

#[cfg(test)]
mod tests;
