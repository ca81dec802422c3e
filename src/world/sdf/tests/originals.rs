//! The original study's own worlds and meshes, where they are at hand.

use super::*;
use crate::world::mesh::section::Standing;
use crate::world::{mesh, originals};
use std::collections::BTreeMap;

/// Lines of a model, world frame.
type Lines = BTreeMap<String, Vec<[f64; 4]>>;

/// Reads what an independent reader cut of the meshes of the world `name`.
fn golden(folder: &std::path::Path, name: &str) -> Lines {
    let path = folder.join(format!("derived/{name}.mesh_slices.csv"));
    let mut lines = Lines::new();
    for row in std::fs::read_to_string(path).unwrap().lines().skip(1) {
        let (model, numbers) = row.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        lines.entry(model.to_owned()).or_default().push(numbers.try_into().unwrap());
    }
    lines
}

/// A shelf that knows every mesh by its URI and takes what is in `files` for it, a cube where there is none.
struct Meshes<'f> {
    files: &'f dyn Fn(&str) -> Option<Vec<u8>>,
    asked: Vec<String>,
}

impl Models for Meshes<'_> {
    fn folders(&self) -> Folders {
        Folders { models: BTreeMap::new(), path: vec!["m".to_owned()] }
    }

    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String> {
        let path = path.path.strip_prefix("m/").unwrap_or(&path.path);
        self.asked.push(path.to_owned());
        (self.files)(path).map(Into::into).ok_or_else(|| "no such file".to_owned())
    }
}

fn read_meshes(source: &Source, files: &dyn Fn(&str) -> Option<Vec<u8>>) -> World {
    read_with(source, &mut Meshes { files, asked: Vec::new() }).unwrap()
}

/// Returns which models hold a mesh of the world, by its path, and where it stands.
fn standing(source: &Source) -> Vec<(String, String, Standing)> {
    // Each mesh a cube of its own size, by which it is known again.
    let paths = std::cell::RefCell::new(Vec::<String>::new());
    let world = read_meshes(source, &|path: &str| {
        if !path.to_ascii_lowercase().ends_with(".dae") {
            return None;
        }
        let mut paths = paths.borrow_mut();
        paths.push(path.to_owned());
        #[expect(clippy::cast_precision_loss, reason = "a few meshes")]
        let size = paths.len() as f64;
        let corner = |[x, y, z]: [f64; 3]| [x * size + 0.5, y * size, z * size + 9.0];
        let cube = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]].map(corner);
        Some(collada(&[cube]).into_bytes())
    });
    let paths = paths.into_inner();
    let stand = |s: &Solid| match &s.body {
        Body::Mesh { standing, mesh } => {
            let [a, b, _] = mesh.triangles()[0];
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
            let number = (b[0] - a[0]).round() as usize;
            let path = paths[number - 1].clone();
            Some((s.name.split('/').next()?.to_owned(), path, *standing))
        }
        _ => None,
    };
    world.solids.iter().filter_map(stand).collect()
}

/// Returns `lines` (world frame) as upright ribbons about the lidar's height, in the frame and the unit of a mesh that
/// stands there.
fn ribbons(lines: &[[f64; 4]], standing: &Standing) -> Vec<mesh::Triangle> {
    let Standing { placement, scale } = standing;
    let local = |x: f64, y: f64, z: f64| {
        let d = [x, y, z].iter().zip(placement.translation).map(|(a, b)| a - b).collect::<Vec<_>>();
        [0, 1, 2]
            .map(|j: usize| (0..3).map(|i| placement.rotation[i][j] * d[i]).sum::<f64>() / scale[j])
    };
    let ribbon = |[x0, y0, x1, y1]: &[f64; 4]| {
        let (a, b) = (local(*x0, *y0, 0.06), local(*x1, *y1, 0.06));
        let (c, d) = (local(*x1, *y1, 0.26), local(*x0, *y0, 0.26));
        [[a, b, c], [a, c, d]]
    };
    lines.iter().flat_map(ribbon).collect()
}

/// Writes the triangles as a COLLADA file in inches.
fn collada(triangles: &[mesh::Triangle]) -> String {
    let numbers: Vec<String> = triangles
        .iter()
        .flatten()
        .flat_map(|[x, y, z]| [*x, *y, *z].map(|v| (v / 0.0254).to_string()))
        .collect();
    let indices: Vec<String> = (0..3 * triangles.len()).map(|i| i.to_string()).collect();
    format!(
        "<COLLADA><asset><unit meter='0.0254'/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id='g'><mesh>\
         <source id='p'><float_array id='a'>{}</float_array></source><vertices id='v'><input semantic='POSITION' source='#p'/>\
         </vertices><triangles><input semantic='VERTEX' source='#v' offset='0'/><p>{}</p></triangles></mesh></geometry>\
         </library_geometries></COLLADA>",
        numbers.join(" "),
        indices.join(" ")
    )
}

/// Asserts that the lines are the same to 2 cm, each end of one near some line of the other.
fn same_lines(name: &str, ours: &[Outline], theirs: &[[f64; 4]]) {
    let thick = |[x0, y0, x1, y1]: &[f64; 4]| {
        let (a, b) = (Point::new(*x0, *y0), Point::new(*x1, *y1));
        Outline::Polygon(vec![a, b, b + Point::new(0.0, 1e-6)])
    };
    let expected: Vec<Outline> = theirs.iter().map(thick).collect();
    let far = |from: &[Outline], to: &[Outline]| {
        let corners = from.iter().flat_map(|o| o.sides().map(|s| s.a).collect::<Vec<_>>());
        let away = |p: Point| to.iter().map(|o| o.distance(p)).fold(f64::INFINITY, f64::min);
        corners.map(away).fold(0.0, f64::max)
    };
    let (missed, added) = (far(&expected, ours), far(ours, &expected));
    assert!(missed <= 0.02 && added <= 0.02, "{name}: {missed} m missed, {added} m added");
}

