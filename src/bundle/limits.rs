//! What the numbers cannot show: what the manifest states, and what the bundle itself shows.

use crate::plan::{Plan, Selection};
use crate::stats::compatibility::{Agreement, Silence};
use crate::studies::{GridRow, Ledger, Outcome, TableLayout};

/// What a bundle shows by itself, of which limits are told.
#[derive(Debug, Clone, Copy, Default)]
pub struct Exhibited<'a> {
    /// The rows of its tables, in the order in which the manifest asks for them.
    pub tables: &'a [&'a [GridRow]],
    /// The ids of the figures that are drawn.
    pub figures: &'a [&'a str],
    /// How many verdicts compare runs of which some never reached the measure.
    pub censored: usize,
}

/// Returns the limits, one sentence each, the manifest's own first.
pub fn limits(plan: &Plan, ledger: &Ledger, shown: Exhibited<'_>) -> Vec<String> {
    let experiment = &plan.experiment;
    let mut limits = experiment.limits.clone();
    let simulated = "Simulated in two dimensions by Reenact's own simulator, with robots and worlds as sealed here";
    // Who re-enacts nobody's study is not compared with anybody's software.
    limits.push(if experiment.cite.is_some() || !experiment.published.is_empty() {
        format!("{simulated}; the paper's runs used other software.")
    } else {
        format!("{simulated}.")
    });
    if !experiment.overrides.is_empty() {
        limits.push(format!(
            "Not the manifest as written: {} from the command line.",
            counted(experiment.overrides.len(), "value was set", "values were set")
        ));
    }
    let count = |wanted: fn(Outcome) -> bool| {
        ledger.entries().filter(|trial| wanted(trial.outcome())).count()
    };
    let panicked = count(|outcome| outcome == Outcome::PANICKED);
    if panicked > 0 {
        limits.push(format!(
            "{} to run: a fault of the program, not a result.",
            counted(panicked, "trial failed", "trials failed")
        ));
    }
    if experiment.kind.outcomes().contains(&Outcome::EXPLORED) {
        let unfinished =
            count(|outcome| ![Outcome::EXPLORED, Outcome::COVERED].contains(&outcome)) - panicked;
        if unfinished > 0 {
            limits.push(format!(
                "{unfinished} of {} trials ended before everything was explored.",
                ledger.len()
            ));
        }
    }
    limits.extend(cells(plan, shown.tables));
    limits.extend(left_out(plan, shown.figures));
    if !experiment.shared_noise.is_empty() {
        limits.push(format!(
            "Trials that differ in {} alone see the same noise: they are paired, not independent.",
            experiment.shared_noise.join(", ")
        ));
    }
    if shown.censored > 0 {
        limits.push(format!(
            "{} runs of which some never reached the measure: see their details.",
            counted(shown.censored, "verdict compares", "verdicts compare")
        ));
    }
    limits
}

/// Names the figures of the manifest in which no trial has anything to show.
fn left_out(plan: &Plan, figures: &[&str]) -> Option<String> {
    let wanted = plan.experiment.figures.iter();
    let missing: Vec<String> = wanted
        .filter(|request| !figures.contains(&request.id.as_str()))
        .map(|request| format!("\u{201c}{}\u{201d}", request.title))
        .collect();
    let one = "figure is left out, in which no trial of this run has anything to show";
    let several = "figures are left out, in which no trial of this run has anything to show";
    (!missing.is_empty())
        .then(|| format!("{}: {}.", counted(missing.len(), one, several), missing.join(", ")))
}

