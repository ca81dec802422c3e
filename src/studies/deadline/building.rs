//! Buildings as graphs, for tests: the exits of vertices and where they lead, without walls or physics. The mind under
//! test sees intersections only.

use super::exploration::{Explorer, Next};
use super::intersection::{Exit, Intersection, Opening};
use crate::geometry::Cardinal;
use crate::rng::{Seeds, Stream};
use crate::studies::deadline::build_cmdp::{
    DoorPairs, Expectation, Maneuvers, Place, SideCorridors,
};
use std::collections::BTreeMap;

/// One vertex.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    pub(super) place: Place,
    pub(super) exits: [Option<(Opening, usize)>; 4],
}

/// A building.
#[derive(Debug, Clone, Default)]
pub(super) struct Building {
    pub(super) spots: Vec<Spot>,
    pub(super) goal: Option<usize>,
    sites: BTreeMap<(i32, i32), usize>,
}

impl Building {
    pub(super) fn add(&mut self, place: Place) -> usize {
        self.spots.push(Spot { place, exits: [None; 4] });
        self.spots.len() - 1
    }

    pub(super) fn join(&mut self, from: usize, direction: Cardinal, to: usize) {
        let places = [self.spots[from].place, self.spots[to].place];
        let opening = if places.contains(&Place::Room) { Opening::Door } else { Opening::Corridor };
        self.spots[from].exits[direction.index()] = Some((opening, to));
        self.spots[to].exits[direction.opposite().index()] = Some((opening, from));
    }

    /// Adds a vertex next to `from`.
    pub(super) fn grow(&mut self, from: usize, direction: Cardinal, place: Place) -> usize {
        let to = self.add(place);
        self.join(from, direction, to);
        to
    }

    /// Grows corridors on a lattice, some in loops, then rooms beside them with one door, or with `two_doors` some with
    /// more.
    pub(super) fn random(seed: u64, corridors: usize, rooms: usize, two_doors: bool) -> Self {
        let mut stream = Seeds::new(seed, Vec::new()).stream("building");
        let mut building = Self::default();
        building.place_at((0, 0), Place::Corridor);
        while building.spots.len() < corridors {
            building.extend(&mut stream, Place::Corridor, 0.15);
        }
        for _ in 0..rooms {
            building.extend(&mut stream, Place::Room, if two_doors { 0.4 } else { 0.0 });
        }
        building.goal = Some(building.spots.len() - 1);
        building
    }

    /// Creates an office floor of 47 vertices: a long corridor, two branches on each side, rooms beside them all.
    pub(super) fn office() -> Self {
        use Cardinal::{East, North, South, West};
        let mut office = Self::default();
        let mut spine = vec![office.add(Place::Corridor)];
        for _ in 1..13 {
            let last = spine[spine.len() - 1];
            spine.push(office.grow(last, East, Place::Corridor));
        }
        let beside = |office: &mut Self, v: usize, sides: [Cardinal; 2]| {
            for side in sides {
                if office.spots[v].exits[side.index()].is_none() {
                    office.grow(v, side, Place::Room);
                }
            }
        };
        for (k, direction) in [(2, North), (5, South), (8, North), (10, South)] {
            let mut at = spine[k];
            for _ in 0..3 {
                at = office.grow(at, direction, Place::Corridor);
                if office.spots.len() % 2 == 0 {
                    beside(&mut office, at, [East, West]);
                }
            }
        }
        for (k, v) in spine.iter().enumerate() {
            if k % 3 != 1 {
                beside(&mut office, *v, [North, South]);
            }
        }
        office.goal = Some(office.spots.len() - 1);
        office
    }

    fn place_at(&mut self, site: (i32, i32), place: Place) -> usize {
        let v = self.add(place);
        self.sites.insert(site, v);
        v
    }

