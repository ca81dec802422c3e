//! The Intersection Detection System (sections 3 and 6): from tags and compass to vertices, their kinds and their outgoing
//! edges. Nothing else of the world reaches the mind.
//!
//! The logical camera gives ids, colours and poses relative to the robot. A vertex tag gives a vertex's position and
//! kind; an exit tag near it faces along an outgoing edge, and its colour gives what the edge leads through; a goal tag
//! marks the goal. The compass gives the cardinal direction that an exit faces; its error is outvoted over many sights.
//!
//! There is no odometry. On an edge the robot sees the edge's far end, and its position; for a moment without sight the
//! commanded speeds predict it. A camera that sees through walls sees many vertices at once: the far end is the nearest
//! one with an exit of the edge's kind that faces the robot, which stands before it.

mod memory;
#[cfg(test)]
mod tests;

use super::intersection::{Intersection, Opening};
use super::rules::parameters;
use crate::geometry::{Cardinal, Point, Pose};
use crate::robot::{CompassReading, Detection, Twist};
use crate::units::Tick;
use memory::{Memory, Role, TagNumber};

parameters!(
    /// How tags are read. The paper shows green and blue tags (Figure 3) and says no more.
    Perception {
        /// Colour of the vertex tags of corridors.
        corridor_color: String = "green".to_owned(),
        /// Colour of the vertex tags of rooms.
        room_color: String = "blue".to_owned(),
        /// Colour of exit tags that lead through a corridor.
        corridor_exit_color: String = "white".to_owned(),
        /// Colour of exit tags that lead through a door.
        door_exit_color: String = "yellow".to_owned(),
        /// Colour of the tag that marks the goal.
        goal_color: String = "red".to_owned(),
        /// Tags this near to a vertex tag belong to it (m), above 0. At most half of what vertices are apart.
        #[schemars(extend("exclusiveMinimum" = 0))]
        grouping_m: f64 = 1.0,
        /// The robot has arrived when the vertex is this near ahead (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        arrival_m: f64 = 0.4,
        /// ... or when it was this near and has passed out of view (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        passed_m: f64 = 0.8,
        /// An edge's far end is at most this far beside the robot (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        aside_m: f64 = 1.0,
    }
);

/// A vertex has passed out of view when it is not in view for this many frames.
const PASSED_FRAMES: u32 = 3;
/// Without sight for longer than this (s) a position is not predicted but given up.
const PREDICTION_S: f64 = 1.5;

/// The object of the system's attention.
#[derive(Debug, Clone, PartialEq)]
enum Attention {
    /// Nothing: it only remembers.
    Idle,
    /// The surroundings of the robot, which turns on the spot.
    Around,
    /// The far end of an edge.
    Leg { direction: Cardinal, opening: Opening, target: Option<Target> },
}

/// The far end of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Target {
    /// Any tag of it.
    tag: TagNumber,
    /// Its position in the base frame (m).
    at: Point,
    /// Its distance when it was last seen (m).
    seen_at: f64,
    /// For how many frames, and how long (s), it has not been seen.
    unseen: (u32, f64),
}

/// A tag in view.
#[derive(Debug, Clone, Copy)]
struct Sight {
    tag: TagNumber,
    pose: Pose,
}

/// The Intersection Detection System.
#[derive(Debug, Clone)]
pub struct IntersectionDetectionSystem {
    perception: Perception,
    memory: Memory,
    attention: Attention,
    /// Any tag of the vertex at which the robot is or which it has left.
    here: Option<TagNumber>,
    /// Heading of the base (rad), and its time.
    heading: Option<(f64, Tick)>,
    view: Vec<Sight>,
}

impl IntersectionDetectionSystem {
    /// Creates a system that has seen nothing.
    pub fn new(perception: &Perception) -> Self {
        Self {
            perception: perception.clone(),
            memory: Memory::default(),
            attention: Attention::Idle,
            here: None,
            heading: None,
            view: Vec::new(),
        }
    }

    /// Records that the robot stands on a vertex and begins to turn once around on the spot.
    pub fn begin_look_around(&mut self) {
        self.attention = Attention::Around;
    }

