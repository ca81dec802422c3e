//! Building an occupancy map from scans, in GMapping's manner (Grisetti, Stachniss, Burgard 2007).
//!
//! [`Mapper`] is the entry point. With one particle, no motion noise and no matching this is mapping with known poses
//! at
//! keyframes, which is what the prior-knowledge study's simulated runs really did; with other numbers it is the full
//! Rao-Blackwellised particle filter. The map's frame is the odometry frame at the beginning: the robot's first pose.

mod beam_ends;
mod beams;
mod hit_map;
mod keyframe;
mod map;
mod mapper;
mod motion_model;
mod particle_filter;
mod resampling;
#[cfg(test)]
mod room;
mod scan_matcher;
mod tile;
mod trajectories;
mod window;

pub use keyframe::KeyframeRule;
pub use map::{Change, NoReturn, OccupancyMap, ScanRule};
pub use mapper::{Mapper, Showing};
pub use motion_model::MotionNoise;
pub use particle_filter::FilterRule;
pub use scan_matcher::MatchRule;
