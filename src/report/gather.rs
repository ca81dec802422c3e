//! A report's content, gathered from a sealed bundle and the plan made again from it.

use super::content::{
    Assumption, Citation, Figure, Headline, OutcomeCount, ReportContent, ReportTable,
};
use super::evaluation::{Evaluated, evaluation};
use super::inline_svg::described;
use super::origin::provenance;
use super::{claim, limits, tables};
use crate::bundle::{Bundle, assemble};
use crate::plan::{Plan, Selection};
use crate::studies::{FigureLayout, TrialRecord};
use serde_json::Value;

/// What the page of `bundle` says, `plan` and `selection` being those made again from it.
///
/// # Errors
/// Where the records or verdicts cannot be read, in words.
pub fn content_of(
    bundle: &Bundle,
    plan: &Plan,
    selection: &Selection,
) -> Result<ReportContent, String> {
    let records = bundle
        .records()
        .map_err(|faults| faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))?;
    let experiment = &plan.experiment;
    let factors = assemble::factors(plan);
    let findings = assemble::findings(plan, &records, &factors);
    let cite = experiment.cite.as_ref();
    let machine_verdicts =
        bundle.circumstance_files().find(|(path, _)| *path == "claims.json").map(|(_, b)| b);
    let claims =
        claim::rows("results/claims.json", bundle.result("claims.json"), &experiment.claims)?;
    let machine_claims =
        claim::rows("circumstances/claims.json", machine_verdicts, &experiment.claims)?;
    let tables: Vec<ReportTable> =
        experiment.tables.iter().map(|request| tables::table(&findings, request, plan)).collect();
    let headline = headline(bundle, plan, &records);
    let circumstance = bundle.circumstance();
    let trial = plan.trials.first().map(|t| format!("{}/{}", t.condition.slug(), t.trial));
    Ok(ReportContent {
        title: experiment.title.clone(),
        citation: Citation {
            paper: cite.map(|c| c.paper.clone()).unwrap_or_default(),
            section: cite.and_then(|c| c.section.clone()).unwrap_or_default(),
            doi: cite.and_then(|c| c.doi.clone()).unwrap_or_default(),
        },
        authors: experiment.authors.iter().map(|a| a.name.clone()).collect(),
        license: experiment.license.clone().unwrap_or_default(),
        limits: limits::limits(plan, &records, &tables, &claims),
        partial: limits::partial(plan, selection),
        evaluation: evaluation(Evaluated {
            file: &format!("{}-{}.zip", bundle.name(), bundle.results_digest().short()),
            trial: trial.as_deref().unwrap_or_default(),
            trials: headline.trials,
            sim_seconds: headline.sim_seconds,
            partial: plan.partial,
            judged: !claims.is_empty(),
            circumstance: circumstance.as_ref(),
        }),
        headline,
        tables,
        figures: figures(bundle, plan),
        claims,
        machine_claims,
        assumptions: experiment
            .assumptions
            .iter()
            .map(|a| Assumption {
                path: a.path.clone(),
                value: in_words(&a.value),
                why: a.why.clone(),
                tried: None,
            })
            .collect(),
        tried_with: None,
        provenance: provenance(bundle, plan),
    })
}

fn headline(bundle: &Bundle, plan: &Plan, records: &[TrialRecord]) -> Headline {
    let mut outcomes: Vec<OutcomeCount> = Vec::new();
    for record in records {
        let name = record.outcome.name();
        match outcomes.iter_mut().find(|o| o.name == name) {
            Some(outcome) => outcome.count += 1,
            None => outcomes.push(OutcomeCount { name: name.to_owned(), count: 1 }),
        }
    }
    outcomes.sort_by(|a, b| b.count.cmp(&a.count).then(a.name.cmp(&b.name)));
    Headline {
        study: plan.resolved_json()["study"].as_str().unwrap_or_default().to_owned(),
        trials: records.len() as u64,
        conditions: bundle.conditions().len() as u64,
        outcomes,
        sim_seconds: records.iter().map(|r| r.sim_seconds).sum(),
        seed: plan.experiment.seed,
        results_digest: bundle.results_digest().hex(),
        bundle_id: bundle.bundle_id().map(|id| id.hex()).unwrap_or_default(),
        engine_version: bundle.engine().to_owned(),
    }
}

fn figures(bundle: &Bundle, plan: &Plan) -> Vec<Figure> {
    plan.experiment
        .figures
        .iter()
        .filter_map(|request| {
            let file = format!("figures/{}.svg", request.id);
            let svg = String::from_utf8_lossy(bundle.result(&file)?).into_owned();
            let (caption, kind) = match &request.layout {
                FigureLayout::CoverageCurve(_) => (
                    "Median of the trials with a band from the 10th to the 90th percentile; hollow markers are the \
                     paper's means with one standard deviation.",
                    "Line chart",
                ),
                FigureLayout::WorldPlan(_) => (
                    "The world at the height of the laser scanner, with the robot's start.",
                    "Floor plan",
                ),
                FigureLayout::PriorOverWorld(_) => (
                    "The world at the height of the laser scanner; orange, the obstacles of the prior map.",
                    "Floor plan with a prior map over it",
                ),
                FigureLayout::OutcomeBars(_) => (
                    "Bars are ours with 95 % intervals; hollow markers are the paper's numbers.",
                    "Bar chart",
                ),
            };
            Some(Figure {
                id: request.id.clone(),
                title: request.title.clone(),
                caption: caption.to_owned(),
                alt: format!("{kind}: {}", described(&svg, &request.title)),
                svg,
                file: format!("results/{file}"),
            })
        })
        .collect()
}
/// A value as one would say it; of one that depends on a factor, `17.5 for department-south, 5.6 for house`.
fn in_words(value: &Value) -> String {
    let Some(values) = value.get("by").and(value.get("values")).and_then(Value::as_object) else {
        return value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    };
    let mut words: Vec<String> =
        values.iter().map(|(level, value)| format!("{} for {level}", in_words(value))).collect();
    if let Some(otherwise) = value.get("otherwise").filter(|otherwise| !otherwise.is_null()) {
        words.push(format!("{} otherwise", in_words(otherwise)));
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_that_depend_on_a_factor_are_told_level_by_level() {
        assert_eq!(in_words(&json!("nearest")), "nearest");
        assert_eq!(in_words(&json!(0.25)), "0.25");
        let by = json!({"by": "start", "values": {"A": 60, "B": {"by": "prior", "values": {"none": 1}}}, "otherwise": 15});
        assert_eq!(in_words(&by), "60 for A, 1 for none for B, 15 otherwise");
    }
}
