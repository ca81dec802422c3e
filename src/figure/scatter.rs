//! The paper's values against ours, with the line of equality.

use super::axis::Axis;
use super::chart::{KeyItem, Plot, TEXT, error_bar, key, label, rule, sheet, text_width};
use super::medium::Medium;
use super::palette::Style;
use super::svg::{Element, path_data};

/// Side of the square (px), and the longest on paper.
const SIDE: f64 = 390.0;
const LARGE: f64 = 520.0;
/// Height of a line of text (px).
const LINE: f64 = 17.0;
/// Radius of a point (px).
const RADIUS: f64 = 4.5;

/// A chart of published values (across) against ours (up).
#[derive(Debug, Clone, Default)]
pub struct Scatter {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// What both axes measure, with its unit: `distance at 90 % coverage (m)`.
    pub quantity: String,
    /// Names of the groups of points, in the order of their looks.
    pub groups: Vec<String>,
    /// The points.
    pub points: Vec<ScatterPoint>,
    /// What the thin lines are: `95 % intervals`.
    pub intervals: String,
    /// Whether equal steps are equal ratios.
    pub logarithmic: bool,
    /// An end that the axes reach in any case, such as 100 for percentages.
    pub end: Option<f64>,
    /// Lines of text for a corner without points: how many, how well they agree.
    pub notes: Vec<String>,
}

/// One cell of a table, twice.
#[derive(Debug, Clone, Default)]
pub struct ScatterPoint {
    /// Index of its group.
    pub group: usize,
    /// Its name, shown on pointing at it.
    pub name: String,
    /// The paper's value.
    pub published: f64,
    /// Low and high end of the paper's interval.
    pub published_interval: Option<(f64, f64)>,
    /// Our value.
    pub ours: f64,
    /// Low and high end of our interval.
    pub ours_interval: Option<(f64, f64)>,
    /// A label beside it, where there is room; empty for most.
    pub label: String,
}

/// A rectangle that is taken: left, top, right, bottom (px).
type Taken = (f64, f64, f64, f64);

impl Scatter {
    /// Returns whether it holds no result of ours: then it would be axes alone.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Draws the chart as the text of an SVG file: grid, axes and the line of equality, error bars, points, notes, then
    /// labels where there is room.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it, the square in the middle where that is wider.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let shown = |v: f64| v.is_finite() && (!self.logarithmic || v > 0.0);
        let points: Vec<&ScatterPoint> =
            self.points.iter().filter(|p| shown(p.published) && shown(p.ours)).collect();
        let values: Vec<f64> = points
            .iter()
            .flat_map(|p| {
                let ends = [p.published_interval, p.ours_interval].into_iter().flatten();
                ends.flat_map(|(low, high)| [low, high]).chain([p.published, p.ours])
            })
            .chain(self.end)
            .chain([0.0])
            .collect();
        let axis = |title: String| {
            if self.logarithmic {
                Axis::logarithmic(&title, values.iter().copied())
            } else {
                Axis::covering(&title, values.iter().copied(), 7)
            }
        };
        let x = axis(format!("paper: {}", self.quantity));
        let y = axis(format!("ours: {}", self.quantity));
        let margin = Plot::left_margin(&y);
        let width = medium.width().unwrap_or(margin + SIDE + 16.0);
        let side = (width - margin - 16.0).min(if medium == Medium::Screen { SIDE } else { LARGE });
        let left = margin + (width - margin - 16.0 - side) / 2.0;
        let plot = Plot { left, right: left + side, top: 14.0, bottom: 14.0 + side, x, y };

