//! A building's graph as the deadline study draws it (its Figure 2): corridors round, rooms square, and every directed
//! edge with its label, R or L.

use crate::figure::canvas::{ACCENT, Canvas, INK};
use crate::figure::svg::{Element, path_data};
use crate::geometry::{Cardinal, Outline, Point};
use crate::math;
use crate::world::topology::{Opening, Topology};
use crate::world::{RegionKind, World};

/// The study's colours of edges that lead to the right and to the left, in shades that the colour-blind tell apart.
const RIGHT: &str = "#7b3294";
const LEFT: &str = "#008837";
/// In grey the two are told by this: lines to the left are dashed.
const LEFT_DASH: &str = "4 2.5";

/// Half the side of a room, radius of a corridor vertex (px).
const SIZE: f64 = 11.0;
/// How far (px) a directed edge lies to the right of the middle line.
const OFFSET: f64 = 2.6;

/// Returns whether S(e) of an edge in this `direction` is R (Definition 1): along E-W one faces north, along N-S west,
/// so that east and north are on the right.
fn is_right(direction: Cardinal) -> bool {
    matches!(direction, Cardinal::East | Cardinal::North)
}

/// Draws the graph over a pale plan of the walls at `height` m.
pub(super) fn graph_sheet(world: &World, topology: &Topology, height: f64) -> Canvas {
    let bounds = world.bounds();
    let span = bounds.width().max(bounds.height());
    let mut canvas = Canvas::new(bounds.grown(0.03 * span), 1000.0, 760.0);
    for outline in world.slice(height) {
        let wall = canvas.outline(&outline).set("fill", "#dcdcdc");
        canvas.push(wall);
    }
    let at: Vec<(f64, f64)> = topology.vertices.iter().map(|v| canvas.at(v.at)).collect();
    for (from, vertex) in topology.vertices.iter().enumerate() {
        for exit in &vertex.exits {
            directed(&mut canvas, at[from], at[exit.to], is_right(exit.direction));
        }
    }
    for (number, name) in topology.names(&world.regions).iter().enumerate() {
        let is_room = topology.vertices[number].kind == RegionKind::Room;
        node(&mut canvas, at[number], is_room, name);
    }
    for (name, start) in &world.starts {
        if let Some(number) = topology.vertex_near(start.position(), 0.5) {
            let (x, y) = at[number];
            badge(&mut canvas, (x + 14.5, y - 14.5), name);
        }
    }
    for number in topology.goals() {
        let (x, y) = at[number];
        canvas.push(star((x - 17.0, y - 17.0), 9.5));
    }
    canvas.axes();
    canvas.heading(&format!("{}: the graph", world.name), &summary(topology));
    legend(&mut canvas);
    canvas
}

/// Counts what the graph has: `49 vertices (26 corridor, 23 room), 49 edges (23 through doors), 1 loop`.
pub(super) fn summary(topology: &Topology) -> String {
    let rooms = topology.vertices.iter().filter(|v| v.kind == RegionKind::Room).count();
    let doors = topology.edges().filter(|edge| edge.opening == Opening::Door).count();
    let loops = topology.loops();
    format!(
        "{} vertices ({} corridor, {rooms} room), {} edges ({doors} through doors), {loops} {}",
        topology.vertices.len(),
        topology.vertices.len() - rooms,
        topology.edges().count(),
        if loops == 1 { "loop" } else { "loops" },
    )
}

/// Draws the directed edge from `a` to `b` (px): an arrow to the right of the middle line.
fn directed(canvas: &mut Canvas, a: (f64, f64), b: (f64, f64), right: bool) {
    let length = math::hypot(b.0 - a.0, b.1 - a.1).max(1e-9);
    let (ux, uy) = ((b.0 - a.0) / length, (b.1 - a.1) / length);
    // The y axis of a drawing points down: to the right of (ux, uy) is (-uy, ux).
    let point = |along: f64, aside: f64| {
        (a.0 + ux * along - uy * (OFFSET + aside), a.1 + uy * along + ux * (OFFSET + aside))
    };
    let (from, tip) = (SIZE, length - SIZE - 0.5);
    let neck = tip - 6.0;
    let color = if right { RIGHT } else { LEFT };
    let mut line = Element::new("path")
        .set("d", path_data([point(from, 0.0), point(neck, 0.0)], false))
        .set("fill", "none")
        .set("stroke", color)
        .set("stroke-width", 1.7);
    if !right {
        line = line.set("stroke-dasharray", LEFT_DASH);
    }
    canvas.push(line);
    let head = [point(tip, 0.0), point(neck, 2.8), point(neck, -1.6)];
    canvas.push(Element::new("path").set("d", path_data(head, true)).set("fill", color));
}

fn node(canvas: &mut Canvas, (x, y): (f64, f64), is_room: bool, name: &str) {
    let shape = if is_room {
        Element::new("rect")
            .at("x", x - SIZE)
            .at("y", y - SIZE)
            .at("width", 2.0 * SIZE)
            .at("height", 2.0 * SIZE)
            .set("fill", "#f3efe6")
    } else {
        Element::new("circle").at("cx", x).at("cy", y).at("r", SIZE).set("fill", "#e6edf3")
    };
    canvas.push(shape.set("stroke", INK).set("stroke-width", 1.2));
    // Up to four characters stand in the node.
    let size = match name.chars().count() {
        0..=2 => 11.0,
        3 => 9.5,
        _ => 8.0,
    };
    canvas.push(
        Element::new("text")
            .at("x", x)
            .at("y", y + 0.36 * size)
            .at("font-size", size)
            .set("text-anchor", "middle")
            .set("fill", INK)
            .text(name),
    );
}

