//! One instant of a trial as the paper would print it:
//! 1. The sheet, and where a place in the world lies on it.
//! 2. Of the deadline study: the building and the graph (`graph_still`), and nothing of what follows.
//! 3. The map, free and occupied cells.
//! 4. The trail and the planned path.
//! 5. The frontiers with their candidates.
//! 6. The robot and the scale bar.

use super::graph_still::{Paper, graph_still};
use super::recorded::bounds;
use crate::figure::svg::{Element, document, number, path_data};
use crate::geometry::{Outline, Point};
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::studies::recording::{Frame, Recording};

/// Longest side of the drawing (px).
const SIZE: f64 = 800.0;

/// What a still shows besides the map, the trail and the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Also the frontiers with their candidates, and the planned path.
    Everything,
    /// Nothing, as the paper prints maps (Figure 9c).
    MapAndTrail,
}

/// Draws the robot's map (free white, occupied black, unknown grey), the frontiers with the chosen candidate, the path
/// and the trail, and the robot, at `at` s or at the end; with a scale bar. Of the deadline study the building, the
/// graph with the plan on it, and the clock. The steps are those of the module documentation.
pub fn still_svg(recording: &Recording, at: Option<f64>, shown: Shown) -> String {
    // 1. The sheet.
    let seen = recording.frames.iter().take_while(|f| at.is_none_or(|at| f.time_s <= at));
    let frames: Vec<&Frame> = seen.collect();
    let bounds = bounds(recording);
    let scale = SIZE / bounds.width().max(bounds.height()).max(1e-3);
    let (width, height) = (bounds.width() * scale, bounds.height() * scale);
    let place = |p: Point| ((p.x - bounds.min.x) * scale, (bounds.max.y - p.y) * scale);
    let line = |points: &[Point]| path_data(points.iter().map(|p| place(*p)), false);
    let stroke = |data: String, colour: &str, width: f64| {
        let path = Element::new("path").set("d", data).set("fill", "none");
        path.set("stroke", colour).at("stroke-width", width).set("stroke-linejoin", "round")
    };

    // 2. The deadline study.
    if recording.deadline_s.is_some() {
        let paper = Paper { low: bounds.min, top: bounds.max.y, scale, width, height };
        let robot = frames.last().map(|frame| robot(recording, frame, &place, scale));
        let robot = robot.into_iter().collect();
        return graph_still(recording, &frames, &paper, robot, scale_bar(height, scale));
    }

    // 3. The map.
    let ground = Element::new("rect").at("width", width).at("height", height);
    let mut body = vec![ground.set("fill", "#c4c7cc")];
    let map = map_of(recording, &frames);
    for (value, colour) in [(Occupancy::Free, "#ffffff"), (Occupancy::Occupied, "#111111")] {
        let data = cells_path(&map, value, scale);
        if !data.is_empty() {
            // Crisp edges: neighbouring cells must not show seams.
            let path = Element::new("path").set("d", data).set("fill", colour);
            let path = path.set("shape-rendering", "crispEdges");
            // The map lies in the frame in which the robot began.
            let (x, y) = place(recording.map_pose.position());
            let turn = number(-recording.map_pose.heading.to_degrees());
            let transform = format!("translate({} {}) rotate({turn})", number(x), number(y));
            body.push(path.set("transform", transform));
        }
    }
    // 4. Trail and path.
    let trail: Vec<_> = frames.iter().map(|f| f.pose.position()).collect();
    body.push(stroke(line(&trail), "#555555", 1.5));
    let is_all = shown == Shown::Everything;
    if let Some(path) = frames.iter().rev().filter(|_| is_all).find_map(|f| f.path.as_deref()) {
        body.push(stroke(line(path), "#0072b2", 2.5).set("stroke-dasharray", "7 4"));
    }
    // 5. Frontiers.
    let dot = |p: Point, r: f64| {
        let (x, y) = place(p);
        Element::new("circle").at("cx", x).at("cy", y).at("r", r)
    };
    let decision = frames.iter().rev().filter(|_| is_all).find_map(|f| f.decision.as_ref());
    for (i, frontier) in decision.iter().flat_map(|d| d.frontiers.iter().enumerate()) {
        let side = recording.map_frame.resolution * scale;
        for &cell in &frontier.cells {
            body.push(dot(cell, (side * 0.5).max(1.5)).set("fill", "#009e73"));
        }
        let chosen = decision.is_some_and(|d| d.chosen == Some(i));
        let candidate = dot(frontier.candidate, 4.0 + 6.0 * frontier.utility.clamp(0.0, 1.0));
        let name = format!(
            "D {:.2} m, I {:.2} m², u {:.3}",
            frontier.distance_m, frontier.gain_m2, frontier.utility
        );
        let title = Element::new("title").text(&name);
        let (fill, edge) = if chosen { ("#d55e00", "#111111") } else { ("#ffffff", "#009e73") };
        let candidate = candidate.set("fill", fill).set("stroke", edge).at("stroke-width", 2.0);
        body.push(candidate.child(title));
    }
    // 6. Robot and scale bar.
    if is_all {
        body.extend(ends(recording, &place));
    }
    if let Some(frame) = frames.last() {
        body.push(robot(recording, frame, &place, scale));
        let nose = frame.pose.transform(Point::new(0.35, 0.0));
        body.push(stroke(line(&[frame.pose.position(), nose]), "#111111", 2.0));
    }
    body.extend(scale_bar(height, scale));
    let time = frames.last().map_or(0.0, |f| f.time_s);
    let what = if is_all { "Map, frontiers, path and robot" } else { "Map, path and robot" };
    let title = format!("{what} after {} s{}", number(time), ended(recording, &frames));
    document(width, height, &recording.titled(&title), body)
}

