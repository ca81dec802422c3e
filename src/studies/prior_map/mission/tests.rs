//! Whole trials in a small flat of our own.

mod short_sighted;

use super::*;
use crate::condition::Condition;
use crate::digest::{Sha256Digest, TrialKey};
use crate::document::Source;
use crate::geometry::Point;
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::rng::Seeds;
use crate::robot::Robot;
use crate::studies;
use crate::studies::prior_map::columns;
use crate::studies::prior_map::tour::{self, TopoMetricMap};
use crate::studies::prior_map::{
    Candidate, Coverage, CoverageMap, CoverageMapCells, Crossing, Gain, Origin, Parameters,
    ReferenceMap, Replan, Reselect, SearchFrom, Strategy, View,
};
use crate::world::{Body, Solid, World};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Returns two rooms of 4 x 4 m joined by a door 0.9 m wide; walls 0.15 m thick.
fn flat() -> World {
    let wall = |x0: f64, y0: f64, x1: f64, y1: f64| Solid {
        name: String::new(),
        layer: "walls".into(),
        body: Body::Prism {
            outline: Outline::Polygon(vec![
                Point::new(x0, y0),
                Point::new(x1, y0),
                Point::new(x1, y1),
                Point::new(x0, y1),
            ]),
            z: [0.0, 2.5],
        },
    };
    World {
        name: "flat".into(),
        solids: vec![
            wall(-4.15, -2.15, 4.15, -2.0),
            wall(-4.15, 2.0, 4.15, 2.15),
            wall(-4.15, -2.15, -4.0, 2.15),
            wall(4.0, -2.15, 4.15, 2.15),
            wall(-0.075, -2.0, 0.075, -1.0),
            wall(-0.075, -0.1, 0.075, 2.0),
        ],
        regions: vec![],
        tags: vec![],
        starts: BTreeMap::new(),
        goals: BTreeMap::new(),
        warnings: vec![],
    }
}

fn robot() -> Robot {
    Robot {
        lidar: Some(Lidar {
            name: "laser".into(),
            mount: Pose::new(0.1, 0.0, 0.0),
            height: 0.1602,
            beams: 720,
            min_angle: -std::f64::consts::FRAC_PI_2,
            max_angle: std::f64::consts::FRAC_PI_2,
            min_range: 0.01,
            max_range: 10.0,
            rate_hz: 20.0,
            noise_sd: 0.01,
        }),
        ..Robot::disc(0.178)
    }
}

/// Returns a prior that knows the outer walls only.
fn footprint() -> OccupancyGrid {
    let frame =
        GridFrame { resolution: 0.1, origin: Point::new(-5.0, -3.0), width: 100, height: 60 };
    let inside = |p: Point| p.x.abs() < 4.0 && p.y.abs() < 2.0;
    let cells = frame
        .cells()
        .map(|cell| if inside(frame.center(cell)) { Occupancy::Free } else { Occupancy::Occupied });
    OccupancyGrid::from_cells(frame, cells.collect())
}

/// Returns the flat with the robot in its left room.
pub(super) fn setup(prior: Option<OccupancyGrid>) -> Setup {
    let start = Pose::new(-2.5, 0.5, 0.0);
    let (world, robot) = (Arc::new(flat()), Arc::new(robot()));
    Setup::new(world, robot, prior.map(Arc::new), start, Parameters::default())
}

fn spec(trial: u32, prior: bool, parameters: Parameters) -> TrialSpec {
    let setup = Setup { parameters, ..setup(prior.then(footprint)) };
    TrialSpec {
        key: TrialKey(Sha256Digest::of("test")),
        condition: Condition::from([("prior", "none")]),
        trial,
        seeds: Seeds::new(1, vec![("trial".into(), trial.to_string())]),
        setup: studies::Setup::new(setup),
    }
}

/// Returns any trial, for tests of records.
pub(super) fn spec_of_the_flat() -> TrialSpec {
    spec(0, false, Parameters::default())
}

/// Returns the flat's two rooms and its door as a graph, from a robot in the left one.
fn graph(door: f64) -> TopoMetricMap {
    let text = format!(
        "reenact-topo-metric-map: 1\nname: flat\nsource: ours\nnodes:\n  left: {{at-m: [-2, 0]}}\n  door: {{at-m: [0, {door}]}}\n  \
         right: {{at-m: [2, 0]}}\nedges: [[left, door], [door, right]]\n"
    );
    tour::read(&Source::new("flat.yaml", text)).unwrap()
}

