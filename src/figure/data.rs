//! What a chart draws, as a table that draws it again in another program. Units are those of the chart's axes.

use super::{
    Estimate, EstimateChart, LineChart, PanelLine, Plan, PolicyChart, Scatter, ShareChart, Shares,
};
use crate::geometry::Outline;
use crate::grid::Occupancy;
use crate::table::{Table, Value};

/// Returns both ends of an interval.
fn ends(interval: Option<(f64, f64)>) -> [Value; 2] {
    [interval.map(|ends| ends.0).into(), interval.map(|ends| ends.1).into()]
}

fn text(text: &str) -> Value {
    text.to_owned().into()
}

impl LineChart {
    /// Returns the points of curves, bands and the paper's values.
    pub fn data(&self) -> Table {
        let mut table =
            Table::new(["series", "what", "x", "y", "low", "high", "x-deviation", "y-deviation"]);
        for series in &self.series {
            let mut push = |what: &str, numbers: [Option<f64>; 6]| {
                let numbers = numbers.into_iter().map(Value::from);
                table.push([text(&series.name), text(what)].into_iter().chain(numbers).collect());
            };
            for (x, y) in series.points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
                push("curve", [Some(*x), Some(*y), None, None, None, None]);
            }
            for (x, low, high) in &series.band {
                push("band", [Some(*x), None, Some(*low), Some(*high), None, None]);
            }
            for p in &series.published {
                push("paper", [Some(p.x), Some(p.y), None, None, p.x_error, p.y_error]);
            }
        }
        table
    }
}

/// Returns what tells each row of the panels apart, and the row.
fn rows<'a, R>(
    lines: &'a [PanelLine<R>],
    names: &'a [String],
) -> impl Iterator<Item = ([Value; 3], &'a R)> {
    lines.iter().flat_map(move |line| {
        line.panels.iter().flat_map(move |panel| {
            let named = panel.rows.iter().zip(names);
            named.map(move |(row, name)| ([text(&line.name), text(&panel.name), text(name)], row))
        })
    })
}

impl EstimateChart {
    /// Returns the estimates, their intervals, and the paper's.
    pub fn data(&self) -> Table {
        let banded = !self.band.is_empty();
        let names = [
            "line",
            "panel",
            "row",
            "value",
            "low",
            "high",
            "middle-half-low",
            "middle-half-high",
            "n",
            "paper",
            "paper-low",
            "paper-high",
        ];
        let bands = ["band-low", "band-median", "band-high"].into_iter().filter(|_| banded);
        let mut table = Table::new(names.into_iter().chain(bands));
        for (names, row) in rows::<Estimate>(&self.lines, &self.names) {
            let n: Option<i64> = row.n.and_then(|n| i64::try_from(n).ok());
            let cells = names
                .into_iter()
                .chain([row.value.into()])
                .chain(ends(row.interval))
                .chain(ends(row.middle_half))
                .chain([n.into(), row.published.into()])
                .chain(ends(row.published_interval))
                .chain((0..3).filter(|_| banded).map(|i| row.band.map(|band| band[i]).into()));
            table.push(cells.collect());
        }
        table
    }
}

impl ShareChart {
    /// Returns the shares, ours and the paper's, in percent.
    pub fn data(&self) -> Table {
        let mut table =
            Table::new(["line", "panel", "row", "part", "share-percent", "paper-share-percent"]);
        for (names, row) in rows::<Shares>(&self.lines, &self.names) {
            for (i, part) in self.parts.iter().enumerate() {
                let shares =
                    [&row.ours, &row.published].map(|all| Value::from(all.get(i).copied()));
                let cells = names.clone().into_iter().chain([text(&part.name)]).chain(shares);
                table.push(cells.collect());
            }
        }
        table
    }
}

impl Scatter {
    /// Returns the points, both values and their intervals.
    pub fn data(&self) -> Table {
        let mut table = Table::new([
            "group",
            "name",
            "paper",
            "paper-low",
            "paper-high",
            "ours",
            "ours-low",
            "ours-high",
        ]);
        for p in &self.points {
            let group = self.groups.get(p.group).map_or("", String::as_str);
            let cells = [text(group), text(&p.name), p.published.into()]
                .into_iter()
                .chain(ends(p.published_interval))
                .chain([p.ours.into()])
                .chain(ends(p.ours_interval));
            table.push(cells.collect());
        }
        table
    }
}

impl PolicyChart {
    /// Returns the actions of every policy.
    pub fn data(&self) -> Table {
        let mut table =
            Table::new(["policy", "from", "to", "maneuver", "probability", "expected-passes"]);
        let label =
            |v: usize| text(self.vertices.get(v).map_or("", |vertex| vertex.label.as_str()));
        for panel in &self.panels {
            for step in &panel.moves {
                table.push(vec![
                    text(&panel.name),
                    label(step.from),
                    label(step.to),
                    text(if step.fast { "fast" } else { "slow" }),
                    step.probability.into(),
                    step.passes.into(),
                ]);
            }
        }
        table
    }
}

impl Plan<'_> {
    /// Returns the corners of everything that stands, the centres and radii of what is round, and the centres of the map's occupied cells (m).
    pub fn data(&self) -> Table {
        let mut table = Table::new(["what", "outline", "x-m", "y-m", "radius-m"]);
        let kinds =
            [("wall", &self.walls), ("furniture", &self.furniture), ("crossed", &self.crossed)];
        for (what, outlines) in kinds {
            for (number, outline) in (1_i64..).zip(outlines) {
                let mut push = |x: f64, y: f64, radius: Option<f64>| {
                    table.push(vec![text(what), number.into(), x.into(), y.into(), radius.into()]);
                };
                match outline {
                    Outline::Polygon(corners) => corners.iter().for_each(|p| push(p.x, p.y, None)),
                    Outline::Circle { center, radius } => push(center.x, center.y, Some(*radius)),
                }
            }
        }
        if let Some((name, map)) = self.overlay {
            let cells = map.frame().cells().filter(|cell| map.at(*cell) == Occupancy::Occupied);
            for (number, cell) in (1_i64..).zip(cells) {
                let at = map.frame().center(cell);
                let what = text(&format!("cell of {name}"));
                table.push(vec![what, number.into(), at.x.into(), at.y.into(), Value::Missing]);
            }
        }
        table
    }
}
