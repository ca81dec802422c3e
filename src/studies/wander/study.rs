//! The wandering robot behind the interface of a study.

use super::{Parameters, Setup, mission};
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::studies::recording::Recording;
use crate::studies::study::parameters;
use crate::studies::{
    ConditionAsWritten, Outcome, Setup as AnySetup, Stopwatch, Study, StudySetup, TrialRecord,
    TrialSpec,
};
use crate::table::{Column, unit_of};
use crate::world::World;
use schemars::{Schema, SchemaGenerator};
use serde_json::{Value, json};

/// The example of a study.
#[derive(Debug)]
pub struct Wander;

impl Study for Wander {
    fn name(&self) -> &'static str {
        "wander"
    }

    fn about(&self) -> &'static str {
        "An example: a robot that drives straight, and turns at random where its way is blocked."
    }

    fn defaults(&self) -> Value {
        json!(Parameters::default())
    }

    fn schema(&self, generator: SchemaGenerator) -> Schema {
        generator.into_root_schema_for::<Parameters>()
    }

    fn outcomes(&self) -> &'static [Outcome] {
        &[Outcome::TIME_LIMIT]
    }

    fn measures(&self) -> Vec<String> {
        ["distance-m", "coverage-m2", "turns", "contacts"].map(str::to_owned).to_vec()
    }

    fn measure(&self, name: &str) -> Option<Column> {
        let number = |meaning: &str| Column::number(name, unit_of(name), meaning).at_least(0.0);
        let column = match name {
            "distance-m" => number("Way that the body truly travelled"),
            "coverage-m2" => number("Floor that the body passed over"),
            "turns" => Column::count(name, "How many times the way was blocked"),
            "contacts" => Column::count(name, "How many times the body came into contact"),
            _ => return None,
        };
        Some(column.empty_where("the program failed in the trial (outcome panicked)"))
    }

    fn setup(&self, condition: &mut dyn ConditionAsWritten) -> Option<AnySetup> {
        let parameters: Option<Parameters> = parameters(condition);
        let (parameters, around) = (parameters?, condition.surroundings()?);
        let (world, robot, start) = (around.world, around.robot, around.start);
        Some(AnySetup::new(Setup { world, robot, start, parameters }))
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

    fn estimated_seconds(&self) -> f64 {
        self.parameters.mission.time_limit_s
    }

    fn run(
        &self,
        spec: &TrialSpec,
        recording: Option<&mut Recording>,
        _: &mut dyn Stopwatch,
    ) -> TrialRecord {
        mission::run(spec, self, recording)
    }
}
