//! Poses and the frames that they are relative to, after SDFormat's pose frame semantics: links, joints, frames and
//! models of one scope are frames of each other, those of a nested model by `model::name`.

use super::model::Model;
use crate::document::known_or_near;
use crate::document::sdf::Pose;
use crate::geometry::Placement;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Why a frame has no place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Unplaceable {
    /// There is no frame of that name.
    Unknown(String),
    /// Each is relative to the next, and the last to the first.
    Cycle(Vec<String>),
    /// One of the two, of a frame that it is relative to, which has been told.
    Told,
}

/// A frame: what it is relative to, and where it is there.
#[derive(Debug)]
struct Entry {
    parent: String,
    local: Placement,
}

/// The frames of one model, or of the world.
#[derive(Debug)]
pub(super) struct Frames {
    /// The name of its own frame: `__model__` or `world`.
    own: &'static str,
    entries: BTreeMap<String, Entry>,
    placed: BTreeMap<String, Placement>,
    /// Those that have no place.
    lost: BTreeSet<String>,
    models: BTreeMap<String, Arc<Model>>,
    /// Models whose parts are parts of this one: the frames of theirs, by the name of the entry of their own.
    merged: Vec<String>,
}

/// A step on the way from a frame to the model's own.
enum Step {
    /// A frame of this scope.
    Entry(String),
    /// The frame `rest` of the nested model that goes before.
    Within(Arc<Model>, String),
}

impl Frames {
    pub(super) fn new(own: &'static str) -> Self {
        Self {
            own,
            entries: BTreeMap::new(),
            placed: BTreeMap::new(),
            lost: BTreeSet::new(),
            models: BTreeMap::new(),
            merged: Vec::new(),
        }
    }

    /// Adds the frame `name` at `pose`, which is relative to `otherwise` where it does not say. Of two of one name the
    /// first counts.
    pub(super) fn add(&mut self, name: &str, pose: &Pose, otherwise: &str) {
        let parent = pose.frame.clone().unwrap_or_else(|| otherwise.to_owned());
        let entry = Entry { parent, local: pose.placement };
        self.entries.entry(name.to_owned()).or_insert(entry);
    }

    /// Adds a nested model, at a pose that is already that of its own frame.
    pub(super) fn add_model(&mut self, name: &str, pose: &Pose, model: &Arc<Model>, merged: bool) {
        let name = if merged {
            let name = format!("_merged__{name}__{}", self.merged.len());
            self.merged.push(name.clone());
            name
        } else {
            name.to_owned()
        };
        self.add(&name, pose, self.own);
        self.models.entry(name).or_insert_with(|| Arc::clone(model));
    }

    /// Returns what a pose places, in the model's own frame; a pose that does not say is relative to `otherwise`.
    pub(super) fn place(
        &mut self,
        pose: &Pose,
        otherwise: Option<&str>,
    ) -> Result<Placement, Unplaceable> {
        match pose.frame.as_deref().or(otherwise) {
            None => Ok(pose.placement),
            Some(frame) if self.is_own(frame) => Ok(pose.placement),
            Some(frame) => Ok(self.locate(frame)?.compose(&pose.placement)),
        }
    }

    /// Returns all frames that have a place.
    pub(super) fn into_placed(mut self) -> BTreeMap<String, Placement> {
        let names: Vec<String> = self.entries.keys().cloned().collect();
        for name in names {
            // Frames that lead nowhere are told where they are used.
            let _ = self.locate(&name);
        }
        self.placed
    }

    /// Says what may have been meant by `name`.
    pub(super) fn near(&self, name: &str) -> String {
        let known: Vec<&str> = self.entries.keys().map(String::as_str).collect();
        known_or_near(name, &known)
    }

    fn is_own(&self, name: &str) -> bool {
        name.is_empty() || name == self.own
    }

    /// Returns where the frame `name` is in the model's own.
    fn locate(&mut self, name: &str) -> Result<Placement, Unplaceable> {
        let mut met = BTreeSet::new();
        let found = self.follow(name, &mut met);
        if found.is_err() {
            self.lost.append(&mut met);
        }
        found
    }

    /// Follows frame by frame from `name` to the model's own, and notes those that it meets.
    fn follow(&mut self, name: &str, met: &mut BTreeSet<String>) -> Result<Placement, Unplaceable> {
        let mut way = Vec::new();
        let mut at = name.to_owned();
        let mut placement = loop {
            if self.is_own(&at) {
                break Placement::IDENTITY;
            }
            if let Some(known) = self.placed.get(&at) {
                break *known;
            }
            if self.lost.contains(&at) {
                return Err(Unplaceable::Told);
            }
            if !met.insert(at.clone()) {
                let names = way.iter().filter_map(|step| match step {
                    Step::Entry(name) => Some(name.clone()),
                    Step::Within(..) => None,
                });
                return Err(Unplaceable::Cycle(names.skip_while(|name| *name != at).collect()));
            }
            if let Some(entry) = self.entries.get(&at) {
                let parent = entry.parent.clone();
                way.push(Step::Entry(at));
                at = parent;
            } else if let Some((model, rest)) = at.split_once("::")
                && let Some(found) = self.models.get(model)
            {
                let model = model.to_owned();
                way.push(Step::Within(Arc::clone(found), rest.to_owned()));
                at = model;
            } else if let Some(merged) =
                self.merged.iter().find(|m| self.models[*m].frame(&at).is_some())
            {
                let (model, merged) = (Arc::clone(&self.models[merged]), merged.clone());
                way.push(Step::Within(model, at));
                at = merged;
            } else {
                return Err(Unplaceable::Unknown(at));
            }
        };
        for step in way.into_iter().rev() {
            match step {
                Step::Entry(name) => {
                    let entry = &self.entries[&name];
                    let is_first = self.is_own(&entry.parent);
                    // Nothing is added to what is relative to the model itself, not even zeros.
                    placement =
                        if is_first { entry.local } else { placement.compose(&entry.local) };
                    self.placed.insert(name, placement);
                }
                Step::Within(model, rest) => {
                    let inner = model.frame(&rest).ok_or(Unplaceable::Unknown(rest))?;
                    placement = placement.compose(&inner);
                }
            }
        }
        Ok(placement)
    }
}
