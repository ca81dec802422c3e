//! A reviewer's afternoon, from the outside: who signed it, does it hold with fresh seeds, what can be signed, what remains in
//! ten years.

use crate::sandbox::{Answer, Sandbox, repository, skipped};
use reenact::bundle::{Archive, Form, Limits, archive};
use reenact::digest::Sha256Digest;
use reenact::plan::engine_version;
use reenact::studies::StudyKind;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Returns the engine that runs the prior-map study.
fn engine() -> String {
    engine_version(StudyKind::named("prior-map").unwrap())
}

/// Returns the path of the bundle that the repository keeps.
fn published() -> PathBuf {
    repository().join("artifacts/quickstart-published.zip")
}

/// Creates a folder with the short study in it.
fn with_study() -> Sandbox {
    Sandbox::pinned().with_study(STUDY)
}

/// Runs `ssh-keygen` in this folder; returns `false` where the machine has none.
fn ssh_keygen(desk: &Sandbox, words: &[&str]) -> bool {
    let mut command = Command::new("ssh-keygen");
    command.args(words).current_dir(desk.path("")).stdin(Stdio::null());
    match command.output() {
        Ok(output) => {
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "ssh-keygen {words:?}: {told}");
            true
        }
        Err(error) => {
            skipped(&format!("no ssh-keygen to sign with on this machine ({error})"));
            false
        }
    }
}

/// Signs and verifies as docs/verification.md describes it, with keys made for the occasion.
#[test]
fn a_bundle_signed_with_openssh_verifies_by_its_allowed_signers() {
    let desk = Sandbox::pinned();
    let bundle = published().to_str().unwrap().to_owned();
    for key in ["author", "stranger"] {
        if !ssh_keygen(&desk, &["-q", "-t", "ed25519", "-N", "", "-C", key, "-f", key]) {
            return;
        }
    }
    let opened = archive::read(&std::fs::read(published()).unwrap(), &Limits::default()).unwrap();
    desk.write("tagmanifest-sha256.txt", &opened.tree["tagmanifest-sha256.txt"]);
    ssh_keygen(&desk, &["-Y", "sign", "-f", "author", "-n", "reenact", "tagmanifest-sha256.txt"]);
    let trusting = |key: &str, file: &str| {
        let line = format!("a@example.org namespaces=\"reenact\" {}", desk.read(key));
        desk.write(file, line);
    };
    trusting("author.pub", "signers");
    trusting("stranger.pub", "strangers");

    let signed =
        desk.run(&["export", &bundle, "--signature", "tagmanifest-sha256.txt.sig", "-o", "signed"]);
    assert_eq!((signed.stderr.as_str(), signed.code), ("", 0));
    let signed = signed.stdout.lines().last().unwrap();
    let inside = desk.run(&["verify", "--level", "2", "--trust", "signers", signed]);
    assert_eq!(inside.code, 0, "{inside:?}");
    assert!(
        inside.stdout.contains("\nsigned   by a@example.org with the key SHA256:"),
        "{inside:?}"
    );
    let beside = ["--trust", "signers", "--signature", "tagmanifest-sha256.txt.sig"];
    let beside = desk.run(&[&["verify", "--level", "2", &bundle], &beside[..]].concat());
    assert_eq!((beside.code, &beside.stdout), (0, &inside.stdout), "in the bundle or beside it");

    let unknown = desk.run(&["verify", "--trust", "strangers", signed]);
    assert_eq!(unknown.code, 1);
    assert!(unknown.stdout.contains("found one by the unknown key SHA256:"), "{unknown:?}");
    assert!(!unknown.stdout.contains("quickstart"), "no word of the bundle is told: {unknown:?}");
    let none = desk.run(&["verify", "--trust", "signers", &bundle]);
    assert_eq!(none.code, 1);
    assert!(none.stdout.contains("found no signature (if its author signed it"), "{none:?}");
    // By SOURCE_DATE_EPOCH, which these commands are given, the key would still be trusted.
    let line = desk.read("signers").replace(" namespaces", " valid-before=\"20210101\",namespaces");
    desk.write("expired", line);
    let expired = desk.run(&["verify", "--trust", "expired", signed]);
    assert_eq!(expired.code, 1);
    assert!(
        expired.stdout.contains(", which is trusted before 2021-01-01 and not on 2"),
        "{expired:?}"
    );
    let unchecked = desk.run(&["verify", "--level", "2", signed]);
    assert_eq!(unchecked.code, 0);
    assert!(unchecked.stdout.contains("name those you trust with `--trust FILE`"), "{unchecked:?}");

    // One digit of one digest.
    let Archive { form: Form::Bag, mut tree, .. } = opened else { panic!("a bag") };
    let list = tree.get_mut("tagmanifest-sha256.txt").unwrap();
    list[0] = if list[0] == b'0' { b'1' } else { b'0' };
    desk.write("changed.zip", archive::write(&tree, "changed", Form::Bag));
    let words = [
        "verify",
        "changed.zip",
        "--trust",
        "signers",
        "--signature",
        "tagmanifest-sha256.txt.sig",
    ];
    let changed = desk.run(&words);
    assert_eq!(changed.code, 1);
    assert!(
        changed.stdout.contains("found one that does not fit this bundle, by the key"),
        "{changed:?}"
    );
}

