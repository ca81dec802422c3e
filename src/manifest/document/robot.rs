//! The robot of a manifest as written.

use crate::robot::given::{DriveDoc, FootprintDoc, Given, LidarDoc};
use crate::studies::FactorValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The robot: a file, or a file and what else is to be said of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum RobotDoc {
    /// A file.
    Path(String),
    /// A file and what goes before it.
    File(Box<RobotFile>),
}

/// A robot in a file, and what is to be said of it besides: that goes before what the file says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct RobotFile {
    /// URDF, xacro, or the `<model>` of an SDF file.
    pub file: String,
    /// Files that hold only the `<gazebo>` blocks of the robot.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gazebo: Vec<String>,
    /// The folders of the packages that its files are named by, `NAME` of `package://NAME/mesh.stl`, `$(find NAME)` and
    /// `model://NAME/mesh.dae` to its folder. They are relative to the manifest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub packages: BTreeMap<String, String>,
    /// Arguments of xacro (`$(arg NAME)`), and what stands for environment variables (`$(optenv NAME ...)`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub arguments: BTreeMap<String, FactorValue>,
    /// The range scanner: the name of one of the description's, or its numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lidar: Option<LidarDoc>,
    /// The drive in numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<DriveDoc>,
    /// The outline of the body from above, instead of that of the collisions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub footprint: Option<FootprintDoc>,
    /// How high the body reaches above ground (m), instead of the collisions' height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub height_m: Option<f64>,
    /// Mass (kg), instead of the links' sum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
}

impl RobotFile {
    /// Returns the robot that is nothing but the file `file`.
    pub(in crate::manifest) fn plain(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            gazebo: Vec::new(),
            packages: BTreeMap::new(),
            arguments: BTreeMap::new(),
            lidar: None,
            drive: None,
            footprint: None,
            height_m: None,
            mass_kg: None,
        }
    }

    /// Returns what goes before the description.
    pub(in crate::manifest) fn given(&self) -> Given {
        Given {
            lidar: self.lidar.clone(),
            drive: self.drive.clone(),
            footprint: self.footprint.clone(),
            height_m: self.height_m,
            mass_kg: self.mass_kg,
        }
    }
}
