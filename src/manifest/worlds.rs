//! The worlds of a manifest's conditions: which file, which layers; or which building of a family.

use super::crossing::draws;
use super::document::{
    Alpha, FactorRef, GenerateDoc, PlaceDoc, PoseDoc, SeedDoc, UpAxisDoc, WorldDoc, WorldFile,
};
use super::input::InputKind;
use super::library::{Known, normalised};
use super::models::{Roots, Shelf};
use super::readers;
use super::resolver::Resolver;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use crate::document::Source;
use crate::geometry::{Point, Pose};
use crate::units::Radians;
use crate::world::map_server::{self, solid};
use crate::world::sdf::NoModels;
use crate::world::{World, generate};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// The layer of a world that always stands.
pub(super) const WALLS: &str = "walls";

impl Resolver<'_> {
    /// Returns the world that `doc`, written at `pointer`, is for `condition`.
    pub(super) fn world(
        &mut self,
        doc: &WorldDoc,
        pointer: &str,
        condition: &Condition,
    ) -> Option<UsedWorld> {
        let (used, place) = match doc {
            WorldDoc::File(doc) => (self.world_of_file(doc, pointer, condition), &doc.place),
            WorldDoc::Generated(doc) => {
                let pointer = format!("{pointer}/generate");
                (self.generated_world(&doc.generate, &pointer, condition), &doc.place)
            }
            WorldDoc::Drawn(FactorRef { factor }) => {
                return self.drawn_world(factor, &format!("{pointer}/factor"), condition);
            }
        };
        match place {
            Some(place) => self.placed(used?, place, &format!("{pointer}/place")),
            None => used,
        }
    }

    /// Returns the world of the draw that `condition` has of `factor`, which is named at `pointer`.
    fn drawn_world(
        &mut self,
        factor: &str,
        pointer: &str,
        condition: &Condition,
    ) -> Option<UsedWorld> {
        self.faults.check_factor(&self.factors, factor, pointer, false)?;
        if draws(self.doc, factor).is_none() {
            let fault =
                self.faults.fault(pointer, format!("the values of `{factor}` are no draws"));
            let fault = fault.label("expected a factor that is `{posterior: FILE, n: N}`");
            self.faults.push(fault.help("docs/inference.md says how draws are run"));
            return None;
        }
        // Draws that could not be had have been told.
        self.draws.as_ref().filter(|draws| draws.are_of(factor))?.world(condition)
    }

    /// Returns `used` with goal and starts where `doc`, written at `pointer`, puts them.
    pub(super) fn placed(
        &mut self,
        used: UsedWorld,
        doc: &PlaceDoc,
        pointer: &str,
    ) -> Option<UsedWorld> {
        let UsedWorld { world, mut described, .. } = used;
        let pose = |at: &PoseDoc| json!([at.x_m, at.y_m, at.heading_deg]);
        let starts: Map<String, Value> =
            doc.starts.iter().map(|(name, at)| (name.clone(), pose(at))).collect();
        let goal = doc.goal.map(|at| [at.x_m, at.y_m]);
        described["place"] = json!({ "goal": goal, "starts": starts });
        let (world, meaning) = self.once(
            |library| &mut library.worlds,
            described.to_string(),
            |this| {
                let mut world = World::clone(&world);
                for (name, at) in &doc.starts {
                    let heading = Radians::from_degrees(at.heading_deg).get();
                    world.starts.insert(name.clone(), Pose::new(at.x_m, at.y_m, heading));
                }
                if let Some([x, y]) = goal
                    && !world.move_goal(Point::new(x, y))
                {
                    let message = "the world has no one goal that could be moved".to_owned();
                    let fault = this.faults.fault(&format!("{pointer}/goal"), message);
                    let label = format!("it has {} goals", world.goals.len());
                    this.faults
                        .push(fault.label(label).help("leave the goal out, or give the world one"));
                    return None;
                }
                let meaning = world.meaning();
                Some((Arc::new(world), meaning))
            },
        )?;
        Some(UsedWorld { world, meaning, described })
    }

    /// Generates a building of a family. No file is sealed for it: the manifest holds what it is made of, and how it is
    /// made belongs to the engine's version; what it means enters the trials' keys like that of any world.
    fn generated_world(
        &mut self,
        doc: &GenerateDoc,
        pointer: &str,
        condition: &Condition,
    ) -> Option<UsedWorld> {
        let seed = match &doc.seed {
            SeedDoc::Number(seed) => *seed,
            SeedDoc::Factor(FactorRef { factor }) => {
                let place = format!("{pointer}/seed/factor");
                self.faults.check_factor(&self.factors, factor, &place, false)?;
                let value = condition.value(factor)?;
                let Ok(seed) = value.parse() else {
                    let message = format!("`{value}`, a value of `{factor}`, is no seed");
                    let label = "expected a factor whose values are whole numbers from 0";
                    self.faults.at(&place, message, label);
                    return None;
                };
                seed
            }
        };
        let described = json!({ "generate": { "family": doc.family, "seed": seed } });
        let key = described.to_string();
        let (world, meaning) = self.once(
            |library| &mut library.worlds,
            key,
            |this| match generate::generate(doc.family, seed) {
                Ok(world) => {
                    let meaning = world.meaning();
                    Some((Arc::new(world), meaning))
                }
                Err(problem) => {
                    let help = "choose another seed";
                    let fault = this.faults.fault(pointer, problem.to_string()).label("made here");
                    this.faults.push(fault.help(help));
                    None
                }
            },
        )?;
        Some(UsedWorld { world, meaning, described })
    }

    fn world_of_file(
        &mut self,
        doc: &WorldFile,
        pointer: &str,
        condition: &Condition,
    ) -> Option<UsedWorld> {
        let (file, file_pointer) = self.choose(&doc.file, &format!("{pointer}/file"), condition)?;
        let layers = match &doc.layers {
            None => None,
            Some(layers) => Some(self.choose(layers, &format!("{pointer}/layers"), condition)?),
        };
        let mut described = json!({
            "file": normalised(file),
            "layers": layers.as_ref().map(|(layers, _)| layers),
        });
        if !doc.models.is_empty() {
            described["models"] = json!(doc.models);
        }
        if !doc.model_path.is_empty() {
            described["model-path"] = json!(doc.model_path);
        }
        if !doc.without.is_empty() {
            described["without"] = json!(doc.without);
        }
        if doc.up_axis == UpAxisDoc::AsWritten {
            described["up-axis"] = json!("as-written");
        }
        if !doc.stand_ins.is_empty() {
            described["stand-ins"] = json!(doc.stand_ins);
        }
        if let Some(unknown) = doc.unknown {
            described["unknown"] = json!(unknown);
        }
        let written_in = self.faults.written_in(&file_pointer);
        let key = json!([described, written_in]).to_string();
        let (world, meaning) = self.once(
            |library| &mut library.worlds,
            key,
            |this| this.read_world(doc, pointer, (file, &file_pointer), layers.as_ref()),
        )?;
        Some(UsedWorld { world, meaning, described })
    }

    fn read_world(
        &mut self,
        doc: &WorldFile,
        place: &str,
        (file, pointer): (&str, &str),
        layers: Option<&(&Vec<String>, String)>,
    ) -> Known<World> {
        let source = self.text(file, pointer, InputKind::World)?;
        if map_server::is_descriptor(&source.text) {
            let grid = self.grid(&source, file, pointer, InputKind::World, Alpha::default())?;
            let mut world = solid::world(file, &grid, doc.unknown.unwrap_or_default());
            if let Some((layers, pointer)) = layers {
                world = self.choose_layers(world, &source, layers, pointer);
            }
            let meaning = world.meaning();
            return Some((Arc::new(world), meaning));
        }
        if doc.unknown.is_some() {
            let place = format!("{place}/unknown");
            let fault = self.faults.key_fault(&place, format!("`{file}` has no unknown cells"));
            let label = "of a world that is a `map_server` map";
            self.faults.push(fault.label(label).help("remove this key"));
        }
        let stand_ins = self.stand_ins(doc, place);
        let world = (normalised(file), self.faults.written_in(pointer));
        let roots = Roots {
            world,
            models: self.faults.written_in(&format!("{place}/models")),
            model_path: self.faults.written_in(&format!("{place}/model-path")),
        };
        let mut shelf = Shelf::new(doc, roots, &mut self.library, stand_ins);
        let read = readers::world(&source, None, &mut shelf);
        let told = shelf.told();
        self.told_by(told, doc, place);
        let mut world = self.told(read)?;
        if world.missing() > 0 {
            let message = format!("`{file}` is incomplete (things missing: {})", world.missing());
            let fault = self.faults.fault(pointer, message);
            self.faults.push(fault.label("nothing sees or touches them").warning());
        }
        for warning in &world.warnings {
            let fault = self.faults.fault(pointer, warning.clone()).label("in this world");
            self.faults.push(fault.warning());
        }
        if let Some((layers, pointer)) = layers {
            world = self.choose_layers(world, &source, layers, pointer);
        }
        let meaning = world.meaning();
        Some((Arc::new(world), meaning))
    }

    /// Returns `world` with its walls and `layers` alone; collects faults where there is no such layer.
    fn choose_layers(
        &mut self,
        mut world: World,
        source: &Source,
        layers: &[String],
        pointer: &str,
    ) -> World {
        let known: Vec<String> = world.layers().iter().map(|l| (*l).to_owned()).collect();
        let unknown = |layer: &String| !known.contains(layer);
        if layers.iter().any(unknown) {
            // A layer may be there and hold nothing.
            if source.name.ends_with(".yaml")
                && let Ok(world) = readers::world(source, Some(layers), &mut NoModels)
            {
                return world;
            }
        }
        for (i, layer) in layers.iter().enumerate().filter(|(_, layer)| unknown(layer)) {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let message = format!("unknown layer `{layer}`");
            let label = format!("not a layer of `{}`", source.name);
            self.faults.unknown(&format!("{pointer}/{i}"), message, &label, layer, &known);
        }
        world.solids.retain(|solid| solid.layer == WALLS || layers.contains(&solid.layer));
        world
    }
}
