//! Estimates with intervals by condition, the paper's right under ours: bars of shares, dots of means.

use super::axis::Axis;
use super::chart::{KeyItem, error_bar, key, label, rule, sheet};
use super::medium::Medium;
use super::palette::{OURS, OURS_TINT, PUBLISHED, published_point};
use super::panels::{Area, Layout, Panel, PanelLine};
use super::svg::Element;

const PITCH: f64 = 28.0;
/// Height of a bar or box (px), its middle above and the paper's mark below that of the row.
const BAR: f64 = 12.0;
const ABOVE: f64 = 4.0;
const BELOW: f64 = 7.0;
/// Room for the numbers beside the rows (px).
const BESIDE: f64 = 30.0;

/// A chart of one quantity: names at the left, a panel for each condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EstimateChart {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// What is measured, with its unit.
    pub quantity: String,
    /// What the thin lines are: `95 % interval`.
    pub interval: String,
    /// What the boxes are; empty for bars from zero.
    pub boxes: String,
    /// What the narrow boxes and their ticks are: `5 to 95 % over draw, median`; empty where there are none.
    pub band: String,
    /// What the mark of a panel is: `deadline`; empty where panels have none.
    pub mark: String,
    /// Names of the rows of every panel.
    pub names: Vec<String>,
    /// The panels.
    pub lines: Vec<PanelLine<Estimate>>,
    /// The end of all axes, such as 100 for percentages; by default each line of panels has its own.
    pub end: Option<f64>,
}

/// One row of a panel, in the unit of the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// Ours; `None` where there is nothing to show.
    pub value: Option<f64>,
    /// Low and high end of its interval.
    pub interval: Option<(f64, f64)>,
    /// Low end, middle and high end of the narrow box, which stands for the interval: of the values of a factor.
    pub band: Option<[f64; 3]>,
    /// Low and high end of the box: of the middle half of the trials.
    pub middle_half: Option<(f64, f64)>,
    /// Trials behind it, printed beside it where boxes are drawn.
    pub n: Option<u64>,
    /// The paper's.
    pub published: Option<f64>,
    /// Low and high end of the paper's interval.
    pub published_interval: Option<(f64, f64)>,
}

impl EstimateChart {
    /// Returns whether it holds no result of ours: then it would be axes alone.
    pub fn is_empty(&self) -> bool {
        self.lines.iter().flat_map(PanelLine::rows).all(|row| row.value.is_none())
    }

