//! A clock that stands still: what the interior-point solver measures its own time with where it is compiled for the web.
//!
//! It takes the place of the crate of this name (`[patch.crates-io]` in `page/Cargo.toml`), which asks the browser. The solver
//! has no limit of time, so only the duration that it reports is another, and nobody reads it.

pub use std::time::Duration;
use std::ops::Sub;

/// The one instant there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Instant;

impl Instant {
    /// Returns the one instant.
    #[must_use]
    pub fn now() -> Self {
        Self
    }

    /// Returns no time at all.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        Duration::ZERO
    }

    /// Returns no time at all.
    #[must_use]
    pub fn duration_since(&self, _: Self) -> Duration {
        Duration::ZERO
    }
}

impl Sub for Instant {
    type Output = Duration;

    fn sub(self, _: Self) -> Duration {
        Duration::ZERO
    }
}
