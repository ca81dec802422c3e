//! Parameters of the prior-knowledge study. Those the paper states have its values as default; those it
//! leaves out have what its authors' released configuration sets (measured facts), and a manifest that
//! relies on one says so with a `why`.
//!
//! Over 400 lines, as it is one list: every parameter with its meaning, range and source, to be read from top to bottom.

use crate::mapping::{FilterRule, KeyframeRule, MatchRule, MotionNoise, NoReturn, ScanRule};
use crate::studies::parameters;
use crate::units::{Seconds, Tick};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

parameters!(
    /// Everything a trial needs besides robot, world, prior and start.
    Parameters {
        /// The range scanner as the study used it.
        sensing: Sensing = Sensing::default(),
        /// Building the occupancy map M_E.
        mapping: Mapping = Mapping::default(),
        /// Planning and driving to a location.
        navigation: Navigation = Navigation::default(),
        /// Choosing the next location.
        exploration: Exploration = Exploration::default(),
        /// What is measured.
        measurement: Measurement = Measurement::default(),
        /// When a trial ends.
        mission: Mission = Mission::default(),
    }
);

parameters!(
    /// The range scanner as the study used it (section 4.1). What is absent is the robot's own.
    Sensing {
        /// Longest range reported (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        range_m: Option<f64> = None,
        /// Standard deviation of the Gaussian noise on ranges (m), 0 or more.
        #[schemars(range(min = 0.0))]
        range_noise_sd_m: Option<f64> = None,
        /// How far round the scanner looks (degrees), about the middle of the robot's own scanner and with its beams as
        /// dense; 360 is all round.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(max = 360.0), extend("exclusiveMinimum" = 0))]
        field_of_view_deg: Option<f64> = None,
        /// Standard deviation of the error of the executed linear speed, as a share of the command, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_linear: f64 = 0.0,
        /// Standard deviation of the error of the executed angular speed, as a share of the command, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        drive_noise_angular: f64 = 0.0,
        /// How long one error of the drive lasts (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        drive_noise_correlation_s: f64 = 0.5,
        /// Standard deviation of odometry's error of distance, per square root of metre (m), 0 or more.
        #[schemars(range(min = 0.0))]
        odometry_noise_distance: f64 = 0.0,
        /// Standard deviation of odometry's error of heading, per square root of radian turned (rad), 0 or more.
        #[schemars(range(min = 0.0))]
        odometry_noise_heading: f64 = 0.0,
    }
);

