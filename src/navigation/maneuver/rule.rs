//! The parameters of the pilot: speeds, gains and distances. The paper gives none of them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Highest speeds of a maneuver.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct SpeedLimits {
    /// Highest linear speed (m/s), above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub linear_m_s: f64,
    /// Highest angular speed (rad/s), above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub angular_rad_s: f64,
}

/// Where the heading comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HeadingSource {
    /// The compass tells the quarter, the walls in the scan the rest: the building is orthogonal (section 3).
    Walls,
    /// The compass alone.
    Compass,
}

/// What the way through a door is steered by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DoorGuidance {
    /// The gap's edges in the scan: the robot aligns itself with the door's axis before it passes.
    Laser,
    /// The tag of the vertex behind the door and the heading, as the paper's "door, as identified by the IDS"; the laser only
    /// keeps the body clear. A door that is not on the line to its tag is not found.
    Tag,
}

macro_rules! rule {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty = $default:expr,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    };
}

rule!(
    /// How the six maneuvers are driven. All of it is ours: the paper names the maneuvers and gives no numbers.
    PilotRule {
        /// Speeds of the slow maneuvers.
        slow: SpeedLimits = SpeedLimits { linear_m_s: 0.33, angular_rad_s: 0.5 },
        /// Speeds of the fast maneuvers.
        fast: SpeedLimits = SpeedLimits { linear_m_s: 0.6, angular_rad_s: 0.9 },
        /// Where the heading comes from.
        heading: HeadingSource = HeadingSource::Walls,
        /// Share of the difference to the compass by which one reading corrects the heading, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        compass_gain: f64 = 0.05,
        /// Share of the difference to the walls by which one scan corrects the heading, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        wall_gain: f64 = 0.4,
        /// Turning speed per error of heading (1/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        turn_gain_per_s: f64 = 2.0,
        /// A turn in place ends within this error of heading (rad), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        turn_tolerance_rad: f64 = 0.035,
        /// Above this error of heading (rad) the robot turns in place instead of driving a curve, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        pivot_rad: f64 = 0.5,
        /// Slowest motion that is commanded on the way to a point (m/s), above 0: slower ones take for ever.
        #[schemars(extend("exclusiveMinimum" = 0))]
        creep_m_s: f64 = 0.08,
        /// Slowest turn in place that is commanded (rad/s), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        creep_rad_s: f64 = 0.08,
        /// Before a turn the robot drives up to the vertex that it is told to have reached, where that is no farther ahead than
        /// this (m), 0 or more; 0 turns on the spot.
        #[schemars(range(min = 0.0))]
        settle_within_m: f64 = 1.0,
        /// ... until it is no farther ahead than this (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        settled_m: f64 = 0.03,
        /// Legs whose direction differs less from the heading (rad) go straight on instead, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        straight_on_rad: f64 = 0.35,
        /// Largest angle to a line that is followed (rad), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        line_angle_rad: f64 = 0.6,
        /// The line to follow is steered for at this distance ahead (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        lookahead_m: f64 = 0.8,
        /// Walls of a corridor are looked for up to this distance ahead (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        corridor_ahead_m: f64 = 3.0,
        /// What the way through a door is steered by.
        door_guidance: DoorGuidance = DoorGuidance::Laser,
        /// Narrowest gap taken for a door (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_narrowest_m: f64 = 0.7,
        /// Widest gap taken for a door (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_widest_m: f64 = 1.4,
        /// A door's axis is looked for this far to either side of the way to the tag (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_reach_m: f64 = 0.8,
        /// Distance of the robot's middle from the door's plane at which it must be aligned (m), above 0. More than
        /// the swing radius, so that it can turn there.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_stage_m: f64 = 0.6,
        /// Offset from the door's axis (m) up to which it counts as aligned, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_offset_m: f64 = 0.05,
        /// Error of heading (rad) up to which it counts as aligned, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_heading_rad: f64 = 0.05,
        /// Distance of the robot's middle before the door's plane at which it commits itself (m), above 0: from there on
        /// it keeps its heading and no longer corrects its offset. Below 0.3 m the laser sees the edges no more.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_commit_m: f64 = 0.3,
        /// In a door the axis is steered for at this distance ahead (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_lookahead_m: f64 = 0.6,
        /// Largest angle to the axis on the way through a door (rad), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_angle_rad: f64 = 0.12,
        /// A door is passed when the body is farther beyond its plane than this (m), above 0: the thickest wall.
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_depth_m: f64 = 0.25,
        /// Distance to the body (m) below which nothing that the laser sees may come by the robot's own motion, 0 or more.
        #[schemars(range(min = 0.0))]
        clearance_m: f64 = 0.03,
        /// How far ahead in time that is looked for (s), 0 or more; 0 looks for nothing.
        #[schemars(range(min = 0.0))]
        guard_s: f64 = 0.5,
        /// A robot held up this long (s) backs off, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        blocked_s: f64 = 1.0,
        /// How far it backs off (m), above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        back_off_m: f64 = 0.35,
        /// How fast it backs off (m/s), above 0: there is no laser behind.
        #[schemars(extend("exclusiveMinimum" = 0))]
        back_off_m_s: f64 = 0.15,
        /// How often it backs off on one leg before it stands still.
        back_off_times: u32 = 5,
        /// The robot stops where the vertex is no further ahead than this (m), 0 or more.
        #[schemars(range(min = 0.0))]
        stop_m: f64 = 0.05,
    }
);
