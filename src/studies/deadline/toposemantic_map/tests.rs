//! Definition 1 on Figure 1's examples and on random explorations; Algorithm 1; observations that do not fit.

use super::*;
use crate::rng::{Seeds, Stream};
use crate::studies::deadline::building::{Building, below, plain};
use crate::studies::deadline::intersection::Exit;
use Cardinal::{East, North, South, West};
use proptest::prelude::*;

fn corridor(tag: &str, exits: &[Cardinal]) -> Intersection {
    seen(tag, Place::Corridor, exits, Opening::Corridor)
}

fn seen(tag: &str, place: Place, exits: &[Cardinal], opening: Opening) -> Intersection {
    let exits = exits.iter().map(|direction| Exit { direction: *direction, opening }).collect();
    Intersection { tags: vec![tag.to_owned()], place, exits, is_goal: false }
}

/// Returns `here` with a further door.
fn and_door(mut here: Intersection, direction: Cardinal) -> Intersection {
    here.exits.push(Exit { direction, opening: Opening::Door });
    here
}

/// Returns axis and S of the edge from one vertex to another: on which side of the first the second is.
fn side_between(map: &ToposemanticMap, from: VertexId, to: VertexId) -> (Axis, Side) {
    let edge = map.edges_from(from).find(|edge| edge.to == End::Vertex(to)).unwrap();
    (edge.axis(), edge.side())
}

fn labels(map: &ToposemanticMap) -> Vec<String> {
    map.ids().map(|v| map.label(v).to_string()).collect()
}

/// Checks figure 1a: "c1a is on the left of c1b, and c1c is on the right of c1b".
#[test]
fn figure_1a_three_vertices_along_e_w() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[East, West])).unwrap();
    let c = map.create_new_node(b, East, &corridor("c", &[West])).unwrap();
    assert_eq!(labels(&map), ["c1a", "c1b", "c1c"]);
    assert_eq!(side_between(&map, b, a), (Axis::EastWest, Side::Left));
    assert_eq!(side_between(&map, a, b), (Axis::EastWest, Side::Right));
    assert_eq!(side_between(&map, b, c), (Axis::EastWest, Side::Right));
    assert_eq!(map.check(), Ok(()));
}

/// Checks figure 1b: "c2a on the right of c2b and c2c on the left of c2b", where north is right.
#[test]
fn figure_1b_three_vertices_along_n_s() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[South])).unwrap();
    let b = map.create_new_node(a, South, &corridor("b", &[North, South])).unwrap();
    let c = map.create_new_node(b, South, &corridor("c", &[North])).unwrap();
    assert_eq!(side_between(&map, b, a), (Axis::NorthSouth, Side::Right));
    assert_eq!(side_between(&map, b, c), (Axis::NorthSouth, Side::Left));
    assert_eq!(side_between(&map, c, b), (Axis::NorthSouth, Side::Right));
    assert_eq!(map.check(), Ok(()));
}

/// Checks figure 1c: c1a on the left of c1b, a room on the left of c1b; c2a on the right of c2b, the room to the left
/// of c2b. The room then has two doors: south of c1b and west of c2b.
#[test]
fn figure_1c_corridors_and_a_room_between_them() {
    let mut map = ToposemanticMap::new();
    let c1a = map.begin(&corridor("1a", &[East])).unwrap();
    let c1b = map.create_new_node(c1a, East, &and_door(corridor("1b", &[West]), South)).unwrap();
    let room = seen("r", Place::Room, &[North, East], Opening::Door);
    let room = map.create_new_node(c1b, South, &room).unwrap();
    let c2b = map.create_new_node(room, East, &and_door(corridor("2b", &[North]), West)).unwrap();
    let c2a = map.create_new_node(c2b, North, &corridor("2a", &[South])).unwrap();
    assert_eq!(labels(&map), ["c1a", "c1b", "R1", "c2a", "c2b"]);
    assert_eq!(side_between(&map, c1b, c1a), (Axis::EastWest, Side::Left));
    assert_eq!(side_between(&map, c1b, room), (Axis::NorthSouth, Side::Left));
    assert_eq!(side_between(&map, c2b, c2a), (Axis::NorthSouth, Side::Right));
    assert_eq!(side_between(&map, c2b, room), (Axis::EastWest, Side::Left));
    assert_eq!(map.check(), Ok(()));
}

