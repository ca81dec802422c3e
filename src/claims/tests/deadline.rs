//! The deadline study's claims, judged on the very trials that its Tables 1 and 2 count.

use super::*;
use crate::factor::Factor;

const MANIFEST: &str = include_str!("../../../manifests/deadline.yaml");

fn printed(name: &str) -> Table {
    let text = match name {
        "success-percent" => include_str!("../../../manifests/reference/deadline-success.csv"),
        "collision-percent" => include_str!("../../../manifests/reference/deadline-collision.csv"),
        "late-percent" => include_str!("../../../manifests/reference/deadline-late.csv"),
        _ => include_str!("../../../manifests/reference/deadline-time.csv"),
    };
    Table::from_csv(text).unwrap()
}

/// Returns the printed number of a cell, if there is one.
fn number(table: &Table, cell: &[String; 3]) -> Option<f64> {
    let names = ["start", "deadline-s", "strategy"];
    let here = |row: &&Vec<Value>| {
        names.iter().zip(cell).all(|(name, value)| table.value(row, name).to_string() == *value)
    };
    table.rows.iter().find(here).and_then(|row| table.value(row, "value").as_f64())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "trials of fifty")]
fn of_fifty(percent: f64) -> u64 {
    (percent / 2.0).round() as u64
}

/// Returns fifty trials a cell, ended as Tables 1 and 2 count them. `corridors-first` from B within 2899 s sums to
/// 98 %: its missing trial counts as late. No spread of times is printed; these lie within a tenth of their mean.
fn as_printed_in_full() -> Table {
    let tables = ["success-percent", "collision-percent", "late-percent", "time-s"].map(printed);
    let columns = ["key", "start", "deadline-s", "strategy", "trial", "outcome", "time-s"];
    let mut trials = Table::new(columns);
    let mut missing = Vec::new();
    for row in &tables[0].rows {
        let cell = ["start", "deadline-s", "strategy"].map(|f| tables[0].value(row, f).to_string());
        let [reached, collided, late] =
            [0, 1, 2].map(|table| of_fifty(number(&tables[table], &cell).unwrap()));
        if reached + collided + late != 50 {
            missing.push((cell.join(" "), reached + collided + late));
        }
        let mean = number(&tables[3], &cell);
        assert_eq!(mean.is_none(), reached == 0, "{cell:?}");
        for trial in 0..50 {
            let (outcome, time) = if trial < reached {
                let offset = crate::stats::real(2 * trial + 1) / crate::stats::real(reached) - 1.0;
                ("reached", mean.map(|mean| mean * (1.0 + 0.1 * offset)))
            } else if trial < reached + collided {
                ("collided", None)
            } else {
                ("late", None)
            };
            let mut line: Vec<Value> = vec![format!("{}-{trial}", cell.join("-")).into()];
            line.extend(
                ["start", "deadline-s", "strategy"].map(|f| tables[0].value(row, f).clone()),
            );
            line.extend([Value::Integer(trial.cast_signed()), outcome.into(), time.into()]);
            trials.push(line);
        }
    }
    assert_eq!(missing, [("B 2899 corridors-first".to_owned(), 49)]);
    assert_eq!(trials.rows.len(), 3000);
    trials
}

fn claims() -> Vec<Claim> {
    let manifest: serde_json::Value = serde_yaml::from_str(MANIFEST).unwrap();
    serde_json::from_value(manifest["claims"].clone()).unwrap()
}

#[test]
fn the_claims_speak_of_what_there_is() {
    let owned = |names: &[&str]| names.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
    let deadlines: Vec<String> =
        TABLE_1.iter().map(|(_, deadline, _)| deadline.to_string()).collect();
    let factors = [
        Factor::new("start", owned(&["A", "B", "C"])),
        Factor::new("deadline-s", deadlines),
        Factor::new("strategy", owned(&STRATEGIES)),
    ];
    let metrics = owned(&[
        "success",
        "outcome:reached",
        "outcome:collided",
        "outcome:late",
        "outcome:stalled",
        "time-s",
        "fast-maneuver-share",
        "fast-maneuvers",
        "slow-maneuvers",
        "fast-collisions",
        "slow-collisions",
    ]);
    let published = owned(&["success-percent", "collision-percent", "late-percent", "time-s"]);
    let known = Known { factors: &factors, metrics: &metrics, published: &published };
    assert_eq!(check_all(&claims(), known).collect::<Vec<_>>(), []);
    for name in &published {
        let table = printed(name);
        assert_eq!(published::check_table(name, &table, &factors), Vec::<String>::new());
        assert_eq!(table.rows.len(), if name == "time-s" { 58 } else { 60 });
    }
}