#[test]
fn a_tour_explores_the_flat_whether_or_not_its_nodes_stand_free() {
    // In the doorway; in the wall; far outside, where the robot can never be.
    for (door, noise) in [(-0.55, 0.0), (1.0, 0.0), (30.0, 0.0), (-0.55, 2.0)] {
        let mut parameters = Parameters::default();
        parameters.exploration.strategy = Strategy::TopoMetricTour;
        parameters.exploration.node_noise_sd_m = noise;
        parameters.measurement.coverage_at_distance_m = vec![1, 500];
        let map = Some(Arc::new(graph(door)));
        let setup = Setup { parameters, ..setup(None) }.with_topo_metric_map(map);
        let spec = TrialSpec { setup: studies::Setup::new(setup), ..spec_of_the_flat() };
        let record = studies::execute(&spec);
        assert_eq!(record.outcome, Outcome::EXPLORED, "{door} {noise}: {}", record.cause);
        let measure = |name: &str| record.measures[name].unwrap();
        assert!(measure("coverage-percent") > 97.0, "{door} {noise}");
        assert!(measure("coverage-percent-at-1-m") < 90.0, "{door} {noise}");
        assert_eq!(measure("coverage-percent-at-500-m"), measure("coverage-percent"));
        assert_eq!(record.to_line(), studies::execute(&spec).to_line(), "the same again");
    }
}

#[test]
fn every_kind_of_run_explores_the_flat_without_touching_it() {
    for (prior, reselect) in
        [(false, Reselect::OnArrival), (true, Reselect::OnArrival), (true, Reselect::Continuous)]
    {
        let mut parameters = Parameters::default();
        parameters.exploration.reselect = reselect;
        let record = studies::execute(&spec(0, prior, parameters));
        let what = format!("prior {prior}, {reselect:?}: {:?} {}", record.outcome, record.cause);
        assert_eq!(record.outcome, Outcome::EXPLORED, "{what}");
        let measure = |name: &str| record.measures[name].unwrap();
        assert!(measure("coverage-percent") > 97.0, "{what}: {}", measure("coverage-percent"));
        assert_eq!(measure("contacts"), 0.0, "{what}");
        let (half, most) = (measure("distance-m-at-50"), measure("distance-m-at-95"));
        assert!(half <= most && most <= measure("distance-m"), "{what}: {half} {most}");
    }
}

/// Returns every option of choosing, measuring and starting, each at a value that is not its default.
fn unusual() -> Vec<(&'static str, Parameters)> {
    let with = |change: fn(&mut Parameters)| {
        let mut parameters = Parameters::default();
        change(&mut parameters);
        parameters
    };
    vec![
        ("released gain", with(|p| p.exploration.gain = Gain::Released)),
        ("view on arrival", with(|p| p.exploration.view = View::OnArrival)),
        ("best view", with(|p| p.exploration.view = View::Best)),
        ("centroid", with(|p| p.exploration.candidate = Candidate::NearestToCentroid)),
        ("nearest", with(|p| p.exploration.strategy = Strategy::NearestFrontier)),
        ("long frontiers", with(|p| p.exploration.minimum_frontier_cells = 3)),
        ("all round", with(|p| p.sensing.field_of_view_deg = Some(360.0))),
        ("slow mind", with(|p| p.exploration.decision_jitter_s = 1.5)),
        (
            "slow mind, continuous",
            with(|p| {
                p.exploration.decision_jitter_s = 1.5;
                p.exploration.reselect = Reselect::Continuous;
            }),
        ),
        (
            "all as released",
            with(|p| {
                p.exploration.gain = Gain::Released;
                p.exploration.candidate = Candidate::NearestToCentroid;
                p.exploration.reselect = Reselect::Continuous;
                p.mapping.origin = Origin::Centre;
                p.measurement.coverage = Coverage::Released;
                p.measurement.crossing = Crossing::Decision;
                p.measurement.reference = ReferenceMap::Robot;
            }),
        ),
        (
            "another start",
            with(|p| {
                p.mission.start_jitter_m = 0.8;
                p.mission.start_jitter_deg = 40.0;
            }),
        ),
    ]
}

