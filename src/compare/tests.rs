use super::*;
use crate::bundle::{Bundle, BundleContent, Circumstance, Form, Limits, Moment, sample, seal};
use crate::digest::Sha256Digest;
use crate::document::Source;
use crate::json::AsWritten;
use crate::plan::ResolvedStudy;
use crate::studies::TrialRecord;
use serde_json::json;

fn account(content: &BundleContent) -> Account {
    let sealed = seal(content, &sample::circumstance()).unwrap();
    let bundle = Bundle::read(&sealed.zip(Form::Bag), &Limits::default()).unwrap();
    Account::of_bundle(&bundle).unwrap()
}

/// Makes the sample study, its conditions listed in the resolved study as ours list them.
fn content_of(conditions: &[(&str, Vec<TrialRecord>)]) -> BundleContent {
    let mut content = sample::content_of(sample::STUDY.as_bytes(), 7, conditions);
    content.resolved = resolved(8.5);
    content
}

fn resolved(range: f64) -> ResolvedStudy {
    let condition =
        |slug: &str| json!({"slug": slug, "parameters": {"range-m": range}, "prior": slug});
    sample::resolved(
        json!({"seed": 7, "title": "T", "conditions": [condition("none"), condition("floor-plan")]}),
    )
}

fn sample_account() -> Account {
    account(&content_of(&sample::records()))
}

/// Returns the account of the sample study with the records changed.
fn changed(change: impl Fn(&mut TrialRecord)) -> Account {
    let mut conditions = sample::records();
    conditions.iter_mut().flat_map(|(_, records)| records).for_each(change);
    account(&content_of(&conditions))
}

/// Makes the record none/1 walk a little further, from 10 s on.
fn walked_further(record: &mut TrialRecord) {
    if record.condition[0].1 == "none" && record.trial == 1 {
        let distance = record.measures["distance-m-at-90"].unwrap();
        record.measures.insert("distance-m-at-90".to_owned(), Some(distance + 3.0));
        record.chain[1] = "0".repeat(16);
    }
}

fn whole(a: &Account, b: &Account, tolerances: &[&str]) -> Comparison {
    let written: Vec<String> = tolerances.iter().map(|t| (*t).to_owned()).collect();
    compare(a, b, Extent::Whole, &Tolerances::parse(&written).unwrap()).unwrap()
}

fn locked(account: &Account) -> Account {
    Lock::of(account).unwrap().account().clone()
}

/// Returns `text` with every digest's first eight digits hidden.
fn redacted(text: &str) -> String {
    let mut parts = text.split("sha256:");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push_str("sha256:XXXXXXXX");
        out.push_str(&part[8..]);
    }
    out
}

#[test]
fn circumstances_are_no_change() {
    let content = content_of(&sample::records());
    let elsewhere = seal(&content, &Circumstance::reproducible(Moment(0))).unwrap();
    let bundle = Bundle::read(&elsewhere.zip(Form::Flat), &Limits::default()).unwrap();
    let comparison = whole(&account(&content), &Account::of_bundle(&bundle).unwrap(), &[]);
    assert_eq!(comparison.discrepancies, []);
    assert_eq!(comparison.matching, Matching { by_key: 6, by_number: 0 });
    assert_eq!(comparison.answer(), "no change");
    assert_eq!(comparison.causes(), []);
}

#[test]
fn one_measure_that_changed_is_told_with_all_that_follows_from_it() {
    let comparison = whole(&sample_account(), &changed(walked_further), &[]);
    let key = sample::record(7, "none", 1).key.short();
    let distance = |further: f64| {
        let key = sample::record(7, "none", 1).key;
        f64::from(key.0.0[0]) + 0.5 + further
    };
    let [before, after] = [distance(0.0), distance(3.0)];
    let percent = 100.0 * 3.0 / before;
    let mean = |further: f64| {
        let all: Vec<TrialRecord> = sample::records().into_iter().flat_map(|(_, r)| r).collect();
        (all.iter().map(|r| r.measures["distance-m-at-90"].unwrap()).sum::<f64>() + further) / 6.0
    };
    let mean_percent = 100.0 * (mean(3.0) - mean(0.0)) / mean(0.0);
    assert_eq!(
        redacted(&comparison.to_human(["old.zip", "new.zip"])),
        format!(
            "\
a  old.zip: corridors, engine test-1, results sha256:XXXXXXXX
b  new.zip: corridors, engine test-1, results sha256:XXXXXXXX

  inputs                2  same
  manifest                 same
  engine                   same
  settings              6  same
  conditions            2  same
  trials                6  1 changed
  cells of tables       2  1 changed
  files of results      5  same
  claims                1  same

trials
  none/1: sha256:XXXXXXXX -> sha256:XXXXXXXX (same key {key}, other bytes; states first differ \
             between 10 s and 20 s of simulated time; distance-m-at-90 {before} -> {after} ({percent:+.2} %))

cells of tables
  distance, coverage=90%, distance-m: {} -> {} ({mean_percent:+.2} %)

changed: trials (1), cells of tables (1)
",
            mean(0.0),
            mean(3.0),
        )
    );
    assert_eq!(comparison.causes(), [Cause::Unexplained]);
}

