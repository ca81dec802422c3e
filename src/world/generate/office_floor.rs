//! Office floors: an E-W corridor of about 60 m, two or three branches to the north and south of it, rooms on both
//! sides. The counts and sizes follow from what Tables 1 and 2 of the deadline study imply about its building.
//!
//! Canonically the goal's branch goes north near the west end and the largest branch south near it; mirrors turn that.
//!
//! Corridors:
//! 1. From the west: stops up to the goal's branch, then up to the largest one.
//! 2. From the east: stops up to the third branch, where there is one.
//! 3. Between them: stops about evenly spaced.
//! 4. The branches with their stops; the draw is refused where the largest branch has no more stops than the goal's.
//!
//! Rooms:
//! 1. The goal on its branch, not at the end, opposite another room.
//! 2. Rooms on most sites of the largest branch, for its four-way vertices.
//! 3. Every other place gets a door unless it is a junction or an end.
//! 4. Second doors, up to the number drawn.
//! 5. Further rooms, up to the number of vertices drawn.
//! 6. The draw is refused where a count is out of its range.

use super::hall::{END, Floor, Hall, INSIDE, Site};
use super::layout::{Cm, Layout};
use crate::geometry::{Axis, Cardinal};
use crate::rng::Stream;

/// Counts of a floor: vertices of the graph.
pub const VERTICES: [usize; 2] = [45, 50];
/// Of these, vertices of rooms.
pub const ROOM_VERTICES: [usize; 2] = [17, 25];
/// Rooms with two doors.
const TWO_DOORS: [usize; 2] = [2, 4];

/// Four-way vertices of the largest branch, at least.
const FOUR_WAYS: usize = 3;

/// Clear width of corridors and doors, thickness of walls: even numbers from, to.
const CORRIDOR: [Cm; 2] = [200, 250];
const DOOR: [Cm; 2] = [90, 100];
/// Clear width where a branch opens from the main corridor: the leaf of a fire door.
const MOUTH: [Cm; 2] = [116, 124];
const WALL: [Cm; 2] = [16, 20];
/// Clear length of the main corridor.
const MAIN: [Cm; 2] = [5_800, 6_200];
/// Clear length of the goal's branch, the largest one and the eastern one.
const GOAL_BRANCH: [Cm; 2] = [1_500, 1_700];
const LARGE_BRANCH: [Cm; 2] = [2_000, 2_300];
const EAST_BRANCH: [Cm; 2] = [1_550, 1_800];
/// Distance from one stop to the next.
const STEP: [Cm; 2] = [410, 530];
const USUAL_STEP: Cm = 475;
/// Depth of rooms.
const DEPTH: [Cm; 2] = [420, 680];

/// Draws a floor, in its final place, and from a stream of their own the mouths of its branches; `None` where the parts drawn do not fit together.
pub(super) fn draw(stream: &mut Stream, mouths: &mut Stream) -> Option<Layout> {
    let mut halls = draw_halls(stream)?;
    for branch in &mut halls.halls[1..] {
        branch.mouth = even(mouths, MOUTH);
    }
    let mut pen = Pen {
        floor: Floor { thickness: halls.thickness, halls: halls.halls, rooms: Vec::new() },
        stream,
    };
    let goal = pen.draw_rooms()?;
    let floor = pen.floor;
    let layout = floor.layout(goal);
    let mirrored = [stream.below(2) == 1, stream.below(2) == 1];
    Some(layout.placed(mirrored))
}

/// Numbers of the branches.
const GOAL: usize = 1;
const LARGE: usize = 2;

struct Halls {
    thickness: Cm,
    halls: Vec<Hall>,
}

