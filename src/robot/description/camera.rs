//! The logical camera: `<logical_camera>` of SDF 1.6.
//!
//! Gazebo's frustum, seen from above, ends at planes; ours is a cone that ends at arcs, which differs in the corners. The
//! frustum's height is left out, since tags have none.

use super::sensors::Sensor;
use crate::document::xml::{self, Faults};
use crate::geometry::Pose;
use crate::robot::LogicalCamera;
use std::f64::consts::TAU;

/// Reads a logical camera.
pub(super) fn read(sensor: &Sensor<'_, '_>, faults: &mut Faults<'_>) -> Option<LogicalCamera> {
    let placement = sensor.level_placement("view", faults)?;
    let rate_hz = sensor.rate(faults);
    let Some(cone) = xml::child(sensor.node, "logical_camera") else {
        let fault = faults
            .at(sensor.node, format!("{} has no <logical_camera>", sensor.title()))
            .label("expected <logical_camera> with <near>, <far> and <horizontal_fov>");
        faults.push(fault);
        return None;
    };
    let near = faults.required(cone, "near", "a distance in metres");
    let far = faults.required(cone, "far", "a distance in metres");
    let horizontal_fov = faults.required(cone, "horizontal_fov", "an angle in radians");
    if let Some(ratio) = xml::child(cone, "aspect_ratio").and_then(|node| faults.number(node))
        && ratio <= 0.0
    {
        let fault = faults
            .at(cone, format!("{} has an aspect ratio of {ratio}", sensor.title()))
            .label("expected more than zero");
        faults.push(fault);
    }
    let (near, far, horizontal_fov) = (near?, far?, horizontal_fov?);
    if near < 0.0 || far <= near {
        let fault = faults
            .at(cone, format!("{} sees from {near} to {far} m", sensor.title()))
            .label("expected zero or more, and a larger maximum");
        faults.push(fault);
    }
    if horizontal_fov <= 0.0 || horizontal_fov > TAU {
        let fault = faults
            .at(cone, format!("{} looks over {horizontal_fov} rad", sensor.title()))
            .label("expected more than zero and at most a full turn");
        faults.push(fault);
    }
    let [x, y, _] = placement.translation;
    Some(LogicalCamera {
        name: sensor.name.to_owned(),
        mount: Pose::new(x, y, placement.yaw()),
        near,
        far,
        horizontal_fov,
        rate_hz: rate_hz?,
    })
}
