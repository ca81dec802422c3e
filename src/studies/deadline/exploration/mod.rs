//! `ExplorationTask(T, G)`: section 4, Algorithm 3, and the random moves that precede its strategy.
//!
//! The listing's loop waits for the robot; here the robot's arrivals drive it ([`Explorer::arrive`]), and each answer
//! is the next exit to take or the end of the task.

use super::intersection::{Intersection, Opening};
use super::navigation::{Flag, NavigateToVertex};
use super::planner::{Plan, PlanError};
use super::rules::{InitialEdges, Rules, UnplannedSpeed};
use super::schedule::LocalDeadline;
use super::strategy::{Came, Chooser, uniform};
use super::toposemantic_map::{Arrival, Edge, MapError, ToposemanticMap, VertexId};
use crate::geometry::Cardinal;
use crate::rng::{Seeds, Stream};
use crate::studies::deadline::build_cmdp::{Maneuvers, Motion, Speed, Through};
use thiserror::Error;

/// The robot's next action.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// Leave the vertex.
    Leave(Leave),
    /// The goal is reached.
    GlobalSuccess,
    /// The task ends without it.
    GiveUp(GiveUp),
}

/// Leave the vertex by an exit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leave {
    /// The exit.
    pub exit: Cardinal,
    /// Whether it leads through a corridor or a door.
    pub opening: Opening,
    /// What it leads through, seen from where the robot comes.
    pub through: Through,
    /// The motion.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
}

/// Why the task ends without the goal.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GiveUp {
    /// Line 12 of Algorithms 2 and 3.
    #[error("the deadline has passed")]
    DeadlinePassed,
    /// Every edge is explored.
    #[error("nothing is left to explore")]
    NothingLeft,
    /// An observation that does not fit the map.
    #[error("the map became inconsistent: {0}")]
    Inconsistent(#[from] MapError),
    /// There is no plan to go on.
    #[error("no plan: {0}")]
    NoPlan(#[from] PlanError),
}

/// The purpose of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Purpose {
    /// Moving randomly until there are K vertices.
    Initial,
    /// Navigating to the chosen vertex (Algorithm 2, line 11).
    Navigate,
    /// Following an edge (v, v∅) (Algorithm 3, line 8).
    Explore,
}

/// One move, from one vertex to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Its beginning (s since the task began).
    pub at_s: f64,
    /// The vertex that it leaves.
    pub from: VertexId,
    /// The exit, motion and speed.
    pub leave: Leave,
    /// Its purpose.
    pub purpose: Purpose,
}

/// A vertex with edges (v, v∅), as it was when the choice was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Candidate {
    /// v'.
    pub vertex: VertexId,
    /// How many such edges it has.
    pub unexplored: usize,
    /// d(v'), in edges.
    pub distance: usize,
}

/// One answer of `ExplorationNext` with its plan.
#[derive(Debug, Clone)]
pub struct Decision {
    /// Its time (s since the task began).
    pub at_s: f64,
    /// v_c.
    pub from: VertexId,
    /// 𝒱, the vertices among which to choose, in order of discovery.
    pub candidates: Vec<Candidate>,
    /// t_d.
    pub deadline: LocalDeadline,
    /// v, and π*.
    pub navigation: NavigateToVertex,
}

impl Decision {
    /// Returns v.
    pub fn target(&self) -> VertexId {
        self.navigation.target()
    }

