//! Whole trials in the engineering building and in a generated one.

use super::policy_chart::policy_chart;
use super::*;
use crate::condition::Condition;
use crate::digest::{Sha256Digest, TrialKey};
use crate::document::Source;
use crate::rng::Seeds;
use crate::robot::{Robot, urdf};
use crate::studies;
use crate::studies::deadline::build_cmdp::{
    DoorPairs, Expectation, Maneuvers, Motion, SideCorridors, Speed,
};
use crate::studies::deadline::calibration::{MOTIONS, SPEEDS, maneuver_name};
use crate::studies::deadline::columns;
use crate::studies::deadline::strategy::Strategy;
use crate::studies::deadline::{Calibration, Parameters};
use crate::world::World;
use crate::world::generate::{Family, generate};
use std::sync::Arc;

fn file(path: &str) -> Source {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    Source::new(path, std::fs::read_to_string(root.join(path)).unwrap())
}

fn pioneer() -> Arc<Robot> {
    Arc::new(urdf::read(&file("robots/pioneer3at.urdf")).unwrap().0)
}

fn building() -> World {
    crate::world::document::read(&file("worlds/engineering-building.yaml"), None).unwrap()
}

fn calibration() -> Arc<Calibration> {
    let pair = |time_s: f64, failure: f64| Expectation { time_s, failure };
    let corridor = [pair(17.0, 0.001), pair(10.0, 0.002)];
    let door = [pair(14.5, 0.01), pair(9.0, 0.03)];
    let door = DoorPairs::alike(door);
    let side_corridors = SideCorridors::Door;
    let maneuvers = Maneuvers { corridor, door_left: door, door_right: door, side_corridors };
    Arc::new(Calibration::assumed(&maneuvers))
}

/// Returns trial number `trial` from the start `start` of `world`.
fn trial(world: World, start: &str, parameters: Parameters, trial: u32) -> TrialSpec {
    let pose = world.starts[start];
    let setup = Setup::new(Arc::new(world), pioneer(), pose, Some(calibration()), parameters);
    TrialSpec {
        key: TrialKey(Sha256Digest::of(trial.to_le_bytes())),
        condition: Condition::from([("start", start)]),
        trial,
        seeds: Seeds::new(2019, vec![("trial".into(), trial.to_string())]),
        setup: studies::Setup::new(setup),
    }
}

fn exploration(strategy: Strategy, deadline_s: f64) -> Parameters {
    let mut parameters = Parameters::default();
    parameters.rules.strategy = strategy;
    parameters.mission.deadline_s = deadline_s;
    parameters
}

fn count(record: &TrialRecord, measure: &str) -> f64 {
    record.measures[measure].unwrap()
}

#[test]
fn a_robot_finds_the_goal_and_every_maneuver_is_counted() {
    let spec = trial(building(), "A", exploration(Strategy::Frontier, 3000.0), 0);
    let record = studies::execute(&spec);
    assert_eq!(record.outcome, Outcome::REACHED, "{}", record.cause);
    assert_eq!(record.measures["time-s"], Some(record.sim_seconds));
    let arrived: f64 = MOTIONS
        .iter()
        .flat_map(|m| SPEEDS.map(|s| maneuver_name(*m, s)))
        .map(|name| count(&record, &format!("{name}-arrived")))
        .sum();
    assert_eq!(arrived, count(&record, "maneuvers"), "all that were begun arrived");
    assert!(count(&record, "vertices") >= 3.0);
    let plans = ["plans-slack", "plans-active", "plans-relaxed"].map(|n| count(&record, n));
    assert_eq!(plans.iter().sum::<f64>(), count(&record, "plans"));
    let named = columns::measures();
    assert!(
        record.measures.names().all(|name| named.iter().any(|known| known == name)),
        "claims know every column"
    );
}

#[test]
fn a_recording_tells_what_a_target_was_chosen_among_and_why() {
    let spec = trial(building(), "C", exploration(Strategy::Frontier, 3000.0), 0);
    let (record, recording) = studies::reenact(&spec);
    assert_eq!(record.to_line(), studies::execute(&spec).to_line());
    assert_eq!(recording.rule, "frontier: most unexplored edges; any of equals");
    let graphs = recording.frames.iter().filter_map(|frame| frame.graph.as_ref());
    let mut legs = 0;
    for graph in graphs {
        assert_eq!(graph.target.is_some(), !graph.candidates.is_empty());
        let Some(target) = graph.target else { continue };
        let most = graph.candidates.iter().map(|c| c.unexplored).max();
        let chosen = graph.candidates.iter().find(|c| c.vertex == target).unwrap();
        assert_eq!(Some(chosen.unexplored), most, "as the rule says");
        legs += 1;
    }
    assert!(legs > 0);
}

#[test]
fn a_strict_deadline_ends_a_trial_late_and_without_a_time() {
    let spec = trial(building(), "C", exploration(Strategy::Random, 60.0), 1);
    let record = studies::execute(&spec);
    assert_eq!((record.outcome, record.measures["time-s"]), (Outcome::LATE, None));
    assert!((60.0..60.2).contains(&record.sim_seconds), "{}", record.sim_seconds);
}

#[test]
fn a_trial_without_a_new_vertex_for_long_has_stalled() {
    // The start is seen after the first turn around, about 14 s; the next vertex is 10 s away.
    let mut parameters = exploration(Strategy::Random, 20.0);
    parameters.mission.stalled_after_s = 2.0;
    let record = studies::execute(&trial(building(), "C", parameters, 1));
    assert_eq!(record.outcome, Outcome::STALLED);
}