/// Says how the trial ended, where `frames` are all of it.
pub(super) fn ended(recording: &Recording, frames: &[&Frame]) -> String {
    let is_end = frames.len() == recording.frames.len() && !recording.outcome.is_empty();
    if is_end { format!("; the trial ended: {}", recording.ending()) } else { String::new() }
}

/// Draws where the trial began, and where it was to go.
pub(super) fn ends(recording: &Recording, place: &impl Fn(Point) -> (f64, f64)) -> Vec<Element> {
    let mut drawn = Vec::new();
    if let Some(first) = recording.frames.first() {
        let (x, y) = place(first.pose.position());
        let ring = Element::new("circle").at("cx", x).at("cy", y).at("r", 5.0).set("fill", "none");
        let ring = ring.set("stroke", "#444444").at("stroke-width", 2.0).set("class", "start");
        drawn.push(ring.child(Element::new("title").text("start")));
    }
    if let Some(goal) = recording.goal {
        let (x, y) = place(goal);
        let flag = [(0.0, 8.0), (0.0, -10.0), (12.0, -6.0), (0.0, -2.0)];
        let flag = path_data(flag.map(|(dx, dy)| (x + dx, y + dy)), true);
        let flag = Element::new("path").set("d", flag).set("fill", "#d55e00").set("class", "goal");
        let flag = flag.set("stroke", "#444444").at("stroke-width", 1.5);
        drawn.push(flag.child(Element::new("title").text("goal")));
    }
    drawn
}

/// Draws the robot's map after `frames`.
fn map_of(recording: &Recording, frames: &[&Frame]) -> OccupancyGrid {
    let mut map = OccupancyGrid::filled(recording.map_frame, Occupancy::Unknown);
    for (cell, value) in frames.iter().flat_map(|f| &f.map_changes) {
        map.set(*cell, *value);
    }
    map
}

/// Writes the cells that hold `value` as one path in the map's frame, y downwards: a rectangle per run along a row.
fn cells_path(map: &OccupancyGrid, value: Occupancy, scale: f64) -> String {
    let (frame, mut data) = (map.frame(), String::new());
    let corner = |x: i32, y: i32| {
        (frame.origin + Point::new(f64::from(x), f64::from(y)) * frame.resolution) * scale
    };
    for y in 0..frame.height {
        let mut x = 0;
        while x < frame.width {
            let begin = x;
            while x < frame.width && map.at(Cell::new(x, y)) == value {
                x += 1;
            }
            if x == begin {
                x += 1;
                continue;
            }
            // Edges as absolute numbers, so that neighbouring rows round to the same one and leave no seam.
            let (low, high) = (corner(begin, y), corner(x, y + 1));
            let [left, right, bottom, top] = [low.x, high.x, -low.y, -high.y].map(number);
            data.push_str(&format!("M{left} {top}H{right}V{bottom}H{left}z"));
        }
    }
    data
}

fn robot(
    recording: &Recording,
    frame: &Frame,
    place: &impl Fn(Point) -> (f64, f64),
    scale: f64,
) -> Element {
    let element = match &recording.footprint {
        Outline::Polygon(corners) => Element::new("path")
            .set("d", path_data(corners.iter().map(|c| place(frame.pose.transform(*c))), true)),
        Outline::Circle { center, radius } => {
            let (x, y) = place(frame.pose.transform(*center));
            Element::new("circle").at("cx", x).at("cy", y).at("r", radius * scale)
        }
    };
    element.set("fill", "#56b4e9").set("stroke", "#111111").at("stroke-width", 1.5)
}

