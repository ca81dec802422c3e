//! The common parts of charts: a plot with two axes, and a key that flows under it.

use super::axis::Axis;
use super::palette::{INK, PAPER};
use super::svg::{self, Element, path_data};

/// Text size of labels (px).
pub(super) const TEXT: f64 = 13.0;

/// Converts a count to a number of px or positions.
pub(super) fn real(n: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts of marks in a drawing are small")]
    let real = n as f64;
    real
}

/// Estimates how wide `text` runs at `size` px in a sans-serif face: layout must not ask for a font.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let width = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | 'I' => 0.26,
        ' ' | 't' | 'f' | 'r' | '(' | ')' | '-' | '/' => 0.34,
        'm' | 'w' | 'M' | 'W' | '%' => 0.86,
        'A'..='Z' => 0.69,
        _ => 0.56,
    };
    text.chars().map(width).sum::<f64>() * size
}

/// Draws the text in ink, its baseline at (`x`, `y`); `anchor` is start, middle or end.
pub(super) fn label(x: f64, y: f64, anchor: &str, text: &str) -> Element {
    Element::new("text")
        .at("x", x)
        .at("y", y)
        .set("text-anchor", anchor)
        .at("font-size", TEXT)
        .set("fill", INK)
        .set("class", "ink-fill")
        .text(text)
}

/// Draws a line in ink between two points (px).
pub(super) fn rule(from: (f64, f64), to: (f64, f64), width: f64, opacity: f64) -> Element {
    let line = Element::new("path")
        .set("d", path_data([from, to], false))
        .set("fill", "none")
        .set("stroke", INK)
        .set("class", "ink-stroke")
        .at("stroke-width", width);
    if opacity < 1.0 { line.at("stroke-opacity", opacity) } else { line }
}

/// Draws a bar with two caps, each reaching `cap` px to either side, as the data of a path.
pub(super) fn error_bar(from: (f64, f64), to: (f64, f64), cap: f64) -> String {
    let (dx, dy) = if from.0 == to.0 { (cap, 0.0) } else { (0.0, cap) };
    let across = |(x, y): (f64, f64)| path_data([(x - dx, y - dy), (x + dx, y + dy)], false);
    path_data([from, to], false) + &across(from) + &across(to)
}

/// The rectangle in which data are drawn (px), and its axes.
pub(super) struct Plot {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x: Axis,
    pub(super) y: Axis,
}

impl Plot {
    /// Returns the horizontal position of the value `x` (px).
    pub(super) fn px(&self, x: f64) -> f64 {
        self.x.position(x, self.left, self.right)
    }

    /// Returns the vertical position of the value `y` (px, downwards).
    pub(super) fn py(&self, y: f64) -> f64 {
        self.y.position(y, self.bottom, self.top)
    }

    /// Returns the room (px) that the tick labels and title of the axis `y` need on the left.
    pub(super) fn left_margin(y: &Axis) -> f64 {
        y.ticks.iter().map(|t| text_width(&t.label, TEXT)).fold(0.0, f64::max) + 40.0
    }

    /// Draws the horizontal axis: ticks, labels and title.
    pub(super) fn x_axis(&self) -> Element {
        let mut group = Element::new("g");
        for tick in &self.x.ticks {
            let x = self.px(tick.value);
            group.push(rule((x, self.bottom), (x, self.bottom + 5.0), 1.0, 1.0));
            group.push(label(x, self.bottom + 19.0, "middle", &tick.label));
        }
        group.push(rule((self.left, self.bottom), (self.right, self.bottom), 1.0, 1.0));
        group.child(self.x_title(40.0))
    }

    /// Draws the title of the horizontal axis, `below` px under it.
    pub(super) fn x_title(&self, below: f64) -> Element {
        let middle = f64::midpoint(self.left, self.right);
        label(middle, self.bottom + below, "middle", &self.x.title)
    }

