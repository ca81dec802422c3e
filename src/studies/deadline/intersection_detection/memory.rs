//! The tags seen so far, and which of them belong to one intersection.

use super::Perception;
use crate::geometry::{Cardinal, Point};
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::{Exit, Intersection, Opening};
use std::collections::BTreeMap;

/// The meaning of a tag's colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A vertex.
    Vertex(Place),
    /// An outgoing edge.
    Exit(Opening),
    /// The goal.
    Goal,
}

impl Role {
    /// Returns the role of a colour; `None` for tags that are not the IDS's.
    pub(super) fn of(color: &str, perception: &Perception) -> Option<Self> {
        let roles = [
            (&perception.corridor_color, Self::Vertex(Place::Corridor)),
            (&perception.room_color, Self::Vertex(Place::Room)),
            (&perception.corridor_exit_color, Self::Exit(Opening::Corridor)),
            (&perception.door_exit_color, Self::Exit(Opening::Door)),
            (&perception.goal_color, Self::Goal),
        ];
        roles.iter().find(|(name, _)| *name == color).map(|(_, role)| *role)
    }
}

/// A tag that has been seen: its number in order of first sight.
pub(super) type TagNumber = usize;

#[derive(Debug, Clone)]
struct Tag {
    id: String,
    role: Role,
    /// How often an exit was seen to face each cardinal direction.
    votes: [u32; 4],
    /// Position of the vertex tag in this tag's frame (m): both are fixed in the building.
    vertex_at: Option<Point>,
    group: Option<usize>,
}

/// Everything seen so far. Nothing is ever done in the order of ids.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    tags: Vec<Tag>,
    numbers: BTreeMap<String, TagNumber>,
    /// The tags of each intersection, in order of first sight; empty where two were joined.
    groups: Vec<Vec<TagNumber>>,
}

impl Memory {
    /// Returns the number of the tag `id`, remembered from now on.
    pub(super) fn number(&mut self, id: &str, role: Role) -> TagNumber {
        if let Some(number) = self.numbers.get(id) {
            return *number;
        }
        let number = self.tags.len();
        self.numbers.insert(id.to_owned(), number);
        let group = matches!(role, Role::Vertex(_)).then(|| {
            self.groups.push(vec![number]);
            self.groups.len() - 1
        });
        self.tags.push(Tag { id: id.to_owned(), role, votes: [0; 4], vertex_at: None, group });
        number
    }

    pub(super) fn role(&self, tag: TagNumber) -> Role {
        self.tags[tag].role
    }

    /// Counts one sight of an exit that faced `direction`.
    pub(super) fn vote(&mut self, tag: TagNumber, direction: Cardinal) {
        self.tags[tag].votes[direction.index()] += 1;
    }

    /// Returns the direction that an exit was seen to face most often; of two the first counter-clockwise from east.
    pub(super) fn direction(&self, tag: TagNumber) -> Option<Cardinal> {
        let votes = &self.tags[tag].votes;
        let most = *votes.iter().max()?;
        let first = Cardinal::ALL.into_iter().find(|direction| votes[direction.index()] == most);
        first.filter(|_| most > 0)
    }

    pub(super) fn set_vertex_at(&mut self, tag: TagNumber, at: Point) {
        self.tags[tag].vertex_at = Some(at);
    }

    /// Returns the position of the vertex tag in the frame of `tag`: its origin, or where it once was seen.
    pub(super) fn vertex_at(&self, tag: TagNumber) -> Option<Point> {
        match self.tags[tag].role {
            Role::Vertex(_) => Some(Point::ZERO),
            Role::Exit(_) | Role::Goal => self.tags[tag].vertex_at,
        }
    }

    /// Returns whether two tags belong to one intersection.
    pub(super) fn together(&self, a: TagNumber, b: TagNumber) -> bool {
        a == b || (self.tags[a].group.is_some() && self.tags[a].group == self.tags[b].group)
    }

    /// Records that two tags belong to one intersection. Two vertex tags never do: then nothing is changed.
    pub(super) fn join(&mut self, a: TagNumber, b: TagNumber) {
        match (self.tags[a].group, self.tags[b].group) {
            (None, None) => {
                self.groups.push(vec![a, b]);
                let group = Some(self.groups.len() - 1);
                self.tags[a].group = group;
                self.tags[b].group = group;
            }
            (Some(group), None) => self.put(b, group),
            (None, Some(group)) => self.put(a, group),
            (Some(one), Some(other)) if one != other => {
                let has_vertex = |group: usize| {
                    self.groups[group]
                        .iter()
                        .any(|tag| matches!(self.tags[*tag].role, Role::Vertex(_)))
                };
                if !(has_vertex(one) && has_vertex(other)) {
                    for tag in std::mem::take(&mut self.groups[other]) {
                        self.put(tag, one);
                    }
                }
            }
            (Some(_), Some(_)) => {}
        }
    }

    fn put(&mut self, tag: TagNumber, group: usize) {
        self.groups[group].push(tag);
        self.tags[tag].group = Some(group);
    }

    /// Returns the intersection to which `tag` belongs, as it is known by now.
    ///
    /// Where its vertex tag has not been seen (the robot stands on it), its kind follows from its exits: every corridor vertex
    /// has an exit through a corridor, and rooms have doors only.
    pub(super) fn intersection(&self, tag: TagNumber) -> Intersection {
        let alone = [tag];
        let group = self.tags[tag].group;
        let members = group.map_or(&alone[..], |group| &self.groups[group]);
        let roles = || members.iter().map(|tag| self.tags[*tag].role);
        let seen = roles().find_map(|role| match role {
            Role::Vertex(place) => Some(place),
            Role::Exit(_) | Role::Goal => None,
        });
        let inferred = || {
            let corridor = roles().any(|role| role == Role::Exit(Opening::Corridor));
            if corridor { Place::Corridor } else { Place::Room }
        };
        // One exit per direction: the one seen most often, of two the one seen first.
        let exit = |direction: Cardinal| {
            let mut best: Option<(u32, Opening)> = None;
            for tag in members {
                if let Role::Exit(opening) = self.tags[*tag].role
                    && self.direction(*tag) == Some(direction)
                {
                    let votes = self.tags[*tag].votes[direction.index()];
                    if best.is_none_or(|(most, _)| votes > most) {
                        best = Some((votes, opening));
                    }
                }
            }
            best.map(|(_, opening)| Exit { direction, opening })
        };
        Intersection {
            tags: members.iter().map(|tag| self.tags[*tag].id.clone()).collect(),
            place: seen.unwrap_or_else(inferred),
            exits: Cardinal::ALL.into_iter().filter_map(exit).collect(),
            is_goal: roles().any(|role| role == Role::Goal),
        }
    }
}
