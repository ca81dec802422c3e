//! The operator: samples arcs ahead and drives the best one (prior-map facts, section 4, "Operator").
//!
//! 1. Every direction's arc is sampled up to the first point closer to an obstacle than the robot's radius.
//! 2. Its score is the mean of free distance, safety, conformance to the wish and continuity; the best direction is
//!    sought.
//! 3. The direction moves towards the best one by a bounded step.
//! 4. The free distance along it caps the speed; without any, the operator looks only for room for a while.
//!
//! A direction runs from -1 (turn right in place) over 0 (straight on) to 1 (turn left in place); between them
//! the robot follows an arc of radius cot(|direction| π/2) m, at most half a circle.

use super::LocalMap;
use crate::geometry::{Point, Pose};
use crate::math;
use crate::robot::Twist;
use crate::units::{Seconds, Tick};
use std::f64::consts::{FRAC_PI_2, PI};

/// The navigator's request to the operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// Desired direction, -1 to 1, positive to the left.
    pub direction: f64,
    /// Desired share of the highest speed, 0 to 1.
    pub speed: f64,
    /// Distance (m) to the place steered for: free distance beyond it is worth nothing.
    pub distance: f64,
}

/// Limits of the operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatorRule {
    /// Highest linear speed (m/s).
    pub max_linear: f64,
    /// Highest angular speed in place (rad/s).
    pub max_angular: f64,
    /// Arcs must keep this far from obstacles (m).
    pub robot_radius: f64,
    /// Distance beyond which obstacles do not matter (m).
    pub comfort_radius: f64,
}

/// Directions are tried in steps of a hundredth.
const STEPS: i32 = 100;
/// How many directions there are.
const DIRECTIONS: usize = 2 * STEPS as usize + 1;
/// The direction changes by at most this many steps per control cycle.
const AGILITY: i32 = 20;
/// Arcs are sampled every 5 cm ...
const SPACING: f64 = 0.05;
/// ... and free distance beyond this (m) is not worth more, ...
const ENOUGH: f64 = 2.0;
/// ... nor is less than this asked for, however near the place steered for is.
const AT_LEAST: f64 = 0.5;
/// How much less an obstacle matters per sample further away.
const DECAY: f64 = 0.97;
/// With less free distance than this (m) the robot does not move on.
const TOO_SHORT: f64 = 0.3;
/// How steeply closeness to obstacles becomes cost (1/m), as the released cost map's `cost_scaling_factor`.
const COST_SCALING: f64 = 10.0;
/// How long the operator looks only for room once it has none.
const RECOVERY: Seconds = Seconds(3.0);

/// Drives by sampling arcs.
#[derive(Debug, Clone)]
pub struct Operator {
    rule: OperatorRule,
    /// For each direction, from -1 to 1, the sample points of its arc in the robot's frame.
    arcs: Vec<Vec<Point>>,
    decay: Vec<f64>,
    /// Sine and cosine of what [`bent`] makes of each direction.
    bends: Vec<(f64, f64)>,
    /// Continuity by the number of steps that the direction changes.
    continuity: Vec<f64>,
    current: i32,
    recovering_until: Option<Tick>,
}

/// The outlook of an arc.
#[derive(Debug, Clone, Copy)]
struct Prospect {
    /// Free distance (m), at most the sampled length of the arc.
    free: f64,
    is_wholly_free: bool,
    safety: f64,
}

impl Operator {
    /// Creates an operator at rest, heading straight on.
    pub fn new(rule: OperatorRule) -> Self {
        let arcs: Vec<_> = (-STEPS..=STEPS).map(arc).collect();
        let longest = arcs.iter().map(Vec::len).max().unwrap_or(0);
        let decay = std::iter::successors(Some(1.0), |d| Some(d * DECAY)).take(longest).collect();
        let changed = |steps: i32| math::cos(FRAC_PI_2 * (f64::from(steps) / f64::from(2 * STEPS)));
        let continuity = (0..=2 * STEPS).map(changed).collect();
        let bends = (-STEPS..=STEPS).map(|direction| bent(share(direction))).collect();
        Self { rule, arcs, decay, bends, continuity, current: 0, recovering_until: None }
    }

