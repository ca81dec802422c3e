//! The sheet under every drawing: metres to pixels, axes, a scale bar, dimensions, texts.

use super::svg::{self, Element};
use crate::geometry::{Bounds, Outline, Point};
use crate::math;

/// Space (px) left, right, above and below the drawing.
const LEFT: f64 = 58.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 62.0;
const BOTTOM: f64 = 78.0;

/// Ink for texts and axes.
pub(crate) const INK: &str = "#222";
/// Ink for secondary marks.
pub(crate) const FAINT: &str = "#777";
/// The one colour: the robot's actions and commands (starts, goals, field of view).
pub(crate) const ACCENT: &str = "#0b62a4";

/// A sheet under construction.
pub(crate) struct Canvas {
    bounds: Bounds,
    scale: f64,
    elements: Vec<Element>,
    /// Lines of text below everything else.
    key: usize,
    /// Whether it is a column of a paper: its caption has the title, and the legend stands below.
    narrow: bool,
}

impl Canvas {
    /// Creates a sheet for `bounds` (m) with about `width` by at most `height` px for the drawing.
    pub(crate) fn new(bounds: Bounds, width: f64, height: f64) -> Self {
        let scale = (width / bounds.width()).min(height / bounds.height());
        let mut canvas = Self { bounds, scale, elements: Vec::new(), key: 0, narrow: false };
        let (w, h) = canvas.size();
        canvas.push(Element::new("rect").at("width", w).at("height", h).set("fill", "#fff"));
        canvas
    }

    /// Creates a sheet for `bounds` (m) that is `width` px wide in all.
    pub(crate) fn of_width(bounds: Bounds, width: f64) -> Self {
        let canvas = Self::new(bounds, width - LEFT - RIGHT, f64::INFINITY);
        Self { narrow: true, ..canvas }
    }

    /// Returns the width and height of the sheet (px).
    fn size(&self) -> (f64, f64) {
        let width = self.bounds.width() * self.scale + LEFT + RIGHT;
        // Room for a title and a legend above small drawings.
        (width.max(420.0), self.bounds.height() * self.scale + TOP + BOTTOM)
    }

    /// Returns the pixels per metre.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns the position of `point` (m) on the sheet (px).
    pub(crate) fn at(&self, point: Point) -> (f64, f64) {
        (
            LEFT + (point.x - self.bounds.min.x) * self.scale,
            TOP + (self.bounds.max.y - point.y) * self.scale,
        )
    }

    pub(crate) fn push(&mut self, element: Element) {
        self.elements.push(element);
    }

    /// Returns the outline as an element to be styled.
    pub(crate) fn outline(&self, outline: &Outline) -> Element {
        match outline {
            Outline::Circle { center, radius } => {
                let (x, y) = self.at(*center);
                Element::new("circle").at("cx", x).at("cy", y).at("r", radius * self.scale)
            }
            Outline::Polygon(corners) => self.path(corners, true),
        }
    }

    /// Returns the polyline through `points` (m) as an element to be styled.
    pub(crate) fn path(&self, points: &[Point], closed: bool) -> Element {
        Element::new("path")
            .set("d", svg::path_data(points.iter().map(|point| self.at(*point)), closed))
    }

    /// Draws a text of `size` px centred at `point` (m) and moved by `shift` px, with a white rim.
    pub(crate) fn label(&self, point: Point, shift: (f64, f64), size: f64, text: &str) -> Element {
        let (x, y) = self.at(point);
        Element::new("text")
            .at("x", x + shift.0)
            .at("y", y + shift.1)
            .at("font-size", size)
            .set("text-anchor", "middle")
            .set("stroke", "#fff")
            .set("stroke-width", 3)
            .set("stroke-linejoin", "round")
            .set("paint-order", "stroke")
            .set("fill", INK)
            .text(text)
    }

