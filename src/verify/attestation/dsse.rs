//! DSSE v1.0.2, the envelope: a payload, its type, and signatures of both.

use super::LONGEST;
use super::statement::Statement;
use crate::bundle::Fault;
use crate::json;
use crate::verify::signature;
use base64ct::{Base64, Base64Url, Encoding as _};
use serde::{Deserialize, Serialize};

/// What the payload is.
const PAYLOAD_TYPE: &str = "application/vnd.in-toto+json";

/// The most signatures that are looked at.
const MOST_SIGNATURES: usize = 16;

/// An envelope whose payload is a Statement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Envelope {
    pub(super) payload: Vec<u8>,
    pub(super) signatures: Vec<Signature>,
}

/// A signature: the file that `ssh-keygen -Y sign` or minisign writes, byte for byte.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Signature {
    /// A hint at the key, in which nobody trusts.
    keyid: Option<String>,
    pub(super) file: Vec<u8>,
}

/// As JSON has it. What DSSE does not name is ignored, as it asks; what it names stands there once.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Written {
    payload: String,
    payload_type: String,
    signatures: Vec<WrittenSignature>,
}

#[derive(Serialize, Deserialize)]
struct WrittenSignature {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    keyid: Option<String>,
    sig: String,
}

impl Envelope {
    /// Creates an envelope of `statement`, signed by nobody yet.
    pub(super) fn unsigned(statement: &Statement) -> Self {
        Self { payload: json::canonical_of(statement).into_bytes(), signatures: Vec::new() }
    }

    /// Reads the envelope in the file called `name`. Nothing in its payload is looked at.
    ///
    /// # Errors
    /// Where it is none, or holds something else.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, Fault> {
        let fault = |expected: &str, found: String| Fault::new(name, expected, found);
        if bytes.len() as u64 > LONGEST {
            let expected = format!("an attestation of at most {LONGEST} bytes");
            return Err(fault(&expected, "more".to_owned()));
        }
        let written: Written = json::read(bytes).map_err(|problem| {
            fault("a DSSE envelope, which `reenact verify --attest` writes", problem.to_string())
        })?;
        if written.payload_type != PAYLOAD_TYPE {
            let expected = format!("the payload type `{PAYLOAD_TYPE}`");
            return Err(fault(&expected, format!("`{}`", written.payload_type)));
        }
        let decoded = |what: &str, text: &str| {
            // DSSE allows either alphabet.
            Base64::decode_vec(text)
                .or_else(|_| Base64Url::decode_vec(text))
                .map_err(|_| fault(&format!("{what} in base64"), "other text".to_owned()))
        };
        if written.signatures.len() > MOST_SIGNATURES {
            let expected = format!("at most {MOST_SIGNATURES} signatures");
            return Err(fault(&expected, written.signatures.len().to_string()));
        }
        let signatures = written.signatures.into_iter().map(|signature| {
            let file = decoded("a signature", &signature.sig)?;
            Ok(Signature { keyid: signature.keyid, file })
        });
        Ok(Self {
            payload: decoded("a payload", &written.payload)?,
            signatures: signatures.collect::<Result<_, Fault>>()?,
        })
    }

    /// Writes the envelope as one line of canonical JSON with a final line feed.
    pub fn to_json(&self) -> String {
        let signatures = self.signatures.iter().map(|signature| WrittenSignature {
            keyid: signature.keyid.clone(),
            sig: Base64::encode_string(&signature.file),
        });
        let written = Written {
            payload: Base64::encode_string(&self.payload),
            payload_type: PAYLOAD_TYPE.to_owned(),
            signatures: signatures.collect(),
        };
        json::canonical_of(&written) + "\n"
    }

    /// Returns the bytes that are signed: DSSE's pre-authentication encoding of type and payload.
    pub fn to_sign(&self) -> Vec<u8> {
        let (kind, payload) = (PAYLOAD_TYPE, &self.payload);
        let head = format!("DSSEv1 {} {kind} {} ", kind.len(), payload.len());
        [head.as_bytes(), payload].concat()
    }

    /// Puts the signature `bytes`, in the file called `name`, into the envelope, in place of an earlier one by the same key,
    /// and gives the key.
    ///
    /// # Errors
    /// Where it is no signature of this envelope.
    pub fn put(&mut self, name: &str, bytes: &[u8]) -> Result<String, Fault> {
        let key = signature::key_of(bytes, &self.to_sign()).map_err(|refusal| {
            Fault::new(name, "a signature of this attestation", refusal.found).hint(refusal.hint)
        })?;
        self.signatures.retain(|known| known.keyid.as_ref() != Some(&key));
        if self.signatures.len() >= MOST_SIGNATURES {
            let expected = format!("at most {MOST_SIGNATURES} signatures in an attestation");
            return Err(Fault::new(name, expected, "one more"));
        }
        self.signatures.push(Signature { keyid: Some(key.clone()), file: bytes.to_vec() });
        Ok(key)
    }
}
