//! The sealed study: one zip that holds what was asked, what came out, and the proof that nothing changed since.
//!
//! A bundle is a `BagIt` bag (RFC 8493) whose payload `data/` is an RO-Crate 1.1 with the Provenance Run Crate 0.5
//! profile. `docs/bundle-format.md` is the contract; this module is pure (bytes in, bytes out) and the only door
//! to the zip crate.
//!
//! [`BundleContent`] and a [`Circumstance`] are sealed into a [`Sealed`] tree; [`archive`] turns a tree into a zip
//! and back, trusting nothing; [`Bundle`] reads an opened tree by meaning.

mod account;
pub mod archive;
pub mod assemble;
pub mod bag;
pub mod capsule;
mod citation;
mod class;
mod content;
mod crate_actions;
mod crate_edition;
mod crate_entities;
mod crate_metadata;
mod crate_people;
mod data_package;
mod departure;
mod fault;
mod file;
mod finding;
pub mod format;
mod gather;
mod index;
mod limits;
mod moment;
pub mod names;
mod path;
mod preview;
mod reader;
mod readme;
mod resolved;
mod scratch;
mod told;
pub mod wall_time;
mod writer;

#[cfg(test)]
pub(crate) mod sample;

pub use account::{Account, Question, ToldClaim, ToldFigure, ToldTable};
pub use archive::{Archive, Form, Limits};
pub use capsule::Capsule;
pub use class::{Class, class_of, is_tag_file, table_in_markdown};
pub use content::{
    BundleContent, Circumstance, Person, Publication, SealedCondition, SealedInput, seal_inputs,
};
pub use crate_edition::{Edition, in_edition};
pub use departure::{Departure, shell_word};
pub use fault::{Fault, visible};
pub use file::{Content, FileRef, Files, LargeFile, LargeFiles, Lines};
pub use finding::{Found, finding};
pub use gather::{Gathered, Gathering, in_parts};
pub use limits::{Exhibited, limits, partial};
pub use moment::Moment;
pub use path::{BundlePath, in_payload};
pub use reader::{Bundle, OpenError, RecordLine, RecordLines};
pub use resolved::{ConditionEntry, InputEntry, Resolved};
pub use scratch::{Forgetful, InMemory, Scratch, Source, Spool};
pub use told::is_version;
pub use writer::{Additions, SealError, Sealed, in_bag, in_bag_info, seal, seal_with};

use crate::digest::{ResultsDigest, Sha256Digest};
use std::collections::BTreeMap;

/// Every file of a bundle that is held in memory, by its path relative to the bag's root (`bagit.txt`, `data/study.yaml`), sorted bytewise.
pub type Tree = BTreeMap<String, Vec<u8>>;

/// Returns whether `path`, relative to `data/`, belongs to the result half: what is byte-identical for everyone.
pub fn in_result_half(path: &str) -> bool {
    path == format::STUDY
        || path == format::RESOLVED
        || [format::INPUTS, format::TRIALS, format::RESULTS].iter().any(|d| path.starts_with(d))
}

/// Computes the results digest of a tree: SHA-256 over the sorted lines `<hex>  <path>` of its result half, each ended
/// by a line feed, paths relative to `data/`.
pub fn results_digest(tree: &Tree) -> ResultsDigest {
    results_digest_of(Files { tree, large: &LargeFiles::new() })
}

/// Does the same for files of which some are not in memory.
pub fn results_digest_of(files: Files<'_>) -> ResultsDigest {
    let mut lines: Vec<String> = files
        .iter()
        .filter_map(|(path, file)| Some((in_payload(path)?, file)))
        .filter(|(path, _)| in_result_half(path))
        .map(|(path, file)| format!("{}  {path}\n", file.digest()))
        .collect();
    lines.sort_unstable();
    ResultsDigest(Sha256Digest::of(lines.concat()))
}
