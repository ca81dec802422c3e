//! An exact lidar: every front-facing wall writes the beams that meet it, so that no beam searches for walls.
//!
//! For a wall from a to b and a beam in the unit direction d, both seen from the sensor, the range is
//! (a × (b − a)) / (d × (b − a)); the beams that meet the wall are those between a and b, a contiguous run of
//! beam numbers. Cost: one visit per wall and one division per beam and wall met.

use crate::geometry::{Outline, Point, Pose};
use crate::math;
use crate::rng::Stream;
use crate::robot::Lidar;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::ops::Range;

/// A wall as the lidar sees it, in the world's frame (m).
#[derive(Debug, Clone, Copy)]
struct Wall {
    /// Its ends; the solid side is on the right of a → b.
    a: Point,
    b: Point,
    /// b − a.
    along: Point,
    /// A sensor for which (a − sensor) × (b − a) exceeds this is further from the wall's line than the longest range.
    reach: f64,
}

impl Wall {
    fn new(a: Point, b: Point, max_range: f64) -> Self {
        Self { a, b, along: b - a, reach: (b - a).norm() * max_range + SLACK }
    }

    /// Returns whether the sensor is surely behind the wall or too far from it. What is left is looked at exactly.
    fn is_out_of_sight(&self, sensor: Point) -> bool {
        let side = (self.a - sensor).cross(self.along);
        side < -SLACK || side > self.reach
    }
}

/// By how much a product of lengths (m²) may be off by rounding, generously.
const SLACK: f64 = 1e-6;

/// A caster for one lidar in one world.
#[derive(Debug, Clone)]
pub struct WallSweep {
    walls: Vec<Wall>,
    circles: Vec<(Point, f64)>,
    /// Unit direction of each beam in the sensor's frame.
    beams: Vec<Point>,
    min_angle: f64,
    increment: f64,
    max_range: f64,
}

impl WallSweep {
    /// Creates a caster of `lidar`'s beams among the `visible` outlines.
    pub fn new(visible: &[Outline], lidar: &Lidar) -> Self {
        let mut walls = Vec::new();
        let mut circles = Vec::new();
        for outline in visible {
            match outline {
                Outline::Circle { center, radius } => circles.push((*center, *radius)),
                Outline::Polygon(corners) => {
                    let doubled_area: f64 = outline.sides().map(|s| s.a.cross(s.b)).sum();
                    debug_assert!(corners.len() >= 3, "polygons have three corners");
                    // Sides of a counter-clockwise polygon have the solid on their left: swap their ends.
                    walls.extend(
                        outline
                            .sides()
                            .map(|s| if doubled_area > 0.0 { (s.b, s.a) } else { (s.a, s.b) })
                            .map(|(a, b)| Wall::new(a, b, lidar.max_range)),
                    );
                }
            }
        }
        let increment = lidar.increment();
        let beams = (0..lidar.beams)
            .map(|i| {
                let (sin, cos) = math::sin_cos(lidar.min_angle + increment * f64::from(i));
                Point::new(cos, sin)
            })
            .collect();
        Self {
            walls,
            circles,
            beams,
            min_angle: lidar.min_angle,
            increment,
            max_range: lidar.max_range,
        }
    }

    /// Computes the ranges (m) from `sensor` (world frame) without noise, first beam first; infinity where nothing lies
    /// within the longest range.
    pub fn cast(&self, sensor: Pose, ranges: &mut Vec<f64>) {
        ranges.clear();
        ranges.resize(self.beams.len(), f64::INFINITY);
        let (sin, cos) = math::sin_cos(sensor.heading);
        let local = |p: Point| {
            let (dx, dy) = (p.x - sensor.x, p.y - sensor.y);
            Point::new(cos * dx + sin * dy, cos * dy - sin * dx)
        };
        let in_sight = |wall: &&Wall| !wall.is_out_of_sight(sensor.position());
        for wall in self.walls.iter().filter(in_sight) {
            let (a, b) = (local(wall.a), local(wall.b));
            // Seen from its open side, a wall runs counter-clockwise around the sensor.
            let along = b - a;
            let numerator = a.cross(along);
            if numerator <= 0.0 || self.is_beyond(a, along, numerator) {
                continue;
            }
            // Rough angles suffice to choose candidates: which beams meet the wall is found exactly below.
            let (first, mut last) = (rough_angle(a) - ROUGHNESS, rough_angle(b) + ROUGHNESS);
            // Less than half a turn, because the wall is seen from its open side.
            if last < first {
                last += TAU;
            }
            for candidates in self.beams_between(first, last) {
                // Few do not meet it, at either end.
                let meets = |d: &Point| a.cross(*d) >= 0.0 && d.cross(b) >= 0.0;
                let beams = &self.beams[candidates.clone()];
                let before = beams.iter().take_while(|d| !meets(d)).count();
                let after = beams[before..].iter().rev().take_while(|d| !meets(d)).count();
                let meeting = candidates.start + before..candidates.end - after;
                let beams = &self.beams[meeting.clone()];
                for (nearest, direction) in ranges[meeting].iter_mut().zip(beams) {
                    let range = numerator / direction.cross(along);
                    *nearest = if range < *nearest { range } else { *nearest };
                }
            }
        }
        for &(center, radius) in &self.circles {
            let center = local(center);
            let distance = center.norm();
            if distance - radius > self.max_range || distance <= radius {
                continue;
            }
            let middle = math::atan2(center.y, center.x);
            let half = math::asin(radius / distance);
            for i in self.beams_between(middle - half, middle + half).flatten() {
                let direction = self.beams[i];
                let (along, beside) = (direction.dot(center), direction.cross(center));
                let inside = radius * radius - beside * beside;
                if along > 0.0 && inside >= 0.0 {
                    let range = along - inside.sqrt();
                    if range < ranges[i] {
                        ranges[i] = range;
                    }
                }
            }
        }
        for range in ranges {
            if *range > self.max_range {
                *range = f64::INFINITY;
            }
        }
    }

