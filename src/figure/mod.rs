//! Pictures as deterministic SVG: no fonts, no clock, no platform arithmetic.

pub mod svg;
