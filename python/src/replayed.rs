//! A re-enacted trial as Python takes it: numbers as the bytes of arrays, little-endian; the rest as JSON.

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use reenact::geometry::Pose;
use reenact::grid::{GridFrame, Occupancy, OccupancyGrid};
use reenact::report::{Shown, still_svg};
use reenact::studies::recording::{Frame, Recording, Sensed};
use serde_json::{Value, json};

/// A trial that was re-enacted.
pub(crate) struct Played {
    pub(crate) name: String,
    pub(crate) key: String,
    /// Whether its record is the archived one.
    pub(crate) same: bool,
    pub(crate) recording: Recording,
}

/// Returns what `reenact.Replay` is made of.
pub(crate) fn replayed<'py>(py: Python<'py>, played: &Played) -> PyResult<Bound<'py, PyDict>> {
    let Played { name, key, same, recording } = played;
    let frames = &recording.frames;
    let floats = |values: Vec<f64>| bytes(py, values.into_iter().map(f64::to_le_bytes));
    let answer = PyDict::new(py);
    answer.set_item("name", name)?;
    answer.set_item("key", key)?;
    answer.set_item("same", same)?;
    answer.set_item("frames", floats(frames.iter().flat_map(frame_row).collect()))?;
    // Beam ends, all frames' in one array; which frames have how many.
    let seen = frames.iter().enumerate().filter_map(|(i, f)| Some((i, f.scan.as_ref()?)));
    let seen: Vec<_> = seen.collect();
    answer.set_item("scan_frames", seen.iter().map(|(i, _)| *i).collect::<Vec<_>>())?;
    answer.set_item("scan_sizes", seen.iter().map(|(_, scan)| scan.len()).collect::<Vec<_>>())?;
    let ends = seen.iter().flat_map(|(_, scan)| scan.iter().flat_map(|p| [p.x, p.y]));
    answer.set_item("scan_points", floats(ends.collect()))?;
    // The map, as it grew.
    answer.set_item("map_frame", frame_of(&recording.map_frame))?;
    answer.set_item("map_pose", pose_row(recording.map_pose))?;
    let changes = frames.iter().enumerate().flat_map(|(i, frame)| {
        let of_frame = frame.map_changes.iter().filter_map(move |(cell, value)| {
            let index = recording.map_frame.index(*cell)?;
            Some([i64::try_from(i).ok()?, i64::try_from(index).ok()?, i64::from(ros(*value))])
        });
        of_frame.flatten()
    });
    answer.set_item("map_changes", bytes(py, changes.map(i64::to_le_bytes)))?;
    if let Some(prior) = &recording.prior {
        answer.set_item("prior_frame", frame_of(prior.frame()))?;
        answer.set_item("prior", cells(py, prior))?;
    }
    if let Some(sensed) = &recording.sensed {
        let ranges = sensed.iter().flat_map(|s| s.scan.ranges.iter().copied());
        answer.set_item("ranges", floats(ranges.collect()))?;
        let sizes: Vec<usize> = sensed.iter().map(|s| s.scan.ranges.len()).collect();
        answer.set_item("range_sizes", sizes)?;
        answer.set_item("sensed", floats(sensed.iter().flat_map(sensed_row).collect()))?;
    }
    answer.set_item("details", details(recording).to_string())?;
    answer.set_item("svg", still_svg(recording, None, Shown::Everything))?;
    Ok(answer)
}

/// Returns the bytes of numbers one after another.
fn bytes<const N: usize>(
    py: Python<'_>,
    numbers: impl Iterator<Item = [u8; N]>,
) -> Bound<'_, PyBytes> {
    PyBytes::new(py, &numbers.flatten().collect::<Vec<u8>>())
}

/// Returns the numbers of a frame, in the order of `Replay`'s columns.
fn frame_row(frame: &Frame) -> [f64; 6] {
    let Pose { x, y, heading } = frame.pose;
    [frame.time_s, x, y, heading, frame.distance_m, frame.coverage_percent]
}

/// Returns the numbers of a scan beside its ranges: when, from where on the robot, which beams, and where the robot was by its
/// wheels and by its own estimate.
fn sensed_row(sensed: &Sensed) -> Vec<f64> {
    let Sensed { scan, odometry, believed } = sensed;
    let mut row = vec![scan.stamp.seconds().get()];
    row.extend(pose_row(scan.mount));
    row.extend([scan.min_angle, scan.increment, scan.min_range, scan.max_range]);
    row.extend(pose_row(odometry.pose));
    row.extend(pose_row(*believed));
    row
}

fn pose_row(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.heading]
}

/// Returns side of a cell (m), lower left corner (m), columns and rows.
fn frame_of(frame: &GridFrame) -> (f64, f64, f64, i32, i32) {
    (frame.resolution, frame.origin.x, frame.origin.y, frame.width, frame.height)
}

/// Returns a cell as ROS has it (`nav_msgs/OccupancyGrid`).
fn ros(value: Occupancy) -> i8 {
    match value {
        Occupancy::Unknown => -1,
        Occupancy::Free => 0,
        Occupancy::Occupied => 100,
    }
}

fn cells<'py>(py: Python<'py>, map: &OccupancyGrid) -> Bound<'py, PyBytes> {
    bytes(py, map.values().iter().map(|value| ros(*value).to_le_bytes()))
}

/// Returns what is no array: how it ended, what was decided when, and what the robot moved in.
fn details(recording: &Recording) -> Value {
    let timed = |of: fn(&Frame) -> Option<Value>| -> Vec<Value> {
        let told = recording.frames.iter().filter_map(|frame| Some((frame.time_s, of(frame)?)));
        told.map(|(time, what)| json!([time, what])).collect()
    };
    let plans = recording.plans.iter().map(|plan| json!([plan.time_s, plan.document]));
    json!({
        "outcome": recording.outcome,
        "rule": recording.rule,
        "deadline-s": recording.deadline_s,
        "goal": recording.goal.map(|goal| [goal.x, goal.y]),
        "world": recording.world,
        "footprint": recording.footprint,
        "events": timed(|frame| frame.event.as_ref().map(|event| json!(event))),
        "decisions": timed(|frame| frame.decision.as_ref().map(|decision| json!(decision))),
        "graphs": timed(|frame| frame.graph.as_ref().map(|graph| json!(graph))),
        "plans": plans.collect::<Vec<_>>(),
    })
}
