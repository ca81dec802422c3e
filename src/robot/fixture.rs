//! A robot for tests in which nothing but its outline matters.

use super::{Drive, DriveKind, Robot};
use crate::geometry::{Outline, Point};

impl Robot {
    /// Returns a disc of `radius` (m) with two wheels, as tall as a Kobuki, that has no sensor.
    pub(crate) fn disc(radius: f64) -> Self {
        Self {
            name: "disc".to_owned(),
            footprint: Outline::Circle { center: Point::ZERO, radius },
            body_z: [0.01, 0.43],
            mass: 5.0,
            drive: Drive {
                kind: DriveKind::Differential,
                wheel_separation: 0.23,
                wheel_diameter: 0.07,
                max_linear: None,
                max_angular: None,
            },
            lidar: None,
            camera: None,
            compass: None,
        }
    }
}
