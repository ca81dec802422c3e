//! `infer:` with `choices`: the factors that are not known, and the table of means that their trials are held against.

use super::document::{FromTrialsDoc, InferenceDoc};
use super::experiment::ResolvedCondition;
use super::faults::{Faults, step};
use super::numbers::MEASURE;
use super::observed::{self, PLACE};
use super::requests::numeric;
use super::resolver::Resolver;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::studies::inference::Cells;
use crate::studies::inference::HoldOut;
use crate::studies::inference::from_trials::{Choice, FromTrials, Means, Part, PrintedMean};
use crate::table::{Table, Value};
use std::collections::BTreeMap;

/// The column of published numbers that says at what coverage they are.
const COVERAGE: &str = "coverage-percent";

/// Reads what is inferred from the trials of `conditions`, where something is; faults where it cannot be.
pub(super) fn read(
    resolver: &mut Resolver<'_>,
    published: &BTreeMap<String, Table>,
    conditions: &[ResolvedCondition],
) -> Option<FromTrials> {
    let doc = resolver.doc.infer.as_ref().and_then(InferenceDoc::from_trials)?;
    let mut measures = numeric(resolver.doc.study);
    for condition in conditions {
        let further = condition.setup.further_measures().into_iter();
        let new: Vec<String> = further.filter(|name| !measures.contains(name)).collect();
        measures.extend(new);
    }
    let asked = Asked { doc, factors: &resolver.factors, published, conditions, measures };
    let faults = &mut resolver.faults;
    for (index, table) in resolver.doc.tables.iter().enumerate() {
        if Part::ALL.iter().any(|(_, id, _)| *id == table.id) {
            let message = format!("the id `{}` is that of a table of the inference", table.id);
            faults.at(&format!("/tables/{index}/id"), message, "choose another one");
        }
    }
    if conditions.iter().any(|condition| condition.setup.is_model()) {
        let message = "choices are inferred from trials in physics";
        let fault = faults.key_fault(PLACE, message).label("these are at graph level");
        faults.push(
            fault.help("simulate with `mission: {simulation: physics}`, or infer by `priors`"),
        );
    }
    asked.read(faults)
}

/// What an inference from trials is read against.
struct Asked<'a> {
    doc: &'a FromTrialsDoc,
    factors: &'a [Factor],
    published: &'a BTreeMap<String, Table>,
    conditions: &'a [ResolvedCondition],
    /// Measures of trials.
    measures: Vec<String>,
}

