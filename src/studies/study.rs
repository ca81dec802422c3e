//! What a study is to the rest of the program.
//!
//! A study is a folder here, and one entry in [`STUDIES`]: what it is called, which parameters it has, what it makes of a
//! manifest's condition, how its trials run and end, and what they measure. Nothing outside its folder names it, but for the
//! layouts of tables and figures that are its own.

use super::inference::Proposing;
use super::prior_map::{self, CoverageMap, SharedReference, tour::TopoMetricMap};
use super::recording::Recording;
use super::{Calibrating, Expectations, Outcome, STUDIES, TrialRecord, TrialSpec};
use crate::geometry::Pose;
use crate::grid::OccupancyGrid;
use crate::robot::Robot;
use crate::table::Column;
use crate::world::World;
use crate::world::topology::{TagFault, TagScheme, Topology};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use std::any::Any;
use std::borrow::Cow;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A study: how its manifests are read, and what its trials are.
pub trait Study: Sync {
    /// Returns the name in manifests, keys and streams.
    fn name(&self) -> &'static str;

    /// Returns the publication and its subject in one line.
    fn about(&self) -> &'static str;

    /// Returns the parameters with every default written out: an object of groups, in which what is an object is a group.
    fn defaults(&self) -> Value;

    /// Returns the schema of the parameters.
    fn schema(&self, generator: SchemaGenerator) -> Schema;

    /// Returns the keys of a manifest, among those that not every study has, that mean something here: `prior`,
    /// `prior-maps`, `calibration`.
    fn keys(&self) -> &'static [&'static str] {
        &[]
    }

    /// Returns the names of the layouts of tables and figures that show what only this study has.
    fn layouts(&self) -> &'static [&'static str] {
        &[]
    }

    /// Returns how trials end that are no fault of the program.
    fn outcomes(&self) -> &'static [Outcome];

    /// Returns how trials end besides, where parameters ask for it ([`StudySetup::further_outcomes`]).
    fn further_outcomes(&self) -> &'static [Outcome] {
        &[]
    }

    /// Returns the names of every measure that a trial can have, but for those that parameters make
    /// ([`StudySetup::further_measures`]).
    fn measures(&self) -> Vec<String>;

    /// Returns what the measure `name` is; `None` where no trial of this study has it.
    fn measure(&self, name: &str) -> Option<Column>;

    /// Returns whether `name` is that of a measure which parameters may ask for.
    fn is_further_measure(&self, _name: &str) -> bool {
        false
    }

    /// Returns the revision of what its trials alone rest on, raised whenever the record of any of them changes; 0 where
    /// that never happened apart from the engine's version.
    fn revision(&self) -> u32 {
        0
    }

    /// Returns how it learns from calibrations; `None` where its trials rest on none.
    fn calibrating(&self) -> Option<&'static dyn Calibrating> {
        None
    }

    /// Returns how it proposes for an inference; `None` where it does not.
    fn proposing(&self) -> Option<&'static dyn Proposing> {
        None
    }

    /// Returns whether trials have curves: points of time, distance and coverage.
    fn has_series(&self) -> bool {
        false
    }

    /// Returns whether the mind's choices are timed, for claims about the machine.
    fn times_choices(&self) -> bool {
        false
    }

    /// Returns how many seconds of it one processor simulates in a second, as a rule: measured with the shipped manifests, where
    /// worlds and filters make it two or three times more or less. Estimates of time rest on it, and nothing else.
    fn pace(&self) -> f64 {
        5000.0
    }

    /// Makes what the trials of a condition need. `None` where that cannot be had, which has been reported then.
    fn setup(&self, condition: &mut dyn ConditionAsWritten) -> Option<Setup>;
}

/// Robot, world and start: what the trials of every study need.
#[derive(Debug, Clone)]
pub struct Surroundings {
    /// The robot.
    pub robot: Arc<Robot>,
    /// The true world.
    pub world: Arc<World>,
    /// Where the robot begins, in the world's frame (m, rad).
    pub start: Pose,
}

/// Prior knowledge of a condition.
#[derive(Debug, Clone)]
pub enum Prior {
    /// A map in the world's frame.
    Map(Arc<OccupancyGrid>),
    /// A graph of places in the world's frame.
    TopoMetric(Arc<TopoMetricMap>),
}

/// The graph of a world, or what is wrong with its tags.
pub type Graph = Result<Arc<Topology>, Arc<[TagFault]>>;

/// A condition as the manifest has it. What cannot be had is told by whoever is asked, and is then `None`.
pub trait ConditionAsWritten {
    /// Returns what the manifest writes as the study's parameters, for this condition.
    fn parameters(&self) -> Value;

    /// Reports that those are no parameters of the study, for this `reason`.
    fn refuse_parameters(&mut self, reason: String);

    /// Returns robot, world and start.
    fn surroundings(&self) -> Option<Surroundings>;

    /// Returns the prior knowledge that the manifest chooses, `Some(None)` where it chooses none.
    fn prior(&mut self, own: &prior_map::Parameters) -> Option<Option<Prior>>;

