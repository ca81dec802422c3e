//! What body and mind tell each other, after ROS's `sensor_msgs` and `geometry_msgs`.

use crate::geometry::Pose;
use crate::units::Tick;

/// One sweep of a range scanner (`sensor_msgs/LaserScan`).
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// When it was taken; all beams at once.
    pub stamp: Tick,
    /// Where the sensor sits on the robot (m, rad).
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
    /// Direction of beam `i` in the sensor's frame (rad).
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
    /// Standing still.
    pub const STOP: Self = Self { linear: 0.0, angular: 0.0 };
}

/// Where the wheels say the robot is (`nav_msgs/Odometry`): a pose in the odometry frame, which is the frame
/// the robot began in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometry {
    /// When it was measured.
    pub stamp: Tick,
    /// Pose in the odometry frame (m, rad).
    pub pose: Pose,
    /// Velocity (m/s, rad/s).
    pub twist: Twist,
}

/// A tag that a logical camera detects (after `gazebo_msgs`' `LogicalCameraImage`): an opaque id, a colour, and where it
/// is as seen from the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Detection {
    /// Opaque id: equal ids are the same tag, and nothing else can be told from one.
    pub id: String,
    /// Colour, by name.
    pub color: String,
    /// Where it stands and faces, in the robot's base frame (m, rad).
    pub pose: Pose,
}

/// What a compass reads: the heading of the base frame's x axis, counter-clockwise from east (rad, in -pi..=pi), with the
/// sensor's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompassReading {
    /// When it was read.
    pub stamp: Tick,
    /// Heading (rad).
    pub heading: f64,
}
