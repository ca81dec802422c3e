//! Plans that need no linear programme: the only way there is, and the ablations' shortest path.

use super::{Method, Status};
use crate::cmdp::build::{Expectation, Maneuvers, Reading, Speed, Task, Topology, motion};
use std::cmp::Ordering;
use std::collections::VecDeque;

/// One way to the target.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    /// In order.
    pub(super) steps: Vec<Step>,
    /// How it stands to the deadline.
    pub(super) status: Status,
    /// Expected duration (s).
    pub(super) time_s: f64,
    /// Sum of failure probabilities.
    pub(super) failure: f64,
}

/// Follow an edge at a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Where.
    pub(super) vertex: usize,
    /// Which edge, by index in the topology.
    pub(super) edge: usize,
    /// How fast.
    pub(super) speed: Speed,
}

/// Margin by which numbers must differ for a decision not to be the solver's: far above its tolerances.
const CLEAR: f64 = 1e-6;

/// The optimal policy where it follows without solving anything, the same as the linear programme's; `None` where it does
/// not. Tests hold the two against each other.
///
/// If the target can be reached without ever coming back to a vertex in one way only, every other policy walks a detour and
/// back, which costs steps, and time, and is never better in any criterion. What remains are the speeds:
///
/// - If the better speed of each edge, by failure and then time, meets both bounds, every edge takes it.
/// - If the shorter time of each edge does not meet the deadline, every edge takes it: the least time.
///
/// Both are unique if no edge is indifferent. In between some edges are sped up, and which of several that gain alike is the
/// solver's choice.
pub(super) fn only_way(topology: &Topology, task: &Task, expectations: &Maneuvers) -> Option<Way> {
    if task.reading != Reading::Additive || task.from == task.to {
        return None;
    }
    let edges = breadth_first(topology, task.from, task.to, None)?;
    let other = |edge: &usize| breadth_first(topology, task.from, task.to, Some(*edge)).is_some();
    if edges.iter().any(other) {
        return None;
    }
    let both = |edge: usize| {
        let motion = motion(topology, &topology.edges[edge]);
        [Speed::Slow, Speed::Fast].map(|speed| expectations.expect(motion, speed))
    };
    // Detours must cost.
    if !edges.iter().all(|edge| both(*edge).iter().all(|e| e.time_s > CLEAR && e.failure >= 0.0)) {
        return None;
    }
    let sober: Option<Vec<Speed>> = edges.iter().map(|edge| sober(both(*edge))).collect();
    let sober = way(topology, expectations, &edges, &sober?, Status::Slack);
    let within_failure = |way: &Way| way.failure < task.failure * (1.0 - CLEAR);
    if within_failure(&sober) && sober.time_s < task.deadline_s * (1.0 - CLEAR) {
        return Some(sober);
    }
    let quick: Option<Vec<Speed>> = edges.iter().map(|edge| quick(both(*edge))).collect();
    let quick = way(topology, expectations, &edges, &quick?, Status::Relaxed);
    (within_failure(&quick) && quick.time_s > task.deadline_s * (1.0 + CLEAR)).then_some(quick)
}

/// The speed that fails less, or if both fail alike takes less time; `None` if that is not clear.
fn sober([slow, fast]: [Expectation; 2]) -> Option<Speed> {
    if slow.failure == fast.failure {
        return quick([slow, fast]);
    }
    clearly_less(slow.failure, fast.failure)
}

/// The speed that takes less time; `None` if that is not clear.
fn quick([slow, fast]: [Expectation; 2]) -> Option<Speed> {
    clearly_less(slow.time_s, fast.time_s)
}

fn clearly_less(slow: f64, fast: f64) -> Option<Speed> {
    if slow < fast - CLEAR {
        Some(Speed::Slow)
    } else if fast < slow - CLEAR {
        Some(Speed::Fast)
    } else {
        None
    }
}

