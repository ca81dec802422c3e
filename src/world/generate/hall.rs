//! Corridors with their stops, and the rooms along them.

use super::layout::{Area, Cm, Gap, Layout, Link, Place, Space, ahead};
use crate::geometry::{Axis, Cardinal};
use crate::world::RegionKind;
use crate::world::topology::Opening;

/// Least distance from a door's axis to the middle line of a wall beside it: leaves 0.5 m of wall, and room to turn.
const BESIDE: Cm = 110;
/// Least size of a room, between the middle lines of its walls.
const LEAST_WIDTH: Cm = 300;
/// As [`LEAST_WIDTH`], away from the door.
const LEAST_DEPTH: Cm = 340;
/// A room grows by this much where that closes a gap behind it.
const SLIVER: Cm = 60;
/// How far a room's vertex is from the wall with its door, and least from the wall behind.
pub(super) const INSIDE: [Cm; 2] = [120, 200];
const BEHIND: Cm = 100;
/// Vertices are at least this far apart.
const APART: Cm = 200;
/// From the last stop of a corridor to the face of the wall that ends it.
pub(super) const END: Cm = 130;

/// A straight corridor.
#[derive(Debug, Clone)]
pub(super) struct Hall {
    /// Its axis.
    pub(super) axis: Axis,
    /// Its middle line: y of an E-W hall, x of a N-S one.
    pub(super) center: Cm,
    /// Distance from its middle line to those of its side walls.
    pub(super) half: Cm,
    /// Clear width where it opens from another, even.
    pub(super) mouth: Cm,
    /// Its ends along its axis, to the middle lines of the end walls (or of the wall it opens from).
    pub(super) span: [Cm; 2],
    /// Its vertices along its axis, ascending; a branch does not hold the junction from which it starts.
    pub(super) stops: Vec<Cm>,
}

/// A possible place of a door: beside a stop, on one side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Site {
    /// The hall, by number.
    pub(super) hall: usize,
    /// The stop, by number.
    pub(super) stop: usize,
    /// The side.
    pub(super) side: Cardinal,
}

/// A door and the place behind it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Door {
    /// The site of the door.
    pub(super) site: Site,
    /// Its width, even.
    pub(super) width: Cm,
    /// The room's vertex.
    pub(super) vertex: (Cm, Cm),
}

/// A room.
#[derive(Debug, Clone)]
pub(super) struct Room {
    /// Its extent, to the middle lines of its walls.
    pub(super) area: Area,
    /// One door or two. Two may share a vertex.
    pub(super) doors: Vec<Door>,
}

/// Halls (the first one is the main one, E-W at y = 0) and rooms.
#[derive(Debug, Clone)]
pub(super) struct Floor {
    /// Thickness of all walls, even.
    pub(super) thickness: Cm,
    /// Corridors.
    pub(super) halls: Vec<Hall>,
    /// Rooms so far.
    pub(super) rooms: Vec<Room>,
}

impl Hall {
    /// Returns the two sides of a hall: of smaller and of larger coordinates.
    pub(super) fn sides(&self) -> [Cardinal; 2] {
        match self.axis {
            Axis::EastWest => [Cardinal::South, Cardinal::North],
            Axis::NorthSouth => [Cardinal::West, Cardinal::East],
        }
    }

    /// Returns whether the hall ends at stop number `stop`: the main hall at its first and last, a branch at its outer
    /// one.
    pub(super) fn ends_at(&self, stop: usize) -> bool {
        let (first, last) = (stop == 0, stop + 1 == self.stops.len());
        match self.axis {
            Axis::EastWest => first || last,
            Axis::NorthSouth => {
                if self.span[0] > 0 {
                    last
                } else {
                    first
                }
            }
        }
    }

    fn at(&self, along: Cm) -> (Cm, Cm) {
        match self.axis {
            Axis::EastWest => (along, self.center),
            Axis::NorthSouth => (self.center, along),
        }
    }

    fn area(&self) -> Area {
        self.beside(self.span, [-self.half, self.half])
    }

