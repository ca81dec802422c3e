//! The pilot: drives one leg after the other.
//!
//! Once a control period [`Pilot::control`] carries its state on by the last command and by what is sensed, computes the
//! wished command, lets the guard limit it, and backs off, gives up or goes on to the next phase where that held it up.
//!
//! The wish goes by the phase:
//! 1. Looking: turn once around, then stand.
//! 2. Settling: drive up to the vertex reached, then turn.
//! 3. Turning: turn in place towards the exit, then drive.
//! 4. Backing: drive backwards, then turn anew.
//! 5. Driving: turn the scan into the leg's frame, and follow the corridor's middle, the tag, or the door's axis.
//!
//! A door by the laser is passed in stages:
//! 1. Track the gap; without one, drive on towards the vertex behind it at half speed.
//! 2. Drive up to the stage before the door on its axis.
//! 3. Align in place; where the axis is aside, back off for another attempt.
//! 4. Pass: correct the offset up to the commitment distance, then keep the heading, until the body is through.

use super::door::{self, Gap};
use super::guard::Guard;
use super::heading::{self, Heading};
use super::outlook::Outlook;
use super::rule::{DoorGuidance, HeadingSource, PilotRule, SpeedLimits};
use super::{CONTROL_PERIOD, Leg, Opening, Sense, corridor};
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::math;
use crate::robot::Twist;
use std::f64::consts::TAU;

/// A vertex less far aside than this (m) is driven up to.
const HUB_ASIDE: f64 = 0.4;
/// A tracked door seen within this distance (m) of where it should be is the same one.
const SAME_DOOR: f64 = 0.25;
/// After this many scans that show it elsewhere or not at all the door is sought anew.
const LOST: u32 = 10;
/// Widths of corridors (m) whose middle is between both walls.
const CORRIDOR: std::ops::RangeInclusive<f64> = 1.0..=4.0;
/// Shortest distance ahead at which a door's axis is steered for (m), on it and aside.
const NEAREST_AIM: f64 = 0.3;
const AT_STAGE: f64 = 0.05;
/// Speed per distance (1/s) on the way up to a vertex or a door's stage.
const APPROACH: f64 = 2.0;

/// The phases of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Nothing: no leg, or given up.
    Standing,
    /// Turning once around, this much left (rad).
    Looking { left: f64 },
    /// Driving up to the vertex reported as reached, at this point of the base frame (m).
    Settling { hub: Point },
    /// Turning in place towards the exit.
    Turning,
    /// Along the corridor, or up to the door.
    Driving,
    /// Turning in place before a door.
    Aligning,
    /// In a door.
    Passing,
    /// From the door to the vertex.
    Leaving,
    /// Backwards, this far yet (m).
    Backing { left: f64 },
}

/// Drives legs closed-loop. There is one pilot per robot; it keeps its heading from leg to leg.
#[derive(Debug, Clone)]
pub struct Pilot {
    rule: PilotRule,
    body: Bounds,
    phase: Phase,
    leg: Option<Leg>,
    heading: Heading,
    command: Twist,
    /// The leg's end in the base frame, as last seen and carried on (m).
    target: Option<Point>,
    gap: Option<Gap>,
    lost: u32,
    /// Half the width of the corridor, as last seen (m).
    half_width: Option<f64>,
    held_up_s: f64,
    backed_off: u32,
    guard: Guard,
    seen: Outlook,
    ahead: Outlook,
}

impl Pilot {
    /// Creates a pilot for a body with this footprint (base frame), standing still.
    pub fn new(rule: PilotRule, footprint: &Outline) -> Self {
        Self {
            rule,
            body: footprint.bounds(),
            phase: Phase::Standing,
            leg: None,
            heading: Heading::UNKNOWN,
            command: Twist::STOP,
            target: None,
            gap: None,
            lost: 0,
            half_width: None,
            held_up_s: 0.0,
            backed_off: 0,
            guard: Guard::default(),
            seen: Outlook::default(),
            ahead: Outlook::default(),
        }
    }