    /// Returns whether the wall from `a` along `along` lies wholly beyond the longest range.
    fn is_beyond(&self, a: Point, along: Point, numerator: f64) -> bool {
        let reach = self.max_range * self.max_range;
        let length_squared = along.norm_squared();
        // The line first, then the nearest end.
        numerator * numerator > reach * length_squared || {
            let t = (-a.dot(along) / length_squared).clamp(0.0, 1.0);
            (a + along * t).norm_squared() > reach
        }
    }

    /// Returns the beams between the angles `first` and `last` (rad, `last` ≥ `first`), with one more on either side for
    /// rounding: in up to three parts, for a wall may be met one turn further round, where the field of view crosses ±π.
    fn beams_between(&self, first: f64, last: f64) -> impl Iterator<Item = Range<usize>> {
        #[expect(clippy::cast_precision_loss, reason = "beam numbers are small")]
        let highest = self.beams.len() as f64 - 1.0;
        let number = |angle: f64| (angle - self.min_angle) / self.increment;
        [-TAU, 0.0, TAU].into_iter().filter_map(move |turn| {
            let (low, high) = (number(first + turn).max(0.0), number(last + turn).min(highest));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "both are beam numbers"
            )]
            (low < high + 1.0).then(|| low as usize..(high + 2.0).min(highest + 1.0) as usize)
        })
    }
}

/// How far off [`rough_angle`] may be (rad).
const ROUGHNESS: f64 = 0.0016;

/// Returns the angle of `direction` (rad, in (-π, π]) to within [`ROUGHNESS`]: an arctangent by a cubic in each eighth of
/// the circle (Rajan et al. 2006, "Efficient Approximations for the Arctangent Function", equation 9).
fn rough_angle(direction: Point) -> f64 {
    let (x, y) = (direction.x.abs(), direction.y.abs());
    let ratio = x.min(y) / x.max(y);
    let eighth = ratio * (FRAC_PI_4 + (1.0 - ratio) * (0.2447 + 0.0663 * ratio));
    let quarter = if y > x { FRAC_PI_2 - eighth } else { eighth };
    let half = if direction.x < 0.0 { PI - quarter } else { quarter };
    if direction.y < 0.0 { -half } else { half }
}

