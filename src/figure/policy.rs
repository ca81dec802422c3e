//! A policy on a building's graph: the actions in each place that it visits, and how often it visits them.
//!
//! Over 400 lines, as graph, arrows, labels and key of a panel share their measures.

use super::chart::{KeyItem, broken, key, label, rule, sheet, text_width};
use super::medium::Medium;
use super::palette::{INK, PAPER};
use super::svg::{Element, path_data};
use crate::geometry::{Bounds, Outline, Point};
use crate::math;

/// Width of the building (px).
const WIDTH: f64 = 760.0;
/// Room around the content of a panel (m).
const AROUND: f64 = 4.0;
/// Size of the names of places (px), and half the height of the places.
const NAME: f64 = 10.0;
const HALF: f64 = 8.0;
const SLOW: &str = "#2b79ad";
const FAST: &str = "#b34700";

/// A chart of policies on one graph. Lengths in m.
#[derive(Debug, Clone, Default)]
pub struct PolicyChart {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// The building.
    pub walls: Vec<Outline>,
    /// Places.
    pub vertices: Vec<PolicyVertex>,
    /// Connections between places, by index.
    pub edges: Vec<(usize, usize)>,
    /// The place at which the policies begin.
    pub start: usize,
    /// The place at which they end.
    pub goal: usize,
    /// The policies, one under another.
    pub panels: Vec<PolicyPanel>,
}

/// A place.
#[derive(Debug, Clone, Default)]
pub struct PolicyVertex {
    /// Its position.
    pub at: Point,
    /// Its name, of few letters.
    pub label: String,
    /// Whether it is a room.
    pub room: bool,
}

/// One policy.
#[derive(Debug, Clone, Default)]
pub struct PolicyPanel {
    /// What it is a policy for.
    pub name: String,
    /// How it meets that.
    pub how: String,
    /// Its expected totals.
    pub told: String,
    /// Its actions.
    pub moves: Vec<PolicyMove>,
}

/// One action of a policy in one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PolicyMove {
    /// The place.
    pub from: usize,
    /// The place to which it leads.
    pub to: usize,
    /// Whether fast.
    pub fast: bool,
    /// Its probability there.
    pub probability: f64,
    /// How often it is expected to be done in all.
    pub passes: f64,
}

/// Metres to pixels: part of the building with its upper left corner at a place of the sheet.
struct View {
    bounds: Bounds,
    scale: f64,
    left: f64,
    top: f64,
    medium: Medium,
}

impl View {
    fn at(&self, point: Point) -> (f64, f64) {
        let x = self.left + (point.x - self.bounds.min.x) * self.scale;
        (x, self.top + (self.bounds.max.y - point.y) * self.scale)
    }

    /// Returns the position of `point`, or of the nearest point of the view: edges run along the axes, so that they end
    /// at its frame.
    fn within(&self, point: Point) -> (f64, f64) {
        let Bounds { min, max } = self.bounds;
        self.at(Point::new(point.x.clamp(min.x, max.x), point.y.clamp(min.y, max.y)))
    }
}

const MARGIN: f64 = 10.0;

