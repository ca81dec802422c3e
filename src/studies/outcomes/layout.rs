//! What is shown of the cells of an outcome table.

use super::{Band, OutcomeCell, OutcomeTable, Percent, Quantity};
use crate::stats::compatibility::Agreement;
use crate::studies::columns::{Columns, whole};
use crate::studies::exhibit::{Abreast, Grid, GridCell, Layout, Lines, Measured, Set, Source};
use crate::studies::{Findings, TableRequest};
use crate::table::{Column, unit_of};

impl Layout for OutcomeTable {
    type Cell = OutcomeCell;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<OutcomeCell> {
        findings.outcome_cells(self)
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, OutcomeCell> {
        let (unit, what, least, most) = match &self.show {
            Quantity::Share(_) => ("%", self.show.describe(), Some(0.0), Some(100.0)),
            Quantity::Percent(Percent { part, whole }) => {
                let what = format!("{part} as a share of {whole}, both summed over trials");
                ("%", what, Some(0.0), Some(100.0))
            }
            Quantity::Mean(measured) => {
                let unit = unit_of(measured);
                (unit, format!("mean of {measured} over the trials that have it"), None, None)
            }
        };
        let number = |name: &str, meaning: &str, empty: &str| {
            let column = Column::number(name, unit, meaning);
            Column { least, most, ..column }.empty_where(empty)
        };
        let few = "no trial, or too few for an interval";
        let columns = Columns::<OutcomeCell>::none()
            .factors(&self.rows, findings, |cell| &cell.rows)
            .with(findings.factor_column(&self.by), |cell| cell.by.clone())
            .number(
                number("value", &sentence(&what), "no trial of the cell has the quantity"),
                |cell| cell.ours.map(|e| e.value),
            )
            .number(number("low", "Lower end of its 95 % interval", few), |cell| {
                cell.ours.and_then(|e| e.interval).map(|(low, _)| low)
            })
            .number(number("high", "Upper end of its 95 % interval", few), |cell| {
                cell.ours.and_then(|e| e.interval).map(|(_, high)| high)
            })
            .number(
                number(
                    "sd",
                    "Standard deviation over trials (n - 1)",
                    "the quantity is a share, or fewer than two trials have it",
                )
                .at_least(0.0),
                |cell| cell.ours.and_then(|e| e.sd),
            )
            .count("n", "Trials behind the value", |cell| cell.ours.map_or(0, |e| e.n))
            .count(
                "trials",
                "All trials of the cell but those in which the program failed",
                |cell| cell.trials,
            )
            .with(
                number("published", "The number that the paper prints", "the paper prints none"),
                |cell| cell.published.map(|(value, _)| value),
            )
            .with(
                Column::count("published-n", "Trials behind the paper's number")
                    .empty_where("the paper does not say"),
                |cell| cell.published.and_then(|(_, n)| n).map(whole),
            )
            .agreement(unit, |cell| cell.agreement);
        let Some(over) = &self.over else { return columns };
        let none = "no trial of the cell has the quantity";
        let quantile = |name: &str, share: &str| {
            let meaning =
                format!("{share} of what each value of `{over}` has by itself, all counted alike");
            number(name, &meaning, none)
        };
        columns
            .number(quantile("over-5", "5 % quantile"), |cell| cell.band.map(|band| band.low))
            .number(quantile("over-50", "Median"), |cell| cell.band.map(|band| band.median))
            .number(quantile("over-95", "95 % quantile"), |cell| cell.band.map(|band| band.high))
            .count("over-n", &format!("Values of `{over}` that have the quantity"), |cell| {
                cell.band.map_or(0, |band| band.of)
            })
    }

    /// Sets the values side by side; where the paper's are asked for, they stand in columns of their own in a document, in the
    /// same column in a terminal.
    fn set(&self, cells: &[OutcomeCell], findings: &Findings<'_>) -> Set {
        let labels = findings.labels;
        let side_by_side = findings.shown_columns(self);
        let rows = labels.factors(&self.rows);
        let is_published = self.published.is_some();
        let abreast = Abreast {
            cells,
            of: side_by_side.len(),
            label: |cell: &OutcomeCell| labels.values(&cell.rows),
        };
        let with = |columns: Vec<String>| [rows.clone(), columns].concat();
        let both = side_by_side.iter().flat_map(|value| {
            [Some(value.clone()), is_published.then(|| format!("{value} (paper)"))]
        });
        let print = abreast.table(with(both.flatten().collect()), |cell| {
            let published = is_published.then(|| cell.published_in_print());
            std::iter::once(cell.in_print()).chain(published)
        });
        let lines = abreast.table(with(side_by_side.clone()), |cell| {
            [if is_published { cell.in_line() } else { cell.ours_in_line() }]
        });
        let is_alone = |cell: &OutcomeCell| cell.agreement.mark().is_empty();
        let over = self.over.as_ref().map(|over| labels.factor(over));
        let band = over.map(|over| {
            format!("in parentheses from 5 to 95 % of what each value of {over} has by itself")
        });
        let legend = is_published.then(|| {
            if cells.iter().any(is_alone) {
                "ours, then the paper's, after \u{b7} where there is nothing to compare"
            } else {
                "ours, then the paper's"
            }
        });
        Set {
            grid: Grid {
                quantity: match over {
                    Some(over) => format!(
                        "{}; small, from 5 to 95 % of what each value of {over} has by itself",
                        self.show.describe()
                    ),
                    None => self.show.describe(),
                },
                beside: "paper",
                source: Source::of(self.published.as_ref()),
                decimals: 1,
                of_trials: true,
                row_header: rows.join(", "),
                columns: side_by_side,
                rows: abreast.rows(grid_cell),
            },
            print: Some(print),
            lines: Lines::all(lines, self.rows.len(), []),
            legend: legend.map(str::to_owned).into_iter().chain(band).collect(),
            more: 0,
        }
    }
}

impl OutcomeCell {
    fn value(&self) -> Option<f64> {
        self.ours.map(|estimate| estimate.value)
    }

