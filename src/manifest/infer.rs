//! `infer:`: the table that is to be explained, the priors, and the conditions that become proposals.

use super::document::{ChoicePriorDoc, InferDoc, InferenceDoc};
use super::experiment::ResolvedCondition;
use super::faults::{Faults, step};
use super::observed;
use super::resolver::Resolver;
use crate::digest::Sha256Digest;
use crate::factor::Factor;
use crate::json;
use crate::studies::Setup;
use crate::studies::inference::{
    Cells, Distribution, HoldOut, Inference, InferenceSetup, Observed, ObservedCell, Prior, Shared,
    Times,
};
use crate::table::Table;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

const PLACE: &str = observed::PLACE;

/// Returns the columns of the observed table as factors without values: no condition varies them.
pub(super) fn columns(doc: &InferDoc) -> impl Iterator<Item = Factor> + '_ {
    doc.by.iter().map(|name| Factor { name: name.clone(), values: Vec::new() })
}

/// Makes every one of the `conditions` a proposal; faults where the inference cannot be made.
pub(super) fn propose(
    resolver: &mut Resolver<'_>,
    published: &BTreeMap<String, Table>,
    conditions: Vec<ResolvedCondition>,
) -> Vec<ResolvedCondition> {
    let doc = resolver.doc.infer.as_ref().and_then(InferenceDoc::from_counts);
    let Some(doc) = doc else { return conditions };
    let (study, seed) = (resolver.doc.study, resolver.doc.seed);
    let faults = &mut resolver.faults;
    let Some(proposing) = study.proposing() else {
        let message = format!("the study `{}` proposes nothing to infer from", study.name());
        faults.at_key(PLACE, message, "remove this key");
        return conditions;
    };
    let Some(inference) = inference(doc, published, faults) else { return conditions };
    if conditions.iter().any(|condition| !condition.setup.is_model()) {
        let message = "an inference rests on trials at graph level";
        let fault = faults.key_fault(PLACE, message).label("these are of another kind");
        faults.push(fault.help("add `mission: {simulation: graph}` to the parameters"));
    }
    // What is refused in many buildings is told of the first one.
    let mut told = BTreeSet::new();
    for condition in &conditions {
        for (path, why) in proposing.refuses(&condition.setup, &inference) {
            let place = path
                .as_ref()
                .map_or(PLACE.to_owned(), |path| step(&format!("{PLACE}/priors"), path));
            let label = match condition.condition.to_string().as_str() {
                "" => "cannot be inferred".to_owned(),
                name => format!("for `{name}`"),
            };
            if told.insert((path, why.clone())) {
                faults.at_key(&place, why, &label);
            }
        }
    }
    if faults.any_error() {
        return conditions;
    }
    let meanings: Vec<Value> = conditions
        .iter()
        .map(|c| serde_json::json!([c.condition.to_string(), c.meanings, c.setup.parameters()]))
        .collect();
    let meaning = Sha256Digest::of(json::canonical(&Value::Array(meanings)));
    let buildings: Vec<Setup> = conditions.iter().map(|c| c.setup.clone()).collect();
    let Some(shared) = Shared::new(inference, study, seed, buildings, meaning) else {
        return conditions;
    };
    let shared = Arc::new(shared);
    let proposed = |condition: ResolvedCondition| {
        let setup = InferenceSetup::new(condition.setup, Arc::clone(&shared));
        ResolvedCondition { setup: Setup::new(setup), ..condition }
    };
    conditions.into_iter().map(proposed).collect()
}

