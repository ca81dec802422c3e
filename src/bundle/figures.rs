//! The figures of a bundle: drawn, and told in words for those who cannot see them.

use crate::figure::svg;
use crate::plan::Plan;
use crate::studies::deadline::{self, PolicyGraph};
use crate::studies::prior_map::{self, PlanFigure};
use crate::studies::{
    Condition, FactorValue, FigureLayout, FigureRequest, Findings, Setup, coverage_tables,
};
use std::collections::BTreeMap;

/// A figure of a bundle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawn {
    /// The file.
    pub svg: String,
    /// How to read it, in a sentence or two.
    pub caption: &'static str,
    /// What it shows, for those who cannot see it: its kind, its title, its extremes.
    pub alt: String,
}

/// The figure that `request` asks of `findings`, those of `plan`; `None` where no trial that was run has anything to show in
/// it, as a partial run may leave it: axes alone would look like a result.
pub fn draw(plan: &Plan, findings: &Findings<'_>, request: &FigureRequest) -> Option<Drawn> {
    let (title, tables) = (request.title.as_str(), &plan.experiment.tables);
    let drawn = |svg: String, kind: &str, words: String, caption: &'static str| {
        let alt = [format!("{kind}: {title}"), words];
        let alt = alt.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(". ");
        Drawn { svg, caption, alt }
    };
    Some(match &request.layout {
        FigureLayout::CoverageCurve(curve) => {
            let tables: Vec<_> =
                coverage_tables(tables).into_iter().map(|(_, table)| table).collect();
            let chart = findings.coverage_figure(title, curve, &tables);
            if chart.is_empty() {
                return None;
            }
            drawn(
                chart.to_svg(),
                "Line chart",
                chart.in_words(),
                "Median of the trials with a band from the 10th to the 90th percentile; hollow markers are the paper's \
                 means with one standard deviation.",
            )
        }
        FigureLayout::WorldPlan(wanted) => drawn(
            plan_figure(plan, title, wanted, false),
            "Floor plan",
            String::new(),
            "The world at the height of the laser scanner, with the robot's start.",
        ),
        FigureLayout::PriorOverWorld(wanted) => drawn(
            plan_figure(plan, title, wanted, true),
            "Floor plan with a prior map over it",
            String::new(),
            "The world at the height of the laser scanner; orange, the obstacles of the prior map.",
        ),
        FigureLayout::OutcomeBars(wanted) => {
            let chart = findings.outcome_figure(title, wanted);
            if chart.is_empty() {
                return None;
            }
            let (kind, caption) = if chart.boxes.is_empty() {
                (
                    "Bar chart",
                    "Bars are ours; hollow diamonds under them the paper's. Lines are 95 % intervals.",
                )
            } else {
                (
                    "Dot chart",
                    "Dots are our means with 95 % intervals, boxes the middle half of our trials, n their number; hollow \
                     diamonds under them are the paper's means.",
                )
            };
            drawn(chart.to_svg(), kind, chart.in_words(), caption)
        }
        FigureLayout::OutcomeShares(wanted) => {
            let chart = findings.shares_figure(title, wanted);
            if chart.is_empty() {
                return None;
            }
            drawn(
                chart.to_svg(),
                "Stacked bars",
                chart.in_words(),
                "How trials ended, in percent of all of a condition: thick bars are ours, thin ones under them the paper's.",
            )
        }
        FigureLayout::PublishedScatter(wanted) => {
            let chart = findings.scatter_figure(title, wanted, tables);
            if chart.is_empty() {
                return None;
            }
            drawn(
                chart.to_svg(),
                "Scatter chart",
                chart.in_words(),
                "One point for each number that the paper prints; on the dashed line ours is the same. Those farthest \
                 from it are named.",
            )
        }
        FigureLayout::PolicyGraph(wanted) => {
            let (svg, words) = policy_figure(plan, title, wanted);
            drawn(
                svg,
                "Graph",
                words,
                "The building's whole toposemantic graph, which no robot of the study knows at first, and the policy that the \
                 study's planner makes on it for one leg from the start to the goal within t_d.",
            )
        }
    })
}

fn first<'p>(
    plan: &'p Plan,
    only: &BTreeMap<String, FactorValue>,
) -> Option<(&'p Condition, &'p Setup)> {
    let admits = |condition: &Condition| {
        only.iter().all(|(factor, value)| condition.value(factor) == Some(&value.0))
    };
    plan.experiment.design().find(|(condition, _)| admits(condition))
}

/// The floor plan of the first condition that a figure speaks of; words where the design leaves that combination out.
fn plan_figure(plan: &Plan, title: &str, wanted: &PlanFigure, with_prior: bool) -> String {
    let found = first(plan, &wanted.only).and_then(|(c, s)| Some((c, s.of::<prior_map::Setup>()?)));
    let Some((condition, setup)) = found else {
        return words_alone(title, NO_CONDITION);
    };
    let prior = condition.value("prior").unwrap_or("prior map");
    prior_map::plan_figure(title, setup, &wanted.crossed, with_prior.then_some(prior))
}

/// The policies of the first condition that a figure speaks of, and what they are.
fn policy_figure(plan: &Plan, title: &str, wanted: &PolicyGraph) -> (String, String) {
    let found = first(plan, &wanted.only).and_then(|(_, setup)| setup.of::<deadline::Setup>());
    let Some(setup) = found else {
        return (words_alone(title, NO_CONDITION), NO_CONDITION.to_owned());
    };
    match deadline::policy_chart(title, setup, &wanted.within_s) {
        Ok(chart) => (chart.to_svg(), chart.in_words()),
        Err(why) => (words_alone(title, &why), why),
    }
}

const NO_CONDITION: &str = "no condition of the design has these values";

fn words_alone(title: &str, words: &str) -> String {
    let text = svg::Element::new("text").at("x", 10.0).at("y", 24.0).text(words);
    svg::document(320.0, 36.0, title, [text])
}
