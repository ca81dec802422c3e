//! Corridors of n equal edges, whose answers have closed forms.

use super::tests::relative;
use super::*;
use crate::cmdp::{Infeasible, Solution, solve};

const SLOW: Expectation = Expectation { time_s: 10.0, failure: 0.01 };
const FAST: Expectation = Expectation { time_s: 4.0, failure: 0.04 };

fn corridor(edges: usize, deadline_s: f64, failure: f64, reading: Reading) -> Navigation {
    let mut topology = Topology { vertices: vec![Place::Corridor; edges + 1], edges: Vec::new() };
    let through = Through::Corridor;
    for x in 0..edges {
        topology.edges.push(OrientedEdge { from: x, to: x + 1, side: Side::Right, through });
        topology.edges.push(OrientedEdge { from: x + 1, to: x, side: Side::Left, through });
    }
    let both = [SLOW, FAST];
    let door = DoorPairs::alike(both);
    let maneuvers = Maneuvers {
        corridor: both,
        door_left: door,
        door_right: door,
        side_corridors: SideCorridors::Door,
    };
    let task = Task { from: 0, to: edges, deadline_s, failure, reading };
    build_cmdp(&topology, &task, &maneuvers).unwrap()
}

fn plan(navigation: &Navigation) -> Solution {
    match navigation.plan().unwrap() {
        Outcome::Optimal(solution) => solution,
        Outcome::Infeasible(why) => panic!("{why:?}"),
    }
}

/// Checks that all is slow when the deadline allows it, and else exactly the smallest share of edges fast that meets
/// it.
#[test]
fn the_expected_number_of_fast_edges_is_least() {
    for edges in [1_u32, 2, 5, 30] {
        let n = f64::from(edges);
        for share in [0.0, 0.1, 0.35, 0.5, 0.999, 1.0, 1.7] {
            // share of the span between all fast and all slow
            let deadline = n * (FAST.time_s + share * (SLOW.time_s - FAST.time_s));
            let navigation = corridor(edges as usize, deadline, 1e3, Reading::Additive);
            let solution = plan(&navigation);
            let fast = ((n * SLOW.time_s - deadline) / (SLOW.time_s - FAST.time_s)).max(0.0);
            let failure = n * SLOW.failure + fast * (FAST.failure - SLOW.failure);
            let time = n * SLOW.time_s - fast * (SLOW.time_s - FAST.time_s);
            assert!(relative(solution.primary, n) < 1e-12);
            assert!(relative(solution.secondary[FAILURE], failure) < 1e-9, "{edges} {share}");
            assert!(relative(solution.secondary[TIME], time) < 1e-9, "{edges} {share}");
            assert!(solution.relaxed.is_empty(), "{edges} {share}: {:?}", solution.relaxed);
            assert!(solution.policy.randomised() <= 1);
        }
    }
}

#[test]
fn a_deadline_that_cannot_be_met_yields_the_fastest_plan_and_says_so() {
    for deadline in [0.0, 1.0, 20.0 - 1e-6] {
        let navigation = corridor(5, deadline, 1e3, Reading::Additive);
        let solution = plan(&navigation);
        assert!(relative(solution.secondary[TIME], 5.0 * FAST.time_s) < 1e-12);
        assert_eq!(solution.policy.randomised(), 0);
        // The result of the interior-point method is reported, and never taken for an answer.
        let said = solution.effort.interior;
        assert!(matches!(said, Some(Err(_))), "{deadline}: {said:?}");
        let [relaxation] = solution.relaxed[..] else { panic!("{:?}", solution.relaxed) };
        assert_eq!((relaxation.index, relaxation.how), (TIME, Unmeetable::AchieveLeast));
        assert!(relative(relaxation.least, 20.0) < 1e-12);
        let refused = if deadline > 0.0 {
            Infeasible::Bound { index: TIME, least: relaxation.least }
        } else {
            Infeasible::ZeroBounds
        };
        let strict = solve(&navigation.cmdp).unwrap();
        assert_eq!(strict, Outcome::Infeasible(refused), "without leave to relax");
    }
}

/// Checks that nothing is relaxed at the knife edge itself, nor within rounding of it.
#[test]
fn the_knife_edge_belongs_to_the_feasible_side() {
    for nudge in [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-10, -1e-10, 1e-8] {
        let navigation = corridor(7, 28.0 * (1.0 + nudge), 1e3, Reading::Additive);
        let solution = plan(&navigation);
        assert!(solution.relaxed.is_empty(), "{nudge}: {:?}", solution.relaxed);
        assert!(relative(solution.secondary[TIME], 28.0) < 2e-8, "{nudge}");
    }
    for nudge in [-1e-8, -1e-6, -1e-3] {
        let navigation = corridor(7, 28.0 * (1.0 + nudge), 1e3, Reading::Additive);
        assert_eq!(plan(&navigation).relaxed.len(), 1, "{nudge}");
    }
}

/// Checks bounds in conflict: failure at most 0.11 asks for slow, time at most 25 for fast. The failure bound stays,
/// the time gives.
#[test]
fn of_two_bounds_in_conflict_the_time_gives() {
    let solution = plan(&corridor(5, 25.0, 0.11, Reading::Additive));
    // The failure bound allows 2 fast edges of 5: 0.05 + 2 * 0.03.
    assert!(relative(solution.secondary[FAILURE], 0.11) < 1e-9);
    assert!(relative(solution.secondary[TIME], 38.0) < 1e-9);
    assert_eq!(solution.relaxed.len(), 1);
    assert_eq!(solution.relaxed[0].index, TIME);
}

/// Checks that the additive bound of 0.99, which 120 edges cannot meet, is dropped; by the other reading it does not
/// bind.
#[test]
fn a_failure_bound_that_cannot_be_met_is_dropped() {
    let solution = plan(&corridor(120, 2000.0, 0.99, Reading::Additive));
    assert_eq!(solution.relaxed.len(), 1);
    assert_eq!((solution.relaxed[0].index, solution.relaxed[0].how), (FAILURE, Unmeetable::Drop));
    assert!(relative(solution.relaxed[0].least, 1.2) < 1e-9);
    assert!(relative(solution.secondary[TIME], 1200.0) < 1e-9);
    let solution = plan(&corridor(120, 2000.0, 0.99, Reading::Reach));
    assert!(solution.relaxed.is_empty());
    let survival = (0..120).fold(1.0, |survival, _| survival * (1.0 - SLOW.failure));
    assert!(relative(solution.primary, 1.0 - survival) < 1e-9);
}

/// Checks that reading R minimises the probability of failing itself, on one edge.
#[test]
fn reach_minimises_the_probability_of_failing() {
    let solution = plan(&corridor(1, 7.0, 0.99, Reading::Reach));
    // Half slow, half fast meets 7 s.
    assert!(relative(solution.primary, 0.025) < 1e-9);
    assert!(relative(solution.secondary[TIME], 7.0) < 1e-9);
}