fn inference(
    doc: &InferDoc,
    published: &BTreeMap<String, Table>,
    faults: &mut Faults<'_>,
) -> Option<Inference> {
    // Each part is read whatever the others are, so that all faults are told at once.
    let observed = counts(doc, published, faults);
    let priors: Vec<Option<Prior>> =
        doc.priors.0.iter().map(|(path, prior)| self::prior(path, prior, faults)).collect();
    let columns: Vec<&str> = doc.by.iter().map(String::as_str).collect();
    let kinds = [HoldOut::CHEQUERBOARD];
    observed::check_hold_outs(&doc.hold_out, &kinds, (&columns, "one of `by`"), faults);
    observed::check_baseline(&doc.baseline, (&columns, "one of `by`"), faults);
    let mut observed = observed?;
    let times = times(doc, published, &mut observed, faults)?;
    let priors: Vec<Prior> = priors.into_iter().collect::<Option<_>>()?;
    let mut hold_outs = vec![HoldOut::nothing(&observed)];
    for kind in &doc.hold_out {
        match observed.factor(kind) {
            Some(factor) => hold_outs.extend(HoldOut::levels_of(&observed, factor)),
            None => hold_outs.extend(HoldOut::chequerboard(&observed)),
        }
    }
    Some(Inference {
        observed,
        priors,
        times,
        concentration: doc.concentration.clone(),
        walks: doc.walks,
        points: doc.points,
        rounds: doc.rounds,
        draws: doc.draws,
        simulated_tables: doc.simulated_tables,
        hold_outs,
        baseline: doc.baseline.clone(),
    })
}

/// Reads the counts of the observed table, cell by cell.
fn counts(
    doc: &InferDoc,
    published: &BTreeMap<String, Table>,
    faults: &mut Faults<'_>,
) -> Option<Observed> {
    let mut tables = Vec::new();
    for (outcome, name) in &doc.observed.0 {
        let Some(table) = published.get(name) else {
            let known: Vec<&str> = published.keys().map(String::as_str).collect();
            let message = format!("unknown published numbers `{name}`");
            let place = step(&format!("{PLACE}/observed"), outcome);
            faults.unknown(&place, message, "not a key of `published`", name, &known);
            continue;
        };
        let missing: Vec<&String> =
            doc.by.iter().filter(|column| table.column(column).is_none()).collect();
        for column in &missing {
            let message = format!("the published numbers `{name}` have no column `{column}`");
            faults.at(&format!("{PLACE}/by"), message, "asked for to tell cells apart");
        }
        if missing.is_empty() {
            tables.push((outcome, table));
        }
    }
    let [(first, firsts), (second, seconds)] = &tables[..] else {
        if !faults.any_error() {
            let message = format!("expected two outcomes, found {}", tables.len());
            faults.at(&format!("{PLACE}/observed"), message, "name two; the rest is the third");
        }
        return None;
    };
    let levels = |table: &Table, row: &[crate::table::Value]| -> Vec<String> {
        doc.by.iter().map(|column| table.value(row, column).to_string()).collect()
    };
    let mut cells = Vec::new();
    for row in &firsts.rows {
        let own = levels(firsts, row);
        let other = seconds.rows.iter().find(|other| levels(seconds, other) == own);
        let share = |table: &Table, row: &[crate::table::Value]| {
            let n = firsts.column("n").and_then(|column| {
                firsts.rows.iter().find(|r| levels(firsts, r) == own)?.get(column)?.as_f64()
            });
            Some((table.value(row, "value").as_f64()?, n?))
        };
        let counted = share(firsts, row).zip(other.and_then(|other| share(seconds, other)));
        let Some(((a, n), (b, _))) = counted else {
            let message = format!(
                "the cell `{}` of the observed table does not say what share of how many ended as `{first}` and as `{second}`",
                own.join(", ")
            );
            faults.at(&format!("{PLACE}/observed"), message, "expected `value` and `n` in both");
            return None;
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "shares of counts of trials"
        )]
        let count = |percent: f64| (percent * n / 100.0).round().clamp(0.0, n) as u32;
        let (a, b, all) = (count(a), count(b), count(100.0));
        let b = b.min(all - a);
        let counts = [a, b, all - a - b];
        cells.push(ObservedCell { levels: own, counts, time_s: None, left_out: false });
    }
    let rows: Vec<&[String]> = cells.iter().map(|cell| &cell.levels[..]).collect();
    let (left_out, is_out) =
        observed::leave_out(&doc.left_out, (&doc.by, "one of `by`"), &rows, faults);
    for (cell, left_out) in cells.iter_mut().zip(is_out) {
        cell.left_out = left_out;
    }
    let outcomes = [(*first).clone(), (*second).clone()];
    Some(Observed { outcomes, factors: doc.by.clone(), cells, left_out })
}

