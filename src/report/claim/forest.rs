//! Claims as a forest plot: every comparison's effect with its interval against the line that its claim draws, and what the paper's
//! own numbers give. Claims of one quantity stand together, on one axis.

use crate::claims::published::PublishedCell;
use crate::claims::statement::{Statement, Wanted};
use crate::claims::verdict::ComparisonVerdict;
use crate::claims::{ClaimVerdict, Judgement};
use crate::figure::Axis;
use crate::figure::svg::{self, Element, path_data};
use crate::math::{exp, ln};
use std::collections::BTreeMap;

/// Width of a strip (px), and the room at both ends for the label of a tick.
const WIDTH: f64 = 300.0;
const ROOM: f64 = 16.0;
/// Height of a comparison's line (px), and of the room above and below all of them.
const PITCH: f64 = 13.0;
const MARGIN: f64 = 4.0;
/// Height of an axis (px).
const AXIS: f64 = 20.0;

/// The quantity of a group, and how its effects are shown.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Quantity {
    /// Its name with its unit: `difference, percentage points`.
    pub(super) name: String,
    scale: Scale,
}

/// How a number of `claims.json` becomes one of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Scale {
    Plain,
    /// Times 100.
    Percent,
    /// A difference of logarithms as a change in percent.
    Ratio,
}

impl Scale {
    fn of(self, x: f64) -> f64 {
        match self {
            Self::Plain => x,
            Self::Percent => 100.0 * x,
            Self::Ratio => 100.0 * (exp(x) - 1.0),
        }
    }
}

impl Quantity {
    /// Returns what the effect of `comparison` is a quantity of; `None` where it has none.
    fn of(comparison: &ComparisonVerdict) -> Option<Self> {
        let effect = comparison.effect.as_ref()?;
        if ![effect.value, effect.low, effect.high].iter().all(|x| x.is_finite()) {
            return None;
        }
        let about = comparison.about.as_str();
        let of_shares = about.contains("success") || about.contains("outcome:");
        let in_logs = about.contains("log of");
        let unit = || {
            let metric = about.split([':', ' ']).next().unwrap_or_default();
            let metric = metric.split_once("-at-").map_or(metric, |(metric, _)| metric);
            match metric.rsplit('-').next() {
                Some("s") => ", s",
                Some("m") => ", m",
                Some("m2") => ", m²",
                _ => "",
            }
        };
        let (name, scale) = match effect.name.as_ref() {
            "risk-difference" => ("difference, percentage points".to_owned(), Scale::Percent),
            "largest-difference" | "rate-difference" if of_shares => {
                ("difference, percentage points".to_owned(), Scale::Percent)
            }
            "spread" | "spread-difference" if of_shares => {
                ("spread, percentage points".to_owned(), Scale::Percent)
            }
            "share" => ("share, %".to_owned(), Scale::Percent),
            "share-of-pairs" => ("share of pairs, %".to_owned(), Scale::Percent),
            "relative-difference" => ("relative difference, %".to_owned(), Scale::Percent),
            "mean-difference" if in_logs => ("relative difference, %".to_owned(), Scale::Ratio),
            "mean-difference" => (format!("difference of means{}", unit()), Scale::Plain),
            "spearman" => ("rank correlation".to_owned(), Scale::Plain),
            "cliff-delta" => ("Cliff's delta".to_owned(), Scale::Plain),
            "rmse" => ("root mean square error".to_owned(), Scale::Plain),
            other => (format!("{}{}", other.replace('-', " "), unit()), Scale::Plain),
        };
        Some(Self { name, scale })
    }
}

/// One line of a strip, in the unit of the axis.
#[derive(Debug, Clone, PartialEq)]
struct Line {
    value: f64,
    low: f64,
    high: f64,
    judgement: Judgement,
    wanted: Option<Wanted>,
    /// What the paper's own numbers give.
    paper: Option<f64>,
}