/// Draws a start's letter, white on a disc around (x, y) px; longer names in ink beside it.
pub(super) fn badge(canvas: &mut Canvas, (x, y): (f64, f64), name: &str) {
    let disc = Element::new("circle").at("cx", x).at("cy", y).at("r", 7.5);
    canvas.push(disc.set("fill", ACCENT).set("stroke", "#fff").set("stroke-width", 1));
    let text =
        Element::new("text").at("font-size", 11.0).set("font-weight", "bold").at("y", y + 4.0);
    canvas.push(if name.chars().count() == 1 {
        text.at("x", x).set("text-anchor", "middle").set("fill", "#fff").text(name)
    } else {
        text.at("x", x + 11.0).set("fill", INK).text(name)
    });
}

/// Draws the goal's star around (x, y) px.
pub(super) fn star((x, y): (f64, f64), radius: f64) -> Element {
    let corner = |i: u32| {
        let angle = std::f64::consts::PI * (f64::from(i) / 5.0 - 0.5);
        let (sin, cos) = math::sin_cos(angle);
        let r = if i.is_multiple_of(2) { radius } else { 0.42 * radius };
        (x + r * cos, y + r * sin)
    };
    Element::new("path")
        .set("d", path_data((0..10).map(corner), true))
        .set("fill", "#e69f00")
        .set("stroke", INK)
        .set("stroke-width", 1)
        .set("stroke-linejoin", "round")
}

/// Draws a tag as a small mark at (x, y) px: squares for vertices, arrowheads for exits, distinguished by colour and
/// shape.
pub(super) fn tag_mark((x, y): (f64, f64), mark: Mark<'_>) -> Element {
    let shape = match mark {
        Mark::Vertex(_) => [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)].to_vec(),
        Mark::Exit(_, direction) => {
            let (sin, cos) = math::sin_cos(direction.heading());
            let turned = |(dx, dy): (f64, f64)| (cos * dx + sin * dy, -sin * dx + cos * dy);
            [(3.2, 0.0), (-2.2, 2.6), (-2.2, -2.6)].map(turned).to_vec()
        }
    };
    let (Mark::Vertex(color) | Mark::Exit(color, _)) = mark;
    Element::new("path")
        .set("d", path_data(shape.into_iter().map(|(dx, dy)| (x + dx, y + dy)), true))
        .set("fill", color)
        .set("stroke", INK)
        .set("stroke-width", 0.7)
}

/// What a tag's mark looks like: its colour, and for exits where it points.
#[derive(Debug, Clone, Copy)]
pub(super) enum Mark<'a> {
    /// A vertex tag.
    Vertex(&'a str),
    /// An exit tag.
    Exit(&'a str, Cardinal),
}

/// Draws a mark that the building's sheet and the legend share, with what it means.
pub(super) fn legend_entry(
    canvas: &mut Canvas,
    x: f64,
    mark: Element,
    width: f64,
    text: &str,
) -> f64 {
    let (_, y) = canvas.legend_at();
    canvas.push(mark);
    canvas.push(
        Element::new("text")
            .at("x", x + width + 6.0)
            .at("y", y + 4.0)
            .at("font-size", 12.0)
            .set("fill", INK)
            .text(text),
    );
    #[expect(clippy::cast_precision_loss, reason = "texts are short")]
    let advance = text.chars().count() as f64 * 6.4;
    x + width + 6.0 + advance + 16.0
}

fn legend(canvas: &mut Canvas) {
    let (x, y) = canvas.legend_at();
    let line = |x: f64, color: &str, dash: &str| {
        Element::new("path")
            .set("d", path_data([(x, y), (x + 24.0, y)], false))
            .set("stroke", color)
            .set("stroke-width", 2)
            .set("stroke-dasharray", dash)
    };
    let x = legend_entry(canvas, x, line(x, RIGHT, "none"), 24.0, "R: to the right");
    let x = legend_entry(canvas, x, line(x, LEFT, LEFT_DASH), 24.0, "L: to the left");
    let circle = Element::new("circle").at("cx", x + 6.0).at("cy", y).at("r", 6.0);
    let circle = circle.set("fill", "#e6edf3").set("stroke", INK);
    let x = legend_entry(canvas, x, circle, 12.0, "corridor");
    let room = Outline::rectangle(Point::new(x + 6.0, y), 11.0, 11.0, 0.0);
    let corners = room.sides().map(|side| (side.a.x, side.a.y));
    let square = Element::new("path").set("d", path_data(corners, true));
    let square = square.set("fill", "#f3efe6").set("stroke", INK);
    let x = legend_entry(canvas, x, square, 12.0, "room");
    legend_entry(canvas, x, star((x + 8.0, y), 8.0), 16.0, "goal");
}
