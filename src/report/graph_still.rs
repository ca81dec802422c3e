//! One instant of a trial of the deadline study: the building, the graph as the robot knows it, its plan, the clock.

use super::still::{ended, ends};
use crate::figure::svg::{Element, document, number, path_data};
use crate::geometry::{Outline, Point};
use crate::math;
use crate::studies::recording::{Frame, GraphView, Recording, VertexView};

const INK: &str = "#111111";
const WALL: &str = "#8a8f98";
const BLUE: &str = "#0072b2";
const ORANGE: &str = "#d55e00";
const GREEN: &str = "#009e73";
/// Room for the legend and the clock under the drawing (px).
const FOOT: f64 = 82.0;

/// The transform from metres to the sheet.
pub(super) struct Paper {
    /// The lower left corner of the drawing (m).
    pub(super) low: Point,
    /// Its upper end (m).
    pub(super) top: f64,
    /// px per metre.
    pub(super) scale: f64,
    /// Width of the drawing (px).
    pub(super) width: f64,
    /// Height of the drawing (px).
    pub(super) height: f64,
}

impl Paper {
    fn place(&self, p: Point) -> (f64, f64) {
        ((p.x - self.low.x) * self.scale, (self.top - p.y) * self.scale)
    }

    fn line(&self, points: &[Point], stroke: &str, width: f64) -> Element {
        let data = path_data(points.iter().map(|p| self.place(*p)), false);
        let path = Element::new("path").set("d", data).set("fill", "none").set("stroke", stroke);
        path.at("stroke-width", width)
            .set("stroke-linejoin", "round")
            .set("stroke-linecap", "round")
    }
}

/// Draws the picture after `frames`; `robot` is the robot and `scale` the scale bar, both already drawn.
pub(super) fn graph_still(
    recording: &Recording,
    frames: &[&Frame],
    paper: &Paper,
    robot: Vec<Element>,
    scale: [Element; 2],
) -> String {
    let ground = |y: f64, height: f64, fill: &str| {
        Element::new("rect")
            .at("y", y)
            .at("width", paper.width)
            .at("height", height)
            .set("fill", fill)
    };
    let mut body = vec![ground(0.0, paper.height + FOOT, "#ffffff")];
    body.extend(recording.world.iter().map(|outline| wall(outline, paper)));
    let trail: Vec<Point> = frames.iter().map(|f| f.pose.position()).collect();
    body.push(paper.line(&trail, "#b0b0b0", 3.0));
    let graph = frames.iter().rev().find_map(|f| f.graph.as_ref());
    if let Some(graph) = graph {
        body.extend(edges(graph, paper));
        body.extend(policy(graph, paper));
    }
    body.extend(ends(recording, &|p| paper.place(p)));
    body.extend(robot);
    if let Some(graph) = graph {
        body.extend(
            graph.vertices.iter().enumerate().flat_map(|(i, v)| vertex(graph, i, v, paper)),
        );
    }
    // Beside the clock: within the drawing it would lie on rooms.
    let beside = format!("translate({} 36)", number(paper.width - 160.0));
    body.push(scale.into_iter().fold(Element::new("g").set("transform", beside), Element::child));
    body.extend(foot(recording, frames, graph, paper));
    let time = frames.last().map_or(0.0, |f| f.time_s);
    let title =
        format!("Graph, plan and robot after {} s{}", number(time), ended(recording, frames));
    document(paper.width, paper.height + FOOT, &recording.titled(&title), body)
}

fn wall(outline: &Outline, paper: &Paper) -> Element {
    let element = match outline {
        Outline::Polygon(corners) => {
            Element::new("path").set("d", path_data(corners.iter().map(|c| paper.place(*c)), true))
        }
        Outline::Circle { center, radius } => {
            let (x, y) = paper.place(*center);
            Element::new("circle").at("cx", x).at("cy", y).at("r", radius * paper.scale)
        }
    };
    element.set("fill", WALL).set("stroke", WALL).at("stroke-width", 1.0)
}

/// Draws explored edges, and a metre of every edge to the unexplored.
fn edges(graph: &GraphView, paper: &Paper) -> Vec<Element> {
    let at = |v: usize| graph.vertices.get(v).map_or(Point::ZERO, |vertex| vertex.at);
    let explored = graph.edges.iter().map(|(a, b)| paper.line(&[at(*a), at(*b)], INK, 1.5));
    let stub = |vertex: &VertexView, heading: f64| {
        let (sin, cos) = math::sin_cos(heading);
        let ends = [vertex.at, vertex.at + Point::new(cos, sin) * 1.2];
        paper.line(&ends, GREEN, 2.0).set("stroke-dasharray", "2 4")
    };
    let open = graph.vertices.iter().flat_map(|v| v.unexplored.iter().map(move |h| stub(v, *h)));
    explored.chain(open).collect()
}

