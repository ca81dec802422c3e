//! The true graph of a building as the planner would know it, and the planner's policies on it.
//!
//! A mind knows the part of the graph that it has explored. Here it is given all of it at once, grown by the study's
//! own Algorithm 1, and plans one leg from the start to the goal as it plans any leg:
//! 1. Grow the map from the start.
//! 2. Choose the deadlines of the legs: those given, or one for each step of the schedule.
//! 3. Plan each leg; legs with equal policies share a panel.
//! 4. Draw vertices and edges from the true positions.

use super::Prepared;
use crate::figure::{Medium, PolicyChart, PolicyMove, PolicyPanel, PolicyVertex};
use crate::studies::deadline::build_cmdp::Place;
use crate::studies::deadline::intersection::{Exit, Intersection, Opening};
use crate::studies::deadline::planner::{Plan, PlanError, Status};
use crate::studies::deadline::toposemantic_map::{End, MapError, ToposemanticMap, VertexId};
use crate::studies::deadline::{PolicyGraph, Setup};
use crate::studies::drawn::{NO_CONDITION, words_alone};
use crate::studies::{CannotBegin, Drawn, Findings};
use crate::table::Table;
use crate::world::RegionKind;
use crate::world::topology::{self, Topology};
use std::collections::VecDeque;

/// Largest distance (m) of a start from its place of the graph.
const NEAR: f64 = 3.0;

