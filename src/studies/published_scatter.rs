//! The paper's numbers against ours, one point per cell of a table.

use super::Drawn;
use super::findings::Findings;
use super::outcomes::{OutcomeTable, Quantity, published_share};
use super::prior_map::CoverageTable;
use super::requests::{TableLayout, TableRequest};
use crate::condition::Condition;
use crate::figure::{Medium, Scatter, ScatterPoint};
use crate::labels::Labels;
use crate::math;
use crate::stats::distribution::student_t_quantile;
use crate::stats::rank::pearson;
use crate::stats::{length, real};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Every cell of a table that the paper prints too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PublishedScatter {
    /// Id of an outcome table or a coverage table with `published` numbers.
    pub table: String,
    /// The factor, of those of the table, whose values look different; by default the one whose values stand side by side.
    #[serde(default)]
    pub by: Option<String>,
    /// How the axes run.
    #[serde(default)]
    pub scale: Scale,
    /// Of a coverage table with a `baseline`: the ratios of the cells to it, not the cells.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ratios: bool,
}

/// How an axis runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal steps are equal differences.
    #[default]
    Linear,
    /// Equal steps are equal ratios.
    Log,
}

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;
/// Points that are named beside them: those farthest from agreement.
const NAMED: usize = 4;

/// A cell on both sides.
struct Pair {
    values: Condition,
    /// The same in short, for its label.
    short: String,
    published: f64,
    published_interval: Option<(f64, f64)>,
    ours: f64,
    ours_interval: Option<(f64, f64)>,
}

impl PublishedScatter {
    /// Draws the figure, where there are points.
    pub(super) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        tables: &[TableRequest],
        medium: Medium,
    ) -> Option<Drawn> {
        let chart = findings.scatter_figure(title, self, tables);
        let caption = "One point for each number that the paper prints; on the dashed line ours is the same. Those farthest \
                       from it are named.";
        (!chart.is_empty()).then(|| {
            let (svg, data) = (chart.to_svg_on(medium), chart.data());
            Drawn::new(("Scatter chart", title), svg, chart.in_words(), caption, data)
        })
    }
}

impl Findings<'_> {
    /// Makes a requested figure: a scatter of the table it names among `tables`; without points where there is none.
    pub(super) fn scatter_figure(
        &self,
        title: &str,
        wanted: &PublishedScatter,
        tables: &[TableRequest],
    ) -> Scatter {
        let layout =
            tables.iter().find(|table| table.id == wanted.table).map(|table| &table.layout);
        let (pairs, by, quantity, unit, end) = match layout {
            Some(TableLayout::OutcomeTable(table)) => {
                let unit = unit_of(&table.show);
                let end = matches!(table.show, Quantity::Share(_)).then_some(100.0);
                (self.outcome_pairs(table), table.by.clone(), table.show.axis_title(), unit, end)
            }
            Some(TableLayout::CoverageTable(table)) => {
                let (name, unit) = match table.metric {
                    super::prior_map::Metric::DistanceM => ("distance travelled", "m"),
                    super::prior_map::Metric::TimeS => ("time", "s"),
                };
                let baseline = table.baseline.as_ref().map_or("", |value| &value.0);
                let (quantity, unit) = if wanted.ratios {
                    (format!("ratio of {name} to {}", self.labels.value(&table.by, baseline)), "")
                } else {
                    (format!("{name} to levels of coverage ({unit}), mean"), unit)
                };
                (self.coverage_pairs(table, wanted.ratios), table.by.clone(), quantity, unit, None)
            }
            _ => (Vec::new(), String::new(), String::new(), "", None),
        };
        let by = wanted.by.clone().unwrap_or(by);
        let level = |pair: &Pair| pair.values.value(&by).unwrap_or_default().to_owned();
        // In the manifest's order, and only those with points.
        let mut groups = if by == COVERAGE { Vec::new() } else { self.values_of(&by) };
        for pair in &pairs {
            if !groups.contains(&level(pair)) {
                groups.push(level(pair));
            }
        }
        groups.retain(|group| pairs.iter().any(|pair| level(pair) == *group));
        let logarithmic = wanted.scale == Scale::Log;
        let far = farthest(&pairs, logarithmic);
        let points = pairs.iter().enumerate().map(|(i, pair)| ScatterPoint {
            group: groups.iter().position(|group| *group == level(pair)).unwrap_or_default(),
            name: self.labels.condition(&pair.values),
            published: pair.published,
            published_interval: pair.published_interval,
            ours: pair.ours,
            ours_interval: pair.ours_interval,
            label: if far.contains(&i) { pair.short.clone() } else { String::new() },
        });
        let shown = |group: &String| {
            if by == COVERAGE {
                format!("{group} % coverage")
            } else {
                named_level(self.labels, &by, group)
            }
        };
        let has_intervals = pairs.iter().any(|p| p.ours_interval.is_some());
        let both = has_intervals && pairs.iter().any(|p| p.published_interval.is_some());
        Scatter {
            title: title.to_owned(),
            quantity,
            groups: groups.iter().map(shown).collect(),
            points: points.collect(),
            intervals: match (has_intervals, both) {
                (_, true) => "95 % intervals".to_owned(),
                (true, false) => "our 95 % intervals".to_owned(),
                (false, false) => String::new(),
            },
            logarithmic,
            end: end.filter(|_| !logarithmic),
            notes: notes(&pairs, unit, logarithmic),
        }
    }

    fn outcome_pairs(&self, table: &OutcomeTable) -> Vec<Pair> {
        let is_share = matches!(table.show, Quantity::Share(_));
        self.outcome_cells(table)
            .into_iter()
            .filter_map(|cell| {
                let ((published, n), ours) = (cell.published?, cell.ours?);
                let values = cell.rows.clone().with(&table.by, &cell.by);
                let short = self.labels.values(&values).join(" ");
                Some(Pair {
                    short,
                    values,
                    published,
                    published_interval: n
                        .filter(|_| is_share)
                        .and_then(|n| published_share(published, n)),
                    ours: ours.value,
                    ours_interval: ours.interval,
                })
            })
            .collect()
    }

    fn coverage_pairs(&self, table: &CoverageTable, ratios: bool) -> Vec<Pair> {
        let baseline = table.baseline.as_ref().map_or("", |value| &value.0);
        self.coverage_cells(table)
            .into_iter()
            .filter_map(|cell| {
                let ((published, sd, runs), ours) = (cell.published?, cell.ours?);
                let values = cell.rows.clone().with(&table.by, &cell.by);
                let values = values.with(COVERAGE, cell.percent.to_string());
                let short = self.labels.values(&values).join(" ") + " %";
                let pair = if ratios {
                    if cell.by == baseline {
                        return None;
                    }
                    Pair {
                        values,
                        short,
                        published: 1.0 + cell.published_difference_percent? / 100.0,
                        published_interval: None,
                        ours: 1.0 + cell.difference_percent? / 100.0,
                        ours_interval: None,
                    }
                } else {
                    let printed = sd.zip(runs).map(|(sd, runs)| (published, sd, runs));
                    let own = (ours.n > 1).then(|| (ours.mean, ours.sd, real(ours.n)));
                    Pair {
                        values,
                        short,
                        published,
                        published_interval: printed.and_then(of_mean),
                        ours: ours.mean,
                        ours_interval: own.and_then(of_mean),
                    }
                };
                Some(pair)
            })
            .collect()
    }
}