    /// Computes the velocity for the next control cycle, with the robot at `pose` (odometry frame), in the steps of the
    /// module documentation.
    ///
    /// The best of all directions is sought, and the direction moves towards it as fast as it may.
    pub fn drive(&mut self, wish: Steering, pose: Pose, map: &LocalMap, now: Tick) -> Twist {
        let recovering = self.recovering_until.is_some_and(|until| now < until);
        let here = map.clearance(pose.position()).unwrap_or(0.0);
        // 1. Already too close, the robot may go on as long as it comes no closer.
        let needed = self.rule.robot_radius.min(here - SPACING / 2.0).max(SPACING);
        let asked = wish.distance.clamp(AT_LEAST, ENOUGH);
        let turn = math::sin_cos(pose.heading);
        let look = |direction: i32| self.prospect(direction, (pose, turn), needed, asked, map);
        // 2. The best of all directions.
        let best = self.best(wish, look, asked, recovering);
        // 3. A bounded step towards it.
        let direction = best.clamp(self.current - AGILITY, self.current + AGILITY);
        let prospect = look(direction);
        self.current = direction;
        // 4. The speed that the free distance allows.
        let cap = self.speed_cap(prospect);
        if cap < 0.1 && direction.abs() < STEPS && !recovering {
            self.recovering_until = Some(now + Tick::at_or_after(RECOVERY));
        }
        self.twist(direction, wish.speed, cap)
    }

    /// Returns the direction of the highest score, the first one of equals.
    ///
    /// What lies ahead is looked at only where the best outlook there could be would suffice: from the direction that would
    /// then be best to both sides, so that few are left after the first ones.
    fn best(
        &self,
        wish: Steering,
        look: impl Fn(i32) -> Prospect,
        asked: f64,
        recovering: bool,
    ) -> i32 {
        let wished = bent(wish.direction.clamp(-1.0, 1.0));
        let most = |direction: i32| {
            let prospect = self.best_prospect(direction);
            self.score(direction, wished, prospect, asked, recovering)
        };
        let mut bounds = [0.0; DIRECTIONS];
        let mut first = (f64::NEG_INFINITY, self.current);
        for (bound, direction) in bounds.iter_mut().zip(-STEPS..) {
            *bound = most(direction);
            if *bound > first.0 {
                first = (*bound, direction);
            }
        }
        let mut best = (f64::NEG_INFINITY, self.current);
        let outwards = (0..=2 * STEPS).flat_map(|off| [first.1 - off, first.1 + off]).skip(1);
        for direction in outwards {
            let Some(&bound) = usize::try_from(direction + STEPS).ok().and_then(|i| bounds.get(i))
            else {
                continue;
            };
            if bound < best.0 {
                continue;
            }
            let score = self.score(direction, wished, look(direction), asked, recovering);
            if score > best.0 || (score == best.0 && direction < best.1) {
                best = (score, direction);
            }
        }
        best.1
    }

    /// Returns what no outlook of `direction` exceeds: nothing in the way as far as its arc is sampled.
    fn best_prospect(&self, direction: i32) -> Prospect {
        #[expect(clippy::cast_precision_loss, reason = "few samples")]
        let free = self.arc(direction).len() as f64 * SPACING;
        Prospect { free, is_wholly_free: true, safety: 1.0 }
    }

    fn prospect(
        &self,
        direction: i32,
        (pose, (sin, cos)): (Pose, (f64, f64)),
        needed: f64,
        asked: f64,
        map: &LocalMap,
    ) -> Prospect {
        let points = self.arc(direction);
        let mut danger: f64 = 0.0;
        for (i, point) in points.iter().enumerate() {
            let at = Point::new(
                pose.x + cos * point.x - sin * point.y,
                pose.y + sin * point.x + cos * point.y,
            );
            let clearance = map.clearance(at).unwrap_or(0.0);
            #[expect(clippy::cast_precision_loss, reason = "few samples")]
            let free = i as f64 * SPACING;
            if clearance < needed {
                return Prospect { free, is_wholly_free: false, safety: 1.0 - danger };
            }
            if free <= asked && clearance < self.rule.comfort_radius {
                let over = (clearance - self.rule.robot_radius).max(0.0);
                danger = danger.max(math::exp(-COST_SCALING * over) * self.decay[i]);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "few samples")]
        let free = points.len() as f64 * SPACING;
        Prospect { free, is_wholly_free: true, safety: 1.0 - danger }
    }

