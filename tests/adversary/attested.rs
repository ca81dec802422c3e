//! Attestations: made, signed, read back, and whatever an attacker may hand over in their place.

use super::forger;
use super::study::HONEST;
use crate::sandbox::{Answer, Sandbox};
use base64ct::{Base64, Encoding as _};
use reenact::bundle::{Form, archive};
use reenact::plan::engine_version;
use reenact::studies::StudyKind;
use serde_json::{Value, json};
use ssh_key::private::Ed25519Keypair;
use ssh_key::{HashAlg, LineEnding, PrivateKey};
use std::fs;
use std::sync::LazyLock;

const TYPE: &str = "application/vnd.in-toto+json";

/// Returns the engine of the honest bundle's study.
fn engine() -> String {
    engine_version(StudyKind::named("prior-map").unwrap())
}

/// The fingerprint of the reviewer's key.
static REVIEWER: LazyLock<String> = LazyLock::new(|| fingerprint(1));

/// The envelope that a check to level 5 of the honest bundle wrote, and the bytes to sign.
static MADE: LazyLock<(Value, Vec<u8>)> = LazyLock::new(|| {
    let sandbox = Sandbox::new();
    sandbox.write("bundle", &HONEST.zip);
    let words = ["verify", "bundle", "--level", "5", "--attest", "review.json"];
    let answer = sandbox.run_bounded(&words);
    let says = "wrote review.json, unsigned, and review.json.pae, the bytes to sign\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 0), "{answer:?}");
    let envelope = fs::read(sandbox.path("review.json")).unwrap();
    let to_sign = fs::read(sandbox.path("review.json.pae")).unwrap();
    (serde_json::from_slice(&envelope).unwrap(), to_sign)
});

/// Returns a key of nobody's but this test's: `seed` is all of its secret.
fn key(seed: u8) -> PrivateKey {
    PrivateKey::from(Ed25519Keypair::from_seed(&[seed; 32]))
}

fn fingerprint(seed: u8) -> String {
    key(seed).public_key().fingerprint(HashAlg::Sha256).to_string()
}

fn sign(seed: u8, namespace: &str, message: &[u8]) -> String {
    let signature = key(seed).sign(namespace, HashAlg::Sha512, message).unwrap();
    signature.to_pem(LineEnding::LF).unwrap()
}

fn payload() -> Vec<u8> {
    Base64::decode_vec(MADE.0["payload"].as_str().unwrap()).unwrap()
}

fn pae(kind: &str, payload: &[u8]) -> Vec<u8> {
    let head = format!("DSSEv1 {} {kind} {} ", kind.len(), payload.len());
    [head.as_bytes(), payload].concat()
}

fn envelope(kind: &str, payload: &[u8], signatures: &[String]) -> String {
    let signatures: Vec<Value> = signatures
        .iter()
        .map(|text| json!({"keyid": "whatever", "sig": Base64::encode_string(text.as_bytes())}))
        .collect();
    let payload = Base64::encode_string(payload);
    json!({"payload": payload, "payloadType": kind, "signatures": signatures}).to_string()
}

/// Returns `payload`, signed by the reviewer whom everybody here trusts.
fn signed(payload: &[u8]) -> String {
    envelope(TYPE, payload, &[sign(1, "reenact", &pae(TYPE, payload))])
}

/// Returns the honest Statement with something changed, signed all the same.
fn signed_with(change: impl FnOnce(&mut Value)) -> String {
    let mut statement: Value = serde_json::from_slice(&payload()).unwrap();
    change(&mut statement);
    signed(statement.to_string().as_bytes())
}

/// Returns the answer for a reader who trusts the reviewer with `limits`, and has `attestation` of `bundle`.
fn read(limits: &str, bundle: &[u8], attestation: &str) -> Answer {
    let sandbox = Sandbox::new();
    sandbox.write("bundle", bundle);
    sandbox.write("review.json", attestation);
    let public = key(1).public_key().to_openssh().unwrap();
    let line = format!("reviewer@example.org {limits} {public}\n");
    sandbox.write("signers", line);
    sandbox.run_reading(&["verify", "bundle", "--trust", "signers", "--attestation", "review.json"])
}

