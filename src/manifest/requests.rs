//! What tables ask for, held against factors, measures and published numbers; and what figures ask for like them.

use super::claims::measures;
use super::document::ManifestDoc;
use super::experiment::ResolvedCondition;
use super::faults::{Faults, step};
use super::names::{is_kebab, kebab};
use super::numbers::MEASURE;
use crate::factor::Factor;
use crate::studies::outcomes::OutcomeTable;
use crate::studies::prior_map::{
    AgreementTable, CoverageTable, EffectsTable, MILESTONES, MeasuresTable, ReadingsTable, least_of,
};
use crate::studies::{FactorValue, StudyKind, TableLayout, coverage_tables};
use crate::table::Table;
use std::collections::{BTreeMap, BTreeSet};

/// What requests are held against.
#[derive(Clone, Copy)]
pub(super) struct Requests<'m> {
    /// The manifest that asks.
    pub(super) doc: &'m ManifestDoc,
    /// Its factors.
    pub(super) factors: &'m [Factor],
    /// The numbers that it names and that could be read.
    pub(super) published: &'m BTreeMap<String, Table>,
}

impl<'m> Requests<'m> {
    /// Collects the faults of the requests for tables, and of the ids of figures.
    pub(super) fn check_tables(self, faults: &mut Faults<'_>) {
        let mut ids = BTreeSet::new();
        let tables =
            self.doc.tables.iter().enumerate().map(|(i, t)| (format!("/tables/{i}/id"), &t.id));
        let figures =
            self.doc.figures.iter().enumerate().map(|(i, f)| (format!("/figures/{i}/id"), &f.id));
        for (pointer, id) in tables.chain(figures) {
            if !is_kebab(id) {
                let label = "expected lower-case letters, digits and single hyphens";
                let fault = faults.fault(&pointer, format!("`{id}` cannot be an id")).label(label);
                faults.push(fault.help(format!("for example `{}`", kebab(id))));
            }
            if !ids.insert(id) {
                faults.at(&pointer, format!("the id `{id}` is used twice"), "choose another one");
            }
        }
        for (i, table) in self.doc.tables.iter().enumerate() {
            let pointer = format!("/tables/{i}/{}", table.layout.key());
            self.foreign(&pointer, faults);
            match &table.layout {
                TableLayout::CoverageTable(table) => {
                    self.check_table(table, &pointer, faults);
                }
                TableLayout::AgreementTable(wanted) => {
                    self.check_agreement(wanted, &pointer, faults);
                }
                TableLayout::ReadingsTable(wanted) => {
                    self.check_readings(wanted, &pointer, faults);
                }
                TableLayout::EffectsTable(wanted) => {
                    self.check_effects(wanted, &pointer, faults);
                }
                TableLayout::MeasuresTable(wanted) => {
                    self.check_measures(wanted, &pointer, faults);
                }
                TableLayout::OutcomeTable(table) => {
                    self.check_outcomes(table, &pointer, faults);
                }
                TableLayout::InferenceTable(_) | TableLayout::FromTrialsTable(_) => {
                    let message = "only a manifest with `infer` has what an inference found, and has it without asking";
                    faults.at_key(&pointer, message, "remove this table");
                }
                TableLayout::ManeuverTable(table) => {
                    self.check_only(&table.only, &pointer, faults);
                }
            }
        }
    }

    /// Reports that the layout at `pointer` is another study's.
    pub(super) fn foreign(self, pointer: &str, faults: &mut Faults<'_>) {
        let layout = pointer.rsplit('/').next().unwrap_or_default();
        let owner = StudyKind::all().find(|kind| kind.layouts().contains(&layout));
        if let Some(owner) = owner.filter(|owner| *owner != self.doc.study) {
            let message = format!("the study `{}` has no such layout", self.doc.study.name());
            let label = format!("of the study `{}`", owner.name());
            faults.at_key(pointer, message, &label);
        }
    }

