//! Robots as files describe them: URDF and SDF, with xacro or without, and what a manifest says besides.
//!
//! Hermetic: files come through [`Files`], the environment is not asked. Joints stand at zero. Reading goes as follows:
//! 1. Xacro is expanded, and files that hold only `<gazebo>` blocks are put in.
//! 2. `urdf` or `sdf` tells the parts: links, joints, collisions, plugins, sensors. A URDF's
//!    base frame is its root link's, an SDF model's is the model's own.
//! 3. The collision shapes give the footprint, meshes by their corners.
//! 4. The floor is the origin of a link called `base_footprint` in URDF (REP-120), else the lowest point of the shapes.
//! 5. The plugins give the drive, the wheels' joints what those leave out.
//! 6. The sensors give scanner, logical camera and compass.
//! 7. What the manifest says goes before all of it.

mod amend;
mod camera;
mod drive;
mod lidar;
pub(super) mod parts;
mod sensors;
mod shape;
mod wheels;

use super::files::{FilePath, Files, Places};
use super::given::{Given, LidarDoc};
use super::xacro::{self, Expanded};
use super::{Robot, sdf, urdf};
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Source, quoted};
use parts::{Geometry, Parts};
use shape::Shape;
pub(super) use shape::ShapeKind;
use std::collections::{BTreeMap, BTreeSet};

/// Longest description read (bytes): real ones have some ten thousand.
pub const MAX_BYTES: usize = 1 << 20;

/// Largest body read (m): beyond it the unit is wrong.
const MAX_SIZE: f64 = 20.0;

/// What is known of a robot besides its own file.
pub struct Request<'r> {
    /// Where its own file lies.
    pub path: FilePath,
    /// Files that hold only `<gazebo>` blocks, and where they lie.
    pub gazebo: Vec<(FilePath, Source)>,
    /// Packages by name, and their folders.
    pub packages: &'r BTreeMap<String, String>,
    /// Arguments of xacro.
    pub arguments: &'r BTreeMap<String, String>,
    /// What goes before the description.
    pub given: &'r Given,
    /// Makes an error at a key of what is given, by its pointer (`/lidar/beams`).
    pub fault: &'r dyn Fn(&str, &str) -> Diagnostic,
}

/// Reads a robot and the warnings about it.
///
/// # Errors
/// Every fault found, warnings among them, where the description cannot be used.
pub fn read(
    source: &Source,
    request: &Request<'_>,
    files: &mut dyn Files,
) -> Result<(Robot, Vec<Diagnostic>), Vec<Diagnostic>> {
    let places = Places { own: request.path.clone(), packages: request.packages };
    // 1. Xacro and added files.
    if !xacro::is_unexpanded(source) && request.gazebo.is_empty() {
        return Reader { request, places: &places, files }.robot(source, MAX_BYTES);
    }
    if source.text.len() > MAX_BYTES {
        return Err(xml::parse(source, MAX_BYTES).err().unwrap_or_default());
    }
    let expanded = xacro::expand(source, &request.gazebo, request.arguments, &places, files)?;
    let reader = Reader { request, places: &places, files };
    let told = |expanded: &Expanded, faults: Vec<Diagnostic>| -> Vec<Diagnostic> {
        let faults = faults.into_iter().map(|fault| expanded.told(fault));
        expanded.warnings.iter().cloned().chain(faults).collect()
    };
    match reader.robot(&expanded.source, usize::MAX) {
        Ok((robot, warnings)) => Ok((robot, told(&expanded, warnings))),
        Err(faults) => Err(told(&expanded, faults)),
    }
}

/// Returns whether an XML text describes a robot, by its first element: `<robot>`, or an `<sdf>` whose model drives or senses.
pub fn is_robot(source: &Source) -> bool {
    let text = &*source.text;
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.find("-->").map_or("", |end| &comment[end..]);
        } else if !rest.starts_with(['?', '!']) {
            let has = |tag: &str| rest.contains(tag);
            let acts = has("<plugin") || has("<sensor");
            return rest.starts_with("robot")
                || (rest.starts_with("sdf") && has("<model") && !has("<world") && acts);
        }
    }
    false
}

struct Reader<'r, 'f> {
    request: &'r Request<'r>,
    places: &'r Places<'r>,
    files: &'f mut dyn Files,
}