#[test]
fn algorithm_1_adds_both_edges_and_the_unexplored_ones() {
    let mut map = ToposemanticMap::new();
    let v = map.begin(&corridor("v", &[North])).unwrap();
    assert_eq!(map.unexplored_degree(v), 1);
    let new =
        map.create_new_node(v, North, &and_door(corridor("v'", &[South, West]), East)).unwrap();
    let edges: Vec<_> = map.edges().map(|e| (e.from, e.direction, e.opening, e.to)).collect();
    assert_eq!(
        edges,
        [
            (v, North, Opening::Corridor, End::Vertex(new)),
            (new, East, Opening::Door, End::Unexplored),
            (new, West, Opening::Corridor, End::Unexplored),
            (new, South, Opening::Corridor, End::Vertex(v)),
        ]
    );
    assert_eq!(map.unexplored(new).map(|edge| edge.side()).collect::<Vec<_>>(), {
        [Side::Right, Side::Left]
    });
}

#[test]
fn a_dead_end_is_a_corridor_vertex_of_degree_one() {
    let mut map = ToposemanticMap::new();
    let v = map.begin(&corridor("v", &[East])).unwrap();
    let end = map.create_new_node(v, East, &corridor("end", &[West])).unwrap();
    assert_eq!((map.edges_from(end).count(), map.unexplored_degree(end)), (1, 0));
    assert_eq!((map.place(end), map.label(end).to_string()), (Place::Corridor, "c1b".to_owned()));
}

/// Checks the last edge round a block: it arrives at the first vertex and resolves the open exit there too.
#[test]
fn a_loop_closes_at_both_ends() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East, North])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West, North])).unwrap();
    let c = map.create_new_node(b, North, &corridor("c", &[South, West])).unwrap();
    let d = map.create_new_node(c, West, &corridor("d", &[East, South])).unwrap();
    assert_eq!((map.unexplored_degree(a), map.unexplored_degree(d)), (1, 1));
    let back = map.arrive(d, South, &corridor("a", &[East, North]));
    assert_eq!(back, Ok((a, Arrival::LoopClosed)));
    assert_eq!(map.edges().filter(|edge| edge.to == End::Unexplored).count(), 0);
    assert_eq!(map.arrive(a, North, &corridor("d", &[East, South])), Ok((d, Arrival::Revisit)));
    assert_eq!(map.distances(a), [Some(0), Some(1), Some(2), Some(1)]);
    assert_eq!(map.check(), Ok(()));
    // A corridor along an axis, a new one across it.
    assert_eq!(labels(&map), ["c1a", "c1b", "c2a", "c3a"]);
}

/// Checks that any tag of the group is enough where the vertex tag is out of view, and that the others are learnt.
#[test]
fn a_vertex_is_recognised_by_any_of_its_tags() {
    let mut map = ToposemanticMap::new();
    let mut first = corridor("exit-1", &[East]);
    let a = map.begin(&first).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West])).unwrap();
    first.tags = vec!["vertex".to_owned(), "exit-1".to_owned()];
    first.exits.push(Exit { direction: North, opening: Opening::Door });
    assert_eq!(map.arrive(b, West, &first), Ok((a, Arrival::Revisit)));
    assert!(map.tags(a).contains("vertex"));
    assert_eq!(map.unexplored_degree(a), 1, "the door was not seen at first");
    assert_eq!(map.recognise(&corridor("vertex", &[])), Ok(Some(a)));
    assert_eq!(map.recognise(&corridor("other", &[])), Ok(None));
}

