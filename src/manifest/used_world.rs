//! A world as a condition uses it.

use crate::digest::MeaningDigest;
use crate::world::World;
use serde_json::Value;
use std::sync::Arc;

/// A world as a condition uses it.
#[derive(Clone)]
pub(super) struct UsedWorld {
    pub(super) world: Arc<World>,
    pub(super) meaning: MeaningDigest,
    /// File and layers as written, or family and seed.
    pub(super) described: Value,
}