parameters!(
    /// Building the map from scans, in GMapping's manner.
    Mapping {
        /// Number of particles, 1 to 1000. With 1, no motion noise and no matching, maps are made with the poses of odometry,
        /// as the simulated study really ran.
        #[schemars(range(min = 1, max = 1000))]
        particles: u32 = 1,
        /// Side of a map cell (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        resolution_m: f64 = 0.1,
        /// Where in its cell the robot's start lies, and with it every cell.
        #[serde(skip_serializing_if = "is_default")]
        origin: Origin = Origin::Corner,
        /// A scan is taken into the map after this much travel (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        keyframe_distance_m: f64 = 1.0,
        /// ... or after turning this much (rad), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        keyframe_turn_rad: f64 = 0.5,
        /// A map is not shown again before this has passed (s), 0 or more (`map_update_interval`): planner and coverage see a scan
        /// taken in between with the next.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        update_interval_s: f64 = 0.0,
        /// Beams are cut to this range (m); `null` means the sensor's own range.
        #[schemars(extend("exclusiveMinimum" = 0))]
        clip_range_m: Option<f64> = None,
        /// What a beam tells that comes back with nothing within the scanner's range.
        no_return: NoReturn = NoReturn::Free,
        /// A visited cell is occupied where more than this share of its visits were hits, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        hit_ratio: f64 = 0.05,
        /// Particles scatter in position by this share of the way, at each scan (GMapping's `srr`), 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        motion_noise_srr: f64 = 0.0,
        /// ... in heading by this (rad) per metre (`srt`), 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        motion_noise_srt: f64 = 0.0,
        /// ... in position by this (m) per radian (`str`), 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        motion_noise_str: f64 = 0.0,
        /// ... in heading by this share of the turn (`stt`), 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        motion_noise_stt: f64 = 0.0,
        /// First step of the search for where a scan fits (m), 0 or more; 0 with `match-angular-step-rad` 0 is no search (`lstep`).
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        match_linear_step_m: f64 = 0.0,
        /// ... of heading (rad), 0 or more (`astep`).
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        match_angular_step_rad: f64 = 0.0,
        /// How often these steps are halved, 0 to 20 (`iterations`).
        #[serde(skip_serializing_if = "is::<5>")]
        #[schemars(range(min = 0, max = 20))]
        match_iterations: u32 = 5,
        /// In the search, a beam that ends d m off scores exp(-d^2 / this) (m^2), above 0 (`sigma`).
        #[serde(skip_serializing_if = "is_thousandths::<50>")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        match_sigma_m2: f64 = 0.05,
        /// How many cells to either side a beam looks for the obstacle it hit, 0 to 2 (`kernelSize`).
        #[serde(skip_serializing_if = "is::<1>")]
        #[schemars(range(min = 0, max = 2))]
        match_kernel_cells: u32 = 1,
        /// A scan whose score, at most its number of beams, is not above this leaves a particle where it moved to, 0 or more
        /// (`minimumScore`).
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        match_minimum_score: f64 = 0.0,
        /// Beams left out between two that are matched and weighed, 0 or more (`lskip`).
        #[serde(skip_serializing_if = "is_default")]
        match_skip_beams: u32 = 0,
        /// In weights, a beam that ends d m off counts -d^2 / this (m^2), above 0 (`lsigma`).
        #[serde(skip_serializing_if = "is_thousandths::<75>")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        likelihood_sigma_m2: f64 = 0.075,
        /// Log weights are divided by this and the number of particles, above 0 (`ogain`).
        #[serde(skip_serializing_if = "is_thousandths::<3000>")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        likelihood_gain: f64 = 3.0,
        /// Particles are drawn anew where their effective number falls below this share, 0 to 1 (`resampleThreshold`).
        #[serde(skip_serializing_if = "is_thousandths::<500>")]
        #[schemars(range(min = 0.0, max = 1.0))]
        resample_threshold: f64 = 0.5,
    }
);

impl Mapping {
    /// Returns the rule by which a scan is taken into the map.
    pub fn keyframes(&self) -> KeyframeRule {
        KeyframeRule { distance: self.keyframe_distance_m, turn: self.keyframe_turn_rad }
    }

    /// Returns how long a map that was shown stands at least.
    pub fn update_interval(&self) -> Tick {
        Tick::at_or_after(Seconds(self.update_interval_s))
    }

    /// Returns how a scan is taken in.
    pub fn scans(&self) -> ScanRule {
        ScanRule {
            resolution: self.resolution_m,
            // A beam at exactly the sensor's range still hit something.
            clip_range: self.clip_range_m.unwrap_or(f64::INFINITY),
            hit_ratio: self.hit_ratio,
            no_return: self.no_return,
        }
    }

    /// Returns where it is taken to have been.
    pub fn filter(&self) -> FilterRule {
        FilterRule {
            particles: self.particles,
            motion: MotionNoise {
                srr: self.motion_noise_srr,
                srt: self.motion_noise_srt,
                str: self.motion_noise_str,
                stt: self.motion_noise_stt,
            },
            matching: MatchRule {
                linear_step: self.match_linear_step_m,
                angular_step: self.match_angular_step_rad,
                iterations: self.match_iterations,
                sigma: self.match_sigma_m2,
                kernel: self.match_kernel_cells,
                minimum_score: self.match_minimum_score,
                likelihood_sigma: self.likelihood_sigma_m2,
                skip: self.match_skip_beams,
            },
            likelihood_gain: self.likelihood_gain,
            resample_threshold: self.resample_threshold,
        }
    }
}

