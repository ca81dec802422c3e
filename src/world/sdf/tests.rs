use super::*;
use crate::document::mutation::{edits, mutate};
use crate::geometry::{Outline, Point};
use crate::world::originals;
use proptest::prelude::*;

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
      <link name="top"><collision name="c"><geometry><mesh><uri>model://table.dae</uri></mesh></geometry></collision></link>
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
            "worlds/tiny.world:5:5: <include> of `model://cafe` is not followed: the model is missing",
            "worlds/tiny.world:18:5: model `plug` can move in Gazebo and stands still here",
            "worlds/tiny.world:23:54: collision `table/top/c` is a mesh `model://table.dae`, which cannot be read: it is missing",
        ]
    );
    assert_eq!(world.missing(), 2, "what stands still is not missing");
}

#[test]
fn faults_say_where() {
    let changed = |from: &str, to: &str| -> Vec<String> {
        assert!(TINY.contains(from), "{from}");
        let source = Source::new("t.world", TINY.replacen(from, to, 1));
        read(&source).unwrap_err().iter().map(|fault| fault.render(false)).collect()
    };
    assert_eq!(
        changed("<scale>500 1 1</scale>", "<scale>500 0 1</scale>")[1],
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
            "<pose relative_to='house'>0 -4 1 ",
            "error: pose relative to `house` cannot be read",
        ),
        ("<pose>0 -4 1 ", "<pose>0 -4e7 1 ", "error: pose out of range"),
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

/// Every outline that an independent reader of the same worlds found, against ours.
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

/// Whether the outline has these corners (or centre and radius) to a millimetre.
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