    /// Returns π*, unless v = v_c.
    pub fn plan(&self) -> Option<&Plan> {
        self.navigation.plan()
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    /// Fewer than K vertices.
    Initial,
    /// Lines 3 to 5, following the last decision.
    Navigating,
    /// Line 8, on an edge (v, v∅).
    Following,
    /// Nothing more to do.
    Ended(Next),
}

/// An exploring mind.
#[derive(Debug)]
pub struct Explorer {
    rules: Rules,
    expectations: Maneuvers,
    deadline_s: f64,
    chooser: Chooser,
    /// Random choices of vertices and edges.
    choosing: Stream,
    /// Random execution: randomised policies. A stream of its own, so that planners are compared on equal choices.
    executing: Stream,
    map: ToposemanticMap,
    current: Option<VertexId>,
    phase: Phase,
    decisions: Vec<Decision>,
    moves: Vec<Move>,
    arrivals: Vec<(VertexId, Option<Arrival>)>,
}

impl Explorer {
    /// Creates a mind without observations, with the global deadline T = `deadline_s` and the maneuvers that it can do with
    /// what it expects of each. It draws from two streams of `seeds`, `exploration` and `policy`.
    pub fn new(rules: &Rules, expectations: Maneuvers, deadline_s: f64, seeds: &Seeds) -> Self {
        Self {
            rules: rules.clone(),
            expectations,
            deadline_s,
            chooser: Chooser::new(rules),
            choosing: seeds.stream("exploration"),
            executing: seeds.stream("policy"),
            map: ToposemanticMap::new(),
            current: None,
            phase: Phase::Initial,
            decisions: Vec::new(),
            moves: Vec::new(),
            arrivals: Vec::new(),
        }
    }

    /// Takes in that the robot stands at a vertex, `now_s` after the task began: its start, or the end of its last
    /// move. The goal counts on arrival, whatever the purpose of the move. After the task's end the answer stays the
    /// same.
    pub fn arrive(&mut self, now_s: f64, here: &Intersection) -> Next {
        if let Phase::Ended(next) = &self.phase {
            return next.clone();
        }
        let next = self.turn(now_s, here).unwrap_or_else(Next::GiveUp);
        if !matches!(next, Next::Leave(_)) {
            self.phase = Phase::Ended(next.clone());
        }
        next
    }

    /// Returns M.
    pub fn map(&self) -> &ToposemanticMap {
        &self.map
    }

    /// Returns v_c: the vertex at which the robot arrived last.
    pub fn current(&self) -> Option<VertexId> {
        self.current
    }

    /// Returns every decision so far.
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// Returns every move so far, the one under way last.
    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// Returns every vertex at which the robot arrived so far, and how; `None` for the start.
    pub fn arrivals(&self) -> &[(VertexId, Option<Arrival>)] {
        &self.arrivals
    }

    /// Runs one turn of Algorithm 3 up to the next move. Comments name the lines of the listings.
    fn turn(&mut self, now_s: f64, here: &Intersection) -> Result<Next, GiveUp> {
        let current = self.perceive(here)?;
        // Line 3, and line 4 of Algorithm 2: even the goal comes too late.
        if now_s >= self.deadline_s {
            return Err(GiveUp::DeadlinePassed);
        }
        if self.map.is_goal(current) {
            return Ok(Next::GlobalSuccess);
        }
        if self.phase == Phase::Initial && self.map.len() < self.rules.initial_vertices as usize {
            return Ok(Next::Leave(self.move_randomly(now_s, current)?));
        }
        if self.phase != Phase::Navigating {
            self.exploration_next(now_s, current)?;
        }
        // Line 5.
        let decision = self.decisions.last().expect("a navigating robot has decided");
        match decision.navigation.step(&self.map, current, &mut self.executing)? {
            Flag::GlobalSuccess => Ok(Next::GlobalSuccess),
            Flag::Execute(action) => {
                let edge =
                    self.map.edge(current, action.exit).expect("plans take edges of the map");
                let leave = self.leave(edge, action.speed);
                Ok(Next::Leave(self.go(now_s, current, leave, Purpose::Navigate)))
            }
            // Lines 6 to 8.
            Flag::LocalSuccess => {
                let unexplored: Vec<Edge> = self.map.unexplored(current).collect();
                let edge = uniform(&unexplored, &mut self.choosing).ok_or(GiveUp::NothingLeft)?;
                self.phase = Phase::Following;
                let leave = self.unplanned(now_s, edge);
                Ok(Next::Leave(self.go(now_s, current, leave, Purpose::Explore)))
            }
        }
    }

