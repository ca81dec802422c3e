//! Effects on made-up runs whose logarithms are round numbers.

use super::*;
use crate::condition::Condition;
use crate::factor::Factor;
use crate::stats::assert_close;
use crate::studies::Ledger;
use crate::studies::prior_map::Metric;
use crate::studies::{TrialRecord, fixture};
use crate::table::Table;

/// Gain, ray stop, noise, and ln(distance at 80 %) of each run; `None` never got there.
type Cell = (&'static str, &'static str, &'static str, &'static [Option<f64>]);

const CELLS: [Cell; 6] = [
    ("paper", "uneven", "0.1", &[Some(1.0), Some(1.2)]),
    ("paper", "uneven", "0.01", &[Some(2.0), Some(2.2)]),
    ("released", "uneven", "0.1", &[Some(1.5), Some(1.7)]),
    ("released", "uneven", "0.01", &[Some(2.1), None, Some(2.3)]),
    // No condition of `paper` has this stop: it must not count where gains are compared.
    ("released", "even", "0.1", &[Some(9.0), Some(9.0)]),
    ("released", "even", "0.01", &[None, None]),
];

fn records() -> Vec<TrialRecord> {
    let blank = fixture::blank();
    let mut records = Vec::new();
    for (gain, stop, noise, logs) in CELLS {
        let pairs =
            [("environment", "basic"), ("noise", noise), ("gain", gain), ("ray-stop", stop)];
        for (trial, log) in (0..).zip(logs) {
            let mut record = blank.clone();
            record.trial = trial;
            record.condition = Condition::from(pairs);
            record.measures.insert("distance-m-at-80".to_owned(), log.map(exp));
            // At 70 % from the start: no distance, and no logarithm of it.
            record.measures.insert("distance-m-at-70".to_owned(), Some(0.0));
            records.push(record);
        }
    }
    records
}

fn factors() -> Vec<Factor> {
    [
        ("environment", vec!["basic"]),
        ("noise", vec!["0.1", "0.01"]),
        ("gain", vec!["paper", "released"]),
        ("ray-stop", vec!["uneven", "even"]),
    ]
    .map(|(name, values)| Factor::new(name, values))
    .to_vec()
}

fn published() -> BTreeMap<String, Table> {
    let mut table = Table::new(["environment", "coverage-percent", "value"]);
    for (environment, value) in [("office", 1.0), ("basic", exp(1.0))] {
        table.push(vec![environment.into(), 80.into(), value.into()]);
    }
    [("distance-m".to_owned(), table)].into()
}

pub(super) fn request(factors: &[&str], within: &[&str], at: &[u32]) -> EffectsTable {
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    EffectsTable {
        metric: Metric::DistanceM,
        at: at.to_vec(),
        factors: owned(factors),
        within: owned(within),
        published: Some("distance-m".to_owned()),
    }
}

/// Calls `check` with the findings of [`records`].
pub(super) fn with_findings(check: impl Fn(&Findings<'_>)) {
    let (factors, records, published) = (factors(), records(), published());
    let ledger = Ledger::of(&records);
    let findings = Findings::new(&factors, &ledger, &published);
    check(&findings);
}

#[test]
fn a_level_is_compared_in_conditions_that_differ_in_nothing_else() {
    with_findings(|findings| {
        let effects = findings.effects(&request(&["gain"], &[], &[80]));
        let [effect] = effects.as_slice() else { panic!("{effects:?}") };
        assert_eq!((effect.level.as_str(), effect.against.as_str()), ("released", "paper"));
        assert_eq!((effect.matched, effect.compared), (2, 2), "`even` has no counterpart");
        assert_eq!(effect.runs, Runs { trials: 5, reached: 4 });
        assert_eq!(effect.runs_against, Runs { trials: 4, reached: 4 });
        // (1.6 - 1.1 + 2.2 - 2.1) / 2. Each group's variance is 0.02, so each side's is 0.02 (1/2 + 1/2) / 4 = 0.005 with 2
        // degrees of freedom: standard error 0.1, 4 degrees of freedom, t = 3; t(0.975, 4) = 2.776445.
        assert_close(effect.log_ratio.unwrap(), 0.3, 1e-12);
        assert_close(effect.percent_moved().unwrap(), 34.985_880_757_6, 1e-10);
        let (low, high) = effect.interval_percent().unwrap();
        assert_close(low, 100.0 * (exp(0.3 - 0.277_644_5) - 1.0), 1e-5);
        assert_close(high, 100.0 * (exp(0.3 + 0.277_644_5) - 1.0), 1e-5);
        assert_close(effect.test.unwrap().tails.two_sided, 0.039_941_968, 1e-6);
        // Means of 1.1 and 2.1 at the first level; the paper's is e, so that the gap is 1 - 1.6.
        assert_close(effect.mean_against.unwrap(), exp(1.6), 1e-12);
        assert_close(effect.log_gap().unwrap(), -0.6, 1e-12);
        assert_close(effect.share_of_gap().unwrap(), -0.5, 1e-12);
    });
}

#[test]
fn conditions_that_nobody_finished_are_counted_and_not_compared() {
    with_findings(|findings| {
        let effects = findings.effects(&request(&["ray-stop"], &["noise"], &[70, 80]));
        let cells: Vec<(&str, u32)> =
            effects.iter().map(|e| (e.within[0].1.as_str(), e.percent)).collect();
        assert_eq!(cells, [("0.1", 70), ("0.1", 80), ("0.01", 70), ("0.01", 80)]);
        let [none, some, _, missing] = effects.as_slice() else { panic!("{effects:?}") };
        assert_eq!((none.runs.reached, none.log_ratio), (0, None), "0 m has no logarithm");
        assert_close(some.log_ratio.unwrap(), 7.4, 1e-12);
        assert_eq!((missing.matched, missing.compared), (1, 0));
        assert_eq!((missing.runs.reached, missing.runs.trials), (0, 2));
        assert_eq!((missing.log_ratio, missing.test), (None, None));
    });
}