/// One claim's lines.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strip {
    pub(super) quantity: Quantity,
    lines: Vec<Line>,
}

impl Strip {
    /// Returns the strip of `verdict`: of its comparisons that share the quantity of the first; `None` where none has an effect.
    /// `published` are the paper's numbers by the name of their table.
    pub(super) fn of(
        verdict: &ClaimVerdict,
        published: &BTreeMap<String, Vec<PublishedCell>>,
    ) -> Option<Self> {
        let quantity = verdict.comparisons.iter().find_map(Quantity::of)?;
        let scale = quantity.scale;
        let line = |comparison: &ComparisonVerdict| {
            let effect = comparison.effect.as_ref()?;
            let wanted = Wanted::read(&comparison.about, &effect.name).map(|wanted| Wanted {
                low: if wanted.low.is_finite() { scale.of(wanted.low) } else { wanted.low },
                high: if wanted.high.is_finite() { scale.of(wanted.high) } else { wanted.high },
            });
            Some(Line {
                value: scale.of(effect.value),
                low: scale.of(effect.low),
                high: scale.of(effect.high),
                judgement: comparison.judgement,
                wanted,
                paper: paper(comparison, published).map(|x| scale.of(x)),
            })
        };
        let of_it =
            verdict.comparisons.iter().filter(|c| Quantity::of(c).as_ref() == Some(&quantity));
        let lines = of_it.filter_map(line).collect();
        Some(Self { quantity, lines })
    }

    fn numbers(&self) -> impl Iterator<Item = f64> {
        self.lines.iter().flat_map(|line| {
            let wanted = line.wanted.map(|wanted| [wanted.low, wanted.high]);
            let lines = wanted.into_iter().flatten().filter(|x| x.is_finite());
            [line.value, line.low, line.high].into_iter().chain(line.paper).chain(lines)
        })
    }

    /// Returns how many comparisons are drawn.
    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    /// Returns whether the paper's numbers are marked somewhere.
    pub(super) fn has_paper(&self) -> bool {
        self.lines.iter().any(|line| line.paper.is_some())
    }

    /// Draws the strip on `axis`; `words` is what it shows for those who cannot see it.
    pub(super) fn draw(&self, axis: &Axis, words: &str) -> String {
        #[expect(clippy::cast_precision_loss, reason = "comparisons are few")]
        let height = 2.0 * MARGIN + PITCH * self.lines.len() as f64;
        let mut body = Vec::new();
        let x = |value: f64| axis.position(value, ROOM, WIDTH - ROOM).clamp(2.0, WIDTH - 2.0);
        for tick in &axis.ticks {
            let at = x(tick.value);
            body.push(stroke(path_data([(at, 0.0), (at, height)], false), "grid"));
        }
        for (i, line) in self.lines.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "comparisons are few")]
            let top = MARGIN + PITCH * i as f64;
            let y = top + PITCH / 2.0;
            if let Some(wanted) = line.wanted {
                let (low, high) = (x(wanted.low.max(axis.low)), x(wanted.high.min(axis.high)));
                let wash = Element::new("rect").at("x", low).at("y", top).at("height", PITCH);
                body.push(wash.at("width", (high - low).max(0.0)).set("class", "wanted"));
                for end in [wanted.low, wanted.high].into_iter().filter(|end| end.is_finite()) {
                    let end = x(end);
                    body.push(stroke(
                        path_data([(end, top), (end, top + PITCH)], false),
                        "claimed",
                    ));
                }
            }
            body.push(stroke(path_data([(x(line.low), y), (x(line.high), y)], false), "interval"));
            if let Some(paper) = line.paper {
                let (at, r) = (x(paper), 4.2);
                let corners = [(at, y - r), (at + r, y), (at, y + r), (at - r, y)];
                body.push(stroke(path_data(corners, true), "paper"));
            }
            body.push(mark(line.judgement, x(line.value), y));
        }
        drawing(height, words, body)
    }
}

