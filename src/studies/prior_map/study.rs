//! The prior-knowledge study behind the interface of a study.

use super::mission::{
    self, at_level, columns, coverage_at_distance, is_coverage_at_distance, level_of,
};
use super::{Parameters, ReferenceMap, Setup, Strategy};
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::studies::recording::Recording;
use crate::studies::study::parameters;
use crate::studies::{
    ConditionAsWritten, End, Outcome, Prior, Remark, Setup as AnySetup, Stopwatch, Study,
    StudySetup, TrialRecord, TrialSpec,
};
use crate::table::Column;
use crate::world::World;
use schemars::{Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

/// Luperto et al. 2020.
#[derive(Debug)]
pub struct PriorMap;

impl Outcome {
    /// Prior map: no frontier is left that the robot could go to.
    pub const EXPLORED: Self =
        Self::new("explored", End::Success, "no frontier was left that the robot could go to");
    /// Prior map: no frontier is left but those given up, and most of the floor was never seen.
    pub const GAVE_UP: Self = Self::new(
        "gave-up",
        End::Failure,
        "the robot gave up every frontier before half of what can be seen was covered",
    );
    /// Prior map: as much was covered as the manifest asks for.
    pub const COVERED: Self = Self::new(
        "covered",
        End::Success,
        "the coverage was reached at which the manifest has runs stopped",
    );
    /// Prior map: the robot could not go on to any frontier, or made no progress.
    pub const STUCK: Self = Self::new(
        "stuck",
        End::Failure,
        "the robot could not go on to any frontier, or made no progress",
    );
}

impl Study for PriorMap {
    fn name(&self) -> &'static str {
        "prior-map"
    }

    fn about(&self) -> &'static str {
        "Luperto et al. 2020: exploration with prior knowledge."
    }

    fn pace(&self) -> f64 {
        // The mind takes most of it: a quickstart goes at four times this, 30 particles at half.
        400.0
    }

    fn defaults(&self) -> Value {
        json!(Parameters::default())
    }

    fn schema(&self, generator: SchemaGenerator) -> Schema {
        generator.into_root_schema_for::<Parameters>()
    }

    fn keys(&self) -> &'static [&'static str] {
        &["prior", "prior-maps"]
    }

    fn layouts(&self) -> &'static [&'static str] {
        &[
            "coverage-table",
            "agreement-table",
            "readings-table",
            "effects-table",
            "measures-table",
            "coverage-curve",
            "world-plan",
            "prior-over-world",
        ]
    }

    fn outcomes(&self) -> &'static [Outcome] {
        &[Outcome::EXPLORED, Outcome::GAVE_UP, Outcome::STUCK, Outcome::TIME_LIMIT]
    }

    /// Returns 1: what beams tell that come back with nothing, and trials that give up early.
    fn revision(&self) -> u32 {
        1
    }

    fn further_outcomes(&self) -> &'static [Outcome] {
        &[Outcome::COVERED]
    }

    fn measures(&self) -> Vec<String> {
        columns::measures()
    }

    fn measure(&self, name: &str) -> Option<Column> {
        columns::measure(name)
    }

    fn is_further_measure(&self, name: &str) -> bool {
        is_coverage_at_distance(name) || level_of(name).is_some()
    }

    fn has_series(&self) -> bool {
        true
    }

    fn times_choices(&self) -> bool {
        true
    }

    fn setup(&self, condition: &mut dyn ConditionAsWritten) -> Option<AnySetup> {
        let parameters: Option<Parameters> = parameters(condition);
        // Every part has reported its faults by now; the prior needs them all.
        let (parameters, around) = (parameters?, condition.surroundings()?);
        let knowledge = condition.prior(&parameters)?;
        let coverage_map = condition.coverage_map(&parameters)?;
        let alike = match parameters.measurement.reference {
            ReferenceMap::Ideal => {
                Parameters { exploration: Parameters::default().exploration, ..parameters.clone() }
            }
            ReferenceMap::Robot => mission::of_reference(&parameters),
        };
        let reference = condition.reference(&json!(alike));
        let (map, graph) = match knowledge {
            Some(Prior::Map(map)) => (Some(map), None),
            Some(Prior::TopoMetric(graph)) => (None, Some(graph)),
            None => (None, None),
        };
        let setup = Setup::new(around.world, around.robot, map, around.start, parameters)
            .with_topo_metric_map(graph)
            .with_coverage_map(coverage_map)
            .with_reference(reference);
        for remark in median(&setup).into_iter().chain(tour(&setup)) {
            condition.tell(remark);
        }
        Some(AnySetup::new(setup))
    }
}

