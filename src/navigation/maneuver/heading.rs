//! The heading, from turning commands, the compass and the walls.

use super::outlook::Outlook;
use super::rule::{HeadingSource, PilotRule};
use crate::geometry::Point;
use crate::math;
use std::f64::consts::FRAC_PI_2;

/// A complementary filter: the commands carry the heading from step to step, the compass and the walls correct it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading {
    estimate: Option<f64>,
}

impl Heading {
    pub(super) const UNKNOWN: Self = Self { estimate: None };

    /// Returns the heading (rad); east before the first reading.
    pub(super) fn get(self) -> f64 {
        self.estimate.unwrap_or(0.0)
    }

    /// Carries the heading on by a turn that was commanded, and corrects it by a reading and, where walls are seen, by
    /// their direction in the base frame (rad). Returns by how much the heading has changed (rad).
    pub(super) fn update(
        &mut self,
        rule: &PilotRule,
        turned: f64,
        compass: f64,
        walls: Option<f64>,
    ) -> f64 {
        let Some(before) = self.estimate else {
            // A first reading off by less than 45 degrees gives the quarter; the walls give the rest.
            let corrected = walls.map_or(compass, |walls| compass + off_square(walls + compass));
            self.estimate = Some(math::wrap_angle(corrected));
            return 0.0;
        };
        let mut estimate = before + turned;
        estimate += rule.compass_gain * math::wrap_angle(compass - estimate);
        if rule.heading == HeadingSource::Walls
            && let Some(walls) = walls
        {
            estimate += rule.wall_gain * off_square(walls + estimate);
        }
        self.estimate = Some(math::wrap_angle(estimate));
        estimate - before
    }
}

/// Returns by how much (rad) a wall at this `angle` must be turned to be square with the building: within an eighth of
/// a turn.
fn off_square(angle: f64) -> f64 {
    (angle / FRAC_PI_2).round() * FRAC_PI_2 - angle
}

/// Beams between the two ends of a chord of the scan.
const CHORD: usize = 8;
/// Longest chord that weighs more than shorter ones (m), and the longest that is one wall.
const WEIGHTY: f64 = 0.5;
const LONGEST: f64 = 2.0;
/// Largest distance of a chord's middle beam from it (m): beyond it there is a corner between.
const STRAIGHT: f64 = 0.02;
/// Least coherence of the chords' directions, 0 to 1: below it the surroundings are not square.
const COHERENT: f64 = 0.6;
/// Fewest chords.
const FEWEST: u32 = 12;

/// Returns the direction (rad, modulo a quarter turn, within an eighth of it) in which the walls run in the frame of
/// `outlook`; `None` where too little is straight and square.
///
/// It is the mean over chords of the scan, of their directions taken four times, weighed by the square of their
/// lengths: noise of the ranges turns short chords more.
pub(super) fn walls(outlook: &Outlook) -> Option<f64> {
    let (mut sum, mut weights, mut count) = (Point::ZERO, 0.0, 0);
    for i in 0..outlook.ends.len().saturating_sub(CHORD) {
        let j = i + CHORD;
        if !(outlook.hits[i] && outlook.hits[i + CHORD / 2] && outlook.hits[j]) {
            continue;
        }
        let (a, middle, b) = (outlook.ends[i], outlook.ends[i + CHORD / 2], outlook.ends[j]);
        let along = b - a;
        let squared = along.norm_squared();
        let off = (middle - a).cross(along);
        if squared > LONGEST * LONGEST || off * off > STRAIGHT * STRAIGHT * squared {
            continue;
        }
        let weight = squared.min(WEIGHTY * WEIGHTY);
        if squared > 0.0 {
            let twice = square(along * (1.0 / squared.sqrt()));
            sum = sum + square(twice) * weight;
            weights += weight;
            count += 1;
        }
    }
    (count >= FEWEST && sum.norm() >= COHERENT * weights).then(|| math::atan2(sum.y, sum.x) / 4.0)
}

/// Returns the unit vector of twice the angle.
fn square(direction: Point) -> Point {
    Point::new(
        direction.x * direction.x - direction.y * direction.y,
        2.0 * direction.x * direction.y,
    )
}
