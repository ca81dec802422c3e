//! Sections of surfaces: what a plane meets, and the shadow of what lies between two heights.

use super::{Mesh, Triangle};
use crate::geometry::{Outline, Placement, Point, convex_hull};
use std::collections::BTreeSet;

/// A surface has none; as an outline it is drawn this thick (m), half on each side.
pub const THICKNESS: f64 = 1e-3;

/// Corners (m) that are nearer than this are one, when the same line is met twice.
const SAME: f64 = 1e-4;

/// Where a mesh stands, and how its own lengths become metres there.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Standing {
    /// Where it stands and how it is turned.
    pub placement: Placement,
    /// Factors along its own axes.
    pub scale: [f64; 3],
}

impl Standing {
    /// Returns the triangles of `mesh` where they stand.
    pub(in crate::world) fn triangles<'m>(
        &'m self,
        mesh: &'m Mesh,
    ) -> impl Iterator<Item = Triangle> + 'm {
        let place = |c: [f64; 3]| {
            let [x, y, z] = self.scale;
            self.placement.apply([c[0] * x, c[1] * y, c[2] * z])
        };
        mesh.triangles().iter().map(move |triangle| triangle.map(place))
    }
}

/// Returns the lines in which the plane at height `z` (m) meets `mesh`, each once.
pub(in crate::world) fn cut(mesh: &Mesh, standing: &Standing, z: f64) -> Vec<Outline> {
    let mut found = Pieces::default();
    for triangle in standing.triangles(mesh) {
        // A corner in the plane counts as above it, so that a line is met by both faces at it or by none.
        let mut ends = Vec::with_capacity(2);
        for (i, a) in triangle.iter().enumerate() {
            let b = triangle[(i + 1) % 3];
            if (a[2] >= z) != (b[2] >= z) {
                ends.push(between(*a, b, z));
            }
        }
        if let [a, b] = ends[..] {
            found.line(a, b);
        }
    }
    found.outlines
}

/// Returns what of `mesh` lies between the heights `low` and `high` (m), seen from above: a convex piece for each face,
/// each once.
pub(in crate::world) fn shadow(
    mesh: &Mesh,
    standing: &Standing,
    low: f64,
    high: f64,
) -> Vec<Outline> {
    let mut found = Pieces::default();
    for triangle in standing.triangles(mesh) {
        let above = clipped(&triangle, low, 1.0);
        let within = clipped(&above, high, -1.0);
        if !within.is_empty() {
            found.piece(&within.iter().map(|c| Point::new(c[0], c[1])).collect::<Vec<_>>());
        }
    }
    found.outlines
}

/// Returns where the edge from `a` to `b` pierces the plane at height `z`.
fn between(a: [f64; 3], b: [f64; 3], z: f64) -> Point {
    // From the lower end, in whichever order the ends are given, so that both faces at the edge find the same point.
    let (a, b) = if a[2] <= b[2] { (a, b) } else { (b, a) };
    let t = (z - a[2]) / (b[2] - a[2]);
    Point::new(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
}

/// Returns the part of a convex `polygon` above the plane at height `z`, or below where `side` is -1.
fn clipped(polygon: &[[f64; 3]], z: f64, side: f64) -> Vec<[f64; 3]> {
    if !z.is_finite() {
        return polygon.to_vec();
    }
    let inside = |c: [f64; 3]| side * (c[2] - z) >= 0.0;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if inside(a) {
            kept.push(a);
        }
        if inside(a) != inside(b) {
            let Point { x, y } = between(a, b, z);
            kept.push([x, y, z]);
        }
    }
    kept
}

/// Outlines, each once.
#[derive(Default)]
struct Pieces {
    outlines: Vec<Outline>,
    seen: BTreeSet<Vec<(i64, i64)>>,
}

impl Pieces {
    fn is_new(&mut self, corners: &[Point]) -> bool {
        #[expect(clippy::cast_possible_truncation, reason = "within 1e5 m, in steps of 0.1 mm")]
        let step = |v: f64| (v / SAME).round() as i64;
        let mut key: Vec<_> = corners.iter().map(|c| (step(c.x), step(c.y))).collect();
        key.sort_unstable();
        key.dedup();
        self.seen.insert(key)
    }

    /// Adds a line as a thin rectangle that goes half its thickness beyond both ends, so that lines that meet leave no
    /// gap.
    fn line(&mut self, a: Point, b: Point) {
        if !self.is_new(&[a, b]) {
            return;
        }
        let half = THICKNESS / 2.0;
        let long = a.distance(b);
        let along = if long > 0.0 { (b - a) * (half / long) } else { Point::new(half, 0.0) };
        let across = Point::new(-along.y, along.x);
        let (a, b) = (a - along, b + along);
        self.outlines.push(Outline::Polygon(vec![a - across, b - across, b + across, a + across]));
    }

    /// Adds the hull of `points`; a line where it is thinner than one.
    fn piece(&mut self, points: &[Point]) {
        let hull = convex_hull(points);
        let pairs = hull.iter().flat_map(|a| hull.iter().map(move |b| (*a, *b)));
        let apart = |(a, b): &(Point, Point)| a.distance(*b);
        let farthest = pairs.max_by(|p, q| apart(p).total_cmp(&apart(q)));
        let Some((a, b)) = farthest else { return };
        let long = a.distance(b);
        let aside = |p: &Point| if long > 0.0 { (b - a).cross(*p - a) / long } else { 0.0 };
        let (least, most) =
            hull.iter().map(aside).fold((0.0_f64, 0.0_f64), |(l, m), d| (l.min(d), m.max(d)));
        if hull.len() < 3 || most - least < THICKNESS {
            self.line(a, b);
        } else if self.is_new(&hull) {
            self.outlines.push(Outline::Polygon(hull));
        }
    }
}
