//! The directions of a scan's beams.

use super::Scan;
use crate::geometry::Point;
use crate::math;

/// Unit directions of beams in the sensor's frame, computed once for all scans of one shape.
#[derive(Debug, Clone, Default)]
pub struct BeamDirections {
    /// Direction of the first beam and angle between beams (rad).
    shape: Option<(f64, f64)>,
    directions: Vec<Point>,
}

impl BeamDirections {
    /// Returns the directions of the beams of `scan`, first beam first.
    pub fn of(&mut self, scan: &Scan) -> &[Point] {
        let shape = Some((scan.min_angle, scan.increment));
        if self.shape != shape || self.directions.len() != scan.ranges.len() {
            self.shape = shape;
            self.directions.clear();
            self.directions.extend((0..scan.ranges.len()).map(|i| {
                let (sin, cos) = math::sin_cos(scan.angle(i));
                Point::new(cos, sin)
            }));
        }
        &self.directions
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::units::Tick;

    #[test]
    fn scans_of_another_shape_have_other_directions() {
        let scan = |min_angle: f64, increment: f64, beams: usize| Scan {
            stamp: Tick(0),
            mount: Pose::default(),
            min_angle,
            increment,
            min_range: 0.1,
            max_range: 9.0,
            ranges: vec![1.0; beams],
        };
        let mut directions = BeamDirections::default();
        for scan in [scan(-1.0, 0.5, 5), scan(-1.0, 0.5, 4), scan(0.0, 0.5, 4), scan(0.0, 0.25, 4)]
        {
            let found = directions.of(&scan).to_vec();
            let expected = (0..scan.ranges.len()).map(|i| scan.angle(i));
            let angles = found.iter().map(|direction| math::atan2(direction.y, direction.x));
            assert!(angles.zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12));
            assert_eq!(found.len(), scan.ranges.len());
        }
    }
}