fn way(
    topology: &Topology,
    expectations: &Maneuvers,
    edges: &[usize],
    speeds: &[Speed],
    status: Status,
) -> Way {
    let mut way = Way { steps: Vec::new(), status, time_s: 0.0, failure: 0.0 };
    for (edge, speed) in edges.iter().zip(speeds) {
        let expected = expectations.expect(motion(topology, &topology.edges[*edge]), *speed);
        way.time_s += expected.time_s;
        way.failure += expected.failure;
        let vertex = topology.edges[*edge].from;
        way.steps.push(Step { vertex, edge: *edge, speed: *speed });
    }
    way
}

/// The edges of a path with the fewest edges, which uses `without` in neither direction; `None` where there is none.
fn breadth_first(
    topology: &Topology,
    from: usize,
    to: usize,
    without: Option<usize>,
) -> Option<Vec<usize>> {
    let closed = without.map(|edge| (topology.edges[edge].from, topology.edges[edge].to));
    let mut came_by: Vec<Option<usize>> = vec![None; topology.vertices.len()];
    let mut queue = VecDeque::from([from]);
    while let Some(v) = queue.pop_front() {
        if v == to {
            let mut path = Vec::new();
            let mut at = to;
            while at != from {
                let edge = came_by[at]?;
                path.push(edge);
                at = topology.edges[edge].from;
            }
            path.reverse();
            return Some(path);
        }
        // Edges are in the order of the vertices that they leave.
        let first = topology.edges.partition_point(|edge| edge.from < v);
        for (index, edge) in topology.edges.iter().enumerate().skip(first) {
            if edge.from != v {
                break;
            }
            let is_closed = closed.is_some_and(|(a, b)| {
                (edge.from, edge.to) == (a, b) || (edge.from, edge.to) == (b, a)
            });
            if !is_closed && edge.to != from && came_by[edge.to].is_none() {
                came_by[edge.to] = Some(index);
                queue.push_back(edge.to);
            }
        }
    }
    None
}

/// The plan of an ablation: a path with the fewest edges, of several the one that fails less at the ablation's speed, then
/// the one that takes less time, then the one over vertices that were discovered earlier. `None` where there is no path.
///
/// The status says how the same deadline stands to this path, whatever the ablation makes of it: slack if all slow meets it,
/// relaxed if not even all fast does.
pub(super) fn shortest(
    topology: &Topology,
    task: &Task,
    expectations: &Maneuvers,
    method: Method,
) -> Option<Way> {
    let at = |speed: Speed| {
        let edges = best_shortest(topology, task, expectations, speed)?;
        let speeds = vec![speed; edges.len()];
        Some(way(topology, expectations, &edges, &speeds, Status::Slack))
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

/// What going on from a vertex costs: edges, failure, time (s); and the edge to take first.
#[derive(Debug, Clone, Copy)]
struct Going {
    edges: usize,
    failure: f64,
    time_s: f64,
    edge: Option<usize>,
}

impl Going {
    fn order(&self, other: &Self) -> Ordering {
        (self.edges.cmp(&other.edges))
            .then(self.failure.total_cmp(&other.failure))
            .then(self.time_s.total_cmp(&other.time_s))
    }
}

fn best_shortest(
    topology: &Topology,
    task: &Task,
    expectations: &Maneuvers,
    speed: Speed,
) -> Option<Vec<usize>> {
    let mut going: Vec<Option<Going>> = vec![None; topology.vertices.len()];
    going[task.to] = Some(Going { edges: 0, failure: 0.0, time_s: 0.0, edge: None });
    // Bellman and Ford: a path has fewer edges than there are vertices.
    for _ in 0..topology.vertices.len() {
        for (index, edge) in topology.edges.iter().enumerate() {
            let Some(rest) = going[edge.to] else { continue };
            let expected = expectations.expect(motion(topology, edge), speed);
            let candidate = Going {
                edges: rest.edges + 1,
                failure: rest.failure + expected.failure,
                time_s: rest.time_s + expected.time_s,
                edge: Some(index),
            };
            if going[edge.from].is_none_or(|best| candidate.order(&best) == Ordering::Less) {
                going[edge.from] = Some(candidate);
            }
        }
    }
    let mut path = Vec::new();
    let mut at = task.from;
    while let Some(edge) = going[at]?.edge {
        path.push(edge);
        at = topology.edges[edge].to;
    }
    Some(path)
}
