//! `<state>`: where the models of a saved world stand, whatever their descriptions say.

use crate::document::sdf;
use crate::document::xml::{self, Faults};
use crate::geometry::Placement;
use roxmltree::Node;
use std::collections::BTreeMap;

/// What the `<state>` says of one model.
#[derive(Default)]
pub(super) struct State<'a, 'i> {
    /// Links and models within, by kind and name.
    parts: BTreeMap<(&'a str, &'a str), Node<'a, 'i>>,
    /// Its pose in the world.
    pub(super) placement: Option<Placement>,
    pub(super) scale: Option<[f64; 3]>,
}

impl<'a, 'i> State<'a, 'i> {
    /// Reads the state of the world, or of a model.
    pub(super) fn read(node: Option<Node<'a, 'i>>, faults: &mut Faults<'_>) -> Self {
        let Some(node) = node else { return Self::default() };
        let placement = xml::child(node, "pose").map(|_| sdf::pose(node, faults).placement);
        let scale = xml::child(node, "scale").and_then(|n| {
            let scale = faults.numbers::<3>(n)?;
            if scale.iter().all(|factor| *factor > 0.0) {
                return Some(scale);
            }
            let fault =
                faults.at(n, "scale out of range").label("expected three factors above zero");
            faults.push(fault);
            None
        });
        let mut parts = BTreeMap::new();
        for element in xml::elements(node) {
            let kind = element.tag_name().name();
            if let ("link" | "model", Some(name)) = (kind, element.attribute("name")) {
                parts.insert((kind, name), element);
            }
        }
        Self { parts, placement, scale }
    }

    /// Returns whether anything is said.
    pub(super) fn is_said(&self) -> bool {
        self.placement.is_some() || self.scale.is_some() || !self.parts.is_empty()
    }

    /// Returns the state of the model `name` within.
    pub(super) fn model(&self, name: &str, faults: &mut Faults<'_>) -> Self {
        State::read(self.parts.get(&("model", name)).copied(), faults)
    }

    /// Returns where the link `name` is in the world, if that is said.
    pub(super) fn link(&self, name: &str, faults: &mut Faults<'_>) -> Option<Placement> {
        let node = *self.parts.get(&("link", name))?;
        xml::child(node, "pose").map(|_| sdf::pose(node, faults).placement)
    }
}
