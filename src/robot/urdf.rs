//! Robots as ROS describes them: URDF links and joints with the `<gazebo>` blocks of sensors and drives.
//!
//! Hermetic: no package path is resolved, no macro expanded, no mesh opened. Joints stand at zero. The base frame is
//! the root link's. Reading goes as follows:
//! 1. A strict pass reports, with lines, what `urdf-rs` would let through.
//! 2. Links and joints are read by `urdf-rs` (this file alone names it).
//! 3. The collision shapes give the footprint.
//! 4. The floor is the root link's origin where that link is called `base_footprint` (REP-120), else the lowest point
//!    of the collision shapes.
//! 5. The `<gazebo>` blocks give drive and sensors.

mod gazebo;
mod shape;
mod strict;

use super::Robot;
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Source};
use crate::geometry::Placement;
use shape::{Shape, ShapeKind};
use std::collections::BTreeMap;

/// Longest description read (bytes): real ones have some ten thousand.
pub const MAX_BYTES: usize = 1 << 20;

/// Largest body read (m): beyond it the unit is wrong.
const MAX_SIZE: f64 = 20.0;

/// Reads a robot and the warnings about it.
///
/// # Errors
/// Every fault found, warnings among them, where the description cannot be used.
pub fn read(source: &Source) -> Result<(Robot, Vec<Diagnostic>), Vec<Diagnostic>> {
    let document = xml::parse(source, MAX_BYTES)?;
    let mut faults = Faults::new(source);
    // 1. The strict pass.
    let tree = strict::check(&document, &mut faults);
    let (Some(tree), false) = (tree, faults.any_error()) else { return Err(faults.finish()) };

    // 2. Links and joints.
    let description = match urdf_rs::read_from_string(&source.text) {
        Ok(description) => description,
        Err(fault) => {
            faults.push(Diagnostic::placeless(format!("`{}` is not a URDF: {fault}", source.name)));
            return Err(faults.finish());
        }
    };
    let frames = place(&description, &tree.root);
    // 3. The footprint.
    let mut shapes = Vec::new();
    for link in &description.links {
        for collision in &link.collision {
            match shape_of(&collision.geometry) {
                Some(kind) => shapes.push(Shape {
                    kind,
                    placement: frames[&link.name].compose(&placement_of(&collision.origin)),
                }),
                None => faults.push(
                    Diagnostic::placeless(format!(
                        "a mesh collides on link `{}` and is not part of the body",
                        link.name
                    ))
                    .warning()
                    .help("add a box or cylinder collision of its size"),
                ),
            }
        }
    }
    let Some(footprint) = shape::footprint(&shapes) else {
        faults.push(
            Diagnostic::placeless(format!("robot `{}` has no body", description.name))
                .help("give a link a box, cylinder or sphere collision"),
        );
        return Err(faults.finish());
    };
    let [low, high] = shape::extent(&shapes);
    let bounds = footprint.bounds();
    let size = bounds.width().max(bounds.height()).max(high - low);
    if size.is_nan() || size >= MAX_SIZE {
        faults.push(
            Diagnostic::placeless(format!(
                "robot `{}` is {size} m across: expected less than {MAX_SIZE} m",
                description.name
            ))
            .help("URDF lengths are in metres; is this in millimetres?"),
        );
    }
    // 4. The floor.
    let ground = if tree.root == "base_footprint" { 0.0 } else { low };
    let mass: f64 = description.links.iter().map(|link| link.inertial.mass.value).sum();
    if mass <= 0.0 || !mass.is_finite() {
        faults.push(
            Diagnostic::placeless(format!("robot `{}` has no mass", description.name))
                .help("give its base link an <inertial> with a <mass>"),
        );
    }
    // 5. Drive and sensors.
    let drive = gazebo::drive(&document, &mut faults);
    let sensors = gazebo::sensors(&document, &mut faults, &frames, ground);
    match drive {
        Some(drive) if !faults.any_error() => {
            let robot = Robot {
                name: description.name,
                footprint,
                body_z: [low - ground, high - ground],
                mass,
                drive,
                lidar: sensors.lidar,
                camera: sensors.camera,
                compass: sensors.compass,
            };
            Ok((robot, faults.finish()))
        }
        _ => Err(faults.finish()),
    }
}

/// Returns the placement of every link in the root link's frame, joints at zero.
fn place(description: &urdf_rs::Robot, root: &str) -> BTreeMap<String, Placement> {
    let mut frames = BTreeMap::from([(root.to_owned(), Placement::IDENTITY)]);
    let mut open = vec![root];
    while let Some(parent) = open.pop() {
        for joint in description.joints.iter().filter(|joint| joint.parent.link == parent) {
            let placement = frames[parent].compose(&placement_of(&joint.origin));
            frames.insert(joint.child.link.clone(), placement);
            open.push(&joint.child.link);
        }
    }
    frames
}

fn placement_of(pose: &urdf_rs::Pose) -> Placement {
    let ([x, y, z], [roll, pitch, yaw]) = (pose.xyz.0, pose.rpy.0);
    Placement::from_xyz_rpy([x, y, z, roll, pitch, yaw])
}

fn shape_of(geometry: &urdf_rs::Geometry) -> Option<ShapeKind> {
    Some(match *geometry {
        urdf_rs::Geometry::Box { size } => ShapeKind::Box { size: size.0 },
        urdf_rs::Geometry::Cylinder { radius, length } => ShapeKind::Cylinder { radius, length },
        urdf_rs::Geometry::Capsule { radius, length } => {
            ShapeKind::Cylinder { radius, length: length + 2.0 * radius }
        }
        urdf_rs::Geometry::Sphere { radius } => ShapeKind::Sphere { radius },
        urdf_rs::Geometry::Mesh { .. } => return None,
    })
}

#[cfg(test)]
mod tests;
