//! The paper's numbers against ours, with the line on which they would be the same.

use super::axis::Axis;
use super::chart::{KeyItem, Plot, error_bar, key, rule, sheet};
use super::palette::Style;
use super::svg::{Element, path_data};

const SIDE: f64 = 380.0;

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
}

/// One cell of a table, twice.
#[derive(Debug, Clone, Default)]
pub struct ScatterPoint {
    /// Index of its group.
    pub group: usize,
    /// What it is, shown on pointing at it.
    pub name: String,
    /// The paper's value.
    pub published: f64,
    /// The paper's deviation, if printed.
    pub published_sd: Option<f64>,
    /// Our value.
    pub ours: f64,
    /// Our deviation, if there is one.
    pub ours_sd: Option<f64>,
}

impl Scatter {
    /// The chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        let points =
            || self.points.iter().filter(|p| p.published.is_finite() && p.ours.is_finite());
        let values = points()
            .flat_map(|p| {
                let (a, b) = (p.published_sd.unwrap_or(0.0), p.ours_sd.unwrap_or(0.0));
                [p.published - a, p.published + a, p.ours - b, p.ours + b]
            })
            .chain([0.0]);
        let axis = |title: String| Axis::covering(&title, values.clone(), 7);
        let x = axis(format!("published: {}", self.quantity));
        let y = axis(format!("ours: {}", self.quantity));
        let left = Plot::left_margin(&y);
        let plot = Plot { left, right: left + SIDE, top: 14.0, bottom: 14.0 + SIDE, x, y };
        let width = plot.right + 16.0;

        let grid = plot.x.ticks.iter().map(|tick| {
            let x = plot.px(tick.value);
            rule((x, plot.top), (x, plot.bottom), 1.0, 0.15)
        });
        let mut body: Vec<_> = grid.collect();
        body.extend([plot.y_axis(), plot.x_axis()]);
        let identity = rule((plot.left, plot.bottom), (plot.right, plot.top), 1.2, 0.7);
        body.push(identity.set("stroke-dasharray", "5 4"));
        // Error bars first: no point may hide under another's.
        for p in points() {
            let bars = error_bars(&plot, p);
            if !bars.is_empty() {
                let path = Element::new("path").set("d", bars).set("fill", "none");
                body.push(Style::of(p.group).stroke(path, 0.9).set("stroke-opacity", "0.6"));
            }
        }
        for p in points() {
            let mark = Style::of(p.group).point(plot.px(p.published), plot.py(p.ours), 4.5, false);
            body.push(mark.child(Element::new("title").text(&p.name)));
        }
        let same = rule((-12.0, 5.0), (12.0, -5.0), 1.2, 0.7).set("stroke-dasharray", "5 4");
        let same = KeyItem { mark: same, text: "ours = published".into() };
        let items = self.groups.iter().enumerate().map(|(i, name)| KeyItem {
            mark: Style::of(i).point(0.0, 0.0, 4.5, false),
            text: name.clone(),
        });
        let top = plot.bottom + 52.0;
        let (key, height) = key(items.chain([same]).collect(), plot.left - 12.0, width, top);
        sheet(width, top + height + 6.0, &self.title, body.into_iter().chain([key]))
    }
}

fn error_bars(plot: &Plot, point: &ScatterPoint) -> String {
    let (x, y) = (plot.px(point.published), plot.py(point.ours));
    let mut data = path_data([], false);
    if let Some(sd) = point.published_sd {
        let ends = [point.published - sd, point.published + sd].map(|v| (plot.px(v), y));
        data.push_str(&error_bar(ends[0], ends[1], 2.5));
    }
    if let Some(sd) = point.ours_sd {
        let ends = [point.ours - sd, point.ours + sd].map(|v| (x, plot.py(v)));
        data.push_str(&error_bar(ends[0], ends[1], 2.5));
    }
    data
}
