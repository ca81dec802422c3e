mod frames;
mod includes;
mod originals;
mod shapes;

use super::*;
use crate::document::mutation::{edits, mutate};
use crate::geometry::{Bounds, Outline, Point};
use crate::world::{Body, Solid};
use proptest::prelude::*;
use std::sync::Arc;

/// A wall with a lintel, a box on its side, a plug that only the state's scale makes a plug, a table leg, a
/// polygon, and things that cannot be read.
const TINY: &str = r#"<?xml version="1.0"?>
<sdf version="1.6">
  <world name="default">
    <include><uri>model://sun</uri></include>
    <include><uri>model://cafe</uri></include>
    <model name="ground_plane"><static>1</static><link name="link"><collision name="c">
      <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model>
    <model name="house"><static>true</static>
      <pose frame=''>50 50 0 0 0 0</pose>
      <link name="wall"><pose>0 2 0 0 0 0</pose>
        <collision name="left"><pose>-2 0 1.25 0 0 0</pose><geometry><box><size>3 0.15 2.5</size></box></geometry></collision>
        <collision name="lintel"><pose>0 0 2.25 0 0 0</pose><geometry><box><size>1 0.15 0.5</size></box></geometry></collision>
        <visual name="v"><geometry><box><size>9 9 9</size></box></geometry></visual>
      </link>
    </model>
    <model name="car"><static>1</static><pose>0 -4 1 1.5707963267948966 0 0</pose><link name="link"><collision name="c">
      <geometry><box><size>4.5 4 2</size></box></geometry></collision></link></model>
    <model name="plug"><link name="link"><collision name="c">
      <geometry><box><size>0.004 1 1</size></box></geometry></collision></link></model>
    <model name="table"><static>1</static><pose>1 1 0 0 0 0</pose>
      <model name="leg"><pose>1 0 0.35 0 0 0</pose><link name="link"><collision name="c">
        <geometry><cylinder><radius>0.02</radius><length>0.7</length></cylinder></geometry></collision></link></model>
      <link name="top"><collision name="c"><geometry><mesh><uri>model://table/t.obj</uri></mesh></geometry></collision></link>
    </model>
    <model name="stage"><static>1</static><pose>0 8 0 0 0 1.5707963267948966</pose><link name="link"><collision name="c">
      <geometry><polyline><point>0 0</point><point>2 0</point><point>0 1</point><height>0.5</height></polyline></geometry></collision></link></model>
    <state world_name="default">
      <model name="house"><pose>10 0 0 0 0 1.5707963267948966</pose><scale>1 1 1</scale>
        <link name="wall"><pose>8 0 0 0 0 1.5707963267948966</pose></link></model>
      <model name="plug"><pose>3 3 0.5 0 0 0</pose><scale>500 1 1</scale></model>
    </state>
  </world>
</sdf>"#;

fn close(outline: &Outline, expected: [[f64; 2]; 2]) -> bool {
    let bounds = outline.bounds();
    let found = [[bounds.min.x, bounds.min.y], [bounds.max.x, bounds.max.y]];
    found.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-9)
}

#[test]
fn the_state_places_and_scales_and_the_plane_cuts() {
    let world = read(&Source::new("worlds/tiny.world", TINY)).unwrap();
    assert_eq!((world.name.as_str(), world.layers()), ("tiny", vec![LAYER]));
    let names: Vec<_> = world.solids.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "house/wall/left",
            "house/wall/lintel",
            "car/link/c",
            "plug/link/c",
            "table/leg/link/c",
            "stage/link/c"
        ]
    );
    let cut = world.slice(0.1602);
    assert_eq!(cut.len(), 5, "the lintel is above the scan plane");
    // The wall's link stands at (8, 0) turned by a quarter: its box, 2 m back along x, is 2 m back along y.
    assert!(close(&cut[0], [[7.925, -3.5], [8.075, -0.5]]), "{:?}", cut[0]);
    // The car lies on its side: 2 m high became 2 m wide.
    assert!(close(&cut[1], [[-2.25, -5.0], [2.25, -3.0]]), "{:?}", cut[1]);
    assert!(close(&cut[2], [[2.0, 2.5], [4.0, 3.5]]), "{:?}", cut[2]);
    assert_eq!(cut[3], Outline::Circle { center: Point::new(2.0, 1.0), radius: 0.02 });
    assert!(close(&cut[4], [[-1.0, 8.0], [0.0, 10.0]]), "{:?}", cut[4]);
    assert_eq!(
        world.warnings,
        [
            "worlds/tiny.world:5:5: <include> of `model://cafe`: no folder of models is given; name its own folder (`models: {cafe: FOLDER}`) or one that holds it (`model-path: [FOLDER]`): the model is missing",
            "worlds/tiny.world:18:5: model `plug` can move in Gazebo and stands still here",
            "worlds/tiny.world:23:54: collision `table/top/c` is a mesh `model://table/t.obj`, which cannot be read: it is missing",
        ]
    );
    assert_eq!(world.missing(), 2, "what stands still is not missing");
}

