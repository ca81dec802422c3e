use super::*;
use crate::document::Source;
use crate::geometry::{Cardinal, Outline, Point};
use crate::world::topology::Vertex;
use std::collections::BTreeSet;

/// Half a robot's width and some: no edge comes nearer to a wall.
const CLEAR: f64 = 0.28;

const ENGINEERING: &str = include_str!("../../../worlds/engineering-building.yaml");

/// Asserts the properties of every building of the family, and returns its graph.
fn check(world: &World) -> Topology {
    let name = &world.name;
    let topology = Topology::read(&world.tags, &TagScheme::default())
        .unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    let solids: Vec<Outline> = world.contact(0.0, 0.5);

    // Orthogonal walls and regions.
    let polygons = world.regions.iter().map(|region| Outline::Polygon(region.polygon.clone()));
    for side in solids.iter().cloned().chain(polygons).flat_map(|o| o.sides().collect::<Vec<_>>()) {
        let along = side.b - side.a;
        assert!(along.x.abs() < 1e-9 || along.y.abs() < 1e-9, "{name}: {side:?}");
    }
    let bounds = world.bounds();
    assert!((58.0..=68.0).contains(&bounds.width()), "{name}: {bounds:?}");
    assert!((36.0..=44.0).contains(&bounds.height()), "{name}: {bounds:?}");

    // The graph.
    let rooms = topology.vertices.iter().filter(|v| v.kind == RegionKind::Room).count();
    let regions = world.regions.iter().filter(|r| r.kind == RegionKind::Room).count();
    assert!((VERTICES[0]..=VERTICES[1]).contains(&topology.vertices.len()), "{name}");
    assert!((ROOM_VERTICES[0]..=ROOM_VERTICES[1]).contains(&rooms), "{name}: {rooms}");
    assert!((ROOM_VERTICES[0]..=ROOM_VERTICES[1]).contains(&regions), "{name}: {regions}");
    assert!(topology.is_connected() && topology.loops() <= 1, "{name}");
    assert_eq!(world.tags.len(), topology.vertices.len() + 2 * topology.edges().count() + 1);
    let ids: BTreeSet<&str> = world.tags.iter().map(|tag| tag.id.as_str()).collect();
    assert_eq!(ids.len(), world.tags.len(), "{name}");

    // Every vertex lies in a region of its kind, every room is entered, and there is space around every vertex.
    let region_of =
        |at: Point| world.regions.iter().find(|r| Outline::Polygon(r.polygon.clone()).contains(at));
    let clearance = |at: Point| solids.iter().map(|s| s.distance(at)).fold(f64::INFINITY, f64::min);
    let mut entered = BTreeSet::new();
    for (number, vertex) in topology.vertices.iter().enumerate() {
        let region = region_of(vertex.at).unwrap_or_else(|| panic!("{name}: {vertex:?}"));
        assert_eq!(region.kind, vertex.kind, "{name}: {vertex:?}");
        assert!(clearance(vertex.at) >= 0.9, "{name}: {vertex:?}");
        entered.insert(region.name.as_str());
        if vertex.kind == RegionKind::Corridor {
            let ways = vertex.exits.iter().filter(|e| e.opening == Opening::Corridor).count();
            // A crossing, a place beside a door, or an end: never a mere point of a corridor.
            assert!(ways != 2 || vertex.exits.len() > 2, "{name}: {vertex:?}");
        }
        for other in &topology.vertices[..number] {
            assert!(other.at.distance(vertex.at) >= 2.0, "{name}: {vertex:?} {other:?}");
        }
    }
    assert_eq!(entered.len(), world.regions.len(), "{name}");

    // Every edge can be driven: the straight line is clear, doors and corridors are as wide as they should be.
    for edge in topology.edges() {
        let (from, to) = (topology.vertices[edge.from].at, topology.vertices[edge.to].at);
        let length = from.distance(to);
        assert!((2.0..=6.0).contains(&length), "{name}: {edge:?} of {length} m");
        let near = (0..=40).map(|i| clearance(from + (to - from) * (f64::from(i) / 40.0)));
        let least = near.fold(f64::INFINITY, f64::min);
        assert!(least >= CLEAR, "{name}: {edge:?} {least}");
        match edge.opening {
            Opening::Door => assert!((0.449..=0.52).contains(&least), "{name}: {edge:?} {least}"),
            Opening::Corridor => {
                // Past the fire door where a branch opens, or along the middle.
                let fits = (0.579..=0.621).contains(&least) || (0.999..=1.251).contains(&least);
                assert!(fits, "{name}: {edge:?} {least}");
            }
        }
    }

    // Goal and starts.
    let goals: Vec<usize> = topology.goals().collect();
    assert_eq!(goals.len(), 1, "{name}");
    let goal = &topology.vertices[goals[0]];
    assert_eq!((goal.kind, goal.exits.len()), (RegionKind::Room, 1), "{name}");
    assert_eq!(world.goals["goal"], goal.at, "{name}");
    let distances = topology.distances_to_goal();
    assert_eq!(world.starts.len(), 3, "{name}");
    for (start, range) in START_DISTANCES {
        let pose = world.starts[start];
        let number = topology.vertex_near(pose.position(), 1e-9).unwrap();
        let distance = distances[number].unwrap();
        assert!((range[0]..=range[1]).contains(&distance), "{name}: {start} {distance}");
        let vertex = &topology.vertices[number];
        assert_eq!(vertex.kind, RegionKind::Corridor, "{name}: {start}");
        let facing = Cardinal::from_heading(pose.heading);
        let way = vertex.exits.iter().find(|exit| exit.direction == facing);
        assert_eq!(way.map(|exit| exit.opening), Some(Opening::Corridor), "{name}: {start}");
    }

    // The goal is on a branch, and another branch has more four-way vertices, three at least.
    let four_ways = |region: &str| {
        let of_region = |v: &&Vertex| region_of(v.at).is_some_and(|r| r.name == region);
        topology.vertices.iter().filter(of_region).filter(|v| v.exits.len() == 4).count()
    };
    let beside = &topology.vertices[goal.exits[0].to];
    let branch = region_of(beside.at).unwrap().name.as_str();
    let branches = world
        .regions
        .iter()
        .filter(|r| r.kind == RegionKind::Corridor && r.name != "C1")
        .map(|r| r.name.as_str());
    assert!(branches.clone().any(|name| name == branch), "{name}: {branch}");
    let most = branches.map(four_ways).max().unwrap();
    assert!(most >= 3 && four_ways(branch) < most, "{name}: {most} {}", four_ways(branch));
    topology
}

