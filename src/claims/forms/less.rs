//! `less`: one cell or pool is lower than another, or than several one by one (`each`), repeated over `for-each`.
//!
//! ```yaml
//! id: P1
//! says: >-
//!   The use of the floor plan ... allows to explore the environment travelling a significantly shorter
//!   distance
//! paper-table: supports
//! expect:
//!   less:
//!     metric: [distance-m-at-70, distance-m-at-80]
//!     where: {prior: floor-plan}
//!     than: {where: {prior: none}}
//!     for-each: {furnished: [true, false]}
//!     test: anova
//!     sides: two
//!     at-least: 3
//!     censored: reached-only
//! ```

use super::contrast::{Contrast, Directed};
use crate::claims::terms::Side;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `less`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Less(pub Contrast);

impl Directed for Less {
    const SIDE: Side = Side::Less;

    fn contrast(&self) -> &Contrast {
        &self.0
    }
}
