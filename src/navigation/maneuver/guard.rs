//! The last check of a command: nothing that the laser sees may come too near by the robot's own motion.

use super::rule::PilotRule;
use crate::geometry::{Bounds, Point};
use crate::math;
use crate::robot::Twist;

/// Instants at which the motion is tested.
const LOOKS: u32 = 3;
/// Shares of the linear speed that are tried, fastest first.
const SHARES: [f64; 4] = [1.0, 0.6, 0.3, 0.0];
/// A point must come nearer than by this (m) to count as coming.
const STILL: f64 = 1e-3;

/// Keeps the body clear of points.
#[derive(Debug, Clone, Default)]
pub(super) struct Guard {
    near: Vec<(Point, f64)>,
}

impl Guard {
    /// Limits the command: slows it down as far as needed so that no point of `points` (base frame) comes nearer to
    /// `body` than the clearance; at last a turn in place, and no motion where even that brings one near.
    pub(super) fn limit(
        &mut self,
        rule: &PilotRule,
        body: Bounds,
        points: impl Iterator<Item = Point>,
        command: Twist,
    ) -> Twist {
        if rule.guard_s <= 0.0 || command == Twist::STOP {
            return command;
        }
        let reach = rule.clearance_m + command.linear.abs() * rule.guard_s;
        // The area that the corners sweep in a turn is no farther away than the corners.
        let swing = body.min.norm().max(body.max.norm()) + reach;
        self.near.clear();
        for point in points.filter(|point| point.norm_squared() <= swing * swing) {
            self.near.push((point, gap(body, point)));
        }
        for share in SHARES {
            let slowed = Twist { linear: share * command.linear, angular: command.angular };
            if self.is_clear(rule, body, slowed) {
                return slowed;
            }
        }
        Twist::STOP
    }

    fn is_clear(&self, rule: &PilotRule, body: Bounds, command: Twist) -> bool {
        (1..=LOOKS).all(|look| {
            let time = rule.guard_s * f64::from(look) / f64::from(LOOKS);
            let (sin, cos) = math::sin_cos(command.angular * time);
            // The chord of the arc, which is as long as the arc for the small turns of one interval.
            let (half_sin, half_cos) = math::sin_cos(command.angular * time / 2.0);
            let way = command.linear * time;
            let moved = Point::new(way * half_cos, way * half_sin);
            self.near.iter().all(|&(point, now)| {
                let off = point - moved;
                let seen = Point::new(cos * off.x + sin * off.y, cos * off.y - sin * off.x);
                let then = gap(body, seen);
                then >= rule.clearance_m || then >= now - STILL
            })
        })
    }
}

/// Returns the distance (m) of `point` from the box `body`, the larger of its two parts; negative inside.
fn gap(body: Bounds, point: Point) -> f64 {
    let beyond = |value: f64, low: f64, high: f64| (low - value).max(value - high);
    beyond(point.x, body.min.x, body.max.x).max(beyond(point.y, body.min.y, body.max.y))
}
