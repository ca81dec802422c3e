//! What the columns of the tables of an inference from trials say.

use super::{FromTrials, Part};
use crate::table::Column;

/// Returns the columns of what is shown, and how many of them name a row.
pub(super) fn declared(show: Part, question: Option<&FromTrials>) -> (Vec<Column>, usize) {
    let text = Column::text;
    let number = |name: &str, unit: &str, meaning: &str| {
        Column::number(name, unit, meaning).empty_where("there is nothing to compute it from")
    };
    let off = |name: &str, meaning: &str| number(name, "%", meaning);
    match show {
        Part::Summary => {
            (vec![text("what", "What was computed"), number("value", "", "Its value")], 1)
        }
        Part::Choices => (
            vec![
                text("choice", "The factor"),
                text("value", "One of its values"),
                number("prior", "", "Its probability before: its share of the combinations"),
                number("posterior", "", "Its probability after the table was looked at"),
                number("odds", "", "Its odds after over those before: below 1 it loses"),
                text("literal", "Whether it is the paper's own words")
                    .empty_where("it is not, or no value is"),
                number("least", "", "Its probability by that alternative of what cells have in common, of 1 % or more, which favours it least"),
                number("most", "", "The same by that which favours it most"),
            ],
            2,
        ),
        Part::Combinations => {
            let mut columns = vec![Column::count("rank", "Its place by weight")];
            for choice in question.iter().flat_map(|question| &question.choices) {
                columns.push(text(&choice.name, "The value of this factor"));
            }
            columns.extend([
                number("posterior", "", "Its probability after the table was looked at"),
                number("sum", "", "Probability of it and all before it"),
                off("distance", "Root mean square of the log of its means over the printed ones"),
                Column::count("unreached", "Cells that count and that no run of it came to"),
                Column::count("runs", "Runs of it, in all arms"),
            ]);
            let keys = 1 + question.map_or(0, |question| question.choices.len());
            (columns, keys)
        }
        Part::Cells => {
            let factors = question.map_or(&[][..], |question| &question.observed.factors);
            let mut columns: Vec<Column> =
                factors.iter().map(|name| text(name, "A column of the printed table")).collect();
            columns.extend([
                number("printed", "", "Mean that the paper prints, in the unit of its measure"),
                number("expected", "", "Expected mean"),
                number("low", "", "5 % quantile of what a table would print"),
                number("high", "", "95 % quantile of what a table would print"),
                number("least", "", "Least mean of any combination"),
                number("most", "", "Largest mean of any combination"),
                Column::probability(
                    "tail",
                    "Probability of a mean as far out as the printed one, on either side",
                )
                .empty_where("it was not run"),
                text("left-out", "yes: left out of the likelihood").empty_where("it is not"),
            ]);
            (columns, factors.len())
        }
        Part::HeldOut => (
            vec![
                text("held-out", "What kind of part of the table is held out"),
                text("part", "Which part"),
                Column::count("cells", "How many cells it has that count"),
                off(
                    "rms",
                    "Root mean square of the log of what the other cells' posterior expects over the print",
                ),
                off("constant", "The same of the other cells' geometric mean"),
                off("means", "The same of the other cells' geometric means by the baseline's columns"),
                number("worth", "combinations", "How many combinations of equal weight are behind it"),
            ],
            2,
        ),
        Part::Simulated => (
            vec![
                text("choice", "The factor; `combination` for all of them together"),
                Column::count("tables", "Tables made by known combinations"),
                Column::percent("likeliest-percent", "Share by which the truth is the likeliest value")
                    .empty_where("there is no table"),
                Column::percent("by-chance-percent", "Share that a draw of the prior would find"),
                Column::percent(
                    "promised-percent",
                    "Mean probability of the likeliest value: the share that is right where all is well",
                )
                .empty_where("there is no table"),
                Column::percent(
                    "covered-90-percent",
                    "Share of truths among the likeliest values that have 90 % together: 90 or more where all is well",
                )
                .empty_where("there is no table"),
                number("region-90", "", "How many values these are, in the mean"),
            ],
            1,
        ),
        Part::Replicate => (
            vec![
                text("what", "The factor, or what was computed"),
                text("value", "One of its values").empty_where("it is of no factor"),
                number("printed", "", "By the printed table: the probability, or the logarithm"),
                number("low", "", "5 % quantile over replicates"),
                number("median", "", "Median over replicates"),
                number("high", "", "95 % quantile over replicates"),
                Column::percent("likeliest-percent", "Share of replicates by which it is the likeliest value")
                    .empty_where("it is no value of a factor"),
            ],
            2,
        ),
    }
}