/// Where in a cell of the map the robot's start lies.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// At its lower left corner: cells are found by rounding down.
    #[default]
    Corner,
    /// In its middle: cells are found by rounding to the nearest centre, as GMapping does.
    Centre,
}

parameters!(
    /// Planning on the inflated map and driving, after Nav2D's behaviour.
    Navigation {
        /// Obstacles are inflated over this many cells, at least 1.
        #[schemars(range(min = 1))]
        inflation_radius_cells: u32 = 9,
        /// Inflated cost (0 to 100) from which a cell counts as lethal when frontiers are sought.
        #[schemars(range(min = 0, max = 100))]
        frontier_lethal_cost: u32 = 60,
        /// Inflated cost (0 to 100) from which the planner does not cross a cell.
        #[schemars(range(min = 0, max = 100))]
        planner_lethal_cost: u32 = 75,
        /// Extra cost of a step per unit of inflated cost / 100: length x (1 + this x cost / 100).
        #[schemars(range(min = 0.0))]
        cost_weight: f64 = 10.0,
        /// When the way to a chosen location is planned.
        #[serde(skip_serializing_if = "is_default")]
        replan: Replan = Replan::OnMapChange,
        /// Highest linear speed (m/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        max_linear_m_s: f64 = 1.0,
        /// Highest angular speed when turning in place (rad/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        max_angular_rad_s: f64 = 1.0,
        /// Radius of the disc that must stay clear of obstacles when driving (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        robot_radius_m: f64 = 0.25,
        /// The operator sees each range as the median of this many neighbouring beams, odd; 1 as they are.
        #[schemars(range(min = 1))]
        obstacle_median_beams: u32 = 1,
        /// A target counts as reached within this distance (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        goal_tolerance_m: f64 = 0.3,
        /// A location that the robot comes no closer to for this long (s), above 0, is given up. A turn on the spot has to fit.
        #[serde(skip_serializing_if = "is_usual_patience")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        patience_s: f64 = 15.0,
    }
);

/// When the way to a chosen location is planned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Replan {
    /// Whenever the map has changed.
    #[default]
    OnMapChange,
    /// Only when a location is chosen, over the map of then, as the released program did.
    OnChoice,
}

parameters!(
    /// Choosing the next location (section 3).
    Exploration {
        /// How the next location is chosen.
        strategy: Strategy = Strategy::Utility,
        /// Weight of distance against information gain in equation 1, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        alpha: f64 = 0.5,
        /// How I(p) is computed.
        gain: Gain = Gain::Paper,
        /// Where the scanner at p looks under `gain: paper`.
        #[serde(skip_serializing_if = "is_default")]
        view: View = View::AllRound,
        /// Under `gain: released` with a prior, rays stop where the inflated cost (0 to 100) is at least this.
        #[serde(skip_serializing_if = "is::<80>")]
        #[schemars(range(min = 0, max = 100))]
        prior_ray_stop_cost: u32 = 80,
        /// Under `gain: released` without a prior, rays stop where the inflated cost (0 to 100) is above this.
        #[serde(skip_serializing_if = "is::<50>")]
        #[schemars(range(min = 0, max = 100))]
        baseline_ray_stop_cost: u32 = 50,
        /// Which cell of a frontier is its candidate location.
        #[serde(skip_serializing_if = "is_default")]
        candidate: Candidate = Candidate::Middle,
        /// Where frontiers are searched from.
        #[serde(skip_serializing_if = "is_default")]
        search_from: SearchFrom = SearchFrom::Robot,
        /// When the next location is chosen anew.
        reselect: Reselect = Reselect::OnArrival,
        /// Under `reselect: continuous`, the time between choices (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        reselect_period_s: f64 = 3.2,
        /// ... and when the remaining plan is cheaper than `reselect-near-cost`.
        #[schemars(extend("exclusiveMinimum" = 0))]
        reselect_near_period_s: f64 = 1.2,
        /// Weighted length (m) of the remaining plan below which the shorter period holds.
        #[schemars(range(min = 0.0))]
        reselect_near_cost: f64 = 3.0,
        /// Frontiers with fewer cells are left out.
        minimum_frontier_cells: u32 = 1,
        /// Whether known obstacles hide what lies behind them when there is no prior (Figure 2b leaves it open).
        known_obstacles_occlude: bool = true,
        /// A choice takes effect after a delay (s) uniform between 0 and this, 0 or more: what a robot's own computing
        /// and message passing would take.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        decision_jitter_s: f64 = 0.0,
        /// Under `strategy: topo-metric-tour`, the standard deviation (m) of Gaussian noise on the positions of the graph's
        /// nodes, in x and in y, drawn anew for every trial, 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        node_noise_sd_m: f64 = 0.0,
    }
);

