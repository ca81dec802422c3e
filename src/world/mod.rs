//! The truth as described: solid things in named layers, regions, tags, starts and goals.
//!
//! The mind never imports this module. Metres and radians; z up from the floor.

pub mod document;
#[cfg(test)]
mod fixture;
pub mod floor;
pub mod floor_plan;
pub mod formats;
pub mod generate;
pub mod map_server;
pub mod mesh;
#[cfg(test)]
pub(crate) mod originals;
pub mod sdf;
mod solid;
pub mod topology;

pub use crate::geometry::Placement;
pub use solid::{Body, Solid};

use crate::digest::{MeaningDigest, Sha256Digest};
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::json;
use serde::Serialize;
use std::collections::BTreeMap;

/// The end of every warning of something that could not be read: `it is missing`, or `12 are missing`.
const MISSING: &str = " missing";

/// A building: everything that a robot can see or touch, or that can be its goal.
///
/// ```
/// use reenact::document::Source;
/// use reenact::world;
///
/// let text = std::fs::read_to_string("worlds/basic.yaml").unwrap();
/// let world = world::document::read(&Source::new("basic.yaml", text), None).unwrap();
/// assert_eq!(world.layers(), ["furniture", "walls"]);
/// // A lidar at 2 m looks over the furniture.
/// assert!(world.slice(2.0).len() < world.slice(0.2).len());
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct World {
    /// Name, for people; not part of the meaning.
    #[serde(skip)]
    pub name: String,
    /// Solid things, in the order written. Those of one layer need not stand together.
    pub solids: Vec<Solid>,
    /// Rooms and corridors.
    pub regions: Vec<Region>,
    /// The tags that a logical camera can detect.
    pub tags: Vec<Tag>,
    /// Named start poses.
    pub starts: BTreeMap<String, Pose>,
    /// Named goals (m).
    pub goals: BTreeMap<String, Point>,
    /// Whatever could not be read, each warning naming the thing; never a silent hole.
    #[serde(skip)]
    pub warnings: Vec<String>,
}

/// A named part of the floor.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Region {
    /// Name, unique in the world.
    pub name: String,
    /// Room or corridor.
    pub kind: RegionKind,
    /// Corners in order (m), at least three.
    pub polygon: Vec<Point>,
}

/// The two kinds of region of the deadline study (section 3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RegionKind {
    /// A room.
    Room,
    /// A corridor.
    Corridor,
}

/// A mark that a logical camera detects: an opaque id, a colour and a pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Tag {
    /// Opaque id, unique in the world.
    pub id: String,
    /// Colour, by name.
    pub color: String,
    /// Its pose (m, rad).
    pub pose: Pose,
}

impl World {
    /// Returns the names of all layers, sorted.
    pub fn layers(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.solids.iter().map(|s| s.layer.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Returns how many things of the file could not be read and are therefore missing; each kind has its warning.
    pub fn missing(&self) -> usize {
        let ends = self.warnings.iter().filter_map(|warning| warning.strip_suffix(MISSING));
        let count = |end: &str| {
            let before = end.strip_suffix(" are")?;
            before.rsplit(' ').next()?.parse().ok()
        };
        ends.map(|end| count(end).unwrap_or(1)).sum()
    }

    /// Moves the goal to `to`, with the tag that marks it: the one of a colour that no other tag has. Returns whether there is one
    /// goal.
    pub fn move_goal(&mut self, to: Point) -> bool {
        let mut goals = self.goals.values_mut();
        let (Some(goal), None) = (goals.next(), goals.next()) else { return false };
        let by = to - *goal;
        *goal = to;
        let colors: Vec<String> = self.tags.iter().map(|tag| tag.color.clone()).collect();
        for tag in &mut self.tags {
            if colors.iter().filter(|color| **color == tag.color).count() == 1 {
                let at = tag.pose.position() + by;
                tag.pose = Pose::new(at.x, at.y, tag.pose.heading);
            }
        }
        true
    }

    /// Returns the outlines of everything cut by the plane at height `z` (m): what a lidar at that height sees.
    pub fn slice(&self, z: f64) -> Vec<Outline> {
        self.solids.iter().flat_map(|solid| solid.body.slice(z)).collect()
    }

    /// Returns the outlines of everything between the heights `low` and `high` (m): what a body of that height touches.
    pub fn contact(&self, low: f64, high: f64) -> Vec<Outline> {
        self.solids.iter().flat_map(|solid| solid.body.shadow(low, high)).collect()
    }

    /// Returns the solid that is nearest to `at` of those between the heights `low` and `high` (m), and how far it is (m).
    pub fn nearest(&self, at: Point, low: f64, high: f64) -> Option<(&Solid, f64)> {
        let distance = |solid: &Solid| {
            let outlines = solid.body.shadow(low, high);
            outlines.iter().map(|o| o.distance(at)).fold(f64::INFINITY, f64::min)
        };
        let known = self.solids.iter().map(|solid| (solid, distance(solid)));
        known.filter(|(_, far)| far.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the smallest box around all solids.
    pub fn bounds(&self) -> Bounds {
        self.solids
            .iter()
            .flat_map(|solid| solid.body.shadow(f64::NEG_INFINITY, f64::INFINITY))
            .fold(Bounds::EMPTY, |bounds, outline| bounds.union(outline.bounds()))
    }

    /// Returns the digest of the description's meaning: without names of files, comments or formatting.
    pub fn meaning(&self) -> MeaningDigest {
        MeaningDigest(Sha256Digest::of(json::canonical_of(self)))
    }
}