fn engineering() -> World {
    let source = Source::new("worlds/engineering-building.yaml", ENGINEERING);
    document::read(&source, None).unwrap()
}

#[test]
fn the_engineering_building_is_of_the_family() {
    let world = engineering();
    let topology = check(&world);
    let rooms = topology.vertices.iter().filter(|v| v.kind == RegionKind::Room).count();
    assert_eq!((topology.vertices.len(), rooms, topology.loops()), (49, 23, 1));
    let names = topology.names(&world.regions);
    for name in ["C1a", "C1n", "C2a", "C3e", "C4d", "R1", "R2a", "R2b", "R7a", "R7b", "R18", "R20"]
    {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
    let c2a = names.iter().position(|name| name == "C2a").unwrap();
    assert_eq!(topology.vertices[c2a].at, Point::new(10.5, 27.9), "from south to north");
    let distances = topology.distances_to_goal();
    let of = |start: &str| {
        let at = world.starts[start].position();
        distances[topology.vertex_near(at, 1e-9).unwrap()].unwrap()
    };
    assert_eq!((of("A"), of("B"), of("C")), (2, 5, 9));
    let bounds = world.bounds();
    assert!((bounds.width() - 62.4).abs() < 1e-9 && (bounds.height() - 41.8).abs() < 1e-9);
}

#[test]
fn every_seed_to_a_thousand_is_a_building_and_a_sample_keeps_every_rule() {
    for seed in 0..1000 {
        document(Family::OfficeFloor, seed).unwrap();
    }
    for seed in (0..12).chain([97, 512, 999, u64::MAX]) {
        check(&generate(Family::OfficeFloor, seed).unwrap());
    }
}

/// Checks that the buildings are the pinned ones. The generator's version is the engine's: raise that together with
/// these.
#[test]
fn buildings_are_pinned() {
    let meanings: Vec<String> =
        (0..3).map(|seed| generate(Family::OfficeFloor, seed).unwrap().meaning().short()).collect();
    assert_eq!(meanings, ["3147a5d5", "57b9b39d", "930b8d66"]);
}

#[test]
fn a_building_is_written_and_read_again() {
    for seed in (0..8).chain([u64::MAX]) {
        let text = document(Family::OfficeFloor, seed).unwrap().to_yaml();
        let begin = format!("reenact-world: 1\nname: office-floor-{seed}\nsource: ");
        assert!(text.starts_with(&begin), "{text}");
        let world = document::read(&Source::new("b.yaml", text), None).unwrap();
        assert_eq!(world, generate(Family::OfficeFloor, seed).unwrap());
        assert_ne!(world.meaning(), generate(Family::OfficeFloor, seed ^ 8).unwrap().meaning());
    }
}

#[test]
fn ids_of_tags_are_shuffled() {
    let world = generate(Family::OfficeFloor, 0).unwrap();
    let changes = world.tags.windows(2).filter(|pair| pair[0].color != pair[1].color).count();
    assert!(changes > world.tags.len() / 3, "{changes}");
}

#[test]
fn a_seed_without_a_building_is_said() {
    let error = Unsatisfied { family: Family::OfficeFloor, seed: 12, attempts: 500 };
    assert_eq!(
        error.to_string(),
        "no building of the family `office-floor` was found for seed 12 in 500 attempts"
    );
}