    /// Draws the chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let dots = !self.boxes.is_empty();
        let counts = dots && self.all_behind().is_none();
        let layout = Layout {
            names: &self.names,
            // Where the paper has no number, rows are closer.
            pitch: if self.is_compared() { PITCH } else { PITCH - 6.0 },
            beside: if counts { (BESIDE, "n") } else { (0.0, "") },
            title: &self.quantity,
            medium,
        };
        let axis = |line: &PanelLine<Estimate>, most: u32| {
            let rows = line.panels.iter().flat_map(|panel| &panel.rows);
            let values = rows.flat_map(ends).chain([0.0]);
            match self.end {
                Some(end) => Axis::covering("", [0.0, end], most.min(6)),
                // Numbers of four digits need more room than those of two.
                None => Axis::covering("", values, most.min(5)),
            }
        };
        let laid =
            layout.draw(&self.lines, axis, |area, panel| self.panel(area, panel, dots, counts));
        let (key, height) = key(self.items(dots), 12.0, laid.width - 4.0, laid.bottom);
        let bottom = laid.bottom + height + 8.0;
        sheet(laid.width, bottom, &self.title, laid.body.into_iter().chain([key]))
    }

    fn rows(&self) -> impl Iterator<Item = &Estimate> {
        self.lines.iter().flat_map(|line| &line.panels).flat_map(|panel| &panel.rows)
    }

    fn is_compared(&self) -> bool {
        self.rows().any(|row| row.published.is_some())
    }

    /// Returns the number of trials behind every row that has any, where it is the same.
    fn all_behind(&self) -> Option<u64> {
        let mut numbers = self.rows().filter(|row| row.value.is_some()).map(|row| row.n);
        let first = numbers.next()??;
        numbers.all(|n| n == Some(first)).then_some(first)
    }

    /// Describes the chart for those who cannot see it: its extremes, and how the paper's numbers compare with ours.
    pub fn in_words(&self) -> String {
        let rows: Vec<(String, &Estimate)> = self
            .lines
            .iter()
            .flat_map(|line| line.panels.iter().map(move |panel| (line, panel)))
            .flat_map(|(line, panel)| {
                let name = |name: &String| match (line.name.as_str(), panel.name.as_str()) {
                    ("", "") => name.clone(),
                    ("", one) | (one, "") => format!("{name}, {one}"),
                    (line, panel) => format!("{name}, {line}, {panel}"),
                };
                panel.rows.iter().zip(&self.names).map(move |(row, of)| (name(of), row))
            })
            .collect();
        let ours = || rows.iter().filter_map(|(name, row)| Some((name, row.value?)));
        let low = ours().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = ours().max_by(|a, b| a.1.total_cmp(&b.1));
        let (Some(low), Some(high)) = (low, high) else { return String::new() };
        let mut words = format!(
            "{} of {} cells: ours from {} ({}) to {} ({})",
            self.quantity,
            rows.len(),
            in_short(low.1),
            low.0,
            in_short(high.1),
            high.0
        );
        let compared: Vec<_> = rows
            .iter()
            .filter_map(|(name, row)| Some((name, row.value?, row.published?, row.interval?)))
            .collect();
        let inside = compared.iter().filter(|(_, _, p, (low, high))| low <= p && p <= high).count();
        let farthest =
            compared.iter().max_by(|a, b| (a.1 - a.2).abs().total_cmp(&(b.1 - b.2).abs()));
        if let Some((name, value, published, _)) = farthest {
            words.push_str(&format!(
                "; {inside} of {} printed numbers lie in our intervals, the farthest is {} against our {} ({name})",
                compared.len(),
                in_short(*published),
                in_short(*value)
            ));
        }
        words + "."
    }

    fn panel(
        &self,
        area: &Area<'_>,
        panel: &Panel<Estimate>,
        dots: bool,
        counts: bool,
    ) -> Vec<Element> {
        let mut elements = Vec::new();
        let compared = self.is_compared();
        if let Some(mark) = panel.mark.filter(|mark| *mark <= area.axis.high) {
            let (x, bottom) = (area.x(mark), area.y(panel.rows.len()) - area.pitch / 2.0);
            let line = rule((x, area.top - 2.0), (x, bottom + 2.0), 1.4, 0.8);
            elements.push(line.set("stroke-dasharray", "4 3"));
        }
        for (i, row) in panel.rows.iter().enumerate() {
            let y = area.y(i) + if compared { 0.0 } else { ABOVE };
            elements.extend(draw(area, y, row, dots));
            if let (true, Some(n)) = (counts, row.n) {
                let x = area.right + BESIDE;
                elements
                    .push(label(x, area.y(i) + 4.5, "end", &n.to_string()).set("opacity", "0.75"));
            }
        }
        elements
    }

    fn items(&self, dots: bool) -> Vec<KeyItem> {
        let rows = || self.rows();
        let mut mark = Element::new("g");
        let banded = !self.band.is_empty();
        if dots {
            if banded {
                for part in band([-12.0, 3.0, 12.0], 0.0) {
                    mark.push(part);
                }
            } else {
                mark.push(spread(-12.0, 12.0, 0.0));
                mark.push(whisker(-8.0, 8.0, 0.0));
            }
            mark.push(dot(0.0, 0.0));
        } else {
            mark.push(bar(-14.0, 6.0, 0.0));
            if banded {
                for part in band([-4.0, 4.0, 13.0], 0.0) {
                    mark.push(part);
                }
            } else {
                mark.push(whisker(-1.0, 13.0, 0.0));
            }
        }
        let mut ours = match (dots, banded) {
            (false, false) => format!("ours, {}", self.interval),
            (true, false) => format!("ours: mean, {}, {}", self.interval, self.boxes),
            (false, true) => format!("ours, {}", self.band),
            (true, true) => format!("ours: mean, {}", self.band),
        };
        if let Some(n) = self.all_behind() {
            ours.push_str(&format!(", n = {n} each"));
        }
        let mut items = vec![KeyItem { mark, text: ours }];
        if rows().any(|row| row.published.is_some()) {
            let spread = rows().any(|row| row.published_interval.is_some());
            let mut mark = Element::new("g");
            if spread {
                mark.push(published_whisker(-12.0, 12.0, 0.0));
            }
            let text =
                if spread { format!("paper, {}", self.interval) } else { "paper".to_owned() };
            items.push(KeyItem { mark: mark.child(published_point(0.0, 0.0, 4.2)), text });
        }
        if !self.mark.is_empty() {
            let mark = rule((0.0, -8.0), (0.0, 8.0), 1.4, 0.8).set("stroke-dasharray", "4 3");
            items.push(KeyItem { mark, text: self.mark.clone() });
        }
        items
    }
}