#[test]
fn every_option_explores_the_flat_and_no_robot_comes_nearer_to_a_wall_than_its_radius() {
    for (what, parameters) in unusual() {
        for prior in [false, true] {
            let spec = spec(3, prior, parameters.clone());
            let (record, recording) = studies::reenact(&spec);
            let what = format!("{what}, prior {prior}: {:?} {}", record.outcome, record.cause);
            assert_eq!(record.outcome, Outcome::EXPLORED, "{what}");
            let covered = record.measures["coverage-percent"].unwrap();
            assert!(covered > 95.0, "{what}: {covered} %");
            let solid = flat().contact(0.01, 0.43);
            // Between frames, 0.1 s apart, the body moves 0.1 m: half that at most from a pose that is tested.
            for pair in recording.frames.windows(2) {
                let (a, b) = (pair[0].pose.position(), pair[1].pose.position());
                for at in [a, (a + b) * 0.5] {
                    let near = solid.iter().map(|o| o.distance(at)).fold(f64::INFINITY, f64::min);
                    assert!(near >= 0.177, "{what}: {near} m from a wall at {at:?}");
                }
            }
        }
    }
}

#[test]
fn a_trial_that_starts_elsewhere_is_measured_in_the_same_frame() {
    let mut parameters = Parameters::default();
    parameters.mission.start_jitter_m = 0.8;
    parameters.mission.start_jitter_deg = 40.0;
    let trials: Vec<_> =
        (0..2).map(|trial| studies::reenact(&spec(trial, true, parameters.clone()))).collect();
    let first = |i: usize| trials[i].1.frames[0].pose;
    assert!(first(0).position().distance(first(1).position()) > 0.05);
    for (_, recording) in &trials {
        assert!(first(0).position().distance(Point::new(-2.5, 0.5)) < 0.8 * 1.5);
        // The wall x = -4 lies where it is in the world, wherever the robot started.
        let mut map = OccupancyGrid::filled(recording.map_frame, Occupancy::Unknown);
        for (cell, value) in recording.frames.iter().flat_map(|f| &f.map_changes) {
            map.set(*cell, *value);
        }
        let at = |x: f64| {
            let p = recording.map_pose.inverse_transform(Point::new(x, 0.5));
            map.at(map.frame().cell_at(p))
        };
        assert_eq!((at(-3.7), at(-4.05)), (Occupancy::Free, Occupancy::Occupied));
    }
}

#[test]
fn a_robots_own_map_counts_less_than_light_and_every_trial_can_reach_it() {
    let mut parameters = Parameters::default();
    parameters.measurement.reference = ReferenceMap::Robot;
    parameters.sensing.range_noise_sd_m = Some(0.0);
    let total = |parameters: &Parameters| {
        let setup = Setup { parameters: parameters.clone(), ..setup(None) };
        setup.prepared().unwrap().reference.total()
    };
    let (robots, ideal) = (total(&parameters), total(&Parameters::default()));
    assert!(robots <= ideal && f64::from(robots) > 0.95 * f64::from(ideal), "{robots} of {ideal}");
    parameters.exploration.strategy = Strategy::NearestFrontier;
    let record = studies::execute(&spec(0, false, parameters));
    assert!(record.measures["coverage-percent"].unwrap() > 99.5, "one of the very explorations");
}

#[test]
fn a_run_is_stopped_where_enough_is_covered_and_all_is_told() {
    let mut parameters = Parameters::default();
    parameters.exploration.reselect = Reselect::Continuous;
    parameters.measurement.crossing = Crossing::Decision;
    let whole = studies::execute(&spec(0, true, parameters.clone()));
    parameters.mission.stop_at_coverage_percent = Some(90.0);
    let stopped = studies::execute(&spec(0, true, parameters));
    assert_eq!((whole.outcome, stopped.outcome), (Outcome::EXPLORED, Outcome::COVERED));
    for name in ["time-s-at-50", "distance-m-at-90"] {
        assert!(
            whole.measures[name].is_some() && stopped.measures[name] == whole.measures[name],
            "{name}"
        );
    }
    assert_eq!(
        stopped.measures["time-s"], stopped.measures["time-s-at-90"],
        "at the choice that told it"
    );
    assert!(stopped.measures["time-s"] < whole.measures["time-s"]);
}

