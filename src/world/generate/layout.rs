//! A floor as rectangles: spaces that share walls, gaps in the walls, places and the links between them; and its
//! conversion to a document. Lengths are whole centimetres, so that walls meet exactly.

use super::walls::walls;
use crate::geometry::{Axis, Cardinal, Pose};
use crate::world::document::{AreaDoc, BASE_LAYER, GoalDoc, LayerDoc, RegionDoc, TagDoc, WorldDoc};
use crate::world::topology::{Opening, TagScheme};
use crate::world::{RegionKind, Tag};
use std::collections::BTreeMap;

/// A length or coordinate in centimetres.
pub(super) type Cm = i32;

/// Distance of an exit tag from its vertex, and of the goal's mark beside it.
const EXIT_AHEAD: Cm = 50;
const GOAL_ASIDE: Cm = 30;

/// An upright rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Area {
    /// West and east.
    pub(super) x: [Cm; 2],
    /// South and north.
    pub(super) y: [Cm; 2],
}

impl Area {
    /// Returns this rectangle grown by `by` on every side.
    pub(super) fn grown(self, by: Cm) -> Self {
        Self { x: [self.x[0] - by, self.x[1] + by], y: [self.y[0] - by, self.y[1] + by] }
    }

    /// Returns the smallest rectangle around this one and `other`.
    pub(super) fn union(self, other: Self) -> Self {
        let both = |a: [Cm; 2], b: [Cm; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self { x: both(self.x, other.x), y: both(self.y, other.y) }
    }
}

/// A room or corridor.
#[derive(Debug, Clone)]
pub(super) struct Space {
    /// Name, unique on the floor.
    pub(super) name: String,
    /// Room or corridor.
    pub(super) kind: RegionKind,
    /// Its extent, to the middle lines of its walls.
    pub(super) area: Area,
    /// Its floor.
    pub(super) floor: Area,
}

/// A gap in the wall along `line`: a door, or the mouth of a corridor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// The axis of the wall.
    pub(super) line: Axis,
    /// Its middle, on the middle line of the wall.
    pub(super) at: (Cm, Cm),
    /// Its width, even.
    pub(super) width: Cm,
}

/// A vertex of the graph.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Its position.
    pub(super) at: (Cm, Cm),
    /// Corridor or room.
    pub(super) kind: RegionKind,
}

/// An edge of the graph.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// One end, by number.
    pub(super) from: usize,
    /// The other.
    pub(super) to: usize,
    /// The direction of the other end.
    pub(super) direction: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub(super) opening: Opening,
}

/// A floor.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Thickness of all walls, even.
    pub(super) thickness: Cm,
    /// Rooms and corridors; none overlap.
    pub(super) spaces: Vec<Space>,
    /// Doors and mouths of corridors.
    pub(super) gaps: Vec<Gap>,
    /// Vertices of the graph.
    pub(super) places: Vec<Place>,
    /// Its edges.
    pub(super) links: Vec<Link>,
    /// The vertex where the goal is.
    pub(super) goal: usize,
}

impl Layout {
    /// Returns the extent from outer face to outer face.
    pub(super) fn extent(&self) -> Area {
        let mut spaces = self.spaces.iter().map(|space| space.area.grown(self.thickness / 2));
        let first = spaces.next().unwrap_or(Area { x: [0, 0], y: [0, 0] });
        spaces.fold(first, Area::union)
    }

    /// Returns the floor mirrored (west and east exchanged, south and north exchanged), with its lower left outer
    /// corner at the origin.
    pub(super) fn placed(mut self, mirrored: [bool; 2]) -> Self {
        let turn = |at: (Cm, Cm)| {
            let sign = |mirrored: bool| if mirrored { -1 } else { 1 };
            (at.0 * sign(mirrored[0]), at.1 * sign(mirrored[1]))
        };
        let facing = |direction: Cardinal| {
            if mirrored[usize::from(direction.axis() == Axis::NorthSouth)] {
                direction.opposite()
            } else {
                direction
            }
        };
        self.change(&turn);
        for link in &mut self.links {
            link.direction = facing(link.direction);
        }
        let low = self.extent();
        self.change(&|at| (at.0 - low.x[0], at.1 - low.y[0]));
        self
    }

    fn change(&mut self, to: &dyn Fn((Cm, Cm)) -> (Cm, Cm)) {
        let area = |area: Area| {
            let (a, b) = (to((area.x[0], area.y[0])), to((area.x[1], area.y[1])));
            Area { x: [a.0.min(b.0), a.0.max(b.0)], y: [a.1.min(b.1), a.1.max(b.1)] }
        };
        for space in &mut self.spaces {
            space.area = area(space.area);
            space.floor = area(space.floor);
        }
        for gap in &mut self.gaps {
            gap.at = to(gap.at);
        }
        for place in &mut self.places {
            place.at = to(place.at);
        }
    }

