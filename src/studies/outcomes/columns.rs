//! What the columns of an outcome table hold.

use super::{OutcomeTable, Percent, Quantity};
use crate::studies::findings::agreement_column;
use crate::table::{Column, unit_of};

/// A column of an outcome table, factors aside.
pub(in crate::studies) fn of_outcome_table(wanted: &OutcomeTable, name: &str) -> Option<Column> {
    let (unit, what, least, most) = match &wanted.show {
        Quantity::Share(_) => ("%", wanted.show.describe(), Some(0.0), Some(100.0)),
        Quantity::Percent(Percent { part, whole }) => {
            let what = format!("{part} as a share of {whole}, both summed over trials");
            ("%", what, Some(0.0), Some(100.0))
        }
        Quantity::Mean(measured) => {
            let unit = unit_of(measured);
            (unit, format!("mean of {measured} over the trials that have it"), None, None)
        }
    };
    let number = |meaning: &str| {
        let column = Column::number(name, unit, meaning);
        Column { least, most, ..column }.empty_where("no trial of the cell has the quantity")
    };
    let few = "no trial, or too few for an interval";
    Some(match name {
        "value" => number(&sentence(&what)),
        "low" => number("Lower end of its 95 % interval").empty_where(few),
        "high" => number("Upper end of its 95 % interval").empty_where(few),
        "sd" => number("Standard deviation over trials (n - 1)")
            .at_least(0.0)
            .empty_where("the quantity is a share, or fewer than two trials have it"),
        "n" => Column::count(name, "Trials behind the value"),
        "trials" => {
            Column::count(name, "All trials of the cell but those in which the program failed")
        }
        "published" => {
            number("The number that the paper prints").empty_where("the paper prints none")
        }
        "published-n" => Column::count(name, "Trials behind the paper's number")
            .empty_where("the paper does not say"),
        _ => return agreement_column(name, unit),
    })
}

/// `text` with a capital.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