#[test]
fn coverage_is_counted_against_a_map_that_is_given() {
    // The left room alone: exploration of it is whole before the right one is seen.
    let frame =
        GridFrame { resolution: 0.05, origin: Point::new(-4.0, -2.0), width: 78, height: 80 };
    let map = OccupancyGrid::from_cells(frame, vec![Occupancy::Free; 78 * 80]);
    let meaning = crate::digest::MeaningDigest(Sha256Digest::of("left"));
    let given = CoverageMap { map: Arc::new(map), meaning };
    let parameters = Parameters::default();
    let own = Setup { parameters, ..setup(None) }.with_coverage_map(Some(given));
    assert_eq!(own.prepared().unwrap().reference.total(), 39 * 40, "cells of 0.1 m");
    assert_eq!(studies::Setup::new(own).further().keys().collect::<Vec<_>>(), ["coverage-map"]);
}

#[test]
fn cells_of_a_given_map_that_nobody_can_see_count_where_asked_for_only() {
    // All around the two rooms and beyond, as if a recorded map's walls lay far off.
    let frame =
        GridFrame { resolution: 0.1, origin: Point::new(-8.0, -6.0), width: 160, height: 120 };
    let map = OccupancyGrid::from_cells(frame, vec![Occupancy::Free; 160 * 120]);
    let meaning = crate::digest::MeaningDigest(Sha256Digest::of("around"));
    let given = CoverageMap { map: Arc::new(map), meaning };
    let counted = |cells: CoverageMapCells, coverage: Coverage| {
        let mut parameters = Parameters::default();
        parameters.measurement.coverage_map_cells = cells;
        parameters.measurement.coverage = coverage;
        let own = Setup { parameters, ..setup(None) }.with_coverage_map(Some(given.clone()));
        own.prepared().unwrap().reference.total()
    };
    let ideal = |coverage: Coverage| {
        let mut parameters = Parameters::default();
        parameters.measurement.coverage = coverage;
        Setup { parameters, ..setup(None) }.prepared().unwrap().reference.total()
    };
    assert_eq!(counted(CoverageMapCells::All, Coverage::Released), 160 * 120);
    let known = ideal(Coverage::Released);
    assert_eq!(counted(CoverageMapCells::InView, Coverage::Released), known);
    // What is free is so in the given map.
    assert_eq!(counted(CoverageMapCells::InView, Coverage::Paper), known);
    assert!(ideal(Coverage::Paper) < known);
}

#[test]
fn a_map_that_stands_for_a_while_and_a_way_planned_once_still_explore_everything() {
    let explored = |interval_s: f64, replan: Replan| {
        let mut parameters = Parameters::default();
        parameters.exploration.reselect = Reselect::Continuous;
        parameters.mapping.update_interval_s = interval_s;
        parameters.navigation.replan = replan;
        let record = studies::execute(&spec(0, true, parameters));
        assert_eq!(record.outcome, Outcome::EXPLORED);
        assert!(record.measures["coverage-percent"].unwrap() > 98.0);
        record.measures["time-s"].unwrap()
    };
    let usual = explored(0.0, Replan::OnMapChange);
    assert_ne!(explored(1.0, Replan::OnMapChange), usual);
    assert_ne!(explored(0.0, Replan::OnChoice), usual);
}

#[test]
fn a_robot_beside_a_wall_goes_on_where_frontiers_are_searched_from_the_nearest_free_cell() {
    let covered = |search_from: SearchFrom| {
        let mut parameters = Parameters::default();
        parameters.exploration.search_from = search_from;
        // All round, so that nothing beside it is unknown.
        parameters.sensing.field_of_view_deg = Some(360.0);
        // 0.21 m from the wall: all cells around cost more than frontiers are sought at.
        let start = Pose::new(-2.5, 1.79, 0.0);
        let setup = studies::Setup::new(Setup { start, parameters, ..setup(None) });
        let record = studies::execute(&TrialSpec { setup, ..spec_of_the_flat() });
        assert_eq!(record.outcome, Outcome::EXPLORED);
        record.measures["coverage-percent"].unwrap()
    };
    assert!(covered(SearchFrom::Robot) < 80.0);
    assert!(covered(SearchFrom::NearestFree) > 98.0);
}

