//! Planning the path to a vertex: lines 2 and 3 of Algorithm 2, and the ablations that plan without a CMDP.
//!
//! A plan states how it meets its deadline: [`Status::Slack`], [`Status::Active`] or [`Status::Relaxed`]. It can be
//! written as a constrained MDP that `reenact solve-cmdp` reads, and whose solution is the policy that was executed.

mod path;
#[cfg(test)]
mod tests;

use super::rules::parameters;
use super::toposemantic_map::{ToposemanticMap, VertexId};
use crate::cmdp::document::write_model;
use crate::cmdp::{
    Cmdp, Outcome, Policy, Relaxation, Solution, SolveError, Unmeetable, solve, solve_with,
};
use crate::geometry::Cardinal;
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::{
    BuildError, FAILURE, Maneuver, Maneuvers, Motion, Navigation, OrientedEdge, Reading, Speed,
    TIME, Task, Topology, build_cmdp,
};
use path::Way;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

parameters!(
    /// Planning the way to a vertex.
    Planning {
        /// What makes the plan.
        method: Method = Method::Cmdp,
        /// P_f, the bound on failure (section 6: 0.99), 0 or more.
        #[schemars(range(min = 0.0))]
        failure_bound: f64 = 0.99,
        /// What the costs of the CMDP mean, which the paper leaves open.
        reading: CostReading = CostReading::Additive,
    }
);

/// What makes the plan.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The CMDP of the paper.
    Cmdp,
    /// Ablation: the shortest path, all slow.
    AllSlow,
    /// Ablation: the shortest path, all fast.
    AllFast,
    /// Ablation: the shortest path, all fast if all slow is expected to take longer than t_d.
    Threshold,
}

/// What the costs of the CMDP mean.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum CostReading {
    /// Literally: a step costs 1, and failure probabilities add up.
    Additive,
    /// As in the papers it builds on: failing is a state, and its probability is minimised.
    Reach,
}

impl From<CostReading> for Reading {
    fn from(reading: CostReading) -> Self {
        match reading {
            CostReading::Additive => Self::Additive,
            CostReading::Reach => Self::Reach,
        }
    }
}

/// The relation of a plan to its deadline t_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The plan without a deadline meets it.
    Slack,
    /// It is met, and binds: the plan is faster somewhere than without it.
    Active,
    /// It cannot be met in expectation, and the least expected time is taken instead.
    Relaxed,
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// The task makes no model.
    #[error("the navigation task makes no model: {0}")]
    Build(#[from] BuildError),
    /// The model could not be solved.
    #[error("the navigation task could not be planned: {0}")]
    Solve(#[from] SolveError),
    /// No path of explored edges leads there.
    #[error("no explored edges lead from {from} to {to}")]
    Unreachable {
        /// The vertex at which the robot is.
        from: String,
        /// The vertex to which it should go.
        to: String,
    },
    /// The robot is where the plan never leads.
    #[error("the plan from {from} to {to} never leads to {at}")]
    OffTheWay {
        /// The vertex at which the plan begins.
        from: String,
        /// The vertex at which it ends.
        to: String,
        /// The vertex at which the robot is.
        at: String,
    },
}

/// One action of a plan: follow an exit by a motion at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Action {
    /// The exit.
    pub exit: Cardinal,
    /// The motion that its edge requires.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
}

/// π* of Algorithm 2, with the problem from which it was computed.
#[derive(Debug, Clone)]
pub struct Plan {
    problem: Problem,
    method: Method,
    policy: Known,
    status: Status,
    time_s: f64,
    failure: f64,
    failure_bound_dropped: bool,
}

/// The planning problem. Indices are those of the map's vertices.
#[derive(Debug, Clone)]
struct Problem {
    topology: Topology,
    task: Task,
    expectations: Maneuvers,
    /// Names of the vertices.
    labels: Vec<String>,
    /// The exit by which each edge leaves its vertex.
    exits: Vec<(VertexId, Cardinal)>,
}

/// The part of the policy that is known.
#[derive(Debug, Clone)]
enum Known {
    /// Deterministic, on one path.
    Way(Way),
    /// Everywhere.
    Everywhere { maneuvers: Vec<Maneuver>, policy: Policy },
}