    /// Reports values in `where` that no factor has.
    pub(super) fn check_only(
        self,
        only: &BTreeMap<String, FactorValue>,
        pointer: &str,
        faults: &mut Faults<'_>,
    ) {
        for (name, value) in only {
            let place = step(&format!("{pointer}/where"), name);
            faults.check_level(self.factors, name, value, &place);
        }
    }

    pub(super) fn check_outcomes(
        self,
        table: &OutcomeTable,
        pointer: &str,
        faults: &mut Faults<'_>,
    ) {
        for measure in table.show.measures() {
            check_measure(measure, &format!("{pointer}/show"), &numeric(self.doc.study), faults);
        }
        self.check_only(&table.only, pointer, faults);
        self.check_columns(&table.by, &table.rows, pointer, faults);
        if let Some(over) = &table.over {
            let place = format!("{pointer}/over");
            faults.check_factor(self.factors, over, &place, false);
            if table.by == *over || table.rows.contains(over) {
                let message = format!("no cell takes the values of `{over}` together");
                let label = "it is in `by` or in `rows`, where each has cells of its own";
                faults.at(&place, message, label);
            }
        }
        self.check_beside(table.published.as_ref(), &table.by, &table.rows, pointer, faults);
    }

    fn check_measures(self, wanted: &MeasuresTable, pointer: &str, faults: &mut Faults<'_>) {
        for (i, row) in wanted.rows.iter().enumerate() {
            faults.check_factor(self.factors, row, &format!("{pointer}/rows/{i}"), false);
        }
        let Some((first, rows)) = wanted.rows.split_first() else { return };
        let place = format!("{pointer}/published");
        self.check_published(wanted.published.as_ref(), first, rows, &place, faults);
        let numbers = wanted.published.as_ref().and_then(|name| self.published.get(name));
        if numbers.is_some_and(|numbers| numbers.column(MEASURE).is_none()) {
            let message = format!("the published numbers have no column `{MEASURE}`");
            faults.at(&place, message, "this table needs numbers that say what they measure");
        }
    }

    fn check_table(self, table: &CoverageTable, pointer: &str, faults: &mut Faults<'_>) {
        check_milestones(&table.at, pointer, faults);
        let by = self.factors.iter().find(|factor| factor.name == table.by);
        if let (Some(_), Some(baseline)) = (by, &table.baseline) {
            faults.check_level(self.factors, &table.by, baseline, &format!("{pointer}/baseline"));
        }
        self.check_columns(&table.by, &table.rows, pointer, faults);
        for factor in self.factors.iter().filter(|f| {
            by.is_some()
                && f.values.len() > 1
                && f.name != table.by
                && !table.rows.contains(&f.name)
        }) {
            let message = format!("the table pools all values of the factor `{}`", factor.name);
            let fault =
                faults.key_fault(pointer, message).label("it is neither in `by` nor in `rows`");
            faults.push(fault.help(format!("add `{}` to `rows`", factor.name)).warning());
        }
        self.check_beside(table.published.as_ref(), &table.by, &table.rows, pointer, faults);
    }

