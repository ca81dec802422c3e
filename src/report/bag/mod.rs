//! A trial as a bag: MCAP with ROS 2 messages, for Foxglove, `rviz` and whatever reads `rosbag2` files.
//!
//! Frames after REP-103 and REP-105: `map` is the frame of the robot's own map, where it began; `odom` that of its
//! odometry; `base_link` the robot, x forward; `laser` its scanner. Above them stands `world`, the truth's frame, which no
//! robot knows: `/ground_truth/pose` is in it. Times are simulated, from 0.

mod definitions;
mod layout;
mod markers;
mod messages;
mod packed;
mod writer;

use crate::geometry::{Point, Pose};
use crate::grid::{GridFrame, Occupancy};
use crate::studies::recording::{Frame, Recording, Sensed};
use messages::{
    Clock, Float64, Header, LaserScan, Log, MapMetaData, MarkerArray, OccupancyGrid, Odometry,
    Path, PoseStamped, TFMessage, Text, Time, TransformStamped,
};
use std::collections::BTreeMap;
use writer::BagWriter;

pub use layout::foxglove_layout;
pub use writer::BagError;

/// Shortest time between two maps (s): GMapping's `map_update_interval` as the prior-knowledge study set it.
const MAP_PERIOD_S: f64 = 1.0;
/// Nominal level of a log line.
const INFO: u8 = 20;

/// A bag and what is in it.
#[derive(Debug, Clone)]
pub struct Bag {
    /// The file.
    pub bytes: Vec<u8>,
    /// How many messages each topic has.
    pub counts: BTreeMap<&'static str, u32>,
}

/// Writes `recording` as an MCAP file. With `scan_rate_hz`, scans that follow the last one written by less than its
/// period are left out; without it all that were recorded are written. The same recording gives the same bytes.
///
/// # Errors
/// Where a message cannot be encoded, which is a bug.
pub fn bag(recording: &Recording, scan_rate_hz: Option<f64>) -> Result<Bag, BagError> {
    bag_under_banner(recording, scan_rate_hz, None)
}

/// Writes a [`bag`] whose metadata record `reenact` has, beside the trial's name, title and outcome, what its readers must know of the
/// bundle: the key `banner`.
///
/// # Errors
/// As there.
pub fn bag_under_banner(
    recording: &Recording,
    scan_rate_hz: Option<f64>,
    banner: Option<&str>,
) -> Result<Bag, BagError> {
    let mut writing = Writing {
        recording,
        writer: BagWriter::new()?,
        map: vec![-1; recording.map_frame.len()],
        map_written_s: None,
        measured_s: None,
        map_changed: false,
        scan_period_s: scan_rate_hz.map_or(0.0, |rate| 1.0 / rate),
        scanned_s: None,
    };
    let told = [
        ("banner", banner.unwrap_or_default()),
        ("trial", &recording.name),
        ("title", &recording.title),
        ("outcome", &recording.outcome),
    ];
    writing.writer.tell("reenact", &told)?;
    writing.still()?;
    if !recording.title.is_empty() {
        writing.log(0.0, &recording.title)?;
    }
    let mut sensed = recording.sensed.as_deref().unwrap_or_default().iter().peekable();
    for frame in &recording.frames {
        while let Some(scan) = sensed.next_if(|s| stamp(s) <= frame.time_s) {
            writing.sensed(scan)?;
        }
        writing.frame(frame)?;
    }
    sensed.try_for_each(|scan| writing.sensed(scan))?;
    if writing.map_changed {
        let frames_end = recording.frames.last().map_or(0.0, |frame| frame.time_s);
        let scans_end = recording.sensed.iter().flatten().last().map_or(0.0, stamp);
        writing.map(frames_end.max(scans_end))?;
    }
    if !recording.outcome.is_empty() {
        let end = recording.frames.last().map_or(0.0, |frame| frame.time_s);
        let scans_end = recording.sensed.iter().flatten().last().map_or(0.0, stamp);
        writing.log(end.max(scans_end), &format!("the trial ended: {}", recording.ending()))?;
    }
    let (bytes, counts) = writing.writer.finish()?;
    Ok(Bag { bytes, counts })
}

