//! What a reviewer takes away: who vouches, what to sign, what another engine can say, what CI shows.

use super::*;
use crate::bundle::{Additions, Moment, capsule, seal_with};
use crate::document::Source;

const SIGNERS: &str = include_str!("../../../tests/signatures/allowed_signers");
const SIGNATURE: &str = include_str!("../../../tests/signatures/ed25519.sig");

fn with_capsule() -> Tree {
    let capsule = capsule::own();
    let additions = Additions { source: Some(&capsule), ..Additions::default() };
    seal_with(&sample::content(), &sample::circumstance(), additions).unwrap().tree
}

fn told(report: &Report) -> Vec<String> {
    report.findings.iter().map(ToString::to_string).collect()
}

#[test]
fn nothing_is_read_of_a_bundle_for_which_nobody_vouches() {
    let trust = Trust::read(&Source::new("signers", SIGNERS)).unwrap();
    let signature = Some(("it.sig", SIGNATURE.as_bytes()));
    let vouching = Vouching { trust: Some(&trust), signature, now: Moment(0) };
    let reviewer = Reviewer { vouching, ..Reviewer::anonymous() };
    let options = Options { level: Level::Derived, sample: 0, rows: None, seed: 0 };
    let mut tree = sample::sealed().tree;
    let archive = Archive::of(Form::Bag, tree.clone());
    let report = climb_for(&reviewer, Ok(archive), &options, &ENGINE);
    assert_eq!(
        report.to_human(),
        "  0 safe      passed\n  1 fixity    failed\n  2 coherent  not judged\n  3 derived   not judged\nerror at level 1: \
         it.sig: expected a signature by a key of `signers`, found one that does not fit this bundle, by the key \
         SHA256:d49HsAAG1CRNSwsjihPAvPcqIFjLu92AQSVHePqPJcs (the bundle was changed after it was signed, or the signature is \
         of another bundle)\nreached level 0 (safe) of level 3 (derived): the bundle is not what it says\n"
    );
    assert_eq!((report.name, report.bundle_id), (None, None));

    // The list of digests that was signed, in a bag that is another: the signature is good and level 1 reports the
    // rest.
    let signed = include_bytes!("../../../tests/signatures/tagmanifest-sha256.txt");
    tree.insert("tagmanifest-sha256.txt".into(), signed.to_vec());
    let report = climb_for(&reviewer, Ok(Archive::of(Form::Bag, tree)), &options, &ENGINE);
    let by = "by alice@example.org with the key SHA256:d49HsAAG1CRNSwsjihPAvPcqIFjLu92AQSVHePqPJcs";
    assert_eq!(report.signed.as_ref().unwrap().to_string(), by);
    assert!(report.to_human().contains(&format!("\nsigned   {by}\n")));
    assert_eq!((report.reached, report.verdict()), (Some(Level::Safe), Verdict::Broken));
}

#[test]
fn a_signature_that_nobody_asked_to_check_is_noted() {
    let mut tree = sample::sealed().tree;
    tree.insert("tagmanifest-sha256.txt.sig".into(), SIGNATURE.into());
    let report = climb_to(Level::Derived, tree);
    assert_eq!(report.verdict(), Verdict::Holds);
    assert_eq!(
        told(&report),
        [
            "note at level 1: tagmanifest-sha256.txt.sig: expected keys to check the signature with, found none (name those you \
          trust with `--trust FILE`; unchecked, it says nothing)"
        ]
    );
}