    /// Draws the vertical axis: gridlines, labels and title.
    pub(super) fn y_axis(&self) -> Element {
        let mut group = Element::new("g");
        for tick in &self.y.ticks {
            let y = self.py(tick.value);
            group.push(rule((self.left, y), (self.right, y), 1.0, 0.15));
            group.push(label(self.left - 8.0, y + 4.5, "end", &tick.label));
        }
        let (x, y) = (16.0, f64::midpoint(self.top, self.bottom));
        let turn = format!("rotate(-90 {} {})", svg::number(x), svg::number(y));
        group.child(label(x, y, "middle", &self.y.title).set("transform", turn))
    }
}

/// One entry of a key: a mark drawn around (0, 0), at most 24 px wide, and its meaning.
pub(super) struct KeyItem {
    pub(super) mark: Element,
    pub(super) text: String,
}

/// Breaks `text` where words end into lines of at most `width` px, where words allow that.
pub(super) fn broken(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), TEXT) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Draws the key, wrapped between `left` and `right` px from `top` px on, and returns it with its height (px).
pub(super) fn key(items: Vec<KeyItem>, left: f64, right: f64, top: f64) -> (Element, f64) {
    let mut group = Element::new("g");
    let (mut x, mut row) = (left, 0.0);
    let rows = if items.is_empty() { 0.0 } else { 1.0 };
    for KeyItem { mark, text } in items {
        let width = 36.0 + text_width(&text, TEXT) + 14.0;
        // What fits on no line is broken.
        let lines = if width - 14.0 > right - left {
            broken(&text, right - left - 36.0)
        } else {
            vec![text]
        };
        if x > left && x + width > right {
            (x, row) = (left, row + 1.0);
        }
        let y = top + row * 20.0 + 10.0;
        let place = format!("translate({} {})", svg::number(x + 14.0), svg::number(y));
        group.push(Element::new("g").set("transform", place).child(mark));
        for (i, line) in lines.iter().enumerate() {
            group.push(label(x + 32.0, y + 4.5 + 17.0 * real(i), "start", line));
        }
        x += width;
        row += real(lines.len() - 1) * 0.85;
    }
    (group, (row + rows) * 20.0)
}

/// Draws a whole chart on paper-coloured ground.
pub(super) fn sheet(
    width: f64,
    height: f64,
    title: &str,
    body: impl IntoIterator<Item = Element>,
) -> String {
    let ground = Element::new("rect")
        .at("width", width)
        .at("height", height)
        .set("fill", PAPER)
        .set("class", "paper-fill");
    svg::document(width, height, title, std::iter::once(ground).chain(body))
}

/// Spreads `wanted` positions, moved as little as is simple so that neighbours keep `gap` and all lie in `low`..=`high`
/// where they can; in the order given.
pub(super) fn spread(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]).then(a.cmp(&b)));
    let mut placed = wanted.to_vec();
    let mut floor = low;
    for &i in &order {
        placed[i] = placed[i].max(floor);
        floor = placed[i] + gap;
    }
    let mut ceiling = high;
    for &i in order.iter().rev() {
        placed[i] = placed[i].min(ceiling);
        ceiling = placed[i] - gap;
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_spread_without_leaving_the_plot() {
        assert_eq!(spread(&[50.0, 50.0, 10.0], 15.0, 0.0, 100.0), [50.0, 65.0, 10.0]);
        assert_eq!(spread(&[99.0, 98.0], 15.0, 0.0, 100.0), [100.0, 85.0]);
        assert_eq!(spread(&[], 15.0, 0.0, 100.0), Vec::<f64>::new());
    }

    #[test]
    fn a_key_wraps_into_rows() {
        let item = || KeyItem { mark: Element::new("g"), text: "a label of some length".into() };
        assert_eq!(key(vec![], 0.0, 300.0, 0.0).1, 0.0);
        assert_eq!(key(vec![item()], 0.0, 300.0, 0.0).1, 20.0);
        assert_eq!(key(vec![item(), item(), item()], 0.0, 300.0, 0.0).1, 60.0);
    }
}
