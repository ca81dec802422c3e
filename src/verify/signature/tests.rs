//! Signatures that OpenSSH and minisign made are told apart: good, by a stranger, of other bytes, for another purpose.

use super::*;
use crate::bundle::Tree;

macro_rules! fixture {
    ($name:literal) => {
        include_str!(concat!("../../../tests/signatures/", $name))
    };
}

const SIGNED: &str = fixture!("tagmanifest-sha256.txt");
const SIGNERS: &str = fixture!("allowed_signers");
const MINISIGN: &str = fixture!("minisign.pub");
const NOW: Moment = Moment(1_768_478_400);
const ED25519: &str = "SHA256:d49HsAAG1CRNSwsjihPAvPcqIFjLu92AQSVHePqPJcs";

fn trust(name: &str, text: &str) -> Trust {
    Trust::read(&Source::new(name, text)).unwrap()
}

fn bag(files: &[(&str, &str)]) -> Archive {
    let files = files.iter().map(|(path, text)| ((*path).to_owned(), text.as_bytes().to_vec()));
    let tree: Tree = files.chain([(format::TAG_MANIFEST.to_owned(), SIGNED.into())]).collect();
    Archive::of(Form::Bag, tree)
}

fn told(archive: &Archive, trust: Option<&Trust>, signature: Option<&str>) -> String {
    let signature = signature.map(|text| ("beside.sig", text.as_bytes()));
    match check(archive, &Vouching { trust, signature, now: NOW }) {
        Outcome::Unsigned => "unsigned".to_owned(),
        Outcome::Unchecked(fault) => format!("unchecked: {fault}"),
        Outcome::Good(signed) => format!("good: {signed}"),
        Outcome::Refused(fault) => format!("refused: {fault}"),
    }
}

/// Returns what is said of `signature` beside a bag that is not signed itself.
fn of(signers: &str, signature: &str) -> String {
    told(&bag(&[]), Some(&trust(name_of(signers), signers)), Some(signature))
}

/// Returns the name of the file that holds `keys`.
fn name_of(keys: &str) -> &'static str {
    if keys.contains("ssh-") { "signers" } else { "minisign.pub" }
}

#[test]
fn good_signatures_name_principal_and_key() {
    assert_eq!(
        of(SIGNERS, fixture!("ed25519.sig")),
        format!("good: by alice@example.org with the key {ED25519}")
    );
    for (signature, by) in [
        (fixture!("rsa.sig"), "good: by rosa@example.org with the key SHA256:"),
        (fixture!("ecdsa-p256.sig"), "good: by erin@example.org,erin with the key SHA256:"),
    ] {
        let told = of(SIGNERS, signature);
        assert!(told.starts_with(by), "{told}");
    }
    let good = "good: by the owner of `minisign.pub` with the key 8A90CDF65360EC10";
    assert_eq!(of(MINISIGN, fixture!("minisign.minisig")), good);
    let key_alone = MINISIGN.lines().nth(1).unwrap();
    assert_eq!(of(key_alone, fixture!("minisign.minisig")), good);
}

#[test]
fn a_signature_in_the_bag_is_found_and_one_beside_it_comes_first() {
    let (ssh, mini) = (trust("signers", SIGNERS), trust("minisign.pub", MINISIGN));
    let both = bag(&[
        ("tagmanifest-sha256.txt.sig", fixture!("ed25519.sig")),
        ("tagmanifest-sha256.txt.minisig", fixture!("minisign.minisig")),
    ]);
    assert!(told(&both, Some(&ssh), None).starts_with("good: by alice@example.org"));
    assert!(told(&both, Some(&mini), None).starts_with("good: by the owner of `minisign.pub`"));
    assert!(
        told(&both, Some(&ssh), Some(fixture!("stranger.sig")))
            .starts_with("refused: beside.sig: expected a signature by a key of `signers`, found one by the unknown key")
    );
    assert_eq!(
        told(&both, None, None),
        "unchecked: tagmanifest-sha256.txt.sig: expected keys to check the signature with, found none (name those you trust \
         with `--trust FILE`; unchecked, it says nothing)"
    );
    assert_eq!(told(&bag(&[]), None, None), "unsigned");
}

