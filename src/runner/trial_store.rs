//! The runner's requirements on a store; `crate::store` keeps it on disk.

use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::TrialRecord;
use thiserror::Error;

/// Finished records by their keys. Several threads and processes may use one at a time.
pub trait TrialStore: Sync {
    /// Returns the record of `key`; `None` where there is none, or none that is whole.
    ///
    /// # Errors
    /// Where the store cannot be read.
    fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError>;

    /// Keeps `record` for good before returning.
    ///
    /// # Errors
    /// Where it cannot be written, is no result, or another record stands under its key.
    fn put(&self, record: &TrialRecord) -> Result<(), StoreError>;
}

/// Why a store refuses.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum StoreError {
    /// One trial, two results: the engine is not deterministic, or the store is not this engine's.
    #[error(
        "trial {key}: expected the record in the store (sha256:{stored}), found another (sha256:{fresh}) {divergence}; \
         equal keys must give equal bytes, so please report it, with both records"
    )]
    Conflict {
        /// The trial.
        key: TrialKey,
        /// Digest of the record that the store holds.
        stored: Sha256Digest,
        /// Digest of the one that should be added.
        fresh: Sha256Digest,
        /// Where they diverge, in words.
        divergence: String,
    },
    /// A panic is not a result.
    #[error(
        "trial {key}: expected a result to store, found a panic ({cause}); panics are never stored"
    )]
    Panicked {
        /// The trial.
        key: TrialKey,
        /// Its message.
        cause: String,
    },
    /// The file system refuses.
    #[error(
        "trial store: {0}; free some space, allow writing, or choose another place with REENACT_STORE"
    )]
    Io(String),
}

impl StoreError {
    /// Creates the conflict between two records of one key.
    pub fn conflict(stored: &TrialRecord, fresh: &TrialRecord) -> Self {
        Self::Conflict {
            key: fresh.key,
            stored: Sha256Digest::of(stored.to_line()),
            fresh: Sha256Digest::of(fresh.to_line()),
            divergence: stored.parting(fresh),
        }
    }
}