    /// Begins a leg at the vertex to which the last leg led. Where that one is still ahead, the robot drives up to it
    /// before it turns.
    pub fn begin(&mut self, leg: Leg) {
        let rule = &self.rule;
        let turns =
            math::wrap_angle(leg.direction - self.heading.get()).abs() > rule.straight_on_rad;
        let ahead = |hub: &Point| {
            (rule.settled_m..rule.settle_within_m).contains(&hub.x) && hub.y.abs() < HUB_ASIDE
        };
        self.phase = match self.target.take().filter(ahead) {
            Some(hub) if turns => Phase::Settling { hub },
            _ => Phase::Turning,
        };
        self.leg = Some(leg);
        self.forget();
        self.backed_off = 0;
    }

    /// Begins to turn once around in place, so that the camera sees everything around.
    pub fn look_around(&mut self) {
        self.phase = Phase::Looking { left: TAU };
        self.leg = None;
    }

    /// Returns whether it turns in place: what is seen ahead is then not where the leg leads.
    pub fn is_turning_in_place(&self) -> bool {
        matches!(self.phase, Phase::Looking { .. } | Phase::Turning | Phase::Aligning)
    }

    /// Returns whether it stands still with nothing to do: not begun, having looked around, or having given the leg up.
    pub fn is_standing(&self) -> bool {
        self.phase == Phase::Standing
    }

    /// Returns how often it backed off on this leg.
    pub fn backed_off(&self) -> u32 {
        self.backed_off
    }

    /// Returns the estimated heading (rad).
    pub fn heading(&self) -> f64 {
        self.heading.get()
    }

    /// Computes the command for the next control period.
    pub fn control(&mut self, sense: &Sense<'_>) -> Twist {
        let period = CONTROL_PERIOD.seconds().get();
        self.seen.read(sense.scan);
        self.carry_on(sense, period);
        let wish = self.wish(period);
        let given = self.guard.limit(&self.rule, self.body, self.seen.points(), wish);
        self.notice_hold_up(wish, given, period);
        self.command = given;
        given
    }

    /// Updates the state by the last command and by what is sensed.
    fn carry_on(&mut self, sense: &Sense<'_>, period: f64) {
        let turned = self.command.angular * period;
        let moved = Pose::new(self.command.linear * period, 0.0, turned);
        let walls = match self.rule.heading {
            HeadingSource::Walls => heading::walls(&self.seen),
            HeadingSource::Compass => None,
        };
        let turned = self.heading.update(&self.rule, turned, sense.compass.heading, walls);
        self.target =
            sense.target.or_else(|| self.target.map(|target| moved.inverse_transform(target)));
        if let Phase::Settling { hub } = &mut self.phase {
            *hub = moved.inverse_transform(*hub);
        }
        if let Phase::Looking { left } = &mut self.phase {
            *left -= turned;
        }
        if let (Some(leg), Some(gap)) = (self.leg, &mut self.gap) {
            let (sin, cos) = math::sin_cos(self.heading.get() - leg.direction);
            gap.distance -= moved.x * cos;
            gap.middle -= moved.x * sin;
        }
    }

