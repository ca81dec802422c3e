//! Requirements of a condition of this study on its robot and world that these may not meet.

use super::Setup;
use crate::studies::Remark;
use crate::studies::deadline::Calibrations;
use crate::world::World;
use crate::world::topology::{TagFault, Topology};

/// Returns the fault of a calibration that drove no passage in `world`.
pub(in crate::studies::deadline) fn not_measured_in(
    world: &World,
    measured: &Calibrations,
) -> Remark {
    let worlds: Vec<String> = measured.worlds().map(|name| format!("`{name}`")).collect();
    Remark {
        pointer: "/calibration",
        message: format!("the calibration drives no passage in the building `{}`", world.name),
        label: format!("it measures maneuvers in {}", worlds.join(", ")),
        help: Some(
            "what a maneuver takes depends on the building's doors: name a calibration of this building, or give the \
             calibration the same factor of buildings"
                .to_owned(),
        ),
    }
}

/// Returns the faults found; `graph` is what the world's tags make by the setup's scheme, or the faults of these.
pub(in crate::studies::deadline) fn remarks(
    setup: &Setup,
    graph: Result<&Topology, &[TagFault]>,
) -> Vec<Remark> {
    let robot = &setup.robot;
    let mut remarks = Vec::new();
    for (there, what) in
        [(robot.camera.is_some(), "logical camera"), (robot.compass.is_some(), "compass")]
    {
        if !there {
            remarks.push(Remark {
                pointer: "/robot",
                message: format!("the robot `{}` has no {what}", robot.name),
                label: "this study explores with one".to_owned(),
                help: Some(
                    "add a `<gazebo>` sensor to the description, or name another robot".to_owned(),
                ),
            });
        }
    }
    match graph {
        Err(problems) => remarks.extend(problems.iter().map(|problem| Remark {
            pointer: "/world",
            message: problem.to_string(),
            label: "the tags make no graph".to_owned(),
            help: Some("docs/world.md tells how tags make a graph".to_owned()),
        })),
        Ok(graph) if graph.goals().next().is_none() => remarks.push(Remark {
            pointer: "/world",
            message: "the world has no goal to reach".to_owned(),
            label: "no vertex carries a tag of the goal's colour".to_owned(),
            help: Some(
                "`perception.goal-color` names it; docs/world.md tells where it stands".to_owned(),
            ),
        }),
        Ok(_) => {}
    }
    remarks
}
