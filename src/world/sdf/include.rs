//! `<include>`: a model that is described in a file of its own.

use super::files::{FilePath, Root, Unplaced, last_name};
use super::known_version;
use super::model::{Lack, Nested, nested, says_yes};
use super::notes::{Kind, Place};
use super::reader::{File, Reader};
use crate::document::xml::{self, Faults};
use crate::document::{Source, sdf};
use roxmltree::Node;

/// What an include comes to.
pub(super) enum Read {
    /// Nothing solid: Gazebo's own light and floor, or a fault that has been told.
    Nothing,
    /// The model is missing.
    Lack(Lack),
    /// A model.
    Model(Nested),
}

/// Reads an `<include>` and the file that it names.
pub(super) fn read(
    include: Node<'_, '_>,
    file: &File<'_>,
    depth: usize,
    reader: &mut Reader<'_>,
    faults: &mut Faults<'_>,
) -> Read {
    let Some(uri) = xml::child(include, "uri").map(xml::text).filter(|uri| !uri.is_empty()) else {
        let fault = faults.at(include, "<include> has no <uri>").label("expected a model's");
        faults.push(fault);
        return Read::Nothing;
    };
    let name = last_name(uri);
    if matches!(name.to_ascii_lowercase().replace(' ', "_").as_str(), "sun" | "ground_plane") {
        return Read::Nothing;
    }
    let own = xml::child(include, "name").map(xml::text).filter(|name| !name.is_empty());
    let model = match reader.model(uri, file.path, depth, &|message| faults.at(include, message)) {
        Loaded::Model(model) => model,
        Loaded::Nothing => return Read::Nothing,
        Loaded::Absent(kind) => {
            let place = Place::of(file.source, include);
            let name = own.unwrap_or(&name).to_owned();
            return Read::Lack(Lack { name, told_as: Some(uri.to_owned()), kind, place });
        }
    };
    let mut nested = nested(model);
    if let Some(own) = own {
        own.clone_into(&mut nested.name);
    }
    if let Some(fixed) = says_yes(include, "static") {
        nested.fixed = fixed;
    }
    if xml::child(include, "pose").is_some() {
        nested.pose = sdf::pose(include, faults);
    }
    if let Some(frame) = xml::child(include, "placement_frame") {
        xml::text(frame).clone_into(&mut nested.placement_frame);
    }
    nested.merged = include.attribute("merge").is_some_and(|v| matches!(v, "1" | "true"));
    Read::Model(nested)
}

/// What came of the file of an include.
pub(super) enum Loaded {
    /// A model.
    Model(std::sync::Arc<super::model::Model>),
    /// A light, or a file whose faults have been told.
    Nothing,
    /// No model can be had: it is missing.
    Absent(Kind),
}

/// Says why there is no model that `uri` names, which may lie in `places`.
pub(super) fn absent(
    uri: &str,
    places: &Result<Vec<FilePath>, Unplaced>,
    reader: &Reader<'_>,
) -> Kind {
    let because = |why: String| Kind::Include { uri: uri.to_owned(), why };
    match places {
        Ok(places) if places.iter().any(|place| place.root != Root::ModelPath) => {
            let own = places.iter().filter(|place| place.root != Root::ModelPath);
            let named: Vec<String> = own.map(|p| format!("`{}`", reader.name(p))).collect();
            because(format!("no `model.config` or `model.sdf` in {}", named.join(", ")))
        }
        Ok(_) | Err(Unplaced::NoFolder(_)) => Kind::Unfound(reader.folders.path.clone()),
        Err(Unplaced::Untold) if uri.contains("://") => Kind::Unfound(reader.folders.path.clone()),
        Err(Unplaced::Untold) => because("it names no model".to_owned()),
        Err(why) => because(why.to_string()),
    }
}

/// Returns the file that describes the model of this `model.config`: of the highest version that is known, as Gazebo
/// chooses.
pub(super) fn description(config: &Source) -> Option<String> {
    let document = xml::parse(config, MAX_CONFIG).ok()?;
    let described = xml::elements(document.root_element()).filter(|e| e.tag_name().name() == "sdf");
    let mut best: Option<(u32, String)> = None;
    for element in described {
        let known = element.attribute("version").map(known_version);
        let rank = match known {
            None => 1,
            Some(None) => 0,
            Some(Some(minor)) => 2 + minor,
        };
        let file = xml::text(element);
        let leads_out =
            file.is_empty() || file.starts_with('/') || file.split(['/', '\\']).any(|s| s == "..");
        if !leads_out && best.as_ref().is_none_or(|(least, _)| rank > *least) {
            best = Some((rank, file.to_owned()));
        }
    }
    best.map(|(_, file)| file)
}

/// Longest `model.config` read (bytes).
const MAX_CONFIG: usize = 1 << 20;
