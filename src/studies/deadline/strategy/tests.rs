//! The paper's statements on each strategy, on maps small enough to see.

use super::Strategy;
use super::*;
use crate::geometry::Cardinal::{self, East, North, South, West};
use crate::rng::Seeds;
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::building::{Building, below};
use crate::studies::deadline::intersection::{Exit, Intersection, Opening};
use crate::studies::deadline::rules::Rules;
use proptest::prelude::*;

fn stream(seed: u64) -> Stream {
    Seeds::new(seed, Vec::new()).stream("exploration")
}

fn exit(direction: Cardinal, opening: Opening) -> Exit {
    Exit { direction, opening }
}

fn corridor(tag: &str, corridors: &[Cardinal], doors: &[Cardinal]) -> Intersection {
    let white = corridors.iter().map(|direction| exit(*direction, Opening::Corridor));
    let yellow = doors.iter().map(|direction| exit(*direction, Opening::Door));
    Intersection {
        tags: vec![tag.to_owned()],
        place: Place::Corridor,
        exits: white.chain(yellow).collect(),
        is_goal: false,
    }
}

fn room(tag: &str, doors: &[Cardinal]) -> Intersection {
    Intersection { place: Place::Room, ..corridor(tag, &[], doors) }
}

/// Returns the map a (3 unexplored) - b (1) - c (3), and beside b a room with another door (1): a, b, c, the room.
fn map() -> (ToposemanticMap, [VertexId; 4]) {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East, North], &[West, South])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[East, West], &[North, South])).unwrap();
    let c = map.create_new_node(b, East, &corridor("c", &[East, West, North], &[South])).unwrap();
    let r = map.create_new_node(b, North, &room("r", &[South, East])).unwrap();
    (map, [a, b, c, r])
}

/// Counts how often each of the four vertices is chosen from `current` in 3000 trials.
fn counts(rules: &Rules, current: usize) -> [i32; 4] {
    let (map, vertices) = map();
    let mut counts = [0; 4];
    for seed in 0..3000 {
        let mut chooser = Chooser::new(rules);
        let next = chooser.next(&map, vertices[current], None, &mut stream(seed)).unwrap();
        counts[next.index()] += 1;
    }
    counts
}

/// Returns whether `counts` are those of a uniform choice among the vertices of `among`, within five standard errors.
fn is_uniform(counts: [i32; 4], among: &[usize]) -> bool {
    let share = 1.0 / f64::from(u32::try_from(among.len()).unwrap());
    let error = 5.0 * (3000.0 * share * (1.0 - share)).sqrt();
    counts.iter().enumerate().all(|(v, count)| {
        let expected = if among.contains(&v) { 3000.0 * share } else { 0.0 };
        (f64::from(*count) - expected).abs() <= error * f64::from(u8::from(among.contains(&v)))
    })
}

fn rules(strategy: Strategy) -> Rules {
    Rules { strategy, ..Rules::default() }
}

#[test]
fn random_is_uniform_over_all_vertices_with_unexplored_edges() {
    let counts = counts(&rules(Strategy::Random), 1);
    assert!(is_uniform(counts, &[0, 1, 2, 3]), "{counts:?}");
}

#[test]
fn frontier_is_uniform_over_those_with_the_most_unexplored_edges() {
    let literal = counts(&rules(Strategy::Frontier), 0);
    assert!(is_uniform(literal, &[0, 2]), "{literal:?}");
    let mut nearest = rules(Strategy::Frontier);
    nearest.frontier.ties = Ties::Nearest;
    assert_eq!(counts(&nearest, 0), [3000, 0, 0, 0]);
    let from_the_middle = counts(&nearest, 1);
    assert!(is_uniform(from_the_middle, &[0, 2]), "both are one edge away: {from_the_middle:?}");
}

