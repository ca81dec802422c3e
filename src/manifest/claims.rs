//! The claims of a manifest, held against its factors, measures and published tables.

use super::Experiment;
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::{self, Claim};
use crate::document::{Diagnostic, FaultList, Severity};
use crate::studies::prior_map::coverage_at_distance;
use crate::studies::{Setup, StudyKind};

/// Every fault of the experiment's claims.
pub fn check_claims(experiment: &Experiment) -> Vec<Diagnostic> {
    let tree = &experiment.document;
    let mut faults = FaultList::default();
    let mut claims: Vec<Claim> = Vec::new();
    for (i, written) in experiment.claims.iter().enumerate() {
        match serde_json::from_value(written.clone()) {
            Ok(claim) => claims.push(claim),
            Err(_) if faults.is_full(Severity::Error) => faults.count_error(),
            Err(e) => faults.push(
                tree.fault(tree.place(&format!("/claims/{i}")), format!("claim: {e}"))
                    .help("docs/claims.md shows every form with an example"),
            ),
        }
    }
    if !faults.is_empty() {
        return faults.finish();
    }
    let factors: Vec<_> =
        experiment.factors.iter().map(|f| (f.name.clone(), f.values.clone())).collect();
    let published: Vec<String> = experiment.published.keys().cloned().collect();
    let mut measures = measures(experiment.kind);
    for (_, setup) in &experiment.conditions {
        if let Setup::PriorMap(setup) = setup {
            let asked_for = &setup.parameters.measurement.coverage_at_distance_m;
            measures.extend(asked_for.iter().map(|&distance| coverage_at_distance(distance)));
        }
    }
    measures.sort();
    measures.dedup();
    let problems = claims::check_all(&claims, &factors, &measures, &published);
    faults.extend(problems.into_iter().map(|problem| tree.fault(tree.place("/claims"), problem)));
    faults.finish()
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
