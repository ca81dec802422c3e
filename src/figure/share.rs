//! Shares that add up to a whole by condition, the paper's in a thin bar right under ours.

use super::axis::Axis;
use super::chart::{KeyItem, key, label, sheet};
use super::medium::Medium;
use super::palette::{INK, PAPER, hatching};
use super::panels::{Area, Layout, Panel, PanelLine};
use super::svg::Element;

const PITCH: f64 = 27.0;
/// Heights of our bar and of the paper's (px), and the offsets of their middles from that of the row.
const OURS: (f64, f64) = (13.0, -4.0);
const PUBLISHED: (f64, f64) = (6.0, 7.0);

/// A chart of shares: names at the left, a panel for each condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShareChart {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// What the shares are of: `trials (%)`.
    pub quantity: String,
    /// What the parts are, in the order in which they are stacked.
    pub parts: Vec<Part>,
    /// Names of the rows of every panel.
    pub names: Vec<String>,
    /// The panels.
    pub lines: Vec<PanelLine<Shares>>,
}

/// A part of the whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// What it is.
    pub name: String,
    /// Its look.
    pub look: Look,
}

/// The look of a part. Neighbours differ in lightness or hatching too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Look {
    /// Blue of middle lightness: the desired end.
    #[default]
    Good,
    /// Pale yellow: time was short.
    Slow,
    /// The same, hatched: time was short, and nothing came of it.
    Idle,
    /// Dark red, cross-hatched in white.
    Bad,
    /// White, outlined.
    Other,
}

impl Look {
    const fn fill(self) -> &'static str {
        match self {
            Self::Good => "#5b9bc8",
            Self::Slow | Self::Idle => "#f6dc9a",
            Self::Bad => "#8c2d04",
            Self::Other => PAPER,
        }
    }

    /// Returns whether lines rise, whether lines fall, and their colour.
    const fn hatch(self) -> Option<([bool; 2], &'static str)> {
        match self {
            Self::Good | Self::Slow | Self::Other => None,
            Self::Idle => Some(([true, false], INK)),
            Self::Bad => Some(([false, true], PAPER)),
        }
    }

    /// Draws a bar from `x` on, around `y`, px.
    fn bar(self, x: f64, width: f64, y: f64, height: f64) -> Element {
        let top = y - height / 2.0;
        let rectangle = |element: Element| {
            element.at("x", x).at("y", top).at("width", width).at("height", height)
        };
        let mut group =
            Element::new("g").child(rectangle(Element::new("rect")).set("fill", self.fill()));
        if let Some((ways, colour)) = self.hatch() {
            let lines = hatching((x, top), (width, height), ways, 5.0);
            if !lines.is_empty() {
                let lines = Element::new("path").set("d", lines).set("fill", "none");
                group.push(lines.set("stroke", colour).at("stroke-width", 0.9));
            }
        }
        let outline = rectangle(Element::new("rect")).set("fill", "none").set("stroke", INK);
        group.child(outline.at("stroke-width", 0.7))
    }
}

/// One row of a panel, in percent, in the order of the parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shares {
    /// Ours; empty where there is nothing to show.
    pub ours: Vec<f64>,
    /// The paper's; empty where it prints none.
    pub published: Vec<f64>,
}

impl ShareChart {
    /// Returns whether it holds no result of ours: then it would be axes alone.
    pub fn is_empty(&self) -> bool {
        self.lines.iter().flat_map(PanelLine::rows).all(|row| row.ours.is_empty())
    }

    /// Draws the chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let layout = Layout {
            names: &self.names,
            pitch: PITCH,
            beside: (0.0, ""),
            title: &self.quantity,
            medium,
        };
        let axis = |_: &PanelLine<Shares>, most: u32| Axis::covering("", [0.0, 100.0], most.min(6));
        let laid = layout.draw(&self.lines, axis, |area, panel| self.panel(area, panel));
        let (key, height) = key(self.items(), 12.0, laid.width - 4.0, laid.bottom);
        let bottom = laid.bottom + height + 8.0;
        sheet(laid.width, bottom, &self.title, laid.body.into_iter().chain([key]))
    }

    /// Describes the chart for those who cannot see it: how far each part goes.
    pub fn in_words(&self) -> String {
        let mut words = Vec::new();
        for (i, part) in self.parts.iter().enumerate() {
            let shares = self.lines.iter().flat_map(|line| {
                line.panels.iter().flat_map(move |panel| {
                    let place = move |name: &String| {
                        let place = [name, &line.name, &panel.name].map(String::as_str);
                        place.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(", ")
                    };
                    let rows = panel.rows.iter().zip(&self.names);
                    rows.filter_map(move |(row, name)| Some((place(name), *row.ours.get(i)?)))
                })
            });
            if let Some((place, share)) = shares.max_by(|a, b| a.1.total_cmp(&b.1)) {
                words.push(format!("{} at most {share:.0} % ({place})", part.name));
            }
        }
        if words.is_empty() { String::new() } else { format!("{}.", words.join("; ")) }
    }

    fn panel(&self, area: &Area<'_>, panel: &Panel<Shares>) -> Vec<Element> {
        let mut elements = Vec::new();
        for (i, row) in panel.rows.iter().enumerate() {
            let y = area.y(i);
            if row.ours.is_empty() {
                elements.push(label(area.left + 6.0, y + 0.5, "start", "–"));
            }
            for (shares, (height, middle)) in [(&row.ours, OURS), (&row.published, PUBLISHED)] {
                let mut below = 0.0;
                for (share, part) in shares.iter().zip(&self.parts) {
                    let (from, to) = (area.x(below), area.x((below + share).min(100.0)));
                    if to - from > 0.01 {
                        elements.push(part.look.bar(from, to - from, y + middle, height));
                    }
                    below += share;
                }
            }
        }
        elements
    }

    fn items(&self) -> Vec<KeyItem> {
        let mut items: Vec<_> = self
            .parts
            .iter()
            .map(|part| KeyItem {
                mark: part.look.bar(-11.0, 22.0, 0.0, OURS.0),
                text: part.name.clone(),
            })
            .collect();
        let rows = || self.lines.iter().flat_map(|line| &line.panels).flat_map(|panel| &panel.rows);
        if rows().any(|row| !row.published.is_empty()) {
            let mut mark = Element::new("g");
            for (height, middle) in [OURS, PUBLISHED] {
                mark.push(Look::Other.bar(-11.0, 22.0, middle, height));
            }
            items.push(KeyItem { mark, text: "thick: ours, thin: paper".to_owned() });
        }
        items
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the relative luminance by WCAG 2.
    fn luminance(colour: &str) -> f64 {
        let channel = |i: usize| {
            let value = f64::from(u8::from_str_radix(&colour[i..i + 2], 16).unwrap()) / 255.0;
            let base = (value + 0.055) / 1.055;
            if value <= 0.040_45 { value / 12.92 } else { crate::math::pow(base, 2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    #[test]
    fn any_two_parts_differ_in_grey_or_in_hatching() {
        let looks = [Look::Good, Look::Slow, Look::Idle, Look::Bad, Look::Other];
        for (i, a) in looks.iter().enumerate() {
            for b in &looks[..i] {
                let (x, y) = (luminance(a.fill()), luminance(b.fill()));
                let contrast = (x.max(y) + 0.05) / (x.min(y) + 0.05);
                let told_apart = contrast >= 1.3 || a.hatch() != b.hatch();
                assert!(told_apart, "{a:?} and {b:?}: {contrast}");
            }
        }
    }
}
