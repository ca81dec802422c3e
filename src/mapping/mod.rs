//! Building an occupancy map from scans, in GMapping's manner (Grisetti, Stachniss, Burgard 2007).
//!
//! With one particle and trusted odometry this is mapping with known poses at keyframes, which is what the
//! prior-knowledge study's simulated runs really did. The map's frame is the odometry frame: the pose the
//! robot began in.

mod keyframe;
mod map;

pub use keyframe::{KeyframeMapper, KeyframeRule};
pub use map::{Change, OccupancyMap, ScanRule};