    /// Checks that effects are of factors that have something to compare, in runs that share no noise.
    fn check_effects(self, wanted: &EffectsTable, pointer: &str, faults: &mut Faults<'_>) {
        check_milestones(&wanted.at, pointer, faults);
        let mut seen = BTreeSet::new();
        for (key, names) in [("factors", &wanted.factors), ("within", &wanted.within)] {
            for (i, name) in names.iter().enumerate() {
                let place = format!("{pointer}/{key}/{i}");
                let Some(factor) = faults.check_factor(self.factors, name, &place, false) else {
                    continue;
                };
                if !seen.insert(name) {
                    let label = "a factor is either compared or told apart, once";
                    faults.at(&place, format!("`{name}` is asked for twice"), label);
                } else if key == "factors" && factor.values.len() < 2 {
                    let message = format!("the factor `{name}` has one level");
                    faults.at(&place, message, "expected a factor with levels to compare");
                }
            }
        }
        // Sharing matters between conditions that one effect is made from, whichever factor they differ in.
        for name in self.doc.shared_noise.iter().filter(|name| !wanted.within.contains(name)) {
            let message = format!("trials that differ in `{name}` alone see the same noise");
            let fault = faults.fault(&format!("{pointer}/factors"), message);
            let help = format!("remove `{name}` from `shared-noise`");
            faults.push(fault.label("intervals of effects need independent trials").help(help));
        }
        let place = format!("{pointer}/published");
        let Some(numbers) = self.check_known(wanted.published.as_ref(), &place, faults) else {
            return;
        };
        for factor in self.factors {
            let names_a_cell = wanted.within.contains(&factor.name) || factor.values.len() == 1;
            if numbers.column(&factor.name).is_some() && !names_a_cell {
                let message = format!("the published numbers have a column `{}`", factor.name);
                let fault =
                    faults.fault(&place, message).label("which names no cell of this table");
                faults.push(fault.help(format!("add `{}` to `within`", factor.name)));
            }
        }
    }

    /// Checks that agreement is of coverage tables that have something to agree with.
    fn check_agreement(self, wanted: &AgreementTable, pointer: &str, faults: &mut Faults<'_>) {
        self.check_compared(&wanted.tables, pointer, faults);
    }

    /// Checks that readings are of a factor that stands in the rows of every table compared.
    fn check_readings(self, wanted: &ReadingsTable, pointer: &str, faults: &mut Faults<'_>) {
        self.check_compared(&wanted.tables, pointer, faults);
        self.check_only(&wanted.only, pointer, faults);
        let within = wanted.within.iter().enumerate();
        let within = within.map(|(i, name)| (name, format!("{pointer}/within/{i}")));
        let by = (&wanted.by, format!("{pointer}/by"));
        for (name, place) in std::iter::once(by).chain(within) {
            if faults.check_factor(self.factors, name, &place, false).is_none() {
                continue;
            }
            let coverage = coverage_tables(&self.doc.tables).into_iter();
            let mut named = coverage.filter(|(id, _)| wanted.tables.iter().any(|t| t == id));
            if let Some((id, _)) = named.find(|(_, table)| !table.rows.contains(name)) {
                let message = format!("`{name}` is not among the rows of the table `{id}`");
                let fault = faults.fault(&place, message).label("which tells no cell by it");
                faults.push(fault.help(format!("add `{name}` to that table's `rows`")));
            }
        }
    }

    /// Checks that `tables` are coverage tables that have something to be compared with.
    fn check_compared(self, tables: &[String], pointer: &str, faults: &mut Faults<'_>) {
        let coverage: Vec<(&str, &CoverageTable)> = coverage_tables(&self.doc.tables);
        for (i, id) in tables.iter().enumerate() {
            let place = format!("{pointer}/tables/{i}");
            let Some((_, table)) = coverage.iter().find(|(known, _)| known == id) else {
                let known: Vec<&str> = coverage.iter().map(|(id, _)| *id).collect();
                let message = format!("`{id}` is no coverage table of this manifest");
                faults.unknown(
                    &place,
                    message,
                    "expected the id of a `coverage-table`",
                    id,
                    &known,
                );
                continue;
            };
            for (lacks, key) in
                [(table.baseline.is_none(), "baseline"), (table.published.is_none(), "published")]
            {
                if lacks {
                    let message = format!("the table `{id}` has no `{key}`");
                    faults.at(&place, message, "its cells are compared as ratios with the paper's");
                }
            }
        }
    }

    /// Checks the factors that stand side by side and in rows.
    pub(super) fn check_columns(
        self,
        by: &str,
        rows: &[String],
        pointer: &str,
        faults: &mut Faults<'_>,
    ) {
        faults.check_factor(self.factors, by, &format!("{pointer}/by"), false);
        for (i, row) in rows.iter().enumerate() {
            let place = format!("{pointer}/rows/{i}");
            faults.check_factor(self.factors, row, &place, false);
            if *row == by {
                faults.at(&place, format!("`{row}` is among the columns already"), "remove it");
            }
        }
    }