    /// Draws a dimension line from `a` to `b` (m), `shift` px off to its left, with its length.
    pub(crate) fn dimension(&mut self, a: Point, b: Point, shift: f64, text: &str) {
        let ((ax, ay), (bx, by)) = (self.at(a), self.at(b));
        let length = math::hypot(bx - ax, by - ay).max(1e-9);
        let (ux, uy) = ((bx - ax) / length, (by - ay) / length);
        let (nx, ny) = (uy, -ux);
        let line = |from: (f64, f64), to: (f64, f64)| {
            Element::new("path")
                .set("d", svg::path_data([from, to], false))
                .set("stroke", FAINT)
                .set("fill", "none")
        };
        let end = |x: f64, y: f64, off: f64| (x + nx * off, y + ny * off);
        let gap = shift.signum() * 4.0;
        self.push(line(end(ax, ay, gap), end(ax, ay, shift + gap)));
        self.push(line(end(bx, by, gap), end(bx, by, shift + gap)));
        let (from, to) = (end(ax, ay, shift), end(bx, by, shift));
        self.push(line(from, to).set("stroke-width", 1));
        for (tip, sign) in [(from, 1.0), (to, -1.0)] {
            let back = (tip.0 + sign * ux * 7.0, tip.1 + sign * uy * 7.0);
            let head = [
                tip,
                (back.0 + nx * 2.5, back.1 + ny * 2.5),
                (back.0 - nx * 2.5, back.1 - ny * 2.5),
            ];
            self.push(Element::new("path").set("d", svg::path_data(head, true)).set("fill", FAINT));
        }
        let (x, y) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        let turned = uy.abs() > ux.abs();
        let mut label = Element::new("text")
            .at("x", x)
            .at("y", y - 5.0)
            .at("font-size", 12.0)
            .set("text-anchor", "middle")
            .set("fill", INK);
        if turned {
            let at = format!("rotate(-90 {} {})", svg::number(x), svg::number(y));
            label = label.set("transform", at);
        }
        self.push(label.text(text));
    }

    /// Draws an arrow from `tail` to `tip` (m).
    pub(crate) fn arrow(&mut self, tail: Point, tip: Point, color: &str) {
        let ((ax, ay), (bx, by)) = (self.at(tail), self.at(tip));
        let length = math::hypot(bx - ax, by - ay).max(1e-9);
        let (ux, uy) = ((bx - ax) / length, (by - ay) / length);
        let neck = (bx - ux * 9.0, by - uy * 9.0);
        self.push(
            Element::new("path")
                .set("d", svg::path_data([(ax, ay), neck], false))
                .set("stroke", color)
                .set("stroke-width", 2.5),
        );
        let head = [
            (bx, by),
            (neck.0 - uy * 5.0, neck.1 + ux * 5.0),
            (neck.0 + uy * 5.0, neck.1 - ux * 5.0),
        ];
        self.push(Element::new("path").set("d", svg::path_data(head, true)).set("fill", color));
    }

    /// Draws light lines at every tick, below everything drawn after.
    pub(crate) fn raster(&mut self) {
        let Bounds { min, max } = self.bounds;
        let lines: Vec<[Point; 2]> = ticks(min.x, max.x)
            .map(|x| [Point::new(x, min.y), Point::new(x, max.y)])
            .chain(ticks(min.y, max.y).map(|y| [Point::new(min.x, y), Point::new(max.x, y)]))
            .collect();
        for line in lines {
            let line = self.path(&line, false).set("stroke", "#e6e6e6").set("stroke-width", 1);
            self.push(line);
        }
    }

    /// Draws axes in metres around the drawing, and a scale bar below.
    pub(crate) fn axes(&mut self) {
        let Bounds { min, max } = self.bounds;
        let corners = [min, Point::new(max.x, min.y), max, Point::new(min.x, max.y)];
        let frame = self.path(&corners, true).set("fill", "none").set("stroke", FAINT);
        self.push(frame);
        let text = |x: f64, y: f64, anchor: &str, text: &str| {
            Element::new("text")
                .at("x", x)
                .at("y", y)
                .at("font-size", 11.0)
                .set("text-anchor", anchor)
                .set("fill", INK)
                .text(text)
        };
        for x in ticks(min.x, max.x) {
            let (px, py) = self.at(Point::new(x, min.y));
            self.push(tick((px, py), (px, py + 5.0)));
            self.push(text(px, py + 17.0, "middle", &metres(x)));
        }
        for y in ticks(min.y, max.y) {
            let (px, py) = self.at(Point::new(min.x, y));
            self.push(tick((px - 5.0, py), (px, py)));
            self.push(text(px - 8.0, py + 4.0, "end", &metres(y)));
        }
        let (left, bottom) = self.at(min);
        let (right, top) = self.at(max);
        self.push(text(f64::midpoint(left, right), bottom + 33.0, "middle", "x (m)"));
        let (x, y) = (16.0, f64::midpoint(top, bottom));
        let turn = format!("rotate(-90 {} {})", svg::number(x), svg::number(y));
        self.push(text(x, y, "middle", "y (m)").set("transform", turn));
        self.scale_bar(left, bottom + 52.0);
    }

