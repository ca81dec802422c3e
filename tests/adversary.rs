//! The adversary's table: what an attacker may hand over as a bundle, and the rung of the ladder that refuses it.
//!
//! Every attack is made here, from an honest bundle that the program under test has just run or from raw bytes, and goes
//! through `reenact verify` as a process of its own, in a sandbox: it must end with the right exit code at the right rung,
//! write nothing anywhere, and take no more than 200 MB. What is said is compared whole
//! (`snapshots/integration__adversary__*.snap`; digests and measured numbers left out). `cargo test --test integration
//! adversary:: -- --nocapture` prints the table.

mod archives;
mod attested;
mod case;
mod checked;
mod files;
mod forged;
pub(crate) mod forger;
mod raw_zip;
mod readers;
pub(crate) mod study;
mod texts;

use crate::sandbox::Sandbox;
use case::{Case, run_all};
use reenact::bundle::{Form, archive};
use std::fs;
use std::path::Path;
use study::HONEST;

#[test]
fn names_that_lead_astray() {
    insta::assert_snapshot!(run_all(&archives::names()));
}

#[test]
fn archives_that_readers_understand_differently() {
    insta::assert_snapshot!(run_all(&archives::structure()));
}

#[test]
fn archives_with_bytes_of_nobody() {
    insta::assert_snapshot!(run_all(&archives::bytes_of_nobody()));
}

#[test]
fn bombs() {
    insta::assert_snapshot!(run_all(&archives::bombs()));
}

#[cfg(unix)]
#[test]
fn folders() {
    insta::assert_snapshot!(run_all(&archives::folders()));
}

#[test]
fn files_that_are_not_those_that_were_sealed() {
    insta::assert_snapshot!(run_all(&files::fixity()));
}

#[test]
fn parts_that_contradict_one_another() {
    insta::assert_snapshot!(run_all(&files::coherence()));
}

#[test]
fn formats_of_other_versions() {
    insta::assert_snapshot!(run_all(&files::formats()));
}

#[test]
fn results_that_do_not_follow() {
    insta::assert_snapshot!(run_all(&forged::results()));
}

#[test]
fn studies_that_were_not_run() {
    insta::assert_snapshot!(run_all(&forged::studies()));
}

#[test]
fn fabrications() {
    insta::assert_snapshot!(run_all(&forged::fabrications()));
}

#[test]
fn texts_that_cost_more_than_they_are_long() {
    insta::assert_snapshot!(run_all(&texts::bombs()));
}

