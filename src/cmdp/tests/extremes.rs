//! Models at the edge: nothing to do, nowhere to go, ties, free circles, wild scales, many states.

use super::*;

fn line(n: usize) -> Instance {
    Instance {
        states: n,
        absorbing: vec![n - 1],
        initial: vec![(0, 1.0)],
        actions: 4,
        ..Instance::default()
    }
}

#[test]
fn starting_where_one_should_arrive_costs_nothing() {
    let mut instance = line(2);
    instance.initial = vec![(1, 1.0)];
    instance.pair(0, 0, &[(1, 1.0)], &[1.0, 5.0]);
    instance.secondary[0].0 = 0.0;
    let solution = optimal(&instance.cmdp());
    assert_eq!((solution.primary, &solution.secondary[..]), (0.0, &[0.0][..]));
    assert_eq!(solution.policy.at(0), &[(0, 1.0)], "the fallback");
    assert!(!solution.policy.visits(0));
    assert_eq!(solution.effort, Effort { interior: None, pivots: 0 });
}

#[test]
fn traps_dead_ends_and_no_goal_are_infeasible() {
    let none = Outcome::Infeasible(Infeasible::NoSureArrival);
    let mut dead_end = line(3);
    dead_end.pair(0, 0, &[(2, 0.9), (1, 0.1)], &[1.0]);
    assert_eq!(solve(&dead_end.cmdp()).unwrap(), none);
    dead_end.pair(1, 0, &[(1, 1.0)], &[1.0]);
    assert_eq!(solve(&dead_end.cmdp()).unwrap(), none, "a circle is a trap too");
    dead_end.pair(1, 1, &[(0, 1.0)], &[1.0]);
    let solution = optimal(&dead_end.cmdp());
    assert!(relative(solution.primary, 1.2 / 0.9 - 0.1 / 0.9) < 1e-14, "{}", solution.primary);
    let mut nowhere = line(2);
    nowhere.absorbing = vec![];
    nowhere.pair(0, 0, &[(0, 1.0)], &[0.0]);
    assert_eq!(solve(&nowhere.cmdp()).unwrap(), none);
}

/// Checks that the policy arrives although circling is free and arriving is not.
#[test]
fn free_circles_are_not_arrivals() {
    let mut instance = line(4);
    for (x, y) in [(0, 1), (1, 0), (1, 2), (2, 1), (0, 2)] {
        instance.pair(x, y, &[(y, 1.0)], &[0.0, 0.0]);
    }
    instance.pair(2, 3, &[(3, 1.0)], &[1.0, 2.0]);
    instance.secondary[0].0 = 2.0;
    let solution = optimal(&instance.cmdp());
    assert_eq!((solution.primary, solution.secondary[0]), (1.0, 2.0));
    // And with no cost at all.
    for (_, _, c) in &mut instance.primary {
        *c = 0.0;
    }
    assert_eq!(optimal(&instance.cmdp()).primary, 0.0);
}

/// Checks that a bound of zero forbids every pair that costs, exactly.
#[test]
fn a_bound_of_zero_is_kept_exactly() {
    let mut instance = line(4);
    instance.pair(0, 0, &[(3, 1.0)], &[1.0, 1e-9]);
    instance.pair(0, 1, &[(1, 0.5), (0, 0.5)], &[1.0, 0.0]);
    instance.pair(1, 0, &[(2, 1e-14), (3, 1.0 - 1e-14)], &[1.0, 0.0]);
    instance.pair(2, 0, &[(3, 1.0)], &[1.0, 7.0]);
    instance.pair(2, 1, &[(3, 1.0)], &[90.0, 0.0]);
    instance.secondary[0].0 = 0.0;
    let solution = optimal(&instance.cmdp());
    assert_eq!(solution.secondary, [0.0]);
    assert!(relative(solution.primary, 3.0) < 1e-11);
    assert_eq!(solution.policy.at(2), &[(1, 1.0)], "reached with probability 1e-14 only");
    // Without the free action there is none.
    instance.secondary[0].1.push((1, 0, 1.0));
    assert_eq!(solve(&instance.cmdp()).unwrap(), Outcome::Infeasible(Infeasible::ZeroBounds));
}

/// Checks that the answer is still a vertex, still with few randomised states, where all actions are equal.
#[test]
fn ties_everywhere_leave_a_vertex() {
    let width = 6;
    let mut instance = line(width * width);
    for x in 0..width * width {
        for (a, y) in
            [(0, x + 1), (1, x + width), (2, x.wrapping_sub(1)), (3, x.wrapping_sub(width))]
        {
            let wraps = (a == 0 && x % width + 1 == width) || (a == 2 && x % width == 0);
            if y < width * width && !wraps {
                instance.pair(x, a, &[(y, 1.0)], &[1.0, 0.1, 2.0]);
            }
        }
    }
    instance.secondary[0].0 = 1.0;
    instance.secondary[1].0 = 20.0;
    let solution = optimal(&instance.cmdp());
    assert!(relative(solution.primary, 10.0) < 1e-14);
    assert!(solution.policy.randomised() <= 2);
}

/// Checks units from micro to mega in one model, and the same model in other units.
#[test]
fn units_do_not_matter() {
    for scale in [1e-9, 1e-3, 1.0, 1e5, 1e12] {
        for family in [Family::Grid, Family::SlippyGrid, Family::Loop] {
            let plain = family.instance(4, 20);
            let mut scaled = plain.clone();
            for (_, _, c) in &mut scaled.primary {
                *c *= scale;
            }
            for (bound, costs) in &mut scaled.secondary {
                *bound /= scale;
                for (_, _, c) in costs.iter_mut() {
                    *c /= scale;
                }
            }
            match (solve(&plain.cmdp()).unwrap(), solve(&scaled.cmdp()).unwrap()) {
                (Outcome::Optimal(a), Outcome::Optimal(b)) => {
                    assert!(relative(a.primary * scale, b.primary) < 1e-9, "{family:?} {scale}");
                }
                (Outcome::Infeasible(_), Outcome::Infeasible(_)) => {}
                (a, b) => panic!("{family:?} {scale}: {a:?} {b:?}"),
            }
        }
    }
}

