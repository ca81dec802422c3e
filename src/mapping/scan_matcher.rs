//! Matching a scan to a particle's map: the pose at which it fits best, and its likelihood there (GMapping's
//! `ScanMatcher`).
//!
//! The search, [`ScanMatcher::climb`], is hill climbing:
//! 1. Score the scan at the pose that odometry gives.
//! 2. Where the last round did not improve the score, halve the steps.
//! 3. Try a step forwards, backwards, left, right and a turn to either side, all from the pose of this round.
//! 4. Move to the best of the six if it scores higher than the pose of this round.
//! 5. Repeat from 2 until a round brings no improvement after the last halving; then test the score against the
//!    minimum.

use super::beams::{Beams, LANES, Turned};
use super::hit_map::MAX_KERNEL;
use super::tile::{CELL_BITS, Place};
use super::window::Window;
use crate::geometry::Pose;
use crate::math;

/// The parameters by which scans are matched to maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchRule {
    /// First step of the search along x and y (m); GMapping's `lstep`.
    pub linear_step: f64,
    /// First step of the search in heading (rad); `astep`.
    pub angular_step: f64,
    /// How often steps are halved; `iterations`.
    pub iterations: u32,
    /// A beam that ends d m from the nearest mean scores exp(-d^2 / this) (m^2, above 0); `sigma`.
    pub sigma: f64,
    /// Cells to either side in which a mean is sought, 10 at most; `kernelSize`.
    pub kernel: u32,
    /// The pose found is used where the scan's score there is above this (0 to the number of beams); `minimumScore`.
    pub minimum_score: f64,
    /// ... and its log likelihood is the sum of -d^2 / this (m^2, above 0); `lsigma`.
    pub likelihood_sigma: f64,
    /// Beams left out between two that are looked at; `lskip`.
    pub skip: u32,
}

impl MatchRule {
    /// The defaults with which GMapping searches (those of `slam_gmapping`, but for the minimum score).
    pub const GMAPPING: Self = Self {
        linear_step: 0.05,
        angular_step: 0.05,
        iterations: 5,
        sigma: 0.05,
        kernel: 1,
        minimum_score: 0.0,
        likelihood_sigma: 0.075,
        skip: 0,
    };

    /// Returns whether the search can move at all.
    pub fn searches(&self) -> bool {
        self.linear_step > 0.0 || self.angular_step > 0.0
    }
}

/// A beam without a mean in its window counts in the likelihood as if it were this far off (m^2); GMapping's constant.
const NO_HIT: f64 = 0.5;
/// The highest score of a beam.
const FULL: u16 = u16::MAX;
/// Entries of the table that are looked at, and all of them: squared distances, shifted down, are below the second.
const SCORED: usize = 4095;
const TABLE: usize = 1 << 15;

/// Scores and likelihoods of beams, as whole numbers.
#[derive(Debug)]
pub(super) struct ScanMatcher {
    rule: MatchRule,
    /// Units in a metre.
    scale: f64,
    /// Score by squared distance (units), shifted down; 0 beyond the window.
    scores: Box<[u16; TABLE]>,
    shift: u32,
    /// Squared distances (units) up to this are within the window.
    window: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Move {
    Front,
    Back,
    Left,
    Right,
    TurnLeft,
    TurnRight,
}

impl Move {
    /// In GMapping's order: of equal moves the first wins.
    const ALL: [Self; 6] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::TurnLeft, Self::TurnRight];

    fn back(self) -> Self {
        match self {
            Self::Front => Self::Back,
            Self::Back => Self::Front,
            Self::Left => Self::Right,
            Self::Right => Self::Left,
            Self::TurnLeft => Self::TurnRight,
            Self::TurnRight => Self::TurnLeft,
        }
    }

    /// Returns the side to which it turns, if it does.
    fn side(self) -> Option<usize> {
        match self {
            Self::TurnLeft => Some(0),
            Self::TurnRight => Some(1),
            _ => None,
        }
    }

    /// Returns the pose after the move; x and y are the map's.
    fn from(self, pose: Pose, linear: f64, angular: f64) -> Pose {
        let Pose { x, y, heading } = pose;
        match self {
            Self::Front => Pose { x: x + linear, ..pose },
            Self::Back => Pose { x: x - linear, ..pose },
            Self::Left => Pose { y: y - linear, ..pose },
            Self::Right => Pose { y: y + linear, ..pose },
            Self::TurnLeft => Pose::new(x, y, heading + angular),
            Self::TurnRight => Pose::new(x, y, heading - angular),
        }
    }
}