    /// Returns the area `along` the hall at these distances `off` its middle line (west and south are negative).
    fn beside(&self, along: [Cm; 2], off: [Cm; 2]) -> Area {
        let across = off.map(|off| self.center + off);
        match self.axis {
            Axis::EastWest => Area { x: along, y: across },
            Axis::NorthSouth => Area { x: across, y: along },
        }
    }

    /// Returns `area` relative to the hall: along it, and how far off its middle line on `side`, near and far.
    fn seen(&self, area: Area, side: Cardinal) -> ([Cm; 2], [Cm; 2]) {
        let (along, across) = match self.axis {
            Axis::EastWest => (area.x, area.y),
            Axis::NorthSouth => (area.y, area.x),
        };
        let [low, high] = across.map(|at| at - self.center);
        let off = if side == self.sides()[1] { [low, high] } else { [-high, -low] };
        (along, off)
    }
}

impl Floor {
    /// Returns all sites without a door and without a branch.
    pub(super) fn free_sites(&self) -> Vec<Site> {
        let mut sites = Vec::new();
        for (number, hall) in self.halls.iter().enumerate() {
            for stop in 0..hall.stops.len() {
                for side in hall.sides() {
                    let site = Site { hall: number, stop, side };
                    if self.branch_at(site).is_none() && !self.has_door(site) {
                        sites.push(site);
                    }
                }
            }
        }
        sites
    }

    pub(super) fn has_door(&self, site: Site) -> bool {
        self.rooms.iter().any(|room| room.doors.iter().any(|door| door.site == site))
    }

    /// Returns the branch that opens at `site`.
    fn branch_at(&self, site: Site) -> Option<&Hall> {
        let hall = &self.halls[site.hall];
        let at = hall.at(hall.stops[site.stop]);
        self.halls.iter().skip(1).filter(|_| site.hall == 0).find(|branch| {
            branch.center == at.0 && (branch.span[0] > 0) == (site.side == Cardinal::North)
        })
    }

    /// Returns the part of a hall's side that is nearest to the stop of `site`: to halfway to the stops beside it, to a
    /// branch's wall, or to the hall's end.
    pub(super) fn bay(&self, site: Site) -> [Cm; 2] {
        let hall = &self.halls[site.hall];
        let here = hall.stops[site.stop];
        let end = |other: Option<usize>, end: Cm, sign: Cm| {
            let Some(other) = other.filter(|other| *other < hall.stops.len()) else { return end };
            match self.branch_at(Site { stop: other, ..site }) {
                Some(branch) => hall.stops[other] - sign * branch.half,
                None => Cm::midpoint(here, hall.stops[other]),
            }
        };
        [end(site.stop.checked_sub(1), hall.span[0], -1), end(Some(site.stop + 1), hall.span[1], 1)]
    }

    /// Fits a room behind `site` that takes what is left of `along` (a part of the hall) and about `depth`.
    pub(super) fn fit(&self, site: Site, along: [Cm; 2], depth: Cm) -> Option<Area> {
        let hall = &self.halls[site.hall];
        let (here, near) = (hall.stops[site.stop], hall.half);
        let [mut low, mut high] = along;
        let taken: Vec<([Cm; 2], [Cm; 2])> = (self.halls.iter().map(Hall::area))
            .chain(self.rooms.iter().map(|room| room.area))
            .map(|area| hall.seen(area, site.side))
            .filter(|(_, off)| off[1] > near)
            .collect();
        for ([from, to], _) in taken.iter().filter(|(_, off)| off[0] < near + LEAST_DEPTH) {
            if *to <= low || *from >= high {
                continue;
            }
            if *to <= here {
                low = *to;
            } else if *from >= here {
                high = *from;
            } else {
                return None;
            }
        }
        if here - low < BESIDE || high - here < BESIDE || high - low < LEAST_WIDTH {
            return None;
        }
        let behind = taken.iter().filter(|([from, to], _)| *to > low && *from < high);
        let wall = behind.map(|(_, off)| off[0]).min().unwrap_or(Cm::MAX);
        let far = if wall - SLIVER < near + depth { wall } else { near + depth };
        let off = if site.side == hall.sides()[1] { [near, far] } else { [-far, -near] };
        Some(hall.beside([low, high], off))
    }