#[test]
fn an_attestation_is_a_statement_in_an_envelope() {
    let (envelope, to_sign) = &*MADE;
    assert_eq!((&envelope["payloadType"], &envelope["signatures"]), (&json!(TYPE), &json!([])));
    assert_eq!(*to_sign, pae(TYPE, &payload()));
    let statement: Value = serde_json::from_slice(&payload()).unwrap();
    assert_eq!(statement["_type"], "https://in-toto.io/Statement/v1");
    let kind = "https://crates.io/crates/reenact#re-execution/v1";
    assert_eq!(statement["predicateType"], kind);
    let id = reenact::digest::Sha256Digest::of(&HONEST.tree["tagmanifest-sha256.txt"]).hex();
    let subject = json!([{"name": "tagmanifest-sha256.txt", "digest": {"sha256": id}}]);
    assert_eq!(statement["subject"], subject);
    let predicate = &statement["predicate"];
    assert_eq!(predicate["bundleId"], format!("sha256:{id}"));
    assert_eq!(
        (&predicate["level"], &predicate["levelName"], &predicate["verdict"]),
        (&json!(5), &json!("full"), &json!("holds"))
    );
    let sample = json!({
        "executed": 6, "equal": 6, "of": 6, "seed": null, "bound": 0,
        "inWords": "all 6 trials gave the same bytes again",
    });
    assert_eq!(predicate["sample"], sample);
    assert_eq!(predicate["levels"].as_array().unwrap().len(), 6);
    assert_eq!(predicate["notes"], json!([]));
    assert_eq!((&predicate["partial"], &predicate["overrides"]), (&json!(false), &json!([])));
    assert!(predicate["date"].as_str().unwrap().ends_with('Z'));
}

#[test]
fn a_signed_attestation_is_read_back() {
    let answer = read("", &HONEST.zip, &signed(&payload()));
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0), "{answer:?}");
    let statement: Value = serde_json::from_slice(&payload()).unwrap();
    let date = statement["predicate"]["date"].as_str().unwrap();
    let reviewer = &*REVIEWER;
    let says = format!(
        "\nattested by reviewer@example.org with the key {reviewer}: level 5 (full) held on {date}, by reenact {}, engine {}\n",
        env!("CARGO_PKG_VERSION"),
        engine()
    );
    assert!(answer.stdout.contains(&says), "{}", answer.stdout);
    assert!(
        answer.stdout.ends_with(
            "\nattested: all 6 trials gave the same bytes again\nreached level 3 (derived) of level 3 (derived): the bundle is \
             what it says\n"
        ),
        "{}",
        answer.stdout
    );

    // Notes and all else that was said is told, and cannot steer the terminal or begin a line of its own.
    let noted = signed_with(|statement| {
        let predicate = &mut statement["predicate"];
        predicate["notes"] = json!([{
            "level": 3, "path": "data/x", "expected": "a\u{1b}[2J", "found": "b\nreached level 6", "hint": "\u{202e}c",
        }]);
        predicate["notChecked"] = json!(["the host\u{7}"]);
        predicate["program"] = json!("reenact\u{1b}[1A 9");
    });
    let answer = read("", &HONEST.zip, &noted);
    assert_eq!(answer.code, 0);
    let says = "attested: note at level 3: data/x: expected a\\u{1b}[2J, found b reached level 6 (\\u{202e}c)\nattested: not \
                checked: the host\\u{7}\nreached level 3";
    assert!(answer.stdout.contains(says), "{}", answer.stdout);
    let says = format!(", by reenact\\u{{1b}}[1A 9, engine {}\n", engine());
    assert!(answer.stdout.contains(&says), "{}", answer.stdout);

    // A second signature by a key that the reader does not trust takes nothing away.
    let to_sign = pae(TYPE, &payload());
    let two = [sign(2, "reenact", &to_sign), sign(1, "reenact", &to_sign)];
    let answer = read("namespaces=\"reenact\"", &HONEST.zip, &envelope(TYPE, &payload(), &two));
    assert_eq!(answer.code, 0, "{answer:?}");
    let says = "\nattested: said to be signed with the key SHA256:";
    assert!(answer.stdout.contains(says), "{}", answer.stdout);
}