fn draw_halls(stream: &mut Stream) -> Option<Halls> {
    let thickness = even(stream, WALL);
    let mut half = || Cm::midpoint(even(stream, CORRIDOR), thickness);
    let halves = [half(), half(), half(), half()];
    let length = even(stream, MAIN) + thickness;
    let (first, last) = (END + thickness / 2, length - END - thickness / 2);

    // 1. From the west: stops up to the junction of the goal's branch, then up to that of the large one.
    let mut stops = vec![first];
    let steps = |stops: &mut Vec<Cm>, count: u64, stream: &mut Stream| {
        for _ in 0..count {
            let next = stops[stops.len() - 1] + whole(stream, STEP);
            stops.push(next);
        }
        stops[stops.len() - 1]
    };
    let west = 1 + stream.below(2);
    let goal = steps(&mut stops, west, stream);
    let between = stream.below(3);
    let large = steps(&mut stops, between, stream);
    // 2. From the east: stops up to the junction of the third branch, where there is one.
    let mut eastern = vec![last];
    let third = (stream.below(4) > 0).then(|| {
        let mut from_east = vec![0];
        let count = 1 + stream.below(3);
        let off = steps(&mut from_east, count, stream);
        eastern.extend(from_east[1..].iter().map(|off| last - off));
        last - off
    });
    // 3. Between them.
    let (from, to) = (large, eastern[eastern.len() - 1]);
    stops.extend(between_stops(stream, from, to)?);
    eastern.reverse();
    stops.extend(eastern);

    // 4. The branches.
    let (axis, mouth) = (Axis::EastWest, 0);
    let main = Hall { axis, center: 0, half: halves[0], mouth, span: [0, length], stops };
    let north = stream.below(2) == 1;
    let mut branch = |center: Cm, north: bool, half: Cm, length: [Cm; 2]| {
        let end = main.half - thickness / 2 + even(stream, length);
        let mut stops: Vec<Cm> = between_stops(stream, 0, end - END)?;
        stops.push(end - END);
        let mut span = [main.half, end + thickness / 2];
        if !north {
            stops = stops.iter().rev().map(|stop| -stop).collect();
            span = [-span[1], -span[0]];
        }
        Some(Hall { axis: Axis::NorthSouth, center, half, mouth: 0, span, stops })
    };
    let mut branches = vec![
        branch(goal, true, halves[1], GOAL_BRANCH)?,
        branch(large, false, halves[2], LARGE_BRANCH)?,
    ];
    if let Some(center) = third {
        branches.push(branch(center, north, halves[3], EAST_BRANCH)?);
    }
    if branches[1].stops.len() <= branches[0].stops.len() {
        return None;
    }
    let halls = std::iter::once(main).chain(branches).collect();
    Some(Halls { thickness, halls })
}

/// Draws stops between `from` and `to`, about evenly spaced; `None` where they come too near or too far apart.
fn between_stops(stream: &mut Stream, from: Cm, to: Cm) -> Option<Vec<Cm>> {
    let count = (to - from + USUAL_STEP / 2) / USUAL_STEP;
    let mut stops = Vec::new();
    for i in 1..count {
        stops.push(from + (to - from) * i / count + whole(stream, [-25, 25]));
    }
    let all: Vec<Cm> = [from].into_iter().chain(stops.iter().copied()).chain([to]).collect();
    let fits = all.windows(2).all(|w| (STEP[0] - 40..=STEP[1] + 40).contains(&(w[1] - w[0])));
    fits.then_some(stops)
}

/// Draws rooms onto a floor.
struct Pen<'a> {
    floor: Floor,
    stream: &'a mut Stream,
}

