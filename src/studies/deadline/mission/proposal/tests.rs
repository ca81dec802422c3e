use super::timing::{Cuts, Hazards, Pace, Sums, Timing};
use super::walk::{Leg, Site, Walk};
use crate::rng::Seeds;
use crate::studies::deadline::build_cmdp::{Maneuvers, Motion, SideCorridors};
use crate::studies::deadline::building;
use crate::studies::deadline::exploration::{Explorer, Next, Purpose};
use crate::studies::deadline::intersection::Intersection;
use crate::studies::deadline::is_entry;
use crate::studies::deadline::mission::graph_level::places;
use crate::studies::deadline::rules::{InitialEdges, Rules, UnplannedSpeed};
use crate::studies::deadline::schedule::Schedule;
use crate::studies::deadline::strategy::{
    CompleteCorridor, Completion, CorridorOf, CorridorsFirst, Frontier, Preference, Strategy, Ties,
};
use crate::world::generate::{Family, generate};
use crate::world::topology::{TagScheme, Topology};

/// Returns the first generated buildings without a loop, where no two ways are equally good.
fn trees(count: usize) -> Vec<Topology> {
    (1..)
        .map(|seed| {
            let world = generate(Family::OfficeFloor, seed).unwrap();
            Topology::read(&world.tags, &TagScheme::default()).unwrap()
        })
        .filter(|topology| topology.loops() == 0)
        .take(count)
        .collect()
}

fn without_goals(topology: &Topology) -> Vec<Intersection> {
    let mut places = places(topology);
    for place in &mut places {
        place.is_goal = false;
    }
    places
}

fn all_rules() -> Vec<Rules> {
    let mut all = Vec::new();
    let strategies = [
        Strategy::Random,
        Strategy::Frontier,
        Strategy::NormalizedFrontier,
        Strategy::CorridorsFirst,
        Strategy::CompleteCorridor,
    ];
    for strategy in strategies {
        for other in [false, true] {
            all.push(Rules {
                strategy,
                frontier: Frontier { ties: if other { Ties::Nearest } else { Ties::Uniform } },
                corridors_first: CorridorsFirst {
                    among: if other { Preference::MostUnexplored } else { Preference::Nearest },
                },
                complete_corridor: CompleteCorridor {
                    corridor: if other { CorridorOf::InHand } else { CorridorOf::Located },
                    finished: if other { Completion::Explored } else { Completion::Extended },
                    ..CompleteCorridor::default()
                },
                initial_edges: if other { InitialEdges::Any } else { InitialEdges::Unexplored },
                ..Rules::default()
            });
        }
    }
    all
}

/// Lets the mind itself explore without end, and returns its moves as legs of a walk.
fn explored(topology: &Topology, rules: &Rules, maneuvers: Maneuvers, seeds: &Seeds) -> Vec<Leg> {
    let mut mind = Explorer::new(rules, maneuvers, 1e9, seeds);
    let places = without_goals(topology);
    let (mut at, mut now, mut legs, mut chosen) = (0, 0.0, Vec::<Leg>::new(), 0);
    while let Next::Leave(leave) = mind.arrive(now, &places[at]) {
        let planned = mind.moves().last().unwrap().purpose == Purpose::Navigate;
        // A plan's moves are one leg.
        let goes_on = planned && mind.decisions().len() == chosen && legs.last().unwrap().planned;
        chosen = mind.decisions().len();
        if !goes_on {
            legs.push(Leg { planned, corridors: 0, doors: 0, entries: 0, to: 0 });
        }
        let exits = &topology.vertices[at].exits;
        at = exits.iter().find(|exit| exit.direction == leave.exit).unwrap().to;
        let leg = legs.last_mut().unwrap();
        match leave.motion {
            Motion::Corridor => leg.corridors += 1,
            Motion::DoorLeft | Motion::DoorRight => leg.doors += 1,
        }
        leg.entries += u8::from(is_entry(leave.through, maneuvers.side_corridors));
        leg.to = u8::try_from(at).unwrap();
        now += 10.0;
    }
    legs
}