#[test]
fn requests_about_signatures_that_make_no_sense_are_refused() {
    let desk = Sandbox::pinned();
    let bundle = published().to_str().unwrap().to_owned();
    desk.write("signers", "a@example.org ssh-ed25519 AAAA\n");
    let bad = desk.run(&["verify", &bundle, "--trust", "signers"]);
    assert_eq!((bad.code, bad.stdout.as_str()), (2, ""));
    assert_eq!(
        bad.stderr,
        "error: a trusted key cannot be read\n --> signers:1:15\n  |\n1 | a@example.org ssh-ed25519 AAAA\n  |               \
         ^^^^^^^^^^^^^^^^ expected a public key such as `ssh-ed25519 AAAA...`\n  |\n  = help: a line is PRINCIPALS [OPTIONS] \
         KEYTYPE KEY [COMMENT], as in ssh-keygen(1), ALLOWED SIGNERS\n"
    );
    let low = desk.run(&["verify", &bundle, "--trust", "signers", "--level", "0"]);
    assert_eq!(
        (low.code, low.stderr.as_str()),
        (
            2,
            "error: `--trust` needs `--level 1` or more: a signature vouches for digests, and level 0 compares none\n"
        )
    );
    let no_signature = desk.run(&["export", &bundle, "--signature", "signers"]);
    assert_eq!(
        (no_signature.code, no_signature.stderr.as_str()),
        (
            2,
            "error: `signers`: expected an OpenSSH signature (`ssh-keygen -Y sign`) or one of minisign\n"
        )
    );
    let high = desk.run(&["verify", &bundle, "--level", "7"]);
    let says = "error: `--level` goes from 0 to 6, found 7\n";
    assert_eq!((high.code, high.stderr.as_str()), (2, says));
}

/// Two short trials, and a claim that any run bears out.
const STUDY: &str = "
reenact: 1
name: tiny
title: A short study
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 2
robot: robots/kobuki.urdf
world: {file: worlds/basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2, heading-deg: 0}
parameters: {mission: {time-limit-s: 20}}
claims:
  - id: S1
    says: in twenty seconds the robot does not go a kilometre
    paper-table: silent
    expect: {between: {metric: distance-m, where: {}, low: 0, high: 1000, minimum-n: 2}}
";

