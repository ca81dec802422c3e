//! Curves with bands: coverage over distance, time over coverage.

use super::axis::Axis;
use super::chart::{
    KeyItem, Plot, TEXT, error_bar, key, label, real, rule, sheet, spread, text_width,
};
use super::medium::Medium;
use super::palette::Style;
use super::svg::{Element, path_data};

const WIDTH: f64 = 680.0;
const PLOT_HEIGHT: f64 = 330.0;
const LABEL_GAP: f64 = 17.0;

/// A chart of named curves, each with an optional band and the paper's own points.
#[derive(Debug, Clone, Default)]
pub struct LineChart {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// Title of the horizontal axis, with its unit.
    pub x_title: String,
    /// Title of the vertical axis, with its unit.
    pub y_title: String,
    /// What curves and bands are: `median and middle half of 10 trials`.
    pub meaning: String,
    /// The curves, in the order of their looks.
    pub series: Vec<Series>,
}

/// One curve.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// What it is called beside its end.
    pub name: String,
    /// The curve, in the axes' units; points that are not finite break it.
    pub points: Vec<(f64, f64)>,
    /// The band as (x, low, high); empty for none.
    pub band: Vec<(f64, f64, f64)>,
    /// The paper's values for the same thing: hollow markers.
    pub published: Vec<PublishedPoint>,
}

/// One value as the paper prints it.
#[derive(Debug, Clone, Copy, Default)]
pub struct PublishedPoint {
    /// Horizontal value, in the axis's unit.
    pub x: f64,
    /// Vertical value, in the axis's unit.
    pub y: f64,
    /// Half the length of its horizontal error bar (the published deviation in x), if any.
    pub x_error: Option<f64>,
    /// Half the length of its vertical error bar, if any.
    pub y_error: Option<f64>,
}

impl LineChart {
    /// Returns whether it holds no result of ours: then it would be axes alone.
    pub fn is_empty(&self) -> bool {
        self.series.iter().all(|series| series.points.is_empty())
    }

    /// Draws the chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let width = medium.width().unwrap_or(WIDTH);
        let plot = self.plot(width);
        let mut body = vec![plot.y_axis(), plot.x_axis()];
        for (i, series) in self.series.iter().enumerate() {
            body.extend(band(&plot, Style::of(i), series));
        }
        for (i, series) in self.series.iter().enumerate() {
            body.extend(curve(&plot, Style::of(i), series, i));
        }
        for (i, series) in self.series.iter().enumerate() {
            body.extend(series.published.iter().map(|p| published(&plot, Style::of(i), p)));
        }
        let mut items = Vec::new();
        if self.labels_fit(width, &plot) {
            body.extend(self.end_labels(&plot));
        } else {
            items.extend(self.series.iter().enumerate().map(|(i, series)| {
                KeyItem {
                    mark: Element::new("g")
                        .child(sample(Style::of(i)))
                        .child(Style::of(i).point(0.0, 0.0, 4.0, false)),
                    text: series.name.clone(),
                }
            }));
        }
        items.extend(self.meaning_items());
        let top = plot.bottom + 52.0;
        let (key, height) = key(items, 24.0, width - 8.0, top);
        sheet(width, top + height + 6.0, &self.title, body.into_iter().chain([key]))
    }

    fn plot(&self, width: f64) -> Plot {
        let height = PLOT_HEIGHT.min(0.62 * width);
        let points = || self.series.iter().flat_map(|s| s.points.iter().copied());
        let bands = || self.series.iter().flat_map(|s| s.band.iter().copied());
        let published = || self.series.iter().flat_map(|s| s.published.iter().copied());
        let x = points()
            .map(|p| p.0)
            .chain(bands().map(|b| b.0))
            .chain(published().flat_map(|p| around(p.x, p.x_error)));
        let y = points()
            .map(|p| p.1)
            .chain(bands().flat_map(|b| [b.1, b.2]))
            .chain(published().flat_map(|p| around(p.y, p.y_error)));
        let many = if width < WIDTH { 6 } else { 9 };
        let (x, y) = (Axis::covering(&self.x_title, x, many), Axis::covering(&self.y_title, y, 8));
        let mut plot = Plot {
            left: Plot::left_margin(&y),
            right: width - 16.0,
            top: 14.0,
            bottom: 14.0 + height,
            x,
            y,
        };
        if self.labels_fit(width, &plot) {
            plot.right = width - self.label_width() - 34.0;
        }
        plot
    }

    fn label_width(&self) -> f64 {
        self.series.iter().map(|s| text_width(&s.name, TEXT)).fold(0.0, f64::max)
    }

    /// Returns whether every curve can be named at its end.
    fn labels_fit(&self, width: f64, plot: &Plot) -> bool {
        let height = plot.bottom - plot.top;
        self.label_width() <= width * 0.3 && real(self.series.len()) * LABEL_GAP <= height
    }

    /// Describes the chart for those who cannot see it: where each curve ends, and where it first had nine tenths of
    /// that.
    pub fn in_words(&self) -> String {
        let told = self.series.iter().filter_map(|series| {
            let finite = || series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
            let (_, end) = finite().next_back()?;
            let (x, _) = finite().find(|p| p.1 >= 0.9 * end)?;
            Some(format!("{} ends at {end:.0} and has nine tenths of it at {x:.0}", series.name))
        });
        let told: Vec<String> = told.collect();
        if told.is_empty() {
            return String::new();
        }
        format!("{} against {}: {}.", self.y_title, self.x_title, told.join("; "))
    }

    fn end_labels(&self, plot: &Plot) -> Vec<Element> {
        let ends: Vec<_> = self
            .series
            .iter()
            .enumerate()
            .filter_map(|(i, series)| {
                let (x, y) =
                    series.points.iter().rev().find(|p| p.0.is_finite() && p.1.is_finite())?;
                Some((i, plot.px(*x), plot.py(*y)))
            })
            .collect();
        let wanted: Vec<_> = ends.iter().map(|e| e.2).collect();
        let placed = spread(&wanted, LABEL_GAP, plot.top + 4.0, plot.bottom - 4.0);
        let mut elements = Vec::new();
        for (&(i, x, y), &at) in ends.iter().zip(&placed) {
            let side = plot.right + 12.0;
            if (at - y).abs() > 2.0 || side - x > 20.0 {
                elements.push(rule((x + 6.0, y), (side - 2.0, at), 0.8, 0.4));
            }
            elements.push(Style::of(i).point(side + 4.0, at, 4.0, false));
            elements.push(label(side + 14.0, at + 4.5, "start", &self.series[i].name));
        }
        elements
    }

    fn meaning_items(&self) -> Vec<KeyItem> {
        let mut items = Vec::new();
        if !self.meaning.is_empty() {
            let mut mark = Element::new("g");
            if self.series.iter().any(|s| !s.band.is_empty()) {
                mark.push(
                    Element::new("rect")
                        .at("x", -12.0)
                        .at("y", -6.0)
                        .at("width", 24.0)
                        .at("height", 12.0)
                        .set("fill", super::INK)
                        .set("class", "ink-fill")
                        .set("fill-opacity", "0.15"),
                );
            }
            let mark = mark.child(sample(Style::of(0)));
            items.push(KeyItem { mark, text: format!("ours: {}", self.meaning) });
        }
        if self.series.iter().any(|s| !s.published.is_empty()) {
            let bars = self
                .series
                .iter()
                .flat_map(|s| &s.published)
                .any(|p| p.x_error.is_some() || p.y_error.is_some());
            let text = if bars { "hollow: published, ± sd" } else { "hollow: published" };
            let mark = Style::of(0).point(0.0, 0.0, 4.5, true);
            items.push(KeyItem { mark, text: text.into() });
        }
        items
    }
}

