//! World YAML: the written form (the `*Doc` structs), and the [`World`] it describes.
//!
//! Layers hold walls, boxes, circles and polygons, each upright from one height to another. Lengths are metres,
//! angles degrees, and the key says so. The layer `walls` always belongs to the world; others are chosen.

mod of_world;
mod write;

use super::{Body, Region, RegionKind, Solid, Tag, World};
use crate::document::{self, Diagnostic, Source, suggestion};
use crate::geometry::{Outline, Point, Pose};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The layer that every world has, chosen or not.
pub const BASE_LAYER: &str = "walls";

/// A building as written.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct WorldDoc {
    /// Version of this format: 1.
    pub reenact_world: u32,
    /// Name of the building.
    pub name: String,
    /// Where its measures come from.
    pub source: String,
    /// Solid things, in layers that can be chosen; `walls` always belongs to the world.
    pub layers: BTreeMap<String, LayerDoc>,
    /// Rooms and corridors by name.
    #[serde(default)]
    pub regions: BTreeMap<String, RegionDoc>,
    /// Marks that a logical camera detects, by id.
    #[serde(default)]
    pub tags: BTreeMap<String, TagDoc>,
    /// Start poses by name.
    #[serde(default)]
    pub starts: BTreeMap<String, PoseDoc>,
    /// Goals by name: x and y (m).
    #[serde(default)]
    pub goals: BTreeMap<String, GoalDoc>,
}

/// Solid things that come and go together.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct LayerDoc {
    /// Lower and upper end (m) of whatever does not say its own; 0 to 2.5 where absent.
    pub z_m: Option<[f64; 2]>,
    /// Walls along lines.
    #[serde(default)]
    pub walls: Vec<WallDoc>,
    /// Boxes.
    #[serde(default)]
    pub boxes: Vec<BoxDoc>,
    /// Round columns.
    #[serde(default)]
    pub circles: Vec<CircleDoc>,
    /// Columns over polygons.
    #[serde(default)]
    pub polygons: Vec<PolygonDoc>,
}

/// A wall along the middle of its thickness. It ends where the line ends; joints are filled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct WallDoc {
    /// Name, for messages.
    #[serde(default)]
    pub name: String,
    /// Two or more points (m).
    pub path_m: Vec<[f64; 2]>,
    /// Thickness (m).
    pub thickness_m: f64,
    /// Lower and upper end (m).
    pub z_m: Option<[f64; 2]>,
}

/// A box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BoxDoc {
    /// Name, for messages.
    #[serde(default)]
    pub name: String,
    /// Its middle (m).
    pub center_m: [f64; 2],
    /// Length along its heading and width across (m).
    pub size_m: [f64; 2],
    /// Heading (degrees, counter-clockwise from x).
    #[serde(default)]
    pub heading_deg: f64,
    /// Lower and upper end (m).
    pub z_m: Option<[f64; 2]>,
}

/// A round column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CircleDoc {
    /// Name, for messages.
    #[serde(default)]
    pub name: String,
    /// Its middle (m).
    pub center_m: [f64; 2],
    /// Radius (m).
    pub radius_m: f64,
    /// Lower and upper end (m).
    pub z_m: Option<[f64; 2]>,
}

/// A column over a polygon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PolygonDoc {
    /// Name, for messages.
    #[serde(default)]
    pub name: String,
    /// Three or more corners in order (m), without crossings.
    pub corners_m: Vec<[f64; 2]>,
    /// Lower and upper end (m).
    pub z_m: Option<[f64; 2]>,
}

/// A named part of the floor.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum RegionDoc {
    /// A room.
    Room(AreaDoc),
    /// A corridor.
    Corridor(AreaDoc),
}

/// A part of the floor.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct AreaDoc {
    /// Three or more corners in order (m), without crossings.
    pub corners_m: Vec<[f64; 2]>,
}

/// A mark that a logical camera detects.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct TagDoc {
    /// Colour by name.
    pub color: String,
    /// Where it stands (m).
    pub at_m: [f64; 2],
    /// Where it faces (degrees, counter-clockwise from x).
    pub heading_deg: f64,
}

/// A pose.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PoseDoc {
    /// Position (m).
    pub at_m: [f64; 2],
    /// Heading (degrees, counter-clockwise from x).
    pub heading_deg: f64,
}

/// A place to reach.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct GoalDoc {
    /// Position (m).
    pub at_m: [f64; 2],
}

/// Heights (m) of whatever gives none: a storey.
const STOREY: [f64; 2] = [0.0, 2.5];

/// Largest coordinate (m) that is taken for metres.
const MAX_DISTANCE: f64 = 1e4;