    /// Returns the vertex `inside` m from the wall with the door at `site`.
    pub(super) fn vertex(&self, site: Site, inside: Cm) -> (Cm, Cm) {
        let hall = &self.halls[site.hall];
        let at = hall.at(hall.stops[site.stop]);
        ahead(at, site.side, hall.half + self.thickness / 2 + inside)
    }

    /// Adds a room of `area` behind `site`, its vertex about `inside` from the wall; returns false where that is too
    /// near another vertex.
    pub(super) fn add(&mut self, site: Site, area: Area, width: Cm, inside: Cm) -> bool {
        let (_, off) = self.halls[site.hall].seen(area, site.side);
        let most = off[1] - off[0] - self.thickness - BEHIND;
        let vertex = self.vertex(site, inside.min(most));
        if self.is_crowded(vertex, None) {
            return false;
        }
        self.rooms.push(Room { area, doors: vec![Door { site, width, vertex }] });
        true
    }

    /// Returns the room with one door whose wall stands at `site` and leaves space for a second one.
    pub(super) fn room_behind(&self, site: Site) -> Option<usize> {
        let hall = &self.halls[site.hall];
        let here = hall.stops[site.stop];
        self.rooms.iter().position(|room| {
            let (along, off) = hall.seen(room.area, site.side);
            off[0] == hall.half
                && along[0] + BESIDE <= here
                && here <= along[1] - BESIDE
                && room.doors.len() == 1
        })
    }

    /// Gives `room` a second door at `site` with a vertex of its own; returns false where that is too near another one.
    pub(super) fn add_door(&mut self, room: usize, site: Site, width: Cm, inside: Cm) -> bool {
        let (_, off) = self.halls[site.hall].seen(self.rooms[room].area, site.side);
        let most = off[1] - off[0] - self.thickness - BEHIND;
        let vertex = self.vertex(site, inside.min(most));
        let apart = !self.is_crowded(vertex, None);
        if apart {
            self.rooms[room].doors.push(Door { site, width, vertex });
        }
        apart
    }

    /// Gives `room` a second door at `site`, around the corner of the first, and one vertex on the axes of both: a
    /// passage through the room. Returns false where there is no such place.
    pub(super) fn add_way_through(&mut self, room: usize, site: Site, width: Cm) -> bool {
        let first = self.rooms[room].doors[0];
        if first.site.side.axis() == site.side.axis() {
            return false;
        }
        let (a, b) = (self.vertex(first.site, 0), self.vertex(site, 0));
        // A door that leads north or south has its x on its axis, one that leads east or west its y.
        let (x, y) = if site.side.axis() == Axis::NorthSouth { (b.0, a.1) } else { (a.0, b.1) };
        let vertex = (x, y);
        let inner = self.rooms[room].area.grown(-self.thickness / 2 - BEHIND);
        let fits = (inner.x[0]..=inner.x[1]).contains(&vertex.0)
            && (inner.y[0]..=inner.y[1]).contains(&vertex.1);
        let inside = |door: (Cm, Cm)| (vertex.0 - door.0).abs() + (vertex.1 - door.1).abs();
        let deep = inside(a) >= INSIDE[0] && inside(b) >= INSIDE[0];
        if !fits || !deep || self.is_crowded(vertex, Some(first.vertex)) {
            return false;
        }
        let doors = &mut self.rooms[room].doors;
        doors[0].vertex = vertex;
        doors.push(Door { site, width, vertex });
        true
    }