#[test]
fn a_walk_goes_where_the_mind_goes() {
    let mut compared = 0;
    for side_corridors in [SideCorridors::Door, SideCorridors::Corridor] {
        let maneuvers = Maneuvers { side_corridors, ..building::maneuvers() };
        for (number, topology) in trees(3).iter().enumerate() {
            let places = without_goals(topology);
            let site = Site { topology, places: &places, maneuvers: &maneuvers };
            for rules in all_rules() {
                let seeds = Seeds::new(number as u64, Vec::new());
                let walk = site.walk(&rules, 0, &mut seeds.stream("exploration"));
                assert_eq!(walk, explored(topology, &rules, maneuvers, &seeds), "{rules:?}");
                compared += walk.len();
            }
        }
    }
    assert!(compared > 3000, "{compared}");
}

fn pace() -> Pace {
    Pace {
        corridor: [12.0, 8.0],
        door: [10.0, 6.0],
        entry: 0.05,
        other: 0.01,
        look_around: 9.0,
        unplanned: UnplannedSpeed::Slow,
    }
}

const LEGS: [Leg; 3] = [
    Leg { planned: false, corridors: 1, doors: 0, entries: 0, to: 1 },
    Leg { planned: true, corridors: 2, doors: 0, entries: 0, to: 2 },
    Leg { planned: false, corridors: 0, doors: 1, entries: 1, to: 3 },
];

#[test]
fn survival_is_carried_along_and_a_deadline_cuts_it() {
    // 9, 21, 45 and 55 s: with 30 s an edge no leg is hurried.
    let schedule = Schedule { seconds_per_edge: 100.0, ..Schedule::default() };
    let deadlines = [100.0, 50.0, 5.0];
    let timing = Timing::new(pace(), &schedule, &deadlines);
    let walk = Walk::new(0, LEGS.to_vec(), &[None, None, None, Some(0), Some(1)]);
    assert_eq!(walk.arrivals, [Some(3), None]);
    let (mut sums, mut cuts) = (Sums::none(2, 3, true), Cuts::default());
    timing.cut(&walk.legs, &mut cuts);
    Hazards::of(&pace()).add(&walk, &cuts, &mut Vec::new(), &mut sums);
    let corridors = 0.99_f64 * 0.99 * 0.99;
    let reached = corridors * 0.95;
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    close(sums.reached[0], reached);
    close(sums.collided[0], 1.0 - reached);
    // Where it is reached it takes 55 s.
    close(sums.time_s(0).unwrap(), 55.0);
    assert_eq!(sums.time_s(3), None, "a goal that is never reached");
    // After 50 s the door is half passed.
    close(sums.reached[1], 0.0);
    close(sums.collided[1], 1.0 - corridors + (corridors - reached) * 0.5);
    // Nothing happens before the first look is over.
    assert_eq!([sums.reached[2], sums.collided[2]], [0.0, 0.0]);
    // The second goal is never reached: the walk ends at the third vertex.
    close(sums.reached[3], 0.0);
    close(sums.collided[3], 1.0 - reached);
}

#[test]
fn a_leg_takes_its_local_deadline_between_all_slow_and_all_fast() {
    let arrival = |seconds_per_edge: f64| {
        let schedule = Schedule { seconds_per_edge, ..Schedule::default() };
        let deadlines = [1000.0];
        let timing = Timing::new(pace(), &schedule, &deadlines);
        let mut cuts = Cuts::default();
        // A third leg that takes 12 s a corridor ends after the deadline: the share tells when it began.
        let last = Leg { planned: false, corridors: 200, doors: 0, entries: 0, to: 3 };
        timing.cut(&[LEGS[0], LEGS[1], last], &mut cuts);
        1000.0 - cuts.each[0].share * 2400.0
    };
    // 21 s until the plan begins; two edges slow are 24 s, fast 16.
    for (seconds_per_edge, expected) in [(30.0, 45.0), (10.0, 41.0), (5.0, 37.0)] {
        let found = arrival(seconds_per_edge);
        assert!((found - expected).abs() < 1e-9, "{seconds_per_edge}: {found}");
    }
}
