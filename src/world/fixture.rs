//! A world for tests that look at something else.

use super::World;
use std::collections::BTreeMap;

impl World {
    /// Returns a world without anything in it.
    pub(crate) fn empty() -> Self {
        Self {
            name: "empty".to_owned(),
            solids: Vec::new(),
            regions: Vec::new(),
            tags: Vec::new(),
            starts: BTreeMap::new(),
            goals: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }
}
