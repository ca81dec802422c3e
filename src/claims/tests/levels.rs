//! Quantities against bounds, to the last digits of scipy and statsmodels; the call is in the comment.

use super::*;

const X: [f64; 12] = [3.1, 4.1, 5.9, 2.6, 5.3, 5.8, 9.7, 9.3, 2.3, 8.4, 6.2, 6.4];
const Y: [f64; 10] = [7.1, 8.8, 6.5, 9.4, 7.7, 10.2, 8.1, 9.9, 6.9, 8.3];

/// Returns the samples as measures `d` of two groups.
fn measures() -> Table {
    let mut table = Table::new(["key", "group", "trial", "outcome", "d"]);
    for (group, values) in [("first", &X[..]), ("second", &Y[..])] {
        for (trial, d) in (0_i64..).zip(values) {
            let key = format!("{group}{trial}");
            table.push(vec![
                key.into(),
                group.into(),
                trial.into(),
                "explored".into(),
                (*d).into(),
            ]);
        }
    }
    table
}

/// Returns trials of two groups with so many successes.
fn shares(groups: [(&str, i64, i64); 2]) -> Table {
    let mut table = Table::new(["key", "group", "trial", "outcome"]);
    for (group, successes, trials) in groups {
        for trial in 0..trials {
            let outcome = if trial < successes { "reached" } else { "late" };
            table.push(vec!["k".into(), group.into(), trial.into(), outcome.into()]);
        }
    }
    table
}

fn raw(found: &ClaimVerdict) -> (f64, f64) {
    let comparison = &found.comparisons[0];
    (comparison.p_for.unwrap(), comparison.p_against.unwrap())
}

fn interval(found: &ClaimVerdict) -> (f64, f64) {
    let effect = found.comparisons[0].effect.as_ref().unwrap();
    (effect.low, effect.high)
}

fn assert_all_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).for_each(|(found, expected)| assert_close(*found, *expected, 1e-9));
}

#[test]
fn levels_of_measures() {
    // scipy.stats.ttest_1samp(x, 5, alternative='greater'), .confidence_interval(0.9) of the two-sided one
    let mean = verdict_on(&measures(), "{between: {metric: d, where: {group: first}, low: 5}}");
    let (low, high) = interval(&mean);
    assert_all_close(
        &[raw(&mean).0, low, high],
        &[0.156_086_530_783_592_25, 4.472_683_377_697_679, 7.043_983_288_968_985_5],
    );
    // scipy.stats.binomtest(values above 4, 12, alternative='greater'), and of those below
    let median = verdict_on(
        &measures(),
        "{between: {metric: d, where: {group: first}, statistic: median, low: 4}}",
    );
    let (above, below) = raw(&median);
    assert_all_close(&[above, below], &[0.072_998_046_875, 0.980_712_890_625]);
    // scipy.stats.t with delta-method variances of log means and Satterthwaite's degrees of freedom:
    // max(sf((l - log .5) / se), cdf((l - log .9) / se)), exp(l -+ se ppf(.95)) - 1
    let ratio = verdict_on(
        &measures(),
        "{between: {metric: d, where: {group: first}, relative-to: {group: second}, low: -0.5, high: -0.1}}",
    );
    let (low, high) = interval(&ratio);
    assert_all_close(
        &[raw(&ratio).0, low, high, ratio.comparisons[0].effect.as_ref().unwrap().value],
        &[
            0.036_228_025_704_662_9,
            -0.450_808_890_664_172_73,
            -0.121_461_003_712_618_37,
            -0.305_388_017_691_998_5,
        ],
    );
}

#[test]
fn levels_of_shares() {
    // statsmodels.stats.proportion.proportions_ztest(14, 200, value=.15, alternative='smaller', prop_var=.15)
    let level =
        verdict("{between: {metric: success, where: {start: C, strategy: random}, high: 0.15}}");
    assert_close(raw(&level).0, 0.000_766_212_183_488_226_6, 1e-9);
    // scipy.stats.contingency.relative_risk(31, 50, 46, 60).confidence_interval(0.9) less 1, and
    // scipy.stats.norm.sf((log(rr) - log(.6)) / sqrt(1/31 - 1/50 + 1/46 - 1/60))
    let ratio = verdict_on(
        &shares([("a", 31, 50), ("b", 46, 60)]),
        "{between: {metric: success, where: {group: a}, relative-to: {group: b}, low: -0.4}}",
    );
    let (low, high) = interval(&ratio);
    assert_all_close(
        &[raw(&ratio).0, low, high],
        &[0.011_682_886_217_487_965, -0.348_755_515_286_050_5, 0.004_213_737_229_953_551],
    );
}
