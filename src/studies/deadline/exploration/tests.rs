//! Algorithms 2 and 3 on buildings that are graphs.

use super::*;
use crate::studies::deadline::build_cmdp::{Place, SideCorridors};
use crate::studies::deadline::building::{Building, maneuvers, plain};
use crate::studies::deadline::intersection::Exit;
use crate::studies::deadline::planner::{Method, Status};
use crate::studies::deadline::strategy::{Preference, Strategy};
use proptest::prelude::*;

const STRATEGIES: [Strategy; 5] = [
    Strategy::Random,
    Strategy::Frontier,
    Strategy::NormalizedFrontier,
    Strategy::CorridorsFirst,
    Strategy::CompleteCorridor,
];

fn rules(strategy: Strategy) -> Rules {
    Rules { strategy, ..Rules::default() }
}

fn explorer(rules: &Rules, deadline_s: f64, seed: u64) -> Explorer {
    Explorer::new(rules, maneuvers(), deadline_s, &Seeds::new(seed, Vec::new()))
}

/// Explores with a deadline that never comes; without a goal, to the end.
fn walk(building: &Building, rules: &Rules, start: usize, seed: u64) -> (Vec<usize>, Next) {
    building.explore(&mut explorer(rules, 1e9, seed), start, 12.0, plain)
}

fn without_goal(mut building: Building) -> Building {
    building.goal = None;
    building
}

