//! Planning on the map and driving on the scan, after Nav2D's behaviour (prior-map facts, section 4):
//! inflation, weighted wavefront, and an operator that samples arcs.
//!
//! [`maneuver`] has the deadline study's six maneuvers, which need no map.
//!
//! A mind: it sees maps and messages, never the simulator or the world.

mod arcs;
mod costmap;
mod following;
mod inflated_map;
mod inflation;
mod local;
pub mod maneuver;
mod wavefront;

pub use arcs::{Operator, OperatorRule, Steering};
pub use costmap::CostGrid;
pub use following::{look_ahead, nearest, nearest_reached};
pub use inflated_map::{Ground, InflatedMap};
pub use inflation::inflate;
pub use local::{LocalMap, LocalRule};
pub use wavefront::{RestingWave, UNREACHED, Wavefront};