    /// Returns the plain mean of free distance, safety, conformance and continuity; of the first two when recovering.
    ///
    /// Conformance is cos(π/2 (d |d| − w |w|)) of the direction d and the wished one w, by the sines and cosines of both.
    fn score(
        &self,
        direction: i32,
        wished: (f64, f64),
        prospect: Prospect,
        asked: f64,
        recovering: bool,
    ) -> f64 {
        if recovering {
            // Room to move, which turning in place does not gain.
            return f64::midpoint(prospect.free / ENOUGH, prospect.safety);
        }
        // A tight turn that is wholly free can always be continued.
        let way = if prospect.is_wholly_free { 1.0 } else { (prospect.free / asked).min(1.0) };
        let (sin, cos) = self.bends[Self::place(direction)];
        let conformance = cos * wished.1 + sin * wished.0;
        let continuity = self.continuity[direction.abs_diff(self.current) as usize];
        (way + prospect.safety + conformance + continuity) / 4.0
    }

    fn speed_cap(&self, prospect: Prospect) -> f64 {
        let cap = prospect.free / 2.0 + 0.05;
        let cap = if prospect.is_wholly_free {
            cap.max(0.5)
        } else if prospect.free < TOO_SHORT {
            0.0
        } else {
            cap
        };
        cap.min(self.rule.max_linear)
    }

    fn twist(&self, direction: i32, speed: f64, cap: f64) -> Twist {
        let side = f64::from(direction.signum());
        if direction.abs() == STEPS {
            return Twist { linear: 0.0, angular: side * speed * self.rule.max_angular };
        }
        if direction == 0 {
            return Twist { linear: (speed * self.rule.max_linear).min(cap), angular: 0.0 };
        }
        let radius = radius(direction);
        let linear = (speed * self.rule.max_linear / (1.0 + 1.0 / radius)).min(cap);
        Twist { linear, angular: side * (linear / radius) }
    }

    fn arc(&self, direction: i32) -> &[Point] {
        &self.arcs[Self::place(direction)]
    }

    /// Returns the place of `direction` among all.
    fn place(direction: i32) -> usize {
        #[expect(clippy::cast_sign_loss, reason = "directions are at least -STEPS")]
        let place = (direction + STEPS) as usize;
        place
    }
}

/// Returns the direction, counted in steps, as a number from -1 to 1.
fn share(direction: i32) -> f64 {
    f64::from(direction) / f64::from(STEPS)
}

/// Returns sine and cosine of π/2 d |d|, d the direction from -1 to 1.
fn bent(direction: f64) -> (f64, f64) {
    math::sin_cos(FRAC_PI_2 * (direction * direction.abs()))
}

/// Returns the radius (m) of the arc in `direction`, which is neither straight nor in place.
fn radius(direction: i32) -> f64 {
    1.0 / math::tan(share(direction.abs()) * FRAC_PI_2)
}

