use super::*;
use crate::rng::Seeds;
use serde_json::json;

fn observed() -> Observed {
    let mut cells = Vec::new();
    for (start, deadlines) in [("A", [680, 68]), ("B", [2899, 290])] {
        for deadline in deadlines {
            for strategy in ["random", "frontier"] {
                cells.push(ObservedCell {
                    levels: vec![start.to_owned(), deadline.to_string(), strategy.to_owned()],
                    counts: [30, 15, 5],
                    time_s: None,
                    left_out: false,
                });
            }
        }
    }
    cells[7].left_out = true;
    Observed {
        outcomes: ["reached".to_owned(), "collided".to_owned()],
        factors: ["start", "deadline-s", "strategy"].map(str::to_owned).to_vec(),
        cells,
        left_out: Vec::new(),
    }
}

#[test]
fn deadlines_have_ranks_within_their_start() {
    assert_eq!(observed().ranks(1), [0, 0, 1, 1, 0, 0, 1, 1]);
    assert_eq!(observed().ranks(0), [0, 0, 0, 0, 1, 1, 1, 1]);
    assert_eq!(observed().ranks(2), [0, 1, 0, 1, 0, 1, 0, 1]);
}

#[test]
fn a_chequerboard_has_two_halves_and_what_is_left_out_is_in_neither() {
    let observed = observed();
    let [even, odd] = &HoldOut::chequerboard(&observed)[..] else { panic!("two") };
    for cell in 0..8 {
        assert_ne!(even.held[cell], odd.held[cell]);
        assert_eq!(even.trains(&observed, cell), odd.tests(&observed, cell));
    }
    assert!(!odd.trains(&observed, 7) && !odd.tests(&observed, 7));
    let parts = HoldOut::levels_of(&observed, 1);
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["deadline-s 1", "deadline-s 2"]);
    let names: Vec<String> =
        HoldOut::levels_of(&observed, 2).into_iter().map(|part| part.name).collect();
    assert_eq!(names, ["random", "frontier"]);
}

#[test]
fn priors_reach_from_end_to_end() {
    let prior = |distribution| Prior { path: "a.b".to_owned(), distribution, literal: None };
    let hazard = prior(Distribution::LogUniform([0.01, 1.0]));
    assert!((hazard.at(0.5) - 0.1).abs() < 1e-12 && hazard.at(0.0) == 0.01);
    let rule = prior(Distribution::Values(vec![json!("uniform"), json!("nearest")]));
    assert_eq!([0.0, 0.49, 0.5, 1.0].map(|share| rule.at(share)), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(rule.written(1.0), json!("nearest"));
}

#[test]
fn points_are_one_in_every_stratum() {
    let mut stream = Seeds::new(3, Vec::new()).stream("points");
    let points = stratified(2, 8, &mut stream);
    for prior in 0..2 {
        let mut strata: Vec<f64> = points.iter().map(|p| (p[prior] * 8.0).floor()).collect();
        strata.sort_by(f64::total_cmp);
        assert_eq!(strata, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}

#[test]
fn a_proposal_survives_its_record() {
    let inference = Inference {
        observed: observed(),
        priors: vec![Prior {
            path: "rules.frontier.ties".to_owned(),
            distribution: Distribution::Values(vec![json!("uniform"), json!("nearest")]),
            literal: Some(0),
        }],
        times: Some(Times { model_error: vec![0.3], scatter: 0.7, at_least: 8 }),
        concentration: vec![20.0],
        walks: 1,
        points: 1,
        rounds: 1,
        draws: 1,
        simulated_tables: 1,
        hold_outs: vec![HoldOut::nothing(&observed())],
        baseline: Vec::new(),
    };
    let times = vec![Some(120.5), None, Some(3.0), None, None, None, None, None];
    let drawn = Drawn { values: vec![3.0, 1.0, 0.0], cells: vec![[0.25, 0.5]; 8], times };
    let proposal = Proposal {
        ln_evidence: vec![-12.5],
        by_value: vec![vec![f64::NEG_INFINITY, -11.0]],
        draws: vec![drawn.clone()],
        prior: vec![drawn],
        held: Vec::new(),
        simulated: vec![Below { ln_evidence: -3.0, below: Vec::new() }],
    };
    let mut record = crate::bundle::sample::record(7, "none", 0);
    record.measures = proposal.measures();
    for name in record.measures.names() {
        assert!(measure(name).is_some(), "{name}");
    }
    let read = crate::studies::TrialRecord::from_line(&record.to_line()).unwrap();
    let ledger = crate::studies::Ledger::of(&[read]);
    let trial = ledger.entries().next().unwrap();
    assert_eq!(Proposal::of(trial, &inference, 3), Some(proposal));
}

#[test]
fn an_urn_scatters_as_its_concentration_says() {
    let mut stream = Seeds::new(5, Vec::new()).stream("urn");
    let mut variance = |concentration: f64| {
        let counts: Vec<f64> = (0..2000)
            .map(|_| f64::from(setup::draw_counts([0.5, 0.3], concentration, 20, &mut stream)[0]))
            .collect();
        let mean = counts.iter().sum::<f64>() / 2000.0;
        counts.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / 2000.0
    };
    // n p q (n + κ) / (1 + κ): 5 · 24 / 5 with κ = 4, and nearly 5 with a large one.
    assert!((variance(4.0) - 24.0).abs() < 2.0);
    assert!((variance(1e6) - 5.0).abs() < 0.6);
}
