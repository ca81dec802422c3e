//! The library of one manifest: every file read once, held against its pin, and what was made of it kept.
//!
//! [`Library::files`] asks [`Inputs`] for bytes and seals what it gave, [`Library::read`] holds them against the pins, and
//! the shelves keep what parsing, drawing or simulating made, by everything that it was made from.

mod files;
mod inputs;
mod paths;
mod pins;

pub use inputs::{CalibrationTrials, InputError, Inputs, ProposalTrials};
pub(super) use paths::{joined, normalised, relative_to};

use super::faults::Faults;
use super::input::{InputKind, WrittenIn};
use super::pinned::PinnedDoc;
use crate::digest::{MeaningDigest, Sha256Digest};
use crate::grid::OccupancyGrid;
use crate::robot::Robot;
use crate::studies::prior_map::SharedReference;
use crate::studies::{Expectations, Graph};
use crate::world::World;
use files::InputFiles;
use pins::Pins;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A thing that was read and what it means; `None` where it could not be, which has been told.
pub(super) type Known<T> = Option<(Arc<T>, MeaningDigest)>;

/// What was made once, by what it was made from.
pub(super) type Made<T> = BTreeMap<String, T>;

/// Files, pins, and what was made of the files.
pub(super) struct Library<'a> {
    pub(super) files: InputFiles<'a>,
    pins: Pins,
    pub(super) robots: Made<Known<Robot>>,
    pub(super) worlds: Made<Known<World>>,
    /// Prior maps.
    pub(super) grids: Made<Known<OccupancyGrid>>,
    /// Graphs of worlds.
    pub(super) graphs: Made<Graph>,
    /// What coverage is measured against.
    pub(super) references: Made<SharedReference>,
    /// What planners expect; `None` where it could not be had, which has been told.
    pub(super) calibrations: Made<Option<Expectations>>,
}

/// Why a file could not be had as it should be.
pub(super) enum Unread {
    /// There are no bytes.
    Missing {
        /// Why.
        reason: InputError,
        /// Where it is published, where it is pinned.
        published: Option<String>,
    },
    /// It is not the file that is pinned.
    Unpinned {
        /// What it holds all the same.
        bytes: Arc<[u8]>,
        /// Both digests, in words.
        digests: String,
        /// Where the right one is published.
        published: String,
    },
}

impl<'a> Library<'a> {
    /// Creates a library of nothing yet, whose files `inputs` hands over.
    pub(super) fn new(inputs: &'a dyn Inputs) -> Self {
        Self {
            files: InputFiles::new(inputs),
            pins: Pins::default(),
            robots: Made::new(),
            worlds: Made::new(),
            grids: Made::new(),
            graphs: Made::new(),
            references: Made::new(),
            calibrations: Made::new(),
        }
    }

    /// Takes the pins of `docs`, the value of `/pinned`; faults where they cannot be read.
    pub(super) fn pin(&mut self, docs: &[PinnedDoc], faults: &mut Faults<'_>) {
        self.pins = Pins::read(docs, faults);
    }

    /// Returns the bytes of `path`, which is [`normalised`]: a file that is a `kind`.
    ///
    /// # Errors
    /// Where there are none, or others than are pinned.
    pub(super) fn read(
        &mut self,
        path: &str,
        written_in: WrittenIn,
        kind: InputKind,
    ) -> Result<Arc<[u8]>, Unread> {
        // On the command line somebody names a file of their own.
        let pin = self.pins.of(path).filter(|_| written_in == WrittenIn::Manifest);
        let bytes = self.files.read(path, written_in, kind).map_err(|reason| Unread::Missing {
            reason,
            published: pin.map(pins::Pin::published),
        })?;
        let Some(pin) = pin else { return Ok(bytes) };
        let found = Sha256Digest::of(&bytes);
        if pin.digest == found {
            return Ok(bytes);
        }
        let digests = format!("expected SHA-256 {}, found {found}", pin.digest);
        Err(Unread::Unpinned { bytes, digests, published: pin.published() })
    }

    /// Returns the paths that are pinned and that nobody asked for, each with where its pin stands.
    pub(super) fn unused_pins(&self) -> Vec<(String, String)> {
        self.pins.unused(&self.files.paths())
    }
}
