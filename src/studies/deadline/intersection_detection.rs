//! The Intersection Detection System (section 3: "the algorithms providing L, S and D"): from the tags in view and the compass to
//! vertices, their kinds and their outgoing edges.
//!
//! Colours say what a tag is; ids only whether it was seen before. A vertex tag gathers the exit and goal tags around it.
//! While the robot drives a leg, the vertex at its end is the nearest one ahead on the leg's line that has an exit back.

use super::intersection::{Exit, Intersection, Opening};
use super::rules::parameters;
use crate::cmdp::build::Place;
use crate::geometry::{Cardinal, Point};
use crate::math;
use crate::robot::{CompassReading, Detection};
use std::collections::BTreeMap;

parameters!(
    /// What tags mean and how near counts. The paper shows green and blue tags in its Figure 3 and does not say what they mean.
    Perception {
        /// Colour of the tag of a corridor vertex.
        corridor_color: String = "green".to_owned(),
        /// Colour of the tag of a room.
        room_color: String = "blue".to_owned(),
        /// Colour of the tag of an outgoing edge through a corridor; it faces along the edge.
        corridor_exit_color: String = "white".to_owned(),
        /// Colour of the tag of an outgoing edge through a door.
        door_exit_color: String = "yellow".to_owned(),
        /// Colour of the mark of the goal.
        goal_color: String = "red".to_owned(),
        /// Exits and marks within this distance (m) of a vertex tag belong to it, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        grouping_m: f64 = 1.0,
        /// A vertex counts as reached when it is this near ahead (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        arrival_m: f64 = 0.4,
        /// A vertex that leaves the view nearer than this (m) has been reached too, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        passed_within_m: f64 = 0.8,
        /// The end of a leg is sought at this distance or farther ahead (m), so that the vertex just left is not taken for it.
        #[schemars(extend("exclusiveMinimum" = 0))]
        nearest_end_m: f64 = 1.0,
        /// ... and at most this far aside of the leg's line (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        aside_m: f64 = 0.7,
    }
);

/// Cosine of 45 degrees: a robot that faces its leg's direction less is still turning towards it.
const FACING: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// What a tag is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Vertex(Place),
    Exit(Opening),
    Goal,
}

/// A vertex as far as it has been seen.
#[derive(Debug, Clone, Default)]
struct Sighting {
    /// Ids of its tags, as they were seen.
    tags: Vec<String>,
    place: Option<Place>,
    exits: Vec<Exit>,
    is_goal: bool,
}

impl Sighting {
    fn take_in(&mut self, detection: &Detection, meaning: Meaning, heading: f64) {
        if self.tags.contains(&detection.id) {
            return;
        }
        self.tags.push(detection.id.clone());
        match meaning {
            Meaning::Vertex(place) => self.place = Some(place),
            Meaning::Goal => self.is_goal = true,
            Meaning::Exit(opening) => {
                let direction = Cardinal::from_heading(heading + detection.pose.heading);
                if self.exits.iter().all(|exit| exit.direction != direction) {
                    self.exits.push(Exit { direction, opening });
                    self.exits.sort();
                }
            }
        }
    }

    fn intersection(&self) -> Intersection {
        // Where the vertex tag itself was never in view, as at the start: a room has doors only.
        let by_exits = if self.exits.iter().all(|exit| exit.opening == Opening::Door) {
            Place::Room
        } else {
            Place::Corridor
        };
        Intersection {
            tags: self.tags.clone(),
            place: self.place.unwrap_or(by_exits),
            exits: self.exits.clone(),
            is_goal: self.is_goal,
        }
    }
}

/// What the robot is doing, as far as it matters to what is sought.
#[derive(Debug, Clone)]
enum Phase {
    /// Looking around at a vertex.
    Around(Sighting),
    /// On a leg.
    Leg {
        direction: Cardinal,
        /// Id of the vertex tag at its end, once it was seen.
        end: Option<String>,
        /// Where that was last seen: along and across the leg (m).
        last: Option<Point>,
        /// Where it is seen now, in the base frame (m).
        now: Option<Point>,
    },
}

/// The system with what it has seen so far.
#[derive(Debug, Clone)]
pub struct IntersectionDetection {
    rule: Perception,
    /// Vertices by the id of their vertex tag. Looked up, never gone through: ids have no order that means anything.
    seen: BTreeMap<String, Sighting>,
    phase: Phase,
}

impl IntersectionDetection {
    /// A system that has seen nothing and looks around.
    pub fn new(rule: &Perception) -> Self {
        let phase = Phase::Around(Sighting::default());
        Self { rule: rule.clone(), seen: BTreeMap::new(), phase }
    }

    /// The robot leaves a vertex by the exit in `direction`: its end is sought from now on.
    pub fn leave(&mut self, direction: Cardinal) {
        self.phase = Phase::Leg { direction, end: None, last: None, now: None };
    }

