//! Models, links and collisions, placed one inside the other.

use super::{Models, geometry};
use crate::document::xml::{self, Faults};
use crate::geometry::Placement;
use crate::world::Solid;
use roxmltree::Node;

/// Where a model's own pose is given, and what its parts are called after.
pub(super) struct Place {
    pub(super) outer: Placement,
    pub(super) prefix: String,
}

/// What the `<state>` says of one model.
pub(super) struct State<'a, 'i> {
    node: Option<Node<'a, 'i>>,
    placement: Option<Placement>,
    scale: [f64; 3],
}

impl<'a, 'i> State<'a, 'i> {
    /// Reads the state's `<model>`, if there is one.
    pub(super) fn read(node: Option<Node<'a, 'i>>, faults: &mut Faults<'_>) -> Self {
        let placement = node.filter(|n| xml::child(*n, "pose").is_some());
        let placement = placement.map(|n| pose(n, faults));
        let scale = node.and_then(|n| xml::child(n, "scale"));
        let scale = scale.and_then(|n| {
            let scale = faults.numbers::<3>(n)?;
            if scale.iter().all(|factor| *factor > 0.0) {
                return Some(scale);
            }
            let fault =
                faults.at(n, "scale out of range").label("expected three factors above zero");
            faults.push(fault);
            None
        });
        Self { node, placement, scale: scale.unwrap_or([1.0; 3]) }
    }

    fn of(&self, kind: &str, name: &str) -> Option<Node<'a, 'i>> {
        xml::elements(self.node?)
            .find(|e| e.tag_name().name() == kind && e.attribute("name") == Some(name))
    }
}

/// Appends the solids of `model`; nested models are read likewise.
pub(super) fn read(
    model: Node<'_, '_>,
    place: &Place,
    state: &State<'_, '_>,
    models: &mut dyn Models,
    solids: &mut Vec<Solid>,
    faults: &mut Faults<'_>,
) {
    let name = format!("{}{}", place.prefix, model.attribute("name").unwrap_or(""));
    // Poses in a state are in the world's frame, those of links and nested models too.
    let placement = state.placement.unwrap_or_else(|| place.outer.compose(&pose(model, faults)));
    let before = solids.len();
    for element in xml::elements(model) {
        let part = element.attribute("name").unwrap_or("");
        match element.tag_name().name() {
            "link" => {
                let within = pose(element, faults);
                let link = match state.of("link", part).filter(|n| xml::child(*n, "pose").is_some())
                {
                    Some(node) => pose(node, faults),
                    None => placement.compose(&within),
                };
                let name = format!("{name}/{part}");
                read_link(element, &name, &link, state.scale, models, solids, faults);
            }
            "model" => {
                let inner = State::read(state.of("model", part), faults);
                let place = Place { outer: placement, prefix: format!("{name}/") };
                read(element, &place, &inner, models, solids, faults);
            }
            "include" => warn_of_include(element, faults),
            _ => {}
        }
    }
    let fixed = xml::child(model, "static").is_some_and(|n| matches!(xml::text(n), "1" | "true"));
    if !fixed && solids.len() > before && place.prefix.is_empty() {
        let fault = faults
            .at(model, format!("model `{name}` can move in Gazebo and stands still here"))
            .warning();
        faults.push(fault);
    }
}

fn read_link(
    link: Node<'_, '_>,
    name: &str,
    placement: &Placement,
    scale: [f64; 3],
    models: &mut dyn Models,
    solids: &mut Vec<Solid>,
    faults: &mut Faults<'_>,
) {
    for collision in xml::elements(link).filter(|e| e.tag_name().name() == "collision") {
        let placement = placement.compose(&pose(collision, faults));
        let name = format!("{name}/{}", collision.attribute("name").unwrap_or(""));
        for body in geometry::read(collision, &name, placement, scale, models, faults) {
            solids.push(Solid { name: name.clone(), layer: super::LAYER.to_owned(), body });
        }
    }
}

/// Warns that an `<include>` is not followed.
pub(super) fn warn_of_include(include: Node<'_, '_>, faults: &mut Faults<'_>) {
    let uri = xml::child(include, "uri").map_or("", xml::text);
    // Gazebo's own light and floor: nothing solid to miss.
    if matches!(uri, "model://sun" | "model://ground_plane") {
        return;
    }
    let fault = faults
        .at(include, format!("<include> of `{uri}` is not followed: the model is missing"))
        .help("save the world from Gazebo with its models written out")
        .warning();
    faults.push(fault);
}

/// Farthest (m) that anything may lie from the origin.
const MAX_DISTANCE: f64 = 1e5;

/// Reads the `<pose>` of an element: identity where it has none, or a fault where it cannot be read.
fn pose(node: Node<'_, '_>, faults: &mut Faults<'_>) -> Placement {
    let Some(pose) = xml::child(node, "pose") else { return Placement::IDENTITY };
    for frame in ["relative_to", "frame"] {
        if let Some(name) = pose.attribute(frame).filter(|name| !name.is_empty()) {
            let fault = faults
                .at(pose, format!("pose relative to `{name}` cannot be read"))
                .label("expected a pose in the parent's frame");
            faults.push(fault);
        }
    }
    if pose.attribute("rotation_format").is_some_and(|format| format != "euler_rpy") {
        let fault =
            faults.at(pose, "pose with a quaternion").label("expected x y z roll pitch yaw");
        faults.push(fault);
        return Placement::IDENTITY;
    }
    if xml::text(pose).is_empty() {
        return Placement::IDENTITY;
    }
    let Some(mut numbers) = faults.numbers::<6>(pose) else { return Placement::IDENTITY };
    if pose.attribute("degrees") == Some("true") {
        for angle in &mut numbers[3..] {
            *angle = angle.to_radians();
        }
    }
    if numbers[..3].iter().any(|coordinate| coordinate.abs() > MAX_DISTANCE) {
        let fault = faults
            .at(pose, "pose out of range")
            .label(format!("expected coordinates within {MAX_DISTANCE} m of the origin"));
        faults.push(fault);
    }
    Placement::from_xyz_rpy(numbers)
}
