//! A trial seen in full: what a replay shows. Produced on demand by re-enacting, never stored.

use crate::geometry::{Outline, Point, Pose};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use crate::robot::{Odometry, Scan};
use serde::Serialize;

/// Everything that happened in one trial.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Recording {
    /// Outlines of the true world at the lidar's height (m).
    pub world: Vec<Outline>,
    /// Outline of the robot in its base frame (m).
    pub footprint: Outline,
    /// The prior map, if the trial had one, in the world's frame.
    #[serde(skip)]
    pub prior: Option<OccupancyGrid>,
    /// Where the robot's own map lies, in the map's frame.
    pub map_frame: GridFrame,
    /// The map's frame (the pose the robot began in), in the world's frame.
    pub map_pose: Pose,
    /// What happened, in order of time.
    pub frames: Vec<Frame>,
    /// Deadline study: the constrained MDPs that were solved, as JSON that `solve-cmdp` reads, in order of time.
    #[serde(skip)]
    pub plans: Vec<SolvedPlan>,
    /// How the next place to go to is chosen, in a sentence.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub rule: String,
    /// Deadline study: T, the global deadline (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deadline_s: Option<f64>,
    /// Deadline study: the place to reach (m, world frame).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<Point>,
    /// What the trial is called where it is asked for: `none/0`; empty where that is not known.
    #[serde(skip)]
    pub name: String,
    /// What readers see for it, by the labels of its manifest: `no prior, trial 0`; empty where that is not known.
    #[serde(skip)]
    pub title: String,
    /// How the trial ended: `reached`; empty where that is not known.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub outcome: String,
    /// The robot as a URDF ([`crate::robot::Robot::as_urdf`]); empty where that is not known.
    #[serde(skip)]
    pub description: String,
    /// Height of the scan plane above the floor (m).
    #[serde(skip)]
    pub scan_height_m: f64,
    /// Every scan that was taken, where a recording was asked for them, in order of time.
    #[serde(skip)]
    pub sensed: Option<Vec<Sensed>>,
}

/// A scan as the robot's sensors delivered it, with where the robot then believed to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// The scan, every beam of it.
    pub scan: Scan,
    /// Odometry when it was taken, in the odometry frame.
    pub odometry: Odometry,
    /// The robot's own estimate of its pose in the frame of its map.
    pub believed: Pose,
}

/// A plan of the deadline study.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedPlan {
    /// Simulated time at which it was made (s).
    pub time_s: f64,
    /// The model.
    pub document: String,
}

impl Recording {
    /// Returns how the trial ended as people say it: `gave up`.
    pub fn ending(&self) -> String {
        self.outcome.replace('-', " ")
    }

    /// Returns `text` after the trial's title, where it has one.
    pub fn titled(&self, text: &str) -> String {
        if self.title.is_empty() { text.to_owned() } else { format!("{}: {text}", self.title) }
    }

    /// Returns the robot's map at the end, in the map's frame; none where it made none.
    pub fn final_map(&self) -> Option<OccupancyGrid> {
        let mut map = OccupancyGrid::filled(self.map_frame, Occupancy::Unknown);
        for (cell, occupancy) in self.frames.iter().flat_map(|frame| &frame.map_changes) {
            map.set(*cell, *occupancy);
        }
        let is_empty = map.values().iter().all(|cell| *cell == Occupancy::Unknown);
        (!is_empty).then_some(map)
    }
}

impl Default for Recording {
    fn default() -> Self {
        let map_frame = GridFrame { resolution: 1.0, origin: Point::ZERO, width: 0, height: 0 };
        Self {
            world: Vec::new(),
            footprint: Outline::Circle { center: Point::ZERO, radius: 0.0 },
            prior: None,
            map_frame,
            map_pose: Pose::default(),
            frames: Vec::new(),
            plans: Vec::new(),
            rule: String::new(),
            deadline_s: None,
            goal: None,
            name: String::new(),
            title: String::new(),
            outcome: String::new(),
            description: String::new(),
            scan_height_m: 0.0,
            sensed: None,
        }
    }
}

/// One instant. What did not change since the frame before is left out.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Frame {
    /// Simulated time (s).
    pub time_s: f64,
    /// True pose of the robot in the world (m, rad).
    pub pose: Pose,
    /// Distance travelled (m).
    pub distance_m: f64,
    /// Coverage (percent).
    pub coverage_percent: f64,
    /// Where each beam ended (m, world frame), every few beams, when a scan was taken into the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan: Option<Vec<Point>>,
    /// Cells of the robot's map that changed, and what they hold now.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub map_changes: Vec<(Cell, Occupancy)>,
    /// A decision taken now.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decision>,
    /// The planned path (m, world frame), when it changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Vec<Point>>,
    /// Deadline study: the robot's map and what it is about to do, when either changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub graph: Option<GraphView>,
    /// Something worth a line of text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub event: Option<String>,
}

/// A choice among frontiers, with everything it was made on.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Decision {
    /// All frontiers, in the order they were found.
    pub frontiers: Vec<FrontierView>,
    /// Index of the chosen one.
    pub chosen: Option<usize>,
}

/// One frontier as the strategy saw it.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FrontierView {
    /// Centres of its cells (m, world frame).
    pub cells: Vec<Point>,
    /// The candidate location p (m, world frame).
    pub candidate: Point,
    /// D(p, pR) (m).
    pub distance_m: f64,
    /// I(p) (m²).
    pub gain_m2: f64,
    /// u(p), in 0..=1.
    pub utility: f64,
}

/// Deadline study: the toposemantic map as the robot knows it, and its plan on it. The map itself has no positions:
/// vertices are drawn where the robot was when it first arrived at them.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GraphView {
    /// V, in order of discovery.
    pub vertices: Vec<VertexView>,
    /// Explored edges, as pairs of vertices, the smaller first, each once.
    pub edges: Vec<(usize, usize)>,
    /// v_c.
    pub current: usize,
    /// v, where the robot is on its way to one.
    pub target: Option<usize>,
    /// What there was to choose from when that was decided.
    pub candidates: Vec<CandidateView>,
    /// t_d, as an instant of the trial (s), while a plan is followed.
    pub leg_deadline_s: Option<f64>,
    /// π*: what it may do at each vertex of the plan.
    pub policy: Vec<ActionView>,
    /// What it does now: `door left, fast`.
    pub doing: String,
}

/// One vertex.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct VertexView {
    /// L(v), as in Figure 1: `R1`, `c1a`.
    pub label: String,
    /// Whether it is a room.
    pub room: bool,
    /// Whether it is the goal.
    pub goal: bool,
    /// Where the robot was when it came there first (m, world frame).
    pub at: Point,
    /// Headings (rad) of its edges to unexplored space.
    pub unexplored: Vec<f64>,
}

/// One vertex that could have been chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CandidateView {
    /// Which one.
    pub vertex: usize,
    /// How many edges to unexplored space it had.
    pub unexplored: usize,
    /// How many edges it was away.
    pub edges_away: usize,
}

/// One action of a policy.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ActionView {
    /// Where it is taken.
    pub from: usize,
    /// Where it leads.
    pub to: usize,
    /// With which probability, 0 to 1.
    pub probability: f64,
    /// Whether it is done fast.
    pub fast: bool,
}
