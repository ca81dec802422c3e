//! Rigid placements in space.

use crate::math;
use serde::Serialize;

/// A rigid placement in space: SDF's `x y z roll pitch yaw`, fixed axes, applied roll first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Placement {
    /// Translation (m).
    pub translation: [f64; 3],
    /// Rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
}

impl Placement {
    /// No translation and no rotation.
    pub const IDENTITY: Self = Self {
        translation: [0.0; 3],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// Creates a placement from SDF's six numbers (m, rad): R = Rz(yaw) Ry(pitch) Rx(roll).
    pub fn from_xyz_rpy([x, y, z, roll, pitch, yaw]: [f64; 6]) -> Self {
        let (sr, cr) = math::sin_cos(roll);
        let (sp, cp) = math::sin_cos(pitch);
        let (sy, cy) = math::sin_cos(yaw);
        Self {
            translation: [x, y, z],
            rotation: [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ],
        }
    }

    /// Creates a placement from a translation (m) and a quaternion `x y z w`, which need not be of length 1; no rotation
    /// where it has none.
    pub fn from_xyz_quaternion(translation: [f64; 3], [x, y, z, w]: [f64; 4]) -> Self {
        let norm = x * x + y * y + z * z + w * w;
        if !(norm.is_finite() && norm > 0.0) {
            return Self { translation, ..Self::IDENTITY };
        }
        let s = 2.0 / norm;
        Self {
            translation,
            rotation: [
                [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
                [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
                [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
            ],
        }
    }

    /// Returns the placement of the outer frame in this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let r = &self.rotation;
        let rotation = [0, 1, 2].map(|i: usize| [r[0][i], r[1][i], r[2][i]]);
        let turned = Self { translation: [0.0; 3], rotation };
        Self { translation: turned.apply(self.translation).map(|v| 0.0 - v), rotation }
    }

    /// Transforms a point from the placed frame to the outer one.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let mut out = self.translation;
        for (value, row) in out.iter_mut().zip(&self.rotation) {
            *value += row[0] * point[0] + row[1] * point[1] + row[2] * point[2];
        }
        out
    }

    /// Returns the placement `inner`, given in this one's frame, in the outer frame.
    #[must_use]
    pub fn compose(&self, inner: &Self) -> Self {
        let mut rotation = [[0.0; 3]; 3];
        for (i, row) in rotation.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = (0..3).map(|k| self.rotation[i][k] * inner.rotation[k][j]).sum();
            }
        }
        Self { translation: self.apply(inner.translation), rotation }
    }

    /// Returns whether its z axis points straight up or straight down.
    pub fn is_upright(&self) -> bool {
        self.rotation[2][2].abs() == 1.0
    }

    /// Returns the heading (rad) of the placed x axis seen from above.
    pub fn yaw(&self) -> f64 {
        math::atan2(self.rotation[1][0], self.rotation[0][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn composed_placements_apply_inner_first() {
        let outer = Placement::from_xyz_rpy([1.0, 0.0, 0.0, 0.0, 0.0, FRAC_PI_2]);
        let inner = Placement::from_xyz_rpy([2.0, 0.0, 0.0, 0.1, 0.2, 0.3]);
        let composed = outer.compose(&inner).apply([0.5, -0.25, 2.0]);
        let stepwise = outer.apply(inner.apply([0.5, -0.25, 2.0]));
        for (a, b) in composed.iter().zip(stepwise) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn an_inverse_undoes_and_a_quaternion_turns_as_its_angles_do() {
        let there = Placement::from_xyz_rpy([1.0, -2.0, 0.5, 0.4, -0.3, 2.0]);
        let back = there.compose(&there.inverse());
        let close = |a: &Placement, b: &Placement| {
            let numbers = |p: &Placement| [p.rotation.as_flattened(), &p.translation].concat();
            numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(close(&back, &Placement::IDENTITY), "{back:?}");
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quarter = Placement::from_xyz_quaternion([1.0, 2.0, 3.0], [0.0, 0.0, half, half]);
        assert!(close(&quarter, &Placement::from_xyz_rpy([1.0, 2.0, 3.0, 0.0, 0.0, FRAC_PI_2])));
        let none = Placement::from_xyz_quaternion([1.0, 2.0, 3.0], [0.0; 4]);
        assert_eq!(none.rotation, Placement::IDENTITY.rotation);
    }

    #[test]
    fn a_yawed_placement_stays_upright_and_a_rolled_one_does_not() {
        let yawed = Placement::from_xyz_rpy([0.0, 0.0, 1.0, 0.0, -0.0, 1.25]);
        assert!(yawed.is_upright() && (yawed.yaw() - 1.25).abs() < 1e-15);
        assert!(!Placement::from_xyz_rpy([0.0, 0.0, 0.0, 0.1, 0.0, 0.0]).is_upright());
    }
}
