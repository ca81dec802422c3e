//! `BuildCMDP(M, v, t_d, P_f)` of the deadline study (Algorithm 2, line 2): the model of navigating from the
//! current vertex of a toposemantic map to a target vertex.
//!
//! What the study fixes: states are vertices, actions are maneuvers, each with one expected time and one
//! failure probability; the primary cost is 1 outside the target; failure and time are bounded by `P_f` and
//! `t_d`. What it leaves open, and how it is settled here:
//!
//! - Maneuvers are relative to the heading and X = V has none. An action is therefore an outgoing edge at a
//!   speed. Its maneuver follows from the edge: through a door if either end is a room or if no robot can go
//!   straight on into it, on the side of the edge's label S(e), else through a corridor.
//! - The failure bound is on a *sum* of probabilities ([`Reading::Additive`]) or on the probability itself
//!   ([`Reading::Reach`]).
//! - Ties go by failure, then by time; a failure bound that cannot be met is dropped; a deadline that cannot
//!   be met becomes the least time that can ([`Navigation::plan`]).

use crate::cmdp::{Cmdp, CmdpBuilder, Outcome, SolveError, Unmeetable, solve_with};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The kind of a vertex, as its semantic label gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A room.
    Room,
    /// A corridor, intersection or dead end of one.
    Corridor,
}

/// S(e): the side of the vertex on which an edge arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

/// What an edge leads through, in its direction.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Through {
    /// Along a corridor.
    Corridor,
    /// From a corridor into another one, which no robot can do straight on.
    SideCorridor,
    /// Through a door into a room.
    Entering,
    /// Through a door out of a room.
    Leaving,
}

impl Through {
    /// All, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Corridor, Self::SideCorridor, Self::Entering, Self::Leaving];
    /// All that a door's maneuver is done for.
    pub const OF_DOORS: [Self; 3] = [Self::Entering, Self::Leaving, Self::SideCorridor];

    /// Returns what counts of a motion are split by.
    pub const fn of(motion: Motion) -> &'static [Self] {
        match motion {
            Motion::Corridor => &[],
            Motion::DoorLeft | Motion::DoorRight => &Self::OF_DOORS,
        }
    }

    /// Returns the name in files: `side-corridor`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::SideCorridor => "side-corridor",
            Self::Entering => "entering",
            Self::Leaving => "leaving",
        }
    }
}

/// The maneuver by which a robot turns from one corridor into another. Section 6 has six maneuvers: the one of corridors
/// keeps the orientation, and only those of doors turn.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum SideCorridors {
    /// That of a door to its side: nothing else turns.
    Door,
    /// That of a corridor, after a turn in place.
    Corridor,
}

/// One explored, oriented edge (unexplored ones lead nowhere yet and are left out).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OrientedEdge {
    /// Index of the vertex that it leaves.
    pub from: usize,
    /// Index of the vertex that it enters.
    pub to: usize,
    /// S(e).
    pub side: Side,
    /// What it leads through.
    pub through: Through,
}

/// The part of a toposemantic map that a plan needs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Topology {
    /// V, by index.
    pub vertices: Vec<Place>,
    /// E, by index.
    pub edges: Vec<OrientedEdge>,
}

/// The study's three elementary motions.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Go through a corridor.
    Corridor,
    /// Go through the door on the left.
    DoorLeft,
    /// Go through the door on the right.
    DoorRight,
}

impl Motion {
    /// Returns the name in files: `door-left`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::DoorLeft => "door-left",
            Self::DoorRight => "door-right",
        }
    }
}

/// How a motion is executed.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Speed {
    /// Slowly.
    Slow,
    /// Fast.
    Fast,
}

impl Speed {
    /// Returns the name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slow => "slow",
            Self::Fast => "fast",
        }
    }
}

/// The expected time and failure of a motion at a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expectation {
    /// Expected duration (s), at least 0.
    pub time_s: f64,
    /// Probability of failing, in [0, 1].
    pub failure: f64,
}

/// Returns the motion by which an edge on that side of its vertex, through that, is passed.
pub const fn motion_of(through: Through, side: Side, side_corridors: SideCorridors) -> Motion {
    match (through, side_corridors, side) {
        (Through::Corridor, ..) | (Through::SideCorridor, SideCorridors::Corridor, _) => {
            Motion::Corridor
        }
        (_, _, Side::Left) => Motion::DoorLeft,
        (_, _, Side::Right) => Motion::DoorRight,
    }
}

