//! The columns of a table's tidy form, each declared once: what it says, and how a cell has its value.

use super::Findings;
use super::findings::rounded;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::stats::compatibility::{Agreement, Method};
use crate::table::{Column, Table, Value, unit_of};

/// Columns of a table whose rows are made of cells `C`: CSV and data dictionary both follow from them.
pub struct Columns<'a, C>(Vec<(Column, Reading<'a, C>)>);

/// How a cell has its value of a column.
type Reading<'a, C> = Box<dyn Fn(&C) -> Value + 'a>;

impl<'a, C: 'a> Columns<'a, C> {
    /// Begins without columns.
    pub fn none() -> Self {
        Self(Vec::new())
    }

    /// Adds `column`, in which a cell has `value`.
    #[must_use]
    pub fn with<V: Into<Value>>(mut self, column: Column, value: impl Fn(&C) -> V + 'a) -> Self {
        self.0.push((column, Box::new(move |cell| value(cell).into())));
        self
    }

    /// Adds `column` of computed numbers, to six significant digits.
    #[must_use]
    pub fn number<N: Into<Option<f64>>>(
        self,
        column: Column,
        value: impl Fn(&C) -> N + 'a,
    ) -> Self {
        self.with(column, move |cell| value(cell).into().map(rounded))
    }

    /// Adds a column of the count `name`.
    #[must_use]
    pub fn count(self, name: &str, meaning: &str, value: impl Fn(&C) -> u64 + 'a) -> Self {
        self.with(Column::count(name, meaning), move |cell| whole(value(cell)))
    }

    /// Adds a column of each of the factors `names`, whose values of a cell `values` has in that order.
    #[must_use]
    pub fn factors(
        self,
        names: &[String],
        findings: &Findings<'_>,
        values: fn(&C) -> &Condition,
    ) -> Self {
        names.iter().enumerate().fold(self, |columns, (i, name)| {
            columns.with(findings.factor_column(name), move |cell| {
                values(cell).get(i).map(|(_, value)| value.as_str().to_owned())
            })
        })
    }

    /// Adds five columns that say how a cell agrees with the paper's; `unit` is that of the cell.
    #[must_use]
    pub fn agreement(self, unit: &str, of: fn(&C) -> Agreement) -> Self {
        let one_of = |name: &str, meaning: &str, names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            Column::of_values(name, "", meaning, &names)
        };
        let end = |name: &str, which: &str| {
            let meaning = format!(
                "{which} end of the 95 % interval of ours less the paper's, by that method"
            );
            Column::number(name, unit, &meaning)
                .empty_where("nothing is compared, or by the relative difference")
        };
        let agreement = one_of(
            "agreement",
            "Whether ours agrees with the paper's: compatible where the interval holds 0, apart where not; without spread \
             only how near it is; or why nothing is compared",
            &Agreement::NAMES,
        );
        let method = one_of(
            "agreement-method",
            "How they were compared: shares by Newcombe's interval of the difference, means by the paper's prediction \
             interval, others by the relative difference",
            &Method::ALL.map(Method::name),
        );
        let relative = Column::number(
            "agreement-relative-percent",
            "%",
            "Ours less the paper's, in percent of the paper's",
        );
        self.with(agreement, move |cell| of(cell).name())
            .with(method.empty_where("nothing is compared"), move |cell| {
                of(cell).method().map(Method::name)
            })
            .number(end("agreement-low", "Lower"), move |cell| of(cell).difference().map(|d| d.low))
            .number(end("agreement-high", "Upper"), move |cell| {
                of(cell).difference().map(|d| d.high)
            })
            .number(
                relative.empty_where("the method is another, or the paper prints 0"),
                move |cell| of(cell).relative_percent(),
            )
    }

    /// Returns the tidy table of `cells`, one row each.
    pub(super) fn table(&self, cells: &[C]) -> Table {
        let mut table = Table::new(self.0.iter().map(|(column, _)| column.name.as_str()));
        for cell in cells {
            table.push(self.0.iter().map(|(_, value)| value(cell)).collect());
        }
        table
    }

    /// Returns what the columns say.
    pub(super) fn described(self) -> Vec<Column> {
        self.0.into_iter().map(|(column, _)| column).collect()
    }
}

/// Returns a count as a table holds it.
pub(super) fn whole(n: u64) -> i64 {
    i64::try_from(n).unwrap_or(i64::MAX)
}

/// Returns what a column of the factor `name` says, of these `factors` with their values; `None` where it is none of them.
pub(super) fn of_factor(factors: &[Factor], name: &str) -> Option<Column> {
    let Factor { values, .. } = factors.iter().find(|known| known.name == name)?;
    let meaning = "Factor of the design: study.yaml says what each value stands for";
    Some(Column::of_values(name, unit_of(name), meaning, values))
}
