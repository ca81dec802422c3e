//! Tags of a small building as a camera without occlusion would detect them, driven past by a robot on rails.

use super::*;
use crate::geometry::Axis;
use crate::math;
use crate::rng::{Seeds, Stream};
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::Exit;
use Cardinal::{East, North, South, West};
use proptest::prelude::{ProptestConfig, prop_assert_eq, proptest};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Ticks between frames: 10 Hz.
const FRAME: u64 = 300;
const FRAME_S: f64 = 0.1;

/// A tag of the world.
#[derive(Debug, Clone)]
struct Placed {
    id: String,
    color: &'static str,
    pose: Pose,
}

/// Returns a vertex of the world with its tags.
fn vertex(x: f64, y: f64, room: bool, exits: &[(Cardinal, bool)]) -> Vec<Placed> {
    let tag = |color, pose| Placed { id: String::new(), color, pose };
    let mut tags = vec![tag(if room { "blue" } else { "green" }, Pose::new(x, y, 0.0))];
    for (direction, door) in exits {
        let at = Pose::new(x, y, direction.heading());
        let at = at.compose(Pose::new(0.5, 0.0, 0.0));
        tags.push(tag(if *door { "yellow" } else { "white" }, at));
    }
    tags
}

/// Returns a corridor a - b - c going east, 4.5 m apart; rooms north of a and north and south of b; behind the wall at
/// c's end a room d, whose tags are on the corridor's line and whose door is to the east. Its north has the goal.
///
/// ```text
///   R      N
///   a------b------c |  d
///          S
/// ```
fn building() -> Vec<Placed> {
    let mut tags = [
        vertex(0.0, 0.0, false, &[(East, false), (North, true)]),
        vertex(4.5, 0.0, false, &[(East, false), (West, false), (North, true), (South, true)]),
        vertex(9.0, 0.0, false, &[(West, false)]),
        vertex(0.0, 3.2, true, &[(South, true)]),
        vertex(4.5, 3.0, true, &[(South, true)]),
        vertex(4.5, -3.0, true, &[(North, true)]),
        vertex(11.5, 0.0, true, &[(East, true)]),
    ]
    .concat();
    tags.push(Placed { id: String::new(), color: "red", pose: Pose::new(4.5, 3.3, 0.0) });
    for (number, tag) in tags.iter_mut().enumerate() {
        tag.id = format!("t{number:02}");
    }
    tags
}

/// Permutes the ids: t00 becomes another's, and so on.
fn permuted(mut tags: Vec<Placed>, seed: u64) -> Vec<Placed> {
    let mut stream = Seeds::new(seed, Vec::new()).stream("ids");
    for last in (1..tags.len()).rev() {
        let other = usize::try_from(stream.below(last as u64 + 1)).unwrap();
        let (a, b) = (tags[last].id.clone(), tags[other].id.clone());
        tags[last].id = b;
        tags[other].id = a;
    }
    tags
}

/// A robot that moves exactly as it is placed, with a camera of 120 degrees that sees 6 m far through walls.
struct Rig {
    tags: Vec<Placed>,
    ids: IntersectionDetectionSystem,
    pose: Pose,
    tick: u64,
    noise: Stream,
    /// Amplitude of the compass's error (rad).
    compass_error: f64,
    /// Share of frames in which nothing is detected.
    blind: f64,
    /// The commanded speed is the true one times this.
    slip: f64,
}

impl Rig {
    fn new(tags: Vec<Placed>, pose: Pose) -> Self {
        Self {
            tags,
            ids: IntersectionDetectionSystem::new(&Perception::default()),
            pose,
            tick: 0,
            noise: Seeds::new(5, Vec::new()).stream("noise"),
            compass_error: 9_f64.to_radians(),
            blind: 0.0,
            slip: 1.0,
        }
    }