/// Returns every attack: what it is, what the reader is told.
fn attacks() -> Vec<(&'static str, String, String)> {
    let by = "expected a signature by a key of `signers`, found ";
    let reviewer = &*REVIEWER;
    let unfit = format!(
        "{by}one that does not fit this attestation, by the key {reviewer} (the attestation was changed after it was signed, or \
         the signature is of something else)"
    );
    let honest = payload();
    let text = String::from_utf8(honest.clone()).unwrap();
    let signature = sign(1, "reenact", &pae(TYPE, &honest));
    let raised = text
        .replace("\"level\":5,\"levelName\":\"full\"", "\"level\":6,\"levelName\":\"replicated\"");
    assert_ne!(raised, text);
    let twice = text.replace("\"level\":5,\"levelName\"", "\"level\":4,\"level\":5,\"levelName\"");
    assert_ne!(twice, text);
    let other_bytes = sign(2, "reenact", b"something else");
    let list = &HONEST.tree["tagmanifest-sha256.txt"];
    let predicate =
        "expected a predicate of the type https://crates.io/crates/reenact#re-execution/v1, found ";
    let said =
        |change: &dyn Fn(&mut Value)| signed_with(|statement| change(&mut statement["predicate"]));
    let stranger = fingerprint(2);
    vec![
        (
            "unsigned",
            MADE.0.to_string(),
            format!("{by}none (sign it as docs/verification.md says; `reenact attest` puts the signature in)"),
        ),
        ("a level raised after it was signed", envelope(TYPE, raised.as_bytes(), std::slice::from_ref(&signature)), unfit.clone()),
        (
            "a signature of the bundle's list of digests",
            envelope(TYPE, &honest, &[sign(1, "reenact", list)]),
            unfit.clone(),
        ),
        ("a signature of the payload without its type", envelope(TYPE, &honest, &[sign(1, "reenact", &honest)]), unfit),
        (
            "a signature of another namespace",
            envelope(TYPE, &honest, &[sign(1, "file", &pae(TYPE, &honest))]),
            format!(
                "{by}one of the namespace `file` (it was made for another purpose; attestations are signed with `ssh-keygen -Y \
                 sign -n reenact`)"
            ),
        ),
        (
            "a stranger's signature",
            envelope(TYPE, &honest, &[sign(2, "reenact", &pae(TYPE, &honest))]),
            format!(
                "{by}one by the unknown key {stranger} (it fits the attestation, but none of the keys you trust made it)"
            ),
        ),
        (
            "two signatures, one of them bad",
            envelope(TYPE, &honest, &[signature.clone(), other_bytes]),
            format!(
                "{by}one that does not fit this attestation, by the key {stranger} (the attestation was changed after it was \
                 signed, or the signature is of something else)"
            ),
        ),
        (
            "a signature that is none",
            envelope(TYPE, &honest, &["trust me".to_owned()]),
            format!("{by}neither an OpenSSH nor a minisign signature"),
        ),
        (
            "seventeen signatures",
            envelope(TYPE, &honest, &vec![signature.clone(); 17]),
            "expected at most 16 signatures, found 17".to_owned(),
        ),
        (
            "another type of payload",
            envelope("text/plain\u{1b}[2J", &honest, &[sign(1, "reenact", &pae("text/plain\u{1b}[2J", &honest))]),
            format!("expected the payload type `{TYPE}`, found `text/plain\\u{{1b}}[2J`"),
        ),
        (
            "two payloads",
            signed(&honest).replacen('{', "{\"payload\":\"e30=\",", 1),
            "expected a DSSE envelope, which `reenact verify --attest` writes, found duplicate field `payload` at line 1 column"
                .to_owned(),
        ),
        (
            "a payload that is no base64",
            signed(&honest).replacen("\"payload\":\"", "\"payload\":\"!", 1),
            "expected a payload in base64, found other text".to_owned(),
        ),
        (
            "brackets, two hundred thousand deep",
            signed(format!("{{\"x\":{}", "[".repeat(200_000)).as_bytes()),
            "expected a Statement of in-toto (https://in-toto.io/Statement/v1), found EOF while parsing a list at line 1 column"
                .to_owned(),
        ),
        ("the level said twice", signed(twice.as_bytes()), format!("{predicate}duplicate field `level` at line 1 column")),
        (
            "another Statement",
            signed_with(|statement| statement["_type"] = "https://in-toto.io/Statement/v0.1".into()),
            "expected a Statement of in-toto (https://in-toto.io/Statement/v1), found `https://in-toto.io/Statement/v0.1`"
                .to_owned(),
        ),
        (
            "another predicate",
            signed_with(|statement| statement["predicateType"] = "https://slsa.dev/provenance/v1".into()),
            format!(
                "{predicate}`https://slsa.dev/provenance/v1` (it says something else than how far a bundle was checked)"
            ),
        ),
        (
            "two subjects",
            signed_with(|statement| {
                let subject = statement["subject"][0].clone();
                statement["subject"].as_array_mut().unwrap().push(subject);
            }),
            "expected one subject, the bundle, found 2 subjects".to_owned(),
        ),
        (
            "a subject that the predicate contradicts",
            said(&|predicate| predicate["bundleId"] = "sha256:00".into()),
            "found sha256:00 (it attests another bundle)".to_owned(),
        ),
        (
            "other results",
            said(&|predicate| predicate["resultsDigest"] = "sha256:00".into()),
            ", found sha256:00\n".to_owned(),
        ),
        (
            "a check that failed",
            said(&|predicate| predicate["verdict"] = "broken".into()),
            "expected the verdict `holds`, found `broken`".to_owned(),
        ),
        (
            "a level that is none",
            said(&|predicate| predicate["level"] = 7.into()),
            "expected a level from 0 to 6 and its name, found level 7 (full)".to_owned(),
        ),
        (
            "a level below which one was not judged",
            said(&|predicate| predicate["levels"][3]["state"] = "not judged".into()),
            "expected every level from 0 to 5 passed, found 0 passed, 1 passed, 2 passed, 3 not judged, 4 passed, 5 passed"
                .to_owned(),
        ),
        (
            "a date that is none",
            said(&|predicate| predicate["date"] = "tomorrow".into()),
            "expected a date such as 2026-01-15T12:00:00Z, found `tomorrow`".to_owned(),
        ),
    ]
}