fn arc(direction: i32) -> Vec<Point> {
    if direction.abs() == STEPS {
        return Vec::new();
    }
    let side = f64::from(direction.signum());
    let length = if direction == 0 { ENOUGH } else { ENOUGH.min(PI * radius(direction)) };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 40")]
    let samples = (length / SPACING) as u32;
    (1..=samples)
        .map(|i| {
            let way = f64::from(i) * SPACING;
            if direction == 0 {
                return Point::new(way, 0.0);
            }
            let radius = radius(direction);
            let (sin, cos) = math::sin_cos(way / radius);
            Point::new(radius * sin, side * radius * (1.0 - cos))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::navigation::LocalRule;
    use crate::robot::Scan;
    use proptest::prelude::*;

    const RULE: OperatorRule = OperatorRule {
        max_linear: 1.0,
        max_angular: 1.0,
        robot_radius: 0.25,
        comfort_radius: 0.35,
    };

    fn map(mut ranges: impl FnMut(f64) -> f64) -> LocalMap {
        let mut map = LocalMap::new(LocalRule::default());
        let increment = 0.005;
        let scan = Scan {
            stamp: Tick(0),
            mount: Pose::default(),
            min_angle: -PI,
            increment,
            min_range: 0.0,
            max_range: 30.0,
            ranges: (0..1257).map(|i| ranges(-PI + f64::from(i) * increment)).collect(),
        };
        map.update(Pose::default(), &scan);
        map
    }

    fn settle(operator: &mut Operator, wish: Steering, map: &LocalMap) -> Twist {
        (0..20).map(|i| operator.drive(wish, Pose::default(), map, Tick(i * 300))).last().unwrap()
    }

    #[test]
    fn in_the_open_it_does_what_it_is_asked() {
        let open = map(|_| 20.0);
        let straight = Steering { direction: 0.0, speed: 1.0, distance: 2.0 };
        let twist = settle(&mut Operator::new(RULE), straight, &open);
        assert_eq!(twist, Twist { linear: 1.0, angular: 0.0 });
        let left = Steering { direction: 1.0, speed: 1.0, distance: 2.0 };
        assert_eq!(
            settle(&mut Operator::new(RULE), left, &open),
            Twist { linear: 0.0, angular: 1.0 }
        );
        let right = Steering { direction: -1.0, speed: 0.5, distance: 2.0 };
        assert_eq!(
            settle(&mut Operator::new(RULE), right, &open),
            Twist { linear: 0.0, angular: -0.5 }
        );
    }

    proptest! {
        #[test]
        fn the_best_direction_is_that_of_looking_everywhere(
            ends in prop::collection::vec(0.2..4.0, 1257),
            wish in (-1.0..1.0, 0.0..1.0, 0.1..3.0),
            current in -STEPS..=STEPS,
            recovering: bool,
        ) {
            let mut ends = ends.into_iter();
            let map = map(|_| ends.next().unwrap());
            let operator = Operator { current, ..Operator::new(RULE) };
            let wish = Steering { direction: wish.0, speed: wish.1, distance: wish.2 };
            let asked = wish.distance.clamp(AT_LEAST, ENOUGH);
            let look = |direction| {
                operator.prospect(direction, (Pose::default(), (0.0, 1.0)), 0.25, asked, &map)
            };
            let mut everywhere = (f64::NEG_INFINITY, current);
            for direction in -STEPS..=STEPS {
                let wished = bent(wish.direction);
                let score = operator.score(direction, wished, look(direction), asked, recovering);
                let off = share(direction) * share(direction).abs() - wish.direction * wish.direction.abs();
                let blind = Prospect { free: 0.0, is_wholly_free: false, safety: 0.0 };
                let continuity = operator.continuity[direction.abs_diff(current) as usize];
                let plain = (math::cos(FRAC_PI_2 * off) + continuity) / 4.0;
                prop_assert!((operator.score(direction, wished, blind, asked, false) - plain).abs() < 1e-15);
                if score > everywhere.0 {
                    everywhere = (score, direction);
                }
            }
            prop_assert_eq!(operator.best(wish, look, asked, recovering), everywhere.1);
        }
    }

    #[test]
    fn mirrored_surroundings_give_mirrored_commands() {
        let wall_left = map(|a| if (0.3..1.2).contains(&a) { 0.8 } else { 3.0 });
        let wall_right = map(|a| if (-1.2..-0.3).contains(&a) { 0.8 } else { 3.0 });
        let ask = |direction: f64, map: &LocalMap| {
            settle(&mut Operator::new(RULE), Steering { direction, speed: 1.0, distance: 2.0 }, map)
        };
        let (a, b) = (ask(0.4, &wall_left), ask(-0.4, &wall_right));
        assert!(
            (a.linear - b.linear).abs() < 0.05 && (a.angular + b.angular).abs() < 0.1,
            "{a:?} {b:?}"
        );
    }

    #[test]
    fn it_does_not_drive_into_a_wall_ahead() {
        let wall = map(|a| if a.abs() < 1.4 { 0.45 / math::cos(a) } else { 3.0 });
        let twist = settle(
            &mut Operator::new(RULE),
            Steering { direction: 0.0, speed: 1.0, distance: 2.0 },
            &wall,
        );
        assert!(twist.linear < 0.3, "{twist:?}");
    }
}