#[test]
fn a_mesh_that_is_missing_is_told_once_for_all_clones() {
    let chair = |name: &str, scale: &str| {
        format!(
            "<model name='{name}'><static>1</static><link name='l'><collision name='c'><geometry><mesh>\
             <uri>model://chair/chair.dae</uri>{scale}</mesh></geometry></collision></link></model>"
        )
    };
    let clones: String = ["chair", "chair_clone", "chair_clone_0"]
        .map(|name| chair(name, ""))
        .into_iter()
        .chain([chair("chair_clone_1", "<scale>2 2 2</scale>")])
        .collect();
    let wall = "<model name='wall'><static>1</static><link name='l'><collision name='c'><geometry><box><size>4 0.2 2</size></box>\
                </geometry></collision></link></model>";
    let text = format!("<sdf version='1.6'><world name='a'>{wall}{clones}</world></sdf>");
    let world = read(&Source::new("a.world", text)).unwrap();
    let told: Vec<&str> = world.warnings.iter().map(|w| w.split_once(": ").unwrap().1).collect();
    assert_eq!(
        told,
        [
            "4 collisions (`chair/l/c`, `chair_clone/l/c`, `chair_clone_0/l/c`, `chair_clone_1/l/c`) are a mesh \
          `model://chair/chair.dae`, which cannot be read: 4 are missing"
        ]
    );
    assert_eq!(world.missing(), 4);
}

#[test]
fn faults_say_where() {
    let changed = |from: &str, to: &str| -> Vec<String> {
        assert!(TINY.contains(from), "{from}");
        let source = Source::new("t.world", TINY.replacen(from, to, 1));
        let faults = read(&source).unwrap_err();
        let errors = faults.iter().filter(|fault| fault.severity == Severity::Error);
        errors.map(|fault| fault.render(false)).collect()
    };
    assert_eq!(
        changed("<scale>500 1 1</scale>", "<scale>500 0 1</scale>")[0],
        "\
error: scale out of range
  --> t.world:30:52
   |
30 |       <model name=\"plug\"><pose>3 3 0.5 0 0 0</pose><scale>500 0 1</scale></model>
   |                                                    ^^^^^^ expected three factors above zero
"
    );
    for (from, to, message) in [
        ("<size>4.5 4 2</size>", "<size>4.5 -4 2</size>", "error: box out of range"),
        ("<size>4.5 4 2</size>", "<size>4.5 4</size>", "error: wrong count of numbers in <size>"),
        ("<size>4.5 4 2</size>", "", "error: <box> has no <size>"),
        ("<radius>0.02</radius>", "<radius>inf</radius>", "error: malformed number in <radius>"),
        ("<point>2 0</point>", "", "error: polyline with too few corners"),
        (
            "<pose>0 -4 1 ",
            "<pose relative_to='hous'>0 -4 1 ",
            "error: pose relative to the unknown frame `hous`",
        ),
        ("<sdf ", "<robot><sdf ", "error: not well-formed XML"),
    ] {
        let found = changed(from, to);
        assert!(found.iter().any(|f| f.lines().next() == Some(message)), "{message}: {found:#?}");
    }
    let empty =
        read(&Source::new("e.sdf", "<sdf version='1.6'><world name='a'/></sdf>")).unwrap_err();
    assert_eq!(empty[0].message, "the world has nothing solid that can be read");
    let robot = read(&Source::new("r.urdf", "<robot name='a'/>")).unwrap_err();
    assert_eq!(robot[0].help.as_deref(), Some("a URDF describes a robot; name it under `robot`"));
}

/// Files by name, stand-ins by URI. A model's folder is in the folder `m`.
#[derive(Default)]
pub(super) struct Shelf {
    pub(super) files: BTreeMap<String, Vec<u8>>,
    pub(super) stand_ins: BTreeMap<String, Arc<[Solid]>>,
    pub(super) without: Vec<String>,
    pub(super) asked: Vec<String>,
    pub(super) turns: bool,
}

impl Shelf {
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        let bytes = |(name, text): &(&str, &str)| ((*name).to_owned(), text.as_bytes().to_vec());
        Self { files: files.iter().map(bytes).collect(), ..Self::default() }
    }
}