    /// Adds a vertex on a random free site next to a corridor, joined to it, and with `chance` to each other corridor
    /// there.
    fn extend(&mut self, stream: &mut Stream, place: Place, chance: f64) {
        let corridors = self.sites.iter().filter(|(_, v)| self.spots[**v].place == Place::Corridor);
        let free: Vec<(usize, Cardinal, (i32, i32))> = corridors
            .flat_map(|(site, v)| Cardinal::ALL.map(|side| (*v, side, step(*site, side))))
            .filter(|(_, _, site)| !self.sites.contains_key(site))
            .collect();
        if free.is_empty() {
            return;
        }
        let (from, direction, site) = free[below(stream, free.len())];
        let to = self.place_at(site, place);
        self.join(from, direction, to);
        for side in Cardinal::ALL {
            if let Some(other) = self.sites.get(&step(site, side)).copied()
                && other != from
                && self.spots[other].place == Place::Corridor
                && stream.uniform() < chance
            {
                self.join(to, side, other);
            }
        }
    }

    /// Returns vertex `v` as the IDS would report it, with ids of tags by `name`.
    pub(super) fn intersection(
        &self,
        v: usize,
        name: impl Fn(usize, Option<Cardinal>) -> String,
    ) -> Intersection {
        let spot = &self.spots[v];
        let open = |direction: &Cardinal| spot.exits[direction.index()];
        let exits: Vec<Exit> = Cardinal::ALL
            .into_iter()
            .filter_map(|direction| {
                open(&direction).map(|(opening, _)| Exit { direction, opening })
            })
            .collect();
        let of_exits = exits.iter().map(|exit| name(v, Some(exit.direction)));
        Intersection {
            tags: std::iter::once(name(v, None)).chain(of_exits).collect(),
            place: spot.place,
            is_goal: self.goal == Some(v),
            exits,
        }
    }

    pub(super) fn see(&self, v: usize) -> Intersection {
        self.intersection(v, plain)
    }

    /// Lets `explorer` explore from `start`, `seconds` a move, and returns the vertices at which it arrives and how it
    /// ends.
    pub(super) fn explore(
        &self,
        explorer: &mut Explorer,
        start: usize,
        seconds: f64,
        name: impl Fn(usize, Option<Cardinal>) -> String,
    ) -> (Vec<usize>, Next) {
        let mut visited = vec![start];
        let mut now = 0.0;
        loop {
            let at = visited[visited.len() - 1];
            match explorer.arrive(now, &self.intersection(at, &name)) {
                Next::Leave(leave) => {
                    let (opening, to) = self.spots[at].exits[leave.exit.index()].unwrap();
                    assert_eq!(opening, leave.opening);
                    visited.push(to);
                }
                end => return (visited, end),
            }
            now += seconds;
            assert!(visited.len() < 100_000, "endless");
        }
    }
}

/// Returns ids of tags that describe what they are; nothing may depend on it.
pub(super) fn plain(v: usize, exit: Option<Cardinal>) -> String {
    match exit {
        None => format!("vertex-{v}"),
        Some(direction) => format!("vertex-{v}-{direction}"),
    }
}

pub(super) fn below(stream: &mut Stream, bound: usize) -> usize {
    usize::try_from(stream.below(bound as u64)).unwrap()
}

fn step((x, y): (i32, i32), direction: Cardinal) -> (i32, i32) {
    match direction {
        Cardinal::East => (x + 1, y),
        Cardinal::North => (x, y + 1),
        Cardinal::West => (x - 1, y),
        Cardinal::South => (x, y - 1),
    }
}

/// Returns six pairs of the size that the study's calibration finds.
pub(super) fn maneuvers() -> Maneuvers {
    let pair = |slow: (f64, f64), fast: (f64, f64)| {
        [slow, fast].map(|(time_s, failure)| Expectation { time_s, failure })
    };
    Maneuvers {
        corridor: pair((13.0, 0.004), (7.4, 0.008)),
        door_left: DoorPairs::alike(pair((12.1, 0.015), (6.9, 0.03))),
        door_right: DoorPairs::alike(pair((11.8, 0.013), (6.6, 0.028))),
        side_corridors: SideCorridors::Door,
    }
}