#[test]
fn what_is_tolerated_is_counted_and_no_change() {
    let (a, b) = (sample_account(), changed(walked_further));
    for tolerances in [&["3"][..], &["distance-m=3", "distance-m-at-90=3"]] {
        let comparison = whole(&a, &b, tolerances);
        let cells = comparison.discrepancies.len();
        // The tolerance of the measure does not cover the table's column of another name.
        assert_eq!((cells, comparison.tally.tolerated_trials), (0, 1), "{tolerances:?}");
    }
    let told = whole(&a, &b, &["3"]).to_human(["a", "b"]);
    assert!(told.contains("\n  trials                6  same, 1 within tolerance\n"), "{told}");
    assert!(told.contains("\n  cells of tables       2  same, 1 within tolerance\n"), "{told}");
    assert_eq!(
        whole(&a, &b, &["2.9"]).discrepancies.len(),
        1,
        "the mean moved by half a metre only"
    );
    let error = Tolerances::parse(&["distanc-m=1".to_owned()]).unwrap();
    assert_eq!(
        compare(&a, &b, Extent::Whole, &error).unwrap_err().to_string(),
        "`--tolerance distanc-m=...`: neither side has a metric `distanc-m`: did you mean `distance-m`?"
    );
}

#[test]
fn another_engine_seed_and_setting_are_matched_by_number_and_told_as_causes() {
    let other: Vec<(&str, Vec<TrialRecord>)> = ["none", "floor-plan"]
        .map(|prior| (prior, (0..3).map(|trial| sample::record(8, prior, trial)).collect()))
        .into();
    let mut content = content_of(&other);
    content.engine = "test-2".to_owned();
    content.resolved = resolved(9.0);
    content.resolved.seed = AsWritten::of(&8);
    content.resolved.title = AsWritten::of(&"U".to_owned());
    content.inputs[0].bytes = b"walls: [2]\n".to_vec();
    let comparison = whole(&sample_account(), &account(&content), &[]);
    assert_eq!(comparison.matching, Matching { by_key: 0, by_number: 6 });
    assert_eq!(comparison.causes(), [Cause::Inputs, Cause::Engine, Cause::Settings]);
    let told = comparison.to_human(["a", "b"]);
    for line in [
        "no two trials have the same key (another engine, seed, input or setting): they are matched by condition and \
         number\n",
        "\nengine\n  version: test-1 -> test-2\n",
        "\nsettings\n  seed: 7 -> 8\n  title: \"T\" -> \"U\"\n  parameters.range-m: 8.5 -> 9 (in every condition)\n",
    ] {
        assert!(told.contains(line), "{line}\nis not in\n{told}");
    }
    // A lock does not hold titles, so they cannot drift.
    let told = whole(&locked(&sample_account()), &account(&content), &[]).to_human(["a", "b"]);
    assert!(told.contains("\nsettings\n  seed: 7 -> 8\n  parameters.range-m"), "{told}");
}

#[test]
fn conditions_and_trials_that_are_new_or_gone_are_told() {
    let mut conditions = sample::records();
    conditions[0].1.pop();
    conditions[1].0 = "footprint";
    let comparison = whole(&sample_account(), &account(&content_of(&conditions)), &[]);
    let rows: Vec<String> = comparison
        .sections()
        .iter()
        .filter(|section| ["conditions", "trials"].contains(&section.name))
        .flat_map(|section| section.rows.iter().map(Row::in_words))
        .collect();
    let gone = sample::record(7, "none", 2);
    assert_eq!(
        rows,
        [
            "none: 3 trials -> 2 trials".to_owned(),
            "floor-plan: gone, was 3 trials".to_owned(),
            "footprint: new, 3 trials".to_owned(),
            format!("none/2: gone, was sha256:{}", Sha256Digest::of(gone.to_line()).short()),
        ]
    );
}

