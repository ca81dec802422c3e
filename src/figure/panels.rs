//! Small multiples: lines of panels that share their rows, which are named once at the left, and an axis under each line.
//!
//! The contents of the rows are up to the chart: [`super::EstimateChart`] or [`super::ShareChart`].

use super::axis::Axis;
use super::chart::{TEXT, label, real, rule, text_width};
use super::medium::Medium;
use super::svg::Element;

/// Panels beside one another at most; more go to the next line.
const ABREAST: usize = 4;
/// Width (px) of a panel with others beside it, and of one alone.
const PANEL: f64 = 150.0;
const ALONE: f64 = 300.0;
/// The least width (px) of a panel on paper.
const LEAST: f64 = 84.0;
/// Space between panels (px): the last label of one axis stands clear of the first of the next.
const GAP: f64 = 26.0;
/// Space (px) above the rows for the names of the panels, and below for the axis.
const HEAD: f64 = 24.0;
const FOOT: f64 = 30.0;

/// Some panels with the same axis, those of one value of a factor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PanelLine<R> {
    /// What they have in common: `start A`; empty where there is but one line.
    pub name: String,
    /// The panels from left to right.
    pub panels: Vec<Panel<R>>,
}

impl<R> PanelLine<R> {
    /// Returns the rows of all its panels.
    pub fn rows(&self) -> impl Iterator<Item = &R> {
        self.panels.iter().flat_map(|panel| &panel.rows)
    }
}

/// One panel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel<R> {
    /// What it shows: `deadline 680 s`.
    pub name: String,
    /// One row for each name at the left.
    pub rows: Vec<R>,
    /// A value with which everything here is compared, such as the deadline of these trials.
    pub mark: Option<f64>,
}

/// Where a panel's rows are drawn, px.
pub(super) struct Area<'a> {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) pitch: f64,
    pub(super) axis: &'a Axis,
}

impl Area<'_> {
    /// Returns the horizontal position of `value`.
    pub(super) fn x(&self, value: f64) -> f64 {
        self.axis.position(value, self.left, self.right)
    }

    /// Returns the vertical position of the middle of row `index`.
    pub(super) fn y(&self, index: usize) -> f64 {
        self.top + self.pitch * (real(index) + 0.5)
    }
}

/// The layout of the lines.
pub(super) struct Layout<'a> {
    /// Names of the rows.
    pub(super) names: &'a [String],
    /// Height of a row (px).
    pub(super) pitch: f64,
    /// Room right of each panel (px), for what is written beside its rows, and what stands above it.
    pub(super) beside: (f64, &'a str),
    /// Title of the axes, with their unit.
    pub(super) title: &'a str,
    /// What it is laid out for.
    pub(super) medium: Medium,
}

/// The drawn lines.
pub(super) struct Laid {
    pub(super) body: Vec<Element>,
    pub(super) width: f64,
    /// Where the next thing below may begin (px).
    pub(super) bottom: f64,
}

impl Layout<'_> {
    /// Draws `lines`, each with the axis that `axis` gives, of so many ticks at most, and the rows with which `draw` fills a panel. The widest
    /// name sets the width of the panels; then each line is drawn from the top down: names, ticks, rows, rule.
    pub(super) fn draw<R>(
        &self,
        lines: &[PanelLine<R>],
        axis: impl Fn(&PanelLine<R>, u32) -> Axis,
        draw: impl Fn(&Area<'_>, &Panel<R>) -> Vec<Element>,
    ) -> Laid {
        let abreast =
            lines.iter().map(|line| line.panels.len()).max().unwrap_or(1).clamp(1, ABREAST);
        let named = lines.iter().flat_map(|line| &line.panels).map(|panel| panel.name.as_str());
        let widest = named.map(|name| text_width(name, TEXT)).fold(0.0, f64::max);
        let head = |line: &PanelLine<R>| {
            let named =
                !line.name.is_empty() || line.panels.iter().any(|panel| !panel.name.is_empty());
            if named || self.beside.0 > 0.0 { HEAD } else { 4.0 }
        };
        let names = self.names.iter().map(|name| text_width(name, TEXT));
        let heads = lines.iter().map(|line| text_width(&line.name, TEXT) * 1.1);
        let (room, gap) = if self.medium == Medium::Screen { (24.0, GAP) } else { (16.0, 20.0) };
        let left = names.chain(heads).fold(0.0, f64::max).max(40.0) + room;
        let beside = self.beside.0;
        // No name runs into the next, nor into what stands above the numbers beside the rows.
        let (abreast, panel, width) = match self.medium.width() {
            None => {
                let panel = if abreast == 1 { ALONE } else { PANEL }.max(widest + 8.0);
                (abreast, panel, left + (panel + beside + GAP) * real(abreast) - GAP + 22.0)
            }
            Some(width) => {
                let each = |n: usize| (width - 22.0 - left + gap) / real(n) - beside - gap;
                // Beside a name there is what stands above the numbers.
                let named = widest + 8.0 - (beside - 14.0).max(0.0);
                let fits = |n: &usize| each(*n) >= named.max(LEAST);
                let abreast = (1..=abreast).rev().find(fits).unwrap_or(1);
                (abreast, each(abreast), width)
            }
        };
        let step = panel + beside + gap;
        let most = match self.medium {
            Medium::Screen => u32::MAX,
            // Labels of four digits stand apart.
            Medium::Paper { .. } => {
                (2..6).rev().find(|n| f64::from(*n) * 38.0 <= panel).map_or(3, |n| n + 1)
            }
        };
        let height = self.pitch * real(self.names.len());
        let mut body = Vec::new();
        let mut y = 8.0;
        for line in lines {
            let axis = axis(line, most);
            for (i, panels) in line.panels.chunks(abreast).enumerate() {
                if i == 0 && !line.name.is_empty() {
                    let name = label(left - 12.0, y + 15.0, "end", &line.name);
                    body.push(name.set("font-weight", "bold"));
                }
                let top = y + head(line);
                for (row, name) in self.names.iter().enumerate() {
                    let middle = top + self.pitch * (real(row) + 0.5);
                    body.push(label(left - 12.0, middle + 4.5, "end", name));
                }
                for (column, shown) in panels.iter().enumerate() {
                    let from = left + step * real(column);
                    let area = Area {
                        left: from,
                        right: from + panel,
                        top,
                        pitch: self.pitch,
                        axis: &axis,
                    };
                    let bottom = top + height;
                    if !shown.name.is_empty() {
                        body.push(label(from, y + 15.0, "start", &shown.name));
                    }
                    if beside > 0.0 {
                        let x = area.right + beside;
                        body.push(label(x, y + 15.0, "end", self.beside.1).set("opacity", "0.75"));
                    }
                    body.extend(ticks(&area, bottom));
                    body.extend(draw(&area, shown));
                    body.push(rule((from, top - 2.0), (from, bottom + 2.0), 1.2, 1.0));
                }
                y = top + height + FOOT;
            }
            y += 2.0;
        }
        let middle = f64::midpoint(left, width - 22.0);
        body.push(label(middle, y + 10.0, "middle", self.title));
        Laid { body, width, bottom: y + 22.0 }
    }
}

fn ticks(area: &Area<'_>, bottom: f64) -> Vec<Element> {
    let mut elements = Vec::new();
    for tick in &area.axis.ticks {
        let x = area.x(tick.value);
        elements.push(rule((x, area.top - 2.0), (x, bottom + 2.0), 1.0, 0.15));
        elements.push(label(x, bottom + 17.0, "middle", &tick.label));
    }
    elements
}