    fn detections(&mut self) -> Vec<Detection> {
        if self.noise.uniform() < self.blind {
            return Vec::new();
        }
        let mut seen: Vec<(f64, f64, Detection)> = Vec::new();
        for tag in &self.tags {
            let pose = self.pose.relative(tag.pose);
            let at = pose.position();
            let (distance, bearing) = (at.norm(), math::atan2(at.y, at.x));
            if (0.05..=6.0).contains(&distance) && bearing.abs() <= 1.05 {
                let (id, color) = (tag.id.as_str().into(), tag.color.into());
                seen.push((distance, bearing, Detection { id, color, pose }));
            }
        }
        seen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        seen.into_iter().map(|(_, _, detection)| detection).collect()
    }

    /// Runs one frame after moving for 0.1 s at these true speeds.
    fn frame(&mut self, linear: f64, angular: f64) -> Option<Intersection> {
        let turned = Pose::new(linear * FRAME_S, 0.0, angular * FRAME_S);
        self.pose = self.pose.compose(turned);
        self.tick += FRAME;
        let error = self.noise.between(-self.compass_error, self.compass_error);
        let compass = CompassReading {
            stamp: Tick(self.tick),
            heading: math::wrap_angle(self.pose.heading + error),
        };
        let commanded = Twist { linear: linear * self.slip, angular: angular * self.slip };
        let detections = self.detections();
        self.ids.observe(&detections, compass, commanded)
    }

    /// Turns once around on the spot.
    fn look_around(&mut self) -> Option<Intersection> {
        self.ids.begin_look_around();
        for _ in 0..70 {
            assert_eq!(self.frame(0.0, TAU / 7.0), None);
        }
        self.ids.end_look_around()
    }

    /// Turns towards `direction` and drives until it arrives, swaying by `sway` (m) about the line; returns how far off
    /// it is then.
    fn go(&mut self, direction: Cardinal, opening: Opening, sway: f64) -> (Intersection, Point) {
        self.ids.depart(direction, opening);
        loop {
            let off = math::wrap_angle(direction.heading() - self.pose.heading);
            if off.abs() < 1e-9 {
                break;
            }
            assert_eq!(self.frame(0.0, off.clamp(-0.05, 0.05) / FRAME_S), None, "while turning");
        }
        let line = if direction.axis() == Axis::EastWest { self.pose.y } else { self.pose.x };
        for step in 0..300 {
            if let Some(here) = self.frame(0.33, 0.0) {
                return (here, self.pose.position());
            }
            let aside = line + sway * math::sin(f64::from(step) * 0.2);
            match direction.axis() {
                Axis::EastWest => self.pose.y = aside,
                Axis::NorthSouth => self.pose.x = aside,
            }
        }
        panic!("never arrived; at {:?}", self.pose)
    }
}

fn exit(direction: Cardinal, opening: Opening) -> Exit {
    Exit { direction, opening }
}

/// Returns the number of the vertex tag nearest to `here`'s tags, by id: the vertex's identity.
fn which(tags: &[Placed], here: &Intersection) -> (i64, i64) {
    let mine = tags.iter().find(|tag| here.tags.contains(&tag.id)).unwrap();
    let vertices = tags.iter().filter(|tag| ["green", "blue"].contains(&tag.color));
    let distance = |tag: &Placed| tag.pose.position().distance(mine.pose.position());
    let nearest = vertices.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    #[expect(clippy::cast_possible_truncation, reason = "a few metres")]
    let tenths = |x: f64| (x * 10.0).round() as i64;
    (tenths(nearest.pose.x), tenths(nearest.pose.y))
}

#[test]
fn a_turn_on_the_spot_tells_the_start_without_its_vertex_tag() {
    let mut rig = Rig::new(building(), Pose::new(4.5, 0.0, 0.3));
    let here = rig.look_around().unwrap();
    assert_eq!(here.place, Place::Corridor);
    let (corridor, door) = (Opening::Corridor, Opening::Door);
    assert_eq!(
        here.exits,
        [exit(East, corridor), exit(North, door), exit(West, corridor), exit(South, door)]
    );
    assert!(!here.is_goal);
    assert_eq!(which(&rig.tags, &here), (45, 0));
    assert!(!here.tags.contains(&"t03".to_owned()), "the vertex tag is under the robot");
}