    /// Ends the turn and returns the vertex at which the robot stands. `None` if no tag of a vertex was seen around it.
    ///
    /// The vertex tag may never have been in view, because the robot stands on it; exit tags around it are enough.
    pub fn end_look_around(&mut self) -> Option<Intersection> {
        self.attention = Attention::Idle;
        self.here.map(|tag| self.memory.intersection(tag))
    }

    /// Records that the robot leaves the vertex by its exit to the `direction`, which leads through `opening`.
    pub fn depart(&mut self, direction: Cardinal, opening: Opening) {
        self.attention = Attention::Leg { direction, opening, target: None };
    }

    /// Takes in the present outputs of camera and compass, after the robot was commanded to move as `commanded` since
    /// the last ones. Returns the intersection at which the robot has arrived, once.
    pub fn observe(
        &mut self,
        detections: &[Detection],
        compass: CompassReading,
        commanded: Twist,
    ) -> Option<Intersection> {
        let elapsed = self
            .heading
            .map_or(0.0, |(_, then)| Tick(compass.stamp.0.saturating_sub(then.0)).seconds().0);
        self.remember(detections, compass.heading);
        self.estimate_heading(compass, commanded.angular * elapsed);
        match self.attention.clone() {
            Attention::Idle => None,
            Attention::Around => {
                self.gather_here();
                None
            }
            Attention::Leg { direction, opening, target } => {
                let target = self.follow(direction, opening, target, commanded, elapsed);
                let arrived = target.filter(|target| self.has_arrived(direction, target));
                if let Some(Target { tag, .. }) = arrived {
                    self.here = Some(tag);
                    self.attention = Attention::Idle;
                    return Some(self.memory.intersection(tag));
                }
                self.attention = Attention::Leg { direction, opening, target };
                None
            }
        }
    }

    /// Returns the position of the far end of the edge in the base frame (m), while the robot is on an edge and it is
    /// known.
    pub fn target(&self) -> Option<Point> {
        match &self.attention {
            Attention::Leg { target, .. } => target.map(|target| target.at),
            Attention::Idle | Attention::Around => None,
        }
    }

    /// Fills the view, votes on the directions of exits and groups the tags seen with the vertex tags seen.
    fn remember(&mut self, detections: &[Detection], heading: f64) {
        self.view.clear();
        for detection in detections {
            let Some(role) = Role::of(&detection.color, &self.perception) else { continue };
            let tag = self.memory.number(&detection.id, role);
            if let Role::Exit(_) = role {
                self.memory.vote(tag, Cardinal::from_heading(heading + detection.pose.heading));
            }
            self.view.push(Sight { tag, pose: detection.pose });
        }
        for sight in &self.view {
            if matches!(self.memory.role(sight.tag), Role::Vertex(_)) {
                continue;
            }
            let at = sight.pose.position();
            let mut nearest: Option<(f64, Sight)> = None;
            for vertex in &self.view {
                let distance = vertex.pose.position().distance(at);
                if matches!(self.memory.role(vertex.tag), Role::Vertex(_))
                    && distance <= self.perception.grouping_m
                    && nearest.is_none_or(|(least, _)| distance < least)
                {
                    nearest = Some((distance, *vertex));
                }
            }
            if let Some((_, vertex)) = nearest {
                self.memory.join(vertex.tag, sight.tag);
                let at = sight.pose.inverse_transform(vertex.pose.position());
                self.memory.set_vertex_at(sight.tag, at);
            }
        }
    }

    /// Estimates the heading: an exit faces a cardinal direction, so that with one in view the heading is free of the
    /// compass's error.
    fn estimate_heading(&mut self, compass: CompassReading, turned: f64) {
        let by_exit = self.view.iter().find_map(|sight| {
            let direction = self.memory.direction(sight.tag)?;
            Some(direction.heading() - sight.pose.heading)
        });
        let heading = by_exit
            .or_else(|| self.heading.map(|(heading, _)| heading + turned))
            .unwrap_or(compass.heading);
        self.heading = Some((heading, compass.stamp));
    }

