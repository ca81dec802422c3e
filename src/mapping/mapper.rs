//! From scans and odometry to the robot's pose and the map.

use super::beam_ends::BeamEnds;
use super::keyframe::{KeyframeRule, Keyframes};
use super::particle_filter::{FilterRule, ParticleFilter};
use super::trajectories::NodeId;
use super::{Change, OccupancyMap, ScanRule};
use crate::geometry::Pose;
use crate::rng::Stream;
use crate::robot::{BeamDirections, Scan};
use crate::units::Tick;

/// Builds a map from the scans at keyframes, with the poses of odometry where the filter's rule trusts it, and else with those
/// of the best particle.
#[derive(Debug)]
pub struct Mapper {
    keyframes: Keyframes,
    rule: ScanRule,
    map: OccupancyMap,
    slam: Option<Slam>,
    /// How long a map that was shown stands at least.
    interval: Tick,
    /// When the map was shown last.
    shown: Option<Tick>,
    /// Scans taken in with the poses of odometry that the map does not show yet.
    waiting: Vec<(Pose, BeamEnds)>,
    directions: BeamDirections,
}

/// When the map shows a scan that is taken in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Showing {
    /// With the next map that is due.
    WhenDue,
    /// At once.
    Now,
}

/// The state besides the map where odometry is not trusted.
#[derive(Debug)]
struct Slam {
    filter: ParticleFilter,
    /// Odometry since the last scan that was taken in, in the robot's frame at each step.
    increments: Vec<Pose>,
    /// Odometry at the last scan that was taken in.
    odometry: Pose,
    /// All scans taken in: the map is drawn anew from them when another particle becomes best.
    scans: Vec<BeamEnds>,
    /// The end of the trajectory that the map shows.
    shown: Option<NodeId>,
    directions: BeamDirections,
}

impl Mapper {
    /// Creates a mapper without scans; particles draw from `stream`.
    pub fn new(
        keyframes: KeyframeRule,
        scan_rule: ScanRule,
        filter: FilterRule,
        stream: Stream,
    ) -> Self {
        let slam = (!filter.trusts_odometry()).then(|| Slam {
            filter: ParticleFilter::new(filter, scan_rule.resolution, stream),
            increments: Vec::new(),
            odometry: Pose::default(),
            scans: Vec::new(),
            shown: None,
            directions: BeamDirections::default(),
        });
        let map = OccupancyMap::new(scan_rule);
        Self {
            keyframes: Keyframes::new(keyframes),
            rule: scan_rule,
            map,
            slam,
            interval: Tick(0),
            shown: None,
            waiting: Vec::new(),
            directions: BeamDirections::default(),
        }
    }

    /// Returns the same mapper whose map, once shown, stands for `interval` at least. GMapping's `map_update_interval`.
    #[must_use]
    pub fn showing_every(self, interval: Tick) -> Self {
        Self { interval, ..self }
    }

    /// Returns the map so far: that of the best particle.
    pub fn map(&self) -> &OccupancyMap {
        &self.map
    }

    /// Returns whether poses are estimated, that is, whether odometry is not trusted.
    pub fn estimates(&self) -> bool {
        self.slam.is_some()
    }

    /// Returns the robot's pose in the map when odometry reads `odometry`: the best particle's pose at the last scan
    /// taken in, moved on by the odometry since.
    pub fn pose(&self, odometry: Pose) -> Pose {
        match &self.slam {
            Some(slam) if slam.shown.is_some() => {
                slam.filter.pose().compose(slam.odometry.relative(odometry))
            }
            _ => odometry,
        }
    }

    /// Returns the robot's pose at each scan taken in, as now estimated: the trajectory of the best particle. Empty
    /// where odometry is trusted.
    pub fn way(&self) -> Vec<Pose> {
        let best = self.slam.as_ref().and_then(|slam| Some((slam, slam.filter.node()?)));
        best.map_or_else(Vec::new, |(slam, node)| slam.filter.trajectories().way_to(node))
    }

    /// Returns the cells that the last scan taken in changed.
    pub fn changes(&self) -> &[Change] {
        self.map.changes()
    }

    /// Returns whether a scan taken at `odometry` is to be taken into the map. Has to be called for every scan, as
    /// particles move with the increments in between.
    pub fn wants(&mut self, odometry: Pose) -> bool {
        if let (Some(slam), Some(last)) = (&mut self.slam, self.keyframes.last())
            && last != odometry
        {
            slam.increments.push(last.relative(odometry));
        }
        self.keyframes.wants(odometry)
    }