/// Checks what the paper's own numbers say of each claim. A statement that the printed order merely does not bear out
/// is inconclusive, not contradicted: fifty trials a cell leave it open.
#[test]
fn the_papers_own_tables_decide_these_claims() {
    use Judgement::{CannotBeTested, Contradicted, Inconclusive, Supported};
    let expected = [
        ("D1", Supported),
        // 26, 34, 30, 26, 30 %: alike to the eye (chi-square p = .90), but fifty trials cannot show that no two differ
        // by ten points.
        ("D1b", Inconclusive),
        ("D2", Supported),
        ("D2-level", Supported),
        // Lowest of five, yet not clearly below normalized-frontier (p = .18).
        ("D2b", Inconclusive),
        ("D3", Inconclusive),
        // 28 against 39 %: neither within ten points nor clearly beyond.
        ("D4", Inconclusive),
        ("D5", Inconclusive),
        ("D5-normalized", Inconclusive),
        ("D5-random", Supported),
        ("D6", Supported),
        ("D6-loose", Inconclusive),
        // Maneuvers are in no table.
        ("D7a", CannotBeTested),
        ("D7b", CannotBeTested),
        // Collisions fall with the deadline for frontier, corridors-first and complete-corridor.
        ("D7c", Contradicted),
        ("D8", Inconclusive),
        ("D9", Inconclusive),
        ("D10", Supported),
        ("D11", Supported),
        // At the longest deadlines 38 % collide and 10 % are late.
        ("D11-cause", Contradicted),
        ("D12", Supported),
        ("D13", Inconclusive),
        ("D14", Supported),
        // The paper has no word for stalled: all are late here.
        ("D14-stalled", Contradicted),
        ("D15", Supported),
        ("D15-rmse", Supported),
        ("D16", Contradicted),
        // Of the means; the spread of times is ours.
        ("D16-time", Supported),
    ];
    let tables: BTreeMap<String, Table> =
        ["success-percent", "collision-percent", "late-percent", "time-s"]
            .map(|name| (name.to_owned(), printed(name)))
            .into();
    let context = Context::new(&tables, &[], 2019);
    let trials = Observations::read(&as_printed_in_full()).unwrap();
    let verdicts: Vec<ClaimVerdict> =
        claims().iter().map(|claim| judge_observations(claim, &trials, &context)).collect();
    let found: Vec<(&str, Judgement)> =
        verdicts.iter().map(|v| (v.id.as_str(), v.judgement)).collect();
    assert_eq!(found, expected);
    assert_eq!(
        Score::of(&verdicts).in_words("claims and checks"),
        "12 of 28 claims and checks supported, 4 contradicted, 10 inconclusive, 2 cannot be tested"
    );
    let of = |id: &str| verdicts.iter().find(|v| v.id == id).unwrap();
    // The paper agrees with itself entirely, and no rounding carries that beyond one.
    let itself = &of("D15").comparisons[0];
    assert_eq!((itself.effect.as_ref().unwrap().value, itself.p_against), (1.0, Some(1.0)));
    // 1308 of 3000, 43.6 %.
    let low = &of("D11").comparisons[0].cells[0];
    assert_eq!((low.successes, low.trials), (Some(1308), 3000));
    // Supported in print means supported or too few trials; and nothing printed as supported is contradicted.
    for (claim, verdict) in claims().iter().zip(&verdicts) {
        let opposite = match claim.papers_table() {
            PaperTable::Supports => Contradicted,
            PaperTable::Contradicts => Supported,
            PaperTable::Silent => continue,
        };
        assert_ne!(verdict.judgement, opposite, "{}: {}", claim.id, verdict.reason);
    }
}

/// Checks that trials outside of a claim's pools do not matter: `plan --power` makes up no others than those within.
#[test]
fn trials_outside_of_a_claims_pools_cannot_matter() {
    let tables: BTreeMap<String, Table> =
        [("success-percent".to_owned(), printed("success-percent"))].into();
    let context = Context { resamples: 100, permutations: 99, ..Context::new(&tables, &[], 2019) };
    let all = as_printed_in_full();
    let whole = Observations::read(&all).unwrap();
    let mut narrowed = 0;
    for claim in claims() {
        let pools = claim.expect.as_form().scope().pools();
        let mut inside = all.clone();
        inside.rows.retain(|row| {
            let values: Vec<(&String, String)> =
                all.columns.iter().zip(row.iter().map(ToString::to_string)).collect();
            let value = |f: &str| values.iter().find(|(n, _)| *n == f).map(|(_, v)| v.as_str());
            pools.iter().any(|pool| pool.admits(value))
        });
        narrowed += usize::from(inside.rows.len() < all.rows.len());
        let inside = Observations::read(&inside).unwrap();
        let [found, expected] =
            [&inside, &whole].map(|trials| judge_observations(&claim, trials, &context));
        assert!(found == expected, "{}", claim.id);
    }
    assert_eq!(narrowed, 18);
}