impl PolicyChart {
    /// Draws the chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let places = self.vertices.iter().fold(Bounds::EMPTY, |b, v| b.including(v.at));
        let mut whole = self.walls.iter().fold(places, |b, wall| b.union(wall.bounds()));
        if whole.is_empty() {
            whole = Bounds { min: Point::ZERO, max: Point::new(1.0, 1.0) };
        }
        // Small buildings leave room for the names of places at their walls.
        let left = if medium == Medium::Screen { MARGIN } else { 2.0 * MARGIN };
        let building = match medium.width() {
            // The building is drawn with 0.3 m around it.
            Some(width) => (width - 2.0 * left) / (1.0 + 0.6 / whole.width().max(1.0)),
            None => WIDTH,
        };
        let scale = building / whole.width().max(1.0);
        let mut body = Vec::new();
        let mut top = 10.0;
        for (i, panel) in self.panels.iter().enumerate() {
            // The first shows the building, the others the part in which they differ.
            let bounds = match self.panels.first() {
                Some(first) if i > 0 => around(&self.vertices, first, panel, whole),
                _ => whole.grown(0.3),
            };
            // A part is twice as large, where words still fit beside it.
            let large = MARGIN + 2.0 * bounds.width() * scale + 14.0;
            let has_room = i > 0 && large < 0.55 * WIDTH && medium == Medium::Screen;
            let (scale, beside) = match medium {
                _ if has_room => (2.0 * scale, large),
                Medium::Paper { .. } if i > 0 => {
                    ((3.0 * scale).min(building / bounds.width().max(1.0)), 0.0)
                }
                _ => (scale, 0.0),
            };
            let mut y = top + 13.0;
            let x = if has_room { beside } else { MARGIN };
            for (line, text) in [&panel.name, &panel.how, &panel.told].into_iter().enumerate() {
                let lines = match medium {
                    Medium::Screen => vec![text.clone()],
                    Medium::Paper { .. } => broken(text, building),
                };
                for text in lines {
                    let text = label(x, y, "start", &text);
                    body.push(if line == 0 { text.set("font-weight", "bold") } else { text });
                    y += 18.0;
                }
            }
            if has_room {
                body.push(label(x, y, "start", "elsewhere as above"));
            } else {
                top = y - 8.0;
            }
            let view = View { bounds, scale, left, top, medium };
            body.extend(self.panel(&view, panel));
            if i > 0 {
                body.push(frame(&view));
            }
            top += (bounds.height() * scale).max(if has_room { 72.0 } else { 0.0 }) + 18.0;
        }
        let width = building + 0.6 * scale + 2.0 * left;
        let (key, height) = key(self.items(), MARGIN, width - 4.0, top);
        sheet(width, top + height + 8.0, &self.title, body.into_iter().chain([key]))
    }

    /// Describes the chart for those who cannot see it: each policy place by place.
    pub fn in_words(&self) -> String {
        let label = |v: usize| self.vertices.get(v).map_or("", |vertex| vertex.label.as_str());
        let told = |panel: &PolicyPanel| {
            let steps: Vec<String> = panel
                .moves
                .iter()
                .map(|step| {
                    let speed = if step.fast { "fast" } else { "slow" };
                    let mut words = format!("{} to {} {speed}", label(step.from), label(step.to));
                    if step.probability < 0.999 {
                        words.push_str(&format!(" with {:.0} %", 100.0 * step.probability));
                    }
                    words
                })
                .collect();
            format!("{}, {}; {}; {}.", panel.name, panel.how, panel.told, steps.join(", "))
        };
        let panels: Vec<String> = self.panels.iter().map(told).collect();
        format!("{} places, {} ways. {}", self.vertices.len(), self.edges.len(), panels.join(" "))
    }

    fn panel(&self, view: &View, panel: &PolicyPanel) -> Vec<Element> {
        let mut body = Vec::new();
        let inside = |bounds: Bounds| {
            let (a, b) = (bounds, view.bounds);
            a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y
        };
        let mut walls = String::new();
        for wall in self.walls.iter().filter(|wall| inside(wall.bounds())) {
            match wall {
                Outline::Polygon(corners) => {
                    // Walls run along the axes, or nearly: cutting each corner cuts the wall.
                    let corners = corners.iter().map(|corner| view.within(*corner));
                    walls.push_str(&path_data(corners, true));
                }
                Outline::Circle { center, radius } => {
                    let bounds = Bounds { min: *center, max: *center }.grown(*radius);
                    let (min, max) = (view.at(bounds.min), view.at(bounds.max));
                    let corners = [min, (min.0, max.1), max, (max.0, min.1)];
                    walls.push_str(&path_data(corners, true));
                }
            }
        }
        body.push(Element::new("path").set("d", walls).set("fill", "#c9c9c9"));
        let shown = |v: usize| view.bounds.contains(self.vertices[v].at);
        for &(a, b) in self.edges.iter().filter(|(a, b)| shown(*a) || shown(*b)) {
            let ends = (view.within(self.vertices[a].at), view.within(self.vertices[b].at));
            body.push(rule(ends.0, ends.1, 1.0, 0.45));
        }
        for step in panel.moves.iter().filter(|step| shown(step.from) || shown(step.to)) {
            body.extend(self.step(view, panel, step));
        }
        let visited = |v: usize| panel.moves.iter().any(|step| step.from == v || step.to == v);
        let hidden = match view.medium {
            Medium::Screen => Vec::new(),
            Medium::Paper { .. } => self.without_room(view, visited),
        };
        for (v, vertex) in self.vertices.iter().enumerate().filter(|(v, _)| shown(*v)) {
            let at = view.at(vertex.at);
            if hidden.contains(&v) {
                body.push(dot(at));
            } else {
                body.extend(self.place(at, v, vertex, visited(v)));
            }
        }
        // Above everything: probabilities stand right of the middle of their arrow.
        let drawn_at_random =
            |step: &&PolicyMove| step.probability < 0.999 && shown(step.from) && shown(step.to);
        for step in panel.moves.iter().filter(drawn_at_random) {
            let (a, b) = self.ends(view, panel, step);
            let middle = (f64::midpoint(a.0, b.0), f64::midpoint(a.1, b.1));
            let share = format!("{:.0} %", 100.0 * step.probability);
            let (dx, dy) = if (b.1 - a.1).abs() > (b.0 - a.0).abs() {
                (if step.fast { 9.0 } else { -9.0 }, 4.0)
            } else {
                (0.0, if step.fast { 17.0 } else { -9.0 })
            };
            let anchor = match dx {
                0.0 => "middle",
                dx if dx > 0.0 => "start",
                _ => "end",
            };
            body.push(
                label(middle.0 + dx, middle.1 + dy, anchor, &share).set("font-weight", "bold"),
            );
        }
        body
    }

    /// Returns the places whose names would lie over others': those of the policy are named first.
    fn without_room(&self, view: &View, visited: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.vertices.len()).collect();
        order.sort_by_key(|v| (!visited(*v) && *v != self.start && *v != self.goal, *v));
        let mut named: Vec<usize> = Vec::new();
        let mut hidden = Vec::new();
        for v in order {
            let (x, y) = view.at(self.vertices[v].at);
            let hits = |other: &usize| {
                let (u, w) = view.at(self.vertices[*other].at);
                let wide = self.half_width(v) + self.half_width(*other) + 2.0;
                (x - u).abs() < wide && (y - w).abs() < 2.0 * HALF + 2.0
            };
            let kept = if named.iter().any(hits) { &mut hidden } else { &mut named };
            kept.push(v);
        }
        hidden
    }

    /// Returns where the arrow of `step` begins and ends, px: beside the edge where it shares it.
    fn ends(
        &self,
        view: &View,
        panel: &PolicyPanel,
        step: &PolicyMove,
    ) -> ((f64, f64), (f64, f64)) {
        let ends = [step.from, step.to].map(|v| view.within(self.vertices[v].at));
        let [a, b] = ends;
        let shared =
            panel.moves.iter().filter(|o| (o.from, o.to) == (step.from, step.to)).count() > 1;
        if !shared {
            return (a, b);
        }
        let length = math::hypot(b.0 - a.0, b.1 - a.1).max(1e-9);
        let side = if step.fast { 4.5 } else { -4.5 };
        let (dx, dy) = (-(b.1 - a.1) / length * side, (b.0 - a.0) / length * side);
        // Slow above or left, fast below or right, whatever the direction.
        let (dx, dy) = if (dx + dy) * side < 0.0 { (-dx, -dy) } else { (dx, dy) };
        ((a.0 + dx, a.1 + dy), (b.0 + dx, b.1 + dy))
    }

    fn step(&self, view: &View, panel: &PolicyPanel, step: &PolicyMove) -> [Element; 2] {
        let (a, b) = self.ends(view, panel, step);
        let half = |v: usize| (self.half_width(v), HALF);
        let (a, b) = (leaving(a, b, half(step.from)), leaving(b, a, half(step.to)));
        arrow(a, b, step.fast, step.passes)
    }

    /// Returns half the width of a place (px).
    fn half_width(&self, v: usize) -> f64 {
        text_width(&self.vertices[v].label, NAME) / 2.0 + 4.0
    }

    fn place(
        &self,
        (x, y): (f64, f64),
        v: usize,
        vertex: &PolicyVertex,
        visited: bool,
    ) -> Vec<Element> {
        let half = text_width(&vertex.label, NAME) / 2.0 + 4.0;
        let (fill, ink) = match v {
            v if v == self.goal => (INK, PAPER),
            v if v == self.start => (SLOW, PAPER),
            _ => (PAPER, INK),
        };
        let shape = Element::new("rect")
            .at("x", x - half)
            .at("y", y - HALF)
            .at("width", 2.0 * half)
            .at("height", 2.0 * HALF)
            .at("rx", if vertex.room { 0.0 } else { HALF })
            .set("fill", fill)
            .set("stroke", INK)
            .at("stroke-width", if visited { 1.6 } else { 0.8 });
        let name = Element::new("text")
            .at("x", x)
            .at("y", y + 3.6)
            .set("text-anchor", "middle")
            .at("font-size", NAME)
            .set("fill", ink)
            .text(&vertex.label);
        vec![shape, name]
    }

    fn items(&self) -> Vec<KeyItem> {
        let place = |label: &str, v: usize, room: bool| {
            let vertex = PolicyVertex { at: Point::ZERO, label: label.to_owned(), room };
            self.place((0.0, 0.0), v, &vertex, false)
                .into_iter()
                .fold(Element::new("g"), Element::child)
        };
        let other = usize::MAX;
        let label_of = |v: usize| self.vertices.get(v).map_or("", |vertex| vertex.label.as_str());
        let room_of = |v: usize| self.vertices.get(v).is_some_and(|vertex| vertex.room);
        let moves = || self.panels.iter().flat_map(|panel| &panel.moves);
        let mut items = vec![
            KeyItem { mark: place("c1a", other, false), text: "corridor".into() },
            KeyItem { mark: place("R1", other, true), text: "room".into() },
            KeyItem {
                mark: place(label_of(self.start), self.start, room_of(self.start)),
                text: "start".into(),
            },
            KeyItem {
                mark: place(label_of(self.goal), self.goal, room_of(self.goal)),
                text: "goal".into(),
            },
        ];
        for (fast, text) in [(false, "slow maneuver"), (true, "fast maneuver")] {
            if moves().any(|step| step.fast == fast) {
                let [line, head] = arrow((-13.0, 0.0), (13.0, 0.0), fast, 0.5);
                items.push(KeyItem {
                    mark: Element::new("g").child(line).child(head),
                    text: text.into(),
                });
            }
        }
        if moves().any(|step| step.probability < 0.999) {
            items.push(KeyItem {
                mark: label(0.0, 4.5, "middle", "%").set("font-weight", "bold"),
                text: "probability; width: expected passes".into(),
            });
        }
        items
    }
}

