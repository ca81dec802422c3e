//! Plans against the linear programme, the exported document, and the corridor's closed form.

use super::*;
use crate::cmdp::solve_document;
use crate::rng::Seeds;
use crate::studies::deadline::build_cmdp::{DoorPairs, Expectation, Place};
use crate::studies::deadline::building::{Building, below, maneuvers};
use crate::studies::deadline::toposemantic_map::End;
use proptest::prelude::*;
use serde_json::Value;

fn planning(method: Method) -> Planning {
    Planning { method, ..Planning::default() }
}

fn stream() -> Stream {
    Seeds::new(1, Vec::new()).stream("policy")
}

/// Returns the whole building as a map, from its first vertex on.
fn mapped(building: &Building) -> ToposemanticMap {
    let mut map = ToposemanticMap::new();
    let mut spots = vec![0];
    map.begin(&building.see(0)).unwrap();
    loop {
        let open = map.edges().find(|edge| edge.to == End::Unexplored);
        let Some(edge) = open else { return map };
        let spot = spots[edge.from.index()];
        let to = building.spots[spot].exits[edge.direction.index()].unwrap().1;
        map.arrive(edge.from, edge.direction, &building.see(to)).unwrap();
        if map.len() > spots.len() {
            spots.push(to);
        }
    }
}

/// Returns a corridor of `n` edges going east, with its two ends.
fn corridor(n: usize) -> (ToposemanticMap, VertexId, VertexId) {
    let mut building = Building::default();
    let mut last = building.add(Place::Corridor);
    for _ in 0..n {
        last = building.grow(last, Cardinal::East, Place::Corridor);
    }
    let map = mapped(&building);
    let (first, last) = (map.ids().next().unwrap(), map.ids().last().unwrap());
    (map, first, last)
}

/// Draws expectations, out of the study's range too: speeds that are alike, fast ones that are safer, failures of zero.
fn some_maneuvers(stream: &mut Stream) -> Maneuvers {
    let mut some = maneuvers();
    let mut vary = |both: &mut [Expectation; 2]| {
        let kind = below(stream, 6);
        both[0].time_s *= stream.between(0.8, 1.3);
        match kind {
            0 => both[1] = both[0],
            1 => both[1].failure = both[0].failure,
            2 => both[1].failure = 0.5 * both[0].failure,
            3 => both[0].failure = 0.0,
            _ => {}
        }
    };
    vary(&mut some.corridor);
    for door in [&mut some.door_left, &mut some.door_right] {
        vary(&mut door.entering);
        *door = DoorPairs::alike(door.entering);
    }
    some
}

/// Draws a task on a random building, its deadline anywhere between impossible and easy.
fn some_task(seed: u64) -> (ToposemanticMap, VertexId, VertexId, f64, Maneuvers) {
    let mut stream = Seeds::new(seed, Vec::new()).stream("task");
    let map = mapped(&Building::random(seed, 2 + below(&mut stream, 14), 6, true));
    let expectations =
        if seed.is_multiple_of(2) { maneuvers() } else { some_maneuvers(&mut stream) };
    let ids: Vec<VertexId> = map.ids().collect();
    let from = ids[below(&mut stream, ids.len())];
    let others: Vec<VertexId> = ids.into_iter().filter(|v| *v != from).collect();
    let to = others[below(&mut stream, others.len())];
    #[expect(clippy::cast_precision_loss, reason = "few edges")]
    let edges = map.distances(from)[to.index()].unwrap() as f64;
    (map, from, to, edges * stream.between(4.0, 16.0), expectations)
}