    /// Returns whether `vertex` is too near another one than `but`.
    fn is_crowded(&self, vertex: (Cm, Cm), but: Option<(Cm, Cm)>) -> bool {
        let stops = self.halls.iter().flat_map(|hall| hall.stops.iter().map(|stop| hall.at(*stop)));
        let rooms = self.rooms.iter().flat_map(|room| room.doors.iter().map(|door| door.vertex));
        stops.chain(rooms).filter(|at| Some(*at) != but).any(|at| {
            let (dx, dy) = (at.0 - vertex.0, at.1 - vertex.1);
            dx * dx + dy * dy < APART * APART
        })
    }

    /// Returns the number of a hall's stop, counted over all halls: the number of its vertex.
    pub(super) fn stop_number(&self, hall: usize, stop: usize) -> usize {
        self.halls[..hall].iter().map(|hall| hall.stops.len()).sum::<usize>() + stop
    }

    /// Converts the floor to a layout. Corridors are named C1, C2, ..., rooms R1, R2, ... in their order; the goal is
    /// the vertex behind the first door of room `goal`.
    pub(super) fn layout(&self, goal: usize) -> Layout {
        let mut layout = Layout {
            thickness: self.thickness,
            spaces: Vec::new(),
            gaps: Vec::new(),
            places: Vec::new(),
            links: Vec::new(),
            goal: 0,
        };
        for (number, hall) in self.halls.iter().enumerate() {
            self.lay_hall(number, hall, &mut layout);
        }
        for (number, room) in self.rooms.iter().enumerate() {
            let name = format!("R{}", number + 1);
            let floor = room.area.grown(-self.thickness / 2);
            layout.spaces.push(Space { name, kind: RegionKind::Room, area: room.area, floor });
            let first = layout.places.len();
            for door in &room.doors {
                let Door { site, width, vertex } = *door;
                let known = (first..layout.places.len()).find(|n| layout.places[*n].at == vertex);
                let to = known.unwrap_or(layout.places.len());
                if known.is_none() {
                    layout.places.push(Place { at: vertex, kind: RegionKind::Room });
                }
                let hall = &self.halls[site.hall];
                let at = ahead(hall.at(hall.stops[site.stop]), site.side, hall.half);
                layout.gaps.push(Gap { line: hall.axis, at, width });
                let from = self.stop_number(site.hall, site.stop);
                let (direction, opening) = (site.side, Opening::Door);
                layout.links.push(Link { from, to, direction, opening });
            }
            if number == goal {
                layout.goal = first;
            }
        }
        layout
    }

    fn lay_hall(&self, number: usize, hall: &Hall, layout: &mut Layout) {
        let (area, half) = (hall.area(), self.thickness / 2);
        let mut floor = area.grown(-half);
        let mut points: Vec<(Cm, usize)> = Vec::new();
        if number > 0 {
            // A branch opens from the main hall's wall: its floor reaches through, and the junction is its first point.
            let northern = hall.span[0] > 0;
            let mouth = (hall.center, if northern { hall.span[0] } else { hall.span[1] });
            layout.gaps.push(Gap { line: Axis::EastWest, at: mouth, width: hall.mouth });
            if northern {
                floor.y[0] -= 2 * half;
            } else {
                floor.y[1] += 2 * half;
            }
            let junction = self.halls[0].stops.iter().position(|stop| *stop == hall.center);
            points.extend(junction.map(|stop| (0, self.stop_number(0, stop))));
        }
        for (stop, along) in hall.stops.iter().enumerate() {
            layout.places.push(Place { at: hall.at(*along), kind: RegionKind::Corridor });
            points.push((*along, self.stop_number(number, stop)));
        }
        points.sort_unstable();
        let direction = match hall.axis {
            Axis::EastWest => Cardinal::East,
            Axis::NorthSouth => Cardinal::North,
        };
        for ends in points.windows(2) {
            let (from, to) = (ends[0].1, ends[1].1);
            layout.links.push(Link { from, to, direction, opening: Opening::Corridor });
        }
        let (name, kind) = (format!("C{}", number + 1), RegionKind::Corridor);
        layout.spaces.push(Space { name, kind, area, floor });
    }
}