    /// Gathers all tags around the robot: they belong to the vertex on which it stands.
    fn gather_here(&mut self) {
        for sight in &self.view {
            if sight.pose.position().norm() <= self.perception.grouping_m {
                match self.here {
                    None => self.here = Some(sight.tag),
                    Some(here) => self.memory.join(here, sight.tag),
                }
            }
        }
    }

    /// Returns the far end of the edge as of this frame.
    fn follow(
        &self,
        direction: Cardinal,
        opening: Opening,
        target: Option<Target>,
        commanded: Twist,
        elapsed: f64,
    ) -> Option<Target> {
        let kept = target.and_then(|target| self.keep(target, commanded, elapsed));
        let nearest = self.nearest_candidate(direction, opening);
        match (kept, nearest) {
            // The vertex that was taken for the far end was seen past the true one, which was out of view.
            (Some(kept), Some(nearest))
                if !self.memory.together(kept.tag, nearest.tag)
                    && nearest.seen_at < kept.at.norm() - self.perception.grouping_m =>
            {
                Some(nearest)
            }
            (Some(kept), _) => Some(kept),
            (None, nearest) => nearest,
        }
    }

    /// Returns the same target at its present position, seen or predicted.
    fn keep(&self, target: Target, commanded: Twist, elapsed: f64) -> Option<Target> {
        if let Some(at) = self.locate(target.tag) {
            return Some(Target { at, seen_at: at.norm(), unseen: (0, 0.0), ..target });
        }
        let (frames, seconds) = (target.unseen.0 + 1, target.unseen.1 + elapsed);
        let turned = commanded.angular * elapsed;
        let travelled = commanded.linear * elapsed;
        let moved = Pose::new(travelled, 0.0, turned);
        let at = moved.inverse_transform(target.at);
        let within = seconds <= PREDICTION_S || target.seen_at <= self.perception.passed_m;
        within.then_some(Target { at, unseen: (frames, seconds), ..target })
    }

    /// Returns the position of the vertex to which `tag` belongs, by its vertex tag or else by any of its tags in view.
    fn locate(&self, tag: TagNumber) -> Option<Point> {
        let mut by_others = None;
        for sight in self.view.iter().filter(|sight| self.memory.together(sight.tag, tag)) {
            let Some(vertex_at) = self.memory.vertex_at(sight.tag) else { continue };
            let at = sight.pose.transform(vertex_at);
            if matches!(self.memory.role(sight.tag), Role::Vertex(_)) {
                return Some(at);
            }
            by_others = by_others.or(Some(at));
        }
        by_others
    }

    /// Returns the nearest vertex whose exit of this kind faces the robot, which stands before it.
    fn nearest_candidate(&self, direction: Cardinal, opening: Opening) -> Option<Target> {
        let mut nearest: Option<Target> = None;
        for sight in &self.view {
            let faces = self.memory.role(sight.tag) == Role::Exit(opening)
                && self.memory.direction(sight.tag) == Some(direction.opposite());
            let left = self.here.is_some_and(|here| self.memory.together(here, sight.tag));
            if !faces || left {
                continue;
            }
            let robot = sight.pose.inverse_transform(Point::ZERO);
            let before = robot.x > 0.0 && robot.y.abs() <= self.perception.aside_m;
            let Some(vertex_at) = self.memory.vertex_at(sight.tag).filter(|_| before) else {
                continue;
            };
            let at = sight.pose.transform(vertex_at);
            let distance = at.norm();
            if nearest.is_none_or(|nearest| distance < nearest.seen_at) {
                nearest = Some(Target { tag: sight.tag, at, seen_at: distance, unseen: (0, 0.0) });
            }
        }
        nearest
    }

    /// Returns whether the target is near ahead, or abreast, or passed out of view.
    fn has_arrived(&self, direction: Cardinal, target: &Target) -> bool {
        let Perception { arrival_m, passed_m, grouping_m, .. } = self.perception;
        let distance = target.at.norm();
        let heading = self.heading.map_or(0.0, |(heading, _)| heading);
        let along = Pose::new(0.0, 0.0, heading - direction.heading()).transform(target.at).x;
        distance <= arrival_m
            || (along <= arrival_m && distance <= grouping_m)
            || (target.unseen.0 >= PASSED_FRAMES && target.seen_at <= passed_m)
    }
}
