//! COLLADA 1.4 and 1.5 (`.dae`): triangles and polygons of the scene's nodes, with unit, transforms and instances.
//!
//! As Gazebo does, coordinates are taken as they are written: the file's `<up_axis>` is handed on and turns nothing.
//!
//! Our own reader: the crate that reads STL and OBJ shows every geometry once however often it stands in the scene, turns
//! by the platform's sine, and trusts the counts that a file announces.

use super::{MAX_BYTES, MAX_TRIANGLES, MeshFile, Part, Triangle, UpAxis, checked};
use crate::document::xml::{self, Faults};
use crate::document::{Diagnostic, Source};
use crate::math;
use roxmltree::Node;
use std::collections::BTreeMap;

/// How deep nodes may stand in one another, instances counted.
const MAX_DEPTH: usize = 64;
/// Most nodes visited: instances of nodes multiply.
const MAX_VISITS: usize = 100_000;

/// An affine map: the first three rows of its matrix.
type Affine = [[f64; 4]; 3];

const IDENTITY: Affine = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Elements by kind and id. Files use one id for things of several kinds: a scene, its node and their geometry.
type Ids<'a, 'i> = BTreeMap<(&'a str, &'a str), Node<'a, 'i>>;

/// Reads the parts of the file `name`, in metres.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<Diagnostic>> {
    let text = std::str::from_utf8(bytes).map_err(|_| {
        vec![Diagnostic::placeless(format!("cannot read the mesh `{name}`: expected UTF-8 text"))]
    })?;
    let source = Source::new(name.to_owned(), text.to_owned());
    let document = xml::parse(&source, MAX_BYTES)?;
    let root = document.root_element();
    let mut faults = Faults::new(&source);
    if root.tag_name().name() != "COLLADA" {
        let found = format!("expected <COLLADA>, found <{}>", root.tag_name().name());
        let fault = faults.at(root, "not a COLLADA file").label(found);
        faults.push(fault);
        return Err(faults.finish());
    }
    let base = metres(root, &mut faults);
    let up_axis = up_axis(root, &mut faults);
    let mut ids = Ids::new();
    for node in root.descendants() {
        if let Some(id) = node.attribute("id") {
            // Of two that are alike the first counts.
            ids.entry((node.tag_name().name(), id)).or_insert(node);
        }
    }
    let mut reader =
        Reader { ids, faults, geometries: BTreeMap::new(), parts: Vec::new(), count: 0, visits: 0 };
    reader.scene(root, &base);
    let Reader { mut faults, parts, .. } = reader;
    if !faults.any_error()
        && let Err(problem) = checked(parts.iter())
    {
        let fault = faults.at(root, format!("cannot read the mesh: {problem}"));
        faults.push(fault);
    }
    if faults.any_error() { Err(faults.finish()) } else { Ok(MeshFile { parts, up_axis }) }
}

/// Returns the map from the file's unit to metres.
fn metres(root: Node<'_, '_>, faults: &mut Faults<'_>) -> Affine {
    let unit = xml::descend(root, "asset/unit");
    let [m] = unit.and_then(|unit| faults.attribute(unit, "meter")).unwrap_or([1.0]);
    if let (Some(unit), false) = (unit, m > 0.0 && m <= 1e6) {
        let fault = faults.at(unit, "unit out of range");
        faults.push(fault.label(format!("expected metres above zero, found {m}")));
    }
    [[m, 0.0, 0.0, 0.0], [0.0, m, 0.0, 0.0], [0.0, 0.0, m, 0.0]]
}

/// Returns the axis that the file says is up.
fn up_axis(root: Node<'_, '_>, faults: &mut Faults<'_>) -> UpAxis {
    let axis = xml::descend(root, "asset/up_axis");
    match axis.map_or("", xml::text) {
        "X_UP" => UpAxis::X,
        "Y_UP" => UpAxis::Y,
        "Z_UP" | "" => UpAxis::Z,
        other => {
            let found = format!("expected X_UP, Y_UP or Z_UP, found {other}");
            let fault = faults.at(axis.unwrap_or(root), "unknown up axis").label(found);
            faults.push(fault);
            UpAxis::Z
        }
    }
}

struct Reader<'a, 'i, 's> {
    ids: Ids<'a, 'i>,
    faults: Faults<'s>,
    /// Triangles of a geometry in its own frame, by id.
    geometries: BTreeMap<&'a str, Vec<Triangle>>,
    parts: Vec<Part>,
    count: usize,
    visits: usize,
}