#[test]
fn an_attestation_says_what_was_checked_and_nothing_more() {
    let date = Moment(1_768_478_400);
    let sealed = sample::sealed();
    let mut tree = sealed.tree.clone();
    tree.insert("tagmanifest-sha256.txt.sig".into(), SIGNATURE.into());
    let envelope = climb_to(Level::Sampled, tree).attest(date).unwrap();
    let to_sign = String::from_utf8(envelope.to_sign()).unwrap();
    let states: Vec<String> = ["safe", "fixity", "coherent", "derived", "sampled"]
        .iter()
        .enumerate()
        .map(|(i, name)| format!("{{\"level\":{i},\"name\":\"{name}\",\"state\":\"passed\"}}"))
        .collect();
    let payload = format!(
        "{{\"_type\":\"https://in-toto.io/Statement/v1\",\"predicate\":{{\"bundleId\":\"sha256:{id}\",\
         \"date\":\"2026-01-15T12:00:00Z\",\"engine\":\"test-1\",\"level\":4,\"levelName\":\"sampled\",\"levels\":[{}],\
         \"notChecked\":[],\"notes\":[{{\"expected\":\"keys to check the signature with\",\"found\":\"none\",\"hint\":\"name \
         those you trust with `--trust FILE`; unchecked, it says nothing\",\"level\":1,\"path\":\
         \"tagmanifest-sha256.txt.sig\"}}],\"overrides\":[],\"partial\":false,\"program\":\"reenact {}\",\"replication\":null,\
         \"resultsDigest\":\"sha256:{}\",\"sample\":{{\"bound\":0,\"equal\":6,\"executed\":6,\"inWords\":\"all 6 trials gave \
         the same bytes again\",\"of\":6,\"seed\":\"1\"}},\"selection\":{{\"only\":{{}},\"shard\":null,\"trials\":null}},\
         \"signed\":null,\"study\":\"corridors\",\"studyDigest\":\"sha256:{}\",\"verdict\":\"holds\"}},\"predicateType\":\
         \"https://crates.io/crates/reenact#re-execution/v1\",\"subject\":[{{\"digest\":{{\"sha256\":\"{id}\"}},\"name\":\
         \"tagmanifest-sha256.txt\"}}]}}",
        states.join(","),
        crate::bundle::format::VERSION,
        sealed.results_digest,
        sealed.study_digest,
        id = sealed.bundle_id,
    );
    let head = format!("DSSEv1 28 application/vnd.in-toto+json {} ", payload.len());
    assert_eq!(to_sign, head + &payload);
    let json = envelope.to_json();
    assert!(
        json.starts_with("{\"payload\":\"eyJfdHlwZSI6Imh0dHBzOi8vaW4tdG90by5pby9TdGF0ZW1lbnQvdjEi"),
        "{json}"
    );
    assert!(
        json.ends_with("\",\"payloadType\":\"application/vnd.in-toto+json\",\"signatures\":[]}\n"),
        "{json}"
    );
    assert_eq!(Envelope::read("a.json", json.as_bytes()).unwrap(), envelope);
    assert_eq!(
        climb_to(Level::Full, forged()).attest(date).unwrap_err().to_string(),
        "the bundle holds to level 3 (derived) and not to level 5 (full), as was asked"
    );
    let opened = archive::read(&sealed.zip(Form::Crate), &Limits::default());
    let options = Options { level: Level::Derived, sample: 0, rows: None, seed: 0 };
    assert_eq!(
        climb(opened, &options, &ENGINE).attest(date).unwrap_err().to_string(),
        "a crate without its bag has no bundle id to attest; check the bundle itself"
    );
}

#[test]
fn a_newer_engine_says_what_it_can_judge_and_how_to_go_on() {
    let told = |tree: Tree| {
        let options = Options { level: Level::Full, sample: 1, rows: None, seed: 1 };
        let newer = Engine { version: "test-2", ..ENGINE };
        let report = climb(Ok(Archive::of(Form::Bag, tree)), &options, &newer);
        assert_eq!(
            (report.verdict(), report.reached),
            (Verdict::Unanswered, Some(Level::Coherent))
        );
        report.to_human().split_inclusive('\n').skip(4).collect::<String>()
    };
    let levels = "  0 safe      passed\n  1 fixity    passed\n  2 coherent  passed\n  3 derived   not judged\n  4 sampled   not \
                  judged\n  5 full      not judged\n";
    let obstacle = "obstacle at level 3: data/study.resolved.json: expected engine test-2, found engine test-1 (levels 0 to 2 \
                    can be judged here; the rest only by the engine that ran the study: ";
    let version = crate::bundle::format::VERSION;
    let install = format!(
        "in a checkout of the source of reenact {version}, `cargo install --path . --locked`, then its own `reenact verify`"
    );
    let end = "reached level 2 (coherent) of level 5 (full): this program cannot judge further\n";
    assert_eq!(told(sample::sealed().tree), format!("{levels}{obstacle}{install})\n{end}"));
    let source = format!(
        ", or, where none can be had, build the source sealed in data/engine/reenact-{version}-source.zip (read it \
         first: it is a stranger's)"
    );
    assert_eq!(told(with_capsule()), format!("{levels}{obstacle}{install}{source})\n{end}"));

    // What a bundle says is put into a command only where it is a version.
    let mut hostile = sample::sealed().tree;
    edit(&mut hostile, "data/ro-crate-metadata.json", |text| {
        text.replace(&format!("Run of reenact {version}"), "Run of reenact 1;id")
    });
    sample::recompute(&mut hostile);
    let options = Options { level: Level::Full, sample: 1, rows: None, seed: 1 };
    let newer = Engine { version: "test-2", ..ENGINE };
    let report = climb(Ok(Archive::of(Form::Bag, hostile)), &options, &newer);
    let readme = "install the version of reenact that the bundle's README.md names";
    let human = report.to_human();
    assert!(
        human.contains(&format!("{obstacle}{readme})\n")) && !human.contains("1;id"),
        "{human}"
    );
}