/// The honest bundle, and everything harmless that befalls bundles in the world.
#[test]
fn honest_bundles_are_not_refused() {
    let holds = |what: &str, level: &str, bundle: &[u8]| {
        let sandbox = Sandbox::new();
        sandbox.write("bundle", bundle);
        let answer = sandbox.run_reading(&["verify", "bundle", "--level", level]);
        assert_eq!((answer.stderr.as_str(), answer.code), ("", 0), "{what}: {answer:?}");
    };
    holds("as it was run", "5", &HONEST.zip);
    for form in [Form::Bag, Form::Flat, Form::Crate] {
        holds("another form", "3", &archive::write(&HONEST.tree, &HONEST.root, form));
    }
    let entries = |root: &str| -> Vec<raw_zip::Entry> {
        let name = |path: &str| format!("{root}/{path}");
        let entry =
            |(path, bytes): (&String, &Vec<u8>)| raw_zip::Entry::stored(name(path), bytes.clone());
        HONEST.tree.iter().map(entry).collect()
    };
    let mut reversed = entries(&HONEST.root);
    reversed.reverse();
    holds("files in another order", "3", &raw_zip::zip(&reversed));
    holds("its folder renamed", "3", &raw_zip::zip(&entries("renamed")));
    let mut others = entries(&HONEST.root);
    for entry in &mut others {
        entry.mode = 0;
    }
    others.insert(
        0,
        raw_zip::Entry {
            mode: 0o040_755,
            ..raw_zip::Entry::stored(format!("{}/", HONEST.root), "")
        },
    );
    holds("as other programs zip it, with folders and without modes", "3", &raw_zip::zip(&others));
    let long = raw_zip::Tail { long: Some(0), reversed: true, ..raw_zip::Tail::default() };
    holds("with a zip64 end, listed from the last", "3", &raw_zip::zip_with(&entries("x"), &long));
    let streamed = entries("x").into_iter().map(raw_zip::Entry::streamed);
    holds("written to a stream", "3", &raw_zip::zip(&streamed.collect::<Vec<_>>()));
    let deflated = entries("x")
        .into_iter()
        .map(|entry| raw_zip::Entry::deflated(entry.central.name, entry.data).streamed());
    holds("compressed into a stream", "3", &raw_zip::zip(&deflated.collect::<Vec<_>>()));
    for (tool, zip) in readers::as_tools_write(&HONEST.tree, &HONEST.root) {
        holds(&tool, "3", &zip);
    }
    let mut windows = HONEST.tree.clone();
    forger::edit(&mut windows, forger::MANIFEST, |text| {
        let line = |line: &str| match line.split_once("  ") {
            Some((digest, path)) => format!("{} *{path}\r\n", digest.to_uppercase()),
            None => unreachable!("a line of a manifest has two parts"),
        };
        text.lines().map(line).collect()
    });
    let digest = reenact::digest::Sha256Digest::of(&windows[forger::MANIFEST]);
    forger::edit(&mut windows, forger::TAG_MANIFEST, |text| {
        let line = |line: &str| match line.split_once("  ") {
            Some((_, path)) if path == forger::MANIFEST => format!("{digest}  {path}\n"),
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    });
    holds("a manifest as other programs write it", "3", &archive::write(&windows, "x", Form::Bag));
}

/// A claim's threshold belongs to what is asked. Changed with everything that follows, it makes another study that is
/// what it says; the study digest and `study.yaml` show that it is another.
#[test]
fn another_question_is_another_study() {
    let mut tree = HONEST.tree.clone();
    forger::replace(&mut tree, forger::STUDY, "low: 5", "low: 5000");
    let tree = forger::rederive(tree);
    let claims = forger::text(&tree, "data/results/claims.json");
    assert!(claims.contains("\"verdict\":\"contradicted\""), "{claims}");
    let digest =
        |info: &str| info.lines().find(|line| line.starts_with("Study-Digest")).map(str::to_owned);
    let (old, new) = (forger::text(&HONEST.tree, forger::INFO), forger::text(&tree, forger::INFO));
    assert_ne!(digest(&old), digest(&new));
    let sandbox = Sandbox::new();
    sandbox.write("bundle", archive::write(&tree, "tiny", Form::Bag));
    assert_eq!(sandbox.run_reading(&["verify", "bundle"]).code, 0);
}

/// Every command that reads a bundle meets the same attacker.
#[test]
fn no_command_is_led_out_of_its_folder() {
    let mut tree = HONEST.tree.clone();
    forger::set_json(&mut tree, forger::RESOLVED, |resolved| {
        resolved["name"] = "../../evil".into();
    });
    forger::reseal(&mut tree);
    let sandbox = Sandbox::new();
    sandbox.write("bundle", archive::write(&tree, "tiny", Form::Bag));
    let says = "error: bundle: the bundle is not what it says: reached level 1 (fixity) of level 3 (derived)\nerror at level 2: \
                data/study.resolved.json: expected a name of A-Z a-z 0-9 . _ - at /name, found a path that climbs out of its \
                folder\n`reenact verify bundle` lists everything that was found\n";
    for words in [
        &["export", "bundle", "--dir"][..],
        &["export", "bundle", "--flat"],
        &["export", "bundle", "--rocrate"],
        &["report", "bundle"],
        &["replay", "bundle", "none/0", "--svg", "x.svg"],
    ] {
        let answer = sandbox.run_reading(words);
        assert_eq!(answer.stdout, "", "{words:?}");
        assert_eq!((answer.stderr.as_str(), answer.code), (says, 1), "{words:?}");
    }
    let slip = [
        raw_zip::Entry::stored("bag/bagit.txt", ""),
        raw_zip::Entry::stored("bag/../../evil", "evil"),
    ];
    sandbox.write("bundle", raw_zip::zip(&slip));
    let says = "error: bundle: the bundle is not what it says: reached no level of level 3 (derived)\nerror at level 0: \
                bag/../../evil: expected a safe relative path, found a path that climbs out of its folder\n`reenact verify \
                bundle` lists everything that was found\n";
    let answer = sandbox.run_reading(&["export", "bundle", "--dir"]);
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 1));
}

/// Returns every attack that is a file.
fn attacks() -> Vec<Vec<Case>> {
    vec![
        archives::names(),
        archives::structure(),
        archives::bytes_of_nobody(),
        archives::bombs(),
        files::fixity(),
        files::coherence(),
        files::formats(),
        forged::results(),
        forged::studies(),
        forged::fabrications(),
        texts::bombs(),
    ]
}

/// Writes the table for `page/node.mjs adversary`, which holds the module of `verify.html` against it (`.ci/page-check`).
#[test]
#[ignore = "for .ci/page-check, which goes on with what it writes"]
fn the_table_is_written_for_the_page() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("adversary");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let table: Vec<_> = attacks().iter().flat_map(|cases| case::written(cases, &folder)).collect();
    assert!(table.len() >= 100, "{} attacks", table.len());
    fs::write(folder.join("table.json"), serde_json::to_string(&table).unwrap()).unwrap();
}

/// A table of attacks is worth what it holds: no name twice, and as many as were promised.
#[test]
fn the_table_is_long_and_names_each_attack_once() {
    let mut tables = attacks();
    #[cfg(unix)]
    tables.push(archives::folders());
    let names: std::collections::BTreeSet<_> =
        tables.iter().flatten().map(|case| case.name).collect();
    let rungs: std::collections::BTreeSet<_> =
        tables.iter().flatten().map(|case| case.rung).collect();
    let all = tables.iter().flatten().count();
    assert_eq!(names.len(), all, "two attacks have one name");
    assert!(all >= 100, "{all} attacks");
    assert_eq!(rungs.into_iter().collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
}