    /// Returns ours as text: `54 [40, 67]` (percent and interval) or `12.3 ± 4.5` (mean and standard deviation).
    fn in_print(&self) -> String {
        let Some(ours) = self.ours else {
            return match self.agreement {
                Agreement::Silent(silence) if self.trials == 0 => silence.words().to_owned(),
                _ => format!("none of {}", self.trials),
            };
        };
        if let Some(Band { low, median, high, .. }) = self.band {
            return format!("{:.1} ({low:.1} to {high:.1}, median {median:.1})", ours.value);
        }
        let mut text = match (ours.sd, ours.interval) {
            (Some(sd), _) => format!("{:.1} ± {sd:.1}", ours.value),
            (None, Some((low, high))) => format!("{:.1} [{low:.1}, {high:.1}]", ours.value),
            (None, None) => format!("{:.1}", ours.value),
        };
        if ours.sd.is_some() && ours.n < self.trials {
            text.push_str(&format!(" ({} of {})", ours.n, self.trials));
        }
        text
    }

    /// Returns the paper's as text, after the mark of its agreement; empty where it prints none.
    fn published_in_print(&self) -> String {
        let Some((value, _)) = self.published else { return String::new() };
        match self.agreement.mark() {
            "" => format!("{value}"),
            mark => format!("{mark} {value}"),
        }
    }

    /// Returns ours, how they agree, and the paper's, each in whole numbers: where there is nothing to compare, a dot.
    fn in_line(&self) -> String {
        let mark = match self.agreement.mark() {
            "" => "·",
            mark => mark,
        };
        let papers = whole_number(self.published.map(|(value, _)| value));
        format!("{} {mark} {papers:>2}", self.ours_in_line())
    }

    /// Returns ours in whole numbers, with its band where it has one.
    fn ours_in_line(&self) -> String {
        let value = whole_number(self.value());
        match self.band {
            Some(Band { low, high, .. }) => format!("{value} ({low:.0}-{high:.0})"),
            None => value,
        }
    }
}

fn whole_number(x: Option<f64>) -> String {
    x.map_or("-".to_owned(), |x| format!("{x:.0}"))
}

fn grid_cell(cell: &OutcomeCell) -> GridCell {
    GridCell {
        ours: cell.ours.map(|e| Measured { mean: e.value, sd: e.sd, n: Some(e.n) }),
        published: cell.published.map(|(mean, n)| Measured { mean, sd: None, n }),
        agreement: cell.agreement,
        band: cell.band.map(|band| [band.low, band.high]),
        ..GridCell::default()
    }
}

/// Returns `text` with a capital.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
