//! The claims of a manifest, held against its factors, measures and published tables.

use super::Experiment;
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::{self, Claim};
use crate::document::Diagnostic;
use crate::studies::prior_map::{
    FURTHER_AT_MILESTONES, MILESTONES, POSE_ERRORS, coverage_at_distance,
};
use crate::studies::{Setup, StudyKind, deadline};

/// Every fault of the experiment's claims.
pub fn check_claims(experiment: &Experiment) -> Vec<Diagnostic> {
    let tree = &experiment.document;
    let mut faults = Vec::new();
    let mut claims: Vec<Claim> = Vec::new();
    for (i, written) in experiment.claims.iter().enumerate() {
        match serde_json::from_value(written.clone()) {
            Ok(claim) => claims.push(claim),
            Err(e) => faults.push(
                tree.fault(tree.place(&format!("/claims/{i}")), format!("claim: {e}"))
                    .help("docs/claims.md shows every form with an example"),
            ),
        }
    }
    if !faults.is_empty() {
        return faults;
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
    faults
}

/// What a claim or table of a study may speak of: success, outcomes and the columns of `results/trials.csv`.
pub(super) fn measures(kind: StudyKind) -> Vec<String> {
    match kind {
        StudyKind::PriorMap => prior_map_measures(),
        StudyKind::Deadline => deadline::measures(),
    }
}

fn prior_map_measures() -> Vec<String> {
    let mut names: Vec<String> = [
        "success",
        "outcome:explored",
        "outcome:stuck",
        "outcome:time-limit",
        "distance-m",
        "time-s",
        "coverage-percent",
        "turning-rad",
        "decisions",
        "frontiers-given-up",
        "contacts",
        "turning-rad-per-m",
        "mean-speed-m-s",
    ]
    .map(str::to_owned)
    .to_vec();
    for percent in MILESTONES {
        names.push(format!("distance-m-at-{percent}"));
        names.push(format!("time-s-at-{percent}"));
        names.extend(FURTHER_AT_MILESTONES.map(|name| format!("{name}-at-{percent}")));
    }
    names.extend(POSE_ERRORS.map(str::to_owned));
    names.extend(WALL_TIME_COLUMNS.map(str::to_owned));
    names
}