impl Asked<'_> {
    fn read(&self, faults: &mut Faults<'_>) -> Option<FromTrials> {
        let doc = self.doc;
        // Each part is read whatever the others are, so that all faults are told at once.
        let choices = self.choices(faults);
        self.check_arms(faults);
        let columns = self.columns();
        let names: Vec<&str> = columns.iter().map(String::as_str).collect();
        let kinds = [HoldOut::CHEQUERBOARD, Means::ARM];
        observed::check_hold_outs(&doc.hold_out, &kinds, (&names, "a column of the table"), faults);
        observed::check_baseline(&doc.baseline, (&names, "one of its columns"), faults);
        let mut observed = self.observed(columns, faults)?;
        let rows: Vec<&[String]> = observed.cells.iter().map(|cell| &cell.levels[..]).collect();
        let called = (&observed.factors[..], "one of its columns");
        let (left_out, is_out) = observed::leave_out(&doc.left_out, called, &rows, faults);
        for (cell, is_out) in observed.cells.iter_mut().zip(is_out) {
            cell.left_out = is_out;
        }
        observed.left_out = left_out;
        let choices = choices?;
        self.check_crossed(&choices, &observed, faults);
        let mut hold_outs = vec![HoldOut::nothing(&observed)];
        for kind in &doc.hold_out {
            match observed.factor(kind) {
                Some(column) => hold_outs.extend(HoldOut::levels_of(&observed, column)),
                None if kind == Means::ARM => hold_outs.extend(observed.by_arm()),
                None => hold_outs.extend(HoldOut::chequerboard(&observed)),
            }
        }
        Some(FromTrials {
            observed,
            choices,
            model_error: doc.model_error.clone(),
            arm_error: doc.arm_error.clone(),
            table_error: doc.table_error.clone(),
            simulated_tables: doc.simulated_tables,
            hold_outs,
            baseline: doc.baseline.clone(),
        })
    }

    /// Returns the choices; collects the faults of those that are no factors to choose by.
    fn choices(&self, faults: &mut Faults<'_>) -> Option<Vec<Choice>> {
        let mut choices = Vec::new();
        let mut fine = true;
        for (name, doc) in &self.doc.choices.0 {
            let place = step(&format!("{PLACE}/choices"), name);
            let Some(factor) = faults.check_factor(self.factors, name, &place, true) else {
                fine = false;
                continue;
            };
            if factor.values.len() < 2 {
                let message = format!("the factor `{name}` has one value");
                faults.at_key(&place, message, "expected a factor with values to choose from");
                fine = false;
            }
            if let Some(literal) = &doc.literal {
                fine &=
                    faults.check_level(self.factors, name, literal, &format!("{place}/literal"));
            }
            let literal = doc.literal.as_ref();
            choices.push(Choice {
                name: name.clone(),
                values: factor.values.clone(),
                literal: literal.and_then(|l| factor.values.iter().position(|value| *value == l.0)),
                why: doc.why.clone(),
            });
        }
        fine.then_some(choices)
    }

    fn is_choice(&self, name: &str) -> bool {
        self.doc.choices.0.iter().any(|(choice, _)| choice == name)
    }

    /// Collects the faults of the factors that tell arms apart: they and the choices are all that varies.
    fn check_arms(&self, faults: &mut Faults<'_>) {
        for (index, name) in self.doc.by.iter().enumerate() {
            let place = format!("{PLACE}/by/{index}");
            if faults.check_factor(self.factors, name, &place, false).is_some()
                && self.is_choice(name)
            {
                let message = format!("`{name}` is a choice");
                faults.at(
                    &place,
                    message,
                    "the print cannot tell cells apart by what is not known",
                );
            }
        }
        for factor in self.factors {
            let told = self.doc.by.contains(&factor.name) || self.is_choice(&factor.name);
            if factor.values.len() > 1 && !told {
                let message =
                    format!("the factor `{}` is neither a choice nor in `by`", factor.name);
                let fault = faults.fault(&format!("{PLACE}/by"), message);
                let help = format!("add `{}` to `choices` or to `by`", factor.name);
                faults.push(fault.label("its values would be pooled").help(help));
            }
        }
    }

    /// Returns the columns that tell cells apart.
    fn columns(&self) -> Vec<String> {
        let mut columns = self.doc.by.clone();
        let tables = self.doc.observed.0.iter().filter_map(|(_, name)| self.published.get(name));
        if tables.clone().any(|table| table.column(COVERAGE).is_some()) {
            columns.push(COVERAGE.to_owned());
        }
        if self.doc.observed.0.len() > 1 {
            columns.push(MEASURE.to_owned());
        }
        columns
    }

    /// Returns the table that is to be explained, as far as there are conditions of its arms.
    fn observed(&self, columns: Vec<String>, faults: &mut Faults<'_>) -> Option<Means> {
        let mut means =
            Means { factors: columns, arms: Vec::new(), cells: Vec::new(), left_out: Vec::new() };
        let mut fine = true;
        for (measure, name) in &self.doc.observed.0 {
            let place = step(&format!("{PLACE}/observed"), measure);
            let Some(table) = self.published.get(name) else {
                let known: Vec<&str> = self.published.keys().map(String::as_str).collect();
                let message = format!("unknown published numbers `{name}`");
                faults.unknown(&place, message, "not a key of `published`", name, &known);
                fine = false;
                continue;
            };
            fine &= self.check_columns(name, table, &place, faults)
                && self.add(&mut means, measure, table, &place, faults);
        }
        if fine && means.cells.is_empty() {
            let message = "the observed table prints no cell that this design runs";
            let fault = faults.fault(&format!("{PLACE}/observed"), message);
            faults.push(fault.label("expected rows with the values of its factors"));
            return None;
        }
        fine.then_some(means)
    }

    /// Returns whether the factors of the design tell the rows of `table` apart, and those of `by` are all columns of it.
    fn check_columns(
        &self,
        name: &str,
        table: &Table,
        place: &str,
        faults: &mut Faults<'_>,
    ) -> bool {
        let mut fine = true;
        for column in self.doc.by.iter().filter(|column| table.column(column).is_none()) {
            let message = format!("the published numbers `{name}` have no column `{column}`");
            faults.at(&format!("{PLACE}/by"), message, "asked for to tell cells apart");
            fine = false;
        }
        for factor in self.factors.iter().filter(|f| f.values.len() > 1) {
            if table.column(&factor.name).is_some() && self.is_choice(&factor.name) {
                let message =
                    format!("the published numbers `{name}` have a column `{}`", factor.name);
                faults.at(place, message, "what is printed by its values is no unknown setting");
                fine = false;
            }
        }
        fine
    }

    /// Adds the rows of `table`, means of `measure`, that this design runs; returns whether they say what is needed.
    fn add(
        &self,
        means: &mut Means,
        measure: &str,
        table: &Table,
        place: &str,
        faults: &mut Faults<'_>,
    ) -> bool {
        // A factor with one value that the table has more values of.
        let single = |row: &[Value], factor: &Factor| {
            let [only] = &factor.values[..] else { return true };
            table.column(&factor.name).is_none()
                || table.value(row, &factor.name).to_string() == *only
        };
        for row in &table.rows {
            let arm: Condition = self
                .doc
                .by
                .iter()
                .map(|name| (name.clone(), table.value(row, name).to_string()))
                .collect();
            let run = self.conditions.iter().any(|own| own.condition.has_all(&arm));
            let of = table.column(MEASURE).map(|_| table.value(row, MEASURE).to_string());
            if !run
                || !self.factors.iter().all(|factor| single(row, factor))
                || of.is_some_and(|of| of != measure)
            {
                continue;
            }
            let coverage = table.column(COVERAGE).map(|_| table.value(row, COVERAGE).to_string());
            let recorded = match &coverage {
                Some(percent) => format!("{measure}-at-{percent}"),
                None => measure.to_owned(),
            };
            if !self.measures.contains(&recorded) {
                let known: Vec<&str> = self.measures.iter().map(String::as_str).collect();
                let message = format!("trials have no measure `{recorded}`");
                faults.unknown_key(place, message, "held against the print", &recorded, &known);
                return false;
            }
            let level = |column: &String| match column.as_str() {
                MEASURE => measure.to_owned(),
                COVERAGE => coverage.clone().unwrap_or_default(),
                name => table.value(row, name).to_string(),
            };
            let levels: Vec<String> = means.factors.iter().map(level).collect();
            let number = |column: &str| table.value(row, column).as_f64();
            let (mean, n) =
                (number("value").filter(|x| *x > 0.0), number("n").filter(|x| *x >= 1.0));
            let (Some(mean), Some(n)) = (mean, n) else {
                let message = format!(
                    "the cell `{}` of the observed table does not say what mean above 0 of how many runs it is",
                    levels.join(", ")
                );
                faults.at(place, message, "expected `value` and `n`");
                return false;
            };
            if means.cells.iter().any(|cell| cell.levels == levels) {
                let message = format!("the cell `{}` is printed twice", levels.join(", "));
                faults.at(place, message, "expected one row for each cell");
                return false;
            }
            let known = means.arms.iter().position(|known| *known == arm);
            let arm = known.unwrap_or_else(|| {
                means.arms.push(arm);
                means.arms.len() - 1
            });
            let sd = number("sd").filter(|sd| *sd >= 0.0);
            let measure = recorded;
            means.cells.push(PrintedMean { levels, measure, arm, mean, sd, n, left_out: false });
        }
        true
    }

    /// Collects the first combination of choices that has no condition for an arm of the table.
    fn check_crossed(&self, choices: &[Choice], observed: &Means, faults: &mut Faults<'_>) {
        let combination = |condition: &Condition| -> Condition {
            let values = choices.iter().map(|choice| {
                (choice.name.clone(), condition.value(&choice.name).unwrap_or_default().to_owned())
            });
            values.collect()
        };
        for condition in self.conditions {
            let own = combination(&condition.condition);
            let lacks = observed.arms.iter().find(|arm| {
                let both = |other: &ResolvedCondition| {
                    other.condition.has_all(&own) && other.condition.has_all(arm)
                };
                !self.conditions.iter().any(both)
            });
            if let Some(arm) = lacks {
                let message = format!("the combination `{own}` is not run in the arm `{arm}`");
                let fault = faults.key_fault(&format!("{PLACE}/choices"), message);
                let fault = fault.label("combinations are weighed by the same cells");
                faults.push(fault.help(
                    "add the condition, or leave its arm or its combination out of the design",
                ));
                return;
            }
        }
    }
}