    /// Computes the command if nothing stood in the way.
    fn wish(&mut self, period: f64) -> Twist {
        // 1. Looking around.
        if let Phase::Looking { left } = self.phase {
            if left <= 0.0 {
                self.phase = Phase::Standing;
                return Twist::STOP;
            }
            let angular = (self.rule.turn_gain_per_s * left).min(self.rule.slow.angular_rad_s);
            return Twist { linear: 0.0, angular: angular.max(self.rule.creep_rad_s) };
        }
        let Some(leg) = self.leg else { return Twist::STOP };
        let off = math::wrap_angle(self.heading.get() - leg.direction);
        // 2. Settling at the vertex.
        if let Phase::Settling { hub } = self.phase {
            if hub.x > self.rule.settled_m {
                let linear = (APPROACH * hub.x).max(self.rule.creep_m_s);
                return Twist { linear: linear.min(leg.limits.linear_m_s), angular: 0.0 };
            }
            self.phase = Phase::Turning;
        }
        // 3. Turning towards the exit.
        if self.phase == Phase::Turning {
            if off.abs() > self.rule.turn_tolerance_rad {
                return self.turn(-off, leg.limits);
            }
            self.phase = Phase::Driving;
        }
        // 4. Backing off.
        if let Phase::Backing { left } = &mut self.phase {
            if *left > 0.0 {
                *left -= self.rule.back_off_m_s * period;
                return Twist { linear: -self.rule.back_off_m_s, angular: 0.0 };
            }
            self.phase = Phase::Turning;
            return Twist::STOP;
        }
        // 5. Driving, in the leg's frame.
        self.ahead.turn(&self.seen, off);
        let target = self.target.map(|target| {
            let (sin, cos) = math::sin_cos(off);
            Point::new(cos * target.x - sin * target.y, sin * target.x + cos * target.y)
        });
        let laser = self.rule.door_guidance == DoorGuidance::Laser;
        match (leg.opening, self.phase) {
            (_, Phase::Standing) => Twist::STOP,
            (Opening::Door, phase) if laser && phase != Phase::Leaving => {
                self.through_door(leg.limits, off, target)
            }
            (Opening::Door, _) => {
                self.follow(leg.limits, off, target.map_or(0.0, |target| target.y), target)
            }
            (Opening::Corridor, _) => {
                let middle = self.middle_of_corridor(target);
                self.follow(leg.limits, off, middle, target)
            }
        }
    }

    /// Returns the offset of the corridor's middle across the leg (m, to the left).
    fn middle_of_corridor(&mut self, target: Option<Point>) -> f64 {
        let fallback = target.map_or(0.0, |target| target.y);
        match corridor::sides(&self.ahead, self.rule.corridor_ahead_m) {
            [Some(left), Some(right)] if CORRIDOR.contains(&(left + right)) => {
                self.half_width = Some(f64::midpoint(left, right));
                (left - right) / 2.0
            }
            [Some(left), None] => self.half_width.map_or(fallback, |half| left - half),
            [None, Some(right)] => self.half_width.map_or(fallback, |half| half - right),
            _ => fallback,
        }
    }

    /// Follows the line along the leg that lies `aside` m to the left, up to the target.
    fn follow(&self, limits: SpeedLimits, off: f64, aside: f64, target: Option<Point>) -> Twist {
        if target.is_some_and(|target| target.x <= self.rule.stop_m) {
            return Twist::STOP;
        }
        let bound = self.rule.line_angle_rad;
        let wanted = math::atan2(aside, self.rule.lookahead_m).clamp(-bound, bound);
        self.steer(math::wrap_angle(wanted - off), limits)
    }

    /// Drives up to a door, aligns with it, and passes through it.
    fn through_door(&mut self, limits: SpeedLimits, off: f64, target: Option<Point>) -> Twist {
        // 1. The gap.
        self.track_door(target);
        let Some(gap) = self.gap else {
            // Nothing resembles a door yet: on towards the vertex behind it, slowly.
            let half = SpeedLimits { linear_m_s: limits.linear_m_s / 2.0, ..limits };
            return self.follow(half, off, target.map_or(0.0, |target| target.y), target);
        };
        let rule = self.rule;
        let aligned = gap.middle.abs() <= rule.door_offset_m && off.abs() <= rule.door_heading_rad;
        let to_stage = gap.distance - rule.door_stage_m;
        // 2. Up to the stage.
        if self.phase == Phase::Driving {
            if to_stage > 0.0 {
                // Straight for the stage where the axis is still aside, else along the axis.
                let aside = gap.middle.abs() > rule.door_offset_m;
                let nearest = if aside { AT_STAGE } else { NEAREST_AIM };
                let aim = to_stage.clamp(nearest, rule.lookahead_m);
                let wanted = math::atan2(gap.middle, aim);
                let mut twist = self.steer(math::wrap_angle(wanted - off), limits);
                if !aligned {
                    twist.linear = twist.linear.min((APPROACH * to_stage).max(rule.creep_m_s));
                }
                return twist;
            }
            self.phase = if aligned { Phase::Passing } else { Phase::Aligning };
        }
        // 3. Align.
        if self.phase == Phase::Aligning {
            if off.abs() > rule.turn_tolerance_rad.min(rule.door_heading_rad) {
                return self.turn(-off, limits);
            }
            if gap.middle.abs() > rule.door_offset_m {
                self.back_off();
                return Twist::STOP;
            }
            self.phase = Phase::Passing;
        }
        // 4. Pass.
        if gap.distance < self.body.min.x - rule.door_depth_m {
            self.phase = Phase::Leaving;
        }
        let wanted = if gap.distance > rule.door_commit_m {
            math::atan2(gap.middle, rule.door_lookahead_m)
                .clamp(-rule.door_angle_rad, rule.door_angle_rad)
        } else {
            0.0
        };
        self.steer(math::wrap_angle(wanted - off), limits)
    }