/// The (time, failure) pairs of a door's maneuver, by what it is done for: slow, fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoorPairs {
    /// To enter a room.
    pub entering: [Expectation; 2],
    /// To leave one.
    pub leaving: [Expectation; 2],
    /// To turn into another corridor.
    pub side_corridor: [Expectation; 2],
}

impl DoorPairs {
    /// Creates the pairs of a maneuver that takes the same whatever it is done for.
    pub const fn alike(both: [Expectation; 2]) -> Self {
        Self { entering: both, leaving: both, side_corridor: both }
    }

    fn each(&self) -> [&[Expectation; 2]; 3] {
        [&self.entering, &self.leaving, &self.side_corridor]
    }
}

/// The set of actions: by which maneuver each edge is passed, and what is expected of it. Six maneuvers, and those of doors
/// apart by what they are done for: entering a room carries nearly all of their hazard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maneuvers {
    /// Through a corridor: slow, fast.
    pub corridor: [Expectation; 2],
    /// Through a door on the left.
    pub door_left: DoorPairs,
    /// Through a door on the right.
    pub door_right: DoorPairs,
    /// The maneuver that turns into another corridor.
    pub side_corridors: SideCorridors,
}

impl Maneuvers {
    /// Returns the motion by which an edge on that side, through that, is passed.
    pub const fn motion(&self, through: Through, side: Side) -> Motion {
        motion_of(through, side, self.side_corridors)
    }

    /// Returns the expected time and failure of `motion` at `speed`, through that.
    pub fn expect(&self, motion: Motion, through: Through, speed: Speed) -> Expectation {
        let of_door = |door: &DoorPairs| match through {
            Through::Entering => door.entering,
            Through::Leaving => door.leaving,
            Through::SideCorridor | Through::Corridor => door.side_corridor,
        };
        let both = match motion {
            Motion::Corridor => self.corridor,
            Motion::DoorLeft => of_door(&self.door_left),
            Motion::DoorRight => of_door(&self.door_right),
        };
        match speed {
            Speed::Slow => both[0],
            Speed::Fast => both[1],
        }
    }

    /// Returns all pairs, with the names of what they are of.
    pub fn pairs(&self) -> impl Iterator<Item = (&'static str, &[Expectation; 2])> {
        let doors = [("door left", &self.door_left), ("door right", &self.door_right)];
        let of_doors =
            doors.into_iter().flat_map(|(name, door)| door.each().map(|both| (name, both)));
        std::iter::once(("corridor", &self.corridor)).chain(of_doors)
    }
}

/// The meaning of the study's costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reading {
    /// Literally (reading L): every step costs 1 until the target; failure probabilities are a cost that
    /// adds up, by the union bound no less than the probability of failing.
    #[default]
    Additive,
    /// As in the papers it builds on (reading R; Chow, Pavone, Sadler and Carpin 2015): failing is an absorbing state,
    /// and the probability of ending there is minimised. Time counts until then.
    Reach,
}

/// A navigation task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// `v_c`, the vertex at which the robot is.
    pub from: usize,
    /// v, the vertex to which it should go.
    pub to: usize,
    /// `t_d`, the local temporal deadline (s).
    pub deadline_s: f64,
    /// `P_f`, the bound on failure.
    pub failure: f64,
    /// The meaning of the costs.
    pub reading: Reading,
}

/// An action of the model: follow an edge by a motion at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Maneuver {
    /// Index of the edge in the topology.
    pub edge: usize,
    /// The motion that the edge requires.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
}

/// A navigation task as a constrained MDP. States are the vertices in order (then, by [`Reading::Reach`], the
/// failure state); secondary costs are `failure`, then `time-s`.
#[derive(Debug, Clone, PartialEq)]
pub struct Navigation {
    /// The model.
    pub cmdp: Cmdp,
    /// Its actions, by index.
    pub maneuvers: Vec<Maneuver>,
}

/// Index of the secondary cost `failure` in a [`Navigation`].
pub const FAILURE: usize = 0;
/// Index of the secondary cost `time-s` in a [`Navigation`].
pub const TIME: usize = 1;

/// Why no model can be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BuildError {
    /// An edge or the task names a vertex that is not in the map.
    #[error("{what}: vertex {index} does not exist; expected an index below {count}")]
    Vertex {
        /// The source that names it.
        what: String,
        /// The index.
        index: usize,
        /// How many vertices there are.
        count: usize,
    },
    /// A time, probability or bound out of its range.
    #[error("{what} is {value}; expected {expected}")]
    Number {
        /// Which.
        what: String,
        /// As given.
        value: f64,
        /// The range.
        expected: &'static str,
    },
}