#[test]
fn a_study_with_its_engine_sealed_in_replicates_and_is_attested() {
    let desk = with_study();
    let digest = |words: &[&str]| {
        let run = desk.run(words);
        assert_eq!((run.stderr.as_str(), run.code), ("", 0));
        let lines: Vec<String> = run.stdout.lines().rev().take(2).map(str::to_owned).collect();
        (lines[1].clone(), lines[0].clone())
    };
    let (without, _) = digest(&["run", "tiny.yaml", "--out", "plain"]);
    let (with, bundle) = digest(&["run", "tiny.yaml", "--out", "sealed", "--capsule"]);
    assert_eq!(without, with, "the capsule lies outside of the results");

    let words = [
        "verify",
        &bundle,
        "--level",
        "6",
        "--sample-seed",
        "18446744073709551615",
        "--attest",
        "a.json",
    ];
    let answer = desk.run(&words);
    let wrote = "wrote a.json, unsigned, and a.json.pae, the bytes to sign\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (wrote, 0), "{}", answer.stdout);
    let says = "run again with the experiment's seed 18446744073709551615: of 1 claims 1 have the same verdict\n  S1: supported (";
    assert!(answer.stdout.contains(says), "{}", answer.stdout);
    assert!(
        answer.stdout.ends_with(
            "reached level 6 (replicated) of level 6 (replicated): the bundle is what it says\n"
        ),
        "{}",
        answer.stdout
    );
    let envelope: serde_json::Value = serde_json::from_str(&desk.read("a.json")).unwrap();
    assert_eq!(envelope["signatures"], serde_json::json!([]));
    let to_sign = desk.read("a.json.pae");
    let (_, payload) = to_sign.split_once(" {").unwrap();
    let statement: serde_json::Value = serde_json::from_str(&format!("{{{payload}")).unwrap();
    let attested = &statement["predicate"];
    assert_eq!(
        (attested["level"].as_u64(), attested["date"].as_str()),
        (Some(6), Some("2020-09-13T12:26:40Z"))
    );
    assert_eq!(attested["replication"]["seed"], "18446744073709551615");
    let bytes = std::fs::read(desk.path(&bundle)).unwrap();
    let tree = archive::read(&bytes, &Limits::default()).unwrap().tree;
    let id = format!("sha256:{}", Sha256Digest::of(&tree["tagmanifest-sha256.txt"]));
    assert_eq!(attested["bundleId"], id);

    // As docs/verification.md tells reviewers and readers, with a key made for the occasion.
    if ssh_keygen(&desk, &["-q", "-t", "ed25519", "-N", "", "-C", "reviewer", "-f", "reviewer"]) {
        ssh_keygen(&desk, &["-Y", "sign", "-f", "reviewer", "-n", "reenact", "a.json.pae"]);
        let signed = desk.run(&["attest", "a.json", "--signature", "a.json.pae.sig"]);
        assert_eq!((signed.stderr.as_str(), signed.code), ("", 0));
        assert!(signed.stdout.starts_with("a.json: signed with the key SHA256:"), "{signed:?}");
        let line = format!("r@example.org namespaces=\"reenact\" {}", desk.read("reviewer.pub"));
        desk.write("signers", line);
        let words = ["verify", &bundle, "--trust", "signers", "--attestation", "a.json"];
        let read = desk.run(&words);
        assert_eq!((read.stderr.as_str(), read.code), ("", 0), "{read:?}");
        let says = "attested by r@example.org with the key SHA256:";
        assert!(
            read.stdout.contains(says)
                && read
                    .stdout
                    .contains(": level 6 (replicated) held on 2020-09-13T12:26:40Z, by reenact ")
        );
    }
    let readme = String::from_utf8(tree["data/README.md"].clone()).unwrap();
    let install = "\n```\ncargo install --path . --locked\n```\n";
    assert!(
        readme.contains(install) && readme.contains(&format!("(engine {})", engine())),
        "{readme}"
    );

    std::fs::remove_file(desk.path("a.json")).unwrap();
    desk.write("broken.zip", &bytes[..bytes.len() / 2]);
    let broken = desk.run(&["verify", "broken.zip", "--attest", "a.json"]);
    let why = "error: wrote no `a.json`: the bundle holds to no level and not to level 3 (derived), as was asked\n";
    assert_eq!((broken.stderr.as_str(), broken.code), (why, 1));
    assert!(!desk.path("a.json").exists());
}

/// Returns the lines of a Markdown text's fenced blocks that begin with `program`, without their comments.
fn printed(text: &str, program: &str) -> Vec<String> {
    let mut fenced = false;
    text.lines()
        .filter(|line| {
            let is_fence = line.starts_with("```");
            fenced ^= is_fence;
            fenced && !is_fence
        })
        .map(|line| line.split(" #").next().unwrap_or_default().trim_end().to_owned())
        .filter(|line| line.split(' ').next() == Some(program))
        .collect()
}

#[test]
fn commands_are_found_in_fenced_blocks_alone() {
    let text =
        "reenact a\n```\nreenact b c   # d\nsha256sum e\n```\nreenact f\n```sh\nreenact\n```\n";
    assert_eq!(printed(text, "reenact"), ["reenact b c", "reenact"]);
    assert_eq!(printed(text, "sha256sum"), ["sha256sum e"]);
}

