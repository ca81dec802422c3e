//! The true graph of a building, read from its tags by the convention of the deadline study (docs/world.md).
//!
//! A vertex tag stands on every place of the graph: corridor vertices (intersections, places beside doors, dead ends)
//! and rooms. Beside it stands an exit tag for every exit, facing in its direction. An edge runs from an exit straight
//! to the nearest vertex tag in its direction, and comes back by the opposite exit there.

mod fault;

pub use fault::TagFault;

use super::{Region, RegionKind, Tag};
use crate::geometry::{Cardinal, Outline, Point};
use crate::math;
use std::collections::VecDeque;

/// The meaning of the colours of tags, and how near they stand to what they belong to.
#[derive(Debug, Clone, PartialEq)]
pub struct TagScheme {
    /// Colour of the vertex tags of corridors.
    pub corridor: String,
    /// Colour of the vertex tags of rooms.
    pub room: String,
    /// Colour of exits that lead through a corridor.
    pub corridor_exit: String,
    /// Colour of exits that lead through a door.
    pub door_exit: String,
    /// Colour of the mark of a goal.
    pub goal: String,
    /// Largest distance (m) of a mark from its vertex tag. Vertices are twice this apart.
    pub grouping: f64,
    /// Largest distance (m) of the other end of an edge from the exit's line.
    pub aside: f64,
}

impl Default for TagScheme {
    fn default() -> Self {
        let own = str::to_owned;
        Self {
            corridor: own("green"),
            room: own("blue"),
            corridor_exit: own("white"),
            door_exit: own("yellow"),
            goal: own("red"),
            grouping: 1.0,
            aside: 0.5,
        }
    }
}

/// Largest angle (rad) of an exit's heading to its cardinal direction: one degree.
const ASKEW: f64 = std::f64::consts::PI / 180.0;

/// What an edge leads through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opening {
    /// A corridor.
    Corridor,
    /// A door.
    Door,
}

/// An exit of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit {
    /// Its direction.
    pub direction: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
    /// The vertex at the other end, by its number.
    pub to: usize,
}

/// A place of the graph.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Id of its vertex tag.
    pub tag: String,
    /// Corridor or room.
    pub kind: RegionKind,
    /// Its position (m).
    pub at: Point,
    /// Its exits, counter-clockwise from east; at most one in each direction.
    pub exits: Vec<Exit>,
    /// Whether the mark of a goal stands here.
    pub is_goal: bool,
}

/// An undirected edge: its east or north exit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Western or southern end.
    pub from: usize,
    /// Eastern or northern end.
    pub to: usize,
    /// East or north.
    pub direction: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
}

/// The graph of a building.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Its vertices, in the order of their tags in the world.
    pub vertices: Vec<Vertex>,
}

impl Topology {
    /// Reads the graph from `tags`. Tags of colours that `scheme` does not name are no part of it.
    ///
    /// # Errors
    /// Every breach of the convention by the tags.
    pub fn read(tags: &[Tag], scheme: &TagScheme) -> Result<Self, Vec<TagFault>> {
        let mut reader =
            Reader { scheme, vertices: Vec::new(), ways: Vec::new(), faults: Vec::new() };
        reader.place(tags);
        for tag in tags {
            let opening = match &tag.color {
                color if *color == scheme.corridor_exit => Some(Opening::Corridor),
                color if *color == scheme.door_exit => Some(Opening::Door),
                color if *color == scheme.goal => None,
                _ => continue,
            };
            if let Some(vertex) = reader.owner(tag) {
                match opening {
                    Some(opening) => reader.exit(tag, vertex, opening),
                    None => reader.vertices[vertex].is_goal = true,
                }
            }
        }
        reader.join();
        reader.check_kinds();
        if reader.faults.is_empty() {
            Ok(Self { vertices: reader.vertices })
        } else {
            Err(reader.faults)
        }
    }

