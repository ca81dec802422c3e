//! From records to what a reader sees, as far as all studies share it: the trials table and how cells are chosen.

use super::columns::of_factor;
use super::inference::from_trials::FromTrials;
use super::{Entry, Group, Ledger, Setup};
use crate::condition::Condition;
use crate::factor::Factor;
use crate::labels::{self, Labels};
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
    /// The trials, in plan order.
    pub ledger: &'a Ledger,
    /// The paper's own numbers, by name: factor columns, `coverage-percent`, `value`, `sd`, `n`.
    pub published: &'a BTreeMap<String, Table>,
    /// What readers see for factors and their values.
    pub labels: &'a Labels,
    /// What is inferred from the trials, where something is.
    pub from_trials: Option<&'a FromTrials>,
}

impl<'a> Findings<'a> {
    /// Creates the findings of the trials in `ledger`.
    pub fn new(
        factors: &'a [Factor],
        ledger: &'a Ledger,
        published: &'a BTreeMap<String, Table>,
    ) -> Self {
        let labels = &labels::NONE;
        Self { factors, design: Vec::new(), ledger, published, labels, from_trials: None }
    }

    /// Returns the same with the conditions of the whole `design`.
    #[must_use]
    pub fn designed(mut self, design: impl Iterator<Item = (&'a Condition, &'a Setup)>) -> Self {
        self.design = design.collect();
        self
    }

    /// Returns the same with what readers see for factors and their values.
    #[must_use]
    pub fn labelled(mut self, labels: &'a Labels) -> Self {
        self.labels = labels;
        self
    }

    /// Returns the same with what is inferred from the trials.
    #[must_use]
    pub fn inferring(mut self, from_trials: Option<&'a FromTrials>) -> Self {
        self.from_trials = from_trials;
        self
    }

    /// Returns the names of all measures in the order of their columns.
    pub fn measures(&self) -> Vec<&'a str> {
        let measures: BTreeSet<&str> =
            self.ledger.groups().iter().flat_map(Group::measures).collect();
        let mut measures: Vec<&str> = measures.into_iter().collect();
        // `...-at-95` after `...-at-50`, and the whole trial's measures after those.
        measures.sort_by_key(|name| (!name.contains("-at-"), *name));
        measures
    }

    /// Returns the table of one row a trial without its rows ([`Self::trial_rows`]): key, factors, number, outcome, then every
    /// measure.
    pub fn trials(&self) -> Table {
        let measures = self.measures();
        let mut columns = vec!["key".to_owned()];
        columns.extend(self.factors.iter().map(|factor| factor.name.clone()));
        columns.extend(["trial".to_owned(), "outcome".to_owned()]);
        columns.extend(measures.iter().map(|&m| m.to_owned()));
        Table::new(columns)
    }

    /// Returns the rows of [`Self::trials`], in plan order.
    pub fn trial_rows(&self) -> impl Iterator<Item = Vec<Value>> {
        let measures = self.measures();
        self.ledger.groups().iter().flat_map(move |group| {
            let factors = self.factor_values(group.condition());
            let measures = measures.clone();
            group.entries().map(move |entry| {
                let mut row: Vec<Value> = vec![entry.key().hex().into()];
                row.extend_from_slice(&factors);
                row.push(i64::from(entry.trial()).into());
                row.push(entry.outcome().name().into());
                row.extend(measures.iter().map(|&m| Value::from(entry.number(m))));
                row
            })
        })
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

    /// Returns the trials whose condition has all values of `fixed`.
    pub(super) fn matching(&self, fixed: &Condition) -> Vec<Entry<'a>> {
        let groups = self.ledger.groups().iter();
        let matching = groups.filter(|group| group.condition().has_all(fixed));
        matching.flat_map(Group::entries).collect()
    }

    /// Returns the conditions that were run, each as often as it begins anew in plan order.
    fn conditions(&self) -> impl Iterator<Item = &'a Condition> {
        self.ledger.groups().iter().map(Group::condition)
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
