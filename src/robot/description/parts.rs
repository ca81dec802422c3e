//! The parts of a robot, in whichever format they were described.

use super::shape::ShapeKind;
use crate::geometry::Placement;
use roxmltree::Node;
use std::collections::BTreeMap;

/// The parts of a robot, placed in its base frame.
pub(in crate::robot) struct Parts<'a, 'i> {
    pub(in crate::robot) name: String,
    /// The element that holds them all.
    pub(in crate::robot) root: Node<'a, 'i>,
    /// Links by name.
    pub(in crate::robot) links: BTreeMap<String, Placement>,
    /// Masses of the links (kg), in their order.
    pub(in crate::robot) masses: Vec<f64>,
    pub(in crate::robot) collisions: Vec<Collision<'a, 'i>>,
    pub(in crate::robot) joints: Vec<Joint>,
    /// Plugins of the whole robot.
    pub(in crate::robot) plugins: Vec<Node<'a, 'i>>,
    pub(in crate::robot) sensors: Vec<Mounted<'a, 'i>>,
    /// Height of the floor in the base frame (m), where a link says.
    pub(in crate::robot) floor: Option<f64>,
}

/// What a link collides with.
pub(in crate::robot) struct Collision<'a, 'i> {
    pub(in crate::robot) node: Node<'a, 'i>,
    pub(in crate::robot) link: String,
    pub(in crate::robot) geometry: Geometry,
    pub(in crate::robot) placement: Placement,
}

/// The form of a collision.
#[derive(Debug, Clone)]
pub(in crate::robot) enum Geometry {
    Simple(ShapeKind),
    Mesh {
        uri: String,
        scale: [f64; 3],
    },
    /// One that is not read, by its element.
    Other(&'static str),
}

/// A joint.
#[derive(Debug, Clone)]
pub(in crate::robot) struct Joint {
    pub(in crate::robot) name: String,
    pub(in crate::robot) child: String,
    pub(in crate::robot) placement: Placement,
    /// Whether it turns about an axis.
    pub(in crate::robot) turns: bool,
}

/// A sensor on its link.
pub(in crate::robot) struct Mounted<'a, 'i> {
    /// The `<sensor>`.
    pub(in crate::robot) node: Node<'a, 'i>,
    /// Where its link is, and where faults about that go; no placement where it is on none.
    pub(in crate::robot) link: Option<Placement>,
    pub(in crate::robot) around: Node<'a, 'i>,
}

/// The two formats' names for a form that is no box, cylinder, sphere or mesh.
pub(in crate::robot) fn other_form(name: &str) -> &'static str {
    const KNOWN: [&str; 6] = ["plane", "polyline", "heightmap", "ellipsoid", "cone", "image"];
    KNOWN.into_iter().find(|known| *known == name).unwrap_or("geometry")
}