/// Returns ids of tags that carry no meaning: a permutation of the numbers from 0.
fn permuted(seed: u64) -> impl Fn(usize, Option<Cardinal>) -> String {
    move |v, exit| {
        let number = v as u64 * 5 + exit.map_or(0, |direction| 1 + direction.index() as u64);
        // 2^16 + 1 is prime, so that multiplying permutes the numbers below it.
        format!("{}", number * (1 + seed % 65_000) % 65_537)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Checks "It is easy to prove that this strategy will eventually explore the whole environment", and that the
    /// others do so too.
    #[test]
    fn every_strategy_explores_everything(seed in 0_u64..1_000_000, which in 0_usize..5, start in 0_usize..8) {
        let building = without_goal(Building::random(seed, 8, 6, true));
        let (visited, end) = walk(&building, &rules(STRATEGIES[which]), start, seed);
        prop_assert_eq!(end, Next::GiveUp(GiveUp::NothingLeft));
        for v in 0..building.spots.len() {
            prop_assert!(visited.contains(&v));
        }
    }

    /// Checks that every strategy therefore finds every goal, and stops there.
    #[test]
    fn every_goal_is_found_and_counts_on_arrival(seed in 0_u64..1_000_000, which in 0_usize..5) {
        let building = Building::random(seed, 8, 6, true);
        let (visited, end) = walk(&building, &rules(STRATEGIES[which]), 0, seed);
        prop_assert_eq!(end, Next::GlobalSuccess);
        let goal = building.goal.unwrap();
        prop_assert_eq!(visited.iter().position(|v| *v == goal), Some(visited.len() - 1));
    }

    /// Checks that nothing depends on the names of tags.
    #[test]
    fn permuting_ids_changes_nothing(seed in 0_u64..1_000_000, which in 0_usize..5) {
        let building = Building::random(seed, 10, 8, true);
        let told = |name: &dyn Fn(usize, Option<Cardinal>) -> String| {
            let mut explorer = explorer(&rules(STRATEGIES[which]), 600.0, seed);
            let (visited, end) = building.explore(&mut explorer, 0, 12.0, name);
            (visited, end, explorer.moves().to_vec())
        };
        prop_assert_eq!(told(&plain), told(&permuted(seed)));
    }

    /// Checks that S1 without a rule among corridors is the random strategy, move for move, where rooms have one door.
    #[test]
    fn uniform_corridors_first_is_random_where_rooms_have_one_door(seed in 0_u64..1_000_000) {
        let building = Building::random(seed, 9, 9, false);
        let mut uniform = rules(Strategy::CorridorsFirst);
        uniform.corridors_first.among = Preference::Uniform;
        let start = usize::try_from(seed).unwrap() % building.spots.len();
        let random = walk(&building, &rules(Strategy::Random), start, seed);
        prop_assert_eq!(walk(&building, &uniform, start, seed), random);
    }

    /// Checks that each plan has the schedule's deadline for its number of edges, and leads from where it was made to
    /// its target, where an unexplored edge is followed.
    #[test]
    fn decisions_keep_algorithms_2_and_3(seed in 0_u64..1_000_000, which in 0_usize..5) {
        let building = without_goal(Building::random(seed, 10, 8, true));
        let rules = rules(STRATEGIES[which]);
        let deadline_s = 700.0;
        let mut explorer = explorer(&rules, deadline_s, seed);
        building.explore(&mut explorer, 0, 12.0, plain);
        let moves = explorer.moves();
        prop_assert!(moves.windows(2).all(|pair| pair[0].at_s < pair[1].at_s));
        prop_assert!(moves.iter().all(|m| m.at_s < deadline_s));
        for decision in explorer.decisions() {
            let t_d = rules.schedule.local_deadline(decision.deadline.edges, decision.at_s, deadline_s);
            prop_assert_eq!(decision.deadline, t_d);
            prop_assert_eq!(decision.plan().is_none(), decision.from == decision.target());
            if let Some(plan) = decision.plan() {
                prop_assert_eq!(plan.deadline_s(), t_d.seconds);
            }
            let first = moves.iter().position(|m| m.at_s == decision.at_s).unwrap();
            prop_assert_eq!(moves[first].from, decision.from);
            let following = moves[first..].iter().find(|m| m.purpose == Purpose::Explore);
            if let Some(following) = following {
                prop_assert_eq!(following.from, decision.target());
                prop_assert_eq!(following.leave.speed, Speed::Slow);
            }
        }
    }
}

/// Checks that S1 differs from the random strategy where rooms have a second door and so are worth returning to.
#[test]
fn uniform_corridors_first_is_not_random_where_rooms_have_two_doors() {
    let mut uniform = rules(Strategy::CorridorsFirst);
    uniform.corridors_first.among = Preference::Uniform;
    let differs = (0..40).any(|seed| {
        let building = without_goal(Building::random(seed, 9, 9, true));
        walk(&building, &uniform, 0, seed) != walk(&building, &rules(Strategy::Random), 0, seed)
    });
    assert!(differs);
}

#[test]
fn the_same_seeds_give_the_same_exploration_and_others_another() {
    let building = Building::office();
    for strategy in STRATEGIES {
        let run = |seed| walk(&building, &rules(strategy), 0, seed);
        assert_eq!(run(7), run(7));
        assert!((8..20).any(|seed| run(seed) != run(7)), "{strategy:?}");
    }
}

/// Checks K = 3, the start counting: in a corridor of many vertices that is two moves; with a dead end beside the start
/// three, back through it.
#[test]
fn the_first_moves_are_random_until_there_are_k_vertices() {
    let mut line = Building::default();
    let mut last = line.add(Place::Corridor);
    for _ in 0..9 {
        last = line.grow(last, Cardinal::East, Place::Corridor);
    }
    let initial = |building: &Building, rules: &Rules, start: usize, seed: u64| {
        let mut explorer = explorer(rules, 1e9, seed);
        building.explore(&mut explorer, start, 12.0, plain);
        let first = explorer.decisions()[0].at_s;
        let moves = explorer.moves();
        assert!(moves.iter().all(|m| (m.purpose == Purpose::Initial) == (m.at_s < first)));
        moves.iter().filter(|m| m.purpose == Purpose::Initial).count()
    };
    let rules = rules(Strategy::Frontier);
    assert_eq!(initial(&line, &rules, 0, 1), 2);
    for (k, moves) in [(1, 0), (5, 4)] {
        assert_eq!(initial(&line, &Rules { initial_vertices: k, ..rules.clone() }, 0, 1), moves);
    }
    // A T: west is a dead end. Going there first takes two more moves to come to a third vertex.
    let moves: std::collections::BTreeSet<usize> =
        (0..40).map(|seed| initial(&line, &rules, 1, seed)).collect();
    assert_eq!(moves, [2, 3].into());
}

/// Checks the other reading of "randomly moves around": back over a known edge, too, so that more moves are needed.
#[test]
fn the_first_moves_may_take_any_edge() {
    let mut line = Building::default();
    let mut last = line.add(Place::Corridor);
    for _ in 0..9 {
        last = line.grow(last, Cardinal::East, Place::Corridor);
    }
    let rules = Rules { initial_edges: InitialEdges::Any, ..rules(Strategy::Frontier) };
    let backs = (0..400).filter(|seed| walk(&line, &rules, 0, *seed).0[2] == 0).count();
    assert!((150..250).contains(&backs), "half of them turn back at once: {backs}");
}

/// Checks section 6's six maneuvers: none of corridors turns. A cross of corridors with a room beside an arm.
#[test]
fn a_turn_from_one_corridor_into_another_is_a_doors_maneuver() {
    use Cardinal::{East, North, South, West};
    let mut cross = Building::default();
    let center = cross.add(Place::Corridor);
    let arms = [East, North, West, South].map(|d| cross.grow(center, d, Place::Corridor));
    cross.grow(arms[0], North, Place::Room);
    let rules = |side_corridors| Rules { side_corridors, ..rules(Strategy::Random) };
    for (side_corridors, turned) in [
        (SideCorridors::Door, [Motion::DoorLeft, Motion::DoorRight]),
        (SideCorridors::Corridor, [Motion::Corridor; 2]),
    ] {
        let (mut turns, mut straight) = (0, 0);
        for seed in 0..20 {
            let (maneuvers, seeds) =
                (Maneuvers { side_corridors, ..maneuvers() }, Seeds::new(seed, Vec::new()));
            let mut explorer = Explorer::new(&rules(side_corridors), maneuvers, 1e9, &seeds);
            cross.explore(&mut explorer, arms[2], 12.0, plain);
            for pair in explorer.moves().windows(2) {
                let [before, Leave { exit, opening, through, motion, .. }] =
                    [pair[0].leave, pair[1].leave];
                if [before.opening, opening] != [Opening::Corridor; 2] {
                    continue;
                }
                if exit.axis() == before.exit.axis() {
                    assert_eq!((through, motion), (Through::Corridor, Motion::Corridor));
                    straight += 1;
                } else {
                    let left = usize::from(!matches!(exit, West | South));
                    assert_eq!((through, motion), (Through::SideCorridor, turned[left]));
                    turns += 1;
                }
            }
        }
        assert!(turns > 10 && straight > 10, "{turns} turns, {straight} straight on");
    }
}

/// Checks that each of three exits is taken first a third of the time, within five standard errors.
#[test]
fn the_first_moves_take_unexplored_edges_uniformly() {
    let mut cross = Building::default();
    let center = cross.add(Place::Corridor);
    for direction in [Cardinal::East, Cardinal::North, Cardinal::West] {
        let arm = cross.grow(center, direction, Place::Corridor);
        cross.grow(arm, direction, Place::Corridor);
    }
    let mut counts = [0_i32; 3];
    for seed in 0..1800 {
        let (visited, _) = walk(&cross, &rules(Strategy::Random), center, seed);
        counts[(visited[1] - 1) / 2] += 1;
        assert!(!visited[..3].iter().skip(1).any(|v| *v == center), "nor back where more is open");
    }
    assert!(counts.iter().all(|count| (count - 600).abs() < 100), "{counts:?}");
}

#[test]
fn a_goal_found_by_the_first_moves_ends_the_task() {
    let mut pair = Building::default();
    let start = pair.add(Place::Corridor);
    let goal = pair.grow(start, Cardinal::North, Place::Room);
    pair.goal = Some(goal);
    let mut explorer = explorer(&rules(Strategy::Frontier), 100.0, 0);
    let (visited, end) = pair.explore(&mut explorer, start, 12.0, plain);
    assert_eq!((visited, end), (vec![start, goal], Next::GlobalSuccess));
    assert_eq!(explorer.decisions().len(), 0);
    let mut at_home = self::explorer(&rules(Strategy::Frontier), 100.0, 0);
    assert_eq!(at_home.arrive(0.0, &pair.see(goal)), Next::GlobalSuccess);
}

#[test]
fn fewer_than_k_vertices_leave_nothing_to_explore() {
    let mut pair = Building::default();
    let start = pair.add(Place::Corridor);
    pair.grow(start, Cardinal::North, Place::Corridor);
    let (visited, end) = walk(&pair, &rules(Strategy::Random), start, 0);
    assert_eq!((visited.len(), end), (2, Next::GiveUp(GiveUp::NothingLeft)));
}

#[test]
fn the_deadline_ends_the_task_even_at_the_goal() {
    let mut pair = Building::default();
    let start = pair.add(Place::Corridor);
    let goal = pair.grow(start, Cardinal::North, Place::Room);
    pair.goal = Some(goal);
    let mut explorer = explorer(&rules(Strategy::Frontier), 12.0, 0);
    let (_, end) = pair.explore(&mut explorer, start, 12.0, plain);
    assert_eq!(end, Next::GiveUp(GiveUp::DeadlinePassed));
    assert_eq!(explorer.arrive(13.0, &pair.see(start)), end, "and stays ended");
}

#[test]
fn what_does_not_fit_the_map_ends_the_task_with_its_reason() {
    let exits = |direction| vec![Exit { direction, opening: Opening::Corridor }];
    let here = |tag: &str, direction| Intersection {
        tags: vec![tag.to_owned()],
        place: Place::Corridor,
        exits: exits(direction),
        is_goal: false,
    };
    let mut explorer = explorer(&rules(Strategy::Random), 100.0, 0);
    explorer.arrive(0.0, &here("a", Cardinal::East));
    let Next::GiveUp(why) = explorer.arrive(12.0, &here("b", Cardinal::North)) else {
        panic!("there is no way back")
    };
    assert_eq!(
        why.to_string(),
        "the map became inconsistent: c1a's exit to the east led to a new vertex, which has no exit back to the west"
    );
}

/// Checks the speed where no plan covers a move: slow, fast, or by the schedule, which has 30, 15 and 9 s for an edge.
#[test]
fn unplanned_moves_have_the_speed_of_their_rule() {
    let building = without_goal(Building::office());
    let fast_from = |unplanned_speed| {
        let rules = Rules { unplanned_speed, ..rules(Strategy::CorridorsFirst) };
        let mut explorer = explorer(&rules, 1000.0, 3);
        building.explore(&mut explorer, 0, 12.0, plain);
        let unplanned = explorer.moves().iter().filter(|m| m.purpose != Purpose::Navigate);
        let fast: Vec<f64> =
            unplanned.clone().filter(|m| m.leave.speed == Speed::Fast).map(|m| m.at_s).collect();
        let all = fast.len() == unplanned.count();
        (fast.iter().copied().reduce(f64::min), all)
    };
    assert_eq!(fast_from(UnplannedSpeed::Slow), (None, false));
    assert_eq!(fast_from(UnplannedSpeed::Fast), (Some(0.0), true));
    let (first, all) = fast_from(UnplannedSpeed::Schedule);
    assert!(first.is_some_and(|at_s| (500.0..600.0).contains(&at_s)) && !all, "{first:?}");
}

/// Checks that the planner changes speeds and nothing else: with the same choices, ablations visit the same vertices on
/// a tree.
#[test]
fn planners_are_compared_on_equal_choices() {
    let building = without_goal(Building::office());
    let run = |method: Method| {
        let mut rules = rules(Strategy::Random);
        rules.planner.method = method;
        let mut explorer = explorer(&rules, 1500.0, 2);
        let (visited, _) = building.explore(&mut explorer, 0, 12.0, plain);
        let navigating = explorer.moves().iter().filter(|m| m.purpose == Purpose::Navigate);
        let fast = navigating.clone().filter(|m| m.leave.speed == Speed::Fast).count();
        let plans: Vec<Status> =
            explorer.decisions().iter().filter_map(Decision::plan).map(Plan::status).collect();
        (visited, plans, fast, navigating.count())
    };
    let (visited, plans, fast, all) = run(Method::Cmdp);
    assert!(plans.contains(&Status::Slack) && plans.contains(&Status::Active), "{plans:?}");
    assert!(fast > 0 && fast < all, "{fast} of {all}");
    for (method, expected) in [(Method::AllSlow, 0), (Method::AllFast, all)] {
        let ablation = run(method);
        assert_eq!(
            (ablation.0, ablation.1, ablation.2),
            (visited.clone(), plans.clone(), expected)
        );
    }
    let threshold = run(Method::Threshold);
    assert_eq!((&threshold.0, &threshold.1), (&visited, &plans));
    assert!(threshold.2 > fast, "it speeds up whole legs: {} against {fast}", threshold.2);
}
