//! How long the planner takes by the number of states: a slippery grid, the shape of the search that a robot
//! in a building asks for, and the model of a navigation task. Goal: 50 states in at most 5 ms.
//!
//! `cargo bench --bench cmdp_solve`

use reenact::cmdp::{Cmdp, CmdpBuilder, solve};
use reenact::studies::deadline::build_cmdp::{
    DoorPairs, Expectation, Maneuvers, Navigation, OrientedEdge, Place, Reading, Side,
    SideCorridors, Task, Through, Topology, build_cmdp,
};

fn main() {
    divan::main();
}

const SIZES: [usize; 6] = [5, 20, 50, 100, 200, 300];

/// A grid of about `states` cells, four moves at two speeds, slips to a neighbour, two bounds that bind.
fn grid(states: usize) -> Cmdp {
    let width = (2..=states).find(|w| w * w >= states).expect("some width suffices");
    let cells = width * states.div_ceil(width);
    let mut builder = CmdpBuilder::new(cells, 8);
    let expected = "the grid is valid";
    builder.absorb(cells - 1).expect(expected);
    builder.initial(0, 1.0).expect(expected);
    let mut costs = Vec::new();
    for x in 0..cells {
        let neighbours = [
            (x % width + 1 < width).then_some(x + 1),
            Some(x + width),
            (x % width > 0).then(|| x - 1),
            x.checked_sub(width),
        ];
        let near: Vec<usize> = neighbours.into_iter().flatten().filter(|y| *y < cells).collect();
        for (k, y) in near.iter().enumerate() {
            for fast in 0..2 {
                let action = 2 * k + fast;
                // Not all alike, so that there is something to weigh.
                let odd =
                    1.0 + 0.01 * f64::from(u8::try_from((7 * x + 3 * k) % 11).expect("below 11"));
                let slip = if fast == 1 { 0.1 } else { 0.02 };
                builder.transition(x, action, *y, 1.0 - slip).expect(expected);
                builder.transition(x, action, near[(k + 1) % near.len()], slip).expect(expected);
                let time = if fast == 1 { 4.0 } else { 9.0 } * odd;
                let failure = if fast == 1 { 0.03 } else { 0.01 } * odd;
                costs.push((x, action, failure, time));
            }
        }
    }
    let path = f64::from(u32::try_from(2 * width).expect("small"));
    builder.secondary("failure", 0.024 * path).expect(expected);
    builder.secondary("time-s", 6.8 * path).expect(expected);
    for (x, action, failure, time) in costs {
        builder.primary(x, action, 1.0).expect(expected);
        builder.secondary_cost(0, x, action, failure).expect(expected);
        builder.secondary_cost(1, x, action, time).expect(expected);
    }
    builder.build().expect(expected)
}

/// A corridor with a room at every other vertex, to be crossed by `deadline_s` per edge.
fn building(states: usize, deadline_s: f64) -> Navigation {
    let corridors = 2 * states / 3;
    let mut topology = Topology { vertices: vec![Place::Corridor; corridors], edges: Vec::new() };
    let mut link = |from: usize, to: usize, [there, back]: [Through; 2]| {
        topology.edges.push(OrientedEdge { from, to, side: Side::Right, through: there });
        topology.edges.push(OrientedEdge { from: to, to: from, side: Side::Left, through: back });
    };
    (1..corridors).for_each(|x| link(x - 1, x, [Through::Corridor; 2]));
    (corridors..states).for_each(|room| {
        link(2 * (room - corridors), room, [Through::Entering, Through::Leaving]);
    });
    topology.vertices.resize(states, Place::Room);
    let both = |time_s: f64, failure: f64| {
        [
            Expectation { time_s, failure },
            Expectation { time_s: 0.5 * time_s, failure: 3.0 * failure },
        ]
    };
    let maneuvers = Maneuvers {
        corridor: both(10.0, 0.002),
        door_left: DoorPairs::alike(both(8.0, 0.004)),
        door_right: DoorPairs::alike(both(7.0, 0.003)),
        side_corridors: SideCorridors::Door,
    };
    let edges = f64::from(u32::try_from(corridors - 1).expect("small"));
    let task = Task {
        from: 0,
        to: corridors - 1,
        deadline_s: deadline_s * edges,
        failure: 0.99,
        reading: Reading::Additive,
    };
    build_cmdp(&topology, &task, &maneuvers).expect("the building is valid")
}

#[divan::bench(args = SIZES)]
fn slippery_grid(bencher: divan::Bencher<'_, '_>, states: usize) {
    let cmdp = grid(states);
    bencher.bench_local(|| solve(&cmdp).expect("solved"));
}

#[divan::bench(args = SIZES)]
fn navigation_within_the_deadline(bencher: divan::Bencher<'_, '_>, states: usize) {
    let navigation = building(states, 8.0);
    bencher.bench_local(|| navigation.plan().expect("solved"));
}

#[divan::bench(args = SIZES)]
fn navigation_beyond_the_deadline(bencher: divan::Bencher<'_, '_>, states: usize) {
    let navigation = building(states, 3.0);
    bencher.bench_local(|| navigation.plan().expect("solved"));
}
