use super::section::{THICKNESS, cut, shadow};
use super::*;
use crate::document::mutation::{edits, mutate};
use crate::geometry::{Bounds, Outline, Placement, Point};
use crate::world::Body;
use proptest::prelude::*;
use section::Standing;

/// Returns the twelve triangles of a box around the origin.
pub(crate) fn box_triangles(size: [f64; 3]) -> Vec<Triangle> {
    let corner = |i: usize| {
        [0, 1, 2].map(|axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 } * size[axis])
    };
    let sides =
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    sides.into_iter().flat_map(halves).map(|face| face.map(corner)).collect()
}

fn text_stl(triangles: &[Triangle]) -> String {
    let mut text = "solid box\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle {
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid box\n"
}

fn binary_stl(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        #[expect(clippy::cast_possible_truncation, reason = "the format's own precision")]
        let corners = triangle.iter().flatten().flat_map(|c| (*c as f32).to_le_bytes());
        bytes.extend(corners);
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj(triangles: &[Triangle]) -> String {
    let mut text = "mtllib none.mtl\ng box\n".to_owned();
    for [x, y, z] in triangles.iter().flatten() {
        text += &format!("v {x} {y} {z}\n");
    }
    for i in 0..triangles.len() {
        text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    text
}

/// A table of one top and four instances of a leg, in inches with y up: 40 x 30 inches, 29 high, the leg turned in its node.
const TABLE: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="inch" meter="0.0254"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries>
    <geometry id="slab" name="Slab"><mesh>
      <source id="slab-p"><float_array id="slab-a" count="24">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</float_array>
        <technique_common><accessor source="#slab-a" count="8" stride="3"/></technique_common></source>
      <vertices id="slab-v"><input semantic="POSITION" source="#slab-p"/></vertices>
      <polylist count="6"><input semantic="VERTEX" source="#slab-v" offset="0"/><input semantic="NORMAL" source="#slab-p" offset="1"/>
        <vcount>4 4 4 4 4 4</vcount>
        <p>0 0 3 0 2 0 1 0  4 0 5 0 6 0 7 0  0 0 1 0 5 0 4 0  3 0 7 0 6 0 2 0  0 0 4 0 7 0 3 0  1 0 2 0 6 0 5 0</p></polylist>
    </mesh></geometry>
  </library_geometries>
  <library_nodes>
    <node id="leg" name="Leg"><rotate>0 1 0 90</rotate><scale>2 28 2</scale><instance_geometry url="#slab"/></node>
  </library_nodes>
  <library_visual_scenes><visual_scene id="s">
    <node id="top" name="Top"><translate>-20 28 -15</translate><scale>40 1 30</scale><instance_geometry url="#slab"/></node>
    <node name="Legs"><matrix>1 0 0 -20 0 1 0 0 0 0 1 -13 0 0 0 1</matrix>
      <instance_node url="#leg"/>
      <node><translate>38 0 0</translate><instance_node url="#leg"/></node>
      <node><translate>0 0 28</translate><instance_node url="#leg"/></node>
      <node><translate>38 0 28</translate><instance_node url="#leg"/></node>
    </node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"##;

const HERE: Standing = Standing { placement: Placement::IDENTITY, scale: [1.0; 3] };

fn whole(parts: &[Part]) -> Mesh {
    Mesh::new(parts.iter().flat_map(|part| part.triangles.clone()).collect())
}

fn bounds(outlines: &[Outline]) -> Bounds {
    outlines.iter().fold(Bounds::EMPTY, |b, o| b.union(o.bounds()))
}

fn near(found: Bounds, expected: [f64; 4], by: f64) -> bool {
    let found = [found.min.x, found.min.y, found.max.x, found.max.y];
    found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= by)
}

#[test]
fn every_format_holds_the_same_box() {
    let triangles = box_triangles([2.0, 1.0, 0.5]);
    let text = text_stl(&triangles);
    let files: [(&str, Vec<u8>); 3] = [
        ("a.stl", text.into_bytes()),
        ("b.STL", binary_stl(&triangles)),
        ("c.obj", obj(&triangles).into_bytes()),
    ];
    for (name, bytes) in files {
        let MeshFile { parts, .. } =
            read(name, &bytes).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        let mesh = whole(&parts);
        assert_eq!(mesh.triangles(), triangles, "{name}");
        assert!(parts[0].names == ["box"] || name == "b.STL", "{name}: {:?}", parts[0].names);
        let lines = cut(&mesh, &HERE, 0.1);
        assert_eq!(lines.len(), 8, "{name}: two triangles a side");
        assert!(near(bounds(&lines), [-1.0, -0.5, 1.0, 0.5], THICKNESS), "{name}: {lines:?}");
        assert_eq!(cut(&mesh, &HERE, 0.3), [], "{name}: above it");
    }
}

#[test]
fn a_table_stands_by_its_unit_and_the_nodes_of_its_legs() {
    let parts = read("models/table.dae", TABLE.as_bytes()).unwrap().upright().parts;
    assert_eq!(parts.len(), 5);
    assert_eq!(parts[0].names, ["Top", "top", "Slab", "slab"]);
    let mesh = whole(&parts);
    let inch = 0.0254;
    // At 0.16 m there are four legs of 2 x 2 inches, 38 inches apart along x and 28 along y.
    let legs = cut(&mesh, &HERE, 0.16);
    assert_eq!(legs.len(), 32, "four legs, four sides, two triangles");
    let reach = [-20.0 * inch, -15.0 * inch, 20.0 * inch, 15.0 * inch];
    assert!(near(bounds(&legs), reach, THICKNESS), "{:?}", bounds(&legs));
    let middle = Point::new(-19.0 * inch, 14.0 * inch);
    assert!(legs.iter().any(|o| o.distance(middle) < 1.01 * inch));
    assert!(legs.iter().all(|o| o.distance(Point::ZERO) > 20.0 * inch));
    // The top is 28 to 29 inches high and closes the middle to whatever reaches it.
    let free = |low: f64, high: f64| {
        shadow(&mesh, &HERE, low, high).iter().all(|o| o.distance(Point::ZERO) > 0.1)
    };
    assert!(free(0.0, 27.9 * inch) && !free(0.0, 28.1 * inch) && free(29.1 * inch, 2.0));
}

#[test]
fn the_up_axis_turns_nothing_unless_one_asks() {
    let read = |axis: &str| {
        let text = TABLE.replace("<up_axis>Y_UP</up_axis>", axis);
        read("t.dae", text.as_bytes()).unwrap()
    };
    let size = |file: &MeshFile| {
        let mesh = whole(&file.parts);
        let ends = |i: usize| {
            let along = mesh.triangles().iter().flatten().map(move |c| c[i]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
        };
        [ends(0), ends(1), ends(2)].map(|[l, h]| ((h - l) / 0.0254).round())
    };
    for (axis, said, turned) in [
        ("", UpAxis::Z, [40.0, 29.0, 30.0]),
        ("<up_axis>Z_UP</up_axis>", UpAxis::Z, [40.0, 29.0, 30.0]),
        ("<up_axis>Y_UP</up_axis>", UpAxis::Y, [40.0, 30.0, 29.0]),
        ("<up_axis>X_UP</up_axis>", UpAxis::X, [29.0, 30.0, 40.0]),
    ] {
        let file = read(axis);
        assert_eq!((size(&file), file.up_axis), ([40.0, 29.0, 30.0], said), "{axis}: as Gazebo");
        assert_eq!(size(&file.upright()), turned, "{axis}");
    }
}

/// Checks the form in which one well-known exporter writes: the scene, its node and the geometry go by one id.
#[test]
fn one_id_may_name_things_of_several_kinds() {
    let named = TABLE
        .replace("\"#s\"", "\"#slab\"")
        .replace("visual_scene id=\"s\"", "visual_scene id=\"slab\"")
        .replace("node id=\"leg\"", "node id=\"slab\"")
        .replace("\"#leg\"", "\"#slab\"");
    assert_ne!(named, TABLE);
    let triangles = |text: &str| whole(&read("t.dae", text.as_bytes()).unwrap().parts);
    assert_eq!(triangles(&named), triangles(TABLE));
}

#[test]
fn faults_say_what_is_wrong_and_where() {
    let told = |name: &str, bytes: &[u8]| -> String {
        read(name, bytes).unwrap_err().iter().map(|fault| fault.render(false)).collect()
    };
    let changed = |from: &str, to: &str| {
        assert!(TABLE.contains(from), "{from}");
        told("t.dae", TABLE.replacen(from, to, 1).as_bytes())
    };
    assert_eq!(
        changed("<p>0 0 3", "<p>0 0 8"),
        "\
error: index out of range
  --> t.dae:11:9
   |
11 |         <p>0 0 8 0 2 0 1 0  4 0 5 0 6 0 7 0  0 0 1 0 5 0 4 0  3 0 7 0 6 0 2 0  0 0 4 0 7 0 3 0  1 0 2 0 6 0 5 0</p></polylist>
   |         ^^ expected indices below 8, found 8
"
    );
    for (from, to, message) in [
        ("meter=\"0.0254\"", "meter=\"-1\"", "error: unit out of range"),
        ("Y_UP", "W_UP", "error: unknown up axis"),
        ("0 0 0 1 0 0", "0 0 NaN 1 0 0", "error: malformed number"),
        ("url=\"#leg\"", "url=\"#arm\"", "error: <instance_node> names `#arm`, which is not there"),
        ("<scale>2 28 2", "<scale>2 28", "error: wrong count of numbers in <scale>"),
        ("<scale>2 28 2</scale>", "<lookat/>", "error: <lookat> cannot be read"),
        ("4 4 4 4 4 4", "4 4 4 4 4 9", "error: too few corners"),
        ("semantic=\"VERTEX\"", "semantic=\"COLOR\"", "error: <polylist> has no vertices"),
        (
            "<matrix>1 0 0 -20",
            "<matrix>1 0 0 -2e9",
            "error: cannot read the mesh: expected coordinates within 100000 m of the origin, found -508",
        ),
        ("<rotate>", "<instance_node url=\"#leg\"/><rotate>", "error: too many nodes"),
    ] {
        let found = changed(from, to);
        assert!(found.lines().next().is_some_and(|l| l.starts_with(message)), "{message}: {found}");
    }
    assert_eq!(
        told("a.ply", b""),
        "error: cannot read the mesh `a.ply`: expected .stl, .obj or .dae, found `.ply`\n"
    );
    assert_eq!(
        told("a.obj", b"v 1 2 3\n"),
        "error: cannot read the mesh `a.obj`: it has no triangle\n"
    );
    let mut lies = binary_stl(&box_triangles([1.0; 3]));
    lies[80..84].copy_from_slice(&[0xff; 4]);
    assert_eq!(
        told("a.stl", &lies),
        "error: cannot read the mesh `a.stl`: it announces 4294967295 triangles and holds 12\n"
    );
    let mut hot = binary_stl(&box_triangles([1.0; 3]));
    hot[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    let nan = told("a.stl", &hot);
    assert!(
        nan.ends_with("expected coordinates within 100000 m of the origin, found NaN\n"),
        "{nan}"
    );
}

#[test]
fn a_mesh_means_what_it_holds() {
    let mesh = Mesh::new(box_triangles([1.0; 3]));
    assert_eq!(mesh, Mesh::new(box_triangles([1.0; 3])));
    let text = serde_json::to_string(&mesh).unwrap();
    assert!(
        text.len() < 100
            && text != serde_json::to_string(&Mesh::new(box_triangles([2.0; 3]))).unwrap()
    );
}

prop_compose! {
    fn placements()(
        x in -5.0..5.0, y in -5.0..5.0, z in -0.5..0.5, roll in -3.2..3.2, pitch in -1.5..1.5, yaw in -3.2..3.2,
    ) -> Placement {
        Placement::from_xyz_rpy([x, y, z, roll, pitch, yaw])
    }
}

proptest! {
    /// Checks that a mesh of a box is cut and casts its shadow as the box does, however it is turned and scaled.
    #[test]
    fn a_box_of_triangles_is_a_box(
        placement in placements(), size in prop::array::uniform3(0.05..3.0), scale in prop::array::uniform3(0.1..4.0),
        low in -1.0..1.0, more in 0.0..1.0,
    ) {
        let full = [size[0] * scale[0], size[1] * scale[1], size[2] * scale[2]];
        let solid = Body::Box { size: full, placement };
        let mesh = Mesh::new(box_triangles(size));
        let surface = Body::Mesh { mesh, standing: Standing { placement, scale } };
        for (ours, theirs) in [
            (surface.slice(low), solid.slice(low)),
            (surface.shadow(low, low + more), solid.shadow(low, low + more)),
        ] {
            // A plane that only just meets the box may meet one of the two.
            let extent = |b: Bounds| b.width().max(b.height());
            let (ours, theirs) = (bounds(&ours), bounds(&theirs));
            if ours.is_empty() || theirs.is_empty() {
                prop_assert!(extent(ours).max(extent(theirs)).max(0.0) < 0.02 || !extent(ours).is_finite(), "{ours:?} {theirs:?}");
            } else {
                let expected = [theirs.min.x, theirs.min.y, theirs.max.x, theirs.max.y];
                prop_assert!(near(ours, expected, 2.0 * THICKNESS), "{ours:?} {theirs:?}");
            }
        }
    }

    /// Checks that what lies between two heights covers every cut between them.
    #[test]
    fn a_cut_lies_in_the_shadow(placement in placements(), low in -1.0..0.0, more in 0.1..1.0, at in 0.0..1.0) {
        let mesh = Mesh::new(box_triangles([1.0, 0.7, 0.4]));
        let standing = Standing { placement, scale: [1.0; 3] };
        let shade = shadow(&mesh, &standing, low, low + more);
        for line in cut(&mesh, &standing, low + at * more) {
            for side in line.sides() {
                let nearest = shade.iter().map(|o| o.distance(side.a)).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= 2.0 * THICKNESS, "{nearest}");
            }
        }
    }

    #[test]
    fn damaged_files_never_panic(edits in edits(), kind in 0..4_usize) {
        let triangles = box_triangles([1.0; 3]);
        let (name, bytes) = match kind {
            0 => ("a.dae", TABLE.as_bytes().to_vec()),
            1 => ("a.stl", text_stl(&triangles).into_bytes()),
            2 => ("a.stl", binary_stl(&triangles)),
            _ => ("a.obj", obj(&triangles).into_bytes()),
        };
        if let Ok(file) = read(name, &mutate(&bytes, &edits)) {
            let mesh = whole(&file.parts);
            let _ = (cut(&mesh, &HERE, 0.1), shadow(&mesh, &HERE, 0.0, 0.4));
        }
    }
}