/// How the next location is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// The largest u(p) of equations 1 to 4.
    Utility,
    /// The nearest frontier (Yamauchi 1997), a further baseline.
    NearestFrontier,
    /// The method of reference 8 in section 4.5: along a tour over the nodes of a topo-metric map, the nearest frontier of each.
    TopoMetricTour,
}

/// How the information gain I(p) is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Gain {
    /// As section 3.2 defines it: every unknown cell within range that is free and visible in the prior and
    /// visible in the map.
    Paper,
    /// As the released program computed it: the distinct unknown cells that 361 rays meet before something stops them.
    Released,
}

/// Where the scanner at a candidate location looks; the paper speaks of "the perceivable area within the field of view"
/// and leaves the heading there open.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// In all directions.
    #[default]
    AllRound,
    /// As the robot would arrive: the scanner's field of view about the straight direction from the robot to p.
    OnArrival,
    /// The scanner's field of view turned to where it promises most.
    Best,
}

/// Which cell of a frontier is its candidate location.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Candidate {
    /// "The cell that divides a frontier into two equal segments" (section 3.1).
    #[default]
    Middle,
    /// The cell nearest to the centroid of the frontier's cells, as the released program did.
    NearestToCentroid,
}

/// Where frontiers are searched from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchFrom {
    /// The robot's cell. Where it stands so close to an obstacle that the search does not leave it, exploration ends, as the
    /// released program's did.
    #[default]
    Robot,
    /// There, the nearest cell that the search may cross.
    NearestFree,
}

/// When the next location is chosen anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reselect {
    /// When the location is reached, or cannot be (section 3.1, steps a to d).
    OnArrival,
    /// Every few seconds, whether or not it was reached, as the released program did.
    Continuous,
}

parameters!(
    /// What is measured.
    Measurement {
        /// What coverage counts.
        coverage: Coverage = Coverage::Paper,
        /// Whose map coverage is counted against where `coverage-map` names none.
        #[serde(skip_serializing_if = "is_default")]
        reference: ReferenceMap = ReferenceMap::Ideal,
        /// A `map_server` map that coverage is counted against, by its path from the manifest: what somebody recorded.
        #[serde(skip_serializing_if = "is_default")]
        coverage_map: Option<String> = None,
        /// The frame that the map's origin is given in.
        #[serde(skip_serializing_if = "is_default")]
        coverage_map_frame: MapFrame = MapFrame::Start,
        /// Which of its cells count.
        #[serde(skip_serializing_if = "is_default")]
        coverage_map_cells: CoverageMapCells = CoverageMapCells::All,
        /// Further levels of coverage (percent, 0 to 100) at which distance and time are recorded.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(inner(range(min = 0.0, max = 100.0)))]
        coverage_levels_percent: Vec<f64> = Vec::new(),
        /// When a coverage counts as reached; time runs from the trial's start.
        #[serde(skip_serializing_if = "is_default")]
        crossing: Crossing = Crossing::Keyframe,
        /// Whether further measures are recorded: decisions and open frontiers at levels of coverage, turning per metre.
        #[serde(skip_serializing_if = "is_default")]
        further: bool = false,
        /// Whether the mean speed of the whole trial is recorded.
        #[serde(skip_serializing_if = "is_default")]
        mean_speed: bool = false,
        /// Distances travelled (m) at which coverage is recorded; a trial that ended before has its last coverage there.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(inner(range(min = 1)))]
        coverage_at_distance_m: Vec<u32> = Vec::new(),
    }
);