/// Draws π*: an arrow per action beside its edge, thick where fast, pale where unlikely.
fn policy(graph: &GraphView, paper: &Paper) -> Vec<Element> {
    let at = |v: usize| paper.place(graph.vertices.get(v).map_or(Point::ZERO, |vertex| vertex.at));
    let mut arrows = Vec::new();
    for action in graph.policy.iter().filter(|action| action.probability > 0.005) {
        let ((x0, y0), (x1, y1)) = (at(action.from), at(action.to));
        let length = math::hypot(x1 - x0, y1 - y0).max(1e-9);
        let (u, v) = ((x1 - x0) / length, (y1 - y0) / length);
        let width = if action.fast { 3.5 } else { 1.5 };
        let head = 6.0 + 1.5 * width;
        let back = (length - 9.0 - head).max(0.0);
        let point = |along: f64, aside: f64| {
            (x0 + u * along - v * (5.0 + aside), y0 + v * along + u * (5.0 + aside))
        };
        let opacity = number(0.3 + 0.7 * action.probability);
        let shaft = path_data([point(9.0, 0.0), point(back, 0.0)], false);
        let tip = path_data(
            [point(length - 9.0, 0.0), point(back, head / 2.0), point(back, -head / 2.0)],
            true,
        );
        let speed = if action.fast { "fast" } else { "slow" };
        let told = format!("{speed}, probability {:.2}", action.probability);
        arrows.push(
            Element::new("path")
                .set("d", shaft)
                .set("fill", "none")
                .set("stroke", BLUE)
                .at("stroke-width", width)
                .set("opacity", opacity.clone())
                .child(Element::new("title").text(&told)),
        );
        arrows.push(Element::new("path").set("d", tip).set("fill", BLUE).set("opacity", opacity));
    }
    arrows
}

/// Draws a circle for a corridor, a square for a room; the target filled, the present vertex with a thick edge.
fn vertex(graph: &GraphView, i: usize, vertex: &VertexView, paper: &Paper) -> Vec<Element> {
    let (x, y) = paper.place(vertex.at);
    let shape = if vertex.room {
        Element::new("rect").at("x", x - 5.0).at("y", y - 5.0).at("width", 10.0).at("height", 10.0)
    } else {
        Element::new("circle").at("cx", x).at("cy", y).at("r", 5.5)
    };
    let (is_target, is_current) = (graph.target == Some(i), graph.current == i);
    let fill = match () {
        () if is_target => ORANGE,
        () if vertex.goal => GREEN,
        () => "#ffffff",
    };
    let mut label = vertex.label.clone();
    if vertex.goal {
        label.push_str(" goal");
    }
    let text = Element::new("text").at("x", x + 8.0).at("y", y - 7.0).at("font-size", 12.0);
    let text = text.set("paint-order", "stroke").set("stroke", "#ffffff").at("stroke-width", 3.0);
    let text = text.set("font-weight", if is_target { "700" } else { "400" }).set("fill", INK);
    vec![
        shape
            .set("fill", fill)
            .set("stroke", INK)
            .at("stroke-width", if is_current { 3.0 } else { 1.5 }),
        text.text(&label),
    ]
}

/// Draws the clock against the deadline, the robot's present task, and the meaning of the signs.
fn foot(
    recording: &Recording,
    frames: &[&Frame],
    graph: Option<&GraphView>,
    paper: &Paper,
) -> Vec<Element> {
    let time = frames.last().map_or(0.0, |f| f.time_s);
    let mut told = match recording.deadline_s {
        Some(deadline) => format!("{time:.1} s of {deadline:.0} s"),
        None => format!("{time:.1} s"),
    };
    let ended = ended(recording, frames);
    if !ended.is_empty() {
        // What it was about to do no longer matters.
        told.push_str(&ended);
    } else if let Some(graph) = graph {
        let target = graph.target.and_then(|v| graph.vertices.get(v));
        if let Some(target) = target {
            told.push_str(&format!(", on the way to {}", target.label));
        }
        if !graph.doing.is_empty() {
            told.push_str(&format!(": {}", graph.doing));
        }
    }
    let signs = "circle: corridor, square: room, orange: target, thick edge: where it is or was last, arrows: policy (thick: fast), \
                 dotted: unexplored";
    let line = |y: f64, size: f64, text: &str| {
        let element = Element::new("text").at("x", 12.0).at("y", paper.height + y);
        element.at("font-size", size).set("fill", INK).text(text)
    };
    let ends = if recording.goal.is_some() { "ring: start, flag: goal" } else { "ring: start" };
    vec![line(24.0, 15.0, &told), line(48.0, 12.0, signs), line(66.0, 12.0, ends)]
}