impl ScanMatcher {
    /// Creates a matcher for maps with cells of `resolution` m.
    pub(super) fn new(rule: MatchRule, resolution: f64) -> Self {
        let cell = f64::from(1_u32 << CELL_BITS);
        let scale = cell / resolution;
        let side = (rule.kernel.min(MAX_KERNEL) + 1) << CELL_BITS;
        let window = 2 * side * side;
        let shift = (0..32).find(|shift| ((window >> shift) as usize) < SCORED).unwrap_or(0);
        let Ok(mut scores) = Box::<[u16; TABLE]>::try_from(vec![0; TABLE]) else {
            unreachable!("it has this length")
        };
        for (index, score) in (0_u32..).zip(scores.iter_mut()) {
            if index << shift <= window {
                // The middle of the squared distances that share the entry.
                let squared = (f64::from(index << shift) + f64::from((1_u32 << shift) - 1) / 2.0)
                    / (scale * scale);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "between 0 and the full score"
                )]
                let value = (f64::from(FULL) * math::exp(-squared / rule.sigma) + 0.5) as u16;
                *score = value;
            }
        }
        Self { rule, scale, scores, shift, window }
    }

    /// Returns the number of units in a metre.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// Finds the pose near `from` where the scan's score is highest, by hill climbing (steps in the module
    /// documentation), and whether the score there is high enough.
    pub(super) fn climb(
        &self,
        window: &mut Window<'_>,
        beams: &mut Beams,
        from: Pose,
    ) -> (Pose, bool) {
        // 1. The score at the start.
        let mut pose = from;
        beams.turn(pose.heading, self.scale);
        let mut score = self.score(window, &beams.here, self.place(pose), None);
        let (mut linear, mut angular) = (self.rule.linear_step, self.rule.angular_step);
        let (mut before, mut halved) = (None, 0);
        let mut came_by: Option<Move> = None;
        loop {
            // 2. Halve the steps where nothing was gained.
            if before.is_some_and(|before| before >= score) {
                halved += 1;
                linear *= 0.5;
                angular *= 0.5;
                came_by = None;
            }
            before = Some(score);
            // 3. Try the six steps from the same pose.
            let (start, mut found) = (pose, None);
            for step in Move::ALL {
                // The step back, of the same size, is known to be worse.
                if came_by.is_some_and(|came_by| step == came_by.back()) {
                    continue;
                }
                let there = step.from(start, linear, angular);
                let ends = match step.side() {
                    Some(side) => {
                        beams.turn_aside(side, there.heading, self.scale);
                        &beams.aside[side]
                    }
                    None => &beams.here,
                };
                // 4. The best of the six so far becomes the pose.
                let reached = self.score(window, ends, self.place(there), Some(score));
                if reached > score {
                    (score, pose, found) = (reached, there, Some(step));
                }
            }
            if let Some(side) = found.and_then(Move::side) {
                beams.adopt(side);
            }
            // 5. Go on until the finest steps bring no gain.
            came_by = found;
            if before.is_some_and(|before| score <= before) && halved >= self.rule.iterations {
                let matched = f64::from(score) / f64::from(FULL);
                return (pose, matched > self.rule.minimum_score);
            }
        }
    }

    /// Computes the log likelihood of the scan with the robot at `pose`.
    pub(super) fn log_likelihood(
        &self,
        window: &mut Window<'_>,
        beams: &mut Beams,
        pose: Pose,
    ) -> f64 {
        beams.turn(pose.heading, self.scale);
        let at = self.place(pose);
        window.reach(&beams.here, at);
        let (mut squares, mut missed, mut left) = (0_u64, 0_u32, beams.here.count());
        for go in beams.here.goes() {
            for squared in window.squared_distances(go, at).into_iter().take(left) {
                if squared <= self.window {
                    squares += u64::from(squared);
                } else {
                    missed += 1;
                }
            }
            left = left.saturating_sub(LANES);
        }
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
        let squared_metres = squares as f64 / (self.scale * self.scale);
        -(squared_metres + NO_HIT * f64::from(missed)) / self.rule.likelihood_sigma
    }

    fn place(&self, pose: Pose) -> Place {
        Place::of(pose.position(), self.scale)
    }

    /// Scores beams that end at `ends` from `at`. Where the score can no longer be above `floor`, returns something not
    /// above it.
    fn score(&self, window: &mut Window<'_>, ends: &Turned, at: Place, floor: Option<u32>) -> u32 {
        window.reach(ends, at);
        let mut sum = 0;
        let mut left = ends.count();
        for go in ends.goes() {
            let squares = window.squared_distances(go, at);
            let score =
                |squared: &u32| u32::from(self.scores[(squared >> self.shift) as usize % TABLE]);
            if left >= LANES {
                sum += squares.iter().map(score).sum::<u32>();
            } else {
                sum += squares[..left].iter().map(score).sum::<u32>();
            }
            left = left.saturating_sub(LANES);
            let most = u32::try_from(left).unwrap_or(u32::MAX).saturating_mul(FULL.into());
            if floor.is_some_and(|floor| sum.saturating_add(most) <= floor) {
                break;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::hit_map::HitMap;
    use crate::mapping::room;
    use proptest::prelude::*;

    const RULE: MatchRule = MatchRule::GMAPPING;

    /// Returns a map of the room, and the beams of a scan taken at `pose` in it.
    fn seen(pose: Pose) -> (ScanMatcher, HitMap, Beams) {
        let matcher = ScanMatcher::new(RULE, 0.05);
        let mut map = HitMap::new(RULE.kernel);
        // The whole room, as otherwise the ends of the known walls would draw the scan along.
        for i in 0..12 {
            let (x, y) = [(0.3, 0.1), (-1.0, 0.5), (1.0, -0.6)][i % 3];
            let place = Pose::new(x, y, [0.0, 1.6, 3.2, 4.8][i / 3]);
            let hits = room::ends(place);
            let places: Vec<_> =
                hits.iter().map(|&hit| Place::of(place.transform(hit), matcher.scale())).collect();
            map.register(&places);
        }
        let mut beams = Beams::default();
        beams.take(room::ends(pose).into_iter());
        (matcher, map, beams)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn a_scan_in_a_known_room_tells_where_it_was_taken(
            x in -1.0..1.0, y in -0.8..0.8, heading in -3.0..3.0,
            dx in -0.04..0.04, dy in -0.04..0.04, turn in -0.03..0.03,
        ) {
            let truth = Pose::new(x, y, heading);
            let (matcher, map, mut beams) = seen(truth);
            let from = Pose::new(x + dx, y + dy, heading + turn);
            let (found, fits) = matcher.climb(&mut Window::over(&map), &mut beams, from);
            prop_assert!(fits);
            // Within a cell: the map is of three scans that met the walls at different places.
            let off = found.position().distance(truth.position());
            prop_assert!(off < 0.05, "{off} m off");
            prop_assert!(math::wrap_angle(found.heading - heading).abs() < 0.02);
        }

        #[test]
        fn giving_up_early_never_hides_a_winner(
            dx in -0.1..0.1, dy in -0.1..0.1, turn in -0.1..0.1, floor in 0_u32..12_000_000,
        ) {
            let (matcher, map, mut beams) = seen(Pose::default());
            let pose = Pose::new(dx, dy, turn);
            beams.turn(pose.heading, matcher.scale);
            let window = &mut Window::over(&map);
            let whole = matcher.score(window, &beams.here, matcher.place(pose), None);
            let early = matcher.score(window, &beams.here, matcher.place(pose), Some(floor));
            let right = if whole > floor { early == whole } else { early <= floor };
            prop_assert!(right, "{early} of {whole}, floor {floor}");
        }
    }

    #[test]
    fn the_score_is_the_sum_of_the_formula_and_a_poor_one_is_told() {
        let (matcher, map, mut beams) = seen(Pose::default());
        beams.turn(0.0, matcher.scale);
        let window = &mut Window::over(&map);
        let score = matcher.score(window, &beams.here, matcher.place(Pose::default()), None);
        let ends = room::ends(Pose::default());
        let expected: f64 = ends
            .iter()
            .map(|&end| map.squared_distance(Place::of(end, matcher.scale)))
            .filter(|&squared| squared <= matcher.window)
            .map(|squared| {
                math::exp(-f64::from(squared) / matcher.scale / matcher.scale / RULE.sigma)
            })
            .sum();
        let found = f64::from(score) / f64::from(FULL);
        assert!((found / expected - 1.0).abs() < 1e-3, "{found}, expected {expected}");
        // No beam scores above 1: a bar of as many as there are is never passed.
        let strict = ScanMatcher::new(MatchRule { minimum_score: 180.0, ..RULE }, 0.05);
        assert!(!strict.climb(&mut Window::over(&map), &mut beams, Pose::default()).1);
        let far = Pose::new(50.0, 0.0, 0.0);
        assert_eq!(
            matcher.log_likelihood(&mut Window::over(&map), &mut beams, far),
            -(0.5 * 180.0) / 0.075
        );
    }
}