/// Reads a world: the layer `walls` and those of `layers`, or every layer where `layers` is `None`.
///
/// # Errors
/// Every fault of the document, including layers asked for that it does not have.
pub fn read(source: &Source, layers: Option<&[String]>) -> Result<World, Vec<Diagnostic>> {
    let parsed = document::parse::<WorldDoc>(source)?;
    let doc = &parsed.value;
    let unknown = |asked: &str| {
        let known: Vec<&str> = doc.layers.keys().map(String::as_str).collect();
        let fault = parsed
            .key_fault("/layers", format!("world `{}` has no layer `{asked}`", doc.name))
            .label(format!("the layers are {}", known.join(", ")));
        match suggestion(asked, known) {
            Some(near) => fault.help(format!("did you mean `{near}`?")),
            None => fault,
        }
    };
    let mut reader =
        Reader { fault_at: &|at, message| parsed.fault(at, message), faults: Vec::new() };
    let world = reader.world(doc, layers, &unknown);
    if reader.faults.is_empty() { Ok(world) } else { Err(reader.faults) }
}

/// Makes the world, with every layer, that `doc` describes: the one that is read where it is written.
///
/// # Errors
/// Every fault of the document; none has a place.
pub fn build(doc: &WorldDoc) -> Result<World, Vec<Diagnostic>> {
    let placeless = |at: &str, message: &str| Diagnostic::placeless(format!("{at}: {message}"));
    let mut reader = Reader { fault_at: &placeless, faults: Vec::new() };
    let world = reader.world(doc, None, &|asked| placeless("/layers", asked));
    if reader.faults.is_empty() { Ok(world) } else { Err(reader.faults) }
}

/// Reads the solids of `layer`, which is written at `pointer` of a document that makes faults by `fault_at` (pointer,
/// message).
///
/// # Errors
/// Every fault of it.
pub fn solids(
    layer: &LayerDoc,
    pointer: &str,
    fault_at: &dyn Fn(&str, &str) -> Diagnostic,
) -> Result<Vec<Solid>, Vec<Diagnostic>> {
    let mut reader = Reader { fault_at, faults: Vec::new() };
    let mut solids = Vec::new();
    reader.layer(BASE_LAYER, pointer, layer, &mut solids);
    if reader.faults.is_empty() { Ok(solids) } else { Err(reader.faults) }
}

