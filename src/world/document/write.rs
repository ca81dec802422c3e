//! Writes a building as world YAML that people can read and edit: one solid, region or tag per line.

use super::{AreaDoc, BoxDoc, CircleDoc, LayerDoc, PolygonDoc, RegionDoc, WallDoc, WorldDoc};
use crate::json;
use std::fmt::Write as _;

/// Words that other YAML readers take for something else than text.
const NOT_TEXT: [&str; 12] =
    ["y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf", "infinity"];

impl WorldDoc {
    /// Writes the document as YAML; reading it gives the same document again.
    pub fn to_yaml(&self) -> String {
        let mut text = format!("reenact-world: {}\n", self.reenact_world);
        let _ = writeln!(text, "name: {}\nsource: {}", scalar(&self.name), scalar(&self.source));
        section(&mut text, "layers", &self.layers, |text, name, layer| {
            let _ =
                writeln!(text, "  {}:{}", scalar(name), if layer.is_empty() { " {}" } else { "" });
            write_layer(text, layer);
        });
        section(&mut text, "regions", &self.regions, |text, name, region| {
            let (kind, AreaDoc { corners_m }) = match region {
                RegionDoc::Room(area) => ("room", area),
                RegionDoc::Corridor(area) => ("corridor", area),
            };
            let name = scalar(name);
            let _ = writeln!(text, "  {name}: {{{kind}: {{corners-m: {}}}}}", points(corners_m));
        });
        section(&mut text, "tags", &self.tags, |text, id, tag| {
            let (id, color, at) = (scalar(id), scalar(&tag.color), numbers(&tag.at_m));
            let heading = number(tag.heading_deg);
            let _ =
                writeln!(text, "  {id}: {{color: {color}, at-m: {at}, heading-deg: {heading}}}");
        });
        section(&mut text, "starts", &self.starts, |text, name, start| {
            let (name, at) = (scalar(name), numbers(&start.at_m));
            let heading = number(start.heading_deg);
            let _ = writeln!(text, "  {name}: {{at-m: {at}, heading-deg: {heading}}}");
        });
        section(&mut text, "goals", &self.goals, |text, name, goal| {
            let _ = writeln!(text, "  {}: {{at-m: {}}}", scalar(name), numbers(&goal.at_m));
        });
        text
    }
}

impl LayerDoc {
    fn is_empty(&self) -> bool {
        let Self { z_m, walls, boxes, circles, polygons } = self;
        z_m.is_none()
            && walls.is_empty()
            && boxes.is_empty()
            && circles.is_empty()
            && polygons.is_empty()
    }
}

fn section<T>(
    text: &mut String,
    key: &str,
    entries: &std::collections::BTreeMap<String, T>,
    mut entry: impl FnMut(&mut String, &str, &T),
) {
    if entries.is_empty() {
        // Only `layers` has to be there.
        if key == "layers" {
            text.push_str("layers: {}\n");
        }
        return;
    }
    let _ = writeln!(text, "{key}:");
    for (name, value) in entries {
        entry(text, name, value);
    }
}

fn write_layer(text: &mut String, layer: &LayerDoc) {
    if let Some(z) = layer.z_m {
        let _ = writeln!(text, "    z-m: {}", numbers(&z));
    }
    items(text, "walls", &layer.walls, |WallDoc { name, path_m, thickness_m, z_m }| {
        let path = format!("path-m: {}", points(path_m));
        item(name, &[path, format!("thickness-m: {}", number(*thickness_m))], *z_m)
    });
    items(text, "boxes", &layer.boxes, |BoxDoc { name, center_m, size_m, heading_deg, z_m }| {
        let at = format!("center-m: {}, size-m: {}", numbers(center_m), numbers(size_m));
        item(name, &[at, format!("heading-deg: {}", number(*heading_deg))], *z_m)
    });
    items(text, "circles", &layer.circles, |CircleDoc { name, center_m, radius_m, z_m }| {
        let at = format!("center-m: {}", numbers(center_m));
        item(name, &[at, format!("radius-m: {}", number(*radius_m))], *z_m)
    });
    items(text, "polygons", &layer.polygons, |PolygonDoc { name, corners_m, z_m }| {
        item(name, &[format!("corners-m: {}", points(corners_m))], *z_m)
    });
}

fn items<T>(text: &mut String, key: &str, list: &[T], line: impl Fn(&T) -> String) {
    if !list.is_empty() {
        let _ = writeln!(text, "    {key}:");
    }
    for entry in list {
        let _ = writeln!(text, "      - {}", line(entry));
    }
}

fn item(name: &str, parts: &[String], z: Option<[f64; 2]>) -> String {
    let name = (!name.is_empty()).then(|| format!("name: {}", scalar(name)));
    let z = z.map(|z| format!("z-m: {}", numbers(&z)));
    let all: Vec<String> = name.into_iter().chain(parts.iter().cloned()).chain(z).collect();
    format!("{{{}}}", all.join(", "))
}

fn points(points: &[[f64; 2]]) -> String {
    let each: Vec<String> = points.iter().map(|point| numbers(point)).collect();
    format!("[{}]", each.join(", "))
}

fn numbers(values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("[{}]", each.join(", "))
}

/// Writes the shortest decimals that read back as `value`; no exponents and no negative zero.
fn number(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value}") }
}

/// Writes a text plainly where that is safe, and in quotes otherwise.
fn scalar(text: &str) -> String {
    let plain = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b" .-_/".contains(&b))
        && !text.ends_with(' ')
        && !NOT_TEXT.contains(&text.to_ascii_lowercase().as_str());
    if plain { text.to_owned() } else { json::canonical(&serde_json::Value::from(text)) }
}
