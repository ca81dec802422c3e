//! What the columns of the tables of an inference say.

use super::{Posterior, Shown};
use crate::studies::Findings;
use crate::table::Column;

/// Returns the columns of what is shown.
pub(super) fn declared(show: Shown, findings: &Findings<'_>) -> Vec<Column> {
    let text = Column::text;
    let number = |name: &str, unit: &str, meaning: &str| {
        Column::number(name, unit, meaning).empty_where("there is nothing to compute it from")
    };
    let points = |name: &str, meaning: &str| number(name, "points", meaning);
    match show {
        Shown::Summary => vec![text("what", "What was computed"), number("value", "", "Its value")],
        Shown::Choices => vec![
            text("choice", "Path of the parameter"),
            text("value", "One of its values"),
            number("prior", "", "Its probability before"),
            number("posterior", "", "Its probability after the table was looked at"),
            number("odds", "", "The second over the odds that it had before: below 1 it loses"),
            text("literal", "Whether it is the paper's own words")
                .empty_where("it is not, or no value is"),
        ],
        Shown::Numbers => vec![
            text("number", "Path of the parameter"),
            number("prior-5", "", "5 % quantile before"),
            number("prior-50", "", "Median before"),
            number("prior-95", "", "95 % quantile before"),
            number("posterior-5", "", "5 % quantile after"),
            number("posterior-50", "", "Median after"),
            number("posterior-95", "", "95 % quantile after"),
        ],
        Shown::Cells => {
            let factors = Posterior::of(findings)
                .map_or_else(Vec::new, |p| p.inference().observed.factors.clone());
            let mut columns: Vec<Column> =
                factors.iter().map(|name| text(name, "A column of the observed table")).collect();
            columns.extend([
                Column::percent("printed-percent", "Share that the paper prints"),
                Column::percent("expected-percent", "Expected share"),
                Column::percent("low-percent", "5 % quantile of what a table would print"),
                Column::percent("high-percent", "95 % quantile of what a table would print"),
                Column::percent("least-percent", "Least expectation of any posterior draw"),
                Column::percent("most-percent", "Largest expectation of any posterior draw"),
                Column::probability(
                    "tail",
                    "Probability of a share as far out as the printed one, on either side",
                ),
                text("left-out", "yes: left out of the likelihood").empty_where("it is not"),
            ]);
            columns
        }
        Shown::Times => {
            let seconds = |name: &str, meaning: &str| number(name, "s", meaning);
            let factors = Posterior::of(findings)
                .map_or_else(Vec::new, |p| p.inference().observed.factors.clone());
            let mut columns: Vec<Column> =
                factors.iter().map(|name| text(name, "A column of the observed table")).collect();
            columns.extend([
                seconds("printed-s", "Mean time that the paper prints"),
                seconds("expected-s", "Median of what a table would print"),
                seconds("low-s", "5 % quantile of it"),
                seconds("high-s", "95 % quantile of it"),
                Column::probability(
                    "tail",
                    "Probability of a time as far out as the printed one, on either side",
                ),
                text("left-out", "yes: left out of the likelihood").empty_where("it is not"),
            ]);
            columns
        }
        Shown::HeldOut => vec![
            text("held-out", "What kind of part of the table is held out"),
            text("part", "Which part"),
            Column::count("cells", "How many cells it has"),
            points("rmse", "Distance of what is predicted from the other cells to the print"),
            points("constant", "The same of the other cells' mean"),
            points("means", "The same of the other cells' means by the baseline's factors"),
            number("worth", "buildings", "How many buildings of equal weight are behind it"),
        ],
        Shown::Simulated => vec![
            text("number", "Path of the parameter"),
            Column::count("tables", "Tables made by draws of the prior"),
            Column::probability("mean-rank", "Mean rank of the truth: 0.5 where all is well"),
            Column::probability(
                "rank-sd",
                "Standard deviation of the ranks: 0.29 where all is well",
            ),
            Column::percent("covered-90-percent", "Share of truths within the region of 90 %"),
        ],
        Shown::Posterior => {
            let mut columns = vec![Column::count("draw", "Number of the draw; all are as likely")];
            columns.push(number("weight", "", "Weight of its building among all"));
            let factors = findings.factors.iter();
            columns.extend(factors.map(|factor| findings.factor_column(&factor.name)));
            let Some(posterior) = Posterior::of(findings) else { return columns };
            let inference = posterior.inference();
            for place in posterior.shared().proposing().placements(inference) {
                columns.push(text(&place, "The vertex, by its tag"));
                let at = |axis: &str| format!("{place}-{axis}-m");
                columns.push(number(&at("x"), "m", "Its position"));
                columns.push(number(&at("y"), "m", "Its position"));
            }
            for prior in &inference.priors {
                columns.push(if prior.is_continuous() {
                    number(&prior.path, "", "The parameter of this path")
                } else {
                    text(&prior.path, "The parameter of this path")
                });
            }
            columns.push(number("concentration", "", "How much the model is trusted"));
            columns.push(points("rmse", "Distance of its expectations to the print"));
            columns
        }
    }
}
