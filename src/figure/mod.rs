//! Pictures as deterministic SVG: no fonts, no clock, no platform arithmetic.
//!
//! Charts are pure functions of their data: [`LineChart`], [`BarChart`] and [`Scatter`] become the text of a
//! file that can be pasted into a paper. What is ink and what is paper carries a class (`ink-fill`,
//! `ink-stroke`, `paper-fill`), so that a page in the dark can turn both; everything else is literal.

mod axis;
mod bar;
pub(crate) mod canvas;
mod chart;
mod line;
mod palette;
mod plan;
mod scatter;
pub mod svg;

pub use axis::{Axis, Tick};
pub use bar::{Bar, BarChart, BarGroup};
pub use line::{LineChart, PublishedPoint, Series};
pub use palette::{INK, Marker, PAPER, Style};
pub use plan::{Plan, cell_runs};
pub use scatter::{Scatter, ScatterPoint};

#[cfg(test)]
pub(crate) mod tests;