impl<'a, 'i> Reader<'a, 'i, '_> {
    /// Places the scene; without one, every geometry where it is.
    fn scene(&mut self, root: Node<'a, 'i>, base: &Affine) {
        let instance = xml::descend(root, "scene/instance_visual_scene");
        if let Some(scene) =
            instance.and_then(|instance| self.target(instance, "url", &["visual_scene"]))
        {
            for node in xml::elements(scene).filter(|n| n.tag_name().name() == "node") {
                self.node(node, base, 0);
            }
        } else if instance.is_none()
            && let Some(library) = xml::child(root, "library_geometries")
        {
            for geometry in xml::elements(library) {
                self.place(geometry, &[], base);
            }
        }
    }

    /// Returns the element, of one of `kinds`, that the attribute `name` of `node` points to.
    fn target(
        &mut self,
        node: Node<'a, 'i>,
        name: &str,
        kinds: &[&'static str],
    ) -> Option<Node<'a, 'i>> {
        let url = node.attribute(name).unwrap_or_default();
        let id = url.strip_prefix('#');
        let found = id.and_then(|id| kinds.iter().find_map(|kind| self.ids.get(&(*kind, id))));
        let found = found.copied();
        if found.is_none() {
            let message = format!("<{}> names `{url}`, which is not there", node.tag_name().name());
            self.fault(node, message, "expected the id of an element of this file");
        }
        found
    }

    fn fault(&mut self, node: Node<'a, 'i>, message: impl Into<String>, label: impl Into<String>) {
        let fault = self.faults.at(node, message).label(label);
        self.faults.push(fault);
    }

    fn node(&mut self, node: Node<'a, 'i>, outer: &Affine, depth: usize) {
        self.visits += 1;
        if depth > MAX_DEPTH || self.visits > MAX_VISITS {
            if !self.faults.any_error() {
                let label =
                    format!("expected at most {MAX_DEPTH} one in another, {MAX_VISITS} in all");
                self.fault(node, "too many nodes", label);
            }
            return;
        }
        let mut here = *outer;
        for element in xml::elements(node) {
            match element.tag_name().name() {
                "matrix" | "translate" | "rotate" | "scale" => {
                    let Some(step) = transform(element, &mut self.faults) else { return };
                    here = after(&here, &step);
                }
                kind @ ("lookat" | "skew") => {
                    let label = "expected matrix, translate, rotate or scale";
                    self.fault(element, format!("<{kind}> cannot be read"), label);
                }
                _ => {}
            }
        }
        for element in xml::elements(node) {
            match element.tag_name().name() {
                "node" => self.node(element, &here, depth + 1),
                "instance_node" => {
                    if let Some(target) = self.target(element, "url", &["node"]) {
                        self.node(target, &here, depth + 1);
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = self.target(element, "url", &["geometry"]) {
                        self.place(geometry, &[node], &here);
                    }
                }
                "instance_controller" => {
                    // A skin stands as it was bound; nothing moves here.
                    let skin = self.target(element, "url", &["controller"]);
                    let skin = skin.and_then(|c| xml::child(c, "skin"));
                    if let Some(geometry) =
                        skin.and_then(|skin| self.target(skin, "source", &["geometry"]))
                    {
                        self.place(geometry, &[node], &here);
                    }
                }
                _ => {}
            }
        }
    }

    /// Puts `geometry`, which stands in `nodes`, where `here` says.
    fn place(&mut self, geometry: Node<'a, 'i>, nodes: &[Node<'a, 'i>], here: &Affine) {
        let id = geometry.attribute("id").unwrap_or_default();
        if !self.geometries.contains_key(id) {
            let triangles = self.geometry(geometry).unwrap_or_default();
            self.geometries.insert(id, triangles);
        }
        let triangles = &self.geometries[id];
        self.count += triangles.len();
        if self.count > MAX_TRIANGLES {
            if !self.faults.any_error() {
                let label = format!("expected at most {MAX_TRIANGLES}, instances counted");
                self.fault(geometry, "too many triangles", label);
            }
            return;
        }
        let triangles = triangles.iter().map(|t| t.map(|corner| apply(here, corner))).collect();
        let named = nodes.iter().chain([&geometry]);
        let names = named.flat_map(|n| [n.attribute("name"), n.attribute("id")]).flatten();
        self.parts.push(Part { names: names.map(str::to_owned).collect(), triangles });
    }

    fn geometry(&mut self, geometry: Node<'a, 'i>) -> Option<Vec<Triangle>> {
        let mesh = xml::child(geometry, "mesh")?;
        let mut triangles = Vec::new();
        for primitive in xml::elements(mesh) {
            let kind = primitive.tag_name().name();
            if !matches!(kind, "triangles" | "polylist" | "polygons" | "trifans" | "tristrips") {
                continue;
            }
            let inputs: Vec<_> =
                xml::elements(primitive).filter(|e| e.tag_name().name() == "input").collect();
            let offset_of = |input: &Node<'_, '_>| {
                input.attribute("offset").map_or(Some(0), |o| o.trim().parse::<usize>().ok())
            };
            let offsets: Option<Vec<usize>> = inputs.iter().map(offset_of).collect();
            let vertex = inputs.iter().position(|i| i.attribute("semantic") == Some("VERTEX"));
            let (Some(offsets), Some(vertex)) = (offsets, vertex) else {
                self.fault(
                    primitive,
                    format!("<{kind}> has no vertices"),
                    "expected an <input> VERTEX",
                );
                return None;
            };
            let stride = offsets.iter().max().map_or(1, |last| last.saturating_add(1)).max(1);
            let positions = self.positions(inputs[vertex])?;
            let lists: Vec<_> =
                xml::elements(primitive).filter(|e| e.tag_name().name() == "p").collect();
            let mut polygons = Vec::new();
            for list in lists {
                let corners = self.corners(list, stride, offsets[vertex], &positions)?;
                match kind {
                    "triangles" => polygons.extend(corners.chunks_exact(3).map(<[_]>::to_vec)),
                    "polylist" => {
                        let counts = xml::child(primitive, "vcount").map_or("", xml::text);
                        let mut rest = &corners[..];
                        for count in counts.split_ascii_whitespace() {
                            let count: usize = count.parse().unwrap_or(usize::MAX);
                            let Some((polygon, after)) = rest.split_at_checked(count) else {
                                let label = "expected as many corners in <p> as <vcount> says";
                                self.fault(primitive, "too few corners", label);
                                return None;
                            };
                            polygons.push(polygon.to_vec());
                            rest = after;
                        }
                    }
                    "tristrips" => polygons.extend(corners.windows(3).map(<[_]>::to_vec)),
                    _ => polygons.push(corners),
                }
            }
            for polygon in polygons {
                let fan = polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]);
                triangles.extend(fan);
            }
        }
        Some(triangles)
    }

    /// Returns the corners that the indices in `list` name.
    fn corners(
        &mut self,
        list: Node<'a, 'i>,
        stride: usize,
        offset: usize,
        positions: &[[f64; 3]],
    ) -> Option<Vec<[f64; 3]>> {
        let mut corners = Vec::new();
        for index in xml::text(list).split_ascii_whitespace().skip(offset).step_by(stride) {
            let corner = index.parse::<usize>().ok().and_then(|index| positions.get(index));
            let Some(corner) = corner else {
                let label = format!("expected indices below {}, found {index}", positions.len());
                self.fault(list, "index out of range", label);
                return None;
            };
            corners.push(*corner);
        }
        Some(corners)
    }

    /// Returns the positions behind an input VERTEX.
    fn positions(&mut self, input: Node<'a, 'i>) -> Option<Vec<[f64; 3]>> {
        let vertices = self.target(input, "source", &["vertices"])?;
        let position =
            xml::elements(vertices).find(|e| e.attribute("semantic") == Some("POSITION"));
        let Some(position) = position else {
            self.fault(vertices, "vertices without positions", "expected an <input> POSITION");
            return None;
        };
        let source = self.target(position, "source", &["source"])?;
        let accessor = xml::descend(source, "technique_common/accessor");
        let number = |name: &str, otherwise: usize| {
            let written = accessor.and_then(|accessor| accessor.attribute(name));
            written.map_or(Some(otherwise), |text| text.trim().parse().ok())
        };
        let (stride, offset) = (number("stride", 3)?.max(3), number("offset", 0)?);
        let array = match accessor {
            Some(accessor) => self.target(accessor, "source", &["float_array"])?,
            None => xml::child(source, "float_array")?,
        };
        let mut numbers = Vec::new();
        for word in xml::text(array).split_ascii_whitespace().skip(offset) {
            let Some(number) = word.parse::<f64>().ok().filter(|n| n.is_finite()) else {
                self.fault(array, "malformed number", format!("expected numbers, found `{word}`"));
                return None;
            };
            numbers.push(number);
        }
        Some(
            numbers
                .chunks(stride)
                .filter_map(|c| Some([*c.first()?, *c.get(1)?, *c.get(2)?]))
                .collect(),
        )
    }
}

