//! Signatures of `ssh-keygen -Y sign` (OpenSSH, PROTOCOL.sshsig).

use super::allowed_signers::{Limits, Signer};
use super::{NAMESPACE, Refusal, Signed};
use crate::bundle::Moment;
use ssh_key::public::KeyData;
use ssh_key::{Algorithm, EcdsaCurve, HashAlg, PublicKey, SshSig};

/// Holds the armoured signature `text` of `message` against the trusted `signers`.
pub(super) fn check(
    signers: &[Signer],
    text: &str,
    message: &[u8],
    now: Moment,
) -> Result<Signed, Refusal> {
    let signature = SshSig::from_pem(text.trim_end()).map_err(|e| {
        Refusal::new(
            format!("an OpenSSH signature that cannot be read ({e})"),
            "it may be cut short",
        )
    })?;
    let data = signature.public_key();
    let key = data.fingerprint(HashAlg::Sha256).to_string();
    if !is_supported(data) {
        return Err(Refusal::new(
            format!(
                "one by a key of the kind {}, which this program cannot check",
                data.algorithm()
            ),
            "`ssh-keygen -Y verify` may; the kinds known here are Ed25519, ECDSA P-256, both on security keys, and RSA",
        ));
    }
    if signature.namespace() != NAMESPACE {
        return Err(Refusal::new(
            format!("one of the namespace `{}`", signature.namespace().escape_debug()),
            "it was made for another purpose; bundles are signed with `ssh-keygen -Y sign -n reenact`",
        ));
    }
    // The bytes first: who signed matters only if these very bytes were signed.
    if PublicKey::from(data.clone()).verify(NAMESPACE, message, &signature).is_err() {
        return Err(Refusal::new(
            format!("one that does not fit this bundle, by the key {key}"),
            "the bundle was changed after it was signed, or the signature is of another bundle",
        ));
    }
    let known: Vec<&Signer> = signers.iter().filter(|signer| signer.owns(data)).collect();
    if known.is_empty() {
        return Err(Refusal::new(
            format!("one by the unknown key {key}"),
            "it fits the bundle, but none of the keys you trust made it",
        ));
    }
    let named: Vec<&Signer> = known.into_iter().filter(|s| s.limits.may_sign(NAMESPACE)).collect();
    let Some(first) = named.first() else {
        return Err(Refusal::new(
            format!("one by the key {key}, which is not trusted for the namespace `{NAMESPACE}`"),
            "add the namespace to the key's `namespaces=` if you trust it for bundles",
        ));
    };
    match named.iter().find(|signer| signer.limits.is_valid(now)) {
        Some(signer) => Ok(Signed { by: signer.principals.clone(), key }),
        None => Err(Refusal::new(
            format!(
                "one by {} with the key {key}, which is trusted {} and not on {}",
                first.principals,
                period(&first.limits),
                now.date()
            ),
            "",
        )),
    }
}

/// Why the armoured text is no signature; `None` where it is one.
pub(super) fn problem(text: &str) -> Option<String> {
    SshSig::from_pem(text.trim_end()).err().map(|e| format!("one that cannot be read ({e})"))
}

fn period(limits: &Limits) -> String {
    let from = limits.valid_after.map(|moment| format!("from {}", moment.date()));
    let until = limits.valid_before.map(|moment| format!("before {}", moment.date()));
    from.into_iter().chain(until).collect::<Vec<_>>().join(" and ")
}

fn is_supported(key: &KeyData) -> bool {
    matches!(
        key.algorithm(),
        Algorithm::Ed25519
            | Algorithm::SkEd25519
            | Algorithm::SkEcdsaSha2NistP256
            | Algorithm::Rsa { .. }
            | Algorithm::Ecdsa { curve: EcdsaCurve::NistP256 }
    )
}