    /// Draws a bar of a round length, black and white, from `left` at height `y` (px).
    fn scale_bar(&mut self, left: f64, y: f64) {
        let length = round_step(self.bounds.width() / 4.0);
        let half = length / 2.0 * self.scale;
        for (i, fill) in [INK, "#fff"].into_iter().enumerate() {
            let x = if i == 0 { left } else { left + half };
            self.push(
                Element::new("rect")
                    .at("x", x)
                    .at("y", y)
                    .at("width", half)
                    .at("height", 6.0)
                    .set("fill", fill)
                    .set("stroke", INK),
            );
        }
        self.push(
            Element::new("text")
                .at("x", left + 2.0 * half + 8.0)
                .at("y", y + 7.0)
                .at("font-size", 12.0)
                .set("fill", INK)
                .text(&format!("{} m", metres(length))),
        );
    }

    /// Writes the title and a line below it.
    pub(crate) fn heading(&mut self, title: &str, subtitle: &str) {
        for (y, size, fill, weight, text) in
            [(24.0, 16.0, INK, "bold", title), (44.0, 12.0, FAINT, "normal", subtitle)]
        {
            if self.narrow && weight == "bold" {
                continue;
            }
            self.push(
                Element::new("text")
                    .at("x", LEFT)
                    .at("y", y)
                    .at("font-size", size)
                    .set("font-weight", weight)
                    .set("fill", fill)
                    .text(text),
            );
        }
    }

    /// Writes what nobody may overlook, below the heading.
    pub(crate) fn remark(&mut self, text: &str) {
        let remark = Element::new("text")
            .at("x", LEFT)
            .at("y", 58.0)
            .at("font-size", 11.0)
            .set("font-weight", "bold")
            .set("fill", ACCENT);
        self.push(remark.text(text));
    }

    /// Draws swatches with names, below the drawing to the right of the scale bar.
    pub(crate) fn legend(&mut self, entries: &[(String, &str, &str)]) {
        let (width, height) = self.size();
        let mut x = LEFT + round_step(self.bounds.width() / 4.0) * self.scale + 80.0;
        // The bottom of the line of names.
        let mut base = height - 19.0;
        if self.narrow {
            (x, base, self.key) = (LEFT, height + 8.0, 1);
        }
        let mut drawn = Vec::new();
        for (name, fill, stroke) in entries {
            #[expect(clippy::cast_precision_loss, reason = "names are short")]
            let advance = name.chars().count() as f64 * 6.6;
            if self.narrow && x > LEFT && x + 19.0 + advance > width - RIGHT {
                (x, base, self.key) = (LEFT, base + 17.0, self.key + 1);
            }
            drawn.push(
                Element::new("rect")
                    .at("x", x)
                    .at("y", base - 9.0)
                    .at("width", 14.0)
                    .at("height", 10.0)
                    .set("fill", fill)
                    .set("stroke", stroke),
            );
            drawn.push(
                Element::new("text")
                    .at("x", x + 19.0)
                    .at("y", base)
                    .at("font-size", 12.0)
                    .set("fill", INK)
                    .text(name),
            );
            x += 19.0 + advance + 18.0;
        }
        if self.narrow {
            let below = self.whole().1 - height;
            let ground = Element::new("rect").at("y", height).at("width", width);
            self.push(ground.at("height", below).set("fill", "#fff"));
        }
        self.elements.extend(drawn);
    }