        let grid = plot.x.ticks.iter().map(|tick| {
            let x = plot.px(tick.value);
            rule((x, plot.top), (x, plot.bottom), 1.0, 0.15)
        });
        let mut body: Vec<_> = grid.collect();
        body.extend([plot.y_axis(), plot.x_axis()]);
        let identity = rule((plot.left, plot.bottom), (plot.right, plot.top), 1.2, 0.7);
        body.push(identity.set("stroke-dasharray", "5 4"));
        // Error bars first: no point may hide under another's.
        for p in &points {
            let bars = error_bars(&plot, p);
            if !bars.is_empty() {
                let path = Element::new("path").set("d", bars).set("fill", "none");
                body.push(Style::of(p.group).stroke(path, 0.9).set("stroke-opacity", "0.45"));
            }
        }
        let mut taken: Vec<Taken> = Vec::new();
        for p in &points {
            let (x, y) = (plot.px(p.published), plot.py(p.ours));
            taken.push((x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS));
            let mark = Style::of(p.group).point(x, y, RADIUS, false);
            body.push(mark.child(Element::new("title").text(&p.name)));
        }
        body.extend(self.corner(&plot, &mut taken));
        for p in &points {
            body.extend(beside(&plot, p, &mut taken).into_iter().flatten());
        }
        let top = plot.bottom + 52.0;
        let (key, height) = key(self.items(), 12.0, width - 4.0, top);
        sheet(width, top + height + 8.0, &self.title, body.into_iter().chain([key]))
    }

    /// Describes the chart for those who cannot see it.
    pub fn in_words(&self) -> String {
        let above = self.points.iter().filter(|p| p.ours > p.published).count();
        let mut words = format!(
            "{}: {} of {} points lie above the line of agreement",
            self.quantity,
            above,
            self.points.len()
        );
        for note in &self.notes {
            words.push_str("; ");
            words.push_str(note);
        }
        let named = self.points.iter().filter(|p| !p.label.is_empty()).map(|p| p.name.as_str());
        let named: Vec<&str> = named.collect();
        if !named.is_empty() {
            words.push_str("; farthest from it: ");
            words.push_str(&named.join(" / "));
        }
        words + "."
    }

    /// Writes the notes in the upper left or lower right corner, whichever has fewer points.
    fn corner(&self, plot: &Plot, taken: &mut Vec<Taken>) -> Vec<Element> {
        let width = self.notes.iter().map(|note| text_width(note, TEXT)).fold(0.0, f64::max);
        let height = LINE * super::chart::real(self.notes.len());
        let upper = (plot.left + 10.0, plot.top + 8.0);
        let lower = (plot.right - 10.0 - width, plot.bottom - 10.0 - height);
        let box_at = |(x, y): (f64, f64)| (x, y, x + width, y + height);
        let hidden = |at| taken.iter().filter(|other| overlap(box_at(at), **other)).count();
        let at = if hidden(upper) <= hidden(lower) { upper } else { lower };
        if self.notes.is_empty() {
            return Vec::new();
        }
        taken.push(box_at(at));
        let lines = self.notes.iter().enumerate();
        lines
            .map(|(i, note)| label(at.0, at.1 + LINE * super::chart::real(i) + 13.0, "start", note))
            .collect()
    }

    fn items(&self) -> Vec<KeyItem> {
        let mut items: Vec<KeyItem> = self
            .groups
            .iter()
            .enumerate()
            .map(|(i, name)| KeyItem {
                mark: Style::of(i).point(0.0, 0.0, RADIUS, false),
                text: name.clone(),
            })
            .collect();
        if !self.intervals.is_empty() {
            let cross =
                error_bar((-8.0, 0.0), (8.0, 0.0), 2.5) + &error_bar((0.0, -7.0), (0.0, 7.0), 2.5);
            let cross = Element::new("path").set("d", cross).set("fill", "none");
            let mark = Style::of(0).stroke(cross, 0.9).set("stroke-opacity", "0.6");
            items.push(KeyItem { mark, text: self.intervals.clone() });
        }
        let same = rule((-12.0, 5.0), (12.0, -5.0), 1.2, 0.7).set("stroke-dasharray", "5 4");
        items.push(KeyItem { mark: same, text: "ours = paper".into() });
        items
    }
}

fn overlap(a: Taken, b: Taken) -> bool {
    a.0 < b.2 && b.0 < a.2 && a.1 < b.3 && b.1 < a.3
}

/// Writes the point's label at the first side of it that is free, if there is one.
fn beside(plot: &Plot, point: &ScatterPoint, taken: &mut Vec<Taken>) -> Option<[Element; 2]> {
    if point.label.is_empty() {
        return None;
    }
    let width = text_width(&point.label, TEXT);
    let (x, y) = (plot.px(point.published), plot.py(point.ours));
    let right = ((x + 9.0, y + 4.5), "start", x + 9.0);
    let left = ((x - 9.0, y + 4.5), "end", x - 9.0 - width);
    let over = ((x, y - 9.0), "middle", x - width / 2.0);
    let under = ((x, y + 19.0), "middle", x - width / 2.0);
    let above_right = ((x + 7.0, y - 9.0), "start", x + 7.0);
    let below_right = ((x + 7.0, y + 17.0), "start", x + 7.0);
    let above_left = ((x - 7.0, y - 9.0), "end", x - 7.0 - width);
    let below_left = ((x - 7.0, y + 17.0), "end", x - 7.0 - width);
    let sides = [right, left, over, under, above_right, below_right, above_left, below_left];
    let (at, anchor, from) = sides.into_iter().find(|(at, _, from)| {
        let wanted = (*from, at.1 - 11.0, from + width, at.1 + 3.0);
        *from >= plot.left + 4.0
            && from + width <= plot.right
            && wanted.1 >= plot.top
            && wanted.3 <= plot.bottom
            && !taken.iter().any(|other| overlap(wanted, *other))
    })?;
    taken.push((from, at.1 - 11.0, from + width, at.1 + 3.0));
    // Error bars of others pass behind the label.
    let ground = Element::new("rect")
        .at("x", from - 2.0)
        .at("y", at.1 - 11.5)
        .at("width", width + 4.0)
        .at("height", 15.0)
        .set("fill", super::PAPER)
        .set("fill-opacity", "0.85")
        .set("class", "paper-fill");
    Some([ground, label(at.0, at.1, anchor, &point.label)])
}

fn error_bars(plot: &Plot, point: &ScatterPoint) -> String {
    let (x, y) = (plot.px(point.published), plot.py(point.ours));
    let mut data = path_data([], false);
    let within = |axis: &Axis, value: f64| value.clamp(axis.low, axis.high);
    if let Some((low, high)) = point.published_interval {
        let [low, high] = [low, high].map(|v| plot.px(within(&plot.x, v)));
        data.push_str(&error_bar((low, y), (high, y), 2.5));
    }
    if let Some((low, high)) = point.ours_interval {
        let [low, high] = [low, high].map(|v| plot.py(within(&plot.y, v)));
        data.push_str(&error_bar((x, low), (x, high), 2.5));
    }
    data
}
