//! Algorithm 3 on the building's graph: the mind decides at vertices as ever, and what lies between them is what
//! [`GraphLevel`](crate::studies::deadline::GraphLevel) states.
//!
//! 1. Look around, to see the first vertex.
//! 2. At a vertex, let the mind decide, measured by the stopwatch.
//! 3. End at the goal, or, before the deadline, where it gives up; else draw whether the maneuver fails.
//! 4. One that fails does so at any point of it, with the same probability; any other arrives after its duration.
//! 5. What would happen after the deadline does not: the time since the last new vertex separates a late trial from a
//!    stalled one.

use super::tally::{self, Done, Tally};
use super::{Ending, Prepared, record};
use crate::digest::Hasher;
use crate::studies::deadline::Setup;
use crate::studies::deadline::build_cmdp::{Maneuvers, Place};
use crate::studies::deadline::exploration::{Explorer, Leave, Next};
use crate::studies::deadline::intersection::{Exit, Intersection, Opening};
use crate::studies::state_chain::StateChain;
use crate::studies::{Measures, Outcome, Stopwatch, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};
use crate::world::RegionKind;
use crate::world::topology::{self, Topology};

/// The measure that marks a trial of this level.
pub(in crate::studies::deadline) const MARK: &str = "graph-level";

/// Explores until the goal is reached, a maneuver fails or the time is up.
pub(super) fn run(
    spec: &TrialSpec,
    setup: &Setup,
    prepared: &Prepared,
    watch: &mut dyn Stopwatch,
) -> TrialRecord {
    let topology = &prepared.topology;
    let Some(calibration) = &setup.calibration else {
        return TrialRecord::panicked(spec, "the planner has no calibration".to_owned());
    };
    let parameters = &setup.parameters;
    let start = setup.start.position();
    let Some(start) = topology.vertex_near(start, parameters.perception.grouping_m) else {
        return TrialRecord::panicked(spec, "no vertex of the graph is at the start".to_owned());
    };
    let calibrated = calibration.maneuvers(parameters.rules.side_corridors);
    let taken = parameters.graph.maneuvers(&calibrated);
    let mut walk = Walk {
        mind: Explorer::new(&parameters.rules, taken, parameters.mission.deadline_s, &spec.seeds),
        places: places(topology),
        topology,
        taken,
        tally: Tally::default(),
        chain: StateChain::default(),
        deadline: Tick::at_or_after(Seconds(parameters.mission.deadline_s)),
        patience: Tick::at_or_after(Seconds(parameters.mission.stalled_after_s)),
    };
    let began = Tick::at_or_after(Seconds(parameters.graph.look_around_s));
    let ending = walk.run(start, began, spec, watch);
    let mut measures = Measures::new();
    measures.insert(MARK.to_owned(), Some(1.0));
    measures.insert("distance-m".to_owned(), None);
    measures.insert("turning-rad".to_owned(), None);
    walk.tally.measures(&mut measures);
    tally::decided(&walk.mind, &mut measures);
    record(spec, ending, Tick(0), measures, &walk.chain)
}

/// Returns the vertices of `topology` as the IDS would report them, each recognised by its vertex tag alone.
pub(super) fn places(topology: &Topology) -> Vec<Intersection> {
    let exit = |exit: &topology::Exit| Exit {
        direction: exit.direction,
        opening: match exit.opening {
            topology::Opening::Corridor => Opening::Corridor,
            topology::Opening::Door => Opening::Door,
        },
    };
    let place = |vertex: &topology::Vertex| Intersection {
        tags: vec![vertex.tag.clone()],
        place: match vertex.kind {
            RegionKind::Room => Place::Room,
            RegionKind::Corridor => Place::Corridor,
        },
        exits: vertex.exits.iter().map(exit).collect(),
        is_goal: vertex.is_goal,
    };
    topology.vertices.iter().map(place).collect()
}

struct Walk<'a> {
    mind: Explorer,
    places: Vec<Intersection>,
    topology: &'a Topology,
    taken: Maneuvers,
    tally: Tally,
    chain: StateChain,
    deadline: Tick,
    patience: Tick,
}

impl Walk<'_> {
    fn run(
        &mut self,
        start: usize,
        began: Tick,
        spec: &TrialSpec,
        watch: &mut dyn Stopwatch,
    ) -> Ending {
        let mut failures = spec.seeds.stream("graph-level");
        // 1. Look around.
        let (mut at, mut now, mut discovered) = (start, began, Tick(0));
        while now < self.deadline {
            self.remember(at, now);
            // 2. Decide.
            self.tally.arrive(now);
            let (known, chosen) = (self.mind.map().len(), self.mind.decisions().len());
            watch.asked();
            let next = self.mind.arrive(now.seconds().get(), &self.places[at]);
            if self.mind.decisions().len() > chosen {
                watch.chose();
            }
            if self.mind.map().len() > known {
                discovered = now;
            }
            // 3. Act.
            let leave = match next {
                Next::GlobalSuccess => return Ending::plain(Outcome::REACHED, now),
                Next::GiveUp(why) => {
                    return Ending { outcome: Outcome::STALLED, cause: why.to_string(), at: now };
                }
                Next::Leave(leave) => leave,
            };
            let Leave { motion, speed, through, .. } = leave;
            self.tally.begin(Done { motion, speed, through }, now);
            let expected = self.taken.expect(motion, through, speed);
            let after = |share: f64| now + Tick::at_or_after(Seconds(share * expected.time_s));
            // 4. Both numbers are drawn for every maneuver, so that the next one's do not depend on this one's.
            let (fails, share) = (failures.uniform() < expected.failure, failures.uniform());
            if fails {
                let at = after(share);
                if at < self.deadline {
                    self.tally.collide();
                    return Ending::plain(Outcome::COLLIDED, at);
                }
                break;
            }
            let Some(to) = self.end(at, leave) else {
                let cause = "left by an exit that the building does not have".to_owned();
                return Ending { outcome: Outcome::PANICKED, cause, at: now };
            };
            (at, now) = (to, after(1.0));
        }
        // 5. The deadline.
        let idle = self.deadline.0 - discovered.0.min(self.deadline.0);
        let stalled = idle >= self.patience.0;
        let outcome = if stalled { Outcome::STALLED } else { Outcome::LATE };
        Ending::plain(outcome, self.deadline)
    }

    fn end(&self, at: usize, leave: Leave) -> Option<usize> {
        let exits = &self.topology.vertices[at].exits;
        exits.iter().find(|exit| exit.direction == leave.exit).map(|exit| exit.to)
    }

    /// Adds the state to the chain for every 10 s that have passed since the last vertex.
    fn remember(&mut self, at: usize, now: Tick) {
        while self.chain.is_due(now) {
            self.chain.push(|hasher: &mut Hasher| {
                hasher.update((at as u64).to_le_bytes()).update(now.0.to_le_bytes());
            });
        }
    }
}