impl Models for Shelf {
    fn folders(&self) -> Folders {
        Folders { models: BTreeMap::new(), path: vec!["m".to_owned()] }
    }

    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String> {
        let found = self.files.get(&path.path).cloned();
        found.map(Into::into).ok_or_else(|| "no such file".to_owned())
    }

    fn stand_in(&mut self, uri: &str) -> Option<Arc<[Solid]>> {
        self.stand_ins.get(uri).cloned()
    }

    fn wanted(&mut self, name: &str) -> bool {
        self.asked.push(name.to_owned());
        !self.without.iter().any(|n| n == name)
    }

    fn turns_meshes(&self) -> bool {
        self.turns
    }
}

/// Returns a unit cube as OBJ, its part called `cube`.
pub(super) fn cube() -> String {
    let corner = |i: usize, axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
    let vertices =
        (0..8).map(|i| format!("v {} {} {}\n", corner(i, 0), corner(i, 1), corner(i, 2)));
    let faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"];
    vertices.chain(["g cube\n".to_owned()]).chain(faces.map(|face| format!("f {face}\n"))).collect()
}

#[test]
fn a_mesh_stands_where_its_collision_does_scaled_twice() {
    // The plug's state scales it by 500 along x; the table stands at (1, 1).
    let text = TINY
        .replace(
            "<box><size>0.004 1 1</size></box>",
            "<mesh><uri>plug.obj</uri><scale>0.004 1 1</scale></mesh>",
        )
        .replace("model://table/t.obj</uri>", "model://table/t.obj</uri><scale>2 1 0.5</scale>");
    let cube = cube();
    let mut shelf = Shelf::of(&[("plug.obj", cube.as_str()), ("m/table/t.obj", cube.as_str())]);
    let world = read_with(&Source::new("t.world", text), &mut shelf).unwrap();
    let reach = |name: &str, z: f64| {
        let solid = world.solids.iter().find(|s| s.name == name).unwrap();
        let bounds = solid.body.slice(z).iter().fold(Bounds::EMPTY, |b, o| b.union(o.bounds()));
        [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]
            .map(|v| (v * 100.0).round() / 100.0)
    };
    assert_eq!(reach("plug/link/c", 0.9), [2.0, 2.5, 4.0, 3.5]);
    assert_eq!(reach("table/top/c", 0.2), [0.0, 0.5, 2.0, 1.5]);
    assert!(world.solids.last().unwrap().body.shadow(0.3, 9.0).len() < 9 && world.missing() == 1);
}

#[test]
fn what_stands_for_a_mesh_or_lacks_is_told() {
    const URI: &str = "model://table/t.obj";
    let with = |text: &str, mesh: Option<&str>, solids: &[Solid]| {
        let mut shelf =
            Shelf::of(&mesh.map(|text| ("m/table/t.obj", text)).into_iter().collect::<Vec<_>>());
        if !solids.is_empty() {
            shelf.stand_ins.insert(URI.to_owned(), solids.into());
        }
        read_with(&Source::new("t.world", text), &mut shelf)
    };
    let outline = Outline::Circle { center: Point::new(0.5, 0.0), radius: 0.2 };
    let body = Body::Prism { outline, z: [0.0, 0.4] };
    let leg = Solid { name: "leg".to_owned(), layer: LAYER.to_owned(), body };
    let world = with(TINY, None, std::slice::from_ref(&leg)).unwrap();
    let table = world.solids.iter().find(|s| s.name == "table/top/c").unwrap();
    let expected = Outline::Circle { center: Point::new(1.5, 1.0), radius: 0.2 };
    assert_eq!(table.body.slice(0.2), [expected]);
    assert_eq!(world.missing(), 1, "the café alone");

    let lacking = with(TINY, None, &[]).unwrap();
    assert_eq!(
        lacking.warnings[2],
        "t.world:23:54: collision `table/top/c` is a mesh `model://table/t.obj`; `m/table/t.obj`: no such file: it is missing"
    );
    assert_eq!(lacking.missing(), 2);

    let leaning = TINY.replace("<pose>1 1 0 0 0 0</pose>", "<pose>1 1 0 0.5 0 0</pose>");
    let told = |faults: Vec<Diagnostic>| {
        faults.iter().find(|f| f.severity == Severity::Error).unwrap().render(false)
    };
    assert!(
        told(with(&leaning, None, &[leg]).unwrap_err())
            .starts_with("error: what stands in for this mesh would lean")
    );
    let parted = TINY.replace(
        "model://table/t.obj</uri>",
        "model://table/t.obj</uri><submesh><name>lamp</name></submesh>",
    );
    let cube = cube();
    let no_part = told(with(&parted, Some(&cube), &[]).unwrap_err());
    assert!(no_part.starts_with("error: the mesh has no part `lamp`"), "{no_part}");
    assert!(no_part.contains("its parts are cube"), "{no_part}");
    assert!(with(&parted.replace("lamp", "cube"), Some(&cube), &[]).unwrap().missing() == 1);
    let scaled =
        TINY.replace("model://table/t.obj</uri>", "model://table/t.obj</uri><scale>1 0 1</scale>");
    assert!(
        told(with(&scaled, Some(&cube), &[]).unwrap_err()).starts_with("error: scale out of range")
    );
    assert_eq!(
        told(with(TINY, Some("v 0 0 0\n"), &[]).unwrap_err()),
        "error: cannot read the mesh `m/table/t.obj`: it has no triangle\n"
    );
}