struct Reader<'a> {
    fault_at: &'a dyn Fn(&str, &str) -> Diagnostic,
    faults: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn world(
        &mut self,
        doc: &WorldDoc,
        layers: Option<&[String]>,
        unknown_layer: &dyn Fn(&str) -> Diagnostic,
    ) -> World {
        self.expect(doc.reenact_world == 1, "/reenact-world", "unknown format version", "1");
        for asked in layers.unwrap_or(&[]).iter().filter(|name| !doc.layers.contains_key(*name)) {
            self.faults.push(unknown_layer(asked));
        }
        let mut solids = Vec::new();
        for (name, layer) in &doc.layers {
            let before = solids.len();
            let pointer = format!("/layers/{}", escaped(name));
            self.layer(name, &pointer, layer, &mut solids);
            let chosen = name == BASE_LAYER || layers.is_none_or(|layers| layers.contains(name));
            if !chosen {
                solids.truncate(before);
            }
        }
        World {
            name: doc.name.clone(),
            solids,
            regions: doc.regions.iter().map(|(name, region)| self.region(name, region)).collect(),
            tags: doc.tags.iter().map(|(id, tag)| self.tag(id, tag)).collect(),
            starts: doc
                .starts
                .iter()
                .map(|(name, start)| {
                    let at = format!("/starts/{}", escaped(name));
                    (name.clone(), self.pose(&at, start.at_m, start.heading_deg))
                })
                .collect(),
            goals: doc
                .goals
                .iter()
                .map(|(name, goal)| {
                    let at = format!("/goals/{}/at-m", escaped(name));
                    (name.clone(), self.point(&at, goal.at_m))
                })
                .collect(),
            warnings: Vec::new(),
        }
    }

    fn layer(&mut self, name: &str, base: &str, layer: &LayerDoc, solids: &mut Vec<Solid>) {
        let storey = layer.z_m.unwrap_or(STOREY);
        self.heights(&format!("{base}/z-m"), storey);
        let mut add = |solid_name: String, outline: Outline, z: [f64; 2]| {
            let body = Body::Prism { outline, z };
            solids.push(Solid { name: solid_name, layer: name.to_owned(), body });
        };
        for (i, wall) in layer.walls.iter().enumerate() {
            let at = format!("{base}/walls/{i}");
            let z = self.heights(&format!("{at}/z-m"), wall.z_m.unwrap_or(storey));
            self.length(&format!("{at}/thickness-m"), wall.thickness_m);
            let path = self.points(&format!("{at}/path-m"), &wall.path_m, 2);
            let repeated = path.windows(2).any(|ends| ends[0] == ends[1]);
            self.expect(!repeated, &format!("{at}/path-m"), "point repeated", "points that differ");
            for (j, outline) in wall_outlines(&path, wall.thickness_m).into_iter().enumerate() {
                add(titled(&wall.name, "wall", i) + &format!("/{j}"), outline, z);
            }
        }
        for (i, item) in layer.boxes.iter().enumerate() {
            let at = format!("{base}/boxes/{i}");
            let z = self.heights(&format!("{at}/z-m"), item.z_m.unwrap_or(storey));
            let center = self.point(&format!("{at}/center-m"), item.center_m);
            self.length(&format!("{at}/size-m/0"), item.size_m[0]);
            self.length(&format!("{at}/size-m/1"), item.size_m[1]);
            let heading = self.heading(&format!("{at}/heading-deg"), item.heading_deg);
            let outline = Outline::rectangle(center, item.size_m[0], item.size_m[1], heading);
            add(titled(&item.name, "box", i), outline, z);
        }
        for (i, item) in layer.circles.iter().enumerate() {
            let at = format!("{base}/circles/{i}");
            let z = self.heights(&format!("{at}/z-m"), item.z_m.unwrap_or(storey));
            let center = self.point(&format!("{at}/center-m"), item.center_m);
            let radius = self.length(&format!("{at}/radius-m"), item.radius_m);
            add(titled(&item.name, "circle", i), Outline::Circle { center, radius }, z);
        }
        for (i, item) in layer.polygons.iter().enumerate() {
            let at = format!("{base}/polygons/{i}");
            let z = self.heights(&format!("{at}/z-m"), item.z_m.unwrap_or(storey));
            let corners = self.points(&format!("{at}/corners-m"), &item.corners_m, 3);
            add(titled(&item.name, "polygon", i), Outline::Polygon(corners), z);
        }
    }

    fn region(&mut self, name: &str, region: &RegionDoc) -> Region {
        let (kind, key, area) = match region {
            RegionDoc::Room(area) => (RegionKind::Room, "room", area),
            RegionDoc::Corridor(area) => (RegionKind::Corridor, "corridor", area),
        };
        let at = format!("/regions/{}/{key}/corners-m", escaped(name));
        Region { name: name.to_owned(), kind, polygon: self.points(&at, &area.corners_m, 3) }
    }

    fn tag(&mut self, id: &str, tag: &TagDoc) -> Tag {
        let at = format!("/tags/{}", escaped(id));
        let pose = self.pose(&at, tag.at_m, tag.heading_deg);
        Tag { id: id.to_owned(), color: tag.color.clone(), pose }
    }

    fn pose(&mut self, at: &str, position: [f64; 2], heading: f64) -> Pose {
        let position = self.point(&format!("{at}/at-m"), position);
        Pose::new(position.x, position.y, self.heading(&format!("{at}/heading-deg"), heading))
    }

    fn points(&mut self, at: &str, points: &[[f64; 2]], least: usize) -> Vec<Point> {
        let expected = format!("at least {least}, found {}", points.len());
        self.expect(points.len() >= least, at, "too few points", &expected);
        let each = points.iter().enumerate();
        each.map(|(i, point)| self.point(&format!("{at}/{i}"), *point)).collect()
    }

    fn point(&mut self, at: &str, [x, y]: [f64; 2]) -> Point {
        let near = x.abs() <= MAX_DISTANCE && y.abs() <= MAX_DISTANCE;
        self.expect(near, at, "coordinate out of range", "metres, within 10 km of the origin");
        Point::new(x, y)
    }

    fn length(&mut self, at: &str, length: f64) -> f64 {
        let possible = length > 0.0 && length <= MAX_DISTANCE;
        self.expect(possible, at, "length out of range", "metres, above zero");
        length
    }

    /// Converts to radians.
    fn heading(&mut self, at: &str, degrees: f64) -> f64 {
        self.expect(degrees.abs() <= 360.0, at, "heading out of range", "degrees from -360 to 360");
        degrees.to_radians()
    }

    fn heights(&mut self, at: &str, z: [f64; 2]) -> [f64; 2] {
        let possible = z[0] < z[1] && z[0] >= -MAX_DISTANCE && z[1] <= MAX_DISTANCE;
        self.expect(possible, at, "heights out of order", "the lower end, then the upper (m)");
        z
    }

    fn expect(&mut self, holds: bool, at: &str, message: &str, expected: &str) {
        if !holds {
            self.faults.push((self.fault_at)(at, message).label(format!("expected {expected}")));
        }
    }
}

/// Escapes a name as part of a JSON pointer (RFC 6901).
fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

fn titled(name: &str, kind: &str, number: usize) -> String {
    if name.is_empty() { format!("{kind} {number}") } else { name.to_owned() }
}

/// Returns a rectangle for each segment of the path. At joints the segments reach half a thickness further, which fills
/// corners; a path that ends where it began is joined there too.
fn wall_outlines(path: &[Point], thickness: f64) -> Vec<Outline> {
    let (half, last) = (thickness / 2.0, path.len().saturating_sub(2));
    let closed = path.len() > 2 && path.first() == path.last();
    path.windows(2)
        .enumerate()
        .filter(|(_, ends)| ends[0] != ends[1])
        .map(|(i, ends)| {
            let (a, b) = (ends[0], ends[1]);
            let along = (b - a) * (1.0 / a.distance(b));
            let across = Point::new(-along.y, along.x) * half;
            let a = if i > 0 || closed { a - along * half } else { a };
            let b = if i < last || closed { b + along * half } else { b };
            Outline::Polygon(vec![a - across, b - across, b + across, a + across])
        })
        .collect()
}

#[cfg(test)]
mod tests;
