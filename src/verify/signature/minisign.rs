//! Signatures of minisign, of both its modes (the file itself, or its BLAKE2b hash).

use super::{Refusal, Signable, Signed};
use crate::document::{Diagnostic, Source};
use base64ct::{Base64, Encoding as _};
use minisign_verify::{Error, PublicKey, Signature};
use std::sync::Arc;

/// A trusted public key.
#[derive(Debug, Clone)]
pub(super) struct Key {
    public: PublicKey,
    id: String,
    /// The file it was read from: minisign's keys name nobody.
    file: Arc<str>,
}

/// Returns whether `text` is a public key rather than a list of OpenSSH's: the file that `minisign -G` writes, or the
/// key alone.
pub(super) fn is_public_key(text: &str) -> bool {
    let line = text.trim();
    text.starts_with("untrusted comment:") || (line.starts_with("RW") && !line.contains(' '))
}

/// Says why the text is no signature; `None` where it is one.
pub(super) fn problem(text: &str) -> Option<String> {
    if text.lines().count() > 4 {
        return Some("more than the four lines of one".to_owned());
    }
    Signature::decode(text).err().map(|e| format!("one that cannot be read ({e})"))
}

impl Key {
    /// Reads a public key file, or the key alone.
    pub(super) fn read(source: &Source) -> Result<Self, Vec<Diagnostic>> {
        let lines = source.text.lines().enumerate();
        let (number, written) =
            lines.filter(|(_, line)| !line.trim().is_empty()).last().unwrap_or_default();
        // What is written there is not shown: it may be a secret.
        let fault = || {
            let message = format!(
                "`{}`: expected a minisign public key, 56 characters beginning with `RW`, found {} characters that are none \
                 on line {}",
                source.name,
                written.trim().chars().count(),
                number + 1
            );
            let help = "give the public key (minisign.pub), not the secret key and not a signature";
            vec![Diagnostic::placeless(message).help(help)]
        };
        let public = PublicKey::from_base64(written.trim()).map_err(|_| fault())?;
        let id = id(written.trim()).ok_or_else(fault)?;
        Ok(Self { public, id, file: source.name.clone() })
    }

    /// Holds the signature `text` of `message` against this key.
    pub(super) fn check(
        &self,
        text: &str,
        message: &[u8],
        of: Signable,
    ) -> Result<Signed, Refusal> {
        let signature = Signature::decode(text).map_err(|_| unreadable())?;
        match self.public.verify(message, &signature, true) {
            Ok(()) => {
                Ok(Signed { by: format!("the owner of `{}`", self.file), key: self.id.clone() })
            }
            Err(Error::UnexpectedKeyId) => {
                let other = text.lines().nth(1).and_then(id).ok_or_else(unreadable)?;
                let hint = match of {
                    Signable::Bundle => {
                        "you trust another key; whether the signature fits the bundle cannot be told without its own"
                    }
                    Signable::Attestation => {
                        "you trust another key; whether the signature fits the attestation cannot be told without its own"
                    }
                };
                let refusal = Refusal::new(format!("one by the unknown key {other}"), hint);
                Err(Refusal { stranger: Some(other), ..refusal })
            }
            Err(_) => Err(Refusal::new(
                format!("one that does not fit this {}, by the key {}", of.name(), self.id),
                of.unfit(),
            )),
        }
    }
}

/// Returns the id of the key that made the signature, by what its `text` says.
pub(super) fn key_of(text: &str) -> Result<String, Refusal> {
    Signature::decode(text).map_err(|_| unreadable())?;
    text.lines().nth(1).and_then(id).ok_or_else(unreadable)
}

fn unreadable() -> Refusal {
    let found = "a minisign signature that cannot be read";
    Refusal::new(found, "it must have four lines; it may be cut short")
}

/// Reads a key's id as minisign prints it: bytes 2 to 9 of what is encoded, little-endian, in hex.
fn id(encoded: &str) -> Option<String> {
    let bytes = Base64::decode_vec(encoded).ok()?;
    let id: [u8; 8] = bytes.get(2..10)?.try_into().ok()?;
    Some(format!("{:016X}", u64::from_le_bytes(id)))
}