/// Puts the mean times into the cells of `observed`, where times are learned from; the outer `None` where they cannot be read.
#[expect(clippy::option_option, reason = "not asked for is no fault")]
fn times(
    doc: &InferDoc,
    published: &BTreeMap<String, Table>,
    observed: &mut Observed,
    faults: &mut Faults<'_>,
) -> Option<Option<Times>> {
    let Some(asked) = &doc.times else { return Some(None) };
    let place = format!("{PLACE}/times/published");
    let Some(table) = published.get(&asked.published) else {
        let known: Vec<&str> = published.keys().map(String::as_str).collect();
        let message = format!("unknown published numbers `{}`", asked.published);
        faults.unknown(&place, message, "not a key of `published`", &asked.published, &known);
        return None;
    };
    let lacking = doc.by.iter().map(String::as_str).chain(["value", "n"]);
    if let Some(column) = lacking.into_iter().find(|column| table.column(column).is_none()) {
        let message = format!(
            "the published numbers `{}` have no column `{column}`, which mean times need",
            asked.published
        );
        faults.at(&place, message, "expected a mean (s) and of how many trials in every row");
        return None;
    }
    let mut found = 0_usize;
    for cell in &mut observed.cells {
        let same = |row: &&Vec<crate::table::Value>| {
            doc.by
                .iter()
                .zip(&cell.levels)
                .all(|(column, level)| table.value(row, column).to_string() == *level)
        };
        let Some(row) = table.rows.iter().find(same) else { continue };
        let number = |column: &str| table.value(row, column).as_f64();
        let (Some(seconds), Some(trials)) = (number("value"), number("n")) else { continue };
        if trials >= f64::from(asked.at_least) && seconds > 0.0 {
            cell.time_s = Some(seconds);
            found += 1;
        }
    }
    if found == 0 {
        let message = format!(
            "no cell of the observed table has a mean time of at least {} trials in `{}`",
            asked.at_least, asked.published
        );
        faults.at(&place, message, "expected rows of the same cells");
        return None;
    }
    if asked.model_error.len() != doc.concentration.len() {
        let message = format!(
            "expected a model error for each of {} concentrations, found {}",
            doc.concentration.len(),
            asked.model_error.len()
        );
        let place = format!("{PLACE}/times/model-error");
        faults.at(&place, message, "in the order of `concentration`");
        return None;
    }
    Some(Some(Times {
        model_error: asked.model_error.clone(),
        scatter: asked.scatter,
        at_least: asked.at_least,
    }))
}

fn prior(path: &str, doc: &ChoicePriorDoc, faults: &mut Faults<'_>) -> Option<Prior> {
    let place = step(&format!("{PLACE}/priors"), path);
    let distribution = match (&doc.values, doc.uniform, doc.log_uniform) {
        (Some(values), None, None) if !values.is_empty() => Distribution::Values(values.clone()),
        (None, Some([low, high]), None) if low < high => Distribution::Uniform([low, high]),
        (None, None, Some([low, high])) if 0.0 < low && low < high => {
            Distribution::LogUniform([low, high])
        }
        _ => {
            let message = format!("nothing can be drawn from the prior of `{path}`");
            let label =
                "expected one of `values`, `uniform: [LOW, HIGH]` and `log-uniform: [LOW, HIGH]`";
            let fault = faults.fault(&place, message).label(label);
            let help = "give one of them; LOW is below HIGH, and above 0 where it is log-uniform";
            faults.push(fault.help(help));
            return None;
        }
    };
    let literal = match (&doc.literal, &distribution) {
        (None, _) => None,
        (Some(literal), Distribution::Values(values)) if values.contains(literal) => {
            values.iter().position(|value| value == literal)
        }
        (Some(literal), _) => {
            let message =
                format!("the literal value `{literal}` of `{path}` is not one of its values");
            faults.at(&format!("{place}/literal"), message, "expected one of `values`");
            return None;
        }
    };
    Some(Prior { path: path.to_owned(), distribution, literal })
}