    /// Takes in what the camera sees (nearest first) and the compass reads.
    pub fn observe(&mut self, detections: &[Detection], compass: CompassReading) {
        let heading = self.heading(detections, compass);
        let known: Vec<(&Detection, Meaning)> =
            detections.iter().filter_map(|d| Some((d, self.meaning(d)?))).collect();
        let is_vertex = |meaning: &Meaning| matches!(meaning, Meaning::Vertex(_));
        for (detection, meaning) in &known {
            let at = detection.pose.position();
            let vertices = known.iter().filter(|(_, m)| is_vertex(m)).map(|(d, _)| *d);
            let distance = |d: &Detection| d.pose.position().distance(at);
            let owner = vertices.min_by(|a, b| distance(a).total_cmp(&distance(b)));
            if let Some(owner) = owner.filter(|d| distance(d) <= self.rule.grouping_m) {
                let sighting = self.seen.entry(owner.id.clone()).or_default();
                sighting.take_in(detection, *meaning, heading);
            }
            // The robot hides the tag of the vertex that it stands on: what is near itself is near that one.
            if let Phase::Around(here) = &mut self.phase
                && at.norm() <= self.rule.grouping_m
            {
                here.take_in(detection, *meaning, heading);
            }
        }
        let ahead: Vec<(&Detection, Point)> = known
            .iter()
            .filter(|(_, meaning)| is_vertex(meaning))
            .map(|(detection, _)| (*detection, detection.pose.position()))
            .collect();
        self.follow(&ahead, heading);
    }

    /// The end of the current leg as it is seen now, in the base frame (m).
    pub fn target(&self) -> Option<Point> {
        match &self.phase {
            Phase::Around(_) => None,
            Phase::Leg { now, .. } => *now,
        }
    }

    /// The vertex that the robot has reached: the end of its leg, or, once it has `looked_around`, where it stands.
    pub fn arrived(&self, looked_around: bool) -> Option<Intersection> {
        match &self.phase {
            Phase::Around(here) => looked_around.then(|| here.intersection()),
            Phase::Leg { end, last, now, .. } => {
                let along = (*last)?.x;
                let reached = along <= self.rule.arrival_m
                    || (now.is_none() && along <= self.rule.passed_within_m);
                let end = end.as_ref().filter(|_| reached)?;
                self.seen.get(end).map(Sighting::intersection)
            }
        }
    }

    /// Finds or follows the end of the leg among the vertex tags in view.
    fn follow(&mut self, vertices: &[(&Detection, Point)], heading: f64) {
        let Phase::Leg { direction, end, last, now } = &mut self.phase else { return };
        let (sin, cos) = math::sin_cos(heading - direction.heading());
        let on_leg = |at: Point| Point::new(cos * at.x - sin * at.y, sin * at.x + cos * at.y);
        *now = None;
        if cos >= FACING {
            let has_way_back = |id: &String| {
                self.seen.get(id).is_some_and(|sighting| {
                    sighting.exits.iter().any(|exit| exit.direction == direction.opposite())
                })
            };
            // Sought anew as long as it is far: a nearer one may come into view.
            let nearest = vertices
                .iter()
                .map(|(detection, at)| (detection, on_leg(*at)))
                .filter(|(detection, at)| {
                    at.x >= self.rule.nearest_end_m
                        && at.y.abs() <= self.rule.aside_m
                        && has_way_back(&detection.id)
                })
                .min_by(|a, b| a.1.x.total_cmp(&b.1.x));
            let found = last.is_none_or(|last| last.x > self.rule.nearest_end_m);
            if let Some((detection, at)) = nearest.filter(|_| found)
                && last.is_none_or(|last| at.x < last.x + self.rule.grouping_m)
            {
                *end = Some(detection.id.clone());
            }
        }
        let Some(id) = end else { return };
        if let Some((_, at)) = vertices.iter().find(|(detection, _)| detection.id == *id) {
            *now = Some(*at);
            *last = Some(on_leg(*at));
        }
    }

    /// The robot's heading (rad): an exit runs along a cardinal direction, which the compass, for all its error, tells from
    /// the other three.
    fn heading(&self, detections: &[Detection], compass: CompassReading) -> f64 {
        let exit = detections.iter().find(|d| matches!(self.meaning(d), Some(Meaning::Exit(_))));
        exit.map_or(compass.heading, |exit| {
            let seen = exit.pose.heading;
            math::wrap_angle(Cardinal::from_heading(compass.heading + seen).heading() - seen)
        })
    }

    fn meaning(&self, detection: &Detection) -> Option<Meaning> {
        let color = &detection.color;
        let rule = &self.rule;
        [
            (&rule.corridor_color, Meaning::Vertex(Place::Corridor)),
            (&rule.room_color, Meaning::Vertex(Place::Room)),
            (&rule.corridor_exit_color, Meaning::Exit(Opening::Corridor)),
            (&rule.door_exit_color, Meaning::Exit(Opening::Door)),
            (&rule.goal_color, Meaning::Goal),
        ]
        .into_iter()
        .find(|(known, _)| *known == color)
        .map(|(_, meaning)| meaning)
    }
}