fn stamp(sensed: &Sensed) -> f64 {
    sensed.odometry.stamp.seconds().get()
}

struct Writing<'a> {
    recording: &'a Recording,
    writer: BagWriter,
    /// The robot's map as ROS has it: -1 unknown, 0 free, 100 occupied.
    map: Vec<i8>,
    map_written_s: Option<f64>,
    measured_s: Option<f64>,
    map_changed: bool,
    scan_period_s: f64,
    scanned_s: Option<f64>,
}

impl Writing<'_> {
    /// Writes what holds all the time: where the robot's map lies in the world, where the scanner sits, what map the
    /// robot was given before.
    fn still(&mut self) -> Result<(), BagError> {
        let recording = self.recording;
        let mut transforms = vec![transform(0.0, "world", "map", recording.map_pose)];
        if let Some(first) = recording.sensed.iter().flatten().next() {
            let mut laser = transform(0.0, "base_link", "laser", first.scan.mount);
            laser.transform = laser.transform.at_height(recording.scan_height_m);
            transforms.push(laser);
        }
        self.writer.write("/tf_static", 0.0, &TFMessage { transforms })?;
        if !recording.description.is_empty() {
            self.writer.write("/robot_description", 0.0, &Text { data: &recording.description })?;
        }
        self.writer.write("/world", 0.0, &MarkerArray { markers: markers::world(recording) })?;
        if let Some(prior) = &recording.prior {
            let cells = prior.values().iter().map(|value| of_ros(*value)).collect();
            self.writer.write("/prior_map", 0.0, &grid(0.0, "world", prior.frame(), cells))?;
        }
        Ok(())
    }

    fn sensed(&mut self, sensed: &Sensed) -> Result<(), BagError> {
        let at = stamp(sensed);
        let odometry = sensed.odometry;
        // map -> odom is what the robot corrects its odometry by (REP-105).
        let back = odometry.pose.relative(Pose::default());
        let correction = sensed.believed.compose(back);
        let transforms = vec![
            transform(at, "map", "odom", correction),
            transform(at, "odom", "base_link", odometry.pose),
        ];
        self.writer.write("/tf", at, &TFMessage { transforms })?;
        let header = header(at, "odom");
        let message = Odometry::new(header, "base_link", odometry.pose, odometry.twist);
        self.writer.write("/odom", at, &message)?;
        // Half a tick of grace: periods are multiples of a tick in time, but not in binary.
        let due = self.scanned_s.is_none_or(|last| at - last >= self.scan_period_s - 1e-4);
        if due {
            self.scanned_s = Some(at);
            self.writer.write("/scan", at, &laser_scan(at, sensed))?;
        }
        Ok(())
    }

    fn frame(&mut self, frame: &Frame) -> Result<(), BagError> {
        let at = frame.time_s;
        // Two frames of one instant differ in what happens, and in nothing that is measured.
        if self.measured_s != Some(at) {
            self.measured_s = Some(at);
            self.measures(frame)?;
        }
        for (cell, value) in &frame.map_changes {
            if let Some(index) = self.recording.map_frame.index(*cell) {
                self.map[index] = of_ros(*value);
                self.map_changed = true;
            }
        }
        let rested = self.map_written_s.is_none_or(|last| at - last >= MAP_PERIOD_S);
        if self.map_changed && rested {
            self.map(at)?;
        }
        if let Some(path) = &frame.path {
            self.writer.write("/plan", at, &planned(at, path))?;
        }
        if let Some(decision) = &frame.decision {
            let markers = markers::frontiers(at, decision);
            self.writer.write("/frontiers", at, &MarkerArray { markers })?;
        }
        if let Some(graph) = &frame.graph {
            let markers = markers::graph(at, graph);
            self.writer.write("/graph", at, &MarkerArray { markers })?;
        }
        frame.event.as_ref().map_or(Ok(()), |event| self.log(at, event))
    }

    /// Writes what there is at every instant.
    fn measures(&mut self, frame: &Frame) -> Result<(), BagError> {
        let at = frame.time_s;
        self.writer.write("/clock", at, &Clock { clock: Time::of(at) })?;
        let pose = PoseStamped { header: header(at, "world"), pose: frame.pose.into() };
        self.writer.write("/ground_truth/pose", at, &pose)?;
        self.writer.write("/coverage", at, &Float64 { data: frame.coverage_percent })?;
        self.writer.write("/distance_travelled", at, &Float64 { data: frame.distance_m })?;
        self.recording.deadline_s.map_or(Ok(()), |deadline| {
            self.writer.write("/time_left", at, &Float64 { data: deadline - at })
        })
    }

    /// Writes a line of the log.
    fn log(&mut self, at: f64, msg: &str) -> Result<(), BagError> {
        let (name, file, function) = ("mission", "", "");
        let log = Log { stamp: Time::of(at), level: INFO, name, msg, file, function, line: 0 };
        self.writer.write("/rosout", at, &log)
    }

    fn map(&mut self, at: f64) -> Result<(), BagError> {
        (self.map_changed, self.map_written_s) = (false, Some(at));
        let message = grid(at, "map", &self.recording.map_frame, self.map.clone());
        self.writer.write("/map", at, &message)
    }
}