fn around(value: f64, error: Option<f64>) -> [f64; 2] {
    let error = error.unwrap_or(0.0);
    [value - error, value + error]
}

/// Draws a short piece of the series' line, around the origin.
fn sample(style: Style) -> Element {
    let line = Element::new("path").set("d", "M-12 0L12 0").set("fill", "none");
    style
        .stroke(line, 2.0)
        .set("stroke-dasharray", if style.dash.is_empty() { "none" } else { style.dash })
}

fn band(plot: &Plot, style: Style, series: &Series) -> Option<Element> {
    let edges: Vec<_> = series
        .band
        .iter()
        .filter(|b| b.0.is_finite() && b.1.is_finite() && b.2.is_finite())
        .collect();
    if edges.len() < 2 {
        return None;
    }
    let low = edges.iter().map(|b| (plot.px(b.0), plot.py(b.1)));
    let high = edges.iter().rev().map(|b| (plot.px(b.0), plot.py(b.2)));
    let area = Element::new("path")
        .set("d", path_data(low.chain(high), true))
        .set("fill", style.colour)
        .set("fill-opacity", "0.15");
    Some(if style.colour == super::INK { area.set("class", "ink-fill") } else { area })
}

/// Draws the line, broken where a point is missing, with about six markers that neighbours do not share.
fn curve(plot: &Plot, style: Style, series: &Series, index: usize) -> Vec<Element> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let data: String = series
        .points
        .split(|p| !finite(p))
        .filter(|piece| !piece.is_empty())
        .map(|piece| path_data(piece.iter().map(|p| (plot.px(p.0), plot.py(p.1))), false))
        .collect();
    if data.is_empty() {
        return Vec::new();
    }
    let mut line = style.stroke(Element::new("path").set("d", data).set("fill", "none"), 2.0);
    line = line.set("stroke-linejoin", "round");
    if !style.dash.is_empty() {
        line = line.set("stroke-dasharray", style.dash);
    }
    let mut elements = vec![line];
    let every = series.points.len().div_ceil(6).max(1);
    let marked = series.points.iter().enumerate().filter(|(i, p)| {
        (i + index * every / 4) % every == every - 1 && finite(p) || series.points.len() <= 12
    });
    for (_, p) in marked.filter(|(_, p)| finite(p)) {
        elements.push(style.point(plot.px(p.0), plot.py(p.1), 4.0, false));
    }
    elements
}

fn published(plot: &Plot, style: Style, point: &PublishedPoint) -> Element {
    let (x, y) = (plot.px(point.x), plot.py(point.y));
    let mut bars = String::new();
    if let Some(error) = point.x_error {
        let [low, high] = around(point.x, Some(error));
        bars.push_str(&error_bar((plot.px(low), y), (plot.px(high), y), 3.0));
    }
    if let Some(error) = point.y_error {
        let [low, high] = around(point.y, Some(error));
        bars.push_str(&error_bar((x, plot.py(low)), (x, plot.py(high)), 3.0));
    }
    let mut group = Element::new("g");
    if !bars.is_empty() {
        group.push(style.stroke(Element::new("path").set("d", bars).set("fill", "none"), 1.1));
    }
    group.child(style.point(x, y, 5.0, true))
}
