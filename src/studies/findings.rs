//! From records to what a reader sees, as far as all studies share it: the trials table and how cells are chosen.

use super::columns::of_factor;
use super::{Setup, TrialRecord};
use crate::condition::Condition;
use crate::factor::Factor;
use crate::stats::compatibility::{Silence, absence};
use crate::table::{Column, Table, Value};
use std::collections::{BTreeMap, BTreeSet};

/// What the tables and figures of one experiment are made from.
#[derive(Debug, Clone)]
pub struct Findings<'a> {
    /// Factors and their values, in the manifest's order.
    pub factors: &'a [Factor],
    /// The conditions of the whole design, those that a partial run leaves out too.
    pub design: Vec<(&'a Condition, &'a Setup)>,
    /// The records, in plan order.
    pub records: &'a [TrialRecord],
    /// The paper's own numbers, by name: factor columns, `coverage-percent`, `value`, `sd`, `n`.
    pub published: &'a BTreeMap<String, Table>,
    /// The records again, by condition: a table asks for each of its cells, and conditions are far fewer than trials.
    by_condition: Vec<&'a [TrialRecord]>,
}

impl<'a> Findings<'a> {
    /// Creates the findings of `records`, which stand in plan order.
    pub fn new(
        factors: &'a [Factor],
        records: &'a [TrialRecord],
        published: &'a BTreeMap<String, Table>,
    ) -> Self {
        let by_condition = records.chunk_by(|a, b| a.condition == b.condition).collect();
        Self { factors, design: Vec::new(), records, published, by_condition }
    }

    /// Returns the same with the conditions of the whole `design`.
    #[must_use]
    pub fn designed(mut self, design: impl Iterator<Item = (&'a Condition, &'a Setup)>) -> Self {
        self.design = design.collect();
        self
    }

    /// Returns one row a trial: key, factors, number, outcome, then every measure.
    pub fn trials(&self) -> Table {
        let measures: BTreeSet<&str> =
            self.records.iter().flat_map(|r| r.measures.names()).collect();
        let mut measures: Vec<&str> = measures.into_iter().collect();
        // `...-at-95` after `...-at-50`, and the whole trial's measures after those.
        measures.sort_by_key(|name| (!name.contains("-at-"), *name));
        let mut columns = vec!["key".to_owned()];
        columns.extend(self.factors.iter().map(|factor| factor.name.clone()));
        columns.extend(["trial".to_owned(), "outcome".to_owned()]);
        columns.extend(measures.iter().map(|&m| m.to_owned()));
        let mut table = Table::new(columns);
        for record in self.records {
            let mut row: Vec<Value> = vec![record.key.hex().into()];
            row.extend(self.factor_values(&record.condition));
            row.push(i64::from(record.trial).into());
            row.push(record.outcome.name().into());
            row.extend(measures.iter().map(|&m| record.measures.number(m).into()));
            table.push(row);
        }
        table
    }

    /// Returns the values of `factor` that were run, in the manifest's order.
    pub(super) fn values_of(&self, factor: &str) -> Vec<String> {
        let known = self.factors.iter().find(|known| known.name == factor);
        let ran = |value: &String| {
            self.conditions().any(|c| c.iter().any(|(f, v)| f == factor && v == value))
        };
        // Partial runs leave values out.
        known.map_or_else(Vec::new, |known| {
            known.values.iter().filter(|v| ran(v)).cloned().collect()
        })
    }

    /// Returns every combination of values of `factors`, the last one fastest.
    pub(super) fn crossed(&self, factors: &[String]) -> Vec<Condition> {
        let mut crossed = vec![Condition::default()];
        for factor in factors {
            crossed = crossed
                .into_iter()
                .flat_map(|row| {
                    self.values_of(factor)
                        .into_iter()
                        .map(move |value| row.clone().with(factor, value))
                })
                .collect();
        }
        crossed
    }

    /// Returns those combinations of values of `factors` that were run, in the order of [`Self::crossed`].
    pub(super) fn ran(&self, factors: &[String]) -> Vec<Condition> {
        let mut crossed = self.crossed(factors);
        crossed.retain(|cell| self.conditions().any(|condition| condition.has_all(cell)));
        crossed
    }

    /// Returns the records whose condition has all values of `fixed`.
    pub(super) fn matching(&self, fixed: &Condition) -> Vec<&'a TrialRecord> {
        self.by_condition
            .iter()
            .filter(|records| records[0].condition.has_all(fixed))
            .flat_map(|records| records.iter())
            .collect()
    }

    /// Returns the conditions that were run, each as often as it begins anew in plan order.
    fn conditions(&self) -> impl Iterator<Item = &'a Condition> {
        self.by_condition.iter().map(|records| &records[0].condition)
    }

    /// Returns why a cell of these factor values has no number of ours, where `trials` of it were run.
    pub(super) fn absence(&self, fixed: &Condition, trials: u64) -> Silence {
        absence(self.design.iter().any(|(condition, _)| condition.has_all(fixed)), trials)
    }

    /// Returns the row of the published table `name` for the values of `fixed` that it has columns for.
    pub(super) fn published_row(
        &self,
        name: &str,
        fixed: &Condition,
    ) -> Option<(&'a Table, &'a [Value])> {
        let table = self.published.get(name)?;
        let fits = |row: &&Vec<Value>| {
            fixed.iter().all(|(factor, value)| {
                table.column(factor).is_none() || table.value(row, factor).to_string() == *value
            })
        };
        table.rows.iter().find(fits).map(|row| (table, row.as_slice()))
    }

    /// Returns what a column of the factor `name` says.
    pub(super) fn factor_column(&self, name: &str) -> Column {
        of_factor(self.factors, name).unwrap_or_else(|| Column::unknown(name))
    }

    /// Returns the values of `condition` in the order of the factors, as a table holds them.
    pub(super) fn factor_values(&self, condition: &Condition) -> Vec<Value> {
        self.factors
            .iter()
            .map(|factor| condition.value(&factor.name).map(str::to_owned).into())
            .collect()
    }
}

/// Rounds to six significant digits: more would only be noise in a table.
pub(super) fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}