/// Names the cells that no run reached, and the means of fewer runs than there were.
fn cells(plan: &Plan, tables: &[&[GridRow]]) -> Option<String> {
    let (mut unreached, mut absent, mut left_out, mut fewer) = (0, 0, 0, 0);
    for (request, table) in plan.experiment.tables.iter().zip(tables) {
        if !matches!(request.layout, TableLayout::CoverageTable(_)) {
            continue;
        }
        let all = || table.iter().flat_map(|row| &row.cells);
        let most = all().filter_map(|cell| cell.ours?.n).max().unwrap_or(0);
        let silent = |why| all().filter(|cell| cell.agreement == Agreement::Silent(why)).count();
        unreached += silent(Silence::NotReached);
        absent += silent(Silence::NotInDesign);
        left_out += silent(Silence::NotRun);
        fewer += all().filter_map(|cell| cell.ours?.n).filter(|n| *n < most).count();
    }
    let told = |n: usize, one, several| (n > 0).then(|| counted(n, one, several));
    let unreached = told(unreached, "cell was reached by no run", "cells were reached by no run");
    let absent = told(
        absent,
        "cell belongs to no condition of the design",
        "cells belong to no condition of the design",
    );
    let left_out = told(left_out, "cell was not run", "cells were not run");
    let fewer = (fewer > 0).then(|| {
        let mean = counted(fewer, "mean leaves", "means leave");
        format!(
            "{mean} out runs that never got there, which flatters them (their n stands in the cell)"
        )
    });
    let parts: Vec<String> = [unreached, absent, left_out, fewer].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| format!("Of the coverage tables, {}.", parts.join("; ")))
}

/// Returns in words why a run is partial, from the selection that was sealed with it.
pub fn partial(plan: &Plan, selection: &Selection) -> Option<String> {
    if !plan.partial {
        return None;
    }
    let mut parts = Vec::new();
    if let Some(trials) = selection.trials {
        let trials = counted(trials as usize, "trial", "trials");
        parts.push(format!("{trials} per condition instead of {}", plan.experiment.trials));
    }
    for (factor, values) in &selection.only {
        let labels = &plan.experiment.labels;
        let values: Vec<&str> = values.iter().map(|value| labels.value(factor, value)).collect();
        parts.push(format!("only {} {}", labels.factor(factor), values.join(", ")));
    }
    if let Some((shard, of)) = selection.shard {
        parts.push(format!("only shard {shard} of {of}"));
    }
    if parts.is_empty() {
        parts.push("only part of the study was run".to_owned());
    }
    Some(format!("{}; no claim is judged.", parts.join("; ")))
}