/// Builds the model of `task` on `topology`: actions are the edges at both speeds; the target absorbs, and by
/// [`Reading::Reach`] failure too; then transitions, bounds and costs.
///
/// # Errors
/// A vertex that does not exist, or a number out of range.
pub fn build_cmdp(
    topology: &Topology,
    task: &Task,
    expectations: &Maneuvers,
) -> Result<Navigation, BuildError> {
    check(topology, task, expectations)?;
    let vertices = topology.vertices.len();
    let failed = vertices;
    let reach = task.reading == Reading::Reach;
    let maneuvers: Vec<Maneuver> = topology
        .edges
        .iter()
        .enumerate()
        .flat_map(|(index, edge)| {
            let motion = expectations.motion(edge.through, edge.side);
            [Speed::Slow, Speed::Fast].map(|speed| Maneuver { edge: index, motion, speed })
        })
        .collect();
    let mut builder = CmdpBuilder::new(vertices + usize::from(reach), maneuvers.len());
    let valid = "every entry was checked above";
    builder.absorb(task.to).expect(valid);
    if reach {
        builder.absorb(failed).expect(valid);
    }
    builder.initial(task.from, 1.0).expect(valid);
    for (action, maneuver) in maneuvers.iter().enumerate() {
        let edge = topology.edges[maneuver.edge];
        let failure = expectations.expect(maneuver.motion, edge.through, maneuver.speed).failure;
        if reach {
            builder.transition(edge.from, action, failed, failure).expect(valid);
            builder.transition(edge.from, action, edge.to, 1.0 - failure).expect(valid);
        } else {
            builder.transition(edge.from, action, edge.to, 1.0).expect(valid);
        }
    }
    let failure = builder.secondary("failure", task.failure).expect(valid);
    let time = builder.secondary("time-s", task.deadline_s).expect(valid);
    for (action, maneuver) in maneuvers.iter().enumerate() {
        let OrientedEdge { from: state, through, .. } = topology.edges[maneuver.edge];
        let expected = expectations.expect(maneuver.motion, through, maneuver.speed);
        let primary = if reach { expected.failure } else { 1.0 };
        builder.primary(state, action, primary).expect(valid);
        builder.secondary_cost(failure, state, action, expected.failure).expect(valid);
        builder.secondary_cost(time, state, action, expected.time_s).expect(valid);
    }
    let cmdp = builder.build().expect("probabilities are p and 1 - p");
    Ok(Navigation { cmdp, maneuvers })
}

impl Navigation {
    /// Does `Solve(CMDP)` of Algorithm 2, always with a policy if the target can be reached at all. A failure bound
    /// that cannot be met is dropped; then a deadline that cannot be met becomes the least expected time, as "as the
    /// deadline nears the robot should speed up" requires. Both are flagged in
    /// [`Solution::relaxed`](crate::cmdp::Solution::relaxed).
    ///
    /// # Errors
    /// A model too large or too badly scaled.
    pub fn plan(&self) -> Result<Outcome, SolveError> {
        solve_with(&self.cmdp, &[Unmeetable::Drop, Unmeetable::AchieveLeast])
    }
}

fn check(topology: &Topology, task: &Task, expectations: &Maneuvers) -> Result<(), BuildError> {
    let count = topology.vertices.len();
    let vertex = |what: String, index: usize| {
        if index < count { Ok(()) } else { Err(BuildError::Vertex { what, index, count }) }
    };
    for (i, edge) in topology.edges.iter().enumerate() {
        vertex(format!("start of edge {i}"), edge.from)?;
        vertex(format!("end of edge {i}"), edge.to)?;
    }
    vertex("start of the task".to_owned(), task.from)?;
    vertex("target of the task".to_owned(), task.to)?;
    let amount = |what: String, value: f64| {
        if value.is_finite() && value >= 0.0 {
            Ok(())
        } else {
            Err(BuildError::Number { what, value, expected: "a finite number >= 0" })
        }
    };
    amount("the deadline (s)".to_owned(), task.deadline_s)?;
    amount("the failure bound".to_owned(), task.failure)?;
    for (name, both) in expectations.pairs() {
        for (speed, expected) in ["slow", "fast"].iter().zip(both) {
            amount(format!("the time (s) of {name}, {speed}"), expected.time_s)?;
            if !(0.0..=1.0).contains(&expected.failure) {
                return Err(BuildError::Number {
                    what: format!("the failure probability of {name}, {speed}"),
                    value: expected.failure,
                    expected: "a probability in [0, 1]",
                });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod corridor_tests;
#[cfg(test)]
mod tests;
