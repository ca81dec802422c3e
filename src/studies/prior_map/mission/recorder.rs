//! Writes a trial down for a replay, in the world's frame.

use crate::geometry::{Outline, Point, Pose};
use crate::grid::{Cell, GridFrame};
use crate::mapping::Change;
use crate::math;
use crate::robot::{Odometry, Scan};
use crate::studies::prior_map::Setup;
use crate::studies::prior_map::choice::Choice;
use crate::studies::prior_map::parameters::{Exploration, Strategy};
use crate::studies::recording::{Decision, Frame, FrontierView, Recording, Sensed};
use crate::units::Tick;

/// Describes how the next location is chosen, in a sentence (equations 1 to 4).
fn rule(exploration: &Exploration) -> String {
    match exploration.strategy {
        Strategy::Utility => {
            let alpha = exploration.alpha;
            format!(
                "highest u = {alpha} d + {} i, where d = 1 - D / largest D and i = I / largest I",
                1.0 - alpha
            )
        }
        Strategy::NearestFrontier => "the nearest frontier".to_owned(),
        Strategy::TopoMetricTour => {
            "the next node of the tour planned on the topo-metric map".to_owned()
        }
    }
}

/// A recording in the making.
pub(super) struct Recorder<'a> {
    recording: &'a mut Recording,
    frame: Pose,
    resolution: f64,
    pending: Frame,
    low: Cell,
    high: Cell,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(recording: &'a mut Recording, setup: &Setup, visible: &[Outline]) -> Self {
        recording.world = visible.to_vec();
        recording.footprint = setup.robot.footprint.clone();
        recording.prior = setup.prior.as_deref().cloned();
        recording.map_pose = setup.map_frame();
        recording.rule = rule(&setup.parameters.exploration);
        let resolution = setup.parameters.mapping.resolution_m;
        Self {
            recording,
            frame: setup.map_frame(),
            resolution,
            pending: Frame::default(),
            low: Cell::new(i32::MAX, i32::MAX),
            high: Cell::new(i32::MIN, i32::MIN),
        }
    }

    /// Returns whether every scan is to be recorded, also those that the mind does not use.
    pub(super) fn wants_scans(&self) -> bool {
        self.recording.sensed.is_some()
    }

    /// Records `scan` where scans are wanted, taken where the robot `believed` to be.
    pub(super) fn sensed(&mut self, scan: &Scan, odometry: Odometry, believed: Pose) {
        if let Some(sensed) = &mut self.recording.sensed {
            sensed.push(Sensed { scan: scan.clone(), odometry, believed });
        }
    }

    pub(super) fn map_changed(&mut self, changes: &[Change], scan: &Scan, pose: Pose) {
        for change in changes {
            let cell = change.cell;
            self.low = Cell::new(self.low.x.min(cell.x), self.low.y.min(cell.y));
            self.high = Cell::new(self.high.x.max(cell.x), self.high.y.max(cell.y));
            self.pending.map_changes.push((cell, change.to));
        }
        let sensor = pose.compose(scan.mount);
        let ends = (0..scan.ranges.len()).step_by(8).filter(|&i| scan.ranges[i].is_finite());
        let end = |i: usize| {
            let (sin, cos) = math::sin_cos(scan.angle(i));
            sensor.transform(Point::new(cos, sin) * scan.ranges[i])
        };
        self.pending.scan = Some(ends.map(end).collect());
    }

    pub(super) fn note(
        &mut self,
        now: Tick,
        pose: Pose,
        distance_m: f64,
        coverage_percent: f64,
        choice: Option<&Choice>,
        path: Option<Vec<Point>>,
    ) {
        let mut frame = std::mem::take(&mut self.pending);
        frame.time_s = now.seconds().get();
        frame.pose = pose;
        frame.distance_m = distance_m;
        frame.coverage_percent = coverage_percent;
        frame.path = path.map(|path| path.into_iter().map(|p| self.frame.transform(p)).collect());
        frame.decision = choice.map(|choice| self.decision(choice));
        self.recording.frames.push(frame);
    }

    fn decision(&self, choice: &Choice) -> Decision {
        let world = |cell: Cell| self.frame.transform(choice.frame.center(cell));
        let frontiers = choice.frontiers.iter().enumerate().map(|(i, frontier)| FrontierView {
            cells: frontier.cells.iter().map(|&cell| world(cell)).collect(),
            candidate: world(frontier.candidate),
            distance_m: choice.appraisals[i].distance,
            gain_m2: choice.appraisals[i].gain,
            utility: choice.utilities[i],
        });
        Decision { frontiers: frontiers.collect(), chosen: choice.chosen }
    }
}

impl Drop for Recorder<'_> {
    /// Moves the lattice cells noted during the trial to one grid that holds them all.
    fn drop(&mut self) {
        if self.low.x > self.high.x {
            return;
        }
        let low = self.low;
        self.recording.map_frame = GridFrame {
            resolution: self.resolution,
            origin: Point::new(f64::from(low.x), f64::from(low.y)) * self.resolution,
            width: self.high.x - low.x + 1,
            height: self.high.y - low.y + 1,
        };
        for frame in &mut self.recording.frames {
            for (cell, _) in &mut frame.map_changes {
                *cell = Cell::new(cell.x - low.x, cell.y - low.y);
            }
        }
    }
}