/// Writes a number with its noun: `1 trial failed`, `2 trials failed`.
fn counted(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::{Bundle, Limits, assemble};
    use crate::plan::engine_version;
    use crate::report::content_of;
    use crate::studies::GridCell;
    use crate::studies::TrialRecord;
    use crate::verify::plan_of;

    /// Returns the published quickstart: ten trials without and ten with a floor plan, nothing claimed.
    fn quickstart() -> (Bundle, Plan, Selection) {
        let zip = include_bytes!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/artifacts/quickstart-published.zip"
        ));
        let bundle = Bundle::read(zip, &Limits::default()).unwrap();
        let (plan, selection) = plan_of(&bundle).unwrap();
        (bundle, plan, selection)
    }

    #[test]
    fn a_manifest_speaks_first_and_then_the_bundle() {
        let (bundle, mut plan, selection) = quickstart();
        plan.experiment.limits = vec!["the house is invented".to_owned()];
        plan.experiment.overrides = vec!["seed=7".to_owned()];
        plan.experiment.shared_noise = vec!["prior".to_owned()];
        let mut records = bundle.records().unwrap();
        records[0].outcome = Outcome::PANICKED;
        records[1].outcome = Outcome::STUCK;
        let mut tables = content_of(&bundle, &plan, &selection).unwrap().tables;
        let silent = |cell: &mut GridCell, why| {
            (cell.ours, cell.agreement) = (None, Agreement::Silent(why));
        };
        silent(&mut tables[0].rows[0].cells[0], Silence::NotReached);
        silent(&mut tables[0].rows[0].cells[1], Silence::NotInDesign);
        silent(&mut tables[0].rows[1].cells[0], Silence::NotInDesign);
        silent(&mut tables[0].rows[1].cells[1], Silence::NotRun);
        let few = tables[1].rows[0].cells[1].ours.as_mut().unwrap();
        few.n = Some(3);
        let rows: Vec<&[GridRow]> = tables.iter().map(|table| &table.rows[..]).collect();
        let shown = Exhibited { tables: &rows, censored: 1, ..Exhibited::default() };
        let limits = limits(&plan, &Ledger::of(&records), shown);
        let expected = [
            "the house is invented",
            "Simulated in two dimensions by Reenact's own simulator, with robots and worlds as sealed here; the paper's runs \
             used other software.",
            "Not the manifest as written: 1 value was set from the command line.",
            "1 trial failed to run: a fault of the program, not a result.",
            "1 of 20 trials ended before everything was explored.",
            "Of the coverage tables, 1 cell was reached by no run; 2 cells belong to no condition of the design; 1 cell was \
             not run; 1 mean leaves out runs that never got there, which flatters them (their n stands in the cell).",
            "1 figure is left out, in which no trial of this run has anything to show: \u{201c}Coverage over time\u{201d}.",
            "Trials that differ in prior alone see the same noise: they are paired, not independent.",
            "1 verdict compares runs of which some never reached the measure: see their details.",
        ];
        assert_eq!(limits, expected);
    }

    #[test]
    fn a_study_of_nobody_s_paper_is_not_compared_with_one() {
        let (_, mut plan, _) = quickstart();
        plan.experiment.cite = None;
        plan.experiment.published.clear();
        let limits = limits(&plan, &Ledger::default(), Exhibited::default());
        assert!(limits.iter().any(|limit| limit.ends_with("worlds as sealed here.")), "{limits:?}");
        assert!(limits.iter().all(|limit| !limit.contains("paper")), "{limits:?}");
    }

    /// Checks that a partial run draws what it has, and nothing where it has nothing.
    #[test]
    fn a_figure_of_a_partial_run_shows_what_there_is_or_is_left_out() {
        let (bundle, plan, _) = quickstart();
        let records = bundle.records().unwrap();
        let request = &plan.experiment.figures[0];
        let drawn = |records: &[TrialRecord]| {
            let ledger = Ledger::of(records);
            request.draw(&assemble::findings(&plan, &ledger), &plan.experiment.tables)
        };
        let none = |record: &TrialRecord| record.condition.value("prior") == Some("none");
        let half: Vec<TrialRecord> = records.iter().filter(|r| none(r)).cloned().collect();
        assert_eq!(half.len(), 10);
        let alt = drawn(&half).unwrap().alt;
        assert!(alt.contains("no prior ends at") && !alt.contains("floor plan ends at"), "{alt}");
        assert_eq!(drawn(&[]), None);
    }

    #[test]
    fn a_part_of_a_study_says_which_part() {
        let (_, mut plan, mut selection) = quickstart();
        assert_eq!(partial(&plan, &selection), None);
        plan.partial = true;
        selection.trials = Some(3);
        selection.shard = Some((1, 4));
        selection.only = [("prior".to_owned(), vec!["none".to_owned()])].into();
        assert_eq!(
            partial(&plan, &selection).unwrap(),
            "3 trials per condition instead of 10; only prior knowledge no prior; only shard 1 of 4; no claim is judged."
        );
    }

    #[test]
    fn a_bundle_without_circumstances_is_told_as_that() {
        let (bundle, plan, selection) = quickstart();
        let content = content_of(&bundle, &plan, &selection).unwrap();
        let facts = &content.provenance.facts;
        let of =
            |name: &str| facts.iter().find(|(known, _)| known == name).map(|(_, v)| v.as_str());
        assert!(of("time and machine of the run").unwrap().starts_with("not recorded"));
        let engine = engine_version(plan.experiment.kind);
        assert_eq!((of("engine version"), of("calibration")), (Some(engine.as_str()), None));
        assert!(content.evaluation.basis.starts_with("The bundle does not tell"));
        let lines = content.evaluation.badges.iter().flat_map(|badge| &badge.commands);
        assert!(
            lines
                .map(|c| c.line.as_str())
                .any(|line| line.ends_with(".zip none/0 --html trial.html"))
        );
        assert!(content.provenance.inputs.iter().all(|input| !input.license.is_empty()));
        assert!(content.figures[0].alt.contains("coverage (%)"), "{}", content.figures[0].alt);
    }
}