/// Returns remarks on tours: one needs a graph, and a graph is of no use to anything else.
fn tour(setup: &Setup) -> Vec<Remark> {
    let exploration = &setup.parameters.exploration;
    let is_toured = exploration.strategy == Strategy::TopoMetricTour;
    let mut remarks = Vec::new();
    let mut remark = |pointer, message: &str, label: &str, help: Option<&str>| {
        let (message, label) = (message.to_owned(), label.to_owned());
        remarks.push(Remark { pointer, message, label, help: help.map(str::to_owned) });
    };
    let pointer = "/parameters/exploration/strategy";
    if is_toured && setup.topo_metric_map.is_none() {
        remark(
            pointer,
            "the strategy `topo-metric-tour` has no graph to make a tour of",
            "expected a prior with a graph",
            Some(
                "name one under `prior-maps`, as `graph: {topo-metric-map: FILE}`, and choose it as `prior`",
            ),
        );
    } else if !is_toured && setup.topo_metric_map.is_some() {
        remark(
            pointer,
            "the prior is a graph, which this strategy cannot use",
            "expected `topo-metric-tour`",
            Some("set `exploration.strategy: topo-metric-tour` where this is the prior"),
        );
    }
    if !is_toured && exploration.node_noise_sd_m > 0.0 {
        remark(
            "/parameters/exploration/node-noise-sd-m",
            "there are no nodes for `exploration.node-noise-sd-m` to move",
            "expected 0 but for `strategy: topo-metric-tour`",
            None,
        );
    }
    remarks
}

/// Returns a remark on a median over an even number of beams: it would invent a range between two.
fn median(setup: &Setup) -> Option<Remark> {
    let beams = setup.parameters.navigation.obstacle_median_beams;
    beams.is_multiple_of(2).then(|| Remark {
        pointer: "/parameters/navigation/obstacle-median-beams",
        message: format!("`navigation.obstacle-median-beams` must be odd, found {beams}"),
        label: "expected 1, 3, 5, ...".to_owned(),
        help: None,
    })
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
        let map = self.coverage_map.iter();
        map.map(|map| ("coverage-map".to_owned(), json!(map.meaning))).collect()
    }

    fn further_measures(&self) -> Vec<String> {
        let asked_for = &self.parameters.measurement;
        let at_distances = asked_for.coverage_at_distance_m.iter();
        let at_levels = asked_for.coverage_levels_percent.iter();
        let at_distances = at_distances.map(|&distance| coverage_at_distance(distance));
        at_distances.chain(at_levels.flat_map(|&level| at_level(level))).collect()
    }

    fn further_outcomes(&self) -> &'static [Outcome] {
        match self.parameters.mission.stop_at_coverage_percent {
            Some(_) => &[Outcome::COVERED],
            None => &[],
        }
    }

    fn estimated_seconds(&self) -> f64 {
        // The shipped apartment, office and open world take 4.5 to 6.2 s for a metre of the mean side of the box around them,
        // where 88 to 98 % of them are explored.
        const SECONDS_PER_METRE: f64 = 5.5;
        let around = self.world.bounds();
        let sides_m = if around.is_empty() { 0.0 } else { around.width() + around.height() };
        (0.5 * SECONDS_PER_METRE * sides_m).min(self.parameters.mission.time_limit_s)
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
