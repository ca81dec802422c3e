//! The motion model of particles: increments of odometry with noise of their own (GMapping's `MotionModel`).

use crate::geometry::Pose;
use crate::rng::Stream;

/// Standard deviations of the noise added to an increment of odometry, per metre or radian of it.
///
/// GMapping draws once per increment, at each scan it receives, and so do we: over n increments of one metre in all the
/// deviations add up to `srr` / sqrt(n).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionNoise {
    /// Of translation, per metre moved.
    pub srr: f64,
    /// Of heading (rad), per metre moved.
    pub srt: f64,
    /// Of translation (m), per radian turned.
    pub str: f64,
    /// Of heading, per radian turned.
    pub stt: f64,
}

/// Share of `srr` that motion along one axis adds across (GMapping's constant).
const ACROSS: f64 = 0.3;

impl MotionNoise {
    /// Returns whether there is no noise.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Draws the pose of a particle at `pose` after odometry reads `increment` (in the robot's frame).
    pub(super) fn draw(&self, pose: Pose, increment: Pose, stream: &mut Stream) -> Pose {
        let (dx, dy, turn) = (increment.x.abs(), increment.y.abs(), increment.heading.abs());
        let (along, across, around) = (stream.normal(), stream.normal(), stream.normal());
        let x = self.srr * dx + self.str * turn + ACROSS * self.srr * dy;
        let y = self.srr * dy + self.str * turn + ACROSS * self.srr * dx;
        let heading = self.stt * turn + self.srt * increment.position().norm();
        pose.compose(Pose::new(
            increment.x + x * along,
            increment.y + y * across,
            increment.heading + heading * around,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    #[test]
    fn the_spread_is_what_the_parameters_say() {
        let noise = MotionNoise { srr: 0.1, srt: 0.2, str: 0.05, stt: 0.3 };
        let mut stream = Seeds::new(1, vec![]).stream("test");
        let n = 20_000;
        let mut squares = [0.0; 3];
        for _ in 0..n {
            let increment = Pose::new(0.5, 0.0, 0.2);
            let drawn = noise.draw(Pose::new(3.0, 4.0, 0.0), increment, &mut stream);
            let off = [drawn.x - 3.5, drawn.y - 4.0, drawn.heading - 0.2];
            for (sum, off) in squares.iter_mut().zip(off) {
                *sum += off * off / f64::from(n);
            }
        }
        let expected =
            [0.1 * 0.5 + 0.05 * 0.2, 0.05 * 0.2 + 0.3 * 0.1 * 0.5, 0.3 * 0.2 + 0.2 * 0.5];
        for (found, expected) in squares.map(f64::sqrt).into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.03, "{found}, expected {expected}");
        }
        let still = noise.draw(Pose::new(3.0, 4.0, 1.0), Pose::default(), &mut stream);
        assert_eq!(still, Pose::new(3.0, 4.0, 1.0), "a robot that stands is where it was");
    }
}
