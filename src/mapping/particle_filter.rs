//! The Rao-Blackwellised particle filter: each particle is a trajectory of the robot with the map that follows from it
//! (Grisetti, Stachniss, Burgard 2007; GMapping's `GridSlamProcessor`).
//!
//! One scan is one [`ParticleFilter::advance`]:
//! 1. Every particle moves by the increments of odometry, with noise of its own.
//! 2. Where matching is on, it climbs to the pose at which the scan fits its map best, and keeps that pose if the score
//!    suffices.
//! 3. Its weight takes in the likelihood of the scan there.
//! 4. It takes the scan into its map.
//! 5. Particles are drawn anew where too few of them count (Grisetti et al. 2007, section 4.2), and the likeliest so far
//!    becomes the best.

use super::beam_ends::BeamEnds;
use super::beams::{Beams, Points};
use super::hit_map::HitMap;
use super::motion_model::MotionNoise;
use super::resampling::{effective, normalised, systematic};
use super::scan_matcher::{MatchRule, ScanMatcher};
use super::tile::Place;
use super::trajectories::{NodeId, Trajectories};
use super::window::Window;
use crate::geometry::Pose;
use crate::rng::Stream;

/// The numbers of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterRule {
    /// How many particles, at least 1.
    pub particles: u32,
    /// How particles move.
    pub motion: MotionNoise,
    /// How each particle matches scans to its map.
    pub matching: MatchRule,
    /// Weights are smoothed by this (above 0); GMapping's `ogain`.
    pub likelihood_gain: f64,
    /// Particles are drawn anew where their effective number falls below this share; `resampleThreshold`.
    pub resample_threshold: f64,
}

impl FilterRule {
    /// Returns whether odometry is trusted: then there is one trajectory, and it is known.
    pub fn trusts_odometry(&self) -> bool {
        self.particles <= 1 && self.motion.is_none() && !self.matching.searches()
    }
}

#[derive(Debug, Clone)]
struct Particle {
    pose: Pose,
    map: HitMap,
    /// Log likelihood since particles were last drawn.
    log_weight: f64,
    /// Log likelihood since the beginning.
    total: f64,
    node: Option<NodeId>,
}

/// The filter.
#[derive(Debug)]
pub(super) struct ParticleFilter {
    rule: FilterRule,
    matcher: ScanMatcher,
    particles: Vec<Particle>,
    trajectories: Trajectories,
    best: usize,
    scans: u64,
    stream: Stream,
    beams: Beams,
    /// Memory for the ends of a scan's beams.
    hits: Points,
    places: Vec<Place>,
}

impl ParticleFilter {
    /// Creates a filter over maps with cells of `resolution` m, before the first scan.
    pub(super) fn new(rule: FilterRule, resolution: f64, stream: Stream) -> Self {
        let nobody = Particle {
            pose: Pose::default(),
            map: HitMap::new(rule.matching.kernel),
            log_weight: 0.0,
            total: 0.0,
            node: None,
        };
        Self {
            matcher: ScanMatcher::new(rule.matching, resolution),
            particles: vec![nobody; rule.particles.max(1) as usize],
            rule,
            trajectories: Trajectories::default(),
            best: 0,
            scans: 0,
            stream,
            beams: Beams::default(),
            hits: Points::default(),
            places: Vec::new(),
        }
    }

    /// Takes in the first scan, taken at `pose`, where all particles start.
    pub(super) fn begin(&mut self, pose: Pose, scan: &BeamEnds) {
        self.hits.take(scan.hits(1));
        let mut map = HitMap::new(self.rule.matching.kernel);
        self.hits.seen_from(pose, self.matcher.scale(), &mut self.places);
        map.register(&self.places);
        for particle in &mut self.particles {
            (particle.pose, particle.map) = (pose, map.clone());
        }
        self.conclude();
    }

    /// Takes in a further scan, taken after the `increments` of odometry.
    pub(super) fn advance(&mut self, increments: &[Pose], scan: &BeamEnds) {
        let Self { rule, matcher, beams, hits, places, stream, scans, .. } = self;
        hits.take(scan.hits(1));
        beams.take(scan.hits(rule.matching.skip as usize + 1));
        for (i, particle) in (0..).zip(&mut self.particles) {
            // 1. Odometry moves the particle.
            let stream = stream.at(*scans << PARTICLE_BITS | i);
            for &increment in increments {
                particle.pose = if rule.motion.is_none() {
                    particle.pose.compose(increment)
                } else {
                    rule.motion.draw(particle.pose, increment, stream)
                };
            }
            // 2. The scan corrects its pose.
            let mut window = Window::over(&particle.map);
            if rule.matching.searches() {
                let (pose, fits) = matcher.climb(&mut window, beams, particle.pose);
                if fits {
                    particle.pose = pose;
                }
            }
            // 3. The scan weighs it.
            let log_likelihood = matcher.log_likelihood(&mut window, beams, particle.pose);
            particle.log_weight += log_likelihood;
            particle.total += log_likelihood;
            // 4. The scan enters its map: before particles are drawn anew, as those of one parent have one pose too. They go on
            // sharing what the scan has changed.
            hits.seen_from(particle.pose, matcher.scale(), places);
            particle.map.register(places);
        }
        // 5. Particles that count for little are replaced.
        self.resample();
        self.conclude();
    }

    /// Returns the pose of the best particle: the one whose scans were likeliest, all in all.
    pub(super) fn pose(&self) -> Pose {
        self.particles[self.best].pose
    }

    /// Returns the end of the best particle's trajectory.
    pub(super) fn node(&self) -> Option<NodeId> {
        self.particles[self.best].node
    }

    /// Returns the trajectories of all particles.
    pub(super) fn trajectories(&self) -> &Trajectories {
        &self.trajectories
    }

    /// Draws particles anew where too few of them count (Grisetti et al. 2007, section 4.2).
    fn resample(&mut self) {
        let log_weights: Vec<f64> = self.particles.iter().map(|p| p.log_weight).collect();
        let weights = normalised(&log_weights, self.rule.likelihood_gain);
        #[expect(clippy::cast_precision_loss, reason = "few")]
        let enough = self.rule.resample_threshold * weights.len() as f64;
        if effective(&weights) >= enough {
            return;
        }
        let everyone = weights.len() as u64;
        let offset = self.stream.at(self.scans << PARTICLE_BITS | everyone).uniform();
        let chosen = systematic(&weights, offset);
        let mut old: Vec<Option<Particle>> = self.particles.drain(..).map(Some).collect();
        for (n, &i) in chosen.iter().enumerate() {
            let is_last = chosen.get(n + 1) != Some(&i);
            let particle = if is_last { old[i].take() } else { old[i].clone() };
            self.particles.extend(particle.map(|p| Particle { log_weight: 0.0, ..p }));
        }
    }

    /// Extends the trajectories, and determines which particle is best.
    fn conclude(&mut self) {
        for particle in &mut self.particles {
            particle.node = Some(self.trajectories.extend(particle.node, particle.pose));
        }
        self.scans += 1;
        self.best = 0;
        for (i, particle) in self.particles.iter().enumerate() {
            if particle.total > self.particles[self.best].total {
                self.best = i;
            }
        }
    }
}

/// Streams are numbered by scan, then by particle: at most a million of these.
const PARTICLE_BITS: u32 = 20;
