//! What a manifest says of a robot itself: it goes before what the description says.

use super::DriveKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a manifest says of a robot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// The range scanner.
    pub lidar: Option<LidarDoc>,
    /// The drive.
    pub drive: Option<DriveDoc>,
    /// The outline of the body.
    pub footprint: Option<FootprintDoc>,
    /// How high the body reaches above ground (m).
    pub height_m: Option<f64>,
    /// Mass (kg).
    pub mass_kg: Option<f64>,
}

/// The range scanner: which of the description's, or what it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LidarDoc {
    /// The sensor of this name.
    Name(String),
    /// What it is; what is left out is as the description has it.
    Numbers(LidarNumbers),
}

/// A range scanner in numbers. What is left out is that of the description's scanner.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct LidarNumbers {
    /// The sensor of the description whose numbers the others are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Number of beams.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 2, max = 100_000))]
    pub beams: Option<u32>,
    /// Direction of the first beam (degrees), counter-clockwise from where the scanner looks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub min_angle_deg: Option<f64>,
    /// Direction of the last beam (degrees), above the first; a full turn is one beam less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub max_angle_deg: Option<f64>,
    /// Shortest range (m), 0 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub min_range_m: Option<f64>,
    /// Longest range (m), above the shortest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_range_m: Option<f64>,
    /// Scans per second (Hz): a divisor of 3000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_hz: Option<f64>,
    /// Standard deviation of the range noise (m); 0 where neither says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub noise_sd_m: Option<f64>,
    /// Position ahead of the base frame (m); 0 where neither says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Position left of the base frame (m); 0 where neither says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
    /// Height of the scan plane above ground (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Where the scanner looks (degrees), counter-clockwise from ahead; 0 where neither says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub heading_deg: Option<f64>,
}

/// The drive. What is left out is that of the description's drive, or of its wheels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct DriveDoc {
    /// Two driven wheels, or wheels of each side that turn together and skid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<DriveKind>,
    /// Distance between left and right wheels (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wheel_separation_m: Option<f64>,
    /// Wheel diameter (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wheel_diameter_m: Option<f64>,
    /// Highest linear speed (m/s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_linear_m_s: Option<f64>,
    /// Highest turning speed (rad/s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_angular_rad_s: Option<f64>,
}

/// The outline of the body from above, in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FootprintDoc {
    /// A disc.
    Disc(DiscDoc),
    /// A rectangle.
    Rectangle(RectangleDoc),
    /// A polygon.
    Polygon(PolygonDoc),
}

/// A disc.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct DiscDoc {
    /// Its radius (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius_m: f64,
    /// Where its middle lies ahead of the base frame (m).
    #[serde(default)]
    pub x_m: f64,
    /// Where its middle lies left of the base frame (m).
    #[serde(default)]
    pub y_m: f64,
}

/// A rectangle, along and across the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct RectangleDoc {
    /// Its length along the robot (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length_m: f64,
    /// Its width across the robot (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub width_m: f64,
    /// Where its middle lies ahead of the base frame (m).
    #[serde(default)]
    pub x_m: f64,
    /// Where its middle lies left of the base frame (m).
    #[serde(default)]
    pub y_m: f64,
}

/// A polygon; its hull counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PolygonDoc {
    /// Its corners (m): x ahead, y left.
    #[schemars(length(min = 3, max = 1000))]
    pub polygon_m: Vec<[f64; 2]>,
}
