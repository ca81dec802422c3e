//! What the deadline study supposes of a building: its vertices, goals and starts, and which rules a prior bears on.

use super::timing::Pace;
use crate::geometry::Point;
use crate::studies::Setup as AnySetup;
use crate::studies::deadline::build_cmdp::{Expectation, Maneuvers, Through};
use crate::studies::deadline::build_cmdp::{Motion, Speed};
use crate::studies::deadline::intersection::Intersection;
use crate::studies::deadline::mission::graph_level;
use crate::studies::deadline::rules::Rules;
use crate::studies::deadline::strategy::Strategy;
use crate::studies::deadline::{Parameters, Setup};
use crate::studies::inference::{Cells, Inference};
use crate::world::RegionKind;
use crate::world::topology::{Opening, Topology};
use serde_json::{Map, Value, json};

/// The columns that the observed table must have.
const FACTORS: [&str; 3] = ["start", "deadline-s", "strategy"];

/// Most vertices and goals of a building.
const MOST_VERTICES: usize = 255;
const MOST_GOALS: usize = 64;

/// What a prior bears on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bears {
    /// Where one strategy goes: its place among the table's.
    Strategy(usize),
    /// Where all go.
    Walk,
    /// How long that takes.
    Pace,
    /// How often it fails.
    Hazard,
}

/// A building with what is supposed of it.
pub(super) struct Model<'a> {
    pub(super) inference: &'a Inference,
    base: Value,
    calibrated: Maneuvers,
    pub(super) topology: &'a Topology,
    /// Its vertices as the IDS would report them, none a goal.
    pub(super) places: Vec<Intersection>,
    /// The vertices that may be the goal: rooms with one door.
    pub(super) goals: Vec<usize>,
    /// The number of the goal at each vertex.
    pub(super) goal_at: Vec<Option<usize>>,
    pub(super) strategies: Vec<Strategy>,
    pub(super) starts: usize,
    /// Start and deadline (s) of each column of the table.
    pub(super) columns: Vec<(usize, f64)>,
    /// The cell of each column, by strategy.
    pub(super) cells: Vec<Vec<usize>>,
    /// What each prior bears on.
    pub(super) bears: Vec<Bears>,
}

/// Returns the deadline study's own setup.
fn own(setup: &AnySetup) -> Option<&Setup> {
    setup.of::<Setup>()
}

/// Returns the graph of the building of `setup`.
pub(super) fn topology(setup: &AnySetup) -> Option<&Topology> {
    own(setup)?.prepared().ok().map(|prepared| &prepared.topology)
}

/// Returns the name and the place of a vertex.
pub(super) fn place(setup: &AnySetup, vertex: usize) -> Option<(String, Point)> {
    let vertex = topology(setup)?.vertices.get(vertex)?;
    Some((vertex.tag.clone(), vertex.at))
}

impl<'a> Model<'a> {
    /// Creates the model of the building of `setup`.
    ///
    /// # Errors
    /// What cannot be inferred in it, in a sentence, with the path of the prior that it is about.
    pub(super) fn new(
        setup: &'a AnySetup,
        inference: &'a Inference,
    ) -> Result<Self, (Option<String>, String)> {
        let refused = |why: &str| (None, why.to_owned());
        let setup = own(setup).ok_or_else(|| refused("the setup is of another study"))?;
        let prepared = setup.prepared().map_err(|why| (None, why.to_string()))?;
        let topology = &prepared.topology;
        let calibration = setup.calibration.as_ref();
        let calibration = calibration
            .ok_or_else(|| refused("an inference is of explorations, not of isolated passages"))?;
        let one_door = |vertex: usize| {
            let vertex = &topology.vertices[vertex];
            vertex.kind == RegionKind::Room
                && vertex.exits.iter().filter(|exit| exit.opening == Opening::Door).count() == 1
        };
        let count = topology.vertices.len();
        let goals: Vec<usize> = (0..count).filter(|vertex| one_door(*vertex)).collect();
        if goals.is_empty() || goals.len() > MOST_GOALS || count > MOST_VERTICES {
            return Err((
                None,
                format!(
                    "expected a building of at most {MOST_VERTICES} vertices and 1 to {MOST_GOALS} rooms of one door, found {count} \
                     and {}",
                    goals.len()
                ),
            ));
        }
        let mut goal_at = vec![None; count];
        for (number, vertex) in goals.iter().enumerate() {
            goal_at[*vertex] = Some(number);
        }
        let mut places = graph_level::places(topology);
        for place in &mut places {
            place.is_goal = false;
        }
        let mut base = json!(setup.parameters);
        if base.get("graph").is_none() {
            base["graph"] = json!(setup.parameters.graph);
        }
        let mut model = Self {
            inference,
            base,
            calibrated: calibration.maneuvers(setup.parameters.rules.side_corridors),
            topology,
            places,
            goals,
            goal_at,
            strategies: Vec::new(),
            starts: 0,
            columns: Vec::new(),
            cells: Vec::new(),
            bears: Vec::new(),
        };
        model.read_table()?;
        model.read_priors()?;
        Ok(model)
    }

