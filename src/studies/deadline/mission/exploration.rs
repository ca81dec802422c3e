//! Algorithm 3 in a building: the mind decides at vertices, the body drives between them.
//!
//! 1. Look around, to see the first vertex.
//! 2. Drive for one control period at a time, until something happens: contact or no vertex in sight ends the trial.
//! 3. At a vertex, let the mind decide, measured by the stopwatch, and count what it found.
//! 4. End at the goal, or, before the deadline, where it gives up; else leave by the exit that it chose.
//! 5. At the deadline, the time since the last new vertex separates a late trial from a stalled one.

use super::body::{Body, Happening};
use super::tally::{self, Done, Tally};
use super::{Ending, Prepared, graph, record};
use crate::geometry::Point;
use crate::studies::deadline::Setup;
use crate::studies::deadline::build_cmdp::Maneuvers;
use crate::studies::deadline::exploration::{Explorer, Leave, Next};
use crate::studies::deadline::planner::Plan;
use crate::studies::recording::{Recording, SolvedPlan};
use crate::studies::{Measures, Outcome, Stopwatch, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};

/// Explores until the goal is reached, the body touches something or the time is up.
pub(super) fn run(
    spec: &TrialSpec,
    setup: &Setup,
    prepared: &Prepared,
    recording: Option<&mut Recording>,
    watch: &mut dyn Stopwatch,
) -> TrialRecord {
    let Some(calibration) = &setup.calibration else {
        return TrialRecord::panicked(spec, "the planner has no calibration".to_owned());
    };
    let expectations = calibration.maneuvers(setup.parameters.rules.side_corridors);
    let mut exploration = Exploration::new(spec, setup, prepared, expectations, recording);
    let ending = exploration.run(watch);
    exploration.write_plans_down();
    let mut measures = Measures::new();
    measures.insert("distance-m".to_owned(), Some(exploration.body.travelled()));
    measures.insert("turning-rad".to_owned(), Some(exploration.body.turned()));
    exploration.tally.measures(&mut measures);
    tally::decided(&exploration.mind, &mut measures);
    record(spec, ending, Tick(0), measures, exploration.body.chain())
}

struct Exploration<'a> {
    mind: Explorer,
    body: Body<'a>,
    tally: Tally,
    deadline: Tick,
    patience: Tick,
    /// When a vertex was last new.
    discovered: Tick,
    /// The robot's position when it first came to each vertex, for drawing.
    places: Vec<Point>,
}

impl<'a> Exploration<'a> {
    fn new(
        spec: &TrialSpec,
        setup: &Setup,
        prepared: &Prepared,
        expectations: Maneuvers,
        recording: Option<&'a mut Recording>,
    ) -> Self {
        let mission = &setup.parameters.mission;
        Self {
            mind: Explorer::new(
                &setup.parameters.rules,
                expectations,
                mission.deadline_s,
                &spec.seeds,
            ),
            body: Body::new(setup, prepared, setup.start, &spec.seeds, recording),
            tally: Tally::default(),
            deadline: Tick::at_or_after(Seconds(mission.deadline_s)),
            patience: Tick::at_or_after(Seconds(mission.stalled_after_s)),
            discovered: Tick(0),
            places: Vec::new(),
        }
    }

    fn run(&mut self, watch: &mut dyn Stopwatch) -> Ending {
        // 1. Look around.
        self.body.look_around();
        // 2. Drive.
        loop {
            match self.body.step() {
                Happening::OnTheWay => {}
                Happening::Contact => {
                    self.tally.collide();
                    return Ending::plain(Outcome::COLLIDED, self.body.now());
                }
                Happening::Lost => {
                    let cause = "saw no vertex where it began".to_owned();
                    return Ending { outcome: Outcome::STALLED, cause, at: self.body.now() };
                }
                Happening::Arrived(here) => {
                    // 3. Decide.
                    let now = self.body.now();
                    self.tally.arrive(now);
                    let known = self.mind.map().len();
                    let chosen = self.mind.decisions().len();
                    watch.asked();
                    let next = self.mind.arrive(now.seconds().get(), &here);
                    if self.mind.decisions().len() > chosen {
                        watch.chose();
                    }
                    if self.mind.map().len() > known {
                        self.discovered = now;
                        self.places.push(self.body.position());
                    }
                    // 4. Act.
                    match next {
                        Next::GlobalSuccess => return Ending::plain(Outcome::REACHED, now),
                        Next::GiveUp(why) if now < self.deadline => {
                            let cause = why.to_string();
                            return Ending { outcome: Outcome::STALLED, cause, at: now };
                        }
                        Next::GiveUp(_) => {}
                        Next::Leave(leave) => {
                            let Leave { exit, opening, through, motion, speed } = leave;
                            self.tally.begin(Done { motion, speed, through }, now);
                            self.body.leave(exit, opening, motion, speed);
                            if self.body.is_recorded() {
                                self.body.note(
                                    graph::view(&self.mind, &self.places),
                                    graph::told(&self.mind),
                                );
                            }
                        }
                    }
                }
            }
            // 5. The deadline.
            if self.body.now() >= self.deadline {
                let idle = self.deadline.0 - self.discovered.0.min(self.deadline.0);
                let stalled = idle >= self.patience.0;
                let outcome = if stalled { Outcome::STALLED } else { Outcome::LATE };
                return Ending::plain(outcome, self.body.now());
            }
        }
    }
}

impl Exploration<'_> {
    /// Writes down the constrained MDPs that were solved, where the trial is recorded.
    fn write_plans_down(&mut self) {
        let Some(recording) = self.body.recording() else { return };
        recording.deadline_s = Some(self.deadline.seconds().get());
        for decision in self.mind.decisions() {
            // A plan without a programme (an ablation's, or one that needed no move) has no model to show.
            if let Some(Ok(Some(document))) = decision.plan().map(Plan::document) {
                recording.plans.push(SolvedPlan { time_s: decision.at_s, document });
            }
        }
    }
}