#[test]
fn what_does_not_vouch_is_told_apart() {
    let begin = "refused: beside.sig: expected a signature by a key of `signers`, found ";
    let begin_minisign = begin.replace("signers", "minisign.pub");
    assert_eq!(
        of(SIGNERS, fixture!("stranger.sig")),
        format!(
            "{begin}one by the unknown key SHA256:bhK7FaarkOe7fSUJZSYr22YwcG9hIy43Cpf7zmXny9I (it fits the bundle, but none of the keys you trust made it)"
        )
    );
    assert_eq!(
        of(SIGNERS, fixture!("another-namespace.sig")),
        format!(
            "{begin}one of the namespace `file` (it was made for another purpose; bundles are signed with `ssh-keygen -Y \
             sign -n reenact`)"
        )
    );
    assert_eq!(
        of(SIGNERS, fixture!("ecdsa-p384.sig")),
        format!(
            "{begin}one by a key of the kind ecdsa-sha2-nistp384, which this program cannot check (`ssh-keygen -Y verify` \
             may; the kinds known here are Ed25519, ECDSA P-256, both on security keys, and RSA)"
        )
    );
    assert_eq!(of(SIGNERS, "hello"), format!("{begin}neither an OpenSSH nor a minisign signature"));
    assert_eq!(
        of(SIGNERS, fixture!("minisign.minisig")),
        format!(
            "{begin}a minisign signature (keys of one kind cannot check signatures of the other)"
        )
    );
    let cut = &fixture!("ed25519.sig")[..100];
    assert!(
        of(SIGNERS, cut).starts_with(&format!("{begin}an OpenSSH signature that cannot be read ("))
    );
    assert_eq!(
        of(MINISIGN, fixture!("stranger.minisig")),
        format!(
            "{begin_minisign}one by the unknown key 9B2962AFD0ADBFE5 (you trust another key; whether the signature fits the bundle cannot \
             be told without its own)"
        )
    );
    assert_eq!(
        of(MINISIGN, "untrusted comment: x\n"),
        format!(
            "{begin_minisign}a minisign signature that cannot be read (it must have four lines; it may be cut short)"
        )
    );
}

#[test]
fn a_changed_list_of_digests_is_a_bad_signature() {
    let mut archive = bag(&[]);
    archive.tree.get_mut(format::TAG_MANIFEST).unwrap()[0] ^= 1;
    let hint =
        "(the bundle was changed after it was signed, or the signature is of another bundle)";
    let begin = "refused: beside.sig: expected a signature by a key of `signers`, found one that does not fit this bundle, by \
                 the key";
    let told = |signers: &str, signature| {
        told(&archive, Some(&trust(name_of(signers), signers)), Some(signature))
    };
    assert_eq!(told(SIGNERS, fixture!("ed25519.sig")), format!("{begin} {ED25519} {hint}"));
    assert_eq!(
        told(MINISIGN, fixture!("minisign.minisig")),
        format!("{begin} 8A90CDF65360EC10 {hint}").replace("signers", "minisign.pub")
    );
    // A stranger's bad signature is a bad one first.
    assert!(told(SIGNERS, fixture!("stranger.sig")).ends_with(hint));
}

#[test]
fn limits_of_a_trusted_key_hold() {
    let key = SIGNERS.lines().nth(1).unwrap().split_once("ssh-ed25519").unwrap().1;
    let with =
        |options: &str| of(&format!("alice {options} ssh-ed25519{key}\n"), fixture!("ed25519.sig"));
    let begin = "refused: beside.sig: expected a signature by a key of `signers`, found one by";
    assert_eq!(
        with("namespaces=\"git\""),
        format!(
            "{begin} the key {ED25519}, which is not trusted for the namespace `reenact` (add the namespace to the key's \
             `namespaces=` if you trust it for bundles)"
        )
    );
    assert_eq!(
        with("valid-after=\"20200101\",valid-before=\"20260101\""),
        format!(
            "{begin} alice with the key {ED25519}, which is trusted from 2020-01-01 and before 2026-01-01 and not on \
             2026-01-15"
        )
    );
    assert!(with("valid-before=\"20260116\"").starts_with("good: by alice"));
    assert!(with("cert-authority").contains("the unknown key"));
}

