//! SHA-256 and one type per kind of digest, so that a trial's key can never stand where a bundle's id belongs.
//!
//! The only file that names the crates for hashes and for hex digits.

use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sha2::{Digest as _, Sha256};

/// A SHA-256 value: 32 bytes, written as 64 lower-case hex digits.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Sha256Digest(pub [u8; 32]);

impl Sha256Digest {
    /// Returns the digest of `bytes`.
    pub fn of(bytes: impl AsRef<[u8]>) -> Self {
        Self(Sha256::digest(bytes.as_ref()).into())
    }

    /// Returns the 64 lower-case hex digits.
    pub fn hex(&self) -> String {
        base16ct::lower::encode_string(&self.0)
    }

    /// Returns the first 8 hex digits, for names and tables.
    pub fn short(&self) -> String {
        base16ct::lower::encode_string(&self.0[..4])
    }

    /// Reads 64 hex digits of either case, as other tools' manifests may carry them; `None` for anything else.
    pub fn from_hex(text: &str) -> Option<Self> {
        if text.len() != 64 {
            return None;
        }
        let mut bytes = [0_u8; 32];
        base16ct::mixed::decode(text, &mut bytes).ok()?;
        Some(Self(bytes))
    }
}

impl std::fmt::Display for Sha256Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.hex())
    }
}

impl std::fmt::Debug for Sha256Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.short())
    }
}

impl Serialize for Sha256Digest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.hex())
    }
}

impl<'de> Deserialize<'de> for Sha256Digest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // By a visitor, so that a reader that knows positions can point at the refused text.
        deserializer.deserialize_str(HexVisitor)
    }
}

struct HexVisitor;

impl Visitor<'_> for HexVisitor {
    type Value = Sha256Digest;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("64 hex digits")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Sha256Digest, E> {
        Sha256Digest::from_hex(text).ok_or_else(|| E::custom("expected 64 hex digits"))
    }
}

/// A SHA-256 fed piece by piece; pieces are concatenated, so callers put their own lengths or separators in.
///
/// ```
/// use reenact::digest::{Hasher, Sha256Digest};
///
/// let mut hasher = Hasher::new();
/// hasher.update("ab").update("c");
/// assert_eq!(hasher.digest(), Sha256Digest::of("abc"));
/// assert_eq!(hasher.digest().short(), "ba7816bf");
/// ```
#[derive(Clone, Default)]
pub struct Hasher(Sha256);

impl Hasher {
    /// Creates an empty hash.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends `bytes`.
    pub fn update(&mut self, bytes: impl AsRef<[u8]>) -> &mut Self {
        self.0.update(bytes.as_ref());
        self
    }

    /// Returns the digest of everything fed so far.
    pub fn digest(&self) -> Sha256Digest {
        Sha256Digest(self.0.clone().finalize().into())
    }
}

macro_rules! digest_type {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub Sha256Digest);

        impl $name {
            /// Returns the 64 lower-case hex digits.
            pub fn hex(&self) -> String {
                self.0.hex()
            }

            /// Returns the first 8 hex digits.
            pub fn short(&self) -> String {
                self.0.short()
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

digest_type!(
    /// Digest of an input file's bytes.
    FileDigest
);
digest_type!(
    /// Digest of the *parsed meaning* of a robot, world or prior map: comments, order and paths do not count.
    MeaningDigest
);
digest_type!(
    /// Identity of a trial: digest of its canonical content and the engine version.
    TrialKey
);
digest_type!(
    /// Digest of the question: the resolved study and its inputs.
    StudyDigest
);
digest_type!(
    /// Digest of the answer: the result half of a bundle, the same for everyone.
    ResultsDigest
);
digest_type!(
    /// Identity of one sealed bundle: digest of its `tagmanifest-sha256.txt`.
    BundleId
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers_of_fips_180_4() {
        assert_eq!(
            Sha256Digest::of(b"abc").hex(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
        assert_eq!(
            Hasher::new().update("a").update("bc").digest(),
            Sha256Digest::of("abc"),
            "pieces are concatenated"
        );
    }

    #[test]
    fn hex_round_trips_and_refuses_other_text() {
        let digest = Sha256Digest::of("x");
        assert_eq!(Sha256Digest::from_hex(&digest.hex()), Some(digest));
        assert_eq!(Sha256Digest::from_hex(&digest.hex().to_uppercase()), Some(digest));
        let every = Sha256Digest(std::array::from_fn(|i| u8::try_from(i * 8 + i % 8).unwrap()));
        assert_eq!(every.hex(), every.0.map(|byte| format!("{byte:02x}")).concat());
        assert_eq!(Sha256Digest::from_hex(&every.hex()), Some(every));
        assert_eq!(every.short(), every.hex()[..8]);
        let wrong = ["/", ":", "@", "G", "`", "g", " "].map(|digit| digit.repeat(64));
        for bad in
            wrong.iter().map(String::as_str).chain(["", "ab", &"é".repeat(32), &"a".repeat(65)])
        {
            assert_eq!(Sha256Digest::from_hex(bad), None);
        }
    }
}