#[test]
fn corridors_run_straight_and_end_at_rooms_and_corners() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&and_door(corridor("a", &[East, North]), West)).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West, East])).unwrap();
    let c = map.create_new_node(b, East, &corridor("c", &[West, South])).unwrap();
    let room =
        map.create_new_node(a, West, &seen("r", Place::Room, &[East], Opening::Door)).unwrap();
    let d = map.create_new_node(c, South, &corridor("d", &[North])).unwrap();
    for v in [a, b, c] {
        assert_eq!(map.corridor(v, Axis::EastWest), [a, b, c]);
    }
    assert_eq!(map.corridor(c, Axis::NorthSouth), [d, c]);
    assert_eq!(map.corridor(a, Axis::NorthSouth), [a]);
    assert_eq!(map.corridor(room, Axis::EastWest), []);
}

#[test]
fn what_does_not_fit_is_told_and_changes_nothing() {
    let mut map = ToposemanticMap::new();
    assert_eq!(
        map.begin(&Intersection { tags: Vec::new(), ..corridor("", &[]) }).unwrap_err().to_string(),
        "the intersection has no tags; expected at least one"
    );
    let a = map.begin(&and_door(corridor("a", &[East, South, North]), West)).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West, North, South])).unwrap();
    let c = map.create_new_node(b, North, &corridor("c", &[South, West, East])).unwrap();
    let before = map.clone();
    let mut refused = |from, direction, here: &Intersection, expected: &str| {
        assert_eq!(map.arrive(from, direction, here).unwrap_err().to_string(), expected);
        assert_eq!(map, before);
    };
    let new = |exits: &[Cardinal]| corridor("new", exits);
    refused(b, East, &new(&[West]), "c1b has no exit to the east");
    refused(
        b,
        South,
        &new(&[East]),
        "c1b's exit to the south led to a new vertex, which has no exit back to the north",
    );
    refused(
        a,
        West,
        &new(&[East]),
        "c1a's exit to the west leads through a door, but a new vertex's exit back through a corridor",
    );
    refused(
        a,
        East,
        &new(&[West]),
        "c1a's exit to the east led to c1b before, and now to a new vertex",
    );
    refused(
        a,
        East,
        &corridor("c", &[South, West]),
        "c1a's exit to the east led to c1b before, and now to c2a",
    );
    refused(
        c,
        East,
        &corridor("b", &[]),
        "c2a's exit to the east led to c1b, whose exit back leads to c1a",
    );
    refused(
        a,
        South,
        &corridor("c", &[]),
        "c1a's exit to the south led to c2a, which has no exit back to the north",
    );
    refused(
        b,
        South,
        &corridor("b", &[]),
        "c1b's exit to the south led back to c1b; expected another vertex",
    );
    refused(
        a,
        North,
        &corridor("b", &[]),
        "c1a's exits to the east and to the north both lead to c1b",
    );
    refused(b, South, &seen("a", Place::Room, &[North], Opening::Door), "c1a was seen as a room");
    let mut both = corridor("a", &[North]);
    both.tags.push("c".to_owned());
    refused(b, South, &both, "tags of c1a and of c2a were seen as one intersection");
    refused(
        b,
        South,
        &corridor("d", &[North, North]),
        "the intersection has two exits to the north; expected at most one in each direction",
    );
    assert_eq!(
        map.create_new_node(b, South, &corridor("a", &[North])).unwrap_err().to_string(),
        "c1a is in the map already"
    );
    assert_eq!(
        map.begin(&new(&[])).unwrap_err().to_string(),
        "the map already begins at c1a; arrive at further vertices by an exit"
    );
}