impl Plan {
    /// Does lines 2 and 3 of Algorithm 2: plans the path on `map` from `from` to another vertex `to` within
    /// `deadline_s`.
    ///
    /// # Errors
    /// Numbers out of range, no path, or a model that cannot be solved.
    pub fn new(
        map: &ToposemanticMap,
        from: VertexId,
        to: VertexId,
        deadline_s: f64,
        planning: &Planning,
        expectations: &Maneuvers,
    ) -> Result<Self, PlanError> {
        let (topology, exits) = map.topology();
        let task = Task {
            from: from.index(),
            to: to.index(),
            deadline_s,
            failure: planning.failure_bound,
            reading: planning.reading.into(),
        };
        let labels = map.ids().map(|v| map.label(v).to_string()).collect();
        let problem = Problem { topology, task, expectations: *expectations, labels, exits };
        let method = planning.method;
        let way = match method {
            Method::Cmdp => path::unbound(&problem.topology, &problem.task, expectations),
            ablation => Some(
                path::ablation(&problem.topology, &problem.task, expectations, ablation)
                    .ok_or_else(|| problem.unreachable())?,
            ),
        };
        let Some(way) = way else { return Self::solved(problem) };
        let (status, time_s, failure) = (way.status, way.time_s, way.failure);
        let policy = Known::Way(way);
        Ok(Self { problem, method, policy, status, time_s, failure, failure_bound_dropped: false })
    }

    fn solved(problem: Problem) -> Result<Self, PlanError> {
        let Solved { maneuvers, solution, relaxed, .. } = problem.solve()?;
        let is_relaxed = |index| relaxed.iter().any(|r: &Relaxation| r.index == index);
        let (time_s, failure) = (solution.secondary[TIME], solution.secondary[FAILURE]);
        let status = if is_relaxed(TIME) {
            Status::Relaxed
        } else if time_s >= problem.task.deadline_s * (1.0 - AT_THE_BOUND) {
            Status::Active
        } else {
            Status::Slack
        };
        let failure_bound_dropped = is_relaxed(FAILURE);
        let policy = Known::Everywhere { maneuvers, policy: solution.policy };
        let method = Method::Cmdp;
        Ok(Self { problem, method, policy, status, time_s, failure, failure_bound_dropped })
    }

    /// Does a ← π*(v_c), line 10 of Algorithm 2. Where the policy is randomised, and only there, a number is drawn.
    ///
    /// # Errors
    /// A vertex at which the plan never arrives.
    pub fn action(&self, at: VertexId, stream: &mut Stream) -> Result<Action, PlanError> {
        let choices = self.choices(at);
        let drawn = match choices.as_slice() {
            [] => None,
            [(only, _)] => Some(*only),
            several => {
                let uniform = stream.uniform();
                let mut below = 0.0;
                let drawn = several.iter().find(|(_, probability)| {
                    below += probability;
                    uniform < below
                });
                // Rounding may leave the sum a hair below 1.
                drawn.or(several.last()).map(|(action, _)| *action)
            }
        };
        drawn.ok_or_else(|| PlanError::OffTheWay {
            from: self.problem.labels[self.problem.task.from].clone(),
            to: self.problem.labels[self.problem.task.to].clone(),
            at: self.problem.labels.get(at.index()).cloned().unwrap_or_default(),
        })
    }

    /// Returns π*(v, ·): the actions at `v` with their probabilities; empty at the target and where the plan never
    /// arrives.
    pub fn choices(&self, v: VertexId) -> Vec<(Action, f64)> {
        let action = |edge: usize, speed: Speed| {
            let Problem { topology, expectations, .. } = &self.problem;
            let OrientedEdge { through, side, .. } = topology.edges[edge];
            let motion = expectations.motion(through, side);
            Action { exit: self.problem.exits[edge].1, motion, speed }
        };
        match &self.policy {
            Known::Way(way) => {
                let step = way.steps.iter().find(|step| step.vertex == v.index());
                step.map(|step| (action(step.edge, step.speed), 1.0)).into_iter().collect()
            }
            Known::Everywhere { policy, .. }
                if v.index() >= self.problem.labels.len() || !policy.visits(v.index()) =>
            {
                Vec::new()
            }
            Known::Everywhere { maneuvers, policy } => {
                let choices = policy.at(v.index()).iter();
                let of =
                    |(a, p): &(usize, f64)| (action(maneuvers[*a].edge, maneuvers[*a].speed), *p);
                choices.map(of).collect()
            }
        }
    }