    /// Returns every edge once, by its western or southern end.
    pub fn edges(&self) -> impl Iterator<Item = Edge> + '_ {
        self.vertices.iter().enumerate().flat_map(|(from, vertex)| {
            let forward = |exit: &&Exit| matches!(exit.direction, Cardinal::East | Cardinal::North);
            vertex.exits.iter().filter(forward).map(move |exit| Edge {
                from,
                to: exit.to,
                direction: exit.direction,
                opening: exit.opening,
            })
        })
    }

    /// Returns the numbers of the vertices where a goal is.
    pub fn goals(&self) -> impl Iterator<Item = usize> + '_ {
        self.vertices.iter().enumerate().filter(|(_, v)| v.is_goal).map(|(number, _)| number)
    }

    /// Returns the number of edges from every vertex to the nearest goal (breadth first); `None` where it is
    /// unreachable.
    pub fn distances_to_goal(&self) -> Vec<Option<u32>> {
        self.distances(self.goals())
    }

    /// Returns the number of edges from every vertex to the nearest of `sources`, by number; `None` where it is
    /// unreachable.
    pub fn distances(&self, sources: impl IntoIterator<Item = usize>) -> Vec<Option<u32>> {
        let mut distances = vec![None; self.vertices.len()];
        let mut open: VecDeque<usize> = sources.into_iter().collect();
        for source in &open {
            distances[*source] = Some(0);
        }
        while let Some(here) = open.pop_front() {
            let next = distances[here].map(|distance: u32| distance + 1);
            for exit in &self.vertices[here].exits {
                if distances[exit.to].is_none() {
                    distances[exit.to] = next;
                    open.push_back(exit.to);
                }
            }
        }
        distances
    }

    /// Returns the number of the vertex within `within` m of `point`, the nearest if there are several.
    pub fn vertex_near(&self, point: Point, within: f64) -> Option<usize> {
        let distance = |number: &usize| self.vertices[*number].at.distance(point);
        (0..self.vertices.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|number| distance(number) <= within)
    }

    /// Returns the names of the vertices for people, as in the paper's Figure 2: that of the one of the `regions` in
    /// which each lies, with a letter where it holds several (`C1a`, `C1b`, ... from west to east, then from south to
    /// north). Outside of all, the tag's id.
    pub fn names(&self, regions: &[Region]) -> Vec<String> {
        let region_of = |vertex: &Vertex| {
            regions.iter().position(|r| Outline::Polygon(r.polygon.clone()).contains(vertex.at))
        };
        let homes: Vec<Option<usize>> = self.vertices.iter().map(region_of).collect();
        let name = |number: usize| {
            let vertex = &self.vertices[number];
            let Some(home) = homes[number] else { return vertex.tag.clone() };
            let here = |n: &usize| homes[*n] == Some(home);
            let place = |n: usize| (self.vertices[n].at.x, self.vertices[n].at.y);
            let before =
                (0..self.vertices.len()).filter(here).filter(|n| place(*n) < place(number));
            let (before, all) = (before.count(), (0..self.vertices.len()).filter(here).count());
            let name = &regions[home].name;
            match u8::try_from(before).ok().filter(|before| *before < 26) {
                _ if all == 1 => name.clone(),
                Some(before) => format!("{name}{}", char::from(b'a' + before)),
                None => format!("{name}-{}", before + 1),
            }
        };
        (0..self.vertices.len()).map(name).collect()
    }

    /// Returns how many edges can be removed before the graph has no loop.
    pub fn loops(&self) -> usize {
        let mut parts = 0;
        let mut reached = vec![false; self.vertices.len()];
        for start in 0..self.vertices.len() {
            if !reached[start] {
                parts += 1;
                for (number, distance) in self.distances([start]).iter().enumerate() {
                    reached[number] |= distance.is_some();
                }
            }
        }
        (self.edges().count() + parts).saturating_sub(self.vertices.len())
    }

    /// Returns whether every vertex can be reached from every other one.
    pub fn is_connected(&self) -> bool {
        self.vertices.is_empty() || self.distances([0]).iter().all(Option::is_some)
    }
}

/// An exit whose other end is not yet known.
struct Way {
    tag: String,
    vertex: usize,
    direction: Cardinal,
    opening: Opening,
}

struct Reader<'a> {
    scheme: &'a TagScheme,
    vertices: Vec<Vertex>,
    ways: Vec<Way>,
    faults: Vec<TagFault>,
}

