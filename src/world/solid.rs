//! Solid things in three dimensions, and their two projections to the plane: the cut by a lidar's scan plane, and the
//! shadow of what a robot's body could touch.

use super::mesh::{Mesh, section};
use crate::geometry::{Outline, Placement, Point, convex_hull};
use crate::math;
use section::Standing;
use serde::Serialize;

/// One solid thing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Solid {
    /// Name, for messages and drawings; not part of the meaning.
    #[serde(skip)]
    pub name: String,
    /// The layer to which it belongs (`walls`, `furniture`, ...).
    #[serde(skip)]
    pub layer: String,
    /// Its shape and place.
    pub body: Body,
}

/// Shape and place of a solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// An upright prism over `outline` from `z[0]` to `z[1]` (m).
    Prism {
        /// Its outline (m).
        outline: Outline,
        /// Lower and upper end (m).
        z: [f64; 2],
    },
    /// A box of `size` m along its own axes, centred on its placement.
    Box {
        /// Full lengths along its x, y and z (m).
        size: [f64; 3],
        /// Position and orientation of its centre.
        placement: Placement,
    },
    /// A cylinder along its own z axis, centred on its placement.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Length (m).
        length: f64,
        /// Position and orientation of its centre.
        placement: Placement,
    },
    /// A ball.
    Sphere {
        /// Its centre (m).
        center: [f64; 3],
        /// Radius (m).
        radius: f64,
    },
    /// A convex body turned about its own z axis: between two neighbouring rings it is spanned by both.
    Round {
        /// Rings from one end to the other: half lengths along its x and y, and height (m).
        rings: Vec<[f64; 3]>,
        /// Position and orientation.
        placement: Placement,
    },
    /// A surface of triangles.
    Mesh {
        /// The triangles in their own frame.
        mesh: Mesh,
        /// Their placement.
        standing: Standing,
    },
}

/// Corners used for the round ends of a tilted cylinder: the outline is within 0.5 % of its radius.
const ROUND: u32 = 32;

impl Body {
    /// Returns the outlines of the cut at height `z` (m): none where the plane misses the body, one of a solid, thin
    /// ones of the lines of a mesh.
    pub fn slice(&self, z: f64) -> Vec<Outline> {
        match self {
            Self::Mesh { mesh, standing } => section::cut(mesh, standing, z),
            _ => self.whole(z, z).into_iter().collect(),
        }
    }

    /// Returns the outlines of the part between the heights `low` and `high` (m) seen from above: at most one of a
    /// solid, one for each face of a mesh. Exact for boxes, spheres, meshes and upright prisms and cylinders; the hull of
    /// 32-gons for tilted cylinders and other round bodies.
    pub fn shadow(&self, low: f64, high: f64) -> Vec<Outline> {
        match self {
            Self::Mesh { mesh, standing } => section::shadow(mesh, standing, low, high),
            _ => self.whole(low, high).into_iter().collect(),
        }
    }