/// Draws `axis` with its ticks' numbers.
pub(super) fn draw_axis(axis: &Axis) -> String {
    let body = axis.ticks.iter().flat_map(|tick| {
        let at = axis.position(tick.value, ROOM, WIDTH - ROOM);
        let label = Element::new("text").at("x", at).at("y", 11.0).set("text-anchor", "middle");
        [
            label.text(&tick.label.replace('-', "\u{2212}")),
            stroke(path_data([(at, AXIS - 4.0), (at, AXIS)], false), "grid"),
        ]
    });
    drawing(AXIS, "", body.collect())
}

/// Returns the axis on which all of `strips` lie.
pub(super) fn axis_of<'s>(strips: impl Iterator<Item = &'s Strip>) -> Axis {
    Axis::covering("", strips.flat_map(Strip::numbers).collect::<Vec<_>>(), 6)
}

fn drawing(height: f64, words: &str, body: Vec<Element>) -> String {
    let view = format!("0 0 {} {}", svg::number(WIDTH), svg::number(height));
    let mut root = Element::new("svg").set("viewBox", view).at("width", WIDTH).at("height", height);
    root = if words.is_empty() {
        root.set("aria-hidden", "true")
    } else {
        root.set("role", "img").child(Element::new("title").text(words))
    };
    body.into_iter().fold(root, Element::child).into_string()
}

fn stroke(data: String, class: &str) -> Element {
    Element::new("path").set("d", data).set("class", class)
}

/// Draws what was found: filled where the statement holds, a cross where it does not, hollow where that is open.
fn mark(judgement: Judgement, x: f64, y: f64) -> Element {
    let disc = |class: &str| {
        Element::new("circle").at("cx", x).at("cy", y).at("r", 3.4).set("class", class)
    };
    match judgement {
        Judgement::Supported => disc("holds"),
        Judgement::Contradicted => {
            let r = 3.6;
            let cross = path_data([(x - r, y - r), (x + r, y + r)], false)
                + &path_data([(x - r, y + r), (x + r, y - r)], false);
            stroke(cross, "fails")
        }
        Judgement::Inconclusive | Judgement::CannotBeTested => disc("open"),
    }
}

/// Returns the effect that the paper's printed numbers give for `comparison`, in the unit of its effect; `None` where it prints
/// none for one of the sides, or where an effect is none of printed numbers.
fn paper(
    comparison: &ComparisonVerdict,
    published: &BTreeMap<String, Vec<PublishedCell>>,
) -> Option<f64> {
    let statement = Statement::read(&comparison.about)?;
    let effect = comparison.effect.as_ref()?;
    let second = statement.second.as_ref();
    if let Some(metrics) = statement.metric.strip_prefix("mean log of ") {
        let second = second?;
        let logs = metrics.split(", ").map(|metric| {
            let of = |pins| printed(metric, pins, published).filter(|mean| *mean > 0.0);
            Some(ln(of(&statement.first)? / of(second)?))
        });
        let logs = logs.collect::<Option<Vec<f64>>>()?;
        #[expect(clippy::cast_precision_loss, reason = "metrics are few")]
        return Some(logs.iter().sum::<f64>() / logs.len() as f64);
    }
    let first = printed(statement.metric, &statement.first, published)?;
    let second = || printed(statement.metric, second?, published);
    match effect.name.as_ref() {
        "risk-difference" | "mean-difference" => Some(first - second()?),
        "relative-difference" => Some(first / second().filter(|x| *x != 0.0)? - 1.0),
        "share" if statement.second.is_none() => Some(first),
        _ => None,
    }
}

