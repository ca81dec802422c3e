//! Prior knowledge PK_E: a map file aligned to the world, what is derived from a world, or a graph of places in it.

use super::choice::Choice;
use super::document::{
    Alpha, DerivedFrom, MapPrior, OwnWorld, PriorDoc, PriorFrame, TopoMetricPrior, UnknownAs,
};
use super::faults::step;
use super::input::InputKind;
use super::knowledge::{Exploration, Knowledge, Told, UsedPrior, meaning, read_as};
use super::library::{Known, joined, normalised};
use super::previous;
use super::readers::{self, Derived};
use super::resolver::Resolver;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use crate::document::{Source, suggestion};
use crate::geometry::{Point, Pose};
use crate::grid::{GridFrame, OccupancyGrid};
use crate::robot::Robot;
use crate::studies::prior_map::{MapFrame, Parameters};
use crate::world::floor_plan::FloorPlanSettings;
use crate::world::map_server::{Descriptor, bag};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// The factor that chooses among prior maps, and the choice of none.
const FACTOR: &str = "prior";
pub(super) const NONE: &str = "none";

impl<'a> Resolver<'a> {
    /// Collects the faults of the names of prior maps.
    pub(super) fn check_prior_names(&mut self) {
        let doc = self.doc;
        let mut known: Vec<&str> = vec![NONE];
        known.extend(doc.prior_maps.keys().map(String::as_str));
        if doc.prior_maps.contains_key(NONE) {
            let message = "`none` stands for no prior map and cannot name one";
            self.faults.at_key("/prior-maps/none", message, "choose another name");
        }
        let chosen: Vec<(String, String)> = match self.factors.iter().find(|f| f.name == FACTOR) {
            Some(factor) => {
                if doc.prior.is_some() {
                    let message = "the factor `prior` chooses the prior map already";
                    self.faults.at_key("/prior", message, "remove this key");
                }
                let places = factor.values.iter().enumerate();
                places.map(|(i, v)| (format!("/factors/prior/{i}"), v.clone())).collect()
            }
            None => doc.prior.iter().map(|name| ("/prior".to_owned(), name.clone())).collect(),
        };
        let then = previous::priors_then(doc);
        let then = then.iter().map(|(place, name)| (place.clone(), (*name).to_owned()));
        let named: Vec<_> = chosen.iter().cloned().chain(then).collect();
        let there: BTreeSet<&str> = known.iter().copied().collect();
        let mut meant = BTreeSet::new();
        for (pointer, name) in &named {
            if there.contains(name.as_str()) {
                meant.insert(name.as_str());
                continue;
            }
            if !self.faults.is_full() {
                // A misspelled name is one fault, not two.
                meant.extend(suggestion(name, known.iter().copied()));
            }
            let message = format!("unknown prior map `{name}`");
            let label = "neither `none` nor a key of `prior-maps`";
            self.faults.unknown(pointer, message, label, name, &known);
        }
        for name in doc.prior_maps.keys().filter(|name| !meant.contains(name.as_str())) {
            let message = format!("the prior map `{name}` is not used");
            let label = "not a value of the factor `prior`";
            self.faults.warn_at_key(&step("/prior-maps", name), message, label);
        }
    }

    /// Returns the prior knowledge of `condition`, where it has some.
    ///
    /// # Errors
    /// Where it could not be had.
    pub(super) fn prior(
        &mut self,
        condition: &Condition,
        world: &UsedWorld,
        robot: &Arc<Robot>,
        start: Pose,
        parameters: &Parameters,
    ) -> Result<Option<Knowledge>, Told> {
        let name = condition.value(FACTOR).or(self.doc.prior.as_deref()).unwrap_or(NONE);
        let whole = Exploration { condition, world, robot, start, parameters };
        self.prior_called(name, &whole, &mut Vec::new())
    }