/// Whose map coverage is counted against.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceMap {
    /// That of ideal exploration: noiseless scans all round from wherever the body fits.
    #[default]
    Ideal,
    /// What the same robot has known after exploring without any noise or prior knowledge, by the nearest frontier till none is
    /// left: by each `candidate`, and by choosing anew all the time. What a robot can see at all.
    Robot,
}

/// Which cells of a recorded map coverage counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CoverageMapCells {
    /// All that it knows.
    #[default]
    All,
    /// Those that `ideal` exploration of the world comes to know too: where the map's walls lie a cell beside the world's, nobody
    /// sees them.
    InView,
}

/// The frame that a map's origin is given in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MapFrame {
    /// That of the robot's start, as mapping programs save what they mapped.
    #[default]
    Start,
    /// The world's.
    World,
}

/// What coverage counts, of the map that it is counted against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Coverage {
    /// Section 4: the share of the free area of E that is mapped (known) in M_E.
    Paper,
    /// As the released program logged it: the share of known cells, free or occupied, that are known.
    Released,
}

/// When a coverage counts as reached. The map changes at keyframes only, so coverage rises in steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Crossing {
    /// At the keyframe that brought it.
    #[default]
    Keyframe,
    /// In between that keyframe and the one before, as if coverage had risen linearly.
    Interpolated,
    /// At the first choice of a location after it: the released program logged at its choices only.
    Decision,
}

parameters!(
    /// Where a trial begins exactly, and when it ends besides running out of frontiers.
    Mission {
        /// Simulated time after which a trial is ended (s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        time_limit_s: f64 = 1800.0,
        /// The experimenter ends the trial where this coverage (percent, above 0, to 100) is reached; `null` means that it goes on.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(max = 100.0), extend("exclusiveMinimum" = 0))]
        stop_at_coverage_percent: Option<f64> = None,
        /// A robot that has not moved `stuck-distance-m` within this time (s) is stuck, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stuck_after_s: f64 = 60.0,
        /// See `stuck-after-s` (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stuck_distance_m: f64 = 0.5,
        /// The robot starts off the manifest's start by up to this (m) in x and in y, uniform, 0 or more.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0))]
        start_jitter_m: f64 = 0.0,
        /// ... and turned by up to this (degrees) to either side, uniform, 0 to 180.
        #[serde(skip_serializing_if = "is_default")]
        #[schemars(range(min = 0.0, max = 180.0))]
        start_jitter_deg: f64 = 0.0,
    }
);

// Parameters that came later are written out only where they are not at their default, so that the trials of manifests
// from before them keep their keys. Nothing is lost: a key means what this version's defaults say, and a default that
// changes raises the engine version.

/// Returns whether a parameter is at its type's default.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Returns whether a robot is as patient as it was before that was a parameter (s).
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
#[expect(clippy::float_cmp, reason = "the very number")]
fn is_usual_patience(value: &f64) -> bool {
    *value == 15.0
}

/// Returns whether a parameter is `N`.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is<const N: u32>(value: &u32) -> bool {
    *value == N
}

/// Returns whether a parameter is `N` / 1000.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_thousandths<const N: u32>(value: &f64) -> bool {
    *value == f64::from(N) / 1000.0
}
