use super::*;
use crate::geometry::{Axis, Pose};

/// A corridor `a` - `b` along E-W with the room `r` north of `b`, where the goal is.
const SMALL: &str = "\
a green 0 0 0
a-east white 0.5 0 0
b green 5 0 0
b-west white 4.5 0 180
b-north yellow 5 0.5 90
r blue 5 3 0
r-south yellow 5 2.5 -90
star red 5.3 3 0
poster mauve 9 9 0
";

fn tags(text: &str) -> Vec<Tag> {
    let tag = |line: &str| {
        let [id, color, x, y, heading] = line.split(' ').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let [x, y, heading] = [x, y, heading].map(|number| number.parse::<f64>().unwrap());
        let pose = Pose::new(x, y, heading.to_radians());
        Tag { id: id.to_owned(), color: color.to_owned(), pose }
    };
    text.lines().map(tag).collect()
}

fn faults(from: &str, to: &str) -> Vec<String> {
    assert!(SMALL.contains(from), "{from}");
    let tags = tags(&SMALL.replacen(from, to, 1));
    let faults = Topology::read(&tags, &TagScheme::default()).unwrap_err();
    faults.iter().map(ToString::to_string).collect()
}

#[test]
fn tags_mean_vertices_exits_and_a_goal() {
    let topology = Topology::read(&tags(SMALL), &TagScheme::default()).unwrap();
    let vertices: Vec<_> = topology
        .vertices
        .iter()
        .map(|vertex| (vertex.tag.as_str(), vertex.kind, vertex.exits.len(), vertex.is_goal))
        .collect();
    let (corridor, room) = (RegionKind::Corridor, RegionKind::Room);
    assert_eq!(
        vertices,
        [("a", corridor, 1, false), ("b", corridor, 2, false), ("r", room, 1, true)]
    );
    let exits: Vec<_> =
        topology.vertices[1].exits.iter().map(|e| (e.direction, e.opening, e.to)).collect();
    assert_eq!(
        exits,
        [(Cardinal::North, Opening::Door, 2), (Cardinal::West, Opening::Corridor, 0)],
        "counter-clockwise from east"
    );
    let edges: Vec<_> = topology.edges().map(|e| (e.from, e.to, e.direction.axis())).collect();
    assert_eq!(edges, [(0, 1, Axis::EastWest), (1, 2, Axis::NorthSouth)]);
    assert_eq!(topology.distances_to_goal(), [Some(2), Some(1), Some(0)]);
    assert!(topology.is_connected() && topology.loops() == 0);
    assert_eq!(topology.vertex_near(Point::new(4.9, 0.1), 0.2), Some(1));
    assert_eq!(topology.vertex_near(Point::new(2.5, 0.0), 0.2), None);
}

#[test]
fn ids_and_order_say_nothing_and_colours_are_values() {
    let mut renamed = tags(SMALL);
    renamed.reverse();
    for (number, tag) in renamed.iter_mut().enumerate() {
        tag.id = format!("t{number}");
        if tag.color == "red" {
            tag.color = "gold".to_owned();
        }
    }
    let scheme = TagScheme { goal: "gold".to_owned(), ..TagScheme::default() };
    let topology = Topology::read(&renamed, &scheme).unwrap();
    assert_eq!(topology.distances_to_goal(), [Some(0), Some(1), Some(2)]);
}

#[test]
fn a_ring_has_one_loop_and_an_island_is_seen() {
    let corner = |name: &str, x: i32, y: i32, ways: [(&str, i32, i32, i32); 2]| {
        let mut text = format!("{name} green {x} {y} 0\n");
        for (way, dx, dy, heading) in ways {
            let (at_x, at_y) =
                (f64::from(x) + 0.5 * f64::from(dx), f64::from(y) + 0.5 * f64::from(dy));
            text.push_str(&format!("{name}{way} white {at_x} {at_y} {heading}\n"));
        }
        text
    };
    let (east, north) = (("e", 1, 0, 0), ("n", 0, 1, 90));
    let (west, south) = (("w", -1, 0, 180), ("s", 0, -1, -90));
    let ring = corner("a", 0, 0, [east, north])
        + &corner("b", 4, 0, [west, north])
        + &corner("c", 4, 4, [west, south])
        + &corner("d", 0, 4, [east, south]);
    let topology = Topology::read(&tags(&ring), &TagScheme::default()).unwrap();
    assert_eq!((topology.loops(), topology.is_connected()), (1, true));
    let island =
        ring + "x green 20 20 0\nxe white 20.5 20 0\ny green 24 20 0\nyw white 23.5 20 180\n";
    let topology = Topology::read(&tags(&island), &TagScheme::default()).unwrap();
    assert_eq!((topology.loops(), topology.is_connected()), (1, false));
    assert_eq!(topology.distances_to_goal(), [None; 6], "there is no goal");
}

#[test]
fn what_breaks_the_convention_is_said_in_words() {
    for (from, to, said) in [
        (
            "a-east white 0.5 0 0",
            "a-east white 2.5 0 0",
            "the white tag `a-east` at (2.5, 0) m belongs to no vertex: expected a vertex tag within 1 m",
        ),
        (
            "b green 5 0 0\nb-west white 4.5 0 180",
            "b green 1.5 0 0\nb-west white 1.3 0 180",
            "the vertex tags `a` and `b` are 1.50 m apart: expected at least 2 m",
        ),
        (
            "a-east white 0.5 0 0",
            "a-east white 0.5 0 30",
            "the exit tag `a-east` faces 30.0 degrees: expected east, north, west or south",
        ),
        (
            "a-east white 0.5 0 0",
            "a-east white 0 0.5 0",
            "the exit tag `a-east` faces east but does not stand east of its vertex `a`",
        ),
        (
            "a-east white 0.5 0 0",
            "a-east white 0.5 0 0\nagain yellow 0.6 0 0",
            "the vertex `a` has two exits to the east: `a-east` and `again`",
        ),
        (
            "a-east white 0.5 0 0",
            "a-east white 0.5 0 0\na-south white 0 -0.5 -90",
            "the exit `a-south` has no other end: there is no vertex tag south of it",
        ),
        (
            "b-west white 4.5 0 180\n",
            "",
            "the exit `a-east` leads east to the vertex `b`, which has no exit west that leads back",
        ),
        (
            "b-west white 4.5 0 180",
            "b-west yellow 4.5 0 180",
            "the exits `a-east` and `b-west` are of one edge and differ in colour",
        ),
        (
            "b-north yellow 5 0.5 90\nr blue 5 3 0\nr-south yellow",
            "b-north white 5 0.5 90\nr blue 5 3 0\nr-south white",
            "the room `r` has the corridor exit `r-south`: expected exits through doors alone",
        ),
        ("a-east white 0.5 0 0\n", "", "the corridor vertex `a` has no exit through a corridor"),
        ("r-south yellow 5 2.5 -90\n", "", "the room `r` has no exit"),
    ] {
        let found = faults(from, to);
        assert!(found.iter().any(|fault| fault == said), "{said}: {found:#?}");
    }
    assert_eq!(
        faults("b-west white 4.5 0 180\n", "").len(),
        2,
        "an exit without a way back, and a corridor vertex with a door alone"
    );
}