/// The reason why there is nothing to draw.
#[derive(Debug, thiserror::Error)]
pub(super) enum NoChart {
    /// The design leaves the condition out.
    #[error("{NO_CONDITION}")]
    NoCondition,
    /// No trial of the condition can begin.
    #[error(transparent)]
    CannotBegin(#[from] CannotBegin),
    /// Isolated passages are not planned.
    #[error("the planner has no calibration")]
    NoCalibration,
    /// The robot starts away from every vertex.
    #[error("the start is at no place of the graph")]
    NoStart,
    /// No way leads to it.
    #[error("the goal cannot be reached")]
    NoGoal,
    /// The tags contradict themselves.
    #[error(transparent)]
    Map(#[from] MapError),
    /// There is no policy.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

impl PolicyGraph {
    /// Draws the policies of the first condition that it speaks of; words where there are none.
    pub(in crate::studies) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        medium: Medium,
    ) -> Drawn {
        let found = findings.first(&self.only).and_then(|(_, setup)| setup.of::<Setup>());
        let chart = found
            .ok_or(NoChart::NoCondition)
            .and_then(|setup| policy_chart(title, setup, &self.within_s))
            .map_err(|why| why.to_string());
        let (svg, words, data) = match chart {
            Ok(chart) => (chart.to_svg_on(medium), chart.in_words(), chart.data()),
            Err(why) => (words_alone(title, &why), why, Table::default()),
        };
        Drawn::new(
            ("Graph", title),
            svg,
            words,
            "The building's whole toposemantic graph, which no robot of the study knows at first, and the policy that the \
             study's planner makes on it for one leg from the start to the goal within t_d.",
            data,
        )
    }
}

/// Plans the policies for legs from the start of `setup` to the goal within each of `within_s` (s), or where it is
/// empty within the deadlines that the schedule sets at its three steps.
///
/// # Errors
/// Where the setup has no calibration, no such places or no such plans.
pub(super) fn policy_chart(
    title: &str,
    setup: &Setup,
    within_s: &[f64],
) -> Result<PolicyChart, NoChart> {
    // 1. The map.
    let prepared: &Prepared = setup.prepared()?;
    let calibration = setup.calibration.as_ref().ok_or(NoChart::NoCalibration)?;
    let truth = &prepared.topology;
    let start = truth.vertex_near(setup.start.position(), NEAR).ok_or(NoChart::NoStart)?;
    let (map, place_of) = known(truth, start)?;
    let goal = map.ids().find(|v| map.is_goal(*v)).ok_or(NoChart::NoGoal)?;
    let from = VertexId::first();
    let edges = map.distances(from)[goal.index()].ok_or(NoChart::NoGoal)?;
    // 2. The deadlines.
    let rules = &setup.parameters.rules;
    let mut legs: Vec<(f64, Vec<&str>)> = Vec::new();
    if within_s.is_empty() {
        // One instant within each step of the schedule, of a task of unit length.
        let s = &rules.schedule;
        let middle = 1.0 - f64::midpoint(s.ample_above, s.scarce_below);
        for (now, name) in [(0.0, "ample"), (middle, "getting short"), (1.0, "scarce")] {
            let seconds = s.local_deadline(edges, now, 1.0).seconds;
            match legs.last_mut() {
                Some(last) if last.0 == seconds => last.1.push(name),
                _ => legs.push((seconds, vec![name])),
            }
        }
    } else {
        legs.extend(within_s.iter().map(|seconds| (*seconds, Vec::new())));
    }
    // 3. The plans.
    let mut panels: Vec<PolicyPanel> = Vec::new();
    for (seconds, steps) in legs {
        let maneuvers = calibration.maneuvers(rules.side_corridors);
        let plan = Plan::new(&map, from, goal, seconds, &rules.planner, &maneuvers)?;
        let when = match steps.as_slice() {
            [] => String::new(),
            steps => format!(" (time {})", steps.join(" or ")),
        };
        let name = format!("t_d = {} s{when}", short(seconds));
        let how = match plan.status() {
            Status::Slack => "slack: what would be done without a deadline meets it",
            Status::Active => "binding: something is done faster because of it",
            Status::Relaxed => "cannot be met: the least expected time is taken",
        };
        let moves = moves(&map, &plan, from);
        match panels.last_mut().filter(|last| last.moves == moves && last.how == how) {
            // Both legs have one policy.
            Some(last) => last.name = format!("{}, and {name}", last.name),
            None => panels.push(PolicyPanel {
                name,
                how: how.to_owned(),
                told: format!("expected: {:.1} s, {:.3} failures", plan.time_s(), plan.failure()),
                moves,
            }),
        }
    }
    // 4. The graph.
    let vertex = |v: VertexId| {
        let place = &truth.vertices[place_of[v.index()]];
        PolicyVertex {
            at: place.at,
            label: map.label(v).to_string(),
            room: place.kind == RegionKind::Room,
        }
    };
    let mut ways: Vec<(usize, usize)> = Vec::new();
    for edge in map.edges() {
        if let End::Vertex(to) = edge.to
            && edge.from < to
        {
            ways.push((edge.from.index(), to.index()));
        }
    }
    Ok(PolicyChart {
        title: title.to_owned(),
        walls: prepared.visible.clone(),
        vertices: map.ids().map(vertex).collect(),
        edges: ways,
        start: from.index(),
        goal: goal.index(),
        panels,
    })
}

/// Grows the map of all that can be reached from place `start`, breadth first, and returns which place each vertex is.
fn known(truth: &Topology, start: usize) -> Result<(ToposemanticMap, Vec<usize>), MapError> {
    let mut map = ToposemanticMap::new();
    let first = map.begin(&seen(truth, start))?;
    let mut place_of = vec![start];
    let mut queue = VecDeque::from([(first, start)]);
    while let Some((v, place)) = queue.pop_front() {
        for exit in &truth.vertices[place].exits {
            let here = seen(truth, exit.to);
            let (to, _) = map.arrive(v, exit.direction, &here)?;
            if to.index() == place_of.len() {
                place_of.push(exit.to);
                queue.push_back((to, exit.to));
            }
        }
    }
    Ok((map, place_of))
}

/// Returns place `v` as a perfect Intersection Detection System would report it.
fn seen(truth: &Topology, v: usize) -> Intersection {
    let vertex = &truth.vertices[v];
    let exits = vertex.exits.iter().map(|exit| Exit {
        direction: exit.direction,
        opening: match exit.opening {
            topology::Opening::Corridor => Opening::Corridor,
            topology::Opening::Door => Opening::Door,
        },
    });
    Intersection {
        tags: std::iter::once(vertex.tag.clone()).collect(),
        place: match vertex.kind {
            RegionKind::Room => Place::Room,
            RegionKind::Corridor => Place::Corridor,
        },
        is_goal: vertex.is_goal,
        exits: exits.collect(),
    }
}

/// Returns the moves of `plan` wherever it arrives from `from`, with how often each is expected: mass is pushed along
/// the policy, which is complete after as many steps as a policy without detours has, and nearly complete after many
/// more with them.
fn moves(map: &ToposemanticMap, plan: &Plan, from: VertexId) -> Vec<PolicyMove> {
    let mut moves: Vec<PolicyMove> = Vec::new();
    let mut mass = vec![0.0; map.len()];
    mass[from.index()] = 1.0;
    for _ in 0..20 * map.len() {
        let mut next = vec![0.0; map.len()];
        for v in map.ids().filter(|v| mass[v.index()] > 0.0) {
            for (action, probability) in plan.choices(v) {
                let Some(End::Vertex(to)) = map.edge(v, action.exit).map(|edge| edge.to) else {
                    continue;
                };
                let fast = action.speed == crate::studies::deadline::build_cmdp::Speed::Fast;
                let share = mass[v.index()] * probability;
                next[to.index()] += share;
                let same =
                    |m: &&mut PolicyMove| (m.from, m.to, m.fast) == (v.index(), to.index(), fast);
                match moves.iter_mut().find(same) {
                    Some(known) => known.passes += share,
                    None => moves.push(PolicyMove {
                        from: v.index(),
                        to: to.index(),
                        fast,
                        probability,
                        passes: share,
                    }),
                }
            }
        }
        mass = next;
    }
    moves
}

/// Writes a number of seconds without superfluous digits.
fn short(seconds: f64) -> String {
    format!("{}", (seconds * 10.0).round() / 10.0)
}
