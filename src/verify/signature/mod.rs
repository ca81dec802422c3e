//! Who vouches for a bundle: detached signatures of `tagmanifest-sha256.txt`, by OpenSSH keys or minisign.
//!
//! That file lists the digests of the bag's tag files, and through `manifest-sha256.txt` those of the whole payload, so a
//! signature of it together with level 1 covers every byte. It is checked before any text of the bundle is read, and only
//! public keys are ever read here.

mod allowed_signers;
mod minisign;
mod ssh;

#[cfg(test)]
mod tests;

use crate::bundle::{Archive, Fault, Form, Moment, Tree, format};
use crate::document::{Diagnostic, Source, secret};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The namespace of `ssh-keygen -Y sign -n`, so that a signature made for another purpose vouches for no bundle.
pub const NAMESPACE: &str = "reenact";

/// The keys whose owners a reviewer trusts.
#[derive(Debug, Clone)]
pub struct Trust {
    name: Arc<str>,
    keys: Keys,
}

#[derive(Debug, Clone)]
enum Keys {
    Ssh(Vec<allowed_signers::Signer>),
    Minisign(minisign::Key),
}

impl Trust {
    /// Reads an OpenSSH `allowed_signers` file (ssh-keygen(1), ALLOWED SIGNERS) or a minisign public key file.
    ///
    /// # Errors
    /// Every line that is not understood.
    pub fn read(source: &Source) -> Result<Self, Vec<Diagnostic>> {
        if let Some(kind) = secret(&source.text) {
            return Err(vec![
                Diagnostic::placeless(format!("`{}`: expected public keys, found {kind}", source.name))
                    .help(format!(
                        "give the public key, which lies beside it (`{}.pub`), in an `allowed_signers` file; nothing of the \
                         private key was printed or kept",
                        source.name
                    )),
            ]);
        }
        let keys = if minisign::is_public_key(&source.text) {
            Keys::Minisign(minisign::Key::read(source)?)
        } else {
            Keys::Ssh(allowed_signers::read(source)?)
        };
        Ok(Self { name: source.name.clone(), keys })
    }

    /// Returns the name of the file that says whom to trust.
    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

/// What a signature is of, in the words of refusals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Signable {
    Bundle,
    Attestation,
}

impl Signable {
    fn name(self) -> &'static str {
        match self {
            Self::Bundle => "bundle",
            Self::Attestation => "attestation",
        }
    }

    /// Says what a signature that does not fit may be.
    fn unfit(self) -> &'static str {
        match self {
            Self::Bundle => {
                "the bundle was changed after it was signed, or the signature is of another bundle"
            }
            Self::Attestation => {
                "the attestation was changed after it was signed, or the signature is of something else"
            }
        }
    }

    /// Says what a signature by a key that nobody here knows is worth.
    fn strange(self) -> &'static str {
        match self {
            Self::Bundle => "it fits the bundle, but none of the keys you trust made it",
            Self::Attestation => "it fits the attestation, but none of the keys you trust made it",
        }
    }

    /// Says what a signature of another namespace lacks.
    fn purpose(self) -> &'static str {
        match self {
            Self::Bundle => {
                "it was made for another purpose; bundles are signed with `ssh-keygen -Y sign -n reenact`"
            }
            Self::Attestation => {
                "it was made for another purpose; attestations are signed with `ssh-keygen -Y sign -n reenact`"
            }
        }
    }
}

/// What a reviewer brings along to see who vouches for a bundle.
#[derive(Debug, Clone, Copy)]
pub struct Vouching<'a> {
    /// Keys that may vouch. Without them a signature is noticed and not checked.
    pub trust: Option<&'a Trust>,
    /// A signature beside the bundle, as (name, bytes); it comes before those inside.
    pub signature: Option<(&'a str, &'a [u8])>,
    /// When this is: keys may be trusted for a time only.
    pub now: Moment,
}

/// A signature that was checked and is good.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Signed {
    /// The principals that the trusted file names for the key, or the key itself where it names none.
    pub by: String,
    /// `SHA256:...` for OpenSSH keys, the key's id for minisign.
    pub key: String,
}

impl std::fmt::Display for Signed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "by {} with the key {}", self.by, self.key)
    }
}

/// What was found out about a bundle's signature.
pub(super) enum Outcome {
    /// There is none, and none was asked for.
    Unsigned,
    /// There is one that nobody asked to check.
    Unchecked(Fault),
    /// It is good.
    Good(Signed),
    /// It is not what the reviewer asked for.
    Refused(Fault),
}

/// The kinds of detached signatures, told by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Ssh,
    Minisign,
}

impl Kind {
    fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"-----BEGIN SSH SIGNATURE-----") {
            Some(Self::Ssh)
        } else if bytes.starts_with(b"untrusted comment:") {
            Some(Self::Minisign)
        } else {
            None
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Ssh => "an OpenSSH signature",
            Self::Minisign => "a minisign signature",
        }
    }

    fn path(self) -> &'static str {
        match self {
            Self::Ssh => format::SIGNATURES[0],
            Self::Minisign => format::SIGNATURES[1],
        }
    }
}

/// Returns the name under which a bag holds the signature `bytes`; `None` where they are of neither kind.
pub fn path_in_bag(bytes: &[u8]) -> Option<&'static str> {
    Kind::of(bytes).map(Kind::path)
}