fn header(at: f64, frame_id: &'static str) -> Header {
    Header { stamp: Time::of(at), frame_id }
}

fn transform(at: f64, parent: &'static str, child: &'static str, pose: Pose) -> TransformStamped {
    TransformStamped { header: header(at, parent), child_frame_id: child, transform: pose.into() }
}

/// Returns a cell as `nav_msgs/OccupancyGrid` has it: a probability in percent, or -1.
fn of_ros(value: Occupancy) -> i8 {
    match value {
        Occupancy::Unknown => -1,
        Occupancy::Free => 0,
        Occupancy::Occupied => 100,
    }
}

fn grid(at: f64, frame_id: &'static str, frame: &GridFrame, data: Vec<i8>) -> OccupancyGrid {
    let origin = Pose::new(frame.origin.x, frame.origin.y, 0.0);
    OccupancyGrid {
        header: header(at, frame_id),
        info: MapMetaData {
            map_load_time: Time::of(at),
            resolution: single(frame.resolution),
            width: u32::try_from(frame.width).unwrap_or(0),
            height: u32::try_from(frame.height).unwrap_or(0),
            origin: origin.into(),
        },
        data,
    }
}

fn planned(at: f64, path: &[Point]) -> Path {
    let pose = |point: &Point| PoseStamped {
        header: header(at, "world"),
        pose: Pose::new(point.x, point.y, 0.0).into(),
    };
    Path { header: header(at, "world"), poses: path.iter().map(pose).collect() }
}

fn laser_scan(at: f64, sensed: &Sensed) -> LaserScan {
    let scan = &sensed.scan;
    LaserScan {
        header: header(at, "laser"),
        angle_min: single(scan.min_angle),
        angle_max: single(scan.angle(scan.ranges.len().saturating_sub(1))),
        angle_increment: single(scan.increment),
        // All beams are taken at once.
        time_increment: 0.0,
        scan_time: 0.0,
        range_min: single(scan.min_range),
        range_max: single(scan.max_range),
        ranges: scan.ranges.iter().map(|range| single(*range)).collect(),
        intensities: Vec::new(),
    }
}

/// Returns `value` as wide as the message has it.
#[expect(clippy::cast_possible_truncation, reason = "ROS messages hold these as float32")]
fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests;
