//! Signatures of `ssh-keygen -Y sign` (OpenSSH, PROTOCOL.sshsig).

use super::allowed_signers::{Limits, Signer};
use super::{NAMESPACE, Refusal, Signable, Signed};
use crate::bundle::Moment;
use ssh_key::public::KeyData;
use ssh_key::{Algorithm, EcdsaCurve, HashAlg, PublicKey, SshSig};

/// Returns the key that made the armoured signature `text` of `message`, and its fingerprint; whose it is remains to be
/// seen.
pub(super) fn fitting(
    text: &str,
    message: &[u8],
    of: Signable,
) -> Result<(KeyData, String), Refusal> {
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
            of.purpose(),
        ));
    }
    // The bytes first: who signed matters only if these very bytes were signed.
    if PublicKey::from(data.clone()).verify(NAMESPACE, message, &signature).is_err() {
        return Err(Refusal::new(
            format!("one that does not fit this {}, by the key {key}", of.name()),
            of.unfit(),
        ));
    }
    Ok((data.clone(), key))
}

/// Holds the armoured signature `text` of `message` against the trusted `signers`.
pub(super) fn check(
    signers: &[Signer],
    text: &str,
    message: &[u8],
    now: Moment,
    of: Signable,
) -> Result<Signed, Refusal> {
    let (data, key) = fitting(text, message, of)?;
    let known: Vec<&Signer> = signers.iter().filter(|signer| signer.owns(&data)).collect();
    if known.is_empty() {
        let refusal = Refusal::new(format!("one by the unknown key {key}"), of.strange());
        return Err(Refusal { stranger: Some(key), ..refusal });
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

/// Says why the armoured text is no signature; `None` where it is one.
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
