//! Line segments: the walls a lidar sees.

use super::Point;

/// The straight line segment from `a` to `b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// First end (m).
    pub a: Point,
    /// Second end (m).
    pub b: Point,
}

impl Segment {
    /// Returns the segment from `a` to `b`.
    pub const fn new(a: Point, b: Point) -> Self {
        Self { a, b }
    }

    /// Returns the length (m).
    pub fn length(self) -> f64 {
        self.a.distance(self.b)
    }

    /// Returns the distance (m) from `point` to the nearest point of the segment.
    pub fn distance(self, point: Point) -> f64 {
        let along = self.b - self.a;
        let length_squared = along.norm_squared();
        if length_squared == 0.0 {
            return self.a.distance(point);
        }
        let t = ((point - self.a).dot(along) / length_squared).clamp(0.0, 1.0);
        (self.a + along * t).distance(point)
    }

    /// Returns the range (m) along the ray from `origin` in the unit `direction` to this segment, if it is hit.
    ///
    /// Parallel rays miss, even where they run along the segment: its neighbours at the ends are hit instead.
    pub fn ray_range(self, origin: Point, direction: Point) -> Option<f64> {
        let along = self.b - self.a;
        let denominator = direction.cross(along);
        if denominator == 0.0 {
            return None;
        }
        let to_a = self.a - origin;
        let range = to_a.cross(along) / denominator;
        let t = to_a.cross(direction) / denominator;
        (range >= 0.0 && (0.0..=1.0).contains(&t)).then_some(range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_hit_in_front_and_miss_behind_and_beside() {
        let wall = Segment::new(Point::new(2.0, -1.0), Point::new(2.0, 1.0));
        let forward = Point::new(1.0, 0.0);
        assert_eq!(wall.ray_range(Point::ZERO, forward), Some(2.0));
        assert_eq!(wall.ray_range(Point::ZERO, -forward), None);
        assert_eq!(wall.ray_range(Point::new(0.0, 1.5), forward), None);
        assert_eq!(wall.ray_range(Point::ZERO, Point::new(0.0, 1.0)), None);
        assert_eq!(wall.ray_range(Point::new(0.0, 1.0), forward), Some(2.0), "ends belong to it");
    }

    #[test]
    fn distance_is_to_the_nearest_point() {
        let wall = Segment::new(Point::new(0.0, 0.0), Point::new(4.0, 0.0));
        assert_eq!(wall.distance(Point::new(2.0, 3.0)), 3.0);
        assert_eq!(wall.distance(Point::new(7.0, 4.0)), 5.0);
        assert_eq!(Segment::new(Point::ZERO, Point::ZERO).distance(Point::new(3.0, 4.0)), 5.0);
    }
}
