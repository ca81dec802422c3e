use super::likelihood::Model;
use super::*;
use crate::factor::Factor;
use crate::math::{exp, ln};
use crate::rng::Seeds;
use crate::stats::{assert_close, real};
use crate::studies::fixture::blank;
use crate::studies::inference::HoldOut;
use crate::studies::{Exhibit, Findings, Ledger, TableRequest, TrialRecord};
use crate::table::Table;
use std::collections::BTreeMap;

const ARMS: [(&str, f64); 3] = [("none", 40.0), ("plan", 24.0), ("footprint", 30.0)];
const LEVELS: [(u32, f64); 2] = [(80, 1.0), (95, 1.6)];

/// Two choices: choosing moves the arms apart, rounding moves nothing.
fn choices() -> Vec<Choice> {
    let choice = |name: &str, values: [&str; 2], literal| Choice {
        name: name.to_owned(),
        values: values.map(str::to_owned).to_vec(),
        literal,
        why: None,
    };
    vec![
        choice("choosing", ["on-arrival", "continuous"], Some(0)),
        choice("rounding", ["down", "near"], None),
    ]
}

fn moved(choosing: &str, prior: &str) -> f64 {
    match (choosing, prior) {
        ("continuous", "plan") => 0.6,
        ("continuous", "footprint") => 1.3,
        _ => 1.0,
    }
}

/// Returns six runs of every condition; `came` says whether runs of one come to a coverage.
fn records(came: impl Fn(&str, &str, u32) -> bool) -> Vec<TrialRecord> {
    let mut records = Vec::new();
    for choosing in ["on-arrival", "continuous"] {
        for rounding in ["down", "near"] {
            for (prior, way) in ARMS {
                let place = vec![("of".to_owned(), format!("{choosing} {rounding} {prior}"))];
                let mut stream = Seeds::new(3, place).stream("runs");
                for trial in 0..6 {
                    let own = way * moved(choosing, prior) * exp(0.08 * stream.normal());
                    let mut record = blank();
                    record.condition =
                        [("choosing", choosing), ("rounding", rounding), ("prior", prior)].into();
                    record.trial = trial;
                    let measures = LEVELS.map(|(level, more)| {
                        let far = own * more * exp(0.03 * stream.normal());
                        let far = came(choosing, prior, level).then_some(far);
                        (format!("distance-m-at-{level}"), far)
                    });
                    record.measures = measures.into();
                    records.push(record);
                }
            }
        }
    }
    records
}

/// Returns what prints the means that `choosing` makes, with a spread of 9 % over ten runs.
fn question(choosing: &str) -> FromTrials {
    let mut observed = Means {
        factors: vec!["prior".to_owned(), "coverage-percent".to_owned()],
        arms: ARMS.map(|(prior, _)| Condition::from([("prior", prior)])).to_vec(),
        cells: Vec::new(),
        left_out: Vec::new(),
    };
    for (level, more) in LEVELS {
        for (arm, (prior, way)) in ARMS.into_iter().enumerate() {
            let mean = way * moved(choosing, prior) * more;
            observed.cells.push(PrintedMean {
                levels: vec![prior.to_owned(), level.to_string()],
                measure: format!("distance-m-at-{level}"),
                arm,
                mean,
                sd: Some(0.09 * mean),
                n: 10.0,
                left_out: false,
            });
        }
    }
    let mut hold_outs = vec![HoldOut::nothing(&observed)];
    hold_outs.extend(HoldOut::chequerboard(&observed));
    hold_outs.extend(observed.by_arm());
    FromTrials {
        observed,
        choices: choices(),
        model_error: vec![0.02, 0.05, 0.1, 0.2],
        arm_error: vec![0.0, 0.15, 0.3],
        table_error: vec![0.0, 0.15],
        simulated_tables: 200,
        hold_outs,
        baseline: vec!["coverage-percent".to_owned()],
    }
}