    /// Explains the numbers in the drawing, in lines below the legend.
    pub(crate) fn key(&mut self, entries: &[String]) {
        let (width, height) = self.size();
        let (mut lines, mut wide) = (vec![String::new()], 0.0);
        for entry in entries {
            #[expect(clippy::cast_precision_loss, reason = "names are short")]
            let advance = entry.chars().count() as f64 * 6.0 + 16.0;
            if wide + advance > width - LEFT - RIGHT && wide > 0.0 {
                lines.push(String::new());
                wide = 0.0;
            }
            if let Some(line) = lines.last_mut() {
                line.push_str(&format!("{entry}\u{2003}"));
            }
            wide += advance;
        }
        if entries.is_empty() {
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "a few lines")]
        let ground = 17.0 * lines.len() as f64 + 6.0;
        let ground = Element::new("rect").at("y", height).at("width", width).at("height", ground);
        self.push(ground.set("fill", "#fff"));
        for (i, line) in lines.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a few lines")]
            let y = height + 8.0 + 17.0 * i as f64;
            let text = Element::new("text").at("x", LEFT).at("y", y).at("font-size", 11.0);
            self.push(text.set("fill", INK).text(line.trim_end()));
        }
        self.key = lines.len();
    }

    /// Returns the height of the sheet with its key (px).
    fn whole(&self) -> (f64, f64) {
        let (width, height) = self.size();
        #[expect(clippy::cast_precision_loss, reason = "a few lines")]
        let key = if self.key == 0 { 0.0 } else { 17.0 * self.key as f64 + 6.0 };
        (width, height + key)
    }

    /// Returns where a legend of one's own begins, and the height of its line (px).
    pub(crate) fn legend_at(&self) -> (f64, f64) {
        let (_, height) = self.size();
        (LEFT + round_step(self.bounds.width() / 4.0) * self.scale + 80.0, height - 23.0)
    }

    /// Returns the finished file.
    pub(crate) fn finish(self, title: &str) -> String {
        let (width, height) = self.whole();
        svg::document(width, height, title, self.elements)
    }

    /// Returns the finished file with another sheet below this one.
    pub(crate) fn finish_above(self, below: Self, title: &str) -> String {
        let ((width, height), (other_width, other_height)) = (self.whole(), below.whole());
        let moved = format!("translate(0 {})", svg::number(height));
        let group = below
            .elements
            .into_iter()
            .fold(Element::new("g").set("transform", moved), Element::child);
        let elements = self.elements.into_iter().chain([group]);
        svg::document(width.max(other_width), height + other_height, title, elements)
    }
}

fn tick(from: (f64, f64), to: (f64, f64)) -> Element {
    Element::new("path").set("d", svg::path_data([from, to], false)).set("stroke", FAINT)
}

/// Returns the largest of 1, 2, 5 times a power of ten that is not above `length`.
fn round_step(length: f64) -> f64 {
    let power = math::pow(10.0, math::log10(length.max(1e-9)).floor());
    [5.0, 2.0, 1.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|step| *step <= length * 1.000_001)
        .unwrap_or(power)
}

/// Returns round numbers from `low` to `high`, about eight of them.
fn ticks(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let step = round_step((high - low) / 5.0);
    let (first, last) = ((low / step).ceil(), (high / step + 1e-9).floor());
    #[expect(clippy::cast_possible_truncation, reason = "some ten")]
    let count = (last - first).clamp(-1.0, 1000.0) as i32;
    (0..=count).map(move |i| (first + f64::from(i)) * step)
}

/// Writes a length in metres, to the millimetre, without trailing zeros.
pub(crate) fn metres(length: f64) -> String {
    let rounded = (length * 1000.0).round() / 1000.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_ticks_are_round() {
        assert_eq!(round_step(4.7), 2.0);
        assert_eq!(round_step(0.05), 0.05);
        assert_eq!(round_step(19.0), 10.0);
        assert_eq!(ticks(-0.9, 2.1).collect::<Vec<_>>(), [-0.5, 0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(
            (metres(-0.0001), metres(0.1602), metres(18.7)),
            ("0".into(), "0.16".into(), "18.7".into())
        );
    }
}