impl Pen<'_> {
    /// Draws all rooms and returns the number of the goal's.
    fn draw_rooms(&mut self) -> Option<usize> {
        let corridor: usize = self.floor.halls.iter().map(|hall| hall.stops.len()).sum();
        let least = ROOM_VERTICES[0].max(VERTICES[0].saturating_sub(corridor));
        let most = ROOM_VERTICES[1].min(VERTICES[1].checked_sub(corridor)?);
        let target = least + self.below(most.checked_sub(least)? + 1);

        // 1. The goal: on its branch, not at the end, opposite another room.
        let stops = self.floor.halls[GOAL].stops.len();
        let stop = self.below(stops.checked_sub(1)?);
        let [west, east] = self.floor.halls[GOAL].sides();
        let side = if self.below(2) == 0 { west } else { east };
        let goal = Site { hall: GOAL, stop, side };
        for site in [goal, Site { side: side.opposite(), ..goal }] {
            if !self.draw_room(site, 0.0) {
                return None;
            }
        }
        // 2. The large branch has many four-way vertices.
        for stop in 0..self.floor.halls[LARGE].stops.len() {
            for side in self.floor.halls[LARGE].sides() {
                if self.stream.uniform() < 0.85 {
                    self.draw_room(Site { hall: LARGE, stop, side }, 0.1);
                }
            }
        }
        // 3. Every other place has a door or is a junction or an end.
        for number in 0..self.floor.halls.len() {
            for stop in 0..self.floor.halls[number].stops.len() {
                self.draw_for(number, stop)?;
            }
        }
        // 4. Second doors.
        let two = TWO_DOORS[0] + self.below(TWO_DOORS[1] - TWO_DOORS[0]);
        let loops = self.below(2) == 1;
        for site in self.shuffled_sites() {
            if self.two_door_rooms() < two && self.room_vertices() < target {
                self.second_door(site, loops);
            }
        }
        // 5. Further rooms.
        for site in self.shuffled_sites() {
            if self.room_vertices() < target {
                self.draw_room(site, 0.3);
            }
        }
        // 6. The counts.
        let fits = self.room_vertices() == target
            && self.floor.rooms.len() >= ROOM_VERTICES[0]
            && (TWO_DOORS[0]..=TWO_DOORS[1]).contains(&self.two_door_rooms())
            && self.four_ways(LARGE) >= FOUR_WAYS
            && self.four_ways(LARGE) > self.four_ways(GOAL);
        fits.then(|| self.name_rooms())
    }

    /// Gives the place a door, unless it needs none.
    fn draw_for(&mut self, hall: usize, stop: usize) -> Option<()> {
        let floor = &self.floor;
        let sides = floor.halls[hall].sides();
        let is_end = floor.halls[hall].ends_at(stop);
        let is_junction = hall == 0
            && floor.halls[1..].iter().any(|branch| branch.center == floor.halls[0].stops[stop]);
        let order = if self.below(2) == 0 { sides } else { [sides[1], sides[0]] };
        let sites = order.map(|side| Site { hall, stop, side });
        let has_door = sites.iter().any(|site| self.floor.has_door(*site));
        let drawn = is_end
            || is_junction
            || has_door
            || sites.iter().any(|site| self.draw_room(*site, 0.15))
            || sites.iter().any(|site| self.second_door(*site, false));
        drawn.then_some(())
    }

    /// Draws a room behind `site`, with probability `wide` over the bay beside it too.
    fn draw_room(&mut self, site: Site, wide: f64) -> bool {
        let mut along = self.floor.bay(site);
        if self.stream.uniform() < wide {
            let up = self.below(2) == 1;
            let stops = self.floor.halls[site.hall].stops.len();
            let beside = if up { Some(site.stop + 1) } else { site.stop.checked_sub(1) };
            if let Some(stop) = beside.filter(|stop| *stop < stops) {
                let other = self.floor.bay(Site { stop, ..site });
                along = [along[0].min(other[0]), along[1].max(other[1])];
            }
        } else {
            // Or a little of the bay beside it.
            let by = whole(self.stream, [0, 60]);
            if self.below(2) == 0 {
                along[0] -= by;
            } else {
                along[1] += by;
            }
        }
        let depth = whole(self.stream, DEPTH);
        let (width, inside) = (even(self.stream, DOOR), whole(self.stream, INSIDE));
        if !self.floor.free_sites().contains(&site) {
            return false;
        }
        let Some(area) = self.floor.fit(site, along, depth) else { return false };
        self.floor.add(site, area, width, inside)
    }

    /// Draws a second door at `site` for the room whose wall is there; with `through`, at most one room becomes a
    /// passage.
    fn second_door(&mut self, site: Site, through: bool) -> bool {
        let (width, inside) = (even(self.stream, DOOR), whole(self.stream, INSIDE));
        // The first room is the goal's, which stays with one door.
        let Some(room) = self.floor.room_behind(site).filter(|room| *room > 0) else {
            return false;
        };
        let through = through && self.room_vertices() == self.doors();
        (through && self.floor.add_way_through(room, site, width))
            || self.floor.add_door(room, site, width, inside)
    }

    fn shuffled_sites(&mut self) -> Vec<Site> {
        let mut sites = self.floor.free_sites();
        self.stream.shuffle(&mut sites);
        sites
    }

    fn doors(&self) -> usize {
        self.floor.rooms.iter().map(|room| room.doors.len()).sum()
    }

    /// Counts the doors, but for passages, whose two doors share a vertex.
    fn room_vertices(&self) -> usize {
        let shared =
            self.floor.rooms.iter().filter(|room| {
                room.doors.len() == 2 && room.doors[0].vertex == room.doors[1].vertex
            });
        self.doors() - shared.count()
    }

    /// Counts the four-way vertices of a branch: doors on both sides, and not its end.
    fn four_ways(&self, branch: usize) -> usize {
        let hall = &self.floor.halls[branch];
        let both = |stop: &usize| {
            let door = |side| self.floor.has_door(Site { hall: branch, stop: *stop, side });
            !hall.ends_at(*stop) && hall.sides().into_iter().all(door)
        };
        (0..hall.stops.len()).filter(both).count()
    }

    fn two_door_rooms(&self) -> usize {
        self.floor.rooms.iter().filter(|room| room.doors.len() == 2).count()
    }

    /// Puts the rooms in the order of their first doors and returns the number of the goal's.
    fn name_rooms(&mut self) -> usize {
        let goal = self.floor.rooms[0].area;
        self.floor.rooms.sort_by_key(|room| {
            let site = room.doors[0].site;
            let side = matches!(site.side, Cardinal::South | Cardinal::East);
            (site.hall, site.stop, side)
        });
        self.floor.rooms.iter().position(|room| room.area == goal).unwrap_or(0)
    }

    fn below(&mut self, bound: usize) -> usize {
        below(self.stream, bound)
    }
}

fn below(stream: &mut Stream, bound: usize) -> usize {
    usize::try_from(stream.below(bound.max(1) as u64)).unwrap_or(0)
}

/// Draws a whole number from `range[0]` to `range[1]`.
fn whole(stream: &mut Stream, range: [Cm; 2]) -> Cm {
    let span = u64::try_from(range[1] - range[0]).unwrap_or(0);
    range[0] + Cm::try_from(stream.below(span + 1)).unwrap_or(0)
}

/// Draws an even number from `range[0]` to `range[1]`, which are even.
fn even(stream: &mut Stream, range: [Cm; 2]) -> Cm {
    2 * whole(stream, [range[0] / 2, range[1] / 2])
}