/// Returns the part of the building in which `panel` differs from `first`, or all that it visits where there is no
/// difference.
fn around(
    vertices: &[PolicyVertex],
    first: &PolicyPanel,
    panel: &PolicyPanel,
    whole: Bounds,
) -> Bounds {
    let mut other: Vec<&PolicyMove> =
        panel.moves.iter().filter(|step| !first.moves.contains(step)).collect();
    if other.is_empty() {
        other = panel.moves.iter().collect();
    }
    let ends = other.into_iter().flat_map(|step| [step.from, step.to]);
    let places = ends.filter_map(|v| vertices.get(v));
    let near = places.fold(Bounds::EMPTY, |b, v| b.including(v.at));
    let around = if near.is_empty() { whole } else { near.grown(AROUND) };
    Bounds {
        min: Point::new(around.min.x.max(whole.min.x), around.min.y.max(whole.min.y)),
        max: Point::new(around.max.x.min(whole.max.x), around.max.y.min(whole.max.y)),
    }
    .grown(0.3)
}

/// Draws a place without its name.
fn dot((x, y): (f64, f64)) -> Element {
    let dot = Element::new("circle").at("cx", x).at("cy", y).at("r", 2.5);
    dot.set("fill", PAPER).set("stroke", INK).at("stroke-width", 0.8)
}