    /// Returns the plan's relation to its deadline.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Returns the method that made it.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Returns t_d (s).
    pub fn deadline_s(&self) -> f64 {
        self.problem.task.deadline_s
    }

    /// Returns the expected duration (s).
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Returns the expected failures: by [`CostReading::Additive`] the sum of probabilities, by [`CostReading::Reach`]
    /// the probability.
    pub fn failure(&self) -> f64 {
        self.failure
    }

    /// Returns whether P_f could not be met and was dropped.
    pub fn failure_bound_dropped(&self) -> bool {
        self.failure_bound_dropped
    }

    /// Writes the constrained MDP as JSON, of which the solution is the executed policy: bounds that could not be met
    /// are written as they were relaxed. `None` for the ablations, which solve none.
    ///
    /// # Errors
    /// None where the plan was made by this very model; the types allow one nevertheless.
    pub fn document(&self) -> Result<Option<String>, PlanError> {
        if self.method != Method::Cmdp {
            return Ok(None);
        }
        let Solved { cmdp, maneuvers, .. } = self.problem.solve()?;
        let topology = &self.problem.topology;
        let mut states = self.problem.labels.clone();
        if cmdp.states() > states.len() {
            states.push("failed".to_owned());
        }
        let actions: Vec<String> = maneuvers
            .iter()
            .map(|maneuver| {
                let edge = topology.edges[maneuver.edge];
                format!(
                    "{} to {}: {}, {}",
                    states[edge.from],
                    states[edge.to],
                    motion_name(maneuver.motion),
                    speed_name(maneuver.speed)
                )
            })
            .collect();
        Ok(Some(write_model(&cmdp, &states, &actions)))
    }
}

/// A model as it was solved.
struct Solved {
    cmdp: Cmdp,
    maneuvers: Vec<Maneuver>,
    solution: Solution,
    relaxed: Vec<Relaxation>,
}

/// An expected time that is short of its bound by less than this share is at the bound.
const AT_THE_BOUND: f64 = 1e-9;

impl Problem {
    /// Solves the model, with bounds that cannot be met as they were relaxed.
    ///
    /// A relaxed model is solved once more in its relaxed form: where several policies are equally good, the executed
    /// one is then that of the exported model.
    fn solve(&self) -> Result<Solved, PlanError> {
        let Navigation { mut cmdp, maneuvers } =
            build_cmdp(&self.topology, &self.task, &self.expectations)?;
        let handling = [Unmeetable::Drop, Unmeetable::AchieveLeast];
        let mut solution = self.optimal(solve_with(&cmdp, &handling)?)?;
        let relaxed = std::mem::take(&mut solution.relaxed);
        for relaxation in &relaxed {
            let bound = match relaxation.how {
                // No optimal policy goes over more edges than there are vertices, nor fails more often than at each.
                #[expect(clippy::cast_precision_loss, reason = "vertices of a building are few")]
                Unmeetable::Drop => cmdp.states() as f64,
                Unmeetable::AchieveLeast | Unmeetable::Refuse => relaxation.least,
            };
            cmdp = cmdp.with_bound(relaxation.index, bound);
        }
        if !relaxed.is_empty() {
            solution = self.optimal(solve(&cmdp)?)?;
        }
        Ok(Solved { cmdp, maneuvers, solution, relaxed })
    }

    fn optimal(&self, outcome: Outcome) -> Result<Solution, PlanError> {
        match outcome {
            Outcome::Optimal(solution) => Ok(solution),
            Outcome::Infeasible(_) => Err(self.unreachable()),
        }
    }

    fn unreachable(&self) -> PlanError {
        PlanError::Unreachable {
            from: self.labels[self.task.from].clone(),
            to: self.labels[self.task.to].clone(),
        }
    }
}

const fn motion_name(motion: Motion) -> &'static str {
    match motion {
        Motion::Corridor => "through the corridor",
        Motion::DoorLeft => "through the door on the left",
        Motion::DoorRight => "through the door on the right",
    }
}

const fn speed_name(speed: Speed) -> &'static str {
    match speed {
        Speed::Slow => "slow",
        Speed::Fast => "fast",
    }
}