/// The level of coverage as if it were a factor.
const COVERAGE: &str = "coverage-percent";

fn named_level(labels: &Labels, factor: &str, value: &str) -> String {
    // A name says itself what it is; a number or a truth does not.
    if value.parse::<f64>().is_ok() || matches!(value, "true" | "false") || value.len() < 3 {
        labels.in_words(factor, value)
    } else {
        labels.value(factor, value).to_owned()
    }
}

fn unit_of(show: &Quantity) -> &'static str {
    match show {
        Quantity::Share(_) | Quantity::Percent(_) => "points",
        Quantity::Mean(measure) if measure.ends_with("-s") => "s",
        Quantity::Mean(measure) if measure.ends_with("-m") => "m",
        Quantity::Mean(_) => "",
    }
}

/// Computes Student's interval of a mean with its standard deviation over `runs`; `None` with one run.
fn of_mean((mean, sd, runs): (f64, f64, f64)) -> Option<(f64, f64)> {
    let half = student_t_quantile(0.5 + 0.5 * CONFIDENCE, runs - 1.0) * sd / runs.sqrt();
    (runs > 1.0 && half.is_finite()).then_some((mean - half, mean + half))
}

/// Computes how far a pair is from agreement, as the eye sees it.
fn gap(pair: &Pair, logarithmic: bool) -> f64 {
    if logarithmic {
        math::ln(pair.ours / pair.published).abs()
    } else {
        (pair.ours - pair.published).abs()
    }
}

fn farthest(pairs: &[Pair], logarithmic: bool) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..pairs.len()).filter(|i| gap(&pairs[*i], logarithmic).is_finite()).collect();
    let by_gap = |i: &usize| gap(&pairs[*i], logarithmic);
    order.sort_by(|a, b| by_gap(b).total_cmp(&by_gap(a)).then(a.cmp(b)));
    order.truncate(if pairs.len() > NAMED { NAMED } else { 0 });
    order
}

/// Says how many cells there are, how they correlate and how far they are apart.
fn notes(pairs: &[Pair], unit: &str, logarithmic: bool) -> Vec<String> {
    if pairs.len() < 3 {
        return Vec::new();
    }
    let of = |value: f64| if logarithmic { math::ln(value) } else { value };
    let ours: Vec<f64> = pairs.iter().map(|p| of(p.ours)).collect();
    let published: Vec<f64> = pairs.iter().map(|p| of(p.published)).collect();
    let differences: Vec<f64> = ours.iter().zip(&published).map(|(a, b)| a - b).collect();
    let n = length(&differences);
    let rmse = (differences.iter().map(|d| d * d).sum::<f64>() / n).sqrt();
    let mean = differences.iter().sum::<f64>() / n;
    let minus = |text: String| text.replace('-', "\u{2212}");
    let r = minus(format!("r = {:.2}", pearson(&published, &ours)));
    let [rmse, mean] = if logarithmic {
        let percent = |log: f64| 100.0 * (math::exp(log) - 1.0);
        [format!("RMSE {:.0} %", percent(rmse)), format!("mean {:+.0} %", percent(mean))]
    } else {
        let digits = usize::from(rmse < 10.0);
        [format!("RMSE {rmse:.digits$} {unit}"), format!("mean {mean:+.digits$} {unit}")]
    };
    let mut notes = vec![format!("{} cells, {r}", pairs.len()), rmse.trim().to_owned()];
    notes.push(minus(mean.trim().to_owned()) + " to paper");
    notes
}
