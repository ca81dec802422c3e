//! Errors of the robot's estimated poses: absolute trajectory errors, with nothing aligned but the start.

use crate::geometry::Pose;

/// Measures of a trial whose mind estimates its pose: the error of position (m) over the scans taken into the map, root
/// mean square, median and largest, of the pose known at the time; root mean square of the trajectory as estimated in
/// the end; and of odometry alone.
pub const POSE_ERRORS: [&str; 5] = [
    "pose-error-m-rms",
    "pose-error-m-median",
    "pose-error-m-max",
    "pose-error-m-rms-in-the-end",
    "odometry-error-m-rms",
];

/// Poses at the scans that were taken into the map, in the frame of the manifest's start.
#[derive(Debug, Default)]
pub(super) struct PoseErrors {
    truth: Vec<Pose>,
    /// Squared errors of position (m^2) of the pose known at the time, and of odometry.
    online: Vec<f64>,
    odometry: Vec<f64>,
}

impl PoseErrors {
    /// Notes that a scan was taken into the map at `truth`, with the mind's pose estimated at `estimate` and odometry
    /// reading `odometry`.
    pub(super) fn note(&mut self, truth: Pose, estimate: Pose, odometry: Pose) {
        self.truth.push(truth);
        self.online.push(squared(truth, estimate));
        self.odometry.push(squared(truth, odometry));
    }

    /// Computes the measures of a trial whose mind estimates in the end that its scans were taken along `way`. None
    /// where no poses were estimated.
    pub(super) fn measures(&self, way: &[Pose]) -> Vec<(&'static str, f64)> {
        if way.is_empty() || way.len() != self.truth.len() {
            return Vec::new();
        }
        let in_the_end: Vec<f64> =
            self.truth.iter().zip(way).map(|(&truth, &pose)| squared(truth, pose)).collect();
        let mut sorted = self.online.clone();
        sorted.sort_by(f64::total_cmp);
        let values = [
            root_mean(&self.online),
            sorted[sorted.len() / 2].sqrt(),
            sorted.last().copied().unwrap_or(0.0).sqrt(),
            root_mean(&in_the_end),
            root_mean(&self.odometry),
        ];
        POSE_ERRORS.into_iter().zip(values).collect()
    }
}

fn squared(a: Pose, b: Pose) -> f64 {
    let off = a.position() - b.position();
    off.x * off.x + off.y * off.y
}

fn root_mean(squares: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "thousands")]
    let n = squares.len().max(1) as f64;
    (squares.iter().sum::<f64>() / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_told_of_the_time_and_of_the_end() {
        let at = |x: f64, y: f64| Pose::new(x, y, 0.3);
        let mut errors = PoseErrors::default();
        errors.note(at(0.0, 0.0), at(0.0, 0.0), at(0.0, 0.0));
        errors.note(at(1.0, 0.0), at(1.3, 0.4), at(1.0, 2.0));
        errors.note(at(2.0, 0.0), at(2.0, -0.2), at(5.0, 4.0));
        assert!(errors.measures(&[]).is_empty(), "nothing was estimated");
        let measures = errors.measures(&[at(0.0, 0.0), at(1.0, 0.1), at(2.0, 0.0)]);
        let of = |name: &str| measures.iter().find(|(n, _)| *n == name).unwrap().1;
        assert!((of("pose-error-m-rms") - (0.29_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((of("pose-error-m-median") - 0.2).abs() < 1e-12);
        assert!((of("pose-error-m-max") - 0.5).abs() < 1e-12);
        assert!((of("pose-error-m-rms-in-the-end") - (0.01_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((of("odometry-error-m-rms") - (29.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}