/// Adds Gaussian noise to the ranges that hit something, kept within the sensor's limits; as Gazebo does,
/// readings beyond the longest range stay infinite.
pub(super) fn add_noise(lidar: &Lidar, stream: &mut Stream, ranges: &mut [f64]) {
    for range in ranges.iter_mut().filter(|range| range.is_finite()) {
        let noise = if lidar.noise_sd > 0.0 { lidar.noise_sd * stream.normal() } else { 0.0 };
        *range = (*range + noise).clamp(lidar.min_range, lidar.max_range);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;
    use crate::rng::Seeds;
    use proptest::prelude::*;

    fn lidar(beams: u32, half_field: f64) -> Lidar {
        Lidar {
            name: "laser".into(),
            mount: Pose::default(),
            height: 0.16,
            beams,
            min_angle: -half_field,
            max_angle: half_field,
            min_range: 0.01,
            max_range: 30.0,
            rate_hz: 20.0,
            noise_sd: 0.0,
        }
    }

    proptest! {
        #[test]
        fn rough_angles_are_as_near_as_they_claim(angle in -PI..PI, length in 1e-6..1e3_f64) {
            let (sin, cos) = math::sin_cos(angle);
            let found = rough_angle(Point::new(cos, sin) * length);
            prop_assert!((found - angle).abs() < ROUGHNESS, "{found}");
        }
    }

    /// Returns the range of one beam by trying every side of every outline.
    fn brute_force(visible: &[Outline], origin: Point, direction: Point, max_range: f64) -> f64 {
        let nearest = visible
            .iter()
            .filter_map(|outline| match outline {
                Outline::Polygon(_) => outline
                    .sides()
                    .filter_map(|s: Segment| s.ray_range(origin, direction))
                    .min_by(f64::total_cmp),
                Outline::Circle { center, radius } => {
                    let to = *center - origin;
                    let (along, beside) = (to.dot(direction), to.cross(direction));
                    let inside = radius * radius - beside * beside;
                    (inside >= 0.0 && along > 0.0).then(|| along - inside.sqrt())
                }
            })
            .fold(f64::INFINITY, f64::min);
        if nearest > max_range { f64::INFINITY } else { nearest }
    }

    fn outlines() -> impl Strategy<Value = Vec<Outline>> {
        let wall = (-15.0..15.0, -15.0..15.0, 0.05..9.0, 0.05..1.0, -3.2..3.2)
            .prop_map(|(x, y, l, w, h)| Outline::rectangle(Point::new(x, y), l, w, h));
        let pillar = (-15.0..15.0, -15.0..15.0, 0.02..1.0)
            .prop_map(|(x, y, radius)| Outline::Circle { center: Point::new(x, y), radius });
        prop::collection::vec(prop_oneof![4 => wall, 1 => pillar], 1..30)
    }

    proptest! {
        /// Checks exactness: against every wall tried for every beam, within rounding.
        #[test]
        fn equals_brute_force(
            visible in outlines(), x in -10.0..10.0, y in -10.0..10.0, heading in -4.0..4.0,
            half_field in 0.3..3.1,
        ) {
            let sensor = Pose::new(x, y, heading);
            prop_assume!(visible.iter().all(|o| o.distance(sensor.position()) > 1e-3));
            let lidar = lidar(181, half_field);
            let mut ranges = Vec::new();
            WallSweep::new(&visible, &lidar).cast(sensor, &mut ranges);
            let mut grazing = 0;
            for (i, &range) in ranges.iter().enumerate() {
                #[expect(clippy::cast_precision_loss, reason = "small")]
                let angle = sensor.heading + lidar.min_angle + lidar.increment() * i as f64;
                let direction = Point::new(math::cos(angle), math::sin(angle));
                let expected = brute_force(&visible, sensor.position(), direction, lidar.max_range);
                // A beam that grazes a corner may be assigned to either side by rounding.
                if (range - expected).abs() > 1e-6 && range != expected {
                    grazing += 1;
                }
            }
            prop_assert!(grazing <= 1, "{grazing} beams differ");
        }
    }

    #[test]
    fn a_closed_room_lets_no_beam_out() {
        let thickness = 0.15;
        let room: Vec<Outline> = [
            (5.0, 0.0, thickness, 10.0),
            (-5.0, 0.0, thickness, 10.0),
            (0.0, 5.0, 10.0 + thickness, thickness),
            (0.0, -5.0, 10.0 + thickness, thickness),
        ]
        .map(|(x, y, l, w)| Outline::rectangle(Point::new(x, y), l, w, 0.0))
        .to_vec();
        let lidar = lidar(7200, PI);
        let mut ranges = Vec::new();
        WallSweep::new(&room, &lidar).cast(Pose::new(1.0, -2.0, 0.3), &mut ranges);
        assert!(ranges.iter().all(|r| r.is_finite()));
    }

    #[test]
    fn beyond_the_range_is_infinity_and_noise_leaves_it_so() {
        let mut lidar = lidar(3, 1.5);
        (lidar.max_range, lidar.noise_sd) = (4.0, 0.1);
        let wall = [Outline::rectangle(Point::new(4.5, 0.0), 1.0, 1.0, 0.0)];
        let mut ranges = Vec::new();
        let sweep = WallSweep::new(&wall, &lidar);
        sweep.cast(Pose::new(0.0, 0.0, 0.0), &mut ranges);
        assert_eq!(ranges, [f64::INFINITY, 4.0, f64::INFINITY]);
        let mut stream = Seeds::new(1, vec![]).stream("lidar-noise");
        sweep.cast(Pose::new(1.0, 0.0, 0.0), &mut ranges);
        add_noise(&lidar, stream.at(5), &mut ranges);
        assert!(ranges[0].is_infinite() && ranges[1] != 3.0 && (ranges[1] - 3.0).abs() < 0.6);
    }
}