impl Reader<'_> {
    /// Registers the vertex tags.
    fn place(&mut self, tags: &[Tag]) {
        for tag in tags {
            let kind = match &tag.color {
                color if *color == self.scheme.corridor => RegionKind::Corridor,
                color if *color == self.scheme.room => RegionKind::Room,
                _ => continue,
            };
            let at = tag.pose.position();
            let least = 2.0 * self.scheme.grouping;
            for other in &self.vertices {
                if !within(other.at - at, least) {
                    continue;
                }
                let distance = other.at.distance(at);
                if distance < least {
                    let tags = [other.tag.clone(), tag.id.clone()];
                    self.faults.push(TagFault::Crowded { tags, distance, least });
                }
            }
            let (tag, exits) = (tag.id.clone(), Vec::new());
            self.vertices.push(Vertex { tag, kind, at, exits, is_goal: false });
        }
    }

    /// Returns the vertex to which the mark `tag` belongs: the nearest within the grouping distance.
    fn owner(&mut self, tag: &Tag) -> Option<usize> {
        let at = tag.pose.position();
        let distance = |number: &usize| self.vertices[*number].at.distance(at);
        let nearest = (0..self.vertices.len())
            .filter(|number| within(self.vertices[*number].at - at, self.scheme.grouping))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|number| distance(number) <= self.scheme.grouping);
        if nearest.is_none() {
            let (tag, color) = (tag.id.clone(), tag.color.clone());
            self.faults.push(TagFault::Alone { tag, color, at, within: self.scheme.grouping });
        }
        nearest
    }

    fn exit(&mut self, tag: &Tag, vertex: usize, opening: Opening) {
        let heading = tag.pose.heading;
        let direction = Cardinal::from_heading(heading);
        let turned = math::wrap_angle(heading - direction.heading()).abs();
        if turned > ASKEW {
            let degrees = heading.to_degrees();
            self.faults.push(TagFault::Askew { tag: tag.id.clone(), degrees });
            return;
        }
        let off = tag.pose.position() - self.vertices[vertex].at;
        let ahead = off.dot(unit(direction));
        if ahead <= 0.0 || ahead < off.cross(unit(direction)).abs() {
            let (tag, owner) = (tag.id.clone(), self.vertices[vertex].tag.clone());
            self.faults.push(TagFault::Misplaced { tag, vertex: owner, direction });
            return;
        }
        if let Some(other) =
            self.ways.iter().find(|w| w.vertex == vertex && w.direction == direction)
        {
            let tags = [other.tag.clone(), tag.id.clone()];
            let vertex = self.vertices[vertex].tag.clone();
            self.faults.push(TagFault::Doubled { vertex, direction, tags });
            return;
        }
        self.ways.push(Way { tag: tag.id.clone(), vertex, direction, opening });
    }

    /// Returns the nearest vertex in `direction` from `from`.
    fn other_end(&self, from: usize, direction: Cardinal) -> Option<usize> {
        let ahead = |number: &usize| {
            (self.vertices[*number].at - self.vertices[from].at).dot(unit(direction))
        };
        let aside = |number: &usize| {
            (self.vertices[*number].at - self.vertices[from].at).cross(unit(direction)).abs()
        };
        (0..self.vertices.len())
            .filter(|number| *number != from)
            .filter(|number| ahead(number) > 0.0 && aside(number) < self.scheme.aside)
            .min_by(|a, b| ahead(a).total_cmp(&ahead(b)))
    }

    /// Gives every exit its other end.
    fn join(&mut self) {
        // A fault in the tags of one vertex would be reported again by its neighbours.
        if !self.faults.is_empty() {
            return;
        }
        self.ways.sort_by_key(|way| (way.vertex, way.direction));
        // Each is asked for twice: from its own end and from the other.
        let ends: Vec<Option<usize>> =
            self.ways.iter().map(|way| self.other_end(way.vertex, way.direction)).collect();
        for (way, end) in self.ways.iter().zip(&ends) {
            let (tag, direction) = (way.tag.clone(), way.direction);
            let Some(to) = *end else {
                self.faults.push(TagFault::Nowhere { tag, direction });
                continue;
            };
            let back = direction.opposite();
            let vertex = self.vertices[to].tag.clone();
            let found = self.ways.binary_search_by_key(&(to, back), |w| (w.vertex, w.direction));
            let Some(found) = found.ok().filter(|found| ends[*found] == Some(way.vertex)) else {
                self.faults.push(TagFault::NoWayBack { tag, vertex, direction, back });
                continue;
            };
            let found = &self.ways[found];
            if found.opening != way.opening {
                // Reported once, by the exit east or north.
                if matches!(direction, Cardinal::East | Cardinal::North) {
                    let tags = [tag, found.tag.clone()];
                    self.faults.push(TagFault::Unequal { tags });
                }
                continue;
            }
            self.vertices[way.vertex].exits.push(Exit { direction, opening: way.opening, to });
        }
    }

    fn check_kinds(&mut self) {
        for (number, vertex) in self.vertices.iter().enumerate() {
            let mut ways = self.ways.iter().filter(|way| way.vertex == number);
            let tag = vertex.tag.clone();
            match vertex.kind {
                RegionKind::Room => {
                    if let Some(way) = ways.clone().find(|w| w.opening == Opening::Corridor) {
                        let exit = way.tag.clone();
                        self.faults.push(TagFault::OpenRoom { vertex: tag, exit });
                    } else if ways.next().is_none() {
                        self.faults.push(TagFault::NoExit { vertex: tag });
                    }
                }
                RegionKind::Corridor => {
                    if !ways.any(|way| way.opening == Opening::Corridor) {
                        self.faults.push(TagFault::NoCorridor { vertex: tag });
                    }
                }
            }
        }
    }
}

/// Returns whether `off` may be as short as `distance` (m): told without a root, for nearly nothing is near.
fn within(off: Point, distance: f64) -> bool {
    off.x.abs() <= distance && off.y.abs() <= distance
}

/// Returns the vector of one metre in `direction`.
fn unit(direction: Cardinal) -> Point {
    match direction {
        Cardinal::East => Point::new(1.0, 0.0),
        Cardinal::North => Point::new(0.0, 1.0),
        Cardinal::West => Point::new(-1.0, 0.0),
        Cardinal::South => Point::new(0.0, -1.0),
    }
}

#[cfg(test)]
mod tests;
