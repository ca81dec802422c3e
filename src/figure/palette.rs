//! The look of the n-th series: colour, dashes and marker together, so that any one of them suffices.
//!
//! Colours are those of M. Okabe and K. Ito, "Color Universal Design" (2008), ordered by contrast on white;
//! their yellow and sky blue are left out because they fade in print.

use super::svg::{Element, path_data};

/// The colour of text, axes and the first series.
pub const INK: &str = "#1a1a1a";
/// The colour of the ground.
pub const PAPER: &str = "#ffffff";
/// Our result, where the paper's stands beside it and no series must be distinguished: filled.
pub(super) const OURS: &str = "#5b9bc8";
/// The same, lighter: for what lies behind it.
pub(super) const OURS_TINT: &str = "#c3dcee";
/// The paper's number: hollow, on paper.
pub(super) const PUBLISHED: &str = "#b34700";

/// Draws the mark of a printed number at (`x`, `y`), of radius `r`, px.
pub(super) fn published_point(x: f64, y: f64, r: f64) -> Element {
    let corners = [(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)];
    let corners = corners.map(|(dx, dy)| (x + dx * r, y + dy * r));
    Element::new("path")
        .set("d", path_data(corners, true))
        .set("fill", PAPER)
        .set("stroke", PUBLISHED)
        .at("stroke-width", 1.6)
        .set("class", "paper-fill")
}

/// The look of one series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Colour as `#rrggbb`.
    pub colour: &'static str,
    /// SVG dash pattern (px); empty for a solid line.
    pub dash: &'static str,
    /// Shape of its points.
    pub marker: Marker,
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
    /// Returns the look of series `index`; colour and marker repeat at different periods, so 30 looks differ.
    pub fn of(index: usize) -> Self {
        Self {
            colour: COLOURS[index % COLOURS.len()],
            dash: DASHES[index % DASHES.len()],
            marker: MARKERS[index % MARKERS.len()],
        }
    }

    /// Returns `element` stroked in this colour.
    #[must_use]
    pub fn stroke(self, element: Element, width: f64) -> Element {
        let element = element.set("stroke", self.colour).at("stroke-width", width);
        if self.colour == INK { element.set("class", "ink-stroke") } else { element }
    }

    /// Draws the point marker of radius `r` px at (`x`, `y`) px: filled for our results, hollow for published ones.
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
}

/// Draws diagonals every `gap` px across the rectangle of `size` at `corner` (px), as the data of a path: rising,
/// falling or both.
///
/// They are drawn line by line: patterns would need identifiers, which clash in a page.
pub(super) fn hatching(
    corner: (f64, f64),
    size: (f64, f64),
    [rising, falling]: [bool; 2],
    gap: f64,
) -> String {
    let ((x, y), (width, height)) = (corner, size);
    let mut lines = String::new();
    // Diagonals x + y = c (rising) or x + height - y = c (falling), clipped to the rectangle.
    let mut diagonals = |rising: bool| {
        let mut c = gap;
        while c < width + height {
            let (from, to) = ((c - height).max(0.0), c.min(width));
            let at = |dx: f64| {
                let dy = c - dx;
                (x + dx, if rising { y + dy } else { y + height - dy })
            };
            lines.push_str(&path_data([at(from), at(to)], false));
            c += gap;
        }
    };
    if rising {
        diagonals(true);
    }
    if falling {
        diagonals(false);
    }
    lines
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
        for ways in [[true, false], [false, true], [true, true]] {
            let data = hatching((10.0, 20.0), (12.0, 33.0), ways, 6.0);
            for pair in data.split(['M', 'L']).filter(|p| !p.is_empty()) {
                let (x, y) = pair.split_once(' ').unwrap();
                let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
                assert!(
                    (10.0..=22.0).contains(&x) && (20.0..=53.0).contains(&y),
                    "{ways:?}: {pair}"
                );
            }
        }
    }
}