    /// Does [`Self::check_published`] for the layout at `pointer`, which names its numbers in `published`.
    fn check_beside(
        self,
        name: Option<&String>,
        by: &str,
        rows: &[String],
        pointer: &str,
        faults: &mut Faults<'_>,
    ) {
        self.check_published(name, by, rows, &format!("{pointer}/published"), faults);
    }

    /// Reports published numbers that the table cannot stand beside.
    pub(super) fn check_published(
        self,
        name: Option<&String>,
        by: &str,
        rows: &[String],
        place: &str,
        faults: &mut Faults<'_>,
    ) {
        let Some(numbers) = self.check_known(name, place, faults) else { return };
        let name = name.map_or("", String::as_str);
        let for_all = self.doc.published.get(name).map_or(&[][..], |numbers| numbers.for_all());
        for factor in std::iter::once(by).chain(rows.iter().map(String::as_str)) {
            if numbers.column(factor).is_none() && !for_all.iter().any(|name| name == factor) {
                let message = format!("the published numbers `{name}` have no column `{factor}`");
                let fault = faults.fault(place, message).label("asked for by this table");
                let help = format!(
                    "where the paper did not vary it: `{name}: {{file: FILE, for-all: [{factor}]}}`"
                );
                faults.push(fault.help(help));
            }
        }
    }

    /// Returns the published numbers `name`, where they are named, known and could be read.
    fn check_known(
        self,
        name: Option<&String>,
        place: &str,
        faults: &mut Faults<'_>,
    ) -> Option<&'m Table> {
        let name = name?;
        if !self.doc.published.contains_key(name) {
            let known: Vec<&str> = self.doc.published.keys().map(String::as_str).collect();
            let message = format!("unknown published numbers `{name}`");
            faults.unknown(place, message, "not a key of `published`", name, &known);
        }
        self.published.get(name)
    }
}

/// Returns the measures that are columns of numbers: success and outcomes are not.
pub(super) fn numeric(kind: StudyKind) -> Vec<String> {
    let mut known = measures(kind);
    known.retain(|name| name != "success" && !name.starts_with("outcome:"));
    known
}

fn check_measure(measure: &str, place: &str, known: &[String], faults: &mut Faults<'_>) {
    if known.iter().any(|name| name == measure) {
        return;
    }
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let message = format!("trials have no measure `{measure}`");
    faults.unknown(place, message, "asked for by this table", measure, &known);
}

/// Collects the faults of the measures that tables ask for, which depend on what the conditions record.
pub(super) fn check_recorded(
    doc: &ManifestDoc,
    conditions: &[ResolvedCondition],
    faults: &mut Faults<'_>,
) {
    let mut known = numeric(doc.study);
    for ResolvedCondition { setup, .. } in conditions {
        let names = setup.further_measures().into_iter();
        let new: Vec<String> = names.filter(|name| !known.contains(name)).collect();
        known.extend(new);
    }
    for (i, table) in doc.tables.iter().enumerate() {
        let TableLayout::MeasuresTable(wanted) = &table.layout else { continue };
        for (j, measure) in wanted.measures.iter().enumerate() {
            let place = format!("/tables/{i}/measures-table/measures/{j}");
            check_measure(least_of(measure).unwrap_or(measure), &place, &known, faults);
        }
    }
}

fn check_milestones(at: &[u32], pointer: &str, faults: &mut Faults<'_>) {
    for (i, level) in at.iter().enumerate().filter(|(_, l)| !MILESTONES.contains(l)) {
        let message = format!("trials are not measured at {level} % of coverage");
        faults.at(&format!("{pointer}/at/{i}"), message, "expected a multiple of 5 from 50 to 95");
    }
}
