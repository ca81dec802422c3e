//! The claims of a manifest, held against its factors, measures and published tables.

use super::experiment::ResolvedCondition;
use super::resolver::Resolver;
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::{self, Claim, Known};
use crate::document::{Content, Diagnostic, Tree, quoted};
use crate::studies::StudyKind;

/// Returns the claims as they are judged: as written, or each once for every value of the factor that `claims-by` names.
pub(super) fn as_judged(resolver: &Resolver<'_>) -> Vec<Claim> {
    let doc = resolver.doc;
    let Some(factor) = &doc.claims_by else { return doc.claims.clone() };
    let known = resolver.factors.iter().find(|known| known.name == *factor);
    let levels = known.map_or(&[][..], |known| known.values.as_slice());
    let each = |claim| levels.iter().map(move |level| Claim::within(claim, factor, level));
    doc.claims.iter().flat_map(each).collect()
}

/// Collects every fault of the claims.
pub(super) fn check(resolver: &mut Resolver<'_>, conditions: &[ResolvedCondition]) {
    let doc = resolver.doc;
    if let Some(factor) = &doc.claims_by {
        resolver.faults.check_factor(&resolver.factors, factor, "/claims-by", false);
    }
    // Faults of those that cannot be read have been collected.
    let published: Vec<String> = doc.published.keys().cloned().collect();
    let mut metrics = measures(doc.study);
    for ResolvedCondition { setup, .. } in conditions {
        metrics.extend(setup.further_measures());
    }
    if resolver.faults.any_error() {
        // A condition that could not be resolved may ask for it.
        let named = doc.claims.iter().flat_map(|claim| claim.expect.metrics());
        metrics.extend(named.filter(|name| doc.study.is_further_measure(name)));
    }
    metrics.sort();
    metrics.dedup();
    let known = Known { factors: &resolver.factors, metrics: &metrics, published: &published };
    for (i, fault) in claims::check_all(&doc.claims, known) {
        let told = format!("claim `{}`: {}", quoted(&doc.claims[i].id), fault.message);
        let faults = &mut resolver.faults;
        if faults.is_full() {
            faults.push(Diagnostic::placeless(told));
            continue;
        }
        let place = as_written(faults.tree, &format!("/claims/{i}{}", fault.pointer));
        let told =
            if fault.at_key { faults.key_fault(&place, told) } else { faults.fault(&place, told) };
        faults.push(match fault.help() {
            Some(help) => told.help(help),
            None => told,
        });
    }
}

/// Returns `pointer` without the numbers of items where one thing is written and no list of them.
fn as_written(tree: &Tree, pointer: &str) -> String {
    let mut found = String::new();
    for part in pointer.split('/').skip(1) {
        let is_list = || match tree.node(&found) {
            Some(node) => matches!(node.content, Content::List(_)),
            None => true,
        };
        if part.parse::<usize>().is_err() || is_list() {
            found = format!("{found}/{part}");
        }
    }
    found
}

/// Returns what a claim or table of a study may speak of: success, outcomes and the columns of `results/trials.csv`.
pub(super) fn measures(kind: StudyKind) -> Vec<String> {
    let outcomes = kind.outcomes().iter().chain(kind.further_outcomes());
    let outcomes = outcomes.map(|outcome| format!("outcome:{}", outcome.name()));
    let mut names: Vec<String> = std::iter::once("success".to_owned()).chain(outcomes).collect();
    names.extend(kind.measures());
    if kind.times_choices() {
        names.extend(WALL_TIME_COLUMNS.map(str::to_owned));
    }
    names
}