/// Checks S(v) = 0.5 deg / 3 - 0.5 d / 2, from a: a 0.5, b 1/6 - 1/4, c 0.5 - 0.5, the room 1/6 - 1/2.
#[test]
fn normalised_frontier_is_the_papers_equation() {
    let (map, [a, b, c, r]) = map();
    let rule = NormalizedFrontier::default();
    let values = rule.values(&Candidates::new(&map, a));
    let expected = [(a, 0.5), (b, 1.0 / 6.0 - 0.25), (c, 0.0), (r, 1.0 / 6.0 - 0.5)];
    for ((v, s), (w, t)) in values.iter().zip(expected) {
        assert_eq!(*v, w);
        assert!((s - t).abs() < 1e-15, "{v}: {s}, {t}");
    }
    assert_eq!(counts(&rules(Strategy::NormalizedFrontier), 3), [0, 0, 0, 3000], "1/6 where it is");
}

/// Checks the ends of γ: with deg only (γ = 1) it is the frontier whose ties go to the nearest; with distance only
/// (γ = 0) the nearest.
#[test]
fn normalised_frontier_at_the_ends_of_gamma() {
    let mut rules = rules(Strategy::NormalizedFrontier);
    rules.normalized_frontier.gamma = 1.0;
    assert_eq!(counts(&rules, 0), [3000, 0, 0, 0]);
    rules.normalized_frontier.gamma = 0.0;
    assert_eq!(counts(&rules, 3), [0, 0, 0, 3000]);
}

/// Checks "We choose a closer vertex when one or more equivalent ones are present": 3 edges 2 away and 1 edge 0 away
/// are worth the same where γ (3/3) - (1-γ) 2/2 = γ/3, which gives γ = 3/5.
#[test]
fn normalised_frontier_breaks_ties_by_distance() {
    let (map, [a, _, c, r]) = map();
    let rule = NormalizedFrontier { gamma: 0.6 };
    let values = rule.values(&Candidates::new(&map, r));
    let value = |v: VertexId| values.iter().find(|(w, _)| *w == v).unwrap().1;
    assert!((value(a) - value(r)).abs() < 1e-15 && (value(c) - value(r)).abs() < 1e-15);
    for seed in 0..20 {
        assert_eq!(rule.choose(&Candidates::new(&map, r), &mut stream(seed)), Some(r));
    }
}

/// Checks one candidate, where the robot stands: every distance is zero.
#[test]
fn normalised_frontier_with_all_distances_zero() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East, North], &[])).unwrap();
    let rule = NormalizedFrontier::default();
    assert_eq!(rule.values(&Candidates::new(&map, a)), [(a, 0.5)]);
    assert_eq!(rule.choose(&Candidates::new(&map, a), &mut stream(0)), Some(a));
}

#[test]
fn corridors_come_before_rooms() {
    let nearest = counts(&rules(Strategy::CorridorsFirst), 3);
    assert_eq!(nearest, [0, 3000, 0, 0], "not the room that it is in");
    let mut other = rules(Strategy::CorridorsFirst);
    other.corridors_first.among = Preference::Uniform;
    let uniform = counts(&other, 3);
    assert!(is_uniform(uniform, &[0, 1, 2]), "{uniform:?}");
    other.corridors_first.among = Preference::MostUnexplored;
    let most = counts(&other, 0);
    assert_eq!(most, [3000, 0, 0, 0], "as many as the far one, and nearer");
    // Only the room is left.
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[], &[North])).unwrap();
    let r = map.create_new_node(a, North, &room("r", &[South, East])).unwrap();
    let mut chooser = Chooser::new(&rules(Strategy::CorridorsFirst));
    assert_eq!(chooser.next(&map, a, None, &mut stream(0)), Some(r));
}

#[test]
fn nothing_left_is_nothing_chosen() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East], &[])).unwrap();
    map.create_new_node(a, East, &corridor("b", &[West], &[])).unwrap();
    for strategy in [
        Strategy::Random,
        Strategy::Frontier,
        Strategy::NormalizedFrontier,
        Strategy::CorridorsFirst,
        Strategy::CompleteCorridor,
    ] {
        assert_eq!(Chooser::new(&rules(strategy)).next(&map, a, None, &mut stream(0)), None);
    }
}

