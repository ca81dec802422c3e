//! The solids of a world: every model where it stands, the state's word before the description's.

use super::body::{self, Refused};
use super::geometry::Shape;
use super::model::{Child, Link, Model, Part};
use super::notes::{Kind, Notes, Place};
use super::state::State;
use super::{LAYER, files::Models};
use crate::document::quoted;
use crate::document::xml::Faults;
use crate::geometry::Placement;
use crate::world::Solid;

/// Most models, links and collisions of a world, those of included files counted as often as they stand in it.
pub(super) const MAX_INSTANCES: usize = 1_000_000;

/// Most triangles of a world, counted likewise.
pub(super) const MAX_TRIANGLES: usize = 1 << 22;

/// Most bytes of the names of solids.
const MAX_NAMES: usize = 1 << 28;

/// Farthest (m) from the origin that anything stands; what is farther off is missing.
const MAX_DISTANCE: f64 = 1e5;

/// A model where it stands.
struct Standing<'p> {
    /// Its name, and those of the models that it is in.
    name: &'p str,
    placement: Placement,
    /// Whether nothing moves it.
    fixed: bool,
}

/// Collects solids.
pub(super) struct Placer<'r, 'f, 's> {
    pub(super) solids: Vec<Solid>,
    pub(super) models: &'r mut dyn Models,
    pub(super) notes: &'r mut Notes,
    /// Faults of the world's file.
    pub(super) faults: &'f mut Faults<'s>,
    pub(super) budget: Budget,
    /// How many of the solids can move.
    pub(super) moving: usize,
    /// Whether there is more than the budget allows, which has been told.
    pub(super) is_full: bool,
}

/// What may still be placed.
pub(super) struct Budget {
    pub(super) instances: usize,
    pub(super) triangles: usize,
    pub(super) names: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { instances: MAX_INSTANCES, triangles: MAX_TRIANGLES, names: MAX_NAMES }
    }
}

impl Budget {
    /// Takes these from what is left; returns whether there was enough.
    fn take(&mut self, triangles: usize, names: usize) -> bool {
        let left = (
            self.instances.checked_sub(1),
            self.triangles.checked_sub(triangles),
            self.names.checked_sub(names),
        );
        let (Some(instances), Some(triangles), Some(names)) = left else { return false };
        *self = Self { instances, triangles, names };
        true
    }
}

impl Placer<'_, '_, '_> {
    /// Places everything in `world`.
    pub(super) fn world(&mut self, world: &Model, state: &State<'_, '_>) {
        let standing = Standing { name: "", placement: Placement::IDENTITY, fixed: false };
        self.parts(world, &standing, state, "");
    }

    /// Places the parts of `model`; `nested` is the way from the model whose state is `state`: `inner::`.
    fn parts(
        &mut self,
        model: &Model,
        standing: &Standing<'_>,
        state: &State<'_, '_>,
        nested: &str,
    ) {
        for part in &model.parts {
            let (name, place) = match part {
                Part::Link(link) => (&link.name, &link.place),
                Part::Model(child) => (&child.name, &child.place),
                Part::Lack(lack) => (&lack.name, &lack.place),
            };
            if !self.take(0, standing.name.len() + name.len(), place) {
                return;
            }
            match part {
                Part::Link(link) => self.link(link, standing, state, nested),
                Part::Model(child) => self.child(child, standing, state, nested),
                Part::Lack(lack) => {
                    let name = joined(standing.name, &lack.name);
                    if self.models.wanted(&name) {
                        let name = lack.told_as.as_ref().unwrap_or(&name);
                        self.notes.add(&lack.kind, name, Some(&lack.place));
                    }
                }
            }
        }
    }

    fn child(&mut self, child: &Child, outer: &Standing<'_>, state: &State<'_, '_>, nested: &str) {
        let fixed = outer.fixed || child.fixed;
        if child.merged {
            let placement = outer.placement.compose(&child.placement);
            let standing = Standing { name: outer.name, placement, fixed };
            return self.parts(&child.model, &standing, state, nested);
        }
        let name = joined(outer.name, &child.name);
        if !self.models.wanted(&name) {
            return;
        }
        let own = state.model(&child.name, self.faults);
        // Poses in a state are in the world's frame, those of links and nested models too.
        let placement = own.placement.unwrap_or_else(|| outer.placement.compose(&child.placement));
        let standing = Standing { name: &name, placement, fixed };
        let before = self.moving;
        // Older states name the links of a nested model `inner::link`, and say nothing of the model.
        let said = own.is_said();
        let way = if said { String::new() } else { format!("{nested}{}::", child.name) };
        self.parts(&child.model, &standing, if said { &own } else { state }, &way);
        if outer.name.is_empty() && self.moving > before {
            self.notes.add(&Kind::Moves, &name, Some(&child.place));
        }
    }

    fn link(&mut self, link: &Link, standing: &Standing<'_>, state: &State<'_, '_>, nested: &str) {
        let said = if nested.is_empty() {
            state.link(&link.name, self.faults)
        } else {
            state.link(&format!("{nested}{}", link.name), self.faults)
        };
        let placement = said.unwrap_or_else(|| standing.placement.compose(&link.placement));
        let own = joined(standing.name, &link.name);
        // The scale of a model is that of its own parts.
        let scale = state.scale.filter(|_| nested.is_empty()).unwrap_or([1.0; 3]);
        for collision in &link.collisions {
            let placement = placement.compose(&collision.placement);
            let name = joined(&own, &collision.name);
            let triangles = match &collision.shape {
                Shape::Mesh { mesh, .. } => mesh.triangles().len(),
                _ => 0,
            };
            if !self.take(triangles, name.len(), &collision.place) {
                return;
            }
            let bodies = match body::of(&collision.shape, placement, scale) {
                Ok(bodies) => bodies,
                Err(Refused::Lack(kind)) => {
                    self.notes.add(&kind, &name, Some(&collision.place));
                    continue;
                }
                Err(Refused::TooLarge(length)) => {
                    let fault = collision.place.fault(format!("`{name}` is out of range"));
                    self.faults.push(fault.label(format!("its scale makes it {length} m long")));
                    continue;
                }
                Err(Refused::Leans) => {
                    let fault = collision.place.fault("what stands in for this mesh would lean");
                    let label = "expected an upright pose: stand-ins are upright";
                    self.faults.push(fault.label(label));
                    continue;
                }
            };
            let off = placement.translation.iter().map(|v| v.abs()).fold(0.0, f64::max);
            if !bodies.is_empty() && (off > MAX_DISTANCE || !off.is_finite()) {
                let far = Kind::Far(format!("{off:.0}"));
                self.notes.add(&far, &name, Some(&collision.place));
                continue;
            }
            for body in bodies {
                self.moving += usize::from(!standing.fixed);
                self.solids.push(Solid { name: name.clone(), layer: LAYER.to_owned(), body });
            }
        }
    }

    /// Takes what stands at `place` from the budget, or tells that there is nothing left.
    fn take(&mut self, triangles: usize, names: usize, place: &Place) -> bool {
        if !self.is_full && !self.budget.take(triangles, names) {
            self.is_full = true;
            self.faults.push(place.fault("the world is too large").label(format!(
                "expected at most {MAX_INSTANCES} models, links and collisions and {MAX_TRIANGLES} triangles, includes counted as often as they stand in it"
            )));
        }
        !self.is_full
    }
}

/// Returns the name of the part `name` of `outer`.
fn joined(outer: &str, name: &str) -> String {
    match outer {
        "" => quoted(name).into_owned(),
        outer => format!("{outer}/{}", quoted(name)),
    }
}