/// Writes three digits at most, which suffice.
fn in_short(value: f64) -> String {
    if value.abs() < 10.0 {
        format!("{}", (value * 10.0).round() / 10.0)
    } else {
        format!("{value:.0}")
    }
}

/// Returns everything that a row's axis must reach.
fn ends(row: &Estimate) -> Vec<f64> {
    let intervals = [row.interval, row.middle_half, row.published_interval];
    let ends = intervals.into_iter().flatten().flat_map(|(low, high)| [low, high]);
    ends.chain(row.band.into_iter().flatten()).chain(row.value).chain(row.published).collect()
}

fn draw(area: &Area<'_>, y: f64, row: &Estimate, dots: bool) -> Vec<Element> {
    let mut elements = Vec::new();
    // No axis begins below zero: an interval of a mean that does is cut.
    let at = |(low, high): (f64, f64)| (area.x(low.max(area.axis.low)), area.x(high));
    let (above, below) = (y - ABOVE, y + BELOW);
    match row.value {
        Some(value) if dots => {
            if let Some((low, high)) = row.middle_half.map(at) {
                elements.push(spread(low, high, above));
            }
            // What the dot hides anyway would only fray it.
            if let Some((low, high)) = row.interval.map(at).filter(|(l, h)| h - l > 10.0) {
                elements.push(whisker(low, high, above));
            }
            elements.extend(
                row.band.map(|ends| band(ends.map(|at| area.x(at)), above)).into_iter().flatten(),
            );
            elements.push(dot(area.x(value), above));
        }
        Some(value) => {
            elements.push(bar(area.x(0.0), area.x(value), above));
            if let Some((low, high)) = row.interval.map(at) {
                elements.push(whisker(low, high, above));
            }
            elements.extend(
                row.band.map(|ends| band(ends.map(|at| area.x(at)), above)).into_iter().flatten(),
            );
        }
        None => elements.push(label(area.x(area.axis.low) + 6.0, above + 4.5, "start", "–")),
    }
    if let Some((low, high)) = row.published_interval.map(at) {
        elements.push(published_whisker(low, high, below));
    }
    if let Some(value) = row.published {
        elements.push(published_point(area.x(value), below, 4.2));
    }
    elements
}

fn bar(from: f64, to: f64, y: f64) -> Element {
    Element::new("rect")
        .at("x", from.min(to))
        .at("y", y - BAR / 2.0)
        .at("width", (to - from).abs())
        .at("height", BAR)
        .set("fill", OURS)
}

/// Draws a narrow box from the first to the last, and a tick at the middle one: light on a bar, lined in ink on the ground, so that
/// either is seen without colour.
fn band([low, middle, high]: [f64; 3], y: f64) -> [Element; 2] {
    let height = BAR / 2.0;
    let span = Element::new("rect")
        .at("x", low)
        .at("y", y - height / 2.0)
        .at("width", (high - low).max(0.0))
        .at("height", height)
        .set("fill", OURS_TINT)
        .set("stroke", super::INK)
        .set("class", "ink-stroke")
        .at("stroke-width", 1.0);
    let tick = rule((middle, y - height / 2.0 - 2.0), (middle, y + height / 2.0 + 2.0), 2.0, 1.0);
    [span, tick]
}

fn spread(from: f64, to: f64, y: f64) -> Element {
    Element::new("rect")
        .at("x", from)
        .at("y", y - BAR / 2.0)
        .at("width", (to - from).max(0.0))
        .at("height", BAR)
        .set("fill", OURS_TINT)
}

fn dot(x: f64, y: f64) -> Element {
    Element::new("circle").at("cx", x).at("cy", y).at("r", 4.0).set("fill", OURS)
}

fn whisker(from: f64, to: f64, y: f64) -> Element {
    Element::new("path")
        .set("d", error_bar((from, y), (to, y), 3.5))
        .set("fill", "none")
        .set("stroke", super::INK)
        .set("class", "ink-stroke")
        .at("stroke-width", 1.5)
}

fn published_whisker(from: f64, to: f64, y: f64) -> Element {
    Element::new("path")
        .set("d", error_bar((from, y), (to, y), 2.0))
        .set("fill", "none")
        .set("stroke", PUBLISHED)
        .at("stroke-width", 1.1)
}
