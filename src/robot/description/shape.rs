//! The body from above: the area that the collision shapes of all links cover together.

use crate::geometry::{Outline, Placement, Point, convex_hull};
use crate::math;

/// One collision shape in the base frame.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) kind: ShapeKind,
    pub(super) placement: Placement,
}

/// Shapes (m), centred on their placement; a capsule counts as the cylinder around it.
#[derive(Debug, Clone)]
pub(in crate::robot) enum ShapeKind {
    Box {
        size: [f64; 3],
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    /// The corners of a mesh.
    Points(Vec<[f64; 3]>),
}

/// Corners of a round outline: within 0.13 % of its radius.
const ROUND: u32 = 64;

/// How far (m) shapes may stand out of a round base that is still taken for round: rounding in the numbers.
const TOLERANCE: f64 = 1e-3;

/// Computes the outline of all shapes from above: a circle where one upright cylinder (or sphere) covers the others,
/// else their convex hull; `None` where there is no shape.
pub(super) fn footprint(shapes: &[Shape]) -> Option<Outline> {
    let corners: Vec<Point> =
        shapes.iter().flat_map(Shape::corners).map(|[x, y, _]| Point::new(x, y)).collect();
    let round = shapes.iter().filter_map(Shape::disc).max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((center, radius)) = round
        && corners.iter().all(|corner| corner.distance(center) <= radius + TOLERANCE)
    {
        return Some(Outline::Circle { center, radius });
    }
    let mut hull = convex_hull(&corners);
    // A mesh's hull may have thousands of corners: those that stand out most in as many directions as a circle has.
    let has_mesh = shapes.iter().any(|shape| matches!(shape.kind, ShapeKind::Points(_)));
    if has_mesh && hull.len() > ROUND as usize {
        let outermost = |i: u32| {
            let (sin, cos) = direction(i);
            let out = |corner: &Point| corner.x * cos + corner.y * sin;
            hull.iter().copied().max_by(|a, b| out(a).total_cmp(&out(b)))
        };
        hull = convex_hull(&(0..ROUND).filter_map(outermost).collect::<Vec<_>>());
    }
    (hull.len() >= 3).then_some(Outline::Polygon(hull))
}

/// Returns sine and cosine of the direction `i` of [`ROUND`].
fn direction(i: u32) -> (f64, f64) {
    math::sin_cos(std::f64::consts::TAU * f64::from(i) / f64::from(ROUND))
}

/// Computes the lowest and highest point (m) of all shapes in the base frame.
pub(super) fn extent(shapes: &[Shape]) -> [f64; 2] {
    shapes
        .iter()
        .flat_map(Shape::corners)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [_, _, z]| {
            [low.min(z), high.max(z)]
        })
}

impl Shape {
    /// Returns centre and radius where the shape seen from above is a disc.
    fn disc(&self) -> Option<(Point, f64)> {
        let [x, y, _] = self.placement.translation;
        match self.kind {
            ShapeKind::Cylinder { radius, .. } if self.placement.is_upright() => {
                Some((Point::new(x, y), radius))
            }
            ShapeKind::Sphere { radius } => Some((Point::new(x, y), radius)),
            _ => None,
        }
    }

    /// Returns the points that span the shape.
    fn corners(&self) -> Vec<[f64; 3]> {
        let signs = [-0.5, 0.5];
        let circle = |radius: f64| {
            (0..ROUND).map(move |i| {
                let (sin, cos) = direction(i);
                (radius * cos, radius * sin)
            })
        };
        match &self.kind {
            ShapeKind::Points(points) => {
                points.iter().map(|point| self.placement.apply(*point)).collect()
            }
            &ShapeKind::Box { size: [sx, sy, sz] } => signs
                .iter()
                .flat_map(|x| signs.iter().map(move |y| (x, y)))
                .flat_map(|(x, y)| signs.iter().map(move |z| [x * sx, y * sy, z * sz]))
                .map(|corner| self.placement.apply(corner))
                .collect(),
            &ShapeKind::Cylinder { radius, length } => circle(radius)
                .flat_map(|(x, y)| signs.map(|z| [x, y, z * length]))
                .map(|corner| self.placement.apply(corner))
                .collect(),
            &ShapeKind::Sphere { radius } => {
                let [x, y, z] = self.placement.translation;
                let mut corners: Vec<_> =
                    circle(radius).map(|(dx, dy)| [x + dx, y + dy, z]).collect();
                corners.extend([[x, y, z - radius], [x, y, z + radius]]);
                corners
            }
        }
    }
}