#[test]
fn uris_lead_into_folders_that_are_given_and_nowhere_else() {
    let models = BTreeMap::from([("house".to_owned(), "models/house".to_owned())]);
    let folders = Folders { models, path: vec!["../path/models".to_owned()] };
    let none = Folders::default();
    let inner = FilePath { root: Root::Models, path: "models/house/model.sdf".to_owned() };
    let places = |uri: &str, beside: &FilePath| -> Vec<String> {
        let places =
            folders.places(uri, beside, &mut NoModels).unwrap_or_else(|why| panic!("{uri}: {why}"));
        places.iter().map(|p| format!("{:?} {}", p.root, p.path)).collect()
    };
    for (uri, expected) in [
        (
            "model://house/m/bed.dae",
            &["Models models/house/m/bed.dae", "ModelPath ../path/models/house/m/bed.dae"][..],
        ),
        (
            "model:///house/m/bed.dae",
            &["Models models/house/m/bed.dae", "ModelPath ../path/models/house/m/bed.dae"],
        ),
        ("package://shed/a.dae", &["ModelPath ../path/models/shed/a.dae"]),
        ("file://m/a.stl", &["World m/a.stl", "ModelPath ../path/models/m/a.stl"]),
        ("m/a.stl", &["World m/a.stl", "ModelPath ../path/models/m/a.stl"]),
        (
            "file://models/shed/a.stl",
            &[
                "World models/shed/a.stl",
                "ModelPath ../path/models/shed/a.stl",
                "ModelPath ../path/models/models/shed/a.stl",
            ],
        ),
        (
            "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Big Shed/3/files/a.dae",
            &[
                "ModelPath ../path/models/Big Shed/a.dae",
                "ModelPath ../path/models/big shed/a.dae",
                "ModelPath ../path/models/big_shed/a.dae",
            ],
        ),
        (
            "https://fuel.gazebosim.org/1.0/openrobotics/models/house",
            &["Models models/house", "ModelPath ../path/models/house"],
        ),
    ] {
        assert_eq!(places(uri, &FilePath::WORLD), expected, "{uri}");
    }
    assert_eq!(
        places("meshes/bed.dae", &inner),
        [
            "Models models/house/meshes/bed.dae",
            "World meshes/bed.dae",
            "ModelPath ../path/models/meshes/bed.dae"
        ]
    );
    for (uri, why) in [
        (
            "model://house/../a.dae",
            "its path leads out of the folder, where none of `--allow FOLDER` is",
        ),
        ("model://../a.dae", "its path leads out of the folder, where none of `--allow FOLDER` is"),
        ("model://..", "its path leads out of the folder, where none of `--allow FOLDER` is"),
        ("../a.dae", "its path leads out of the folder, where none of `--allow FOLDER` is"),
        (
            "file:///home/a.stl",
            "a path from the root of some machine is not followed without `--allow FOLDER`",
        ),
        ("https://example.org/a.stl", ""),
        ("", ""),
    ] {
        assert_eq!(
            folders.places(uri, &inner, &mut NoModels).unwrap_err().to_string(),
            why,
            "{uri}"
        );
    }
    assert_eq!(none.places("model://house/a.dae", &inner, &mut NoModels), Err(Unplaced::Untold));
    let other = Folders { path: Vec::new(), ..folders.clone() };
    let why = other.places("model://shed/a.dae", &inner, &mut NoModels).unwrap_err();
    assert_eq!(why.to_string(), "no folder is given for the model `shed`");
}

proptest! {
    #[test]
    fn damaged_worlds_never_panic(edits in edits()) {
        let text = String::from_utf8_lossy(&mutate(TINY.as_bytes(), &edits)).into_owned();
        if let Ok(world) = read(&Source::new("t.world", text)) {
            prop_assert!(!world.solids.is_empty());
            let _ = (world.slice(0.16), world.contact(0.0, 0.4), world.meaning());
        }
    }
}
