//! The bodies of shapes, where they stand.

use super::geometry::{MAX_SIZE, Shape};
use super::notes::Kind;
use crate::geometry::{Outline, Placement, Point, Pose};
use crate::math;
use crate::world::mesh::section::{Standing, THICKNESS};
use crate::world::{Body, Solid};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Why a shape has no body.
pub(super) enum Refused {
    /// It is missing.
    Lack(Kind),
    /// A scale makes it larger than anything: this long (m).
    TooLarge(f64),
    /// What stands in for it would lean.
    Leans,
}

/// How far (cosine) a stand-in's frame may lean: a degree.
const UPRIGHT: f64 = 0.9998;

/// Rings of a half round end: the outline is within 1 % of its radius.
const RINGS: u32 = 8;

/// Returns the bodies of `shape` at `placement`, sizes multiplied by `scale` as Gazebo does.
pub(super) fn of(
    shape: &Shape,
    placement: Placement,
    scale: [f64; 3],
) -> Result<Vec<Body>, Refused> {
    let [sx, sy, sz] = scale;
    // Gazebo scales a radius by the larger of x and y.
    let sr = sx.max(sy);
    let body = match shape {
        Shape::Nothing => return Ok(Vec::new()),
        Shape::Lack(kind) => return Err(Refused::Lack(kind.clone())),
        Shape::StandIn(solids) => return stand_in(solids, &placement),
        Shape::Box(size) => {
            let size = [size[0] * sx, size[1] * sy, size[2] * sz];
            check(&size)?;
            Body::Box { size, placement }
        }
        Shape::Cylinder { radius, length } => {
            let (radius, length) = (radius * sr, length * sz);
            check(&[radius, length])?;
            Body::Cylinder { radius, length, placement }
        }
        Shape::Sphere(radius) => {
            let radius = radius * sr.max(sz);
            check(&[radius])?;
            Body::Sphere { center: placement.translation, radius }
        }
        Shape::Capsule { radius, length } => {
            let (radius, half) = (radius * sr, length * sz / 2.0);
            check(&[radius, half])?;
            let upper = round_end([radius; 3]).map(|[x, y, z]| [x, y, z + half]);
            Body::Round { rings: mirrored(upper.collect()), placement }
        }
        Shape::Cone { radius, length } => {
            let (radius, half) = (radius * sr, length * sz / 2.0);
            check(&[radius, half])?;
            Body::Round { rings: vec![[radius, radius, -half], [0.0, 0.0, half]], placement }
        }
        Shape::Ellipsoid([a, b, c]) => {
            let radii = [a * sx, b * sy, c * sz];
            check(&radii)?;
            Body::Round { rings: mirrored(round_end(radii).collect()), placement }
        }
        Shape::Plane { normal, size } => plane(*normal, [size[0] * sx, size[1] * sy], &placement),
        Shape::Polyline { corners, height } => {
            if placement.rotation[2][2] < 1.0 - 1e-9 {
                return Err(Refused::Lack(Kind::Shape("tilted polyline".to_owned())));
            }
            let height = height * sz;
            check(&[height])?;
            let corner = |[x, y]: &[f64; 2]| {
                let [x, y, _] = placement.apply([x * sx, y * sy, 0.0]);
                Point::new(x, y)
            };
            let outline = Outline::Polygon(corners.iter().map(corner).collect());
            let low = placement.translation[2];
            Body::Prism { outline, z: [low, low + height] }
        }
        Shape::Mesh { mesh, scale: own } => {
            let scale = [own[0] * sx, own[1] * sy, own[2] * sz];
            Body::Mesh { mesh: mesh.clone(), standing: Standing { placement, scale } }
        }
    };
    Ok(vec![body])
}

fn check(lengths: &[f64]) -> Result<(), Refused> {
    let wrong = lengths.iter().find(|length| !(**length > 0.0 && **length <= MAX_SIZE));
    wrong.map_or(Ok(()), |wrong| Err(Refused::TooLarge(*wrong)))
}

/// Returns the rings of the upper half of an ellipsoid, from its middle to its top.
fn round_end([a, b, c]: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (0..=RINGS).map(move |i| {
        let (sin, cos) = math::sin_cos(FRAC_PI_2 * f64::from(i) / f64::from(RINGS));
        // The last ring is a point.
        let cos = if i == RINGS { 0.0 } else { cos };
        [a * cos, b * cos, c * sin]
    })
}

/// Returns the rings of a body of which `upper` are those above its middle.
fn mirrored(upper: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    let lower: Vec<_> = upper.iter().rev().map(|[x, y, z]| [*x, *y, -z]).collect();
    // An ellipsoid has one ring in its middle, a capsule two.
    let both = usize::from(lower.last() == upper.first());
    lower.into_iter().chain(upper.into_iter().skip(both)).collect()
}

/// Returns a plane as a thin board of its `size`, its z axis along `normal`.
fn plane(normal: [f64; 3], size: [f64; 2], placement: &Placement) -> Body {
    let long = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    let [x, y, z] = if long > 0.0 { normal.map(|n| n / long) } else { [0.0, 0.0, 1.0] };
    // The shortest turn from z to the normal.
    let axis = math::hypot(x, y);
    let turn = if axis > 0.0 {
        let half = math::atan2(axis, z).clamp(-TAU, TAU) / 2.0;
        let (sin, cos) = math::sin_cos(half);
        Placement::from_xyz_quaternion([0.0; 3], [-y / axis * sin, x / axis * sin, 0.0, cos])
    } else {
        Placement::IDENTITY
    };
    let extent = |length: f64| length.abs().clamp(THICKNESS, MAX_SIZE);
    Body::Box {
        size: [extent(size[0]), extent(size[1]), THICKNESS],
        placement: placement.compose(&turn),
    }
}

/// Returns the stand-in `solids` where `placement` is.
fn stand_in(solids: &[Solid], placement: &Placement) -> Result<Vec<Body>, Refused> {
    if placement.rotation[2][2] < UPRIGHT {
        return Err(Refused::Leans);
    }
    let [x, y, up] = placement.translation;
    let frame = Pose::new(x, y, placement.yaw());
    let place = |solid: &Solid| match &solid.body {
        Body::Prism { outline, z } => {
            let outline = match outline {
                Outline::Circle { center, radius } => {
                    Outline::Circle { center: frame.transform(*center), radius: *radius }
                }
                Outline::Polygon(corners) => {
                    Outline::Polygon(corners.iter().map(|c| frame.transform(*c)).collect())
                }
            };
            Body::Prism { outline, z: [z[0] + up, z[1] + up] }
        }
        other => other.clone(),
    };
    Ok(solids.iter().map(place).collect())
}
