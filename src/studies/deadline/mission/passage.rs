//! One isolated maneuver, from a random vertex of the building where it is possible to the next: this measures the
//! planner's expectations.

use super::body::{Body, Happening};
use super::tally::{Done, Tally};
use super::{Ending, Prepared, record};
use crate::geometry::{Cardinal, Pose};
use crate::rng::Stream;
use crate::studies::deadline::Setup;
use crate::studies::deadline::build_cmdp::{Motion, SideCorridors, Through, motion_of};
use crate::studies::deadline::intersection::Opening;
use crate::studies::deadline::toposemantic_map::side;
use crate::studies::recording::Recording;
use crate::studies::{Measures, Outcome, TrialRecord, TrialSpec};
use crate::units::{Radians, Seconds, Tick};
use crate::world::RegionKind;
use crate::world::topology::{self, Topology};

/// Control periods that a passage stands still before it begins.
const SETTLING: u32 = 10;

/// A directed edge of the true graph.
#[derive(Debug, Clone, Copy)]
struct Way {
    from: usize,
    to: usize,
    direction: Cardinal,
    opening: Opening,
    through: Through,
}

/// Drives one maneuver and measures it.
pub(super) fn run(
    spec: &TrialSpec,
    setup: &Setup,
    prepared: &Prepared,
    recording: Option<&mut Recording>,
) -> TrialRecord {
    let passage = &setup.parameters.passage;
    let topology = &prepared.topology;
    let ways = ways(topology, passage.motion, setup.parameters.rules.side_corridors);
    let mut stream = spec.seeds.stream("passage");
    if ways.is_empty() {
        let cause = format!("the building has no way for the motion {:?}", passage.motion);
        return TrialRecord::panicked(spec, cause);
    }
    let way = ways[pick(&mut stream, ways.len())];
    let start = start(topology, way, setup, &mut stream);
    let mut body = Body::new(setup, prepared, start, &spec.seeds, recording);
    // The pilot keeps its heading from leg to leg: standing still it settles it, as it would have on the leg before.
    for _ in 0..SETTLING {
        body.step();
    }
    let began = body.now();
    let mut tally = Tally::default();
    let done = Done { motion: passage.motion, speed: passage.speed, through: way.through };
    tally.begin(done, began);
    body.leave(way.direction, way.opening, passage.motion, passage.speed);
    let limit = began + Tick::at_or_after(Seconds(passage.time_limit_s));
    let ending = loop {
        match body.step() {
            Happening::Contact => {
                tally.collide();
                break Ending::plain(Outcome::COLLIDED, body.now());
            }
            Happening::Arrived(here) => {
                let there = &topology.vertices[way.to].tag;
                if here.tags.contains(there) {
                    break Ending::plain(Outcome::REACHED, body.now());
                }
                let cause = "arrived at another vertex".to_owned();
                break Ending { outcome: Outcome::STALLED, cause, at: body.now() };
            }
            Happening::OnTheWay | Happening::Lost if body.now() >= limit => {
                break Ending::plain(Outcome::LATE, body.now());
            }
            Happening::OnTheWay | Happening::Lost => {}
        }
    };
    let mut measures = Measures::new();
    tally.passed(&mut measures);
    measures.insert("distance-m".to_owned(), Some(body.travelled()));
    measures.insert("turning-rad".to_owned(), Some(body.turned()));
    record(spec, ending, began, measures, body.chain())
}

/// Returns the directed edges that require `motion`: the side of a door is S(e), as the planner names it, and a side corridor
/// is one that no robot can go straight on into.
fn ways(topology: &Topology, motion: Motion, side_corridors: SideCorridors) -> Vec<Way> {
    let mut ways = Vec::new();
    for (from, vertex) in topology.vertices.iter().enumerate() {
        let corridor = |direction: Cardinal| {
            let mut exits = vertex.exits.iter();
            exits.any(|e| e.direction == direction && e.opening == topology::Opening::Corridor)
        };
        for exit in &vertex.exits {
            let direction = exit.direction;
            let across = direction.axis().across().directions();
            let is_side = !corridor(direction.opposite()) && across.into_iter().any(corridor);
            let (opening, through) = match (exit.opening, topology.vertices[exit.to].kind) {
                (topology::Opening::Corridor, _) if is_side => {
                    (Opening::Corridor, Through::SideCorridor)
                }
                (topology::Opening::Corridor, _) => (Opening::Corridor, Through::Corridor),
                (topology::Opening::Door, RegionKind::Room) => (Opening::Door, Through::Entering),
                (topology::Opening::Door, RegionKind::Corridor) => {
                    (Opening::Door, Through::Leaving)
                }
            };
            if motion_of(through, side(direction), side_corridors) == motion {
                ways.push(Way { from, to: exit.to, direction, opening, through });
            }
        }
    }
    ways
}

/// Draws the start of a passage: near its vertex, as if the robot had just come by one of its exits, all equally
/// likely.
fn start(topology: &Topology, way: Way, setup: &Setup, stream: &mut Stream) -> Pose {
    let passage = &setup.parameters.passage;
    let vertex = &topology.vertices[way.from];
    let came_by = vertex.exits[pick(stream, vertex.exits.len())].direction;
    let along = stream.between(-passage.offset_m, passage.offset_m);
    let across = stream.between(-passage.offset_m, passage.offset_m);
    let error = Radians::from_degrees(passage.heading_error_deg).get();
    let heading = came_by.opposite().heading();
    let offset = Pose::new(along, across, stream.between(-error, error));
    Pose::new(vertex.at.x, vertex.at.y, heading).compose(offset)
}

/// Draws one of `count` indices, all equally likely.
fn pick(stream: &mut Stream, count: usize) -> usize {
    #[expect(clippy::cast_possible_truncation, reason = "below a usize")]
    let place = stream.below(count as u64) as usize;
    place
}
