//! A file that was read: where its path was written, what it is, what it holds.

use crate::digest::FileDigest;
use std::sync::Arc;

/// Where a path was written, which says what it is relative to.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum WrittenIn {
    /// In the manifest (or a file that it names): relative to the manifest.
    Manifest,
    /// On the command line: relative to where the command was given.
    CommandLine,
    /// Nowhere: made from the calibration manifest.
    Calibration,
    /// Nowhere: made from the manifest of an inference whose draws are run.
    Inference,
    /// Nowhere: made by an exploration before the experiment's own.
    PreviousMap,
}

/// What an input is, as whoever read it says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputKind {
    /// Parameters that several manifests share.
    Settings,
    /// A robot, or a file that one names.
    Robot,
    /// A world, or a mesh of one.
    World,
    /// A map or a graph that is prior knowledge.
    Prior,
    /// Numbers that the paper prints, as a tidy CSV.
    PublishedNumbers,
    /// What the claims' verdicts were at other values of the assumptions, as `reenact vary` writes it.
    Robustness,
    /// What they were at draws of all assumptions together, as `reenact vary --joint` writes it.
    Multiverse,
    /// The manifest of a calibration, or what it reads, where that has not said what it is.
    Calibration,
    /// The passages of a calibration, one row a trial.
    Passages,
    /// What follows from the passages: times and failures of every maneuver.
    Maneuvers,
    /// The manifest of an inference, or what it reads, where that has not said what it is.
    Inference,
    /// The proposals of an inference: the record of every trial, a line each.
    Proposals,
    /// What follows from the proposals: the draws that are run, one row each.
    Draws,
}

/// One file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Its path, as it was asked for.
    pub as_written: String,
    /// What that path is relative to.
    pub written_in: WrittenIn,
    /// What it is.
    pub kind: InputKind,
    /// Its name in a bundle: flat, of `[A-Za-z0-9._-]`, unique even where case does not count.
    pub name: String,
    /// What it holds.
    pub bytes: Arc<[u8]>,
    /// Digest of what it holds.
    pub digest: FileDigest,
    /// Its licence, where the manifest states one.
    pub license: Option<String>,
}

/// What a manifest is to the one that names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nested {
    /// Its calibration.
    Calibration,
    /// The inference whose draws it runs.
    Inference,
}

impl Nested {
    /// Returns what its file is as an input.
    pub(super) fn kind(self) -> InputKind {
        match self {
            Self::Calibration => InputKind::Calibration,
            Self::Inference => InputKind::Inference,
        }
    }
}
