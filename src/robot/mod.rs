//! The body as described (footprint, drive, sensors), and the messages between body and mind.
//!
//! A mind (mapping, navigation, strategies) sees [`Scan`], [`Odometry`], [`Detection`]s and [`CompassReading`]s and answers
//! with [`Twist`]; nothing else crosses.

mod as_urdf;
mod beams;
pub mod description;
mod files;
#[cfg(test)]
mod fixture;
pub mod given;
mod message;
mod sdf;
pub mod urdf;
mod xacro;

pub use beams::BeamDirections;
pub use files::{FilePath, Files, NoFiles, Rooted, Unfound};
pub use message::{CompassReading, Detection, Odometry, Scan, Twist};

use crate::digest::{MeaningDigest, Sha256Digest};
use crate::geometry::{Outline, Point, Pose};
use crate::json;
use crate::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A wheeled robot as its description has it, reduced to what matters in the plane.
///
/// ```
/// use reenact::document::Source;
/// use reenact::robot::urdf;
///
/// let text = std::fs::read_to_string("robots/kobuki.urdf").unwrap();
/// let (robot, warnings) = urdf::read(&Source::new("kobuki.urdf", text)).unwrap();
/// assert_eq!((robot.name.as_str(), warnings.len()), ("kobuki", 0));
/// assert!(robot.lidar.is_some() && robot.circumscribed_radius() < 0.2);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Robot {
    /// Name in the description.
    pub name: String,
    /// Outline of the body seen from above, in the base frame (m); convex.
    pub footprint: Outline,
    /// Lowest and highest point of the body above ground (m): the heights of the world that it can touch.
    pub body_z: [f64; 2],
    /// Mass (kg), the sum over all links.
    pub mass: f64,
    /// How it drives.
    pub drive: Drive,
    /// The range scanner, if it has one.
    pub lidar: Option<Lidar>,
    /// The logical camera, if it has one. Left out of the meaning where absent, so that robots without one keep theirs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<LogicalCamera>,
    /// The compass, if it has one; as with the camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compass: Option<Compass>,
}

impl Robot {
    /// Returns the digest of the description's meaning, whatever the file looked like.
    pub fn meaning(&self) -> MeaningDigest {
        MeaningDigest(Sha256Digest::of(json::canonical_of(self)))
    }

    /// Returns the radius (m) of the smallest disc around the base frame's origin that holds the footprint.
    pub fn circumscribed_radius(&self) -> f64 {
        match &self.footprint {
            Outline::Circle { center, radius } => center.norm() + radius,
            Outline::Polygon(corners) => corners.iter().map(|c| c.norm()).fold(0.0, f64::max),
        }
    }
}

/// Wheels and their limits.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Drive {
    /// The plugin whose geometry this is.
    pub kind: DriveKind,
    /// Distance between left and right wheels (m).
    pub wheel_separation: f64,
    /// Wheel diameter (m).
    pub wheel_diameter: f64,
    /// Highest linear speed (m/s), where the description limits it.
    pub max_linear: Option<f64>,
    /// Highest angular speed (rad/s), where the description limits it.
    pub max_angular: Option<f64>,
}

/// The two drives of the studies' robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DriveKind {
    /// Two driven wheels and casters.
    Differential,
    /// Wheels of each side turn together and skid in turns.
    SkidSteer,
}

/// A planar range scanner. Angles in radians, counter-clockwise from its own x axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Lidar {
    /// Name of the sensor in the description.
    pub name: String,
    /// Its pose in the base frame (m, rad).
    pub mount: Pose,
    /// Height of the scan plane above ground (m).
    pub height: f64,
    /// Number of beams, at least 2; the first looks along `min_angle`, the last along `max_angle`.
    pub beams: u32,
    /// Direction of the first beam (rad).
    pub min_angle: f64,
    /// Direction of the last beam (rad), above `min_angle`, less than a full turn away.
    pub max_angle: f64,
    /// Shortest range reported (m).
    pub min_range: f64,
    /// Longest range reported (m); nothing within it reads as infinity.
    pub max_range: f64,
    /// Scans per second (Hz).
    pub rate_hz: f64,
    /// Standard deviation of the Gaussian range noise (m).
    pub noise_sd: f64,
}

impl Lidar {
    /// Returns the angle between neighbouring beams (rad).
    pub fn increment(&self) -> f64 {
        (self.max_angle - self.min_angle) / f64::from(self.beams - 1)
    }

    /// Returns a scanner that looks round by `angle` (rad, above 0), about the same middle, its beams as dense; a full turn
    /// begins behind.
    #[must_use]
    pub fn looking_round(&self, angle: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "thousands at most"
        )]
        let beams_over = |angle: f64| (angle / self.increment()).ceil() as u32;
        if angle >= 2.0 * PI {
            let beams = beams_over(2.0 * PI);
            let step = 2.0 * PI / f64::from(beams);
            return Self { beams, min_angle: -PI, max_angle: PI - step, ..self.clone() };
        }
        let middle = f64::midpoint(self.min_angle, self.max_angle);
        let (min_angle, max_angle) = (middle - angle / 2.0, middle + angle / 2.0);
        Self { beams: beams_over(angle).max(1) + 1, min_angle, max_angle, ..self.clone() }
    }
}

/// A camera that reports tags instead of an image: all those within a cone of the plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LogicalCamera {
    /// Name of the sensor in the description.
    pub name: String,
    /// Its pose in the base frame (m, rad).
    pub mount: Pose,
    /// Shortest distance at which it sees a tag (m), 0 or more.
    pub near: f64,
    /// Longest distance (m), above `near`.
    pub far: f64,
    /// Full angle of the cone (rad), above 0, at most a full turn.
    pub horizontal_fov: f64,
    /// Images per second (Hz).
    pub rate_hz: f64,
}

impl LogicalCamera {
    /// Returns whether a tag at `point` (base frame, m) lies within the cone.
    pub fn covers(&self, point: Point) -> bool {
        let seen = self.mount.inverse_transform(point);
        let distance = seen.norm();
        let bearing = math::atan2(seen.y, seen.x);
        (self.near..=self.far).contains(&distance) && bearing.abs() <= self.horizontal_fov / 2.0
    }
}

/// A sensor of the base's heading. Its errors are the study's, not the description's.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Compass {
    /// Name of the sensor in the description.
    pub name: String,
    /// Readings per second (Hz).
    pub rate_hz: f64,
}
