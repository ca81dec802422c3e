use super::super::assert_close;
use super::*;

#[expect(clippy::unnecessary_wraps, reason = "as `compare` takes it")]
fn share(successes: u64, trials: u64) -> Result<Ours, Silence> {
    Ok(Ours::Share(Proportion::new(successes, trials)))
}

#[expect(clippy::unnecessary_wraps, reason = "as `compare` takes it")]
fn mean(mean: f64, n: u64) -> Result<Ours, Silence> {
    Ok(Ours::Mean(Summary { n, mean, sd: 99.0 }))
}

#[expect(clippy::unnecessary_wraps, reason = "as `compare` takes it")]
fn printed(value: f64, sd: Option<f64>, n: Option<u64>) -> Option<Printed> {
    Some(Printed { value, sd, n })
}

/// Checks Newcombe 1998, table II, method 10: 56 of 70 against 48 of 80 is 0.0524 to 0.3339. The others by hand with
/// z = 1.959963984540054.
#[test]
fn shares_are_compared_by_newcombes_interval_at_both_numbers_of_trials() {
    for (ours, percent, n, low, high) in [
        ((56, 70), 60.0, 80, 5.243_147_240_236_507, 33.387_265_403_690_606),
        ((28, 50), 26.0, 50, 10.733_112_851_595_045, 46.352_219_555_929_14),
        ((28, 50), 40.0, 50, -3.454_498_998_108_26, 33.842_677_326_249_49),
        ((0, 50), 0.0, 50, -7.134_759_913_335_873, 7.134_759_913_335_873),
    ] {
        let found = Agreement::between(share(ours.0, ours.1), printed(percent, None, Some(n)));
        let difference = found.difference().unwrap();
        assert_close(difference.low, low, 1e-9);
        assert_close(difference.high, high, 1e-9);
        assert_eq!(found.method(), Some(Method::Newcombe));
        assert_eq!(matches!(found, Agreement::Compatible(_)), low <= 0.0, "{found:?}");
    }
}

/// Checks the interval by hand: t(0.975; 9) = 2.262157162798205, times 3 √(1/10 + 1/30): 2.478069. The spread is the
/// paper's, whatever ours is.
#[test]
fn means_are_compared_by_the_papers_prediction_interval() {
    let paper = printed(20.0, Some(3.0), Some(10));
    let found = Agreement::between(mean(22.4, 30), paper);
    let difference = found.difference().unwrap();
    assert_close(difference.low, 2.4 - 2.478_069_013_372_926, 1e-6);
    assert_close(difference.high, 2.4 + 2.478_069_013_372_926, 1e-6);
    assert!(matches!(found, Agreement::Compatible(_)));
    assert!(matches!(Agreement::between(mean(22.5, 30), paper), Agreement::Apart(_)));
    assert!(matches!(Agreement::between(mean(17.4, 30), paper), Agreement::Apart(_)));
}

/// Checks the same quantile and interval by another library.
#[test]
fn the_half_width_is_that_of_statrs() {
    use statrs::distribution::{ContinuousCDF, StudentsT};
    for (n, sd, runs) in [(2_u64, 1.5_f64, 1_u64), (5, 16.42, 50), (10, 3.46, 15)] {
        let found = Agreement::between(mean(7.0, runs), printed(5.0, Some(sd), Some(n)));
        let t = StudentsT::new(0.0, 1.0, real(n) - 1.0).unwrap().inverse_cdf(0.975);
        let half = t * sd * (1.0 / real(n) + 1.0 / real(runs)).sqrt();
        assert_close(found.difference().unwrap().high, 2.0 + half, 1e-6);
    }
}

/// Checks that no sd, and an sd of an unknown number of runs, of one run, or of none at all, give nearness and no
/// compatibility.
#[test]
fn numbers_without_spread_are_only_near_or_far() {
    for (sd, n) in [(None, Some(48)), (Some(2.0), None), (Some(2.0), Some(1)), (Some(0.0), Some(9))]
    {
        let near = |ours| Agreement::between(mean(ours, 12), printed(50.0, sd, n));
        assert_eq!(near(55.0), Agreement::Near(Band::Within10, Some(10.0)));
        assert_eq!(near(40.0), Agreement::Near(Band::Within20, Some(-20.0)));
        assert_eq!(near(60.5), Agreement::Near(Band::Farther, Some(21.0)));
        assert_eq!(near(60.5).difference(), None);
    }
    let of_zero = |ours| Agreement::between(Ok(Ours::Bare(ours)), printed(0.0, None, None));
    assert_eq!(of_zero(0.0), Agreement::Near(Band::Within10, None));
    assert_eq!(of_zero(0.1), Agreement::Near(Band::Farther, None));
    let unknown = Agreement::between(share(1, 2), printed(50.0, None, None));
    assert_eq!(unknown, Agreement::Near(Band::Within10, Some(0.0)));
}

#[test]
fn what_is_missing_says_why() {
    for (in_design, trials, why) in [
        (true, 10, Silence::NotReached),
        (true, 0, Silence::NotRun),
        (false, 0, Silence::NotInDesign),
    ] {
        let silent = Agreement::between(Err(absence(in_design, trials)), printed(1.0, None, None));
        assert_eq!(silent, Agreement::Silent(why));
        assert_eq!((silent.mark(), silent.method()), ("", None));
    }
    assert_eq!(Agreement::between(share(1, 2), None), Agreement::default());
}

/// Checks that marks differ in shape, as names and words do.
#[test]
fn every_answer_has_a_mark_a_name_and_words_of_its_own() {
    let difference = Interval { low: 0.0, high: 1.0, confidence: CONFIDENCE };
    let evidence = Evidence { method: Method::Newcombe, difference };
    let all = [
        Agreement::Compatible(evidence),
        Agreement::Apart(evidence),
        Agreement::Near(Band::Within10, None),
        Agreement::Near(Band::Within20, None),
        Agreement::Near(Band::Farther, None),
        Agreement::Silent(Silence::NotPrinted),
        Agreement::Silent(Silence::NotInDesign),
        Agreement::Silent(Silence::NotRun),
        Agreement::Silent(Silence::NotReached),
    ];
    assert_eq!(all.map(Agreement::name), Agreement::NAMES);
    assert_eq!(all[..5].iter().map(|a| a.mark()).collect::<String>(), "✓≠≈~≉");
    let mut words = all.map(Agreement::words).to_vec();
    words.sort_unstable();
    words.dedup();
    assert_eq!(words.len(), all.len());
}

#[test]
fn methods_are_counted_apart_and_only_those_that_occur_are_explained() {
    let paper = printed(26.0, None, Some(50));
    let found = [
        Agreement::between(share(13, 50), paper),
        Agreement::between(share(50, 50), paper),
        Agreement::between(mean(11.5, 4), printed(10.0, None, None)),
        Agreement::default(),
    ];
    let words: Vec<String> = Tally::of(&found).into_iter().map(Tally::in_words).collect();
    assert_eq!(
        words,
        [
            "1 of 2 published percentages is compatible with ours at 95 %",
            "of 1 published numbers without spread ours lies within 10 % of 0, within 20 % of 1 more, farther from 0",
        ]
    );
    assert_eq!(
        rules(found).unwrap(),
        "shares: ✓ compatible at 95 %, ≠ not, by Newcombe's interval of the difference at both numbers of trials; no sd or \
         no n printed: ≈ within 10 % of the paper's, ~ within 20 %, ≉ farther, a relative difference and no test"
    );
    assert_eq!(rules([Agreement::default()]), None);
}