fn factors() -> Vec<Factor> {
    let factor = |name: &str, values: &[&str]| Factor {
        name: name.to_owned(),
        values: values.iter().map(|value| (*value).to_owned()).collect(),
    };
    vec![
        factor("choosing", &["on-arrival", "continuous"]),
        factor("rounding", &["down", "near"]),
        factor("prior", &["none", "plan", "footprint"]),
    ]
}

/// Hands over what follows from `records` for `question`.
fn answered<T>(
    question: &FromTrials,
    records: &[TrialRecord],
    look: impl FnOnce(&Findings<'_>) -> T,
) -> T {
    let (factors, ledger, published) = (factors(), Ledger::of(records), BTreeMap::new());
    look(&Findings::new(&factors, &ledger, &published).inferring(Some(question)))
}

fn everywhere(_: &str, _: &str, _: u32) -> bool {
    true
}

fn probabilities(question: &FromTrials, records: &[TrialRecord]) -> Vec<Vec<f64>> {
    answered(question, records, |findings| {
        let answer = Answer::of(findings).unwrap();
        let weights = answer.weights();
        (0..2).map(|choice| answer.probabilities(choice, &weights)).collect()
    })
}

#[test]
fn the_setting_that_made_the_table_is_found_and_what_moves_nothing_is_not() {
    for (made_by, index) in [("on-arrival", 0), ("continuous", 1)] {
        let [choosing, rounding] = &probabilities(&question(made_by), &records(everywhere))[..]
        else {
            panic!("two")
        };
        assert!(choosing[index] > 0.97, "{made_by}: {choosing:?}");
        assert!(rounding.iter().all(|share| (0.2..0.8).contains(share)), "{rounding:?}");
    }
}

#[test]
fn the_likelihood_of_one_cell_is_a_normal_density_of_logarithms() {
    let mut question = question("on-arrival");
    for cell in question.observed.cells.iter_mut().skip(1) {
        cell.left_out = true;
    }
    let records = records(everywhere);
    answered(&question, &records, |findings| {
        let answer = Answer::of(findings).unwrap();
        let model = Model::new(findings, &question);
        // Six runs of it, whose spread is pooled over all four combinations; ten printed ones; and the errors 0.1, 0.15 and 0.
        let own: Vec<f64> = records[..6]
            .iter()
            .map(|record| record.measures.number("distance-m-at-80").unwrap())
            .collect();
        let mean = own.iter().sum::<f64>() / 6.0;
        let spread = model.runs.spread(0, 0, |_| None);
        assert!((spread.sqrt() - 0.085).abs() < 0.03, "{spread}");
        let variance = spread / 6.0 + 0.09 * 0.09 / 10.0 + 0.1 * 0.1 + 0.15 * 0.15;
        let off = ln(40.0 / mean);
        let expected = -0.5 * (off * off / variance + ln(2.0 * std::f64::consts::PI * variance));
        // Combinations are in the order of the values of their choices.
        assert_close(answer.ln_likelihoods[0][6], expected, 1e-9);
    });
}

#[test]
fn cells_of_the_same_runs_do_not_count_as_if_each_were_evidence() {
    let odds = |levels: usize| {
        let mut question = question("continuous");
        let first: Vec<PrintedMean> = question.observed.cells[..3].to_vec();
        question.observed.cells = (0..levels).flat_map(|_| first.clone()).collect();
        question.hold_outs = vec![HoldOut::nothing(&question.observed)];
        let all = probabilities(&question, &records(everywhere));
        ln(all[0][1] / all[0][0])
    };
    let (one, eight) = (odds(1), odds(8));
    assert!(one > 1.0, "{one}");
    assert!(eight < 2.0 * one, "the same three cells, eight times: {one} becomes {eight}");
}

#[test]
fn a_cell_that_no_run_came_to_costs_and_does_not_decide_alone() {
    // The setting that made the table does not come to 95 % in one of three arms.
    let late = |choosing: &str, prior: &str, level: u32| {
        (choosing, prior, level) != ("continuous", "footprint", 95)
    };
    let whole = probabilities(&question("continuous"), &records(everywhere))[0][1];
    let lacking = probabilities(&question("continuous"), &records(late))[0][1];
    assert!(lacking < whole && lacking > 0.5, "{whole} {lacking}");
    answered(&question("continuous"), &records(late), |findings| {
        let cells = Answer::of(findings).unwrap().cells();
        assert!(cells.iter().all(Option::is_some), "the other combinations came there");
    });
    let never = |_: &str, prior: &str, level: u32| (prior, level) != ("footprint", 95);
    answered(&question("continuous"), &records(never), |findings| {
        let cells = Answer::of(findings).unwrap().cells();
        assert_eq!(cells.iter().filter(|cell| cell.is_none()).count(), 1);
    });
}

#[test]
fn arms_that_were_not_run_do_not_count_and_combinations_must_have_all_others() {
    let mut records = records(everywhere);
    records.retain(|record| record.condition.value("prior") != Some("footprint"));
    answered(&question("continuous"), &records, |findings| {
        let answer = Answer::of(findings).unwrap();
        assert_eq!(answer.combinations().len(), 4);
        assert_eq!(answer.model.trained(|_| true), [0, 1, 3, 4]);
        assert!(answer.cells()[2].is_none());
    });
    // One combination lacks one of the arms.
    records.retain(|record| {
        record.condition
            != [("choosing", "on-arrival"), ("rounding", "near"), ("prior", "plan")].into()
    });
    answered(&question("continuous"), &records, |findings| {
        let answer = Answer::of(findings).unwrap();
        let names: Vec<String> = (0..3).map(|index| answer.named(index).to_string()).collect();
        assert_eq!(answer.combinations().len(), 3);
        assert!(!names.iter().any(|name| name.contains("on-arrival") && name.contains("near")));
        // On arrival is one of three now: so it was before.
        assert_close(answer.probabilities(0, &answer.before())[0], 1.0 / 3.0, 1e-12);
    });
    let nothing: [TrialRecord; 0] = [];
    answered(&question("continuous"), &nothing, |findings| {
        assert_eq!(Answer::of(findings), None);
    });
}

#[test]
fn predictions_say_which_cells_they_never_match() {
    let mut question = question("continuous");
    // Nothing makes this: without a prior, four times as far, which no error that is allowed explains.
    question.observed.cells[0].mean *= 4.0;
    answered(&question, &records(everywhere), |findings| {
        let cells = Answer::of(findings).unwrap().cells();
        let own = cells[0].as_ref().unwrap();
        assert!(own.tail < 0.02 && own.interval[1] < 160.0 && own.range[1] < 80.0, "{own:?}");
        assert!((own.expected - 40.0).abs() < 4.0, "{own:?}");
        let other = cells[4].as_ref().unwrap();
        assert!(other.tail > 0.1, "{other:?}");
        assert!(other.interval[0] < other.expected && other.expected < other.interval[1]);
    });
}

#[test]
fn held_out_arms_are_predicted_by_the_setting_that_the_others_tell() {
    answered(&question("continuous"), &records(everywhere), |findings| {
        let held = Answer::of(findings).unwrap().held_out();
        let names: Vec<&str> = held.iter().map(|held| held.part.name.as_str()).collect();
        assert_eq!(names, ["even cells", "odd cells", "none", "plan", "footprint"]);
        let plan = &held[3];
        // The footprint's cells tell how locations are chosen, and so where the plan's lie.
        assert_eq!(plan.cells, 2);
        assert!(plan.rms < 0.15 && plan.rms < 0.3 * plan.constant, "{plan:?}");
        assert!(plan.means.unwrap() > 0.5, "the other arms are far from it: {plan:?}");
    });
}

#[test]
fn tables_of_known_combinations_are_judged_as_well_as_they_promise() {
    answered(&question("continuous"), &records(everywhere), |findings| {
        let answer = Answer::of(findings).unwrap();
        let made = answer.simulated();
        assert_eq!(made.len(), 200);
        let found = answer.found(&made);
        let names: Vec<Option<usize>> = found.iter().map(|found| found.choice).collect();
        assert_eq!(names, [Some(0), Some(1), None]);
        for found in &found {
            assert!((found.likeliest - found.promised).abs() < 0.1, "{found:?}");
            assert!(found.covered > 0.85, "{found:?}");
        }
        assert!(found[0].likeliest > 0.9 && found[0].by_chance == 0.5, "{:?}", found[0]);
        assert!(found[1].likeliest < 0.75 && found[1].region > 1.5, "{:?}", found[1]);
        let tail = answer.prior_tail(&made);
        assert!(tail > 0.1, "a table that a combination made is no surprise: {tail}");
    });
}

#[test]
fn a_replicate_explains_the_print_better_than_a_wrong_setting_alone() {
    let odds = |made_by: &str, records: &[TrialRecord]| {
        answered(&question(made_by), records, |findings| {
            let answer = Answer::of(findings).unwrap();
            let found = answer.replicates();
            assert_eq!(found.ln_exact.len(), 200);
            let exact = found.ln_exact.iter().sum::<f64>() / real(200);
            exact - Answer::ln_evidence(&answer.ln_likelihoods)
        })
    };
    let mut wrong = records(everywhere);
    wrong.retain(|record| record.condition.value("choosing") == Some("on-arrival"));
    let (right, wrong) = (odds("continuous", &records(everywhere)), odds("continuous", &wrong));
    assert!(right.abs() < 3.0, "{right}");
    assert!(wrong > right + 3.0, "{wrong} {right}");
}

fn exhibits(findings: &Findings<'_>) -> Vec<Exhibit> {
    let requests: Vec<TableRequest> = Part::requests();
    requests.iter().map(|request| request.exhibit(findings, &requests)).collect()
}

#[test]
fn tables_say_what_was_found_and_what_cannot_be_told() {
    let found = answered(&question("continuous"), &records(everywhere), exhibits);
    let answers: Vec<&str> =
        found.iter().map(|exhibit| exhibit.answer.as_deref().unwrap_or_default()).collect();
    assert!(
        answers[0].starts_with("From 72 trials in physics: 4 combinations, "),
        "{}",
        answers[0]
    );
    for expected in [
        "choosing = continuous (",
        "Not told: rounding = ",
        "The paper's own words, where they win and where they lose: choosing = on-arrival: 0.0",
    ] {
        assert!(answers[1].contains(expected), "{}", answers[1]);
    }
    assert_eq!(answers[3], "Every cell is matched: none has a tail below 0.02.");
    assert!(answers[5].contains("is the likeliest value in fewer than 75 %: rounding ("));
    let ids: Vec<&str> = found.iter().map(|exhibit| exhibit.id.as_str()).collect();
    assert_eq!(
        ids,
        ["summary", "choices", "combinations", "cells", "held-out", "simulated", "replicate"]
    );
    let combinations: &Table = &found[2].tidy;
    assert_eq!(
        combinations.columns,
        ["rank", "choosing", "rounding", "posterior", "sum", "distance", "unreached", "runs"]
    );
    let sums: f64 = combinations.rows.iter().filter_map(|row| row[3].as_f64()).sum();
    assert_close(sums, 1.0, 1e-4);
    // A manifest that infers nothing has none of it.
    let (factors, published) = (factors(), BTreeMap::new());
    let ledger = Ledger::of(&records(everywhere));
    let none = exhibits(&Findings::new(&factors, &ledger, &published));
    assert!(none.iter().all(|exhibit| exhibit.tidy.rows.is_empty() && exhibit.answer.is_none()));
}