/// Finds the faults of files that lie where signatures do and are none: something else would ride along unlisted.
pub(super) fn unreadable(tree: &Tree) -> Vec<Fault> {
    let mut faults = Vec::new();
    for kind in [Kind::Ssh, Kind::Minisign] {
        let Some(bytes) = tree.get(kind.path()) else { continue };
        let problem = match (Kind::of(bytes), std::str::from_utf8(bytes)) {
            (Some(found), Ok(text)) if found == kind => match kind {
                Kind::Ssh => ssh::problem(text),
                Kind::Minisign => minisign::problem(text),
            },
            (Some(found), Ok(_)) => Some(found.name().to_owned()),
            _ => Some("something else".to_owned()),
        };
        if let Some(problem) = problem {
            let fault = Fault::new(kind.path(), kind.name(), problem);
            faults.push(fault.hint(
                "no list holds the digest of a signature, so it must be one and nothing more",
            ));
        }
    }
    faults
}

/// Looks for a signature and checks it where the reviewer says whom to trust.
pub(super) fn check(archive: &Archive, vouching: &Vouching<'_>) -> Outcome {
    let inside: Vec<(&str, &[u8])> = format::SIGNATURES
        .iter()
        .filter_map(|path| Some((*path, archive.tree.get(*path)?.as_slice())))
        .collect();
    let Some(trust) = vouching.trust else {
        return match vouching.signature.or(inside.first().copied()) {
            None => Outcome::Unsigned,
            Some((path, _)) => Outcome::Unchecked(
                Fault::new(path, "keys to check the signature with", "none")
                    .hint("name those you trust with `--trust FILE`; unchecked, it says nothing"),
            ),
        };
    };
    let expected = format!("a signature by a key of `{}`", trust.name);
    let refuse = |path: &str, found: &str, hint: &str| {
        Outcome::Refused(Fault::new(path, expected.clone(), found).hint(hint))
    };
    if archive.form == Form::Crate {
        return refuse(
            format::TAG_MANIFEST,
            "a crate without its bag",
            "only the bag holds the list of digests that is signed; ask for the bundle itself",
        );
    }
    let Some(signed) = archive.tree.get(format::TAG_MANIFEST) else {
        return refuse(format::TAG_MANIFEST, "no list of digests", "nothing here could be signed");
    };
    let wanted = match trust.keys {
        Keys::Ssh(_) => Kind::Ssh,
        Keys::Minisign(_) => Kind::Minisign,
    };
    // Both kinds may lie in one bag: the one that the trusted keys can check is meant.
    let of_kind = |(_, bytes): &&(&str, &[u8])| Kind::of(bytes) == Some(wanted);
    let found =
        vouching.signature.or_else(|| inside.iter().find(of_kind).or(inside.first()).copied());
    let Some((path, bytes)) = found else {
        return refuse(
            format::TAG_MANIFEST,
            "no signature",
            "if its author signed it, give the file with `--signature FILE`",
        );
    };
    match signer(trust, bytes, signed, vouching.now, Signable::Bundle) {
        Ok(signed) => Outcome::Good(signed),
        Err(Refusal { found, hint, .. }) => refuse(path, &found, hint),
    }
}

/// Returns who of those in `trust` made the signature `bytes` of `message`.
pub(super) fn signer(
    trust: &Trust,
    bytes: &[u8],
    message: &[u8],
    now: Moment,
    of: Signable,
) -> Result<Signed, Refusal> {
    let (kind, text) = readable(bytes)?;
    match (&trust.keys, kind) {
        (Keys::Ssh(signers), Kind::Ssh) => ssh::check(signers, text, message, now, of),
        (Keys::Minisign(key), Kind::Minisign) => key.check(text, message, of),
        _ => Err(Refusal {
            stranger: key_of(bytes, message).ok(),
            ..Refusal::new(kind.name(), "keys of one kind cannot check signatures of the other")
        }),
    }
}

/// Returns the key that made the signature `bytes`, where it fits `message` as far as the signature alone can show:
/// minisign's do not hold their key.
pub(super) fn key_of(bytes: &[u8], message: &[u8]) -> Result<String, Refusal> {
    match readable(bytes)? {
        (Kind::Ssh, text) => ssh::fitting(text, message, Signable::Attestation).map(|(_, key)| key),
        (Kind::Minisign, text) => minisign::key_of(text),
    }
}

fn readable(bytes: &[u8]) -> Result<(Kind, &str), Refusal> {
    let kind = Kind::of(bytes)
        .ok_or_else(|| Refusal::new("neither an OpenSSH nor a minisign signature", ""))?;
    let text =
        std::str::from_utf8(bytes).map_err(|_| Refusal::new("bytes that are no text", ""))?;
    Ok((kind, text))
}

/// Why a signature does not vouch: what was found, and what it may mean.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) found: String,
    pub(super) hint: &'static str,
    /// The key, where all that is wrong with the signature is that nobody here knows it.
    pub(super) stranger: Option<String>,
}

impl Refusal {
    fn new(found: impl Into<String>, hint: &'static str) -> Self {
        Self { found: found.into(), hint, stranger: None }
    }
}