/// Checks that the slices of the study's own meshes, rebuilt as meshes, stand where an independent reader found them:
/// poses and scales of the state, units, axes and all instances of a mesh.
#[test]
fn rebuilt_meshes_of_the_original_worlds_are_cut_as_measured() {
    let Some(folder) = originals::folder("rebuilt_meshes_of_the_original_worlds") else { return };
    let mut compared = 0;
    for name in ["basic", "basic_v2", "office"] {
        let source = originals::source(&folder.join(format!("worlds/{name}.world")));
        let lines = golden(&folder, name);
        let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        for (model, path, standing) in standing(&source) {
            if let (Some(lines), false) = (lines.get(&model), files.contains_key(&path)) {
                files.insert(path, collada(&ribbons(lines, &standing)).into_bytes());
            }
        }
        let world = read_meshes(&source, &|path| files.get(path).cloned());
        compared += compare(&world, &lines);
        // The western bedroom's mesh is not published, and the marble table is Gazebo's own.
        assert!(world.missing() <= 2, "{name}: {:?}", world.warnings);
    }
    assert!(compared >= 45, "{compared}");
}

/// Counts the meshes of `world` for which `lines` holds a cut, and asserts that they are cut as it says.
fn compare(world: &World, lines: &Lines) -> usize {
    let is_mesh = |s: &&Solid| matches!(s.body, Body::Mesh { .. });
    let mut count = 0;
    for solid in world.solids.iter().filter(is_mesh) {
        let model = solid.name.split('/').next().unwrap();
        if let Some(expected) = lines.get(model) {
            same_lines(&solid.name, &solid.body.slice(0.1602), expected);
            count += 1;
        }
    }
    count
}

/// Checks the cuts of the study's own mesh files, where the folder is a full checkout with `worlds/models/`.
#[expect(clippy::print_stderr, reason = "a skipped test says so")]
#[test]
fn the_original_meshes_are_cut_as_measured() {
    let Some(folder) = originals::folder("the_original_meshes_are_cut_as_measured") else { return };
    if !folder.join("worlds/models").is_dir() {
        eprintln!(
            "skipped: the_original_meshes_are_cut_as_measured needs worlds/models, a full checkout"
        );
        return;
    }
    for name in ["basic", "basic_v2", "office"] {
        let source = originals::source(&folder.join(format!("worlds/{name}.world")));
        let world = read_meshes(&source, &|path| {
            let path = path.strip_prefix("blueprint_exploration/").unwrap_or(path);
            std::fs::read(folder.join(path)).ok()
        });
        assert!(compare(&world, &golden(&folder, name)) >= 3, "{name}: {:?}", world.warnings);
    }
}

/// Checks every outline that an independent reader of the same worlds found against ours.
#[test]
fn the_original_worlds_are_cut_as_measured() {
    let Some(folder) = originals::folder("the_original_worlds_are_cut_as_measured") else { return };
    let mut compared = 0;
    for entry in std::fs::read_dir(folder.join("derived")).unwrap() {
        let path = entry.unwrap().path();
        let file = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some(name) = file.strip_suffix(".primitives.csv") else { continue };
        let world = read(&originals::source(&folder.join(format!("worlds/{name}.world")))).unwrap();
        let mut ours: Vec<(String, Outline)> = world
            .solids
            .iter()
            .flat_map(|s| {
                let link = s.name.rsplit_once('/').unwrap().0.to_owned();
                s.body.slice(0.1602).into_iter().map(move |outline| (link.clone(), outline))
            })
            .collect();
        let rows = std::fs::read_to_string(&path).unwrap();
        for row in rows.lines().skip(1) {
            let fields: Vec<&str> = row.split(',').collect();
            let link = format!("{}/{}", fields[0], fields[1]);
            let numbers: Vec<f64> = fields[3..].iter().map(|f| f.parse().unwrap()).collect();
            let at = ours
                .iter()
                .position(|(name, outline)| *name == link && matches(outline, fields[2], &numbers));
            let at = at.unwrap_or_else(|| {
                panic!(
                    "{name}: {row} is missing; {:?}",
                    ours.iter().filter(|o| o.0 == link).collect::<Vec<_>>()
                )
            });
            ours.swap_remove(at);
            compared += 1;
        }
        assert!(ours.is_empty(), "{name}: {ours:?} are too many");
    }
    assert!(compared > 500, "{compared}");
}

/// Returns whether the outline has these corners (or centre and radius) to a millimetre.
fn matches(outline: &Outline, kind: &str, numbers: &[f64]) -> bool {
    match (outline, kind) {
        (Outline::Circle { center, radius }, "circle") => {
            center.distance(Point::new(numbers[0], numbers[1])) < 1e-3
                && (radius - numbers[2]).abs() < 1e-3
        }
        (Outline::Polygon(corners), "poly") => {
            let expected: Vec<Point> = numbers.chunks(2).map(|p| Point::new(p[0], p[1])).collect();
            corners.len() == expected.len()
                && corners.iter().all(|c| expected.iter().any(|e| e.distance(*c) < 1e-3))
                && expected.iter().all(|e| corners.iter().any(|c| e.distance(*c) < 1e-3))
        }
        _ => false,
    }
}
