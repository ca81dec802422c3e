//! Pictures as deterministic SVG: no fonts, no clock, no platform arithmetic.
//!
//! Charts are pure functions of their data: [`LineChart`], [`EstimateChart`], [`ShareChart`], [`Scatter`] and
//! [`PolicyChart`] become the text of a file that can be pasted into a paper. Ink and paper carry a class (`ink-fill`,
//! `ink-stroke`, `paper-fill`), so that a dark page can turn both; everything else is literal.

mod axis;
pub(crate) mod canvas;
mod chart;
mod data;
mod estimate;
mod line;
mod medium;
mod palette;
mod panels;
mod plan;
mod policy;
mod scatter;
mod share;
pub mod svg;

pub use axis::{Axis, Tick};
pub use estimate::{Estimate, EstimateChart};
pub use line::{LineChart, PublishedPoint, Series};
pub use medium::{Medium, for_paper};
pub use palette::{INK, Marker, PAPER, Style};
pub use panels::{Panel, PanelLine};
pub use plan::{Plan, cell_runs};
pub use policy::{PolicyChart, PolicyMove, PolicyPanel, PolicyVertex};
pub use scatter::{Scatter, ScatterPoint};
pub use share::{Look, Part, ShareChart, Shares};

#[cfg(test)]
pub(crate) mod tests;