#[test]
fn a_capsule_is_data_beside_the_results_and_is_compared() {
    let (plain, tree) = (sample::sealed(), with_capsule());
    assert_eq!(crate::bundle::results_digest(&tree), plain.results_digest);
    let report = climb_to(Level::Full, tree.clone());
    assert_eq!((told(&report), report.verdict()), (Vec::new(), Verdict::Holds));
    let readme = String::from_utf8(tree["data/README.md"].clone()).unwrap();
    let version = crate::bundle::format::VERSION;
    let path = format!("engine/reenact-{version}-source.zip");
    for says in [
        &format!("`{path}` holds its source"),
        &format!("\nunzip {path}\ncargo install"),
        &format!("cargo install --path reenact-{version} --locked"),
    ] {
        assert!(readme.contains(says.as_str()), "{readme}");
    }
    let metadata = String::from_utf8(tree["data/ro-crate-metadata.json"].clone()).unwrap();
    assert!(metadata.contains(&format!("\"@id\": \"{path}\"")));

    let mut changed = tree.clone();
    let bytes = changed.get_mut(&format!("data/{path}")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    sample::recompute(&mut changed);
    let report = climb_to(Level::Derived, changed);
    let findings: Vec<_> = told(&report).iter().map(|text| shorten(text)).collect();
    assert_eq!(
        findings,
        [format!(
            "error at level 3: data/{path}: expected the source that reenact {version} was built from, found sha256:* (another \
             source, or one of the same version that was changed: build nothing from it)"
        )]
    );

    let capsule = capsule::own();
    let circumstance =
        crate::bundle::Circumstance { version: "0.0.9".to_owned(), ..sample::circumstance() };
    let additions = Additions { source: Some(&capsule), ..Additions::default() };
    let older = seal_with(&sample::content(), &circumstance, additions).unwrap().tree;
    let report = climb_to(Level::Derived, older);
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Coherent)));
    assert_eq!(
        told(&report),
        [format!(
            "obstacle at level 3: data/{path}: expected the source of reenact {version}, found one that claims to be of reenact \
             0.0.9 (this program can compare its own source only: build nothing from this one before you have read it)"
        )]
    );
    let human = report.to_human();
    let end = "this program cannot judge further; the engine's source is not checked; the description is not checked\n";
    assert!(human.ends_with(end), "{human}");
}

/// Checks that only the elements and attributes of Jenkins' `junit-10.xsd`, which GitLab and most viewers follow, stand
/// there, in the order it wants.
#[test]
fn junit_has_the_shape_that_viewers_expect() {
    let now = std::cell::Cell::new(0.0);
    let clock = || {
        now.set(now.get() + 0.25);
        now.get()
    };
    let vouching = Vouching { trust: None, signature: None, now: Moment(0) };
    let reviewer = Reviewer { vouching, clock: &clock, judged: &|_| () };
    let options = Options { level: Level::Full, sample: 0, rows: None, seed: 1 };
    let mut tree = forged();
    tree.insert("tagmanifest-sha256.txt.sig".into(), SIGNATURE.into());
    let report = climb_for(&reviewer, Ok(Archive::of(Form::Bag, tree)), &options, &ENGINE);
    let junit = report.to_junit();
    let document = roxmltree::Document::parse(&junit).unwrap();
    let allowed = |tag: &str| -> (&[&str], &[&str]) {
        match tag {
            "testsuites" => (&["name", "tests", "failures", "errors", "time"], &["testsuite"]),
            "testsuite" => (
                &["name", "tests", "failures", "errors", "skipped", "time"],
                &["properties", "testcase", "system-out"],
            ),
            "properties" => (&[], &["property"]),
            "property" => (&["name", "value"], &[]),
            "testcase" => (&["name", "classname", "time"], &["skipped", "failure", "system-out"]),
            "failure" => (&["message", "type"], &[]),
            "skipped" => (&["message"], &[]),
            "system-out" => (&[], &[]),
            other => panic!("an element `{other}` that no viewer knows"),
        }
    };
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        let (attributes, children) = allowed(node.tag_name().name());
        for attribute in node.attributes() {
            assert!(attributes.contains(&attribute.name()), "{junit}");
        }
        for child in node.children().filter(roxmltree::Node::is_element) {
            assert!(children.contains(&child.tag_name().name()), "{junit}");
        }
    }
    let cases: Vec<_> = document
        .descendants()
        .filter(|node| node.has_tag_name("testcase"))
        .map(|node| (node.attribute("name").unwrap(), node.attribute("time").unwrap()))
        .collect();
    let expected = [
        ("level 0 (safe)", "0.250"),
        ("level 1 (fixity)", "0.250"),
        ("level 2 (coherent)", "0.250"),
        ("level 3 (derived)", "0.250"),
        ("level 4 (sampled)", "0.000"),
        ("level 5 (full)", "0.250"),
    ];
    assert_eq!(cases, expected);
    let suite = document.root_element().first_element_child().unwrap();
    let count = |name| suite.attribute(name).unwrap();
    assert_eq!(
        (count("tests"), count("failures"), count("skipped"), count("time")),
        ("6", "2", "0", "1.250")
    );
}

#[test]
fn a_hostile_bundle_cannot_write_to_the_terminal() {
    let mut tree = sample::sealed().tree;
    edit(&mut tree, "bag-info.txt", |text| {
        text.replace("Payload-Oxum: ", "Payload-Oxum: \u{1b}[2J")
    });
    let report = climb_to(Level::Coherent, tree);
    assert_eq!(report.verdict(), Verdict::Broken);
    for text in [report.to_human(), report.to_junit(), report.to_json()] {
        assert!(!text.contains('\u{1b}') && text.contains("[2J"), "{text}");
    }
}
