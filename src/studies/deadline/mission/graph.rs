//! The mind's knowledge and intentions, for display.

use crate::geometry::Point;
use crate::studies::deadline::build_cmdp::{Motion, Place, Speed};
use crate::studies::deadline::exploration::{Candidate, Decision, Explorer, Purpose};
use crate::studies::deadline::planner::Plan;
use crate::studies::deadline::rules::Rules;
use crate::studies::deadline::strategy::{Preference, Strategy, Ties};
use crate::studies::deadline::toposemantic_map::{End, ToposemanticMap, VertexId};
use crate::studies::recording::{ActionView, CandidateView, GraphView, VertexView};

/// Returns the map of `mind`, its vertices drawn at `places`, and its plan.
pub(super) fn view(mind: &Explorer, places: &[Point]) -> GraphView {
    let map = mind.map();
    let vertices = map.ids().zip(places).map(|(v, at)| VertexView {
        label: map.label(v).to_string(),
        room: map.place(v) == Place::Room,
        goal: map.is_goal(v),
        at: *at,
        unexplored: map.unexplored(v).map(|edge| edge.direction.heading()).collect(),
    });
    let mut edges: Vec<(usize, usize)> = map
        .edges()
        .filter_map(|edge| match edge.to {
            End::Vertex(to) => {
                Some((edge.from.index().min(to.index()), edge.from.index().max(to.index())))
            }
            End::Unexplored => None,
        })
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let leg = leg(mind);
    GraphView {
        vertices: vertices.collect(),
        edges,
        current: mind.current().map_or(0, VertexId::index),
        target: leg.map(|decision| decision.target().index()),
        candidates: leg.map(candidates).unwrap_or_default(),
        leg_deadline_s: leg.map(|decision| decision.at_s + decision.deadline.seconds),
        policy: leg.and_then(Decision::plan).map(|plan| policy(map, plan)).unwrap_or_default(),
        doing: doing(mind),
    }
}

/// Returns the decision that the robot is following, if it is.
fn leg(mind: &Explorer) -> Option<&Decision> {
    let under_way = mind.moves().last()?;
    (under_way.purpose == Purpose::Navigate).then(|| mind.decisions().last()).flatten()
}

/// Returns the candidates among which `decision` chose.
fn candidates(decision: &Decision) -> Vec<CandidateView> {
    let view = |candidate: &Candidate| CandidateView {
        vertex: candidate.vertex.index(),
        unexplored: candidate.unexplored,
        edges_away: candidate.distance,
    };
    decision.candidates.iter().map(view).collect()
}

/// Describes how `rules` choose the next vertex, in a sentence (section 5).
pub(super) fn rule(rules: &Rules) -> String {
    let preference = |preference| match preference {
        Preference::Nearest => "the nearest",
        Preference::MostUnexplored => "the one with most unexplored edges",
        Preference::Uniform => "any",
    };
    match rules.strategy {
        Strategy::Random => "random: any vertex with unexplored edges".to_owned(),
        Strategy::Frontier => {
            let ties = match rules.frontier.ties {
                Ties::Uniform => "any",
                Ties::Nearest => "the nearest",
            };
            format!("frontier: most unexplored edges; {ties} of equals")
        }
        Strategy::NormalizedFrontier => {
            let gamma = rules.normalized_frontier.gamma;
            format!(
                "normalized frontier: highest {gamma} x unexplored edges / most - {} x edges away / furthest; the nearest of equals",
                1.0 - gamma
            )
        }
        Strategy::CorridorsFirst => {
            format!(
                "corridors first: {} of the corridors, then of the rooms",
                preference(rules.corridors_first.among)
            )
        }
        Strategy::CompleteCorridor => format!(
            "complete corridor: {} vertex of the corridor in hand, then {} to begin another with",
            preference(rules.complete_corridor.inside),
            preference(rules.complete_corridor.next)
        ),
    }
}

/// Returns π* as arrows between known vertices.
fn policy(map: &ToposemanticMap, plan: &Plan) -> Vec<ActionView> {
    let mut actions = Vec::new();
    for v in map.ids() {
        for (action, probability) in plan.choices(v) {
            if let Some(End::Vertex(to)) = map.edge(v, action.exit).map(|edge| edge.to) {
                let fast = action.speed == Speed::Fast;
                actions.push(ActionView { from: v.index(), to: to.index(), probability, fast });
            }
        }
    }
    actions
}

/// Describes the move under way, in words.
fn doing(mind: &Explorer) -> String {
    let Some(last) = mind.moves().last() else { return String::new() };
    let motion = match last.leave.motion {
        Motion::Corridor => "through the corridor",
        Motion::DoorLeft => "door on the left",
        Motion::DoorRight => "door on the right",
    };
    let speed = match last.leave.speed {
        Speed::Slow => "slow",
        Speed::Fast => "fast",
    };
    format!("{motion}, {speed}")
}

/// Describes the mind's next action and its reason, in words.
pub(super) fn told(mind: &Explorer) -> String {
    let Some(last) = mind.moves().last() else { return String::new() };
    let map = mind.map();
    let why = match (last.purpose, mind.decisions().last()) {
        (Purpose::Initial, _) => "at random, to know the first vertices".to_owned(),
        (Purpose::Navigate, Some(decision)) => format!(
            "towards {}, {} edges within {} s",
            map.label(decision.target()),
            decision.deadline.edges,
            decision.deadline.seconds
        ),
        (Purpose::Explore | Purpose::Navigate, _) => "into the unexplored".to_owned(),
    };
    format!("at {}: {}, {why}", map.label(last.from), doing(mind))
}
