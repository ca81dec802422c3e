//! Trials read from a table, and made up.

use super::*;

fn table(text: &str) -> Table {
    Table::from_csv(text).unwrap()
}

const TRIALS: &str = "key,start,strategy,trial,outcome,time-s\n\
    k1,A,random,0,reached,10.5\nk2,A,random,1,late,\nk3,A,frontier,0,panicked,\nk4,B,random,0,collided,3\n";

#[test]
fn trials_are_grouped_and_never_dropped() {
    let all = Observations::read(&table(TRIALS)).unwrap();
    assert_eq!(all.factors, ["start", "strategy"]);
    let at_a: Where = serde_json::from_str(r#"{"start": "A"}"#).unwrap();
    let at_a = all.select(&at_a);
    assert_eq!(at_a, [0, 1]);
    let time = all.readings(&at_a, &Metric::named("time-s"));
    assert_eq!(time, Readings { values: vec![Some(10.5), None], failed: 1 });
    let success = all.readings(&[0, 2], &Metric::Success);
    assert_eq!(success.values, [Some(1.0), Some(0.0), Some(0.0)]);
    let counted = Counted { successes: 1, reached: 3, censored: 0, failed: 1 };
    assert_eq!(all.counted(&[0, 1, 2], &Metric::Success), Some(counted));
    assert_eq!(all.counted(&[0], &Metric::named("time-s")), None);
    assert_eq!(all.trials_per_condition(&[1, 0]), 2);
    assert_eq!(all.lacks(&Metric::named("tim-s")), Some(CannotTest::NoColumn("tim-s".to_owned())));
}

#[test]
fn a_selection_names_factors_that_are_there_and_any_of_their_values() {
    let all = Observations::read(&table(TRIALS)).unwrap();
    let select = |cell: &str| all.select(&serde_json::from_str(cell).unwrap());
    assert_eq!(select("{}"), [0, 1, 2]);
    assert_eq!(select(r#"{"start": ["B", "A", "C"], "strategy": "random"}"#), [0, 2]);
    assert_eq!(select(r#"{"start": "C"}"#), [0; 0]);
    assert_eq!(select(r#"{"stop": "A"}"#), [0; 0]);
}

#[test]
fn what_is_made_up_is_read_and_counted_like_trials() {
    let metrics = ["success".to_owned(), "time-s".to_owned()];
    let conditions = ["A", "B"].map(|start| vec![start.to_owned()]);
    let mut study = Observations::simulated(vec!["start".into()], conditions, &metrics, 3);
    for condition in &mut study.conditions {
        let Some(MadeUp::Share(counts)) = condition.made_up("success") else { panic!("share") };
        counts.copy_from_slice(&[true, false, true]);
        let Some(MadeUp::Measure(times)) = condition.made_up("time-s") else { panic!("time") };
        times[2] = Some(7.0);
        assert!(condition.made_up("outcome:late").is_none());
    }
    let counted = Counted { successes: 4, reached: 6, ..Counted::default() };
    assert_eq!(study.counted(&[0, 1], &Metric::Success), Some(counted));
    let success = study.readings(&[1], &Metric::Success).values;
    assert_eq!(success, [Some(1.0), Some(0.0), Some(1.0)]);
    let unknown = study.counted(&[0], &Metric::named("outcome:late")).unwrap();
    assert_eq!(unknown, Counted { censored: 3, ..Counted::default() });
    let time = Metric::named("time-s");
    assert_eq!(study.readings(&[0], &time).values, [None, None, Some(7.0)]);
    assert_eq!(study.first(2).readings(&[0], &time).values, [None, None]);
    assert_eq!(study.first(1).counted(&[0], &Metric::Success).unwrap().successes, 1);
    assert_eq!(study.lacks(&Metric::Success), None);
}

#[test]
fn shared_noise_is_found_by_the_coordinates_that_remain() {
    let all = Observations::read(&table(TRIALS)).unwrap();
    let shared = ["strategy".to_owned()];
    assert_eq!(
        all.sharing(&[0, 1], &shared),
        Some(("start=A, strategy=random".into(), "start=A, strategy=frontier".into()))
    );
    assert_eq!(all.sharing(&[1, 2], &shared), None);
    assert_eq!(all.sharing(&[0, 1, 2], &[]), None);
}

#[test]
fn a_table_of_another_shape_is_refused() {
    let fault = |text: &str| Observations::read(&table(text)).unwrap_err().to_string();
    assert_eq!(
        fault("key,outcome\n"),
        "the trials table has no column `trial` (it has key, outcome)"
    );
    assert_eq!(
        fault("key,trial,x,outcome\n"),
        "the trials table must have `outcome` right after `trial`"
    );
    assert_eq!(
        fault("key,start,trial,outcome\nk,A,x,late\n"),
        "a trial of A has the number `x` and the outcome `late`; expected a whole number and a name"
    );
    assert_eq!(
        fault("key,start,trial,outcome\nk,A,0,late\nk,A,0,late\n"),
        "trial 0 of A is there twice"
    );
}