    /// Takes `scan`, taken at `odometry`, in, and returns the cells that changed where the map was shown, among them those that
    /// differ because another particle became best. `None` where the scan waits for the next map.
    pub fn integrate(
        &mut self,
        odometry: Pose,
        scan: &Scan,
        showing: Showing,
    ) -> Option<&[Change]> {
        self.keyframes.taken(odometry);
        let is_due = showing == Showing::Now
            || self.interval == Tick(0)
            || self.shown.is_none_or(|last| scan.stamp > last + self.interval);
        if is_due {
            self.shown = Some(scan.stamp);
        }
        let Some(slam) = &mut self.slam else {
            if is_due && self.waiting.is_empty() {
                return Some(self.map.integrate(odometry, scan));
            }
            let beams = BeamEnds::of(scan, self.rule, &mut self.directions);
            self.waiting.push((odometry, beams));
            if !is_due {
                return None;
            }
            let waited = std::mem::take(&mut self.waiting);
            return Some(self.map.redraw([], waited.iter().map(|(pose, beams)| (*pose, beams))));
        };
        let beams = BeamEnds::of(scan, self.rule, &mut slam.directions);
        if slam.shown.is_none() {
            slam.filter.begin(odometry, &beams);
        } else {
            slam.filter.advance(&slam.increments, &beams);
        }
        slam.increments.clear();
        slam.odometry = odometry;
        slam.scans.push(beams);
        let node = slam.filter.node()?;
        if !is_due {
            return None;
        }
        let ways = slam.filter.trajectories();
        let (removed, added) = ways.between(slam.shown.replace(node), node);
        let scan_at = |&node: &NodeId| {
            let (pose, scan) = ways.at(node);
            (pose, &slam.scans[scan])
        };
        Some(self.map.redraw(removed.iter().map(scan_at), added.iter().map(scan_at)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Cell, Occupancy};
    use crate::mapping::{MatchRule, MotionNoise, NoReturn, room};
    use crate::rng::Seeds;
    use std::collections::BTreeMap;

    const KEYFRAMES: KeyframeRule = KeyframeRule { distance: 0.3, turn: 0.3 };
    const SCANS: ScanRule = ScanRule {
        resolution: 0.05,
        clip_range: 9.0,
        hit_ratio: 0.25,
        no_return: NoReturn::Nothing,
    };
    const GMAPPING: FilterRule = FilterRule {
        particles: 12,
        motion: MotionNoise { srr: 0.1, srt: 0.2, str: 0.1, stt: 0.2 },
        matching: MatchRule::GMAPPING,
        likelihood_gain: 3.0,
        resample_threshold: 0.5,
    };
    /// No particle moves but by odometry.
    const STILL: FilterRule = FilterRule {
        particles: 1,
        motion: MotionNoise { srr: 0.0, srt: 0.0, str: 0.0, stt: 0.0 },
        matching: MatchRule { linear_step: 0.0, angular_step: 0.0, ..GMAPPING.matching },
        ..GMAPPING
    };

    fn mapper(filter: FilterRule) -> Mapper {
        Mapper::new(KEYFRAMES, SCANS, filter, Seeds::new(5, vec![]).stream("slam"))
    }

    /// Returns true poses on rounds in the room, and those of odometry, which drifts.
    fn rounds() -> Vec<(Pose, Pose)> {
        let mut drift = Seeds::new(3, vec![]).stream("odometry");
        let (mut truth, mut odometry) = (Pose::default(), Pose::default());
        (0..300)
            .map(|_| {
                let step = Pose::new(0.05, 0.0, 0.05);
                let (along, around) = (drift.normal(), drift.normal());
                truth = truth.compose(step);
                odometry = odometry.compose(Pose::new(
                    step.x + 0.006 * along,
                    0.0,
                    step.heading + 0.004 * around - 0.001,
                ));
                (truth, odometry)
            })
            .collect()
    }

    /// Drives the rounds and passes to `each` the mapper, the true pose and odometry after every scan that was taken
    /// in.
    fn drive(mapper: &mut Mapper, mut each: impl FnMut(&Mapper, Pose, Pose)) {
        for (truth, odometry) in rounds() {
            if mapper.wants(odometry) {
                mapper.integrate(odometry, &room::scan(truth), Showing::WhenDue);
                each(mapper, truth, odometry);
            }
        }
    }

    fn known(map: &OccupancyMap) -> BTreeMap<Cell, Occupancy> {
        let grid = map.grid();
        let lattice = |cell: Cell| Cell::new(cell.x + map.offset().x, cell.y + map.offset().y);
        let cells = grid.frame().cells().map(|cell| (lattice(cell), grid.at(cell)));
        cells.filter(|(_, value)| *value != Occupancy::Unknown).collect()
    }

    #[test]
    fn a_filter_that_may_not_move_is_mapping_with_odometry() {
        assert!(STILL.trusts_odometry() && !GMAPPING.trusts_odometry());
        // Two particles go through the filter, one does not: without noise or matching all follow odometry.
        let (mut trusting, mut filtering) =
            (mapper(STILL), mapper(FilterRule { particles: 2, ..STILL }));
        assert!(!trusting.estimates() && filtering.estimates());
        let mut poses = Vec::new();
        drive(&mut trusting, |mapper, _, odometry| {
            assert_eq!(mapper.pose(odometry), odometry);
            poses.push(odometry);
        });
        drive(&mut filtering, |mapper, _, odometry| {
            assert!(mapper.pose(odometry).position().distance(odometry.position()) < 1e-9);
        });
        assert!(trusting.way().is_empty());
        assert_eq!(filtering.way().len(), poses.len());
        assert_eq!(known(trusting.map()), known(filtering.map()));
    }

    #[test]
    fn particles_find_where_odometry_loses_the_way() {
        let (mut worst, mut drifted) = (0.0_f64, 0.0_f64);
        // The map's frame is where odometry began, and the first pose is one step from there.
        let start = rounds()[0];
        let mut mapper = mapper(GMAPPING);
        drive(&mut mapper, |mapper, truth, odometry| {
            let expected = start.1.compose(start.0.relative(truth));
            worst = worst.max(mapper.pose(odometry).position().distance(expected.position()));
            drifted = drifted.max(odometry.position().distance(expected.position()));
        });
        assert!(worst < 0.1 && drifted > 0.3, "{worst} m, odometry {drifted} m");
    }

    /// Checks that the reported changes add up to the map, and that the map is what the best particle's trajectory
    /// makes of the scans: also where another particle became best.
    #[test]
    fn changes_tell_the_whole_story_across_changes_of_the_best_particle() {
        let vague = FilterRule {
            matching: MatchRule { skip: 29, iterations: 1, ..GMAPPING.matching },
            ..GMAPPING
        };
        let mut told = BTreeMap::new();
        let (mut scans, mut ways) = (Vec::new(), Vec::new());
        let mut mapper = mapper(vague);
        drive(&mut mapper, |mapper, truth, _| {
            scans.push(room::scan(truth));
            ways.push(mapper.way());
            for change in mapper.changes() {
                let was = told.insert(change.cell, change.to).unwrap_or(Occupancy::Unknown);
                assert_eq!(was, change.from);
                assert_ne!(change.from, change.to);
            }
            told.retain(|_, value| *value != Occupancy::Unknown);
            assert_eq!(known(mapper.map()), told);
            let mut afresh = OccupancyMap::new(SCANS);
            for (pose, scan) in mapper.way().into_iter().zip(&scans) {
                afresh.integrate(pose, scan);
            }
            assert_eq!(known(&afresh), told);
        });
        let switches = ways.windows(2).filter(|pair| !pair[1].starts_with(&pair[0])).count();
        assert!(switches > 3, "another particle became best {switches} times");
    }

    #[test]
    fn a_map_shows_what_waited_once_it_is_due_and_at_once_where_asked_for() {
        // Two particles that may not move go through the filter, one does not.
        for particles in [1, 2] {
            let at = |mapper: &mut Mapper, scan: u32, showing: Showing| {
                let pose = Pose::new(0.4 * f64::from(scan), 0.0, 0.0);
                assert!(mapper.wants(pose));
                let scan = Scan { stamp: Tick(300 * u64::from(scan)), ..room::scan(pose) };
                mapper.integrate(pose, &scan, showing).map(<[Change]>::len)
            };
            let rule = FilterRule { particles, ..STILL };
            let mut waiting = mapper(rule).showing_every(Tick(700));
            let mut prompt = mapper(rule);
            assert!(at(&mut waiting, 0, Showing::WhenDue).is_some(), "the first");
            assert_eq!(at(&mut waiting, 1, Showing::WhenDue), None);
            assert_eq!(at(&mut waiting, 2, Showing::WhenDue), None);
            for scan in 0..4 {
                assert!(at(&mut prompt, scan, Showing::WhenDue).is_some());
            }
            assert_ne!(known(waiting.map()), known(prompt.map()));
            assert!(at(&mut waiting, 3, Showing::WhenDue).is_some());
            assert_eq!(known(waiting.map()), known(prompt.map()));
            assert!(at(&mut waiting, 4, Showing::Now).is_some());
        }
    }

    #[test]
    fn the_same_again_to_the_bit_and_another_stream_differs() {
        let ends = |stream: &str| {
            let stream = Seeds::new(5, vec![]).stream(stream);
            let mut mapper = Mapper::new(KEYFRAMES, SCANS, GMAPPING, stream);
            drive(&mut mapper, |_, _, _| {});
            let bits = |pose: &Pose| [pose.x, pose.y, pose.heading].map(f64::to_bits);
            mapper.way().iter().map(bits).collect::<Vec<_>>()
        };
        assert_eq!(ends("slam"), ends("slam"));
        assert_ne!(ends("slam"), ends("other"));
    }
}
