//! The deadline study behind the interface of a study.

use super::mission::graph_level::MARK;
use super::mission::proposal::AtGraphLevel;
use super::mission::{self, lints};
use super::{
    Calibration, Calibrations, GraphLevel, Isolated, Parameters, Setup, Simulation, Task, columns,
};
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::studies::inference::Proposing;
use crate::studies::recording::Recording;
use crate::studies::study::parameters;
use crate::studies::{
    Calibrating, ConditionAsWritten, End, Outcome, Setup as AnySetup, Stopwatch, Study, StudySetup,
    TrialRecord, TrialSpec,
};
use crate::table::Column;
use crate::world::World;
use schemars::{Schema, SchemaGenerator};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// Susa Rincon and Carpin 2019.
#[derive(Debug)]
pub struct Deadline;

impl Outcome {
    /// Deadline: the robot arrived at the goal in time; in a passage, at the end of it.
    pub const REACHED: Self =
        Self::new("reached", End::Success, "the robot arrived at the goal in time");
    /// Deadline: the body came into contact with something.
    pub const COLLIDED: Self =
        Self::new("collided", End::Failure, "the body came into contact with something");
    /// Deadline: the time was up, though new places were still being found.
    pub const LATE: Self =
        Self::new("late", End::TimeUp, "the time was up while new places were still being found");
    /// Deadline: the time was up, and no new place had been found for long; or nothing was left to do.
    pub const STALLED: Self = Self::new(
        "stalled",
        End::Idle,
        "the time was up and no new place had been found for long, or nothing was left to do",
    );
}

impl Study for Deadline {
    fn name(&self) -> &'static str {
        "deadline"
    }

    fn about(&self) -> &'static str {
        "Susa Rincon and Carpin 2019: exploration under a deadline."
    }

    fn defaults(&self) -> Value {
        let mut defaults = json!(Parameters::default());
        // What came later is left out of a trial's key where it is as before, and can be written nevertheless.
        defaults["graph"] = json!(GraphLevel::default());
        defaults["mission"]["simulation"] = json!(Simulation::default());
        defaults
    }

    fn schema(&self, generator: SchemaGenerator) -> Schema {
        generator.into_root_schema_for::<Parameters>()
    }

    fn keys(&self) -> &'static [&'static str] {
        &["calibration"]
    }

    fn layouts(&self) -> &'static [&'static str] {
        &["maneuver-table", "policy-graph"]
    }

    fn outcomes(&self) -> &'static [Outcome] {
        &[Outcome::REACHED, Outcome::COLLIDED, Outcome::LATE, Outcome::STALLED]
    }

    /// Returns 1: side corridors by the maneuver of doors, counts by what was passed.
    fn revision(&self) -> u32 {
        1
    }

    fn calibrating(&self) -> Option<&'static dyn Calibrating> {
        Some(&Isolated)
    }

    fn proposing(&self) -> Option<&'static dyn Proposing> {
        Some(&AtGraphLevel)
    }

    fn measures(&self) -> Vec<String> {
        columns::measures()
    }

    fn measure(&self, name: &str) -> Option<Column> {
        if name == MARK {
            let meaning =
                "1: the trial is of a model of the study, on the building's graph, and no result";
            return Some(
                Column::count(name, meaning).empty_where("the program failed in the trial"),
            );
        }
        columns::measure(name)
    }

    fn is_further_measure(&self, name: &str) -> bool {
        name == MARK
    }

    fn setup(&self, condition: &mut dyn ConditionAsWritten) -> Option<AnySetup> {
        let parameters: Parameters = parameters(condition)?;
        let stated =
            parameters.mission.simulation == Simulation::Graph && parameters.graph.is_complete();
        let calibration = match parameters.mission.task {
            Task::Exploration if !stated => Some(condition.calibration()),
            Task::Exploration | Task::Passage => None,
        };
        let around = condition.surroundings()?;
        let calibration = match calibration {
            Some(expected) => {
                let measured = expected?.of::<Calibrations>()?;
                let here = measured.of(&around.world);
                if here.is_none() {
                    condition.tell(lints::not_measured_in(&around.world, &measured));
                }
                Some(here?)
            }
            None if stated => {
                let maneuvers = parameters.graph.stated(parameters.rules.side_corridors);
                Some(Arc::new(Calibration::assumed(&maneuvers)))
            }
            None => None,
        };
        let setup = Setup::new(around.world, around.robot, around.start, calibration, parameters);
        let graph = condition.graph(&mission::tag_scheme(&setup))?;
        for remark in lints::remarks(&setup, graph.as_deref().map_err(|faults| &**faults)) {
            condition.tell(remark);
        }
        Some(AnySetup::new(setup))
    }
}

impl StudySetup for Setup {
    fn world(&self) -> &World {
        &self.world
    }

    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn start(&self) -> Pose {
        self.start
    }

    fn parameters(&self) -> Value {
        json!(self.parameters)
    }

    fn further(&self) -> Map<String, Value> {
        let calibration = self.calibration.iter();
        calibration.map(|known| ("maneuvers".to_owned(), known.to_json())).collect()
    }

    fn is_model(&self) -> bool {
        self.parameters.mission.task == Task::Exploration
            && self.parameters.mission.simulation == Simulation::Graph
    }

    fn further_measures(&self) -> Vec<String> {
        if self.is_model() { vec![MARK.to_owned()] } else { Vec::new() }
    }

    fn estimated_seconds(&self) -> f64 {
        // Where it does not end before.
        match self.parameters.mission.task {
            Task::Exploration => self.parameters.mission.deadline_s,
            Task::Passage => self.parameters.passage.time_limit_s,
        }
    }

    fn run(
        &self,
        spec: &TrialSpec,
        recording: Option<&mut Recording>,
        watch: &mut dyn Stopwatch,
    ) -> TrialRecord {
        mission::run(spec, self, recording, watch)
    }
}