/// Where they are said to work: those of the README and the page in the folder of the bundle, the study's own run in the
/// README's folder, checksums in the folder above it.
#[test]
fn every_command_that_a_bundle_and_its_page_print_works_as_printed() {
    let desk = with_study();
    let run = desk.run(&["run", "tiny.yaml", "--out", "bundles"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let bundle = run.stdout.lines().last().unwrap().to_owned();
    let report = desk.run(&["report", &bundle, "-o", "page.html"]);
    assert_eq!(report.code, 0, "{}", report.stderr);
    let page = desk.read("page.html").replace("&#x2f;", "/").replace("&#x27;", "'");
    let lines = page.split("<pre tabindex=\"0\"><code>").skip(1);
    let lines = lines.map(|rest| rest.split("</code>").next().unwrap().to_owned());
    let (mut commands, by_hand): (Vec<String>, Vec<String>) =
        lines.partition(|line| line.starts_with("reenact "));
    assert!(commands.len() > 5, "{commands:?}");

    let unpacked = desk.run(&["export", &bundle, "--dir", "--out", "tree"]);
    assert_eq!(unpacked.code, 0, "{}", unpacked.stderr);
    let bag = desk.path(unpacked.stdout.lines().last().unwrap());
    let readme = std::fs::read_to_string(bag.join("data/README.md")).unwrap();
    let (again, of_readme): (Vec<_>, Vec<_>) =
        printed(&readme, "reenact").into_iter().partition(|line| line.contains(" study.yaml"));
    assert!(again.len() == 1 && of_readme.len() > 1, "{readme}");
    commands.extend(of_readme);
    for line in &commands {
        let words: Vec<&str> = line.split(' ').skip(1).collect();
        let answer = Answer::of(desk.command(&words).current_dir(desk.path("bundles")));
        assert_eq!(answer.code, 0, "{line}\n{}{}", answer.stdout, answer.stderr);
    }
    let words: Vec<&str> = again[0].split(' ').skip(1).collect();
    let answer = Answer::of(desk.command(&words).current_dir(bag.join("data")));
    assert_eq!(answer.code, 0, "{}\n{}{}", again[0], answer.stdout, answer.stderr);
    let results =
        |told: &str| told.lines().find(|line| line.starts_with("results ")).map(str::to_owned);
    assert!(results(&run.stdout).is_some() && results(&answer.stdout) == results(&run.stdout));
    // The results digest without any program of ours.
    assert_eq!(by_hand.len(), 1, "{by_hand:?}");
    let shell = Command::new("sh").args(["-c", &by_hand[0]]).current_dir(bag.join("data")).output();
    let digest = String::from_utf8(shell.unwrap().stdout).unwrap();
    let digest = digest.split(' ').next().unwrap();
    assert!(
        run.stdout.contains(&format!("sha256:{digest}")),
        "{} is not in {}",
        digest,
        run.stdout
    );

    let sums = printed(&readme, "sha256sum");
    assert_eq!(sums.len(), 1, "{readme}");
    for line in sums {
        let mut words = line.split(' ');
        let checked = Command::new(words.next().unwrap()).args(words).current_dir(&bag).output();
        let checked = checked.unwrap();
        assert!(checked.status.success(), "{line}\n{}", String::from_utf8_lossy(&checked.stderr));
    }
}

/// The small bundle in the repository, as a reviewer of years to come would check it: wholly, for as long as its engine is
/// ours; after that as far as any program can, with the way to climb the rest.
#[test]
fn the_published_quickstart_bundle_still_verifies() {
    let desk = Sandbox::pinned();
    let bundle = published().to_str().unwrap().to_owned();
    let answer = desk.run(&["verify", &bundle, "--level", "5", "--format", "json"]);
    let report: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    if report["engine"] == engine() {
        assert_eq!(
            answer.code, 0,
            "{}\nwhere trials were meant to change, publish the quickstart's bundle anew \
            (SOURCE_DATE_EPOCH=0 reenact run manifests/quickstart.yaml) and say so in CHANGELOG.md",
            answer.stdout
        );
        assert_eq!(report["reached"], 5);
    } else {
        assert_eq!((answer.code, report["reached"].as_u64()), (2, Some(2)), "{}", answer.stdout);
        let hint = report["findings"][0]["hint"].as_str().unwrap();
        assert!(hint.contains("`cargo install --path . --locked`"), "{hint}");
    }
}