#[test]
fn cells_about_the_start_are_those_of_rounding() {
    let explored = |origin: Origin| {
        let mut parameters = Parameters::default();
        parameters.mapping.origin = origin;
        let spec = spec(0, true, parameters);
        let record = studies::execute(&spec);
        let map = explored_map(&spec, spec.setup.of().unwrap()).unwrap();
        (record, map.frame().origin)
    };
    let (record, corner) = explored(Origin::Corner);
    let (other, centre) = explored(Origin::Centre);
    assert_eq!((record.outcome, other.outcome), (Outcome::EXPLORED, Outcome::EXPLORED));
    let cells_from_start = |origin: Point| (origin.x - -2.5) / 0.1;
    let off = |x: f64| (x - x.round()).abs();
    assert!(off(cells_from_start(corner)) < 1e-6, "whole cells");
    assert!(off(cells_from_start(centre)) > 0.5 - 1e-6, "half a cell");
    assert!(other.measures["coverage-percent"].unwrap() > 99.0);
}

#[test]
fn later_choices_and_further_measures_are_written_down_when_asked_for() {
    let usual = studies::execute(&spec(0, true, Parameters::default()));
    let mut parameters = Parameters::default();
    parameters.measurement.further = true;
    parameters.measurement.mean_speed = true;
    let further = studies::execute(&spec(0, true, parameters.clone()));
    let measure = |record: &TrialRecord, name: &str| record.measures[name].unwrap();
    for (name, value) in &usual.measures {
        assert_eq!(further.measures[name], value, "{name}");
    }
    assert_eq!(further.chain, usual.chain, "looking changes nothing");
    let undescribed = further.measures.names().find(|name| columns::measure(name).is_none());
    assert_eq!(undescribed, None, "the data dictionary knows every measure");
    let (early, late) =
        (measure(&further, "decisions-at-50"), measure(&further, "decisions-at-95"));
    assert!(early <= late && late <= measure(&further, "decisions"), "{early} {late}");
    assert!(measure(&further, "open-frontiers-at-50") >= 1.0);
    let per_metre = measure(&further, "turning-rad") / measure(&further, "distance-m");
    assert_eq!(measure(&further, "turning-rad-per-m"), per_metre);
    assert!(usual.measures.get("turning-rad-per-m").is_none());
    let mean_speed = measure(&further, "distance-m") / measure(&further, "time-s");
    assert_eq!(measure(&further, "mean-speed-m-s"), mean_speed);
    assert!(usual.measures.get("mean-speed-m-s").is_none());
    parameters.measurement.crossing = Crossing::Decision;
    let decided = studies::execute(&spec(0, true, parameters.clone()));
    parameters.measurement.crossing = Crossing::Interpolated;
    let interpolated = studies::execute(&spec(0, true, parameters));
    let at = |record: &TrialRecord| measure(record, "time-s-at-80");
    assert!(at(&interpolated) < at(&usual) && at(&usual) <= at(&decided));
}

#[test]
fn recording_changes_no_bit_and_shows_the_map_that_was_made() {
    let spec = spec(1, true, Parameters::default());
    let (record, recording) = studies::reenact(&spec);
    assert_eq!(record.to_line(), studies::execute(&spec).to_line());
    let last = recording.frames.last().unwrap();
    assert!((last.distance_m - record.measures["distance-m"].unwrap()).abs() < 1e-9);
    let mut map = OccupancyGrid::filled(recording.map_frame, Occupancy::Unknown);
    for (cell, value) in recording.frames.iter().flat_map(|f| &f.map_changes) {
        assert!(recording.map_frame.contains(*cell));
        map.set(*cell, *value);
    }
    let at = |x: f64, y: f64| {
        let p = recording.map_pose.inverse_transform(Point::new(x, y));
        map.at(map.frame().cell_at(p))
    };
    assert_eq!((at(2.0, 0.5), at(-4.05, 0.5)), (Occupancy::Free, Occupancy::Occupied));
    assert!(
        recording.frames.iter().any(|f| f.decision.as_ref().is_some_and(|d| d.chosen.is_some()))
    );
}

/// Returns odometry that loses its position, and a mind that does not trust it.
fn lost() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.sensing.odometry_noise_distance = 0.03;
    parameters.sensing.odometry_noise_heading = 0.05;
    let mapping = &mut parameters.mapping;
    (mapping.particles, mapping.resolution_m) = (8, 0.1);
    (mapping.motion_noise_srr, mapping.motion_noise_srt) = (0.1, 0.1);
    (mapping.motion_noise_str, mapping.motion_noise_stt) = (0.05, 0.2);
    (mapping.match_linear_step_m, mapping.match_angular_step_rad) = (0.05, 0.05);
    mapping.match_skip_beams = 3;
    parameters
}