#[test]
fn verdicts_and_rows_of_tables_are_compared_one_by_one() {
    let mut content = content_of(&sample::records());
    let file = |content: &BundleContent, name: &str| {
        content.results.iter().position(|(path, _)| path == name).unwrap()
    };
    let claims = file(&content, "claims.json");
    content.results[claims].1 =
        b"[{\"id\":\"P1\",\"verdict\":\"contradicted\"},{\"id\":\"P2\",\"verdict\":\"supported\"}]\n".to_vec();
    let table = file(&content, "tables/distance.csv");
    content.results[table].1.extend_from_slice(b"95%,12.5\n");
    let figure = file(&content, "figures/distance.svg");
    content.results[figure].1.push(b'\n');
    let comparison = whole(&sample_account(), &account(&content), &[]);
    let rows: Vec<String> = comparison
        .sections()
        .iter()
        .flat_map(|section| section.rows.iter().map(|row| redacted(&row.in_words())))
        .collect();
    assert_eq!(
        rows,
        [
            "distance, coverage=95%, the whole row: new, 95%, 12.5",
            "figures/distance.svg: sha256:XXXXXXXX -> sha256:XXXXXXXX",
            "P1: supported -> contradicted",
            "P2: new, supported",
        ]
    );
    assert_eq!(comparison.causes(), [Cause::Derivation]);
}

#[test]
fn verdicts_that_are_none_are_refused_with_the_reason() {
    let mut content = content_of(&sample::records());
    let claims = content.results.iter_mut().find(|(path, _)| path == "claims.json").unwrap();
    claims.1 = b"[{\"id\":\"P1\",\"verdict\":\"maybe\"}]\n".to_vec();
    let sealed = seal(&content, &sample::circumstance()).unwrap();
    let bundle = Bundle::read(&sealed.zip(Form::Bag), &Limits::default()).unwrap();
    let faults = Account::of_bundle(&bundle).unwrap_err();
    assert_eq!(
        faults.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "data/results/claims.json: expected a list of verdicts, found {\"id\":\"P1\",\"verdict\":\"maybe\"} (unknown \
          variant `maybe`, expected one of `supported`, `contradicted`, `inconclusive`, `cannot-be-tested`)"
        ]
    );
}

#[test]
fn long_lists_are_capped_with_a_count() {
    let many: Vec<TrialRecord> = (0..40).map(|trial| sample::record(7, "none", trial)).collect();
    let mut later = many.clone();
    for record in &mut later {
        record.chain[0] = "f".repeat(16);
    }
    let of = |records: &[TrialRecord]| account(&content_of(&[("none", records.to_vec())]));
    let told = whole(&of(&many), &of(&later), &[]).to_human(["a", "b"]);
    assert!(told.contains("\n  ... and 28 more\n"), "{told}");
    assert_eq!(told.matches("states first differ between 0 s and 10 s").count(), 12);
}

#[test]
fn the_json_is_whole() {
    let comparison = whole(&sample_account(), &changed(walked_further), &[]);
    let mut value = comparison.to_json();
    assert_eq!(value["same"], json!(false));
    assert_eq!(value["causes"], json!(["unexplained"]));
    assert_eq!(value["matching"], json!({"by_key": 6, "by_number": 0}));
    let trial = value["discrepancies"][0].take();
    let record = sample::record(7, "none", 1);
    let mut later = record.clone();
    walked_further(&mut later);
    let distance = |record: &TrialRecord| record.measures["distance-m-at-90"];
    assert_eq!(
        trial,
        json!({
            "what": "trial",
            "condition": "none",
            "number": 1,
            "key": {"from": record.key, "to": record.key},
            "sha256": {"from": Sha256Digest::of(record.to_line()), "to": Sha256Digest::of(later.to_line())},
            "measures": [{"name": "distance-m-at-90", "from": distance(&record), "to": distance(&later)}],
            "diverges_after_s": 10.0,
        })
    );
}