/// Checks that an id carries no meaning but whether a tag was seen before.
#[test]
fn permuting_the_ids_of_tags_changes_no_trial() {
    let mut renamed = building();
    let count = renamed.tags.len();
    for (i, tag) in renamed.tags.iter_mut().enumerate() {
        tag.id = format!("{:03}", count - i);
    }
    let parameters = || exploration(Strategy::CompleteCorridor, 200.0);
    let record = studies::execute(&trial(building(), "B", parameters(), 2));
    let other = studies::execute(&trial(renamed, "B", parameters(), 2));
    assert!(record.chain.len() > 5);
    assert_eq!(record, other);
}

#[test]
fn writing_a_trial_down_changes_no_bit_of_it() {
    let spec = trial(building(), "A", exploration(Strategy::Random, 60.0), 3);
    let (record, recording) = studies::reenact(&spec);
    assert_eq!(record, studies::execute(&spec));
    assert!(recording.frames.len() > 300);
    assert!(recording.frames.iter().any(|frame| frame.event.is_some()));
}

#[test]
fn a_generated_building_can_be_explored() {
    let world = generate(Family::OfficeFloor, 7).unwrap();
    let spec = trial(world, "B", exploration(Strategy::NormalizedFrontier, 600.0), 0);
    let record = studies::execute(&spec);
    assert_ne!(record.outcome, Outcome::PANICKED, "{}", record.cause);
    assert!(count(&record, "vertices") >= 5.0);
}

#[test]
fn a_passage_ends_at_the_next_vertex() {
    for motion in MOTIONS {
        for speed in SPEEDS {
            let mut parameters = Parameters::default();
            parameters.mission.task = Task::Passage;
            parameters.passage.motion = motion;
            parameters.passage.speed = speed;
            let record = studies::execute(&trial(building(), "A", parameters, 5));
            assert_eq!(record.outcome, Outcome::REACHED, "{motion:?} {speed:?}: {}", record.cause);
            let seconds = record.measures["time-s"].unwrap();
            assert!((2.0..60.0).contains(&seconds), "{motion:?} {speed:?} took {seconds} s");
        }
    }
}

#[test]
fn a_robot_that_cannot_feel_its_way_collides() {
    let collided = (0..30).any(|number| {
        let mut parameters = Parameters::default();
        parameters.mission.task = Task::Passage;
        parameters.passage.motion = Motion::DoorRight;
        parameters.passage.speed = Speed::Fast;
        parameters.pilot.door_guidance = crate::navigation::maneuver::DoorGuidance::Tag;
        parameters.pilot.heading = crate::navigation::maneuver::HeadingSource::Compass;
        parameters.pilot.guard_s = 0.0;
        parameters.pilot.clearance_m = 0.0;
        parameters.sensing.compass_noise_deg = 30.0;
        parameters.sensing.compass_noise_correlation_s = 12.0;
        let record = studies::execute(&trial(building(), "A", parameters, number));
        record.outcome == Outcome::COLLIDED && record.measures["time-s"].is_none()
    });
    assert!(collided, "contact ends a passage");
}

/// Checks the golden trial. When this fails, see docs/determinism.md, "Golden trials": raise the study's revision
/// if trials were meant to change.
#[test]
fn the_golden_trial_has_not_changed() {
    let spec = trial(building(), "A", exploration(Strategy::NormalizedFrontier, 120.0), 0);
    let line = studies::execute(&spec).to_line();
    let digest = Sha256Digest::of(&line).short();
    let found = (line.len(), digest.as_str());
    assert_eq!(
        found, GOLDEN,
        "the record of the golden trial changed; if that was meant, raise the study's `revision`, tell readers in \
         CHANGELOG.md and put the new pair here; if not, something of order, time or platform came in"
    );
}

const GOLDEN: (usize, &str) = (2240, "819c47ea");

#[test]
fn the_policy_chart_knows_the_whole_building_and_tells_equal_policies_once() {
    let setup = |start: &str| {
        let world = building();
        let pose = world.starts[start];
        Setup::new(Arc::new(world), pioneer(), pose, Some(calibration()), Parameters::default())
    };
    let chart = policy_chart("Policy", &setup("A"), &[]).unwrap();
    assert_eq!((chart.vertices.len(), chart.edges.len()), (49, 49));
    let how: Vec<&str> = chart.panels.iter().map(|p| &p.how[..5]).collect();
    assert_eq!(how, ["slack", "bindi", "canno"], "30, 15 and 9 s an edge: {:?}", chart.panels);
    for panel in &chart.panels {
        let to_goal: f64 =
            panel.moves.iter().filter(|m| m.to == chart.goal).map(|m| m.passes).sum();
        assert!((to_goal - 1.0).abs() < 1e-9, "every pass ends at the goal");
        assert!(panel.moves.iter().all(|m| m.probability > 0.0 && m.passes > 0.0));
    }
    let drawn = &chart.panels[1].moves;
    assert!(drawn.iter().any(|m| m.probability < 0.999), "only chance meets it exactly: {drawn:?}");
    let twice = policy_chart("Policy", &setup("B"), &[500.0, 400.0]).unwrap();
    assert_eq!(twice.panels.len(), 1, "the same is done within both: {:?}", twice.panels);
    assert_eq!(twice.panels[0].name, "t_d = 500 s, and t_d = 400 s");
    let alone = Setup::new(
        Arc::new(building()),
        pioneer(),
        building().starts["A"],
        None,
        Parameters::default(),
    );
    assert_eq!(
        policy_chart("Policy", &alone, &[]).unwrap_err().to_string(),
        "the planner has no calibration"
    );
}