/// Draws a thin line around a part of the building.
fn frame(view: &View) -> Element {
    let (left, top) = view.at(Point::new(view.bounds.min.x, view.bounds.max.y));
    Element::new("rect")
        .at("x", left)
        .at("y", top)
        .at("width", view.bounds.width() * view.scale)
        .at("height", view.bounds.height() * view.scale)
        .set("fill", "none")
        .set("stroke", INK)
        .set("stroke-opacity", "0.4")
}

/// Returns where the line from `a` to `b` leaves the rectangle around `a` with these halves (px).
fn leaving(a: (f64, f64), b: (f64, f64), half: (f64, f64)) -> (f64, f64) {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let share = (half.0 / dx.abs().max(1e-9)).min(half.1 / dy.abs().max(1e-9)).min(0.45);
    (a.0 + share * dx, a.1 + share * dy)
}

/// Draws a line with a head in its middle, two where it is `fast`, `passes` (0 to 1 and more) wide.
fn arrow(a: (f64, f64), b: (f64, f64), fast: bool, passes: f64) -> [Element; 2] {
    let colour = if fast { FAST } else { SLOW };
    let width = 1.5 + 3.5 * passes.clamp(0.0, 1.5);
    let line = Element::new("path")
        .set("d", path_data([a, b], false))
        .set("fill", "none")
        .set("stroke", colour)
        .at("stroke-width", width);
    let length = math::hypot(b.0 - a.0, b.1 - a.1).max(1e-9);
    let (ux, uy) = ((b.0 - a.0) / length, (b.1 - a.1) / length);
    let (mx, my) = (f64::midpoint(a.0, b.0), f64::midpoint(a.1, b.1));
    // Heads leave part of a short line free.
    let size = (4.0 + width).min(length / 2.6);
    // One head, `on` px beyond the middle of the line.
    let triangle = |on: f64| {
        let (x, y) = (mx + ux * on, my + uy * on);
        let corners = [
            (x + ux * size * 0.6, y + uy * size * 0.6),
            (x - ux * size * 0.6 - uy * size * 0.75, y - uy * size * 0.6 + ux * size * 0.75),
            (x - ux * size * 0.6 + uy * size * 0.75, y - uy * size * 0.6 - ux * size * 0.75),
        ];
        path_data(corners, true)
    };
    let heads = if fast { triangle(-0.55 * size) + &triangle(0.55 * size) } else { triangle(0.0) };
    let head = Element::new("path")
        .set("d", heads)
        .set("fill", colour)
        .set("stroke", PAPER)
        .at("stroke-width", 0.8)
        .set("class", "paper-stroke");
    [line, head]
}
