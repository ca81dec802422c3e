//! What has no message of its own, as `visualization_msgs`: the true walls, frontiers with their utility, the graph.

use super::header;
use super::messages::{ColorRGBA, Marker, Shape, Vector3};
use crate::geometry::{Outline, Point, Pose};
use crate::math;
use crate::studies::recording::{Decision, GraphView, Recording, VertexView};
use std::f64::consts::TAU;

const GREY: ColorRGBA = ColorRGBA { r: 0.35, g: 0.35, b: 0.35, a: 1.0 };
const BLUE: ColorRGBA = ColorRGBA { r: 0.0, g: 0.447, b: 0.698, a: 1.0 };
const ORANGE: ColorRGBA = ColorRGBA { r: 0.835, g: 0.369, b: 0.0, a: 1.0 };
const GREEN: ColorRGBA = ColorRGBA { r: 0.0, g: 0.62, b: 0.451, a: 1.0 };
const INK: ColorRGBA = ColorRGBA { r: 0.1, g: 0.1, b: 0.1, a: 1.0 };

/// Corners that stand for a circle.
const CORNERS: i32 = 24;
/// Width of a wall's line (m).
const LINE_M: f64 = 0.05;

/// Returns the outlines that stand at the scanner's height.
pub(super) fn world(recording: &Recording) -> Vec<Marker> {
    let mut ends = Vec::new();
    for outline in &recording.world {
        let corners = corners(outline);
        for (i, corner) in corners.iter().enumerate() {
            ends.extend([*corner, corners[(i + 1) % corners.len()]]);
        }
    }
    vec![
        Marker::new(header(0.0, "world"), "walls", 0, Shape::LineList)
            .scaled(Vector3::new(LINE_M, 0.0, 0.0))
            .colored(GREY)
            .through(ends),
    ]
}

fn corners(outline: &Outline) -> Vec<Point> {
    match outline {
        Outline::Polygon(corners) => corners.clone(),
        Outline::Circle { center, radius } => {
            let corner = |i: i32| {
                let (sin, cos) = math::sin_cos(TAU * f64::from(i) / f64::from(CORNERS));
                *center + Point::new(cos, sin) * *radius
            };
            (0..CORNERS).map(corner).collect()
        }
    }
}

/// Returns the cells of all frontiers and their candidate locations with the utility, the chosen one in another colour.
pub(super) fn frontiers(at: f64, decision: &Decision) -> Vec<Marker> {
    let mut markers = vec![Marker::clear(header(at, "world"))];
    for (i, frontier) in decision.frontiers.iter().enumerate() {
        let id = i32::try_from(i).unwrap_or(i32::MAX);
        let color = if decision.chosen == Some(i) { ORANGE } else { BLUE };
        let place = Pose::new(frontier.candidate.x, frontier.candidate.y, 0.0);
        let cells = Marker::new(header(at, "world"), "cells", id, Shape::Points)
            .scaled(Vector3::new(0.1, 0.1, 0.0))
            .colored(color)
            .through(frontier.cells.iter().copied());
        let candidate = Marker::new(header(at, "world"), "candidates", id, Shape::Sphere)
            .scaled(Vector3::new(0.3, 0.3, 0.3))
            .colored(color)
            .at(place);
        let utility = Marker::new(header(at, "world"), "utilities", id, Shape::Text)
            .scaled(Vector3::new(0.0, 0.0, 0.4))
            .colored(INK)
            .at(place)
            .saying(format!("{:.3}", frontier.utility));
        markers.extend([cells, candidate, utility]);
    }
    markers
}

/// Returns vertices with their labels, explored edges, edges to the unexplored, and the policy as arrows.
pub(super) fn graph(at: f64, graph: &GraphView) -> Vec<Marker> {
    let mut markers = vec![Marker::clear(header(at, "world"))];
    let place = |v: usize| graph.vertices.get(v).map_or(Point::ZERO, |vertex| vertex.at);
    let explored = graph.edges.iter().flat_map(|(a, b)| [place(*a), place(*b)]);
    let open = graph.vertices.iter().flat_map(stubs);
    let lines = |ns, color, points: Vec<Point>| {
        Marker::new(header(at, "world"), ns, 0, Shape::LineList)
            .scaled(Vector3::new(0.08, 0.0, 0.0))
            .colored(color)
            .through(points)
    };
    markers.push(lines("edges", GREY, explored.collect()));
    markers.push(lines("unexplored", BLUE, open.collect()));
    for (i, vertex) in graph.vertices.iter().enumerate() {
        let id = i32::try_from(i).unwrap_or(i32::MAX);
        let color = match () {
            () if graph.target == Some(i) => ORANGE,
            () if vertex.goal => GREEN,
            () if graph.current == i => INK,
            () => BLUE,
        };
        let pose = Pose::new(vertex.at.x, vertex.at.y, 0.0);
        let sphere = Marker::new(header(at, "world"), "vertices", id, Shape::Sphere)
            .scaled(Vector3::new(0.5, 0.5, 0.5))
            .colored(color)
            .at(pose);
        let label = Marker::new(header(at, "world"), "labels", id, Shape::Text)
            .scaled(Vector3::new(0.0, 0.0, 0.6))
            .colored(INK)
            .at(Pose::new(vertex.at.x, vertex.at.y + 0.6, 0.0))
            .saying(vertex.label.clone());
        markers.extend([sphere, label]);
    }
    for (i, action) in graph.policy.iter().enumerate() {
        let id = i32::try_from(i).unwrap_or(i32::MAX);
        #[expect(clippy::cast_possible_truncation, reason = "an opacity")]
        let color = ColorRGBA { a: action.probability as f32, ..ORANGE };
        let arrow = Marker::new(header(at, "world"), "policy", id, Shape::Arrow)
            .scaled(Vector3::new(if action.fast { 0.2 } else { 0.1 }, 0.3, 0.0))
            .colored(color)
            .through([place(action.from), place(action.to)]);
        markers.push(arrow);
    }
    markers
}

/// Returns a metre of every edge to unexplored space.
fn stubs(vertex: &VertexView) -> impl Iterator<Item = Point> + '_ {
    vertex.unexplored.iter().flat_map(|heading| {
        let (sin, cos) = math::sin_cos(*heading);
        [vertex.at, vertex.at + Point::new(cos, sin)]
    })
}
