//! `BuildCMDP` on a small map.

use super::*;

/// Returns a corridor of three vertices with a room off the middle one (on its left), and a far room off the last.
fn map() -> Topology {
    let mut topology = Topology {
        vertices: vec![Place::Corridor, Place::Corridor, Place::Corridor, Place::Room, Place::Room],
        edges: Vec::new(),
    };
    for (from, to, side) in
        [(0, 1, Side::Right), (1, 2, Side::Right), (1, 3, Side::Left), (2, 4, Side::Right)]
    {
        let back = if side == Side::Left { Side::Right } else { Side::Left };
        let (there, here) = match topology.vertices[to] {
            Place::Room => (Through::Entering, Through::Leaving),
            Place::Corridor => (Through::Corridor, Through::Corridor),
        };
        topology.edges.push(OrientedEdge { from, to, side, through: there });
        topology.edges.push(OrientedEdge { from: to, to: from, side: back, through: here });
    }
    topology
}

fn maneuvers() -> Maneuvers {
    let pair = |time_s: f64, failure: f64| {
        [
            Expectation { time_s, failure },
            Expectation { time_s: time_s / 2.0, failure: 3.0 * failure },
        ]
    };
    Maneuvers {
        corridor: pair(10.0, 0.01),
        door_left: DoorPairs::alike(pair(8.0, 0.02)),
        door_right: DoorPairs::alike(pair(6.0, 0.03)),
        side_corridors: SideCorridors::Door,
    }
}

fn task(to: usize, deadline_s: f64) -> Task {
    Task { from: 0, to, deadline_s, failure: 0.99, reading: Reading::Additive }
}

fn planned(navigation: &Navigation) -> crate::cmdp::Solution {
    match navigation.plan().unwrap() {
        Outcome::Optimal(solution) => solution,
        Outcome::Infeasible(why) => panic!("{why:?}"),
    }
}

#[test]
fn doors_and_corridors_have_their_own_expectations() {
    let navigation = build_cmdp(&map(), &task(3, 100.0), &maneuvers()).unwrap();
    assert_eq!(navigation.maneuvers.len(), 16);
    let solution = planned(&navigation);
    assert_eq!(solution.primary, 2.0);
    assert!(relative(solution.secondary[TIME], 18.0) < 1e-14, "corridor, then a door on the left");
    assert!(relative(solution.secondary[FAILURE], 0.03) < 1e-14);
    let chosen = navigation.maneuvers[solution.policy.at(1)[0].0];
    assert_eq!(chosen, Maneuver { edge: 4, motion: Motion::DoorLeft, speed: Speed::Slow });
    // Off the path: the far room's fallback leaves it, by the door on the left of the return path.
    assert!(!solution.policy.visits(4));
    let chosen = navigation.maneuvers[solution.policy.at(4)[0].0];
    assert_eq!(chosen, Maneuver { edge: 7, motion: Motion::DoorLeft, speed: Speed::Slow });
}

/// Checks that the corridor, which saves 5 s for 0.02, is sped up before the door, which saves 4 s for 0.04.
#[test]
fn what_costs_least_failure_per_second_is_sped_up_first() {
    let speeds = |deadline| {
        let navigation = build_cmdp(&map(), &task(3, deadline), &maneuvers()).unwrap();
        let solution = planned(&navigation);
        let fast = |x: usize| -> f64 {
            let of = |a: usize| navigation.maneuvers[a].speed == Speed::Fast;
            solution.policy.at(x).iter().filter(|(a, _)| of(*a)).map(|(_, p)| p).sum()
        };
        (fast(0), fast(1), solution.relaxed.len())
    };
    let near = |(a, b, n): (f64, f64, usize), (x, y, m): (f64, f64, usize)| {
        (a - x).abs() < 1e-9 && (b - y).abs() < 1e-9 && n == m
    };
    assert!(near(speeds(18.0), (0.0, 0.0, 0)));
    assert!(near(speeds(15.5), (0.5, 0.0, 0)));
    assert!(near(speeds(13.0), (1.0, 0.0, 0)));
    assert!(near(speeds(11.0), (1.0, 0.5, 0)));
    assert!(near(speeds(9.0), (1.0, 1.0, 0)));
    assert!(near(speeds(8.0), (1.0, 1.0, 1)));
}

#[test]
fn both_readings_choose_the_same_path() {
    for deadline_s in [100.0, 30.0, 20.0, 5.0] {
        let path = |reading| {
            let task = Task { reading, ..task(4, deadline_s) };
            let navigation = build_cmdp(&map(), &task, &maneuvers()).unwrap();
            let solution = planned(&navigation);
            [0, 1, 2].map(|x| navigation.maneuvers[solution.policy.at(x)[0].0].edge)
        };
        assert_eq!(path(Reading::Additive), path(Reading::Reach), "{deadline_s}");
    }
}

#[test]
fn an_unreachable_target_and_bad_numbers_are_named() {
    let mut cut = map();
    cut.edges.truncate(6);
    let navigation = build_cmdp(&cut, &task(4, 100.0), &maneuvers()).unwrap();
    assert!(matches!(navigation.plan().unwrap(), Outcome::Infeasible(_)));
    let text = |result: Result<Navigation, BuildError>| result.unwrap_err().to_string();
    assert_eq!(
        text(build_cmdp(&map(), &task(9, 1.0), &maneuvers())),
        "target of the task: vertex 9 does not exist; expected an index below 5"
    );
    assert_eq!(
        text(build_cmdp(&map(), &task(3, -1.0), &maneuvers())),
        "the deadline (s) is -1; expected a finite number >= 0"
    );
    let mut wrong = maneuvers();
    wrong.door_left.entering[1].failure = 1.5;
    assert_eq!(
        text(build_cmdp(&map(), &task(3, 1.0), &wrong)),
        "the failure probability of door left, fast is 1.5; expected a probability in [0, 1]"
    );
    wrong = maneuvers();
    wrong.corridor[0].time_s = f64::NAN;
    assert_eq!(
        text(build_cmdp(&map(), &task(3, 1.0), &wrong)),
        "the time (s) of corridor, slow is NaN; expected a finite number >= 0"
    );
}

/// Returns |a - b| relative to the larger.
pub(super) fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(1e-300)
}
