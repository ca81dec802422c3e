//! From scans and odometry to where the robot is and the map.

use super::beam_ends::BeamEnds;
use super::keyframe::{KeyframeRule, Keyframes};
use super::particle_filter::{FilterRule, ParticleFilter};
use super::trajectories::NodeId;
use super::{Change, OccupancyMap, ScanRule};
use crate::geometry::Pose;
use crate::rng::Stream;
use crate::robot::Scan;

/// Builds a map from the scans at keyframes, with the poses of odometry where the filter's rule trusts it, and else with those
/// of the best particle.
#[derive(Debug)]
pub struct Mapper {
    keyframes: Keyframes,
    rule: ScanRule,
    map: OccupancyMap,
    slam: Option<Slam>,
}

/// What there is besides a map where odometry is not trusted.
#[derive(Debug)]
struct Slam {
    filter: ParticleFilter,
    /// Odometry since the last scan that was taken in, in the robot's frame at each step.
    increments: Vec<Pose>,
    /// Odometry at the last scan that was taken in.
    odometry: Pose,
    /// All scans taken in: the map is drawn anew from them where another particle becomes best.
    scans: Vec<BeamEnds>,
    /// Where the way ends that the map shows.
    shown: Option<NodeId>,
}

impl Mapper {
    /// A mapper that has seen nothing; particles draw from `stream`.
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
        });
        let map = OccupancyMap::new(scan_rule);
        Self { keyframes: Keyframes::new(keyframes), rule: scan_rule, map, slam }
    }

    /// The map so far: that of the best particle.
    pub fn map(&self) -> &OccupancyMap {
        &self.map
    }

    /// Whether poses are estimated: odometry is not trusted.
    pub fn estimates(&self) -> bool {
        self.slam.is_some()
    }

    /// Where in the map the robot is, when odometry tells `odometry`: the best particle's pose at the last scan taken in,
    /// moved on as odometry did since.
    pub fn pose(&self, odometry: Pose) -> Pose {
        match &self.slam {
            Some(slam) if slam.shown.is_some() => {
                slam.filter.pose().compose(slam.odometry.relative(odometry))
            }
            _ => odometry,
        }
    }

    /// Where the robot was at each scan taken in, as it looks from now: the way of the best particle. Empty where odometry
    /// is trusted.
    pub fn way(&self) -> Vec<Pose> {
        let shown = self.slam.as_ref().and_then(|slam| Some((slam, slam.shown?)));
        shown.map_or_else(Vec::new, |(slam, node)| slam.filter.trajectories().way_to(node))
    }

    /// The cells that the last scan taken in changed.
    pub fn changes(&self) -> &[Change] {
        self.map.changes()
    }

    /// Whether a scan taken at `odometry` is to be taken into the map. To be told of every scan, as particles move with the
    /// increments in between.
    pub fn wants(&mut self, odometry: Pose) -> bool {
        if let (Some(slam), Some(last)) = (&mut self.slam, self.keyframes.last())
            && last != odometry
        {
            slam.increments.push(last.relative(odometry));
        }
        self.keyframes.wants(odometry)
    }

    /// Takes `scan`, taken at `odometry`, into the map and tells the cells that changed, those among them that are different
    /// because another particle became best.
    pub fn integrate(&mut self, odometry: Pose, scan: &Scan) -> &[Change] {
        self.keyframes.taken(odometry);
        let Some(slam) = &mut self.slam else { return self.map.integrate(odometry, scan) };
        let beams = BeamEnds::of(scan, self.rule.clip_range);
        if slam.shown.is_none() {
            slam.filter.begin(odometry, &beams);
        } else {
            slam.filter.advance(&slam.increments, &beams);
        }
        slam.increments.clear();
        slam.odometry = odometry;
        slam.scans.push(beams);
        let Some(node) = slam.filter.node() else { return &[] };
        let ways = slam.filter.trajectories();
        let (removed, added) = ways.between(slam.shown.replace(node), node);
        let scan_at = |&node: &NodeId| {
            let (pose, scan) = ways.at(node);
            (pose, &slam.scans[scan])
        };
        self.map.redraw(removed.iter().map(scan_at), added.iter().map(scan_at))
    }
}