/// Returns how the robot came by its last move, from `from` towards `direction`.
const fn came(from: VertexId, direction: Cardinal, opening: Opening) -> Came {
    Came { from, direction, opening }
}

fn in_hand() -> Rules {
    let mut rules = rules(Strategy::CompleteCorridor);
    rules.complete_corridor.corridor = CorridorOf::InHand;
    rules.complete_corridor.finished = Completion::Explored;
    rules
}

/// Checks "finishes exploring the corridor it is located in" and "can no longer be extended": from wherever a random edge has
/// led the robot it is that corridor which is gone on with, not the one before.
#[test]
fn the_corridor_it_is_located_in_is_extended_first() {
    // c1: a - b going east and on; c2 goes north from b, over n and on. Each has a door besides.
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East], &[North])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[East, West, North], &[])).unwrap();
    let n = map.create_new_node(b, North, &corridor("n", &[South, North], &[East])).unwrap();
    let rules = rules(Strategy::CompleteCorridor);
    let from = |at, came| Chooser::new(&rules).next(&map, at, came, &mut stream(1)).unwrap();
    assert_eq!(
        from(n, Some(came(b, North, Opening::Corridor))),
        n,
        "it is in c2, which goes on at n"
    );
    assert_eq!(from(b, Some(came(n, South, Opening::Corridor))), n, "it is in c2 still");
    assert_eq!(
        from(b, Some(came(a, East, Opening::Corridor))),
        b,
        "it is in c1, which goes on at b"
    );
    // In the room at a's door: c1 passes it, whatever the door's own direction.
    let r = map.create_new_node(a, North, &room("r", &[South])).unwrap();
    let from = |at, came| Chooser::new(&rules).next(&map, at, came, &mut stream(1)).unwrap();
    assert_eq!(from(r, Some(came(a, North, Opening::Door))), b);
    // In the room at n's door: c2 passes that.
    let s = map.create_new_node(n, East, &room("s", &[West])).unwrap();
    let from = |at, came| Chooser::new(&rules).next(&map, at, came, &mut stream(1)).unwrap();
    assert_eq!(from(s, Some(came(n, East, Opening::Door))), n);
}

/// Checks that a corridor which cannot be extended is left, though doors of it are unexplored, and that a stated option
/// explores them first.
#[test]
fn a_corridor_that_cannot_be_extended_is_left() {
    // c1: a - b - c going east to its end, with two doors at a; another corridor goes south from b.
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East], &[North, South])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West, East, South], &[])).unwrap();
    let c = map.create_new_node(b, East, &corridor("c", &[West], &[North])).unwrap();
    let r = map.create_new_node(c, North, &room("r", &[South])).unwrap();
    let mut rules = rules(Strategy::CompleteCorridor);
    rules.complete_corridor.inside = Preference::MostUnexplored;
    let next = |rules: &Rules| {
        let arrived = Some(came(c, North, Opening::Door));
        Chooser::new(rules).next(&map, r, arrived, &mut stream(0))
    };
    assert_eq!(next(&rules), Some(b), "the nearest to begin a new one with");
    rules.complete_corridor.finished = Completion::Explored;
    assert_eq!(next(&rules), Some(a), "two doors of c1 are left");
}