/// A file that is longer than any attestation is not even read.
#[test]
fn an_endless_attestation_is_no_attestation() {
    let spaces = " ".repeat(1 << 20);
    let answer = read("", &HONEST.zip, &envelope(TYPE, spaces.as_bytes(), &[]));
    let (begin, end) = (
        "error: cannot read `review.json`: it is too large: expected at most 1048576 bytes, found ",
        "\n",
    );
    assert_eq!((answer.stdout.as_str(), answer.code), ("", 2));
    let found = answer.stderr.strip_prefix(begin).and_then(|rest| rest.strip_suffix(end));
    assert!(found.is_some_and(|bytes| bytes.parse::<u64>().unwrap() > 1 << 20), "{answer:?}");
}

#[test]
fn nothing_but_a_signed_attestation_of_this_bundle_passes() {
    for (name, attestation, says) in attacks() {
        let answer = read("", &HONEST.zip, &attestation);
        assert_eq!((answer.stderr.as_str(), answer.code), ("", 1), "{name}: {answer:?}");
        let line = answer.stdout.lines().rev().nth(1).unwrap();
        assert!(line.starts_with("attestation refused: review.json: expected "), "{name}: {line}");
        assert!(format!("{line}\n").contains(&says), "{name}: {line}");
        let last = "reached level 3 (derived) of level 3 (derived): the bundle is what it says, but the attestation is refused";
        assert_eq!(answer.stdout.lines().last(), Some(last), "{name}");
        assert!(
            !answer.stdout.contains("\nattested ") && !answer.stdout.contains('\u{1b}'),
            "{name}"
        );
    }
    assert!(attacks().len() >= 20);
}

#[test]
fn keys_are_trusted_for_a_time_and_a_purpose() {
    let honest = signed(&payload());
    for (limits, says) in [
        ("valid-before=\"20200101\"", "which is trusted before 2020-01-01 and not on "),
        (
            "namespaces=\"git\"",
            "which is not trusted for the namespace `reenact` (add the namespace to the key's `namespaces=` if you trust it for \
             bundles)",
        ),
    ] {
        let answer = read(limits, &HONEST.zip, &honest);
        assert_eq!(answer.code, 1);
        let line = answer.stdout.lines().rev().nth(1).unwrap();
        assert!(line.starts_with("attestation refused: review.json: expected a signature by a key of `signers`, found one by "));
        assert!(line.contains(says), "{line}");
    }
}

#[test]
fn an_attestation_is_of_one_bundle_only() {
    let honest = signed(&payload());
    let mut tree = HONEST.tree.clone();
    forger::replace(&mut tree, forger::STUDY, "low: 5", "low: 6");
    let tree = forger::rederive(tree);
    let other = archive::write(&tree, "tiny", Form::Bag);
    let answer = read("", &other, &honest);
    assert_eq!(answer.code, 1);
    let id = |tree: &reenact::bundle::Tree| {
        reenact::digest::Sha256Digest::of(&tree["tagmanifest-sha256.txt"])
    };
    let says = format!(
        "\nattestation refused: review.json: expected the bundle sha256:{}, found sha256:{} (it attests another bundle)\n",
        id(&tree),
        id(&HONEST.tree)
    );
    assert!(answer.stdout.contains(&says), "{}", answer.stdout);

    // The same lists of digests over other files: what the id stands for is not there.
    let mut changed = HONEST.tree.clone();
    forger::replace(&mut changed, "data/README.md", "A tiny study", "A vast study");
    let answer = read("", &archive::write(&changed, &HONEST.root, Form::Bag), &honest);
    assert_eq!(answer.code, 1);
    let says = "\nattestation refused: review.json: expected a bundle whose files are those of its lists, found one that does not \
                hold to level 1 (fixity)\nreached level 0 (safe) of level 3 (derived): the bundle is not what it says\n";
    assert!(answer.stdout.ends_with(says), "{}", answer.stdout);
}