/// Draws a bar of 1, 2, 5 or ten times that many metres, about a sixth of the drawing long.
fn scale_bar(height: f64, scale: f64) -> [Element; 2] {
    let lengths = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
    let metres = lengths.into_iter().rev().find(|m| m * scale <= SIZE / 6.0).unwrap_or(0.5);
    let (x, y) = (12.0, height - 12.0);
    let bar = Element::new("path")
        .set("d", format!("M{0} {1}v6h{2}v-6", number(x), number(y - 6.0), number(metres * scale)))
        .set("fill", "none")
        .set("stroke", "#111111")
        .at("stroke-width", 2.0);
    let label = Element::new("text").at("x", x + 4.0).at("y", y - 5.0).at("font-size", 13.0);
    [bar, label.set("fill", "#111111").text(&format!("{metres} m"))]
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::recording;
    use super::*;
    use crate::studies::recording::{ActionView, GraphView, VertexView};

    #[test]
    fn the_still_shows_map_frontiers_path_and_robot() {
        let recording = recording(40);
        let svg = still_svg(&recording, None, Shown::Everything);
        let parsed = roxmltree::Document::parse(&svg).unwrap();
        let with = |name: &str, value: &str| {
            parsed.descendants().filter(|n| n.attribute(name) == Some(value)).count()
        };
        assert_eq!(with("fill", "#d55e00"), 1, "one candidate is chosen");
        assert_eq!(with("stroke-dasharray", "7 4"), 1, "one path");
        assert_eq!(with("fill", "#56b4e9"), 1, "one robot");
        assert_eq!((with("fill", "#111111"), with("stroke", "#111111")), (2, 4));
        assert_eq!(svg, still_svg(&recording, None, Shown::Everything));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_still_of_the_deadline_study_shows_the_graph_its_plan_and_the_clock() {
        let mut recording = recording(40);
        recording.deadline_s = Some(60.0);
        let at = recording.frames[0].pose.position();
        let vertex = |label: &str, room, x: f64| VertexView {
            label: label.to_owned(),
            room,
            goal: room,
            at: at + Point::new(x, 0.0),
            unexplored: vec![0.0],
        };
        recording.frames[0].graph = Some(GraphView {
            vertices: vec![vertex("c1a", false, 0.0), vertex("R1", true, 3.0)],
            edges: vec![(0, 1)],
            target: Some(1),
            policy: vec![ActionView { from: 0, to: 1, probability: 0.75, fast: true }],
            doing: "door on the left, fast".to_owned(),
            ..GraphView::default()
        });
        let svg = still_svg(&recording, Some(2.0), Shown::Everything);
        roxmltree::Document::parse(&svg).unwrap();
        for text in [
            "c1a",
            "R1 goal",
            "fast, probability 0.75",
            "2.0 s of 60 s, on the way to R1: door on the left, fast",
        ] {
            assert!(svg.contains(text), "{text} in {svg}");
        }
        recording.outcome = "reached".to_owned();
        recording.goal = Some(at + Point::new(3.0, 0.0));
        let (early, whole) = (Some(2.0), None);
        let [early, whole] = [early, whole].map(|at| still_svg(&recording, at, Shown::Everything));
        assert!(!early.contains("ended") && early.contains("class=\"goal\""), "{early}");
        assert!(whole.contains(" s of 60 s; the trial ended: reached</text>"), "{whole}");
        assert!(whole.contains(">ring: start, flag: goal</text>"), "{whole}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_plain_still_has_neither_frontiers_nor_a_planned_path() {
        let svg = still_svg(&recording(40), None, Shown::MapAndTrail);
        assert!(svg.contains("#555555") && svg.contains("#56b4e9"), "the trail and the robot");
        assert!(!svg.contains("#d55e00") && !svg.contains("#009e73") && !svg.contains("7 4"));
    }

    #[test]
    fn an_earlier_instant_knows_less() {
        let recording = recording(40);
        let frames: Vec<_> = recording.frames.iter().collect();
        let known = |n: usize| map_of(&recording, &frames[..n]).count(Occupancy::Unknown);
        assert!(known(40) < known(5) && known(5) < known(0));
        let still = |at| still_svg(&recording, Some(at), Shown::Everything);
        assert!(still(0.3).contains("after 0.3 s"));
        assert!(still(-1.0).contains("after 0 s"), "before it began");
    }
}
