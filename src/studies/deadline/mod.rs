//! The deadline study: J. L. Susa Rincon, S. Carpin, "Time-constrained exploration using toposemantic spatial models: a
//! reproducible approach", IEEE Robotics & Automation Magazine 26(3), 2019, pages 78 to 87.

#[cfg(test)]
mod building;
pub mod exploration;
pub mod intersection;
pub mod intersection_detection;
pub mod navigation;
pub mod planner;
mod rules;
pub mod schedule;
pub mod strategy;
pub mod toposemantic_map;

pub use intersection_detection::{IntersectionDetectionSystem, Perception};
pub use rules::{Rules, UnplannedSpeed};
