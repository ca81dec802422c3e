//! Bars with intervals in groups, the paper's values as hollow markers beside them.

use super::axis::Axis;
use super::chart::{KeyItem, Plot, TEXT, error_bar, key, label, real, rule, sheet, text_width};
use super::palette::Style;
use super::svg::Element;

const PLOT_HEIGHT: f64 = 280.0;

/// A chart of grouped bars from zero.
#[derive(Debug, Clone, Default)]
pub struct BarChart {
    /// What the chart shows, for those who cannot see it.
    pub title: String,
    /// Title of the horizontal axis: what the groups are.
    pub x_title: String,
    /// Title of the vertical axis, with its unit.
    pub y_title: String,
    /// What bars and intervals are: `mean and sd of 10 trials`.
    pub meaning: String,
    /// Names of the bars within each group, in the order of their looks.
    pub series: Vec<String>,
    /// The groups, from left to right.
    pub groups: Vec<BarGroup>,
    /// A top the axis reaches in any case, such as 100 for percentages.
    pub at_least: Option<f64>,
}

/// A group of bars.
#[derive(Debug, Clone, Default)]
pub struct BarGroup {
    /// What stands under it.
    pub name: String,
    /// One bar per series.
    pub bars: Vec<Bar>,
}

/// One bar, in the unit of the axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bar {
    /// Its height; `None` where there is nothing to show.
    pub value: Option<f64>,
    /// Low and high end of its interval.
    pub interval: Option<(f64, f64)>,
    /// The paper's value.
    pub published: Option<f64>,
    /// Low and high end of the paper's interval.
    pub published_interval: Option<(f64, f64)>,
}

impl BarChart {
    /// The chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        let bars = || self.groups.iter().flat_map(|g| &g.bars);
        let ends = |interval: Option<(f64, f64)>| interval.map_or([0.0; 2], |(l, h)| [l, h]);
        let values = bars()
            .flat_map(|b| [b.value.unwrap_or(0.0), b.published.unwrap_or(0.0)])
            .chain(bars().flat_map(|b| ends(b.interval)))
            .chain(bars().flat_map(|b| ends(b.published_interval)))
            .chain([0.0, self.at_least.unwrap_or(0.0)]);
        let y = Axis::covering(&self.y_title, values, 7);
        let per_group = real(self.series.len()) + 1.0;
        let slots = per_group * real(self.groups.len());
        // Bars of 14 to 34 px, so that few do not look like blocks nor many like threads.
        let slot = (560.0 / slots.max(1.0)).clamp(22.0, 46.0);
        let left = Plot::left_margin(&y);
        let width = (left + slot * slots + 16.0).max(420.0);
        let plot = Plot {
            left,
            right: width - 16.0,
            top: 14.0,
            bottom: 14.0 + PLOT_HEIGHT,
            x: Axis::covering(&self.x_title, [0.0, 1.0], 2),
            y,
        };
        let mut body = vec![plot.y_axis()];
        let group_width = (plot.right - plot.left) / real(self.groups.len()).max(1.0);
        let mut lines = 1;
        for (g, group) in self.groups.iter().enumerate() {
            let middle = plot.left + group_width * (real(g) + 0.5);
            let start = middle - slot * real(self.series.len()) / 2.0;
            for (i, bar) in group.bars.iter().enumerate() {
                body.extend(draw(&plot, Style::of(i), bar, start + slot * real(i), slot));
            }
            let name = wrap(&group.name, group_width - 6.0);
            lines = lines.max(name.len());
            for (row, line) in name.iter().enumerate() {
                body.push(label(middle, plot.bottom + 19.0 + 15.0 * real(row), "middle", line));
            }
        }
        body.push(rule((plot.left, plot.py(0.0)), (plot.right, plot.py(0.0)), 1.2, 1.0));
        let below = 25.0 + 15.0 * real(lines);
        body.push(plot.x_title(below));
        let top = plot.bottom + below + 12.0;
        let (key, height) = key(self.items(), 24.0, width - 8.0, top);
        sheet(width, top + height + 6.0, &self.title, body.into_iter().chain([key]))
    }

    fn items(&self) -> Vec<KeyItem> {
        let bars = || self.groups.iter().flat_map(|g| &g.bars);
        let mut items: Vec<_> = self
            .series
            .iter()
            .enumerate()
            .map(|(i, name)| KeyItem {
                mark: Style::of(i).bar(-10.0, -7.0, 20.0, 14.0),
                text: name.clone(),
            })
            .collect();
        if !self.meaning.is_empty() {
            let mark = rule((0.0, -7.0), (0.0, 7.0), 1.2, 1.0);
            items.push(KeyItem { mark, text: format!("ours: {}", self.meaning) });
        }
        if bars().any(|b| b.published.is_some()) {
            let spread = bars().any(|b| b.published_interval.is_some());
            let text =
                if spread { "hollow: published, with its interval" } else { "hollow: published" };
            items
                .push(KeyItem { mark: Style::of(0).point(0.0, 0.0, 4.5, true), text: text.into() });
        }
        items
    }
}

/// One bar in the slot of `slot` px that begins at `x`; the paper's marker stands in its right part.
fn draw(plot: &Plot, style: Style, bar: &Bar, x: f64, slot: f64) -> Vec<Element> {
    let zero = plot.py(0.0);
    let width = if bar.published.is_some() { slot * 0.56 } else { slot * 0.8 };
    let x = x + slot * 0.08;
    let mut elements = Vec::new();
    if let Some(value) = bar.value {
        let y = plot.py(value);
        elements.push(style.bar(x, y.min(zero), width, (zero - y).abs()));
    } else {
        elements.push(label(x + width / 2.0, zero - 5.0, "middle", "–"));
    }
    let mut interval = |(low, high): (f64, f64), at: f64, thick: f64| {
        let bar = error_bar((at, plot.py(low)), (at, plot.py(high)), 3.0);
        let path = Element::new("path").set("d", bar).set("fill", "none");
        elements.push(if thick > 1.2 {
            // Over the bar itself only ink can be seen.
            Style::of(0).stroke(path, thick)
        } else {
            style.stroke(path, thick)
        });
    };
    if let Some(ends) = bar.interval {
        interval(ends, x + width / 2.0, 1.4);
    }
    let beside = x + width + slot * 0.16;
    if let Some(ends) = bar.published_interval {
        interval(ends, beside, 1.0);
    }
    if let Some(published) = bar.published {
        elements.push(style.point(beside, plot.py(published), 4.2, true));
    }
    elements
}

/// `text` broken at spaces into lines of at most `width` px where words allow.
fn wrap(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
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
