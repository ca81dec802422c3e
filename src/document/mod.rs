//! Documents that people write (manifests, worlds, robots, maps), read with faults that say where.
//!
//! The only door to the YAML crate and to the crate that draws source excerpts.

mod diagnostic;
#[cfg(test)]
pub(crate) mod mutation;
pub mod xml;

pub use diagnostic::{Diagnostic, Severity, Source, suggestion};