/// Returns the mean of what the paper prints of `metric` in the cells of `pins`: a share of 1 for what it prints in percent.
fn printed(
    metric: &str,
    pins: &[(&str, &str)],
    published: &BTreeMap<String, Vec<PublishedCell>>,
) -> Option<f64> {
    let quantity = metric.split_once("-at-").map_or(metric, |(quantity, _)| quantity);
    let in_percent = published.get(&format!("{metric}-percent"));
    let (cells, scale) = match in_percent {
        Some(cells) => (cells, 0.01),
        None => (published.get(metric).or_else(|| published.get(quantity))?, 1.0),
    };
    let fits = |cell: &&PublishedCell| {
        cell.speaks_of(metric)
            && pins.iter().all(|(factor, values)| {
                let pinned = cell.pins.get(*factor);
                pinned.is_none_or(|pinned| values.split('|').any(|value| value == pinned))
            })
    };
    let mut found = Vec::new();
    for cell in cells.iter().filter(fits) {
        found.push(scale * cell.value?);
    }
    #[expect(clippy::cast_precision_loss, reason = "cells of a printed table")]
    (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn verdict() -> ClaimVerdict {
        let compared = |verdict: &str, value: f64| {
            json!({
                "about": "success: (start=A, strategy=random) > (start=A, strategy=frontier)", "verdict": verdict,
                "test": "fisher-exact",
                "effect": {"name": "risk-difference", "value": value, "low": value - 0.1, "high": value + 0.1},
            })
        };
        let all = [
            compared("supported", 0.3),
            compared("contradicted", -0.2),
            compared("inconclusive", 0.0),
        ];
        serde_json::from_value(json!({"id": "D1", "verdict": "supported", "comparisons": all}))
            .unwrap()
    }

    fn published() -> BTreeMap<String, Vec<PublishedCell>> {
        let cell = |strategy: &str, value| PublishedCell {
            pins: [("start", "A"), ("strategy", strategy)]
                .map(|(factor, value)| (factor.to_owned(), value.to_owned()))
                .into(),
            metric: None,
            coverage: None,
            value: Some(value),
            sd: None,
            n: None,
        };
        [("success-percent".to_owned(), vec![cell("random", 90.0), cell("frontier", 50.0)])].into()
    }

    #[test]
    fn a_strip_shows_effect_line_and_the_papers_own_number() {
        let strip = Strip::of(&verdict(), &published()).unwrap();
        assert_eq!(strip.quantity.name, "difference, percentage points");
        let first = &strip.lines[0];
        assert!((first.value - 30.0).abs() < 1e-9 && (first.low - 20.0).abs() < 1e-9);
        assert!((first.paper.unwrap() - 40.0).abs() < 1e-9, "90 % less 50 %");
        assert_eq!(first.wanted, Some(Wanted { low: 0.0, high: f64::INFINITY }));
        let axis = axis_of([&strip].into_iter());
        assert_eq!((axis.low, axis.high), (-40.0, 40.0));
        let drawn = strip.draw(&axis, "D1: <three> comparisons");
        let read = roxmltree::Document::parse(&drawn).unwrap();
        let of = |class: &str| {
            read.descendants().filter(|n| n.attribute("class") == Some(class)).count()
        };
        assert_eq!(
            [of("holds"), of("fails"), of("open"), of("paper"), of("claimed")],
            [1, 1, 1, 3, 3]
        );
        assert!(drawn.contains("D1: &lt;three&gt; comparisons"));
        let none = Strip::of(&verdict(), &BTreeMap::new()).unwrap();
        assert!(!none.has_paper() && strip.has_paper());
    }

    #[test]
    fn a_claim_without_effect_has_no_strip() {
        let verdict = json!({"id": "D1", "verdict": "cannot-be-tested", "comparisons": []});
        let verdict: ClaimVerdict = serde_json::from_value(verdict).unwrap();
        assert_eq!(Strip::of(&verdict, &published()), None);
    }

    #[test]
    fn the_paper_speaks_only_where_it_prints_both_sides() {
        let mut published = published();
        published.get_mut("success-percent").unwrap()[1].value = None;
        let strip = Strip::of(&verdict(), &published).unwrap();
        assert!(!strip.has_paper());
    }
}