    /// Finds out which cell is of which start, deadline and strategy.
    fn read_table(&mut self) -> Result<(), (Option<String>, String)> {
        let observed = &self.inference.observed;
        let missing = |name: &str| {
            (None, format!("the observed table has no column `{name}`, which this study varies"))
        };
        let mut places = [0; 3];
        for (place, name) in places.iter_mut().zip(FACTORS) {
            *place = observed.factor(name).ok_or_else(|| missing(name))?;
        }
        let [start, deadline, strategy] = places;
        let starts = observed.levels(start);
        for level in observed.levels(strategy) {
            let read = serde_json::from_value(json!(level));
            let unknown = |_| (None, format!("`{level}` is no strategy of this study"));
            self.strategies.push(read.map_err(unknown)?);
        }
        let strategies = observed.levels(strategy);
        for (index, cell) in observed.cells.iter().enumerate() {
            let place = |levels: &[&str], at: usize| {
                levels.iter().position(|level| *level == cell.levels[at]).unwrap_or_default()
            };
            let seconds: f64 = cell.levels[deadline]
                .parse()
                .map_err(|_| (None, format!("`{}` is no deadline", cell.levels[deadline])))?;
            let column = (place(&starts, start), seconds);
            let known = self.columns.iter().position(|known| *known == column);
            let known = known.unwrap_or_else(|| {
                self.columns.push(column);
                self.cells.push(vec![usize::MAX; strategies.len()]);
                self.columns.len() - 1
            });
            self.cells[known][place(&strategies, strategy)] = index;
        }
        self.starts = starts.len();
        if self.cells.iter().flatten().any(|cell| *cell == usize::MAX) {
            let why = "the observed table lacks a strategy for one of its starts and deadlines";
            return Err((None, why.to_owned()));
        }
        Ok(())
    }

    fn read_priors(&mut self) -> Result<(), (Option<String>, String)> {
        for prior in &self.inference.priors {
            let path = prior.path.as_str();
            let named = |strategy: &Strategy| {
                let name = json!(strategy);
                let group = path.strip_prefix("rules.").and_then(|rest| rest.split('.').next());
                name.as_str() == group && path.matches('.').count() > 1
            };
            let bears = if let Some(strategy) = self.strategies.iter().position(named) {
                Bears::Strategy(strategy)
            } else if path.starts_with("rules.initial-") || path == "rules.side-corridors" {
                Bears::Walk
            } else if path == "graph.entry-hazard" || path == "graph.corridor-hazard" {
                Bears::Hazard
            } else if path.starts_with("graph.")
                || path.starts_with("rules.schedule.")
                || path == "rules.unplanned-speed"
            {
                Bears::Pace
            } else {
                let why = format!("nothing at graph level depends on `parameters.{path}`");
                return Err((Some(path.to_owned()), why));
            };
            if matches!(bears, Bears::Strategy(_) | Bears::Walk) && prior.is_continuous() {
                let why =
                    format!("`parameters.{path}` decides where robots go, so it needs `values`");
                return Err((Some(path.to_owned()), why));
            }
            self.bears.push(bears);
        }
        for (index, prior) in self.inference.priors.iter().enumerate() {
            let count = prior.values().len().max(2);
            for step in 0..count {
                let share = crate::stats::real(step as u64) / crate::stats::real(count as u64 - 1);
                let mut values = vec![0.0; self.inference.priors.len()];
                for (value, other) in values.iter_mut().zip(&self.inference.priors) {
                    *value = other.at(0.5);
                }
                values[index] = prior.at(share);
                self.parameters(&values).map_err(|why| {
                    (Some(prior.path.clone()), format!("`{}`: {why}", prior.path))
                })?;
            }
        }
        Ok(())
    }

    /// Returns the study's parameters where the priors have these values.
    pub(super) fn parameters(&self, values: &[f64]) -> Result<Parameters, String> {
        let mut written = self.base.clone();
        for (prior, value) in self.inference.priors.iter().zip(values) {
            put(&mut written, &prior.path, prior.written(*value));
        }
        serde_json::from_value(written).map_err(|why| why.to_string())
    }

    /// Returns the rules of `strategy` among those `parameters`.
    pub(super) fn rules(&self, parameters: &Parameters, strategy: usize) -> Rules {
        Rules { strategy: self.strategies[strategy], ..parameters.rules.clone() }
    }

    /// Returns what maneuvers take by `parameters`.
    pub(super) fn maneuvers(&self, parameters: &Parameters) -> Maneuvers {
        let calibrated =
            Maneuvers { side_corridors: parameters.rules.side_corridors, ..self.calibrated };
        parameters.graph.maneuvers(&calibrated)
    }

    /// Returns the pace by `parameters`: doors in the mean over sides and what they are passed for.
    pub(super) fn pace(&self, parameters: &Parameters) -> Pace {
        let maneuvers = self.maneuvers(parameters);
        let doors = |speed: Speed, of: fn(Expectation) -> f64, through: &[Through]| {
            let sides = [Motion::DoorLeft, Motion::DoorRight];
            let all: Vec<f64> = sides
                .iter()
                .flat_map(|side| through.iter().map(|t| of(maneuvers.expect(*side, *t, speed))))
                .collect();
            all.iter().sum::<f64>() / crate::stats::length(&all)
        };
        let every = [Through::Entering, Through::Leaving];
        let time = |speed| doors(speed, |expected| expected.time_s, &every);
        let entering = doors(Speed::Slow, |expected| expected.failure, &[Through::Entering]);
        Pace {
            corridor: maneuvers.corridor.map(|expected| expected.time_s),
            door: [time(Speed::Slow), time(Speed::Fast)],
            entry: entering,
            other: maneuvers.corridor[0].failure,
            look_around: parameters.graph.look_around_s,
            unplanned: parameters.rules.unplanned_speed,
        }
    }
}

/// Puts `value` at the dotted `path` of `written`.
fn put(written: &mut Value, path: &str, value: Value) {
    let mut at = written;
    for key in path.split('.') {
        if !at.is_object() {
            *at = Value::Object(Map::new());
        }
        at = &mut at[key];
    }
    *at = value;
}