/// Checks that `check` finds breaches that no operation makes.
#[test]
fn an_inconsistent_map_is_found() {
    let mut map = ToposemanticMap::new();
    let a = map.begin(&corridor("a", &[East, North])).unwrap();
    let b = map.create_new_node(a, East, &corridor("b", &[West, South])).unwrap();
    let broken = |change: &dyn Fn(&mut ToposemanticMap)| {
        let mut map = map.clone();
        change(&mut map);
        map.check().unwrap_err().to_string()
    };
    let open = Some((Opening::Corridor, End::Unexplored));
    let to = |v| Some((Opening::Corridor, End::Vertex(v)));
    assert_eq!(
        broken(&|map| map.vertices[1].exits[West.index()] = open),
        "there is an edge from vertex 0 to vertex 1 and none back"
    );
    assert_eq!(
        broken(&|map| {
            map.vertices[1].exits[West.index()] = None;
            map.vertices[1].exits[South.index()] = to(a);
        }),
        "the edges between vertices 0 and 1 run along different axes"
    );
    assert_eq!(
        broken(&|map| {
            map.vertices[1].exits[West.index()] = None;
            map.vertices[1].exits[East.index()] = to(a);
        }),
        "vertices 0 and 1 are on the same side of each other"
    );
    assert_eq!(
        broken(&|map| map.vertices[0].exits[North.index()] = to(b)),
        "edge 0 to 1 is a loop or is there twice"
    );
    assert_eq!(
        broken(&|map| map.vertices[1].label = map.vertices[0].label),
        "vertices 0 and 1 have the same label"
    );
    assert_eq!(
        broken(&|map| map.vertices[1].tags = map.vertices[0].tags.clone()),
        "vertices 0 and 1 share a tag"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Checks random walks through random buildings: Definition 1 holds throughout, every edge of the map is one of the
    /// building, and every edge walked is explored.
    #[test]
    fn a_walk_maps_the_building(seed in 0_u64..1_000_000, corridors in 2_usize..16, rooms in 0_usize..8) {
        let building = Building::random(seed, corridors, rooms, true);
        let mut stream = Seeds::new(seed, Vec::new()).stream("walk");
        let mut at = below(&mut stream, building.spots.len());
        let mut map = ToposemanticMap::new();
        let mut ids = BTreeMap::from([(at, map.begin(&building.see(at)).unwrap())]);
        for _ in 0..80 {
            let directions: Vec<Cardinal> = building.see(at).exits.iter().map(|e| e.direction).collect();
            let direction = directions[below(&mut stream, directions.len())];
            let to = building.spots[at].exits[direction.index()].unwrap().1;
            let (v, arrival) = map.arrive(ids[&at], direction, &building.see(to)).unwrap();
            let known = ids.insert(to, v);
            prop_assert_eq!(known.is_none(), arrival == Arrival::New);
            prop_assert!(known.is_none_or(|known| known == v));
            prop_assert_eq!(map.check(), Ok(()));
            prop_assert_eq!(map.edge(ids[&at], direction).unwrap().to, End::Vertex(v));
            at = to;
        }
        for (spot, v) in &ids {
            prop_assert_eq!(map.place(*v), building.spots[*spot].place);
            for edge in map.edges_from(*v) {
                let (opening, to) = building.spots[*spot].exits[edge.direction.index()].unwrap();
                prop_assert_eq!(edge.opening, opening);
                if let End::Vertex(end) = edge.to {
                    prop_assert_eq!(end, ids[&to]);
                }
            }
            prop_assert_eq!(map.edges_from(*v).count(), building.see(*spot).exits.len());
        }
    }

    /// Checks that the map stays consistent, or refuses and stays as it is, whatever is claimed in whatever order.
    #[test]
    fn nonsense_never_breaks_the_map(seed in 0_u64..1_000_000) {
        let mut stream = Seeds::new(seed, Vec::new()).stream("nonsense");
        let mut map = ToposemanticMap::new();
        let nonsense = |stream: &mut Stream, tag: usize| {
            let mut exits = Vec::new();
            for direction in Cardinal::ALL {
                if stream.uniform() < 0.6 {
                    let opening = if stream.uniform() < 0.8 { Opening::Corridor } else { Opening::Door };
                    exits.push(Exit { direction, opening });
                }
            }
            let tags = vec![plain(tag, None)];
            Intersection { tags, place: Place::Corridor, exits, is_goal: false }
        };
        map.begin(&nonsense(&mut stream, 0)).unwrap();
        for _ in 0..120 {
            let from = VertexId(below(&mut stream, map.len()));
            let direction = Cardinal::ALL[below(&mut stream, 4)];
            let tag = below(&mut stream, 10);
            let here = nonsense(&mut stream, tag);
            let before = map.clone();
            if map.arrive(from, direction, &here).is_err() {
                prop_assert_eq!(&map, &before);
            }
            prop_assert_eq!(map.check(), Ok(()));
        }
    }
}