#[test]
fn without_a_signature_or_a_bag_nobody_vouches() {
    let signers = trust("signers", SIGNERS);
    assert_eq!(
        told(&bag(&[]), Some(&signers), None),
        "refused: tagmanifest-sha256.txt: expected a signature by a key of `signers`, found no signature (if its author \
         signed it, give the file with `--signature FILE`)"
    );
    let crate_alone = Archive { form: Form::Crate, ..bag(&[]) };
    assert_eq!(
        told(&crate_alone, Some(&signers), Some(fixture!("ed25519.sig"))),
        "refused: tagmanifest-sha256.txt: expected a signature by a key of `signers`, found a crate without its bag (only the \
         bag holds the list of digests that is signed; ask for the bundle itself)"
    );
    let fault = Trust::read(&Source::new("k.pub", "untrusted comment: a\nRWQ\n")).unwrap_err();
    assert_eq!(
        fault[0].render(false),
        "error: `k.pub`: expected a minisign public key, 56 characters beginning with `RW`, found 3 characters that are none on \
         line 2\n |\n = help: give the public key (minisign.pub), not the secret key and not a signature\n"
    );
}

#[test]
fn signatures_find_their_place_in_a_bag() {
    assert_eq!(path_in_bag(fixture!("rsa.sig").as_bytes()), Some("tagmanifest-sha256.txt.sig"));
    let minisign = fixture!("minisign.minisig").as_bytes();
    assert_eq!(path_in_bag(minisign), Some("tagmanifest-sha256.txt.minisig"));
    assert_eq!(path_in_bag(b"hello"), None);
}

/// A throw-away key; nothing was ever signed with it.
const PRIVATE: &str = "-----BEGIN OPENSSH PRIVATE KEY-----
b3BlbnNzaC1rZXktdjEAAAAABG5vbmUAAAAEbm9uZQAAAAAAAAABAAAAMwAAAAtzc2gtZWQyNTUx
-----END OPENSSH PRIVATE KEY-----
";

#[test]
fn not_a_byte_of_a_private_key_is_shown() {
    let refused = |text: &str| {
        let faults = Trust::read(&Source::new("id", text)).unwrap_err();
        crate::document::reports(&faults, false).concat()
    };
    let says = |kind: &str| {
        format!(
            "error: `id`: expected public keys, found {kind}\n |\n = help: give the public key, which lies beside it (`id.pub`), in \
             an `allowed_signers` file; nothing of the private key was printed or kept\n"
        )
    };
    assert_eq!(refused(PRIVATE), says("an OpenSSH private key"));
    // Even where a key that is good stands above it.
    assert_eq!(refused(&format!("{SIGNERS}{PRIVATE}")), says("an OpenSSH private key"));
    assert_eq!(refused(&PRIVATE.replace("OPENSSH ", "RSA ")), says("a private key"));
    assert_eq!(refused("PuTTY-User-Key-File-3: ssh-ed25519\n"), says("a PuTTY private key"));
    let minisign = "untrusted comment: minisign encrypted secret key\nRWRTY0Iyabcdef\n";
    assert_eq!(refused(minisign), says("a minisign secret key"));
    // A secret of another kind: nothing that looks like a key, so nothing is shown.
    assert_eq!(
        refused("root:x:0:0\npassword hunter2\n"),
        "error: `id`: expected keys to trust, found text of which no line is one\n |\n = help: it must be an OpenSSH \
         `allowed_signers` file or a minisign public key\n"
    );
}