    /// Returns the map that coverage is counted against, in the world's frame; `Some(None)` where `own` names none.
    fn coverage_map(&mut self, own: &prior_map::Parameters) -> Option<Option<CoverageMap>>;

    /// Returns what coverage is measured against together with every other condition of these `parameters`, robot, world and
    /// start.
    fn reference(&mut self, parameters: &Value) -> SharedReference;

    /// Returns the graph that the world's tags make by `scheme`: the same for every condition in that world.
    fn graph(&mut self, scheme: &TagScheme) -> Option<Graph>;

    /// Returns what follows from what the manifest's `calibration` measured.
    fn calibration(&mut self) -> Option<Expectations>;

    /// Reports what is wrong or looks wrong.
    fn tell(&mut self, remark: Remark);
}

/// Reads the parameters of a condition.
pub(super) fn parameters<P: DeserializeOwned>(condition: &mut dyn ConditionAsWritten) -> Option<P> {
    match serde_json::from_value(condition.parameters()) {
        Ok(parameters) => Some(parameters),
        Err(error) => {
            condition.refuse_parameters(error.to_string());
            None
        }
    }
}

/// Something that is well-formed and cannot be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// JSON pointer from the manifest's root to the value it is about.
    pub pointer: &'static str,
    /// What is wrong.
    pub message: String,
    /// What is expected.
    pub label: String,
    /// What to do, where that can be said.
    pub help: Option<String>,
}

/// Everything the trials of one condition need.
pub trait StudySetup: Any + fmt::Debug + Send + Sync {
    /// Returns the true world.
    fn world(&self) -> &World;

    /// Returns the robot.
    fn robot(&self) -> &Robot;

    /// Returns where the robot begins, in the world's frame (m, rad).
    fn start(&self) -> Pose;

    /// Returns the study's parameters, defaults written out.
    fn parameters(&self) -> Value;

    /// Returns what else a trial depends on, by name: nothing of it is in robot, world, prior, start or parameters.
    fn further(&self) -> Map<String, Value> {
        Map::new()
    }

    /// Returns the names of measures that these parameters ask for.
    fn further_measures(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns how trials can end by these parameters, besides the study's own ways.
    fn further_outcomes(&self) -> &'static [Outcome] {
        &[]
    }

    /// Returns whether its trials are of a model that proposes, never of the study itself: no table, figure or claim may rest on
    /// them.
    fn is_model(&self) -> bool {
        false
    }

    /// Estimates how long (s of simulated time) a trial takes, to deal trials to machines evenly: from what the manifest says
    /// alone, so that every machine estimates the same. Only its ratio to other conditions' matters.
    fn estimated_seconds(&self) -> f64 {
        1.0
    }

    /// Runs a trial under the eyes of `watch`, writing everything down in `recording` where there is one: a pure function of
    /// `spec` and this setup. The record is the same either way.
    fn run(
        &self,
        spec: &TrialSpec,
        recording: Option<&mut Recording>,
        watch: &mut dyn Stopwatch,
    ) -> TrialRecord;
}

/// Times parts of a trial, for claims about the machine. No record depends on it.
pub trait Stopwatch {
    /// Takes note that a mind is asked what to do next.
    fn asked(&mut self);
    /// Takes note that the mind, to answer, chose where to go.
    fn chose(&mut self);
}

/// Nobody takes the time.
impl Stopwatch for () {
    fn asked(&mut self) {}
    fn chose(&mut self) {}
}

/// The setup of a condition, shared by all its trials.
#[derive(Debug, Clone)]
pub struct Setup(Arc<dyn StudySetup>);

impl Setup {
    /// Creates the setup of any study.
    pub fn new(setup: impl StudySetup) -> Self {
        Self(Arc::new(setup))
    }

    /// Returns the setup as that of one study; `None` where it is another's.
    pub fn of<S: StudySetup>(&self) -> Option<&S> {
        let setup: &dyn Any = &*self.0;
        setup.downcast_ref()
    }
}

impl Deref for Setup {
    type Target = dyn StudySetup;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

/// Which study a manifest describes: one of [`STUDIES`].
#[derive(Clone, Copy)]
pub struct StudyKind(&'static dyn Study);

impl StudyKind {
    /// Returns every study.
    pub fn all() -> impl Iterator<Item = Self> {
        STUDIES.iter().map(|study| Self(*study))
    }

    /// Returns the study of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|kind| kind.name() == name)
    }
}

impl Deref for StudyKind {
    type Target = dyn Study;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl PartialEq for StudyKind {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for StudyKind {}

impl fmt::Debug for StudyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for StudyKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for StudyKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name: Cow<'_, str> = Cow::deserialize(deserializer)?;
        Self::named(&name).ok_or_else(|| D::Error::custom(format!("no study `{name}`")))
    }
}

impl JsonSchema for StudyKind {
    fn schema_name() -> Cow<'static, str> {
        "StudyKind".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let known: Vec<Value> = Self::all()
            .map(|kind| {
                serde_json::json!({
                    "type": "string",
                    "const": kind.name(),
                    "description": kind.about(),
                })
            })
            .collect();
        json_schema!({ "description": "Which study a manifest describes.", "oneOf": known })
    }
}
