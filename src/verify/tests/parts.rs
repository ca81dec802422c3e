//! Records that go on in further files, read from memory and from a disk.

use super::*;
use crate::bundle::format;
use crate::store;

/// Returns the sample with six records of `none` that have 20 MB together, sealed.
fn sealed() -> crate::bundle::Sealed {
    let mut records = sample::records();
    records[0].1 = (0..6)
        .map(|trial| {
            let mut record = sample::record(7, "none", trial);
            record.cause = "a wall ".repeat(485_000);
            record
        })
        .collect();
    let content = sample::content_of(sample::STUDY.as_bytes(), 7, &records);
    crate::bundle::seal(&content, &sample::circumstance()).unwrap()
}

const SECOND: &str = "data/trials/none_part-0002.jsonl";

#[test]
fn records_of_many_trials_go_on_in_further_files() {
    let sealed = sealed();
    let lines = |path: &str| String::from_utf8_lossy(&sealed.tree[path]).lines().count();
    assert_eq!((lines("data/trials/none.jsonl"), lines(SECOND)), (4, 2));
    assert!(sealed.tree["data/trials/none.jsonl"].len() as u64 <= format::PART);
    let info = String::from_utf8_lossy(&sealed.tree["bag-info.txt"]).into_owned();
    assert!(info.contains("\nBundle-Format: 5\n"), "{info}");
    let whole = String::from_utf8_lossy(&sample::sealed().tree["bag-info.txt"]).into_owned();
    assert!(whole.contains("\nBundle-Format: 4\n"), "{whole}");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bundle.zip");
    let written = store::publish(folder.path(), "bundle.zip", |out| sealed.write(Form::Bag, out));
    assert_eq!(written.unwrap(), path);
    assert!(std::fs::read(&path).unwrap() == sealed.zip(Form::Bag), "piece by piece or at once");
    let opened = store::open_bundle(&path, &Limits::default()).unwrap().unwrap();
    assert!(
        opened.large.contains_key(SECOND) && opened.large.contains_key("data/trials/none.jsonl")
    );
    let options = Options { level: Level::Coherent, sample: 1, rows: None, seed: 1 };
    let report = climb(Ok(opened.clone()), &options, &ENGINE);
    assert_eq!((report.verdict(), report.findings), (Verdict::Holds, Vec::new()));

    let bundle = Bundle::open(opened).unwrap();
    assert_eq!((bundle.format(), bundle.record_count("none")), (format::IN_PARTS, 6));
    let mut places = Vec::new();
    bundle.record_lines("none", |line| {
        let record = TrialRecord::from_line(line.text).unwrap();
        places.push((record.trial, line.place()));
        true
    });
    assert_eq!(places[3], (3, "data/trials/none.jsonl:4".to_owned()));
    assert_eq!(places[4], (4, format!("{SECOND}:1")));
}

#[test]
fn records_that_say_each_something_of_their_own_do_not_fill_the_memory() {
    let mut records = sample::records();
    records[0].1 = (0..6000)
        .map(|trial| {
            let mut record = sample::record(7, "none", trial);
            record.measures.insert(format!("m-{trial}"), Some(1.0));
            record
        })
        .collect();
    let content = sample::content_of(sample::STUDY.as_bytes(), 7, &records);
    let sealed = crate::bundle::seal(&content, &sample::circumstance()).unwrap();
    let bundle = Bundle::open(Archive::of(Form::Bag, sealed.tree)).unwrap();
    let published = include_bytes!("../../../artifacts/quickstart-published.zip");
    let published = Bundle::read(published, &Limits::default()).unwrap();
    let (plan, _) = plan_of(&published).unwrap();
    let gathered = bundle.gathered(&plan, &crate::bundle::Forgetful::default());
    let told: Vec<String> = gathered.unwrap_err().iter().map(ToString::to_string).collect();
    let expected = "data/trials/: expected records that take at most 80 MiB of memory, found more";
    assert_eq!(told, [expected]);
    let honest = published.gathered(&plan, &crate::bundle::Forgetful::default()).unwrap();
    assert_eq!(honest, crate::bundle::Gathered::of(&plan, &published.records().unwrap()));
}

#[test]
fn a_part_that_is_missing_or_of_nobody_is_named() {
    let told = |damage: &dyn Fn(&mut Tree)| {
        let mut tree = sealed().tree;
        damage(&mut tree);
        let report = climb_to(Level::Coherent, tree);
        assert_eq!(report.reached, Some(Level::Safe));
        let findings: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
        findings.into_iter().filter(|finding| finding.contains("at level 2")).collect::<Vec<_>>()
    };
    let missing = told(&|tree| drop(tree.remove(SECOND)));
    let expected = "error at level 2: data/trials/none.jsonl: expected 6 records, as the resolved study says, found 4";
    assert!(missing.iter().any(|finding| finding == expected), "{missing:#?}");
    let beyond = told(&|tree| {
        let lines = tree.remove(SECOND).unwrap();
        tree.insert("data/trials/none_part-0003.jsonl".to_owned(), lines);
    });
    let expected = "error at level 2: data/trials/none_part-0003.jsonl: expected a file that the resolved study names, found one \
                    that it does not";
    assert!(beyond.iter().any(|finding| finding == expected), "{beyond:#?}");
}