#[test]
fn a_start_in_a_room_is_a_room() {
    let mut rig = Rig::new(building(), Pose::new(4.5, -3.05, PI));
    let here = rig.look_around().unwrap();
    assert_eq!((here.place, here.exits), (Place::Room, vec![exit(North, Opening::Door)]));
    let mut nowhere = Rig::new(building(), Pose::new(30.0, 30.0, 0.0));
    assert_eq!(nowhere.look_around(), None);
}

/// Checks kind, exits, target and arrival from a to b, and that the room d is never taken for the corridor's end.
#[test]
fn a_corridor_is_followed_to_its_next_vertex_and_its_end() {
    let mut rig = Rig::new(building(), Pose::new(0.0, 0.0, FRAC_PI_2));
    let start = rig.look_around().unwrap();
    assert_eq!(start.exits, [exit(East, Opening::Corridor), exit(North, Opening::Door)]);
    let (b, at) = rig.go(East, Opening::Corridor, 0.1);
    assert_eq!(which(&rig.tags, &b), (45, 0));
    assert!((4.0..=4.2).contains(&at.x), "0.4 m before it: {at:?}");
    assert_eq!((b.place, b.exits.len()), (Place::Corridor, 4));
    assert_eq!(b.tags.len(), 5, "its vertex tag and four exits");
    let (c, _) = rig.go(East, Opening::Corridor, 0.1);
    assert_eq!(which(&rig.tags, &c), (90, 0));
    assert_eq!(c.exits, [exit(West, Opening::Corridor)], "a dead end");
}

#[test]
fn a_door_leads_to_its_room_and_the_goal_counts_on_arrival() {
    let mut rig = Rig::new(building(), Pose::new(4.5, 0.0, 0.0));
    let start = rig.look_around().unwrap();
    assert!(!start.is_goal, "though the goal's tag was seen");
    let (goal, _) = rig.go(North, Opening::Door, 0.05);
    assert_eq!((goal.place, goal.is_goal), (Place::Room, true));
    assert_eq!(goal.exits, [exit(South, Opening::Door)]);
    // Back, and recognised by the tags that were seen at the start.
    let (back, _) = rig.go(South, Opening::Door, 0.05);
    assert!(start.tags.iter().all(|tag| back.tags.contains(tag)));
    assert_eq!(back.exits, start.exits);
    let (south, _) = rig.go(South, Opening::Door, 0.05);
    assert_eq!((which(&rig.tags, &south), south.is_goal), ((45, -30), false));
}

#[test]
fn the_target_is_where_the_far_end_is() {
    let mut rig = Rig::new(building(), Pose::new(0.0, 0.1, 0.0));
    rig.look_around().unwrap();
    assert_eq!(rig.ids.target(), None, "not on an edge");
    rig.ids.depart(East, Opening::Corridor);
    assert_eq!(rig.frame(0.33, 0.0), None);
    let target = rig.ids.target().unwrap();
    let expected = rig.pose.inverse_transform(Point::new(4.5, 0.0));
    assert!(target.distance(expected) < 1e-9, "{target:?}, {expected:?}");
}

/// Checks that in frames without sight the position is predicted by the commanded speeds, for a while.
#[test]
fn a_moment_without_sight_is_bridged() {
    let mut rig = Rig::new(building(), Pose::new(0.0, 0.0, 0.0));
    rig.look_around().unwrap();
    rig.ids.depart(East, Opening::Corridor);
    rig.frame(0.33, 0.0);
    rig.blind = 1.0;
    for _ in 0..10 {
        rig.frame(0.33, 0.1);
    }
    let expected = rig.pose.inverse_transform(Point::new(4.5, 0.0));
    let target = rig.ids.target().unwrap();
    assert!(target.distance(expected) < 0.02, "{target:?}, {expected:?}");
    for _ in 0..10 {
        rig.frame(0.33, 0.0);
    }
    assert_eq!(rig.ids.target(), None, "2 s are too long");
    rig.blind = 0.0;
    rig.frame(0.33, 0.0);
    assert!(rig.ids.target().is_some());
}

