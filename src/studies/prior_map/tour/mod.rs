//! The rival of section 4.5: S. Osswald, M. Bennewitz, W. Burgard, C. Stachniss, "Speeding-Up Robot Exploration by
//! Exploiting Background Information", IEEE Robotics and Automation Letters 2016, as the study describes it.
//!
//! A user gives a topo-metric graph of the environment; a tour over its nodes is planned off-line, as a travelling
//! salesperson problem, and completed on-line by exploring the frontiers around each node in the tour's order.

mod document;
mod graph;
mod salesperson;
mod strategy;

pub use document::read;
pub use graph::TopoMetricMap;
pub use salesperson::{EXACT_UP_TO, open_tour};
pub use strategy::Tour;