    /// Returns its lowest and highest point (m).
    pub fn heights(&self) -> [f64; 2] {
        let of = |heights: &mut dyn Iterator<Item = f64>| {
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], z| [l.min(z), h.max(z)])
        };
        match self {
            Self::Prism { z, .. } => *z,
            Self::Sphere { center, radius } => [center[2] - radius, center[2] + radius],
            Self::Box { size, placement } => {
                let up = placement.rotation[2];
                let half = up.iter().zip(size).map(|(u, s)| (u * s).abs() / 2.0).sum::<f64>();
                [placement.translation[2] - half, placement.translation[2] + half]
            }
            Self::Cylinder { radius, length, placement } => {
                let [x, y, z] = placement.rotation[2];
                let half = radius * math::hypot(x, y) + (z * length).abs() / 2.0;
                [placement.translation[2] - half, placement.translation[2] + half]
            }
            Self::Round { rings, placement } => {
                let [x, y, z] = placement.rotation[2];
                of(&mut rings.iter().flat_map(|[a, b, h]| {
                    let middle = placement.translation[2] + z * h;
                    let half = math::hypot(x * a, y * b);
                    [middle - half, middle + half]
                }))
            }
            Self::Mesh { mesh, standing } => {
                of(&mut standing.triangles(mesh).flatten().map(|c| c[2]))
            }
        }
    }

    /// Returns the one outline of a solid between two heights; none of a mesh.
    fn whole(&self, low: f64, high: f64) -> Option<Outline> {
        match self {
            Self::Mesh { .. } => None,
            Self::Sphere { center: [x, y, z], radius } => {
                // The widest section is the one nearest to the centre.
                let off = (low - z).max(z - high).max(0.0);
                let within = (radius * radius - off * off).max(0.0).sqrt();
                (off <= *radius && within > 0.0)
                    .then(|| Outline::Circle { center: Point::new(*x, *y), radius: within })
            }
            Self::Round { rings, placement } => {
                let corners: Vec<_> = rings
                    .iter()
                    .flat_map(|&[a, b, height]| {
                        (0..ROUND).map(move |i| {
                            let (sin, cos) = math::sin_cos(
                                std::f64::consts::TAU * f64::from(i) / f64::from(ROUND),
                            );
                            placement.apply([a * cos, b * sin, height])
                        })
                    })
                    .collect();
                let round = ROUND as usize;
                let around = (0..corners.len()).map(|i| (i, i / round * round + (i + 1) % round));
                let along = (round..corners.len()).map(|i| (i - round, i));
                hull_between(&corners, &around.chain(along).collect::<Vec<_>>(), low, high)
            }
            Self::Prism { outline, z } => (z[0] <= high && z[1] >= low).then(|| outline.clone()),
            Self::Cylinder { radius, length, placement } if placement.is_upright() => {
                let [x, y, z] = placement.translation;
                (z - length / 2.0 <= high && z + length / 2.0 >= low)
                    .then(|| Outline::Circle { center: Point::new(x, y), radius: *radius })
            }
            Self::Cylinder { radius, length, placement } => {
                let rim = |end: f64, i: u32| {
                    let angle = std::f64::consts::TAU * f64::from(i) / f64::from(ROUND);
                    let (sin, cos) = math::sin_cos(angle);
                    placement.apply([radius * cos, radius * sin, end * length / 2.0])
                };
                let corners: Vec<_> = [-1.0, 1.0]
                    .iter()
                    .flat_map(|&end| (0..ROUND).map(move |i| rim(end, i)))
                    .collect();
                let pairs: Vec<_> = (0..corners.len())
                    .flat_map(|i| (i + 1..corners.len()).map(move |j| (i, j)))
                    .collect();
                hull_between(&corners, &pairs, low, high)
            }
            Self::Box { size, placement } => {
                let corner = |i: usize| {
                    let end = |axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
                    placement.apply([end(0) * size[0], end(1) * size[1], end(2) * size[2]])
                };
                let corners: Vec<_> = (0..8).map(corner).collect();
                if placement.is_upright() {
                    let (bottom, top) =
                        (corners[0][2].min(corners[7][2]), corners[0][2].max(corners[7][2]));
                    let sides: Vec<_> =
                        corners[..4].iter().map(|c| Point::new(c[0], c[1])).collect();
                    return (bottom <= high && top >= low)
                        .then(|| Outline::Polygon(convex_hull(&sides)));
                }
                let edges: Vec<_> = (0..8_usize)
                    .flat_map(|i| (0..3).map(move |axis| (i, i | 1 << axis)))
                    .filter(|(i, j)| i != j)
                    .collect();
                hull_between(&corners, &edges, low, high)
            }
        }
    }
}