#[test]
fn a_robot_that_estimates_its_pose_explores_where_one_that_trusts_odometry_is_lost() {
    for prior in [false, true] {
        let record = studies::execute(&spec(0, prior, lost()));
        assert_eq!(record.outcome, Outcome::EXPLORED, "{prior}: {}", record.cause);
        let measure = |name: &str| record.measures[name].unwrap();
        assert!(measure("coverage-percent") > 95.0, "{}", measure("coverage-percent"));
        assert_eq!(measure("contacts"), 0.0);
        let (found, drifted) = (measure("pose-error-m-rms"), measure("odometry-error-m-rms"));
        assert!(found < 0.12 && found < drifted, "{found} m, odometry {drifted} m");
        assert!(measure("pose-error-m-rms-in-the-end") < 0.12);
        assert!(measure("pose-error-m-median") <= measure("pose-error-m-max"));
        // Recording changes nothing, and shows the map as it is in the end.
        let (again, recording) = studies::reenact(&spec(0, prior, lost()));
        assert_eq!(again.to_line(), record.to_line());
        let mut map = OccupancyGrid::filled(recording.map_frame, Occupancy::Unknown);
        for (cell, value) in recording.frames.iter().flat_map(|f| &f.map_changes) {
            map.set(*cell, *value);
        }
        let inside = |cell: &Cell| {
            let p = recording.map_pose.transform(map.frame().center(*cell));
            p.x.abs() < 3.8 && (0.2..1.8).contains(&p.y) && p.x.abs() > 0.3
        };
        let cells: Vec<_> = map.frame().cells().filter(inside).collect();
        let free = cells.iter().filter(|&&c| map.at(c) == Occupancy::Free).count();
        assert!(free * 100 > cells.len() * 95, "{free} of {} cells of floor are free", cells.len());
    }
    let trusting = Parameters { mapping: Parameters::default().mapping, ..lost() };
    let record = studies::execute(&spec(0, false, trusting));
    assert!(record.measures.get("pose-error-m-rms").is_none(), "nothing was estimated");
}

/// Checks the golden trial of a mind that estimates its pose, also on other threads.
#[test]
fn the_golden_estimating_trial_has_not_changed() {
    let line = || {
        let mut parameters = lost();
        parameters.mission.time_limit_s = 20.0;
        studies::execute(&spec(0, true, parameters)).to_line()
    };
    let lines = std::thread::scope(|scope| {
        let threads = [0, 1, 2].map(|_| scope.spawn(line));
        threads.map(|thread| thread.join().unwrap())
    });
    assert!(lines.iter().all(|l| *l == lines[0]), "threads leave no mark");
    let found = (lines[0].len(), Sha256Digest::of(&lines[0]).short());
    assert_eq!(found, (2632, "b33615d0".to_owned()), "see `the_golden_trial_has_not_changed`");
}

#[test]
fn records_survive_their_text() {
    let record = studies::execute(&spec(2, false, Parameters::default()));
    let line = record.to_line();
    assert_eq!(TrialRecord::from_line(&line).unwrap(), record);
}

#[test]
fn a_time_limit_and_a_walled_in_robot_are_recorded_as_such() {
    let mut parameters = Parameters::default();
    parameters.mission.time_limit_s = 2.0;
    let record = studies::execute(&spec(0, false, parameters));
    assert_eq!((record.outcome, record.sim_seconds), (Outcome::TIME_LIMIT, 2.0));
    assert_eq!(record.measures["distance-m-at-95"], None);
}

/// Checks the golden trial: its bytes are part of the determinism contract (docs/determinism.md).
#[test]
fn the_golden_trial_has_not_changed() {
    let line = studies::execute(&spec(0, true, Parameters::default())).to_line();
    let found = (line.len(), Sha256Digest::of(&line).short());
    assert_eq!(
        found,
        (2184, "bd68efd8".to_owned()),
        "a trial's bytes have changed (size, then digest).\n\
         Re-mint only if trials were meant to change: raise ENGINE_VERSION in src/plan/key.rs, say in CHANGELOG.md \
         what a reader of results will observe, then put the new pair here. If nothing was meant to change, this \
         is a bug: look for a new source of order, time or platform arithmetic. A differing size alone points at \
         the record's shape; an equal size with another digest at arithmetic"
    );
}
