//! The claims of a manifest, held against its factors, measures and published tables.

use super::resolve::{Resolved, Resolver};
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::{self, Fault, Known};
use crate::document::{Content, Tree};
use crate::studies::prior_map::coverage_at_distance;
use crate::studies::{Setup, StudyKind};

/// Collects every fault of the claims. Where a condition could not be resolved, which has been told, nobody knows what its
/// trials measure.
pub(super) fn check(resolver: &mut Resolver<'_>, published: &[String], conditions: &[Resolved]) {
    let doc = resolver.doc;
    let factors: Vec<_> =
        resolver.factors.iter().map(|f| (f.name.clone(), f.values.clone())).collect();
    let mut metrics = measures(doc.study);
    for (_, setup, ..) in conditions {
        if let Setup::PriorMap(setup) = setup {
            let asked_for = &setup.parameters.measurement.coverage_at_distance_m;
            metrics.extend(asked_for.iter().map(|&distance| coverage_at_distance(distance)));
        }
    }
    metrics.sort();
    metrics.dedup();
    let metrics = (!resolver.faults.any_error()).then_some(&metrics[..]);
    let known = Known { factors: &factors, metrics, published };
    for (i, fault) in claims::check_all(&doc.claims, known) {
        let Fault { pointer, at_key, message, help } = fault;
        let claim = format!("claim `{}`: {message}", crate::document::quoted(&doc.claims[i].id));
        let faults = &mut resolver.faults;
        let place = as_written(faults.tree, &format!("/claims/{i}{pointer}"));
        let told =
            if at_key { faults.key_fault(&place, claim) } else { faults.fault(&place, claim) };
        faults.push(match help {
            Some(help) => told.help(help),
            None => told,
        });
    }
}

/// `pointer` without the numbers of items where one thing is written and no list of them.
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

/// What a claim or table of a study may speak of: success, outcomes and the columns of `results/trials.csv`.
pub(super) fn measures(kind: StudyKind) -> Vec<String> {
    let outcomes = kind.outcomes().iter().map(|(name, _)| format!("outcome:{name}"));
    let mut names: Vec<String> = std::iter::once("success".to_owned()).chain(outcomes).collect();
    names.extend(kind.measures());
    if kind == StudyKind::PriorMap {
        names.extend(WALL_TIME_COLUMNS.map(str::to_owned));
    }
    names
}
