//! How the n-th series looks: colour, dashes, marker and hatching together, so that any one of them suffices.
//!
//! Colours are those of M. Okabe and K. Ito, "Color Universal Design" (2008), ordered by contrast on white;
//! their yellow and sky blue are left out because they fade in print.

use super::svg::{Element, path_data};

/// The colour of text, axes and the first series.
pub const INK: &str = "#1a1a1a";
/// The colour of the ground.
pub const PAPER: &str = "#ffffff";

/// The look of one series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Colour as `#rrggbb`.
    pub colour: &'static str,
    /// SVG dash pattern (px); empty for a solid line.
    pub dash: &'static str,
    /// Shape of its points.
    pub marker: Marker,
    /// Which hatching its bars have.
    hatch: usize,
}

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A circle.
    Disc,
    /// A square.
    Square,
    /// A triangle, point up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle, point down.
    Wedge,
}

const COLOURS: [&str; 6] = [INK, "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"];
const DASHES: [&str; 6] = ["", "7 3", "2 3", "10 3 2 3", "12 4", "4 2 1 2"];
const MARKERS: [Marker; 5] =
    [Marker::Disc, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Wedge];

impl Style {
    /// The look of series `index`; colour and marker repeat at different periods, so 30 looks differ.
    pub fn of(index: usize) -> Self {
        Self {
            colour: COLOURS[index % COLOURS.len()],
            dash: DASHES[index % DASHES.len()],
            marker: MARKERS[index % MARKERS.len()],
            hatch: index,
        }
    }

    /// `element` stroked in this colour.
    #[must_use]
    pub fn stroke(self, element: Element, width: f64) -> Element {
        let element = element.set("stroke", self.colour).at("stroke-width", width);
        if self.colour == INK { element.set("class", "ink-stroke") } else { element }
    }

    /// The point marker of radius `r` px at (`x`, `y`) px: filled for what we found, hollow for what was
    /// published.
    pub fn point(self, x: f64, y: f64, r: f64, hollow: bool) -> Element {
        let shape = |corners: &[(f64, f64)]| {
            let corners = corners.iter().map(|(dx, dy)| (x + dx * r, y + dy * r));
            Element::new("path").set("d", path_data(corners, true))
        };
        let shape = match self.marker {
            Marker::Disc => Element::new("circle").at("cx", x).at("cy", y).at("r", r),
            Marker::Square => shape(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Marker::Triangle => shape(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]),
            Marker::Diamond => shape(&[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)]),
            Marker::Wedge => shape(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]),
        };
        let ink = self.colour == INK;
        let (fill, stroke, class) = match (hollow, ink) {
            (true, true) => (PAPER, INK, "paper-fill ink-stroke"),
            (true, false) => (PAPER, self.colour, "paper-fill"),
            (false, true) => (INK, PAPER, "ink-fill paper-stroke"),
            (false, false) => (self.colour, PAPER, "paper-stroke"),
        };
        shape
            .set("fill", fill)
            .set("stroke", stroke)
            .at("stroke-width", if hollow { 1.6 } else { 0.8 })
            .set("class", class)
    }

    /// A bar from (`x`, `y`), `width` by `height` px: a tint under a hatching and an outline.
    ///
    /// The hatching is drawn line by line: patterns would need identifiers, which clash in a page.
    pub fn bar(self, x: f64, y: f64, width: f64, height: f64) -> Element {
        let rectangle = |element: Element| {
            element.at("x", x).at("y", y).at("width", width).at("height", height)
        };
        let fill = rectangle(Element::new("rect"))
            .set("fill", self.colour)
            .set("fill-opacity", if self.hatch.is_multiple_of(2) { "0.55" } else { "0.25" });
        let fill = if self.colour == INK { fill.set("class", "ink-fill") } else { fill };
        let outline = self.stroke(rectangle(Element::new("rect")).set("fill", "none"), 1.2);
        let mut lines = String::new();
        let mut add = |a: (f64, f64), b: (f64, f64)| lines.push_str(&path_data([a, b], false));
        let gap = 6.0;
        // Diagonals x + y = c (rising) or y - x = c (falling), clipped to the bar.
        let mut diagonals = |rising: bool| {
            let mut c = gap;
            while c < width + height {
                let (from, to) = ((c - height).max(0.0), c.min(width));
                let at = |dx: f64| {
                    let dy = c - dx;
                    (x + dx, if rising { y + dy } else { y + height - dy })
                };
                add(at(from), at(to));
                c += gap;
            }
        };
        match self.hatch % 5 {
            1 => diagonals(true),
            3 => diagonals(false),
            4 => {
                diagonals(true);
                diagonals(false);
            }
            2 => {
                let mut dy = gap;
                while dy < height {
                    add((x, y + height - dy), (x + width, y + height - dy));
                    dy += gap;
                }
            }
            _ => {}
        }
        let mut group = Element::new("g").child(fill);
        if !lines.is_empty() {
            group.push(self.stroke(Element::new("path").set("d", lines).set("fill", "none"), 0.8));
        }
        group.child(outline)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_series_look_different_and_neighbours_differ_in_everything() {
        let looks: Vec<_> =
            (0..30).map(|i| (Style::of(i).colour, format!("{:?}", Style::of(i).marker))).collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "series {i} repeats an earlier look");
        }
        let (a, b) = (Style::of(0), Style::of(1));
        assert!(a.colour != b.colour && a.dash != b.dash && a.marker != b.marker);
    }

    #[test]
    fn hatching_stays_within_its_bar() {
        for index in 0..5 {
            let text = Style::of(index).bar(10.0, 20.0, 12.0, 33.0).into_string();
            let parsed = roxmltree::Document::parse(&text).unwrap();
            let data = parsed.descendants().filter_map(|n| n.attribute("d"));
            for pair in data.flat_map(|d| d.split(['M', 'L'])).filter(|p| !p.is_empty()) {
                let (x, y) = pair.split_once(' ').unwrap();
                let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
                assert!(
                    (10.0..=22.0).contains(&x) && (20.0..=53.0).contains(&y),
                    "{index}: {pair}"
                );
            }
        }
    }
}
