//! Gazebo worlds: SDF `.world` and `.sdf` files (SDFormat 1.3 to 1.12) as solids of one layer, [`LAYER`].
//!
//! 1. Files are read (`model`, `include`, `geometry`): the world's own, and once each those that it
//!    includes. A model's parts are placed in its own frame (`frames`).
//! 2. Models are placed in the world (`place`), as often as they stand in it. Where the file has a `<state>`, its
//!    poses and scales are the truth, as in Gazebo; a scale multiplies sizes, not the poses within a model.
//! 3. Floors are taken out (`floor`).
//!
//! Collisions count, visuals do not. What moves in Gazebo stands still here. Whatever cannot be read is a warning that names
//! it, one for each kind of thing.

mod body;
mod files;
mod floor;
mod frames;
mod geometry;
mod include;
mod model;
mod notes;
mod place;
mod reader;
mod state;
mod terrain;

pub use files::{FilePath, Folders, Models, NoModels, Root, Unplaced};
pub use floor::{ROLLED_OVER, STEP, WIDE};

use super::World;
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Severity, Source};
use place::Placer;
use reader::{File, Reader};
use roxmltree::Node;
use state::State;
use std::collections::BTreeMap;

/// Longest file read (bytes).
pub const MAX_BYTES: usize = 16 << 20;

/// The layer of every solid of an SDF world.
pub const LAYER: &str = "walls";

/// A world so wide (m) is taken to be written in another unit.
const WIDEST: f64 = 1e4;

/// Reads a world without the files of its models; its `warnings` say what could not be read.
///
/// # Errors
/// Every fault found, warnings among them, where the file is no SDF world.
pub fn read(source: &Source) -> Result<World, Vec<Diagnostic>> {
    read_with(source, &mut NoModels)
}

/// Reads a world with the models and meshes of which `models` hands over the files.
///
/// # Errors
/// As [`read`]; also where a file is there and cannot be read.
pub fn read_with(source: &Source, models: &mut dyn Models) -> Result<World, Vec<Diagnostic>> {
    let document = xml::parse(source, MAX_BYTES)?;
    let mut faults = Faults::new(source);
    let mut reader = Reader::new(models);
    let mut solids = Vec::new();
    let root = document.root_element();
    if let Some(world) = world_of(root, &mut faults) {
        reader.note_oddities(root, source);
        check_macros(root, &mut faults);
        let file = File { path: &FilePath::WORLD, source };
        let model = model::read(world, &file, 0, &mut reader, &mut faults);
        let state = State::read(xml::child(world, "state"), &mut faults);
        let broken = reader.any_error();
        let Reader { models, notes, .. } = &mut reader;
        let mut placer = Placer {
            solids: Vec::new(),
            models: &mut **models,
            notes,
            faults: &mut faults,
            budget: place::Budget::default(),
            moving: 0,
            is_full: false,
        };
        if !broken {
            placer.world(&model, &state);
        }
        solids = placer.solids;
        let found = !solids.is_empty();
        floor::take(&mut solids, notes);
        if solids.is_empty() && !broken {
            let mut fault = faults
                .at(world, "the world has nothing solid that can be read")
                .label("expected a model with collisions");
            if let Some(lack) = notes.first_lack() {
                fault = fault.help(lack.message);
            } else if found {
                fault = fault.help("all of it lies flat on the ground: it is floor");
            }
            faults.push(fault);
        }
    }
    for fault in reader.take_faults().into_iter().chain(reader.notes.finish()) {
        faults.push(fault);
    }
    if faults.any_error() {
        return Err(faults.finish());
    }
    let mut world = World {
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
    };
    world.warnings.extend(unit_slip(&world));
    Ok(world)
}

/// Returns the minor version of a version of SDFormat that is read: 6 of `1.6`.
fn known_version(version: &str) -> Option<u32> {
    let minor: u32 = version.trim().strip_prefix("1.")?.parse().ok()?;
    (3..=12).contains(&minor).then_some(minor)
}

/// Returns the one `<world>`, or the `<sdf>` itself where it holds bare models.
fn world_of<'a, 'i>(root: Node<'a, 'i>, faults: &mut Faults<'_>) -> Option<Node<'a, 'i>> {
    let found = root.tag_name().name();
    if found != "sdf" {
        let mut fault =
            faults.at(root, "not an SDF world").label(format!("expected <sdf>, found <{found}>"));
        match found {
            "robot" => fault = fault.help("a URDF describes a robot; name it under `robot`"),
            "mujoco" => fault = fault.help(super::formats::Foreign::Mjcf.help()),
            _ => {}
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

/// Refuses macros in which something solid may stand. Others, as around a plugin, change no solid: Gazebo overlooks them too.
fn check_macros(root: Node<'_, '_>, faults: &mut Faults<'_>) {
    let is_macro =
        |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro"));
    let solid = ["model", "include", "link", "collision", "pose", "geometry", "static"];
    let matters = |node: &Node<'_, '_>| {
        let harmless = matches!(node.tag_name().name(), "arg" | "property" | "if" | "unless");
        !harmless || node.descendants().skip(1).any(|n| solid.contains(&n.tag_name().name()))
    };
    let mut macros = root.descendants().filter(|node| node.is_element() && is_macro(node));
    if let Some(node) = macros.find(matters) {
        let fault = faults
            .at(node, "this file is written in macros (xacro)")
            .label("something solid may depend on this one")
            .help("expand them first: `xacro my.sdf.xacro > my.sdf`");
        faults.push(fault);
    }
}

/// Warns of a world that is as wide as a town.
fn unit_slip(world: &World) -> Option<String> {
    let bounds = world.bounds();
    let wide = bounds.width().max(bounds.height());
    if wide < WIDEST {
        return None;
    }
    let extent = |solid: &super::Solid| {
        let outlines = solid.body.shadow(f64::NEG_INFINITY, f64::INFINITY);
        let bounds =
            outlines.iter().fold(crate::geometry::Bounds::EMPTY, |b, o| b.union(o.bounds()));
        bounds.width().max(bounds.height())
    };
    let widest = world.solids.iter().max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    Some(format!(
        "the world is {wide:.0} m wide (`{}` alone {:.0} m): are its lengths in millimetres? Metres are expected",
        widest.name,
        extent(widest)
    ))
}

/// Returns a warning as one line.
fn said(warning: &Diagnostic) -> String {
    let place = warning.location().map(|place| place + ": ").unwrap_or_default();
    format!("{place}{}", warning.message)
}

/// Returns the file's name without folders and extension.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let file = file.strip_suffix(".xacro").unwrap_or(file);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

#[cfg(test)]
mod tests;
