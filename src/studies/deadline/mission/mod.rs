//! One trial: the simulator at one end, the mind at the other, and the measures in between.

mod body;
mod calibrations;
mod exploration;
mod graph;
pub(in crate::studies::deadline) mod graph_level;
pub(super) mod lints;
mod passage;
mod passages;
mod policy_chart;
pub(in crate::studies::deadline) mod proposal;
mod tally;
#[cfg(test)]
mod tests;

pub use calibrations::Calibrations;
pub(super) use passages::Isolated;

use super::{Setup, Simulation, Task};
use crate::geometry::Outline;
use crate::robot::Lidar;
use crate::studies::recording::Recording;
use crate::studies::state_chain::StateChain;
use crate::studies::{CannotBegin, Measures, Outcome, Stopwatch, TrialRecord, TrialSpec};
use crate::units::{Seconds, Tick};
use crate::world::topology::{TagScheme, Topology};

/// The data that all trials of a setup share: computed once, from the setup alone.
#[derive(Debug)]
pub struct Prepared {
    visible: Vec<Outline>,
    solid: Vec<Outline>,
    lidar: Lidar,
    /// The true graph, from which passages are drawn; no mind sees it.
    topology: Topology,
}

impl Prepared {
    /// Cuts the world at the lidar's height and reads its graph from the tags.
    ///
    /// # Errors
    /// A robot without scanner, camera or compass, or tags that make no graph: resolution refuses them with better
    /// messages.
    pub fn new(setup: &Setup) -> Result<Self, CannotBegin> {
        let robot = &setup.robot;
        let own = robot.lidar.as_ref().ok_or(CannotBegin::NoScanner)?;
        robot.camera.as_ref().ok_or(CannotBegin::NoCamera)?;
        robot.compass.as_ref().ok_or(CannotBegin::NoCompass)?;
        let sensing = &setup.parameters.sensing;
        let noise_sd = sensing.range_noise_sd_m.unwrap_or(own.noise_sd);
        let lidar = Lidar { noise_sd, ..own.clone() };
        let topology =
            Topology::read(&setup.world.tags, &tag_scheme(setup)).map_err(CannotBegin::NoGraph)?;
        Ok(Self {
            visible: setup.world.slice(lidar.height),
            solid: setup.world.contact(robot.body_z[0], robot.body_z[1]),
            lidar,
            topology,
        })
    }
}

/// Returns the convention of the tags, as the mind's perception uses it.
pub fn tag_scheme(setup: &Setup) -> TagScheme {
    let perception = &setup.parameters.perception;
    TagScheme {
        corridor: perception.corridor_color.clone(),
        room: perception.room_color.clone(),
        corridor_exit: perception.corridor_exit_color.clone(),
        door_exit: perception.door_exit_color.clone(),
        goal: perception.goal_color.clone(),
        grouping: perception.grouping_m,
        ..TagScheme::default()
    }
}

/// Runs the trial, timed by `watch`, writing everything to `recording` where there is one. The record is the same
/// either way.
pub fn run(
    spec: &TrialSpec,
    setup: &Setup,
    recording: Option<&mut Recording>,
    watch: &mut dyn Stopwatch,
) -> TrialRecord {
    let prepared = match setup.prepared() {
        Ok(prepared) => prepared,
        Err(why) => return TrialRecord::panicked(spec, why.to_string()),
    };
    let mission = &setup.parameters.mission;
    match mission.task {
        Task::Exploration if mission.simulation == Simulation::Graph => {
            graph_level::run(spec, setup, prepared, watch)
        }
        Task::Exploration => exploration::run(spec, setup, prepared, recording, watch),
        Task::Passage => passage::run(spec, setup, prepared, recording),
    }
}

/// The end of a trial.
#[derive(Debug)]
struct Ending {
    outcome: Outcome,
    /// Its cause in words, where the outcome alone is not enough.
    cause: String,
    at: Tick,
}

impl Ending {
    fn plain(outcome: Outcome, at: Tick) -> Self {
        Self { outcome, cause: String::new(), at }
    }
}

/// Returns the record of a trial whose clock `began` at that tick.
fn record(
    spec: &TrialSpec,
    ending: Ending,
    began: Tick,
    mut measures: Measures,
    chain: &StateChain,
) -> TrialRecord {
    let Seconds(seconds) = ending.at.seconds();
    // As in Table 1, a time belongs to trials that arrived.
    let time = Tick(ending.at.0 - began.0).seconds().get();
    let time = (ending.outcome == Outcome::REACHED).then_some(time);
    measures.insert("time-s".to_owned(), time);
    TrialRecord {
        key: spec.key,
        condition: spec.condition.clone(),
        trial: spec.trial,
        outcome: ending.outcome,
        cause: ending.cause,
        measures,
        series: Vec::new(),
        sim_seconds: seconds,
        chain: chain.to_hex(),
    }
}
