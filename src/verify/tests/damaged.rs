//! Files that were changed, lost or added after sealing, whatever checksums say.

use super::*;

#[test]
fn a_flipped_byte_is_found_at_every_level_that_looks() {
    damaged(
        Level::Derived,
        Some(Level::Safe),
        &[
            "error at level 1: data/results/tables/distance.csv: expected sha256:*, as manifest-sha256.txt says, found \
             sha256:*",
            "error at level 2: data/ro-crate-metadata.json: expected results digest sha256:*, found sha256:*",
            "error at level 2: data/ro-crate-metadata.json: expected sha256 * for `results/tables/distance.csv`, as the file \
             is, found *",
            "error at level 2: bag-info.txt: expected Results-Digest: sha256:*, found sha256:*",
            "error at level 3: data/results/tables/distance.csv: expected the columns coverage, distance-m, as the records \
             give, found the columns Coverage, distance-m",
        ],
        |tree| tree.get_mut("data/results/tables/distance.csv").unwrap()[0] ^= 0x20,
    );
}

#[test]
fn missing_and_extra_files_are_found() {
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: data/trials/none.jsonl: expected a file, as manifest-sha256.txt lists it, found none",
        ],
        |tree| assert!(tree.remove("data/trials/none.jsonl").is_some()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: data/results/extra.csv: expected only files that manifest-sha256.txt lists, found an unlisted \
           file",
        ],
        |tree| assert!(tree.insert("data/results/extra.csv".into(), b"x".to_vec()).is_none()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: run.sh: expected only files that tagmanifest-sha256.txt lists, found an unlisted file",
        ],
        |tree| assert!(tree.insert("run.sh".into(), b"x".to_vec()).is_none()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &["error at level 1: tagmanifest-sha256.txt: expected a list of digests, found no file"],
        |tree| assert!(tree.remove("tagmanifest-sha256.txt").is_some()),
    );
    let mut signed = sample::sealed().tree;
    let signature = include_bytes!("../../../tests/signatures/minisign.minisig");
    signed.insert("tagmanifest-sha256.txt.minisig".into(), signature.to_vec());
    assert_eq!(climb_to(Level::Derived, signed).verdict(), Verdict::Holds, "signatures come later");
}

/// Checks that what lies in the place of a signature is one, or is refused: no list holds the digest of a signature.
#[test]
fn nothing_rides_along_as_a_signature() {
    let hint = "(no list holds the digest of a signature, so it must be one and nothing more)";
    let ssh = include_str!("../../../tests/signatures/ed25519.sig");
    for (path, content, found) in [
        ("tagmanifest-sha256.txt.minisig", "sh install.sh".to_owned(), "something else"),
        ("tagmanifest-sha256.txt.minisig", ssh.to_owned(), "an OpenSSH signature"),
        ("tagmanifest-sha256.txt.sig", format!("{ssh}run me"), "one that cannot be read ("),
    ] {
        let mut tree = sample::sealed().tree;
        tree.insert(path.to_owned(), content.into_bytes());
        let report = climb_to(Level::Fixity, tree);
        let errors = report.findings.iter().filter(|f| f.severity == Severity::Error);
        let told: Vec<String> = errors.map(ToString::to_string).collect();
        let kind = if path.contains("minisig") { "a minisign" } else { "an OpenSSH" };
        let says = format!("error at level 1: {path}: expected {kind} signature, found {found}");
        assert!(
            told.len() == 1 && told[0].starts_with(&says) && told[0].ends_with(hint),
            "{told:?}"
        );
    }
}

#[test]
fn truncated_and_misplaced_records_are_found() {
    let mut tree = sample::sealed().tree;
    let records = tree.get_mut("data/trials/none.jsonl").unwrap();
    records.truncate(records.len() - 40);
    sample::recompute(&mut tree);
    let report = climb_to(Level::Coherent, tree);
    let findings: Vec<_> = report.findings.iter().map(ToString::to_string).collect();
    assert_eq!(findings.len(), 2);
    assert_eq!(
        findings[0],
        "error at level 2: data/trials/none.jsonl: expected a line feed at its end, found none (the file may have been cut \
         short)"
    );
    assert!(
        findings[1].starts_with(
            "error at level 2: data/trials/none.jsonl:3: expected a trial record, found EOF while"
        ),
        "{}",
        findings[1]
    );
    assert_eq!(report.reached, Some(Level::Fixity));

    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl:1: expected trial 0, found trial 1",
            "error at level 2: data/trials/none.jsonl:2: expected trial 2, found trial 0",
            "error at level 2: data/trials/none.jsonl:3: expected trial 1, found trial 2",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                let lines: Vec<_> = text.lines().collect();
                format!("{}\n{}\n{}\n", lines[1], lines[0], lines[2])
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl:2: expected a key of its own, found that of data/trials/none.jsonl:1",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                let lines: Vec<_> = text.lines().collect();
                let copy = lines[0].replace("\"trial\":0", "\"trial\":1");
                format!("{}\n{copy}\n{}\n", lines[0], lines[2])
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl: expected 3 records, as the resolved study says, found 2",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                text.split_inclusive('\n').take(2).collect()
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/inputs/a.yaml: expected sha256:*, as the resolved study says of `../worlds/a.yaml`, found \
           sha256:*",
        ],
        |tree| {
            edit(tree, "data/inputs/a.yaml", |text| text.replace("[1]", "[2]"));
            sample::recompute(tree);
        },
    );
}

#[test]
fn hostile_archives_fail_at_level_0() {
    let zip = sample::zip_of(&[("b/bagit.txt", b""), ("../evil", b"x")]);
    let options = Options { level: Level::Derived, sample: 0, rows: None, seed: 0 };
    let report = climb(archive::read(&zip, &Limits::default()), &options, &ENGINE);
    assert_eq!((report.reached, report.verdict()), (None, Verdict::Broken));
    assert_eq!(
        report.to_human(),
        "  0 safe      failed\n  1 fixity    not judged\n  2 coherent  not judged\n  3 derived   not judged\nerror at level 0: \
         ../evil: expected a safe relative path, found a path that climbs out of its folder\nreached no level of level 3 \
         (derived): the bundle is not what it says\n"
    );
}
