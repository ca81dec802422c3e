//! Plans that need no linear programme: deadlines that do not bind or cannot be met, and the ablations.

use super::{Method, Status};
use crate::studies::deadline::build_cmdp::{
    Expectation, Maneuvers, OrientedEdge, Reading, Speed, Task, Topology,
};

/// One path to the target.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    /// Its steps, in order.
    pub(super) steps: Vec<Step>,
    /// Its relation to the deadline.
    pub(super) status: Status,
    /// Expected duration (s).
    pub(super) time_s: f64,
    /// Sum of failure probabilities.
    pub(super) failure: f64,
}

/// Follow an edge at a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// The vertex.
    pub(super) vertex: usize,
    /// The edge, by index in the topology.
    pub(super) edge: usize,
    /// The speed.
    pub(super) speed: Speed,
}

/// Margin by which totals must differ for a choice not to be left to the solver: far above its tolerances.
const CLEAR: f64 = 1e-6;
const BOTH: [Speed; 2] = [Speed::Slow, Speed::Fast];

/// Returns the optimal policy where it follows without a linear programme, the same as the programme's; `None` where it
/// does not. Tests compare the two.
///
/// Every step costs time, so that without bounds the best is a path, by dynamic programming.
///
/// - The best by steps, then failure, then time, if it is within both bounds, is also the programme's solution.
/// - The quickest, if it is within the failure bound and not within the deadline, has the least time, to which the
///   deadline is relaxed.
///
/// Both only if no other choice on the path is equally good or nearly so: then the choice is left to the solver. So is
/// everything in between, where some edges are sped up and several gain equally.
pub(super) fn unbound(topology: &Topology, task: &Task, expectations: &Maneuvers) -> Option<Way> {
    if task.reading != Reading::Additive || task.from == task.to {
        return None;
    }
    let mut expected = expectations.pairs().flat_map(|(_, both)| both);
    if expected.any(|e| e.time_s.is_nan() || e.time_s < CLEAR) {
        return None;
    }
    let within_failure = |way: &Way| way.failure < task.failure * (1.0 - CLEAR);
    let sober = Going::by(topology, task, expectations, &BOTH, |e| [1.0, e.failure, e.time_s]);
    let sober = sober.way(Status::Slack, CLEAR)?;
    if within_failure(&sober) && sober.time_s < task.deadline_s * (1.0 - CLEAR) {
        return Some(sober);
    }
    let quick = Going::by(topology, task, expectations, &BOTH, |e| [e.time_s, 1.0, e.failure]);
    let quick = quick.way(Status::Relaxed, CLEAR)?;
    (within_failure(&quick) && quick.time_s > task.deadline_s * (1.0 + CLEAR)).then_some(quick)
}

/// Returns the plan of an ablation: a path with the fewest edges, of several the one that fails less at the ablation's
/// speed, then the one that takes less time, then the one whose edges the map lists first. `None` where there is no
/// path.
///
/// The status gives the relation of the same deadline to this path, whatever the ablation makes of it: slack if all
/// slow meets it, relaxed if not even all fast does.
pub(super) fn ablation(
    topology: &Topology,
    task: &Task,
    expectations: &Maneuvers,
    method: Method,
) -> Option<Way> {
    let at = |speed: Speed| {
        Going::by(topology, task, expectations, &[speed], |e| [1.0, e.failure, e.time_s])
            .way(Status::Slack, 0.0)
    };
    let (slow, fast) = (at(Speed::Slow)?, at(Speed::Fast)?);
    let status = if slow.time_s <= task.deadline_s {
        Status::Slack
    } else if fast.time_s <= task.deadline_s {
        Status::Active
    } else {
        Status::Relaxed
    };
    let way = match method {
        Method::AllFast => fast,
        Method::Threshold if status != Status::Slack => fast,
        Method::AllSlow | Method::Threshold | Method::Cmdp => slow,
    };
    Some(Way { status, ..way })
}

/// The costs of going on to the target from each vertex, by three criteria in order, and the first choice to make.
struct Going<'a, C> {
    topology: &'a Topology,
    task: &'a Task,
    expectations: &'a Maneuvers,
    speeds: &'a [Speed],
    criteria: C,
    best: Vec<Option<([f64; 3], Option<Choice>)>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Choice {
    edge: usize,
    speed: Speed,
}

impl<'a, C: Fn(Expectation) -> [f64; 3]> Going<'a, C> {
    fn by(
        topology: &'a Topology,
        task: &'a Task,
        expectations: &'a Maneuvers,
        speeds: &'a [Speed],
        criteria: C,
    ) -> Self {
        let mut best = vec![None; topology.vertices.len()];
        best[task.to] = Some(([0.0; 3], None));
        let mut going = Self { topology, task, expectations, speeds, criteria, best };
        // Bellman and Ford: a path has fewer edges than there are vertices.
        for _ in 0..topology.vertices.len() {
            let mut changed = false;
            for edge in 0..topology.edges.len() {
                for speed in speeds {
                    let choice = Choice { edge, speed: *speed };
                    let from = topology.edges[edge].from;
                    let Some(costs) = going.costs(choice) else { continue };
                    if going.best[from].is_none_or(|(best, _)| less(&costs, &best)) {
                        going.best[from] = Some((costs, Some(choice)));
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
        }
        going
    }

    fn expected(&self, choice: Choice) -> Expectation {
        let OrientedEdge { through, side, .. } = self.topology.edges[choice.edge];
        let motion = self.expectations.motion(through, side);
        self.expectations.expect(motion, through, choice.speed)
    }

    /// Returns the costs of beginning with `choice`; `None` where that leads nowhere.
    fn costs(&self, choice: Choice) -> Option<[f64; 3]> {
        let (rest, _) = self.best[self.topology.edges[choice.edge].to]?;
        let own = (self.criteria)(self.expected(choice));
        Some(std::array::from_fn(|k| own[k] + rest[k]))
    }

    /// Returns the path from the task's start; `None` where there is none, or where on the path another choice than the
    /// best is not worse by more than `margin`.
    fn way(&self, status: Status, margin: f64) -> Option<Way> {
        let mut way = Way { steps: Vec::new(), status, time_s: 0.0, failure: 0.0 };
        let mut vertex = self.task.from;
        while let (costs, Some(choice)) = self.best[vertex]? {
            let rivals = (0..self.topology.edges.len())
                .filter(|edge| self.topology.edges[*edge].from == vertex)
                .flat_map(|edge| {
                    self.speeds.iter().map(move |speed| Choice { edge, speed: *speed })
                })
                .filter(|rival| *rival != choice);
            let mut rivals = rivals.filter_map(|rival| self.costs(rival));
            if margin > 0.0 && rivals.any(|rival| !clearly_less(&costs, &rival, margin)) {
                return None;
            }
            let expected = self.expected(choice);
            way.time_s += expected.time_s;
            way.failure += expected.failure;
            way.steps.push(Step { vertex, edge: choice.edge, speed: choice.speed });
            vertex = self.topology.edges[choice.edge].to;
        }
        Some(way)
    }
}

fn less(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a.iter().zip(b).find(|(a, b)| a != b).is_some_and(|(a, b)| a < b)
}

/// Returns whether the first criterion in which the two differ at all favours `a`, by more than `margin`.
fn clearly_less(a: &[f64; 3], b: &[f64; 3], margin: f64) -> bool {
    a.iter().zip(b).find(|(a, b)| a != b).is_some_and(|(a, b)| *a < b - margin)
}