/// Checks, by the reading that keeps a corridor in hand, that from the middle of the corridor c1 it goes to c1's ends
/// although a crossing corridor is as near, and comes back from that.
#[test]
fn a_corridor_in_hand_is_completed_before_another_begins() {
    // c1: a - b - c going east, all with a door; a second corridor goes north from b.
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East], &[North])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[East, West, North], &[])).unwrap();
    let c = map.create_new_node(b, East, &corridor("c", &[West], &[South])).unwrap();
    let n = map.create_new_node(b, North, &corridor("n", &[South, North], &[East, West])).unwrap();
    let mut chooser = Chooser::new(&in_hand());
    let first = chooser.next(&map, b, None, &mut stream(1)).unwrap();
    assert!([a, c].contains(&first), "{first}");
    let (near, far) = if first == a { ((a, North), (c, South)) } else { ((c, South), (a, North)) };
    let shut = |map: &mut ToposemanticMap, (v, direction): (VertexId, Cardinal), tag: &str| {
        map.create_new_node(v, direction, &room(tag, &[direction.opposite()])).unwrap()
    };
    let inside = shut(&mut map, near, "near");
    // From the new room, and even from the crossing corridor, back to what is left of c1.
    assert_eq!(chooser.next(&map, inside, None, &mut stream(2)), Some(far.0));
    assert_eq!(chooser.next(&map, n, None, &mut stream(2)), Some(far.0));
    shut(&mut map, far, "far");
    assert_eq!(chooser.next(&map, far.0, None, &mut stream(3)), Some(n), "c1 is finished");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Checks that any strategy, driven through any building, only ever chooses a vertex with unexplored edges, keeps
    /// its rule, and leaves nothing unexplored.
    #[test]
    fn every_choice_keeps_the_rule(seed in 0_u64..1_000_000, which in 0_usize..5, keeps: bool) {
        let strategy = [
            Strategy::Random,
            Strategy::Frontier,
            Strategy::NormalizedFrontier,
            Strategy::CorridorsFirst,
            Strategy::CompleteCorridor,
        ][which];
        let building = Building::random(seed, 2 + usize::try_from(seed % 14).unwrap(), 6, true);
        let mut stream = stream(seed);
        let mut rules = rules(strategy);
        if keeps {
            rules.complete_corridor = in_hand().complete_corridor;
        }
        let mut chooser = Chooser::new(&rules);
        let mut came = None;
        let mut map = ToposemanticMap::new();
        let mut spots = vec![below(&mut stream, building.spots.len())];
        let mut current = map.begin(&building.see(spots[0])).unwrap();
        let mut in_hand = None;
        while let Some(target) = chooser.next(&map, current, came, &mut stream) {
            let candidates = Candidates::new(&map, current);
            prop_assert!(candidates.open().contains(&target));
            let place = |v: &VertexId| map.place(*v);
            let any_corridor = candidates.open().iter().any(|v| place(v) == Place::Corridor);
            match strategy {
                Strategy::Frontier => {
                    let most = candidates.open().iter().map(|v| candidates.degree(*v)).max();
                    prop_assert_eq!(Some(candidates.degree(target)), most);
                }
                Strategy::CorridorsFirst => {
                    prop_assert!(!any_corridor || place(&target) == Place::Corridor);
                }
                Strategy::CompleteCorridor if !keeps => {
                    prop_assert!(!any_corridor || place(&target) == Place::Corridor);
                }
                Strategy::CompleteCorridor => {
                    // A corridor in hand that has anything left is not left for another.
                    let now = chooser.complete_corridor.in_hand();
                    if let Some((member, axis)) = in_hand {
                        let before = map.corridor(member, axis);
                        let left = candidates.open().iter().any(|v| before.contains(v));
                        prop_assert!(!left || before.contains(&target));
                        prop_assert!(!left || now == in_hand);
                    }
                    prop_assert!(!any_corridor || place(&target) == Place::Corridor);
                    in_hand = now;
                }
                _ => {}
            }
            let edges: Vec<_> = map.unexplored(target).collect();
            let edge = uniform(&edges, &mut stream).unwrap();
            let spot = spots[target.index()];
            let to = building.spots[spot].exits[edge.direction.index()].unwrap().1;
            let arrived = map.arrive(target, edge.direction, &building.see(to)).unwrap();
            current = arrived.0;
            came = Some(Came { from: target, direction: edge.direction, opening: edge.opening });
            if map.len() > spots.len() {
                spots.push(to);
            }
        }
        prop_assert_eq!(map.len(), building.spots.len());
        prop_assert!(map.ids().all(|v| map.unexplored_degree(v) == 0));
    }
}
