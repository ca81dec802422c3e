//! Where links, joints and frames of a model are: each by a pose relative to another.

use super::NOWHERE;
use crate::document::xml::{self, Faults};
use crate::document::{sdf, suggestion};
use crate::geometry::Placement;
use roxmltree::Node;
use std::collections::BTreeMap;

/// The frame of a model itself.
const MODEL: &str = "__model__";

/// How far frames may be relative to one another.
const MAX_STEPS: usize = 64;

/// A frame by its pose in another.
struct Frame<'a, 'i> {
    node: Node<'a, 'i>,
    pose: Placement,
    /// The other; `None` for the robot's own.
    within: Option<String>,
}

/// The frames of a model and of those in it, by their names with the models' before them.
#[derive(Default)]
pub(super) struct Frames<'a, 'i>(BTreeMap<String, Frame<'a, 'i>>);

impl<'a, 'i> Frames<'a, 'i> {
    /// Takes the frames of `model`, whose names begin with `prefix`.
    pub(super) fn collect(
        &mut self,
        model: Node<'a, 'i>,
        prefix: &str,
        depth: usize,
        faults: &mut Faults<'_>,
    ) {
        let own = format!("{prefix}{MODEL}");
        if prefix.is_empty() {
            self.0.insert(own.clone(), Frame { node: model, pose: NOWHERE, within: None });
        }
        for node in xml::elements(model) {
            let kind = node.tag_name().name();
            let Some(name) = node.attribute("name") else { continue };
            let default = match kind {
                "joint" => xml::child(node, "child").map(xml::text).unwrap_or_default(),
                "frame" => node.attribute("attached_to").unwrap_or_default(),
                "link" | "model" => "",
                _ => continue,
            };
            let sdf::Pose { frame, placement } = sdf::pose(node, faults);
            let within = match frame.as_deref().unwrap_or(default) {
                "" => own.clone(),
                other => format!("{prefix}{other}"),
            };
            let name = if kind == "model" {
                format!("{prefix}{name}::{MODEL}")
            } else {
                format!("{prefix}{name}")
            };
            self.0.insert(name, Frame { node, pose: placement, within: Some(within) });
            if kind == "model" && depth > 0 {
                let prefix = format!("{prefix}{}::", node.attribute("name").unwrap_or_default());
                self.collect(node, &prefix, depth - 1, faults);
            }
        }
    }

    /// Returns whether there is a frame `name`.
    pub(super) fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// Returns the placement of the frame `name` in the robot's; a fault where it is relative to nothing.
    pub(super) fn placement(&self, name: &str, faults: &mut Faults<'_>) -> Option<Placement> {
        let mut frame = self.0.get(name)?;
        let mut placement = frame.pose;
        let first = frame.node;
        for _ in 0..MAX_STEPS {
            let Some(within) = &frame.within else { return Some(placement) };
            // A model's name stands for its frame.
            let found = self.0.get(within).or_else(|| self.0.get(&format!("{within}::{MODEL}")));
            let Some(outer) = found else {
                let mut fault = faults
                    .at(frame.node, format!("`{name}` is relative to an unknown frame `{within}`"));
                if let Some(near) = suggestion(within, self.0.keys().map(String::as_str)) {
                    fault = fault.help(format!("did you mean `{near}`?"));
                }
                faults.push(fault);
                return None;
            };
            placement = outer.pose.compose(&placement);
            frame = outer;
        }
        let fault = faults.at(first, format!("`{name}` is relative to itself"));
        faults.push(fault.label("expected frames that lead to the model's own"));
        None
    }
}