    /// Does line 9, `CreateNewNode`, and recognises known vertices, which the listing leaves to the IDS.
    fn perceive(&mut self, here: &Intersection) -> Result<VertexId, MapError> {
        let (current, arrival) = match (self.current, self.moves.last()) {
            (Some(from), Some(last)) => {
                let (current, arrival) = self.map.arrive(from, last.leave.exit, here)?;
                (current, Some(arrival))
            }
            _ => (self.map.begin(here)?, None),
        };
        debug_assert_eq!(self.map.check(), Ok(()));
        self.current = Some(current);
        self.arrivals.push((current, arrival));
        Ok(current)
    }

    /// Does `InitializeGraph`: "it initially randomly moves around until it has K vertices in the graph". It takes any
    /// of the current vertex's unexplored edges, or where it has none, or by [`InitialEdges::Any`], any of its edges. A
    /// building of fewer than K vertices ends it too.
    fn move_randomly(&mut self, now_s: f64, current: VertexId) -> Result<Leave, GiveUp> {
        if self.map.ids().all(|v| self.map.unexplored_degree(v) == 0) {
            return Err(GiveUp::NothingLeft);
        }
        let mut edges: Vec<Edge> = self.map.unexplored(current).collect();
        if edges.is_empty() || self.rules.initial_edges == InitialEdges::Any {
            edges = self.map.edges_from(current).collect();
        }
        let edge = uniform(&edges, &mut self.choosing).ok_or(GiveUp::NothingLeft)?;
        let leave = self.unplanned(now_s, edge);
        Ok(self.go(now_s, current, leave, Purpose::Initial))
    }

    /// Does line 4, v, t_d ← `ExplorationNext(M, time)`, and the beginning of line 5.
    fn exploration_next(&mut self, now_s: f64, current: VertexId) -> Result<(), GiveUp> {
        let came = self.came();
        let target = self.chooser.next(&self.map, current, came, &mut self.choosing);
        let target = target.ok_or(GiveUp::NothingLeft)?;
        let distances = self.map.distances(current);
        let candidate = |v: VertexId| {
            let (unexplored, distance) = (self.map.unexplored_degree(v), distances[v.index()]?);
            (unexplored > 0).then_some(Candidate { vertex: v, unexplored, distance })
        };
        let candidates = self.map.ids().filter_map(candidate).collect();
        let edges = distances[target.index()].expect("candidates are reachable");
        let deadline = self.rules.schedule.local_deadline(edges, now_s, self.deadline_s);
        let navigation = NavigateToVertex::begin(
            &self.map,
            current,
            target,
            &deadline,
            &self.rules.planner,
            &self.expectations,
        )?;
        self.decisions.push(Decision {
            at_s: now_s,
            from: current,
            candidates,
            deadline,
            navigation,
        });
        self.phase = Phase::Navigating;
        Ok(())
    }

    /// Returns the robot's last move, by which it came to where it is.
    fn came(&self) -> Option<Came> {
        let last = self.moves.last()?;
        Some(Came { from: last.from, direction: last.leave.exit, opening: last.leave.opening })
    }

    /// Returns how to pass `edge` at that speed.
    fn leave(&self, edge: Edge, speed: Speed) -> Leave {
        let through = Came::through(self.came(), &self.map, &edge);
        let motion = self.expectations.motion(through, edge.side());
        Leave { exit: edge.direction, opening: edge.opening, through, motion, speed }
    }

    /// Returns how to follow `edge` without a plan.
    fn unplanned(&self, now_s: f64, edge: Edge) -> Leave {
        let Leave { motion, through, .. } = self.leave(edge, Speed::Slow);
        let speed = match self.rules.unplanned_speed {
            UnplannedSpeed::Slow => Speed::Slow,
            UnplannedSpeed::Fast => Speed::Fast,
            UnplannedSpeed::Schedule => {
                let slow = self.expectations.expect(motion, through, Speed::Slow).time_s;
                let given = self.rules.schedule.local_deadline(1, now_s, self.deadline_s).seconds;
                if slow > given { Speed::Fast } else { Speed::Slow }
            }
        };
        self.leave(edge, speed)
    }

    fn go(&mut self, at_s: f64, from: VertexId, leave: Leave, purpose: Purpose) -> Leave {
        self.moves.push(Move { at_s, from, leave, purpose });
        leave
    }
}

#[cfg(test)]
mod tests;
