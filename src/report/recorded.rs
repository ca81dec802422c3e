//! A recording as the replay page takes it: frames as columns, everything packed.

use super::pack::{deltas, grid, points, runs, whole};
use crate::geometry::{Bounds, Outline, Point};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::studies::recording::{Decision, Frame, GraphView, Recording};
use serde::Serialize;
use std::collections::BTreeMap;

/// Unit of all packed lengths: a millimetre. Angles are in milliradians, times in milliseconds.
const MILLI: f64 = 0.001;
/// Unit of beam ends: a centimetre is finer than a pixel, and half the text.
const CENTI: f64 = 0.01;

/// One trial's data block.
#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) struct Recorded<'a> {
    name: &'a str,
    /// What to show: x and y of the lower left and of the upper right corner (m).
    view: [f64; 4],
    frame: GridFrame,
    /// Where the map's frame lies in the world: x, y (m), heading (rad).
    pose: [f64; 3],
    /// Polygons, as packed corners (mm).
    polygons: Vec<String>,
    /// Centre x, y and radius of discs (m).
    discs: Vec<[f64; 3]>,
    footprint: Footprint,
    prior: Option<Prior>,
    time: String,
    x: String,
    y: String,
    heading: String,
    distance: String,
    coverage: String,
    /// Packed beam ends (cm) by frame.
    scans: Vec<(usize, String)>,
    /// Packed runs of changed cells by frame.
    maps: Vec<(usize, String)>,
    /// Packed points (mm) by frame; an empty path is one, too.
    paths: Vec<(usize, String)>,
    decisions: Vec<(usize, Choice)>,
    events: Vec<(usize, &'a str)>,
    /// How the next place is chosen, in a sentence.
    rule: &'a str,
    /// Deadline study: T (s).
    deadline: Option<f64>,
    graphs: Vec<(usize, &'a GraphView)>,
    /// Deadline study: the place to reach (m).
    goal: Option<[f64; 2]>,
    /// How the trial ended; empty where that is not known.
    outcome: &'a str,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Footprint {
    Polygon(String),
    Disc([f64; 3]),
}

#[derive(Debug, Serialize)]
struct Prior {
    frame: GridFrame,
    cells: String,
}

#[derive(Debug, Serialize)]
struct Choice {
    chosen: Option<usize>,
    frontiers: Vec<Candidate>,
}

#[derive(Debug, Serialize)]
struct Candidate {
    cells: String,
    x: f64,
    y: f64,
    distance: f64,
    gain: f64,
    utility: f64,
}

impl<'a> Recorded<'a> {
    pub(super) fn new(name: &'a str, recording: &'a Recording) -> Self {
        let frames = &recording.frames;
        let column = |value: fn(&Frame) -> f64| deltas(frames.iter().map(value), MILLI);
        let mut polygons = Vec::new();
        let mut discs = Vec::new();
        for outline in &recording.world {
            match outline {
                Outline::Polygon(corners) => polygons.push(points(corners, MILLI)),
                Outline::Circle { center, radius } => discs.push(disc(*center, *radius)),
            }
        }
        Self {
            name,
            view: view(recording),
            frame: recording.map_frame,
            pose: [recording.map_pose.x, recording.map_pose.y, recording.map_pose.heading],
            polygons,
            discs,
            footprint: match &recording.footprint {
                Outline::Polygon(corners) => Footprint::Polygon(points(corners, MILLI)),
                Outline::Circle { center, radius } => Footprint::Disc(disc(*center, *radius)),
            },
            prior: recording.prior.as_ref().map(prior),
            time: column(|f| f.time_s),
            x: column(|f| f.pose.x),
            y: column(|f| f.pose.y),
            heading: column(|f| f.pose.heading),
            distance: column(|f| f.distance_m),
            coverage: column(|f| f.coverage_percent),
            scans: each(frames, |f| f.scan.as_ref().map(|scan| points(scan, CENTI))),
            maps: each(frames, |f| changes(&recording.map_frame, f)),
            paths: each(frames, |f| f.path.as_ref().map(|path| points(path, MILLI))),
            decisions: each(frames, |f| f.decision.as_ref().map(choice)),
            events: each(frames, |f| f.event.as_deref()),
            rule: &recording.rule,
            deadline: recording.deadline_s,
            graphs: each(frames, |f| f.graph.as_ref()),
            goal: recording.goal.map(|goal| [short(goal.x), short(goal.y)]),
            outcome: &recording.outcome,
        }
    }
}

/// Returns what `of` finds, with the number of its frame.
fn each<'a, T>(frames: &'a [Frame], of: impl Fn(&'a Frame) -> Option<T>) -> Vec<(usize, T)> {
    frames.iter().enumerate().filter_map(|(i, frame)| Some((i, of(frame)?))).collect()
}

fn disc(center: Point, radius: f64) -> [f64; 3] {
    [center.x, center.y, radius].map(short)
}

/// Rounds to the millimetre (or the thousandth): what a reader can see.
fn short(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn changes(map: &GridFrame, frame: &Frame) -> Option<String> {
    // A cell may change more than once between frames: the last word counts.
    let indexed = frame.map_changes.iter().filter_map(|(c, value)| Some((map.index(*c)?, *value)));
    let last: BTreeMap<usize, Occupancy> = indexed.collect();
    (!frame.map_changes.is_empty()).then(|| runs(map, last))
}

fn prior(map: &OccupancyGrid) -> Prior {
    Prior { frame: *map.frame(), cells: grid(map) }
}

fn choice(decision: &Decision) -> Choice {
    let frontiers = decision.frontiers.iter().map(|f| Candidate {
        cells: points(&f.cells, CENTI),
        x: short(f.candidate.x),
        y: short(f.candidate.y),
        distance: short(f.distance_m),
        gain: short(f.gain_m2),
        utility: short(f.utility),
    });
    Choice { chosen: decision.chosen, frontiers: frontiers.collect() }
}

/// Returns the box around the world and every place where the robot was, with a small margin; around the robot's map
/// where the world is empty.
pub(super) fn bounds(recording: &Recording) -> Bounds {
    let world = recording.world.iter().fold(Bounds::EMPTY, |b, outline| b.union(outline.bounds()));
    let seen = recording.frames.iter().fold(world, |b, f| b.including(f.pose.position()));
    let map = recording.map_frame.bounds();
    let corners =
        [map.min, Point::new(map.max.x, map.min.y), map.max, Point::new(map.min.x, map.max.y)];
    let map = corners.into_iter().map(|corner| recording.map_pose.transform(corner));
    let seen = if world.is_empty() { map.fold(seen, Bounds::including) } else { seen };
    seen.grown(0.3)
}

fn view(recording: &Recording) -> [f64; 4] {
    let bounds = bounds(recording);
    #[expect(clippy::cast_precision_loss, reason = "millimetres of a building are exact")]
    [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]
        .map(|v| whole(v, MILLI) as f64 / 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Cell;

    #[test]
    fn of_several_changes_of_a_cell_the_last_counts() {
        let map = GridFrame { resolution: 1.0, origin: Point::ZERO, width: 4, height: 1 };
        let of = |map_changes| changes(&map, &Frame { map_changes, ..Frame::default() });
        let (free, occupied) = (Occupancy::Free, Occupancy::Occupied);
        let cell = Cell::new(2, 0);
        assert_eq!(of(vec![(cell, occupied), (cell, free)]), of(vec![(cell, free)]));
        assert_ne!(of(vec![(cell, free), (cell, occupied)]), of(vec![(cell, free)]));
        assert_eq!(of(Vec::new()), None);
    }
}