/// Checks a model whose every step succeeds with probability 1e-7 only, and where a second action costs a million times
/// as much.
#[test]
fn hardly_moving_has_its_closed_form() {
    let p = 1e-7;
    let mut instance = line(11);
    for x in 0..10 {
        instance.pair(x, 0, &[(x + 1, p), (x, 1.0 - p)], &[1.0, 1e-3]);
        instance.pair(x, 1, &[(x + 1, 1.0)], &[1e9, 0.0]);
    }
    // 1e8 and 1e5 for all patient; half of the second cost means half of the steps bought.
    instance.secondary[0].0 = 5e4;
    let solution = optimal(&instance.cmdp());
    assert!(relative(solution.primary, 5.0 * 1e9 + 5e7) < 1e-8, "{}", solution.primary);
    assert!(solution.secondary[0] <= 5e4 * (1.0 + BOUND_TOLERANCE));
}

/// Checks a walk that drifts away from the goal: expected steps grow exponentially with its length.
#[test]
fn drifting_away_has_its_closed_form() {
    let n = 25;
    let mut instance = line(n + 1);
    for x in 0..n {
        instance.pair(x, 0, &[(x + 1, 0.25), (x.saturating_sub(1), 0.75)], &[1.0, 1.0]);
        instance.pair(x, 1, &[(x + 1, 0.25), (x.saturating_sub(1), 0.75)], &[1.0, 2.0]);
    }
    // Steps from x to x + 1: 1/p + (q/p) of those before.
    let (mut step, mut expected) = (0.0, 0.0);
    for x in 0..n {
        step = if x == 0 { 4.0 } else { 4.0 + 3.0 * step };
        expected += step;
    }
    instance.secondary[0].0 = 1.5 * expected;
    let solution = optimal(&instance.cmdp());
    assert!(relative(solution.primary, expected) < 1e-9, "{} {expected}", solution.primary);
}

#[test]
fn three_hundred_states_are_solved() {
    for family in [Family::Corridor, Family::SlippyGrid, Family::Loop] {
        let mut instance = family.instance(0, 300);
        for (i, (bound, _)) in instance.secondary.clone().iter().enumerate() {
            instance.secondary[i].0 = bound.max(1.05 * instance.best_by(i + 1)[i + 1]);
        }
        let solution = match solve(&instance.cmdp()).unwrap() {
            Outcome::Optimal(solution) => solution,
            Outcome::Infeasible(why) => {
                // Both bounds can be met one by one; together perhaps not.
                assert!(matches!(why, Infeasible::Bound { index: 1, .. }), "{family:?} {why:?}");
                continue;
            }
        };
        for ((bound, _), total) in instance.secondary.iter().zip(&solution.secondary) {
            assert!(*total <= bound * (1.0 + BOUND_TOLERANCE), "{family:?}");
        }
        assert!(solution.policy.randomised() <= 2, "{family:?}");
    }
}

#[test]
fn numbers_beyond_floating_point_are_an_error_not_an_answer() {
    let mut instance = line(3);
    instance.pair(0, 0, &[(1, 1.0)], &[1e308]);
    instance.pair(1, 0, &[(2, 1e-3), (0, 0.999)], &[1e308]);
    let error = solve(&instance.cmdp()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "costs or expected totals exceed the range of floating point; scale the costs"
    );
}

#[test]
fn a_model_too_large_says_so() {
    let mut instance = line(MAX_STATES + 2);
    for x in 0..=MAX_STATES {
        instance.pair(x, 0, &[(x + 1, 1.0)], &[1.0]);
    }
    assert_eq!(
        solve(&instance.cmdp()).unwrap_err().to_string(),
        "2001 states take part; expected at most 2000"
    );
}

/// Checks that wherever a bound cannot be met, the least total said to be achievable is, and nothing below it.
#[test]
fn the_least_achievable_total_is_the_knife_edge() {
    let mut edges = 0;
    for family in Family::ALL {
        for index in 0..30 {
            let mut instance = family.instance(index, 12);
            let Outcome::Infeasible(why) = solve(&instance.cmdp()).unwrap() else { continue };
            let Infeasible::Bound { index: i, least } = why else { panic!("{family:?} {why:?}") };
            edges += 1;
            for (_, later) in instance.secondary.iter_mut().enumerate().filter(|(j, _)| *j > i) {
                later.0 = 1e6;
            }
            for nudge in [0.0, 1e-13, -1e-13, 1e-11, 1e-9, 1e-7, 1e-5] {
                instance.secondary[i].0 = least * (1.0 + nudge);
                let solution = optimal(&instance.cmdp());
                let total = solution.secondary[i];
                assert!(
                    relative(total, least) < 2e-5,
                    "{family:?} {index} {nudge}: {total} {least}"
                );
                assert!(solution.policy.randomised() <= 2);
            }
            for nudge in [1e-8, 1e-6, 1e-3] {
                instance.secondary[i].0 = least * (1.0 - nudge);
                let Outcome::Infeasible(Infeasible::Bound { least: again, .. }) =
                    solve(&instance.cmdp()).unwrap()
                else {
                    panic!("{family:?} {index}: feasible at {nudge} below the least");
                };
                assert!(relative(again, least) < 1e-10, "{family:?} {index} {nudge}");
            }
        }
    }
    assert!(edges >= 20, "{edges} instances only were infeasible");
}