    /// Finds the door in the scan, or carries on the one found before.
    fn track_door(&mut self, target: Option<Point>) {
        let commit = self.rule.door_commit_m;
        if self.phase == Phase::Passing && self.gap.is_some_and(|gap| gap.distance < commit) {
            return;
        }
        let expected =
            self.gap.map(|gap| gap.middle).or(target.map(|target| target.y)).unwrap_or(0.0);
        let limit = target.map_or(f64::INFINITY, |target| target.x);
        let found = door::find(&self.ahead, &self.rule, expected, limit);
        match (self.gap, found) {
            (Some(old), Some(new))
                if (old.distance - new.distance).abs() <= SAME_DOOR
                    && (old.middle - new.middle).abs() <= SAME_DOOR =>
            {
                self.lost = 0;
                self.gap = Some(new);
            }
            (Some(_), _) => {
                self.lost += 1;
                if self.lost > LOST {
                    (self.gap, self.lost) = (None, 0);
                }
            }
            (None, found) => self.gap = found,
        }
    }

    /// Drives on, turning by `error` rad; turns in place where that is much.
    fn steer(&self, error: f64, limits: SpeedLimits) -> Twist {
        let share = (1.0 - error.abs() / self.rule.pivot_rad).max(0.0);
        let bound = limits.angular_rad_s;
        Twist {
            linear: limits.linear_m_s * share,
            angular: (self.rule.turn_gain_per_s * error).clamp(-bound, bound),
        }
    }

    /// Turns in place by `error` rad.
    fn turn(&self, error: f64, limits: SpeedLimits) -> Twist {
        let angular = (self.rule.turn_gain_per_s * error.abs()).max(self.rule.creep_rad_s);
        Twist { linear: 0.0, angular: angular.min(limits.angular_rad_s).copysign(error) }
    }

    /// Backs off, or ends the present phase, where the guard has held the robot up for long.
    fn notice_hold_up(&mut self, wish: Twist, given: Twist, period: f64) {
        let held_up =
            given == Twist::STOP && wish != Twist::STOP || wish.linear > 0.0 && given.linear == 0.0;
        self.held_up_s = if held_up { self.held_up_s + period } else { 0.0 };
        if self.held_up_s >= self.rule.blocked_s {
            match self.phase {
                // The vertex is as near as it gets.
                Phase::Settling { .. } => self.phase = Phase::Turning,
                Phase::Looking { .. } => self.phase = Phase::Standing,
                _ => self.back_off(),
            }
            self.held_up_s = 0.0;
        }
    }

    fn back_off(&mut self) {
        self.forget();
        self.backed_off += 1;
        self.phase = if self.backed_off > self.rule.back_off_times {
            Phase::Standing
        } else {
            Phase::Backing { left: self.rule.back_off_m }
        };
    }

    /// Forgets what was seen on the leg.
    fn forget(&mut self) {
        (self.gap, self.lost, self.half_width, self.held_up_s) = (None, 0, None, 0.0);
    }
}