fn transform(element: Node<'_, '_>, faults: &mut Faults<'_>) -> Option<Affine> {
    Some(match element.tag_name().name() {
        "matrix" => {
            let m = faults.numbers::<16>(element)?;
            [0, 4, 8].map(|row| [m[row], m[row + 1], m[row + 2], m[row + 3]])
        }
        "translate" => {
            let [x, y, z] = faults.numbers(element)?;
            [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]
        }
        "scale" => {
            let [x, y, z] = faults.numbers(element)?;
            [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]
        }
        _ => {
            let [x, y, z, degrees] = faults.numbers(element)?;
            let long = (x * x + y * y + z * z).sqrt();
            if long == 0.0 {
                return Some(IDENTITY);
            }
            let (x, y, z) = (x / long, y / long, z / long);
            let (s, c) = math::sin_cos(degrees.to_radians());
            let d = 1.0 - c;
            [
                [c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0.0],
                [d * x * y + s * z, c + d * y * y, d * y * z - s * x, 0.0],
                [d * x * z - s * y, d * y * z + s * x, c + d * z * z, 0.0],
            ]
        }
    })
}

/// Returns the map that applies `inner`, then `outer`.
fn after(outer: &Affine, inner: &Affine) -> Affine {
    let column = |j: usize| [0, 1, 2].map(|row: usize| inner[row][j]);
    let mut product = *outer;
    for (out, row) in product.iter_mut().zip(outer) {
        for (j, value) in out.iter_mut().enumerate() {
            let [x, y, z] = column(j);
            *value = row[0] * x + row[1] * y + row[2] * z + if j == 3 { row[3] } else { 0.0 };
        }
    }
    product
}

fn apply(map: &Affine, [x, y, z]: [f64; 3]) -> [f64; 3] {
    map.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
}
