//! The messages between body and mind, after ROS's `sensor_msgs` and `geometry_msgs`.

use crate::geometry::Pose;
use crate::units::Tick;
use std::sync::Arc;

/// One sweep of a range scanner (`sensor_msgs/LaserScan`).
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Time of the scan; all beams at once.
    pub stamp: Tick,
    /// Pose of the sensor on the robot (m, rad).
    pub mount: Pose,
    /// Direction of the first beam in the sensor's frame (rad).
    pub min_angle: f64,
    /// Angle between neighbouring beams (rad).
    pub increment: f64,
    /// Shortest range reported (m).
    pub min_range: f64,
    /// Longest range reported (m).
    pub max_range: f64,
    /// Ranges (m), first beam first; infinity where nothing was hit.
    pub ranges: Vec<f64>,
}

impl Scan {
    /// Returns the direction of beam `i` in the sensor's frame (rad).
    pub fn angle(&self, i: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "beam numbers are small")]
        let steps = i as f64;
        self.min_angle + self.increment * steps
    }
}

/// A velocity in the robot's own frame (`geometry_msgs/Twist`, planar part).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Forward speed (m/s).
    pub linear: f64,
    /// Turning speed (rad/s), counter-clockwise.
    pub angular: f64,
}

impl Twist {
    /// The twist of a robot at rest.
    pub const STOP: Self = Self { linear: 0.0, angular: 0.0 };
}

/// The robot's pose by its wheels (`nav_msgs/Odometry`): in the odometry frame, which is the frame in which the robot
/// began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometry {
    /// When it was measured.
    pub stamp: Tick,
    /// Pose in the odometry frame (m, rad).
    pub pose: Pose,
    /// Velocity (m/s, rad/s).
    pub twist: Twist,
}

/// A tag that a logical camera detects (after `gazebo_msgs`' `LogicalCameraImage`): an opaque id, a colour, and its
/// pose relative to the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Detection {
    /// Opaque id: equal ids are the same tag, and an id carries no other information.
    pub id: Arc<str>,
    /// Colour, by name.
    pub color: Arc<str>,
    /// Its pose in the robot's base frame (m, rad).
    pub pose: Pose,
}

/// A reading of a compass: the heading of the base frame's x axis, counter-clockwise from east (rad, in -pi..=pi), with
/// the sensor's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompassReading {
    /// When it was read.
    pub stamp: Tick,
    /// Heading (rad).
    pub heading: f64,
}