/// Returns the plan of the linear programme, even where none is needed.
fn programme(plan: &Plan) -> Plan {
    Plan::solved(plan.problem.clone()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Checks that a plan without a programme is the programme's: the same policy, the same status, the same totals.
    #[test]
    fn shortcuts_are_the_programmes_policy(seed in 0_u64..1_000_000) {
        let (map, from, to, deadline_s, expectations) = some_task(seed);
        let plan =
            Plan::new(&map, from, to, deadline_s, &planning(Method::Cmdp), &expectations).unwrap();
        let solved = programme(&plan);
        prop_assert_eq!(plan.status(), solved.status());
        prop_assert!((plan.time_s() - solved.time_s()).abs() < 1e-9 * solved.time_s());
        prop_assert!((plan.failure() - solved.failure()).abs() < 1e-9);
        for v in map.ids() {
            prop_assert_eq!(plan.choices(v), solved.choices(v));
        }
    }

    /// Checks that the exported document's solution is the executed policy, to the bit.
    #[test]
    fn the_exported_model_has_the_executed_policy(seed in 0_u64..1_000_000, reach: bool) {
        let (map, from, to, deadline_s, expectations) = some_task(seed);
        let reading = if reach { CostReading::Reach } else { CostReading::Additive };
        let planning = Planning { reading, ..Planning::default() };
        let plan = Plan::new(&map, from, to, deadline_s, &planning, &expectations).unwrap();
        prop_assert_eq!(disagreement(&plan, &map), None);
    }

    /// Checks that every plan arrives, whatever the draws, and takes at least as many steps as a shortest path.
    #[test]
    fn a_plan_arrives(seed in 0_u64..1_000_000) {
        let (map, from, to, deadline_s, expectations) = some_task(seed);
        let mut stream = Seeds::new(seed, Vec::new()).stream("policy");
        for method in [Method::Cmdp, Method::AllSlow, Method::AllFast, Method::Threshold] {
            let plan =
                Plan::new(&map, from, to, deadline_s, &planning(method), &expectations).unwrap();
            let mut at = from;
            let mut steps = 0;
            while at != to {
                let action = plan.action(at, &mut stream).unwrap();
                let End::Vertex(next) = map.edge(at, action.exit).unwrap().to else {
                    panic!("plans take explored edges")
                };
                at = next;
                steps += 1;
                prop_assert!(steps <= 10 * map.len());
            }
            let shortest = map.distances(from)[to.index()].unwrap();
            prop_assert!(steps >= shortest);
            prop_assert!(method == Method::Cmdp || steps == shortest);
        }
    }
}

/// Solves the document of `plan` and compares; `None` where all agree.
fn disagreement(plan: &Plan, map: &ToposemanticMap) -> Option<String> {
    let document = plan.document().unwrap().unwrap();
    let answer: Value = serde_json::from_str(&solve_document(&document).unwrap()).unwrap();
    if answer["status"] != "optimal" {
        return Some(format!("{answer} of {document}"));
    }
    let written: Value = serde_json::from_str(&document).unwrap();
    let policy = answer["policy"].as_array().unwrap();
    for v in map.ids() {
        let executed: Vec<(String, f64)> = plan
            .choices(v)
            .into_iter()
            .map(|(action, probability)| {
                let End::Vertex(to) = map.edge(v, action.exit).unwrap().to else { unreachable!() };
                let speed = speed_name(action.speed);
                let motion = motion_name(action.motion);
                let name = format!("{} to {}: {motion}, {speed}", map.label(v), map.label(to));
                (name, probability)
            })
            .collect();
        let solved: Vec<(String, f64)> = policy
            .iter()
            .filter(|row| row[0] == v.index())
            .map(|row| {
                let action = usize::try_from(row[1].as_u64().unwrap()).unwrap();
                (written["actions"][action].as_str().unwrap().to_owned(), row[2].as_f64().unwrap())
            })
            .collect();
        if !executed.is_empty() && executed != solved {
            return Some(format!("at {}: {executed:?}, {solved:?}", map.label(v)));
        }
    }
    None
}

/// Checks that the optimum is zero by the reading that minimises the probability of failing, where slow maneuvers never
/// fail.
#[test]
fn a_way_that_cannot_fail_is_planned() {
    let (map, from, to, deadline_s, expectations) = some_task(189_231);
    let planning = Planning { reading: CostReading::Reach, ..Planning::default() };
    let plan = Plan::new(&map, from, to, deadline_s, &planning, &expectations).unwrap();
    assert_eq!(plan.failure(), 0.0);
    assert_eq!(disagreement(&plan, &map), None);
}

/// Checks a corridor of n equal edges: all slow while t_d allows, then as little speed as meets it, then all fast.
#[test]
fn a_corridor_is_sped_up_as_far_as_needed() {
    let (map, from, to) = corridor(10);
    let fast_edges = |deadline_s: f64| {
        let plan =
            Plan::new(&map, from, to, deadline_s, &planning(Method::Cmdp), &maneuvers()).unwrap();
        let fast: f64 = map
            .ids()
            .flat_map(|v| plan.choices(v))
            .filter(|(action, _)| action.speed == Speed::Fast)
            .map(|(_, probability)| probability)
            .sum();
        (plan.status(), fast)
    };
    let [slow, fast] = maneuvers().corridor.map(|e| e.time_s);
    assert_eq!(fast_edges(300.0), (Status::Slack, 0.0), "30 s an edge, slow takes 13 s");
    assert_eq!(fast_edges(150.0), (Status::Slack, 0.0));
    let (status, share) = fast_edges(90.0);
    assert_eq!(status, Status::Active);
    assert!((share - (10.0 * slow - 90.0) / (slow - fast)).abs() < 1e-9, "{share}");
    assert_eq!(fast_edges(70.0), (Status::Relaxed, 10.0), "7 s an edge, fast takes 7.4 s");
}

#[test]
fn ablations_take_the_shortest_path_at_their_speed() {
    let (map, from, to) = corridor(4);
    let speeds = |method: Method, deadline_s: f64| {
        let plan = Plan::new(&map, from, to, deadline_s, &planning(method), &maneuvers()).unwrap();
        assert_eq!(plan.document(), Ok(None));
        let speeds: Vec<Speed> =
            map.ids().flat_map(|v| plan.choices(v)).map(|(action, _)| action.speed).collect();
        assert!(speeds.len() == 4 && speeds.iter().all(|speed| *speed == speeds[0]));
        (speeds[0], plan.status())
    };
    // 4 edges: 52 s slow, 29.6 s fast.
    for (deadline_s, status) in
        [(60.0, Status::Slack), (40.0, Status::Active), (20.0, Status::Relaxed)]
    {
        assert_eq!(speeds(Method::AllSlow, deadline_s), (Speed::Slow, status));
        assert_eq!(speeds(Method::AllFast, deadline_s), (Speed::Fast, status));
        let threshold = if status == Status::Slack { Speed::Slow } else { Speed::Fast };
        assert_eq!(speeds(Method::Threshold, deadline_s), (threshold, status));
    }
}

/// Checks that P_f is a bound on a sum by default: 40 slow edges at 0.004 add up to 0.16, and a bound of 0.1 cannot be
/// met.
#[test]
fn a_failure_bound_that_cannot_be_met_is_dropped_and_written_so() {
    let (map, from, to) = corridor(40);
    let planning = Planning { failure_bound: 0.1, ..Planning::default() };
    let plan = Plan::new(&map, from, to, 600.0, &planning, &maneuvers()).unwrap();
    assert!(plan.failure_bound_dropped());
    assert_eq!(plan.status(), Status::Slack);
    assert_eq!(disagreement(&plan, &map), None);
    assert!((plan.failure() - 0.16).abs() < 1e-12);
    let hurried = Plan::new(&map, from, to, 100.0, &planning, &maneuvers()).unwrap();
    assert!(hurried.failure_bound_dropped());
    assert_eq!(hurried.status(), Status::Relaxed);
    assert_eq!(disagreement(&hurried, &map), None);
}

#[test]
fn a_number_is_drawn_only_where_the_policy_is_randomised() {
    let (map, from, to) = corridor(3);
    let plan = |deadline_s| {
        Plan::new(&map, from, to, deadline_s, &planning(Method::Cmdp), &maneuvers()).unwrap()
    };
    let mut drawn = stream();
    plan(300.0).action(from, &mut drawn).unwrap();
    assert_eq!(drawn.bits(), stream().bits(), "nothing was drawn");
    // 31.8 s allow one fast edge and a half: at one vertex chance decides, evenly.
    let plan = plan(39.0 - 1.5 * 5.6);
    let randomised: Vec<VertexId> = map.ids().filter(|v| plan.choices(*v).len() > 1).collect();
    assert_eq!(randomised.len(), 1);
    let mut stream = stream();
    let fast = (0..4000)
        .filter(|_| plan.action(randomised[0], &mut stream).unwrap().speed == Speed::Fast)
        .count();
    assert!(fast.abs_diff(2000) < 160, "{fast} of 4000, five standard errors are 158");
}

#[test]
fn what_cannot_be_planned_is_told() {
    let (map, from, to) = corridor(2);
    let middle = map.ids().nth(1).unwrap();
    let plan = |from, to, expectations: Maneuvers| {
        Plan::new(&map, from, to, 60.0, &planning(Method::Cmdp), &expectations)
    };
    let back = plan(middle, to, maneuvers()).unwrap();
    assert_eq!(
        back.action(from, &mut stream()).unwrap_err().to_string(),
        "the plan from c1b to c1c never leads to c1a"
    );
    let mut endless = maneuvers();
    endless.corridor[0].time_s = f64::NAN;
    assert_eq!(
        plan(from, to, endless).unwrap_err().to_string(),
        "the navigation task makes no model: the time (s) of corridor, slow is NaN; \
         expected a finite number >= 0"
    );
    // Two vertices with nothing explored between them.
    let topology = Topology { vertices: vec![Place::Corridor; 2], edges: Vec::new() };
    let problem = Problem {
        topology,
        task: Task { from: 0, to: 1, deadline_s: 10.0, failure: 0.99, reading: Reading::Additive },
        expectations: maneuvers(),
        labels: vec!["c1a".to_owned(), "c2a".to_owned()],
        exits: Vec::new(),
    };
    assert_eq!(
        Plan::solved(problem).unwrap_err().to_string(),
        "no explored edges lead from c1a to c2a"
    );
}
