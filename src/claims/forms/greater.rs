//! `greater`: one cell or pool is higher than another, or than several one by one (`each`), repeated over `for-each`.
//!
//! ```yaml
//! id: D1
//! says: >-
//!   the random strategy is the most effective when starting from location A, except when the shortest
//!   deadline is enforced
//! paper-table: supports
//! expect:
//!   greater:
//!     metric: success
//!     where: {start: A, strategy: random}
//!     than: {where: {start: A, strategy: [frontier, normalized-frontier]}, each: [strategy]}
//!     for-each: {deadline-s: [680, 477, 272]}
//!     test: fisher-exact
//!     alpha: 0.01
//! ```

use super::contrast::{Contrast, Directed};
use crate::claims::terms::Side;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `greater`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Greater(pub Contrast);

impl Directed for Greater {
    const SIDE: Side = Side::Greater;

    fn contrast(&self) -> &Contrast {
        &self.0
    }
}