    /// Returns the prior knowledge `name` as `exploration` uses it. `before` are the prior maps that are made of it.
    pub(super) fn prior_called<'d>(
        &mut self,
        name: &'d str,
        exploration: &Exploration<'_>,
        before: &mut Vec<&'d str>,
    ) -> Result<Option<Knowledge>, Told>
    where
        'a: 'd,
    {
        let Exploration { condition, world, robot, start, parameters } = *exploration;
        let doc = self.doc;
        if name == NONE {
            return Ok(None);
        }
        let choice: &Choice<PriorDoc> = doc.prior_maps.get(name).ok_or(Told)?;
        let (prior, pointer) =
            self.choose(choice, &step("/prior-maps", name), condition).ok_or(Told)?;
        let derived = |kind: Derived, from: &'_ DerivedFrom, resolution: Option<f64>| {
            (kind, from.clone(), resolution.unwrap_or(parameters.mapping.resolution_m))
        };
        let (kind, from, resolution) = match prior {
            PriorDoc::Map(map) => {
                let map = self.map(map, &pointer, start).ok_or(Told)?;
                return Ok(Some(Knowledge::Map(map)));
            }
            PriorDoc::TopoMetric(graph) => {
                return self.topo_metric_map(graph, &pointer).map(Some).ok_or(Told);
            }
            PriorDoc::Previous(of) => {
                before.push(name);
                let found = self.previous_map(&of.previous_map, &pointer, exploration, before);
                before.pop();
                return found.map(|map| Some(Knowledge::Map(map)));
            }
            PriorDoc::FloorPlan(p) => derived(Derived::FloorPlan, &p.floor_plan_of, p.resolution_m),
            PriorDoc::Footprint(p) => derived(Derived::Footprint, &p.footprint_of, p.resolution_m),
            PriorDoc::BoundingBox(p) => {
                derived(Derived::BoundingBox, &p.bounding_box_of, p.resolution_m)
            }
        };
        let own = matches!(from, DerivedFrom::Own(OwnWorld::World));
        let of = match &from {
            DerivedFrom::Own(OwnWorld::World) => world.clone(),
            DerivedFrom::Other(other) => {
                let place = step(&pointer, kind.key());
                self.world(other, &place, condition).ok_or(Told)?
            }
        };
        let described = json!({
            kind.key(): if own { json!("world") } else { of.described.clone() },
            "resolution-m": resolution,
        });
        // Without a scanner there is no height to cut at; the lint says so.
        let height = robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
        let cache = json!([described, of.meaning, height]).to_string();
        let plan = FloorPlanSettings { height, resolution, layers: None };
        let known = self.once(
            |library| &mut library.grids,
            cache,
            |this| match kind.draw(&of.world, plan) {
                Ok(grid) => {
                    let meaning = meaning(&grid);
                    Some((Arc::new(grid), meaning))
                }
                Err(problem) => {
                    let fault =
                        this.faults.fault(&pointer, problem.to_string()).label("derived here");
                    this.faults.push(fault);
                    None
                }
            },
        );
        let (grid, meaning) = known.ok_or(Told)?;
        // Footprints and boxes leave most walls out by what they are: that few have one in the world is no slip.
        let own = own || kind != Derived::FloorPlan;
        Ok(Some(Knowledge::Map(UsedPrior { grid, meaning, described, pointer, own })))
    }

    /// Reads a topo-metric map, for every condition anew: it is small.
    fn topo_metric_map(&mut self, doc: &TopoMetricPrior, pointer: &str) -> Option<Knowledge> {
        let place = format!("{pointer}/topo-metric-map");
        let source = self.text(&doc.topo_metric_map, &place, InputKind::Prior)?;
        let graph = self.told(readers::topo_metric_map(&source))?;
        let described = json!({ "topo-metric-map": normalised(&doc.topo_metric_map) });
        let meaning = graph.meaning();
        Some(Knowledge::TopoMetric(Arc::new(graph), meaning, described))
    }

    fn map(&mut self, doc: &MapPrior, pointer: &str, start: Pose) -> Option<UsedPrior> {
        let places = [format!("{pointer}/map"), format!("{pointer}/frame")];
        let described = described(doc);
        let (grid, meaning) = self.map_in_world(doc, &places, start)?;
        let pointer = pointer.to_owned();
        Some(UsedPrior { grid, meaning, described, pointer, own: false })
    }

    /// Returns the map at `path`, as the parameters of a condition name it, in the world's frame.
    pub(super) fn coverage_map(
        &mut self,
        path: &str,
        frame: MapFrame,
        start: Pose,
    ) -> Known<OccupancyGrid> {
        let places = ["coverage-map", "coverage-map-frame"]
            .map(|key| format!("/parameters/measurement/{key}"));
        let frame = match frame {
            MapFrame::Start => PriorFrame::Start,
            MapFrame::World => PriorFrame::World,
        };
        let doc = MapPrior {
            map: path.to_owned(),
            topic: None,
            frame,
            origin: None,
            alpha: Alpha::default(),
            unknown: UnknownAs::default(),
        };
        self.map_in_world(&doc, &places, start)
    }

    /// Reads a map; `places` are those of its path and its frame.
    fn map_in_world(
        &mut self,
        doc: &MapPrior,
        [place, frame_place]: &[String; 2],
        start: Pose,
    ) -> Known<OccupancyGrid> {
        let shift = match doc.frame {
            PriorFrame::World => Point::ZERO,
            PriorFrame::Start => start.position(),
        };
        if doc.frame == PriorFrame::Start && start.heading != 0.0 {
            let message = "a map in the start's frame needs a start that faces along x";
            let fault = self.faults.fault(frame_place, message);
            let label = format!("the start is turned by {} degrees", start.heading.to_degrees());
            let key = frame_place.rsplit('/').next().unwrap_or_default();
            let help = format!("turn the image, or use `{key}: world`");
            self.faults.push(fault.label(label).help(help));
            return None;
        }
        let cache = json!([described(doc), self.faults.written_in(place), shift]).to_string();
        self.once(|library| &mut library.grids, cache, |this| this.read_map(doc, place, shift))
    }

    fn read_map(&mut self, doc: &MapPrior, place: &str, shift: Point) -> Known<OccupancyGrid> {
        let grid = if is_bag(&doc.map) {
            self.grid_of_bag(doc, place)?
        } else {
            let source = self.text(&doc.map, place, InputKind::Prior)?;
            if doc.topic.is_some() {
                let fault = self.faults.fault(place, format!("`{}` has no topics", doc.map));
                let label = "`topic` chooses among those of a bag (.mcap)";
                self.faults.push(fault.label(label).help("leave `topic` out"));
            }
            self.grid(&source, &doc.map, place, InputKind::Prior, doc.alpha)?
        };
        let origin = doc.origin.map_or(grid.frame().origin, |o| Point::new(o.x_m, o.y_m));
        let frame = GridFrame { origin: origin + shift, ..*grid.frame() };
        Some(read_as(&grid, frame, doc.unknown))
    }
}