/// Checks that the next vertex but one is taken for the far end while the next is out of view, and that this is
/// corrected when it is seen.
#[test]
fn a_nearer_vertex_takes_over() {
    let mut rig = Rig::new(building(), Pose::new(3.2, 0.0, 0.0));
    let all = rig.tags.clone();
    rig.tags.retain(|tag| (tag.pose.x - 4.5).abs() > 1.0);
    rig.ids.depart(East, Opening::Corridor);
    rig.frame(0.0, 0.0);
    assert!(rig.ids.target().unwrap().distance(Point::new(5.8, 0.0)) < 1e-9, "c");
    rig.tags = all;
    rig.frame(0.0, 0.0);
    assert!(rig.ids.target().unwrap().distance(Point::new(1.3, 0.0)) < 1e-9, "b");
}

/// Checks that a vertex also counts as reached when it is passed a little aside: abreast, or out of view.
#[test]
fn a_vertex_driven_past_is_arrived_at() {
    let mut rig = Rig::new(building(), Pose::new(0.0, 0.6, 0.0));
    rig.ids.depart(East, Opening::Corridor);
    let (b, at) = rig.go(East, Opening::Corridor, 0.0);
    assert_eq!(which(&rig.tags, &b), (45, 0));
    assert!((4.0..4.2).contains(&at.x), "{at:?}");
}

#[test]
fn tags_of_other_colours_are_none_of_its_business() {
    let mut tags = building();
    for tag in &mut tags {
        if tag.color == "white" {
            tag.color = "purple";
        }
    }
    let mut rig = Rig::new(tags, Pose::new(4.5, 0.0, 0.0));
    let here = rig.look_around().unwrap();
    assert_eq!(here.exits, [exit(North, Opening::Door), exit(South, Opening::Door)]);
}

/// Drives a tour of the building and returns its places, exits and goals: no ids.
fn tour(rig: &mut Rig, sway: f64) -> Vec<((i64, i64), Intersection)> {
    let mut seen = Vec::new();
    let start = rig.look_around().unwrap();
    seen.push((which(&rig.tags, &start), start));
    let (corridor, door) = (Opening::Corridor, Opening::Door);
    for (direction, opening) in [
        (North, door),
        (South, door),
        (East, corridor),
        (South, door),
        (North, door),
        (North, door),
        (South, door),
        (East, corridor),
        (West, corridor),
        (West, corridor),
    ] {
        let (here, _) = rig.go(direction, opening, sway);
        seen.push((which(&rig.tags, &here), here));
    }
    seen
}

const TOUR: [(i64, i64); 11] = [
    (0, 0),
    (0, 32),
    (0, 0),
    (45, 0),
    (45, -30),
    (45, 0),
    (45, 30),
    (45, 0),
    (90, 0),
    (45, 0),
    (0, 0),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Checks that the tour visits what is there, whatever the noise, the missing frames and the slip, and that
    /// permuted ids change nothing.
    #[test]
    fn a_tour_is_told_right(
        seed in 0_u64..1_000_000, blind in 0.0..0.4, slip in 0.75..1.25, sway in 0.0..0.25,
        x in -0.1..0.1, y in -0.1..0.1, heading in -3.0..3.0
    ) {
        let run = |tags: Vec<Placed>| {
            let mut rig = Rig::new(tags, Pose::new(x, y, heading));
            rig.noise = Seeds::new(seed, Vec::new()).stream("noise");
            rig.blind = blind;
            rig.slip = slip;
            tour(&mut rig, sway)
        };
        let seen = run(building());
        let places: Vec<_> = seen.iter().map(|(place, _)| *place).collect();
        prop_assert_eq!(&places, &TOUR);
        let again = run(permuted(building(), seed));
        for ((place, here), (place_again, here_again)) in seen.iter().zip(&again) {
            prop_assert_eq!(place, place_again);
            prop_assert_eq!(here.place, here_again.place);
            prop_assert_eq!(&here.exits, &here_again.exits);
            prop_assert_eq!(here.is_goal, here_again.is_goal);
            prop_assert_eq!(here.tags.len(), here_again.tags.len());
        }
        // Exits are those of the building, each time.
        for (place, here) in &seen {
            let expected = match place {
                (0, 0) => 2,
                (45, 0) => 4,
                _ => 1,
            };
            prop_assert_eq!(here.exits.len(), expected);
            prop_assert_eq!(here.is_goal, *place == (45, 30));
        }
    }
}
