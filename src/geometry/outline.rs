//! Outlines of solid things cut by a plane: what is drawn on a floor plan.

use super::{Point, Segment};
use serde::{Deserialize, Serialize};

/// The closed outline of one solid thing, in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outline {
    /// A simple polygon of at least three corners, in order, not repeated at the end.
    Polygon(Vec<Point>),
    /// A disc.
    Circle {
        /// Centre (m).
        center: Point,
        /// Radius (m), positive.
        radius: f64,
    },
}

impl Outline {
    /// Creates the four-cornered outline of a box of `length` (along its x) and `width` m, centred on `center` and
    /// turned by `heading` rad.
    pub fn rectangle(center: Point, length: f64, width: f64, heading: f64) -> Self {
        let frame = super::Pose::new(center.x, center.y, heading);
        let (dx, dy) = (length / 2.0, width / 2.0);
        Self::Polygon(
            [(-dx, -dy), (dx, -dy), (dx, dy), (-dx, dy)]
                .map(|(x, y)| frame.transform(Point::new(x, y)))
                .to_vec(),
        )
    }

    /// Returns the sides of a polygon; none for a circle.
    pub fn sides(&self) -> impl Iterator<Item = Segment> + '_ {
        let corners: &[Point] = match self {
            Self::Polygon(corners) => corners,
            Self::Circle { .. } => &[],
        };
        (0..corners.len()).map(|i| Segment::new(corners[i], corners[(i + 1) % corners.len()]))
    }

    /// Returns whether `point` lies inside (even-odd rule); points on the border may count as either.
    pub fn contains(&self, point: Point) -> bool {
        match self {
            Self::Circle { center, radius } => (point - *center).norm_squared() <= radius * radius,
            Self::Polygon(_) => {
                self.sides()
                    .filter(|s| {
                        (s.a.y > point.y) != (s.b.y > point.y)
                            && point.x
                                < (s.b.x - s.a.x) * (point.y - s.a.y) / (s.b.y - s.a.y) + s.a.x
                    })
                    .count()
                    % 2
                    == 1
            }
        }
    }

    /// Returns the distance (m) from `point` to the solid: zero inside.
    pub fn distance(&self, point: Point) -> f64 {
        match self {
            Self::Circle { center, radius } => (center.distance(point) - radius).max(0.0),
            Self::Polygon(_) if self.contains(point) => 0.0,
            Self::Polygon(_) => {
                self.sides().map(|s| s.distance(point)).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Returns the smallest axis-aligned box around the outline.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Circle { center, radius } => Bounds {
                min: *center - Point::new(*radius, *radius),
                max: *center + Point::new(*radius, *radius),
            },
            Self::Polygon(corners) => {
                corners.iter().fold(Bounds::EMPTY, |bounds, &corner| bounds.including(corner))
            }
        }
    }
}

/// An axis-aligned box, in metres; empty where `min` exceeds `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lower left corner (m).
    pub min: Point,
    /// Upper right corner (m).
    pub max: Point,
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self = Self {
        min: Point::new(f64::INFINITY, f64::INFINITY),
        max: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Returns the smallest box around this one and `point`.
    #[must_use]
    pub fn including(self, point: Point) -> Self {
        Self {
            min: Point::new(self.min.x.min(point.x), self.min.y.min(point.y)),
            max: Point::new(self.max.x.max(point.x), self.max.y.max(point.y)),
        }
    }

    /// Returns the smallest box around this one and `other`.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        self.including(other.min).including(other.max)
    }

    /// Returns this box grown by `margin` m on every side.
    #[must_use]
    pub fn grown(self, margin: f64) -> Self {
        let by = Point::new(margin, margin);
        Self { min: self.min - by, max: self.max + by }
    }

    /// Returns the width (m) along x.
    pub fn width(self) -> f64 {
        self.max.x - self.min.x
    }

    /// Returns the height (m) along y.
    pub fn height(self) -> f64 {
        self.max.y - self.min.y
    }

    /// Returns whether the box is empty.
    pub fn is_empty(self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y
    }

    /// Returns whether `point` lies inside or on the border.
    pub fn contains(self, point: Point) -> bool {
        (self.min.x..=self.max.x).contains(&point.x) && (self.min.y..=self.max.y).contains(&point.y)
    }
}

/// Returns the convex hull of `points`, counter-clockwise, without collinear corners (Andrew 1979, monotone chain).
///
/// Fewer than three corners mean that the points are all on one line.
pub fn convex_hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while chain.len() >= 2 {
                let (a, b) = (chain[chain.len() - 2], chain[chain.len() - 1]);
                if (b - a).cross(point - b) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_turned_box_knows_inside_distance_and_bounds() {
        let outline =
            Outline::rectangle(Point::new(1.0, 2.0), 4.0, 2.0, std::f64::consts::FRAC_PI_2);
        let bounds = outline.bounds();
        assert!((bounds.width() - 2.0).abs() < 1e-12 && (bounds.height() - 4.0).abs() < 1e-12);
        assert!(outline.contains(Point::new(1.9, 3.9)));
        assert!(!outline.contains(Point::new(2.9, 2.0)));
        assert!((outline.distance(Point::new(4.0, 2.0)) - 2.0).abs() < 1e-12);
        assert_eq!(outline.distance(Point::new(1.0, 2.0)), 0.0);
    }

    proptest! {
        #[test]
        fn a_hull_contains_its_points_and_turns_left(
            raw in prop::collection::vec((-10.0..10.0, -10.0..10.0), 3..30)
        ) {
            let points: Vec<_> = raw.iter().map(|&(x, y)| Point::new(x, y)).collect();
            let hull = convex_hull(&points);
            prop_assert!(hull.len() >= 3);
            for i in 0..hull.len() {
                let (a, b) = (hull[i], hull[(i + 1) % hull.len()]);
                prop_assert!(points.iter().all(|&p| (b - a).cross(p - a) >= -1e-9));
            }
        }
    }
}