#[test]
fn programs_and_ci_read_who_attests() {
    let sandbox = Sandbox::new();
    sandbox.write("bundle", &HONEST.zip);
    let public = key(1).public_key().to_openssh().unwrap();
    sandbox.write("signers", format!("r@example.org {public}\n"));
    let words =
        ["verify", "bundle", "--trust", "signers", "--attestation", "review.json", "--format"];
    let told = |attestation: &str, format: &str| {
        sandbox.write("review.json", attestation);
        sandbox.run_reading(&[&words[..], &[format]].concat())
    };
    let good = told(&signed(&payload()), "json");
    let json: Value = serde_json::from_str(&good.stdout).unwrap();
    assert_eq!(json["attestation"]["signed"], json!([{"by": "r@example.org", "key": *REVIEWER}]));
    assert_eq!((&json["attestation"]["level"], &json["verdict"]), (&json!(5), &json!("holds")));
    let bad = told(&MADE.0.to_string(), "json");
    let json: Value = serde_json::from_str(&bad.stdout).unwrap();
    assert_eq!((bad.code, &json["verdict"]), (1, &json!("not-attested")));
    assert!(json["attestation"]["refused"].as_str().unwrap().contains("found none (sign it "));
    for (attestation, failures) in [(signed(&payload()), 0), (MADE.0.to_string(), 1)] {
        let junit = told(&attestation, "junit").stdout;
        let document = roxmltree::Document::parse(&junit).unwrap();
        let count = |tag: &str| document.descendants().filter(|n| n.has_tag_name(tag)).count();
        assert_eq!((count("testcase"), count("failure")), (5, failures), "{junit}");
        assert_eq!(junit.contains("name=\"attested\""), failures == 0, "{junit}");
    }
}

#[test]
fn a_signature_is_put_into_an_attestation_that_it_fits() {
    let sandbox = Sandbox::new();
    let words = ["attest", "review.json", "--signature", "review.json.pae.sig"];
    let given = |signature: &str| {
        sandbox.write("review.json", MADE.0.to_string());
        sandbox.write("review.json.pae.sig", signature);
        sandbox.run_bounded(&words)
    };
    let (signature, reviewer) = (sign(1, "reenact", &MADE.1), &*REVIEWER);
    let answer = given(&signature);
    let says = format!("review.json: signed with the key {reviewer}\n");
    assert_eq!(
        (answer.stdout.as_str(), answer.stderr.as_str(), answer.code),
        (says.as_str(), "", 0)
    );
    let read = || -> Value {
        serde_json::from_slice(&fs::read(sandbox.path("review.json")).unwrap()).unwrap()
    };
    let inside = json!([{"keyid": *REVIEWER, "sig": Base64::encode_string(signature.as_bytes())}]);
    assert_eq!(read()["signatures"], inside);
    // Once more, and it stands there once; another's comes beside it.
    assert_eq!(sandbox.run_bounded(&words).code, 0);
    assert_eq!(read()["signatures"], inside);
    sandbox.write("review.json.pae.sig", sign(2, "reenact", &MADE.1));
    assert_eq!(sandbox.run_bounded(&words).code, 0);
    assert_eq!(read()["signatures"].as_array().unwrap().len(), 2);

    for (signature, code, says) in [
        (
            sign(1, "reenact", &payload()),
            1,
            format!(
                "error: review.json.pae.sig: expected a signature of this attestation, found one that does not fit this attestation, \
                 by the key {reviewer} (the attestation was changed after it was signed, or the signature is of something else)\n"
            ),
        ),
        (
            "-----BEGIN OPENSSH PRIVATE KEY-----\nc2VjcmV0\n".to_owned(),
            1,
            "error: review.json.pae.sig: expected a signature of this attestation, found neither an OpenSSH nor a minisign \
             signature\n"
                .to_owned(),
        ),
    ] {
        let answer = given(&signature);
        assert_eq!((answer.stderr.as_str(), answer.code), (says.as_str(), code));
        assert_eq!(read(), MADE.0, "it stays as it was");
    }
    sandbox.write("review.json", "{}");
    let answer = sandbox.run_reading(&words);
    let says = "error: review.json: expected a DSSE envelope, which `reenact verify --attest` writes, found missing field `payload` \
                at line 1 column 2\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 2));
}