impl Reader<'_, '_> {
    fn robot(
        mut self,
        source: &Source,
        max_bytes: usize,
    ) -> Result<(Robot, Vec<Diagnostic>), Vec<Diagnostic>> {
        let document = xml::parse(source, max_bytes)?;
        let mut faults = Faults::new(source);
        let given = self.request.given;
        // 2. The parts.
        let parts = match document.root_element().tag_name().name() {
            "sdf" => sdf::parts(&document, &mut faults),
            _ => urdf::parts(&document, &mut faults),
        };
        let (Some(parts), false) = (parts, faults.any_error()) else { return Err(faults.finish()) };
        // 3. The footprint.
        let shapes = self.shapes(&parts, &mut faults);
        let extent = (!shapes.is_empty()).then(|| shape::extent(&shapes));
        let outline = match &given.footprint {
            Some(footprint) => amend::outline(footprint, self.request.fault, &mut faults),
            None => shape::footprint(&shapes),
        };
        let Some(footprint) = outline else {
            if given.footprint.is_none() {
                faults.push(bodiless(&parts));
            }
            return Err(faults.finish());
        };
        // 4. The floor.
        let ground = parts.floor.or(extent.map(|[low, _]| low)).unwrap_or(0.0);
        let low = extent.map_or(0.0, |[low, _]| low - ground);
        let Some(high) = given.height_m.or(extent.map(|[_, high]| high - ground)) else {
            let fault = (self.request.fault)("/footprint", "how high the robot is, nothing says");
            faults.push(fault.label("no collision of it can be read").help("add `height-m`"));
            return Err(faults.finish());
        };
        let bounds = footprint.bounds();
        let size = bounds.width().max(bounds.height()).max(high - low);
        if size.is_nan() || size >= MAX_SIZE {
            faults.push(
                Diagnostic::placeless(format!(
                    "robot `{}` is {size} m across: expected less than {MAX_SIZE} m",
                    parts.name
                ))
                .help("lengths are in metres: is this in millimetres? A mesh may lack its <scale>"),
            );
        }
        let mass = given.mass_kg.unwrap_or_else(|| parts.masses.iter().sum());
        if mass <= 0.0 || !mass.is_finite() {
            let fault = Diagnostic::placeless(format!("robot `{}` has no mass", parts.name));
            let help =
                "give its base link an <inertial> with a <mass>, or the manifest's robot `mass-kg`";
            faults.push(fault.help(help));
        }
        // 5. and 6. Drive and sensors, 7. as the manifest has them.
        let drive = drive::read(&parts, given.drive.as_ref(), &mut faults);
        let sensors = sensors::read(&parts, self.request, ground, &mut faults);
        match drive {
            Some(drive) if !faults.any_error() => {
                let robot = Robot {
                    name: parts.name,
                    footprint,
                    body_z: [low, high],
                    mass,
                    drive,
                    lidar: sensors.lidar,
                    camera: sensors.camera,
                    compass: sensors.compass,
                };
                Ok((robot, faults.finish()))
            }
            _ => Err(faults.finish()),
        }
    }

    /// Returns the collision shapes in the base frame. Of what is left out there are warnings, but where the manifest gives
    /// a footprint.
    fn shapes(&mut self, parts: &Parts<'_, '_>, faults: &mut Faults<'_>) -> Vec<Shape> {
        let mut shapes = Vec::new();
        let mut known: BTreeMap<&str, Option<Vec<[f64; 3]>>> = BTreeMap::new();
        let mut told = BTreeSet::new();
        for collision in &parts.collisions {
            let kind = match &collision.geometry {
                Geometry::Simple(kind) => kind.clone(),
                Geometry::Mesh { uri, scale } => {
                    let found = known.entry(uri.as_str()).or_insert_with(|| {
                        match self.corners(uri) {
                            Ok(corners) => Some(corners),
                            Err((why, help)) => {
                                let fault = faults.at(
                                    collision.node,
                                    format!(
                                        "the mesh `{}` collides on link `{}` and is not part of the body",
                                        quoted(uri),
                                        collision.link
                                    ),
                                );
                                if self.request.given.footprint.is_none() {
                                    faults.push(fault.label(why).help(help).warning());
                                }
                                None
                            }
                        }
                    });
                    let Some(corners) = found else { continue };
                    let scaled =
                        corners.iter().map(|[x, y, z]| [x * scale[0], y * scale[1], z * scale[2]]);
                    ShapeKind::Points(scaled.collect())
                }
                Geometry::Other(name) => {
                    if self.request.given.footprint.is_none() && told.insert(*name) {
                        let message = format!(
                            "<{name}> collides on link `{}` and is not part of the body",
                            collision.link
                        );
                        let fault = faults.at(collision.node, message).warning();
                        faults.push(fault.label("expected a box, a cylinder, a sphere or a mesh"));
                    }
                    continue;
                }
            };
            shapes.push(Shape { kind, placement: collision.placement });
        }
        shapes
    }

    /// Returns the corners of the mesh `uri`, or why there are none and what to do.
    fn corners(&mut self, uri: &str) -> Result<Vec<[f64; 3]>, (String, String)> {
        const OR: &str = "or the body as `footprint: {radius-m: ...}`";
        match self.places.find(uri, &self.places.own, self.files) {
            Ok(file) => match self.files.corners(&file) {
                Ok(mut corners) => {
                    // Triangles share most of theirs.
                    corners.sort_by(|a, b| {
                        let [x, y, z] = [0, 1, 2].map(|i| a[i].total_cmp(&b[i]));
                        x.then(y).then(z)
                    });
                    corners.dedup();
                    Ok(corners)
                }
                Err(why) => {
                    let why = format!("`{}`: {why}", file.path);
                    Err((why, format!("put the mesh there, {OR}")))
                }
            },
            Err(why) => {
                let help = match why.package() {
                    Some(name) => xacro::how_to_give(name),
                    None => "name the mesh by its package".to_owned(),
                };
                Err((why.to_string(), format!("{help}, {OR}")))
            }
        }
    }
}

fn bodiless(parts: &Parts<'_, '_>) -> Diagnostic {
    let fault = Diagnostic::placeless(format!("robot `{}` has no body", parts.name));
    let is_mesh = |geometry: &Geometry| matches!(geometry, Geometry::Mesh { .. });
    let count = parts.collisions.iter().filter(|c| is_mesh(&c.geometry)).count();
    if count == 0 {
        return fault.help(
            "give a link a box, cylinder or sphere collision, or the manifest's robot a footprint: \
             `robot: {file, footprint: {radius-m: ...}}`",
        );
    }
    fault.help(
        "its collisions are meshes that are not at hand: give their packages, or a footprint: \
         `robot: {file, footprint: {radius-m: ...}}`",
    )
}

/// Returns the name of the scanner that the manifest asks for.
fn asked_scanner(given: &Given) -> Option<&str> {
    match given.lidar.as_ref()? {
        LidarDoc::Name(name) => Some(name),
        LidarDoc::Numbers(numbers) => numbers.name.as_deref(),
    }
}