impl Resolver<'_> {
    /// Reads the grid of a bag.
    fn grid_of_bag(&mut self, doc: &MapPrior, place: &str) -> Option<OccupancyGrid> {
        let path = normalised(&doc.map);
        let bytes = self.bytes(&path, InputKind::Prior, &path, place)?;
        match bag::read_bag(&bytes, doc.topic.as_deref()) {
            Ok(grid) => Some(grid),
            Err(why) => {
                let fault = self.faults.fault(place, format!("no map in the bag `{path}`"));
                self.faults.push(fault.label(why.to_string()));
                None
            }
        }
    }

    /// Reads the map that `source`, the text of `file` named at `place`, describes, with its image beside it.
    pub(super) fn grid(
        &mut self,
        source: &Source,
        file: &str,
        place: &str,
        kind: InputKind,
        alpha: Alpha,
    ) -> Option<OccupancyGrid> {
        let descriptor = self.told(Descriptor::read(source))?;
        self.faults.extend(descriptor.warnings().to_vec());
        let path = joined(&normalised(file), descriptor.image());
        let bytes = self.bytes(&path, kind, &path, place)?;
        let grid = self.told(readers::map(&descriptor, &path, &bytes, alpha))?;
        self.faults.extend(descriptor.doubt(&grid));
        Some(grid)
    }
}

/// Returns whether the name of a map's file is that of a bag.
fn is_bag(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
}

fn described(doc: &MapPrior) -> Value {
    let mut described = json!({
        "map": normalised(&doc.map),
        "frame": doc.frame,
        "origin": doc.origin.map(|o| json!({ "x-m": o.x_m, "y-m": o.y_m })),
        "alpha": doc.alpha,
        "unknown": doc.unknown,
    });
    if let Some(topic) = &doc.topic {
        described["topic"] = json!(topic);
    }
    described
}