#[test]
fn a_lock_is_read_back_as_it_was_written() {
    let account = sample_account();
    let lock = Lock::of(&account).unwrap();
    let text = lock.to_text();
    assert_eq!(Lock::read(&Source::new("s.lock", text.as_str())).unwrap(), lock);
    assert_eq!(Lock::read(&Source::new("s.lock", text.as_str())).unwrap().to_text(), text);
    assert_eq!(whole(lock.account(), &account, &[]).discrepancies, []);
    assert_eq!(whole(lock.account(), lock.account(), &[]).discrepancies, []);
    for line in [
        "  \"lock-format\": 1,\n",
        "  \"every-condition\": {\n    \"parameters.range-m\": 8.5\n  },\n",
        "      \"settings\": {\n        \"prior\": \"none\"\n      },\n",
        "    \"P1\": \"supported\"\n",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}

#[test]
fn a_chain_that_parted_is_named_by_its_first_step() {
    let account = sample_account();
    let lock = Lock::of(&account).unwrap().to_text();
    let hash = &sample::record(7, "floor-plan", 0).chain[1];
    let altered = lock.replace(hash.as_str(), "00000000deadbeef");
    assert_ne!(altered, lock);
    let altered = Lock::read(&Source::new("s.lock", altered)).unwrap();
    let probe = compare(altered.account(), &account, Extent::FirstTrials, &Tolerances::default());
    let key = sample::record(7, "floor-plan", 0).key.short();
    assert_eq!(
        redacted(&drift(&probe.unwrap(), "s.yaml", "s.lock")),
        format!(
            "\
s.yaml has drifted from s.lock (trial 0 of every condition)

  inputs                2  same
  manifest                 same
  engine                   same
  settings              5  same
  conditions            2  same
  trials                2  1 changed

trials
  floor-plan/0: sha256:XXXXXXXX (same key {key}, other bytes; states first differ between 10 s and 20 s of simulated time)

cause: same inputs, same engine version, same settings, other bytes: either the program changed what a trial yields and \
             its engine version was not raised (docs/determinism.md), or a trial is not deterministic (`reenact run --twice \
             s.yaml` finds out)
If this is meant, write the lock anew with `reenact lock s.yaml` and say why in CHANGELOG.md.
"
        )
    );
}

#[test]
fn a_later_trial_that_changed_is_seen_by_the_digest_of_its_condition() {
    let lock = locked(&sample_account());
    let comparison = whole(&lock, &changed(walked_further), &[]);
    let rows: Vec<String> = comparison
        .sections()
        .iter()
        .filter(|section| ["trials", "records"].contains(&section.name))
        .flat_map(|section| section.rows.iter().map(|row| redacted(&row.in_words())))
        .collect();
    assert_eq!(rows, ["none: sha256:XXXXXXXX -> sha256:XXXXXXXX"]);
    assert_eq!(comparison.causes(), [Cause::Unexplained]);
    let first =
        compare(&lock, &changed(walked_further), Extent::FirstTrials, &Tolerances::default());
    assert!(first.unwrap().is_same(), "a probe runs trial 0 only");
}

#[test]
fn a_changed_comment_is_drift_that_touches_no_trial() {
    let mut content = content_of(&sample::records());
    content.study_yaml.extend_from_slice(b"# a comment\n");
    let comparison = whole(&locked(&sample_account()), &account(&content), &[]);
    assert_eq!(comparison.causes(), [Cause::Manifest]);
    let told = drift(&comparison, "s.yaml", "s.lock");
    assert!(
        told.ends_with(
            "\ncause: the manifest's text changed\nevery trial that was run is the same all the same\nIf this is meant, \
             write the lock anew with `reenact lock s.yaml` and say why in CHANGELOG.md.\n"
        ),
        "{told}"
    );
}

#[test]
fn what_is_no_lock_is_told_at_its_place() {
    let text = Lock::of(&sample_account()).unwrap().to_text();
    let told = |text: String| match Lock::read(&Source::new("s.lock", text)) {
        Err(LockError::Unreadable(faults)) => {
            faults.iter().map(|f| f.render(false)).collect::<Vec<_>>().join("\n")
        }
        other => panic!("{other:?}"),
    };
    let misspelt = told(text.replace("\"results-digest\"", "\"results-digst\""));
    assert!(misspelt.contains("did you mean `results-digest`?"), "{misspelt}");
    let manifest = Sha256Digest::of(sample::STUDY).hex();
    let short =
        told(text.replace(&format!("\"manifest\": \"{manifest}\""), "\"manifest\": \"abc\""));
    let line = text.lines().position(|line| line.contains("\"manifest\":")).unwrap() + 1;
    assert_eq!(
        short,
        format!(
            "error: expected 64 hex digits\n  --> s.lock:{line}:15\n   |\n{line} |   \"manifest\": \"abc\",\n   |               ^^^^^\n"
        )
    );
    assert!(told("<<<<<<< HEAD\n{}\n".to_owned()).starts_with("error: "));
}

#[test]
fn a_newer_lock_is_not_taken_for_a_broken_one() {
    let text = "{\n  \"lock-format\": 2,\n  \"unheard-of\": []\n}\n";
    let Err(LockError::Newer(faults)) = Lock::read(&Source::new("s.lock", text)) else {
        panic!("a newer lock was read");
    };
    assert_eq!(
        faults[0].render(false),
        "\
error: lock format 2 is newer than this program
 --> s.lock:2:18
  |
2 |   \"lock-format\": 2,
  |                  ^ expected 1 or less
  |
  = help: install a newer reenact, or delete the lock and write it anew with `reenact lock`
"
    );
}

#[test]
fn a_part_or_a_panic_cannot_be_locked() {
    let mut content = content_of(&sample::records());
    content.partial = true;
    assert_eq!(
        Lock::of(&account(&content)).unwrap_err().to_string(),
        "expected the whole study, found a part of it: a lock pins all of it"
    );
    let panicked = changed(|record| {
        if record.trial == 2 {
            record.outcome = crate::studies::Outcome::PANICKED;
            record.cause = "index out of bounds".to_owned();
        }
    });
    assert_eq!(
        Lock::of(&panicked).unwrap_err().to_string(),
        "trial none/2 panicked (index out of bounds): a panic is no result"
    );
}