/// Computes the hull, seen from above, of the convex body spanned by `corners`, cut to `low..=high`.
///
/// A section of a convex body is spanned by the corners within it and by the points where its edges pierce a cutting
/// plane. `edges` name corners by number and may hold inner lines too.
fn hull_between(
    corners: &[[f64; 3]],
    edges: &[(usize, usize)],
    low: f64,
    high: f64,
) -> Option<Outline> {
    let mut points: Vec<Point> = corners
        .iter()
        .filter(|c| (low..=high).contains(&c[2]))
        .map(|c| Point::new(c[0], c[1]))
        .collect();
    for plane in [low, high] {
        if !plane.is_finite() {
            continue;
        }
        for &(i, j) in edges {
            let (a, b) = (corners[i], corners[j]);
            if (a[2] < plane) != (b[2] < plane) {
                let t = (plane - a[2]) / (b[2] - a[2]);
                points.push(Point::new(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])));
            }
        }
    }
    let hull = convex_hull(&points);
    (hull.len() >= 3).then_some(Outline::Polygon(hull))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn one(outlines: Vec<Outline>) -> Option<Outline> {
        assert!(outlines.len() <= 1, "{outlines:?}");
        outlines.into_iter().next()
    }

    fn size(outline: &Outline) -> (f64, f64) {
        let bounds = outline.bounds();
        (bounds.width(), bounds.height())
    }

    #[test]
    fn a_rolled_car_shows_its_side() {
        // The cars of the open world: 4.5 x 4 x 2 m with roll 1.571 stand on their side.
        let placement = Placement::from_xyz_rpy([0.0, 0.0, 1.0, FRAC_PI_2, 0.0, 0.0]);
        let car = Body::Box { size: [4.5, 4.0, 2.0], placement };
        let (width, height) = size(&one(car.slice(0.16)).unwrap());
        assert!((width - 4.5).abs() < 1e-9 && (height - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_turned_box_has_four_corners_wherever_it_is_cut() {
        // Rounding must not add corners along its sides: each would be a wall to the lidar.
        for yaw in [0.0, 0.1, FRAC_PI_2, -1.57, 2.5] {
            let placement = Placement::from_xyz_rpy([32.0, 8.9, 1.25, 0.0, -0.0, yaw]);
            let wall = Body::Box { size: [10.25, 0.15, 2.5], placement };
            for outline in [wall.slice(0.1602), wall.shadow(0.0, 0.43), wall.shadow(-9.0, 9.0)] {
                assert_eq!(one(outline).unwrap().sides().count(), 4, "{yaw}");
            }
        }
    }

    #[test]
    fn a_ball_is_cut_in_circles_and_round_bodies_nearly_so() {
        let ball = Body::Sphere { center: [1.0, 0.0, 0.5], radius: 0.5 };
        let cut = |body: &Body, z: f64| one(body.slice(z)).map(|outline| size(&outline));
        assert_eq!(cut(&ball, 0.5), Some((1.0, 1.0)));
        assert!((cut(&ball, 0.2).unwrap().0 - 0.8).abs() < 1e-12);
        assert_eq!((cut(&ball, 1.01), ball.heights()), (None, [0.0, 1.0]));
        assert_eq!(one(ball.shadow(0.0, 2.0)), one(ball.slice(0.5)));
        // A cone of 1 m, lying: seen from above it is a triangle.
        let rings = vec![[0.5, 0.5, -0.5], [0.0, 0.0, 0.5]];
        let placement = Placement::from_xyz_rpy([0.0, 0.0, 0.0, 0.0, FRAC_PI_2, 0.0]);
        let cone = Body::Round { rings, placement };
        let (width, height) = cut(&cone, 0.0).unwrap();
        assert!((width - 1.0).abs() < 1e-9 && (height - 1.0).abs() < 0.01, "{width} {height}");
        let (width, _) = cut(&cone, 0.25).unwrap();
        assert!((width - 0.5).abs() < 0.01, "{width}");
        assert!((cone.heights()[1] - 0.5).abs() < 1e-9);
    }

    #[test]
    fn a_lintel_is_above_the_lidar_but_a_tall_body_could_touch_it() {
        let placement = Placement::from_xyz_rpy([1.0, 2.0, 2.25, 0.0, 0.0, 0.3]);
        let lintel = Body::Box { size: [0.9, 0.15, 0.5], placement };
        assert_eq!(lintel.slice(0.1602), []);
        assert_eq!(lintel.shadow(0.0, 0.43), []);
        assert_eq!(lintel.shadow(0.0, 2.1).len(), 1);
    }

    #[test]
    fn a_tilted_box_is_cut_where_the_plane_meets_it() {
        // A 45 degree wedge: a unit cube pitched by a quarter of pi, cut through its centre, is sqrt(2) long.
        let placement = Placement::from_xyz_rpy([0.0, 0.0, 0.0, 0.0, FRAC_PI_2 / 2.0, 0.0]);
        let cube = Body::Box { size: [1.0, 1.0, 1.0], placement };
        let (width, height) = size(&one(cube.slice(0.0)).unwrap());
        assert!((width - 2.0_f64.sqrt()).abs() < 1e-9 && (height - 1.0).abs() < 1e-9);
        let (width, _) = size(&one(cube.slice(0.5)).unwrap());
        assert!((width - (2.0_f64.sqrt() - 1.0)).abs() < 1e-9);
    }
}