    /// Returns the marks of all places and links (id left out): colour, place and heading.
    fn marks(&self, scheme: &TagScheme) -> Vec<(String, (Cm, Cm), Cardinal)> {
        let mut marks = Vec::new();
        for (number, place) in self.places.iter().enumerate() {
            let color = match place.kind {
                RegionKind::Corridor => &scheme.corridor,
                RegionKind::Room => &scheme.room,
            };
            marks.push((color.clone(), place.at, Cardinal::East));
            if number == self.goal {
                let taken = |direction: Cardinal| self.exits(number).any(|e| e == direction);
                let side = Cardinal::ALL.into_iter().find(|d| !taken(*d)).unwrap_or(Cardinal::East);
                marks.push((
                    scheme.goal.clone(),
                    ahead(place.at, side, GOAL_ASIDE),
                    Cardinal::East,
                ));
            }
        }
        for link in &self.links {
            let color = match link.opening {
                Opening::Corridor => &scheme.corridor_exit,
                Opening::Door => &scheme.door_exit,
            };
            for (end, direction) in
                [(link.from, link.direction), (link.to, link.direction.opposite())]
            {
                let at = ahead(self.places[end].at, direction, EXIT_AHEAD);
                marks.push((color.clone(), at, direction));
            }
        }
        marks
    }

    fn exits(&self, place: usize) -> impl Iterator<Item = Cardinal> + '_ {
        self.links.iter().filter_map(move |link| match link {
            link if link.from == place => Some(link.direction),
            link if link.to == place => Some(link.direction.opposite()),
            _ => None,
        })
    }

    /// Returns how many tags the floor carries.
    pub(super) fn tag_count(&self) -> usize {
        self.places.len() + 1 + 2 * self.links.len()
    }

    /// Returns the tags, the n-th mark with the n-th of `ids`.
    pub(super) fn tags(&self, ids: &[String], scheme: &TagScheme) -> Vec<Tag> {
        let mut tags: Vec<Tag> = self
            .marks(scheme)
            .into_iter()
            .zip(ids)
            .map(|((color, at, facing), id)| {
                let at = metres(at);
                Tag { id: id.clone(), color, pose: Pose::new(at[0], at[1], facing.heading()) }
            })
            .collect();
        tags.sort_by(|a, b| a.id.cmp(&b.id));
        tags
    }

    /// Converts the floor to a document without starts.
    pub(super) fn document(&self, name: String, source: String, tags: &[Tag]) -> WorldDoc {
        let layer = LayerDoc {
            z_m: Some([0.0, 2.5]),
            walls: walls(&self.spaces, &self.gaps, self.thickness),
            ..LayerDoc::default()
        };
        let region = |space: &Space| {
            let ([west, east], [south, north]) = (space.floor.x, space.floor.y);
            let corners = [(west, south), (east, south), (east, north), (west, north)];
            let area = AreaDoc { corners_m: corners.map(metres).to_vec() };
            let region = match space.kind {
                RegionKind::Room => RegionDoc::Room(area),
                RegionKind::Corridor => RegionDoc::Corridor(area),
            };
            (space.name.clone(), region)
        };
        let tag = |tag: &Tag| {
            let heading_deg = degrees(Cardinal::from_heading(tag.pose.heading));
            let at_m = [tag.pose.x, tag.pose.y];
            (tag.id.clone(), TagDoc { color: tag.color.clone(), at_m, heading_deg })
        };
        let goal = GoalDoc { at_m: metres(self.places[self.goal].at) };
        WorldDoc {
            reenact_world: 1,
            name,
            source,
            layers: BTreeMap::from([(BASE_LAYER.to_owned(), layer)]),
            regions: self.spaces.iter().map(region).collect(),
            tags: tags.iter().map(tag).collect(),
            starts: BTreeMap::new(),
            goals: BTreeMap::from([("goal".to_owned(), goal)]),
        }
    }
}

/// Returns a heading as written: 0, 90, 180 or -90.
pub(super) fn degrees(direction: Cardinal) -> f64 {
    match direction {
        Cardinal::East => 0.0,
        Cardinal::North => 90.0,
        Cardinal::West => 180.0,
        Cardinal::South => -90.0,
    }
}

/// Returns `at`, moved by `by` in `direction`.
pub(super) fn ahead(at: (Cm, Cm), direction: Cardinal, by: Cm) -> (Cm, Cm) {
    match direction {
        Cardinal::East => (at.0 + by, at.1),
        Cardinal::North => (at.0, at.1 + by),
        Cardinal::West => (at.0 - by, at.1),
        Cardinal::South => (at.0, at.1 - by),
    }
}

/// Converts centimetres to metres: the number that is written with two decimals.
pub(super) fn metres(at: (Cm, Cm)) -> [f64; 2] {
    [f64::from(at.0) / 100.0, f64::from(at.1) / 100.0]
}
