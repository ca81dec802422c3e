//! Shapes, floors, meshes' axes, and slips of units.

use super::*;

fn world_of(models: &str) -> String {
    format!("<sdf version='1.9'><world name='w'>{models}</world></sdf>")
}

fn model(name: &str, pose: &str, geometry: &str) -> String {
    format!(
        "<model name='{name}'><static>1</static><pose>{pose}</pose><link name='l'><collision name='c'><geometry>{geometry}</geometry></collision></link></model>"
    )
}

fn read_models(models: &str, shelf: &mut Shelf) -> World {
    read_with(&Source::new("t.sdf", world_of(models)), shelf).unwrap_or_else(|faults| {
        panic!("{}", faults.iter().map(|f| f.render(false)).collect::<String>())
    })
}

#[test]
fn round_shapes_and_upright_planes_are_solid() {
    let shape = |geometry: &str, pose: &str, z: f64| {
        let world = read_models(&model("m", pose, geometry), &mut Shelf::default());
        let outlines = world.slice(z);
        let bounds = outlines.iter().fold(Bounds::EMPTY, |b, o| b.union(o.bounds()));
        assert_eq!(outlines.len(), 1, "{geometry}");
        [bounds.width(), bounds.height()].map(|v| (v * 100.0).round() / 100.0)
    };
    assert_eq!(shape("<sphere><radius>0.5</radius></sphere>", "0 0 0.5 0 0 0", 0.5), [1.0, 1.0]);
    assert_eq!(
        shape(
            "<capsule><radius>0.2</radius><length>1</length></capsule>",
            "0 0 0.2 0 1.5708 0",
            0.2
        ),
        [1.4, 0.4]
    );
    assert_eq!(
        shape("<ellipsoid><radii>0.5 0.25 1</radii></ellipsoid>", "0 0 0 0 0 0", 0.0),
        [1.0, 0.5]
    );
    assert_eq!(
        shape("<cone><radius>0.5</radius><length>1</length></cone>", "0 0 0.5 0 0 0", 0.5),
        [0.5, 0.5]
    );
    let plane = "<plane><normal>1 0 0</normal><size>3 5</size></plane>";
    assert_eq!(shape(plane, "0 0 0.5 0 0 0", 0.2), [0.0, 5.0], "a wall");
    let turned = "<plane><normal>0 0 1</normal><size>3 5</size></plane>";
    assert_eq!(shape(turned, "0 0 0.5 1.5707963267948966 0 0", 0.2), [3.0, 0.0], "lying down");
}

#[test]
fn floors_are_stood_upon_and_steps_are_not() {
    let wall = model("wall", "0 4 .5 0 0 0", "<box><size>10 .2 1</size></box>");
    let solids = |thing: &str| {
        let world = read_models(&format!("{wall}{thing}"), &mut Shelf::default());
        (world.solids.len(), world.warnings)
    };
    let boxed = |z: f64, size: &str| {
        model("thing", &format!("0 0 {z} 0 0 0"), &format!("<box><size>{size}</size></box>"))
    };
    assert_eq!(
        solids(&boxed(0.0, "10 8 0.1")),
        (1, vec!["`thing/l/c` lies flat on the ground: it is floor".to_owned()])
    );
    assert_eq!(solids(&boxed(-0.5, "10 8 1")).0, 1, "the ground itself");
    assert_eq!(solids(&boxed(0.0, "1 8 0.1")).0, 2, "no wider than a robot");
    assert_eq!(solids(&boxed(0.0, "10 8 0.14")).0, 2, "a step too high");
    assert_eq!(solids(&boxed(0.0, "1 0.1 0.03")).0, 1, "a sill");
    assert_eq!(solids(&boxed(0.5, "10 8 0.1")).0, 2, "a table");
    let ground = model(
        "ground_plane",
        "0 0 0 0 0 0",
        "<plane><normal>0 0 1</normal><size>100 100</size></plane>",
    );
    assert_eq!(solids(&ground), (1, Vec::new()), "nothing need be told of the ground");
}

#[test]
fn of_a_mesh_with_walls_on_its_floor_the_walls_stand() {
    let triangles = "v -5 -5 0.05\nv 5 -5 0.05\nv 5 5 0.05\nv -5 5 0.05\nv -5 5 2\nv 5 5 2\n\
        g hall\nf 1 2 3\nf 1 3 4\nf 4 3 6\nf 4 6 5\n";
    let mut shelf = Shelf::of(&[("hall.obj", triangles)]);
    let hall = model("hall", "0 0 0 0 0 0", "<mesh><uri>hall.obj</uri></mesh>");
    let world = read_models(&hall, &mut shelf);
    assert!(world.contact(0.0, 0.4).iter().all(|o| o.distance(Point::ZERO) > 4.9));
    assert_eq!(world.slice(0.2).len(), 2);
}

#[test]
fn what_is_far_too_far_away_is_missing_and_the_rest_stands() {
    let one = model("wall", "0 0 .5 0 0 0", "<box><size>4 .2 1</size></box>");
    let far = model("book", "1 1 343582.7 0 0 0", "<box><size>.2 .2 .1</size></box>");
    let world = read_models(&(one + &far), &mut Shelf::default());
    assert_eq!(world.solids.len(), 1);
    let told = world.warnings.iter().map(|w| w.rsplit_once(": `").unwrap().1).collect::<Vec<_>>();
    assert_eq!(told, ["book/l/c` is 343583 m away: it is missing"]);
    assert_eq!(world.missing(), 1);
}

#[test]
fn degrees_for_radians_are_noticed() {
    let cube = "<box><size>1 1 1</size></box>";
    let models = model("a", "0 0 0.5 0 0 90", cube) + &model("b", "3 0 0.5 0 0 1.5708", cube);
    let told = |models: &str| read_models(models, &mut Shelf::default()).warnings;
    let question =
        "angles are read as radians, are these degrees? SDFormat has `<pose degrees=\"true\">`";
    let one = told(&models);
    assert_eq!(one.len(), 1, "{one:?}");
    let said = format!(": the pose of `a` turns by more than once around: {question}");
    assert!(one[0].ends_with(&said), "{one:?}");
    let both = told(&models.replace("1.5708", "180"));
    assert_eq!(both.len(), 1, "{both:?}");
    let said = format!(": 2 poses (of `a`, `b`) turn by more than once around: {question}");
    assert!(both[0].ends_with(&said), "{both:?}");
}

#[test]
fn a_town_in_millimetres_is_noticed() {
    let wall = model("wall", "0 0 .5 0 0 0", "<box><size>12000 200 2500</size></box>");
    let world = read_models(&wall, &mut Shelf::default());
    assert_eq!(
        world.warnings,
        [
            "the world is 12000 m wide (`wall/l/c` alone 12000 m): are its lengths in millimetres? Metres are expected"
        ]
    );
}

/// Returns a quad of 2 x 0.8 m, 1 m along the third axis, that says y is up.
fn y_up() -> String {
    "<COLLADA><asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id='g'><mesh>\
     <source id='p'><float_array id='a'>-1 0 -0.4 1 0 -0.4 1 0 0.4 -1 1 0.4</float_array></source>\
     <vertices id='v'><input semantic='POSITION' source='#p'/></vertices><polygons>\
     <input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2 3</p></polygons></mesh></geometry></library_geometries></COLLADA>"
        .to_owned()
}

#[test]
fn the_up_axis_of_a_mesh_is_noticed_and_turns_it_only_where_one_asks() {
    let text = y_up();
    let box_of = |name: &str, x: f64| {
        model(name, &format!("{x} 0 .5 0 0 0"), "<mesh><uri>b.dae</uri></mesh>")
    };
    let models = box_of("a", 0.0) + &box_of("b", 5.0);
    let mut shelf = Shelf::of(&[("b.dae", &text)]);
    let as_gazebo = read_models(&models, &mut shelf);
    assert_eq!(
        as_gazebo.warnings,
        ["the mesh `b.dae` says that y is up: taken as Gazebo does, which turns no mesh by that"]
    );
    shelf.turns = true;
    let turned = read_models(&models, &mut shelf);
    assert_eq!(turned.warnings, [""; 0]);
    let height = |world: &World| world.solids[0].body.heights().map(|z| (z * 10.0).round() / 10.0);
    assert_eq!((height(&as_gazebo), height(&turned)), ([0.1, 0.9], [0.5, 1.5]));
}

#[test]
fn what_is_missing_is_told_once_for_each_kind_and_counted_whole() {
    let wall = model("wall", "0 0 .5 0 0 0", "<box><size>4 .2 1</size></box>");
    let chairs: String = (0..7)
        .map(|i| {
            model(
                &format!("chair{i}"),
                "0 0 0 0 0 0",
                "<mesh><uri>model://chair/c.dae</uri></mesh>",
            )
        })
        .collect();
    let hills = model("hill", "0 0 0 0 0 0", "<heightmap><uri>hill.png</uri></heightmap>")
        + &model("urn", "0 0 0 0 0 0", "<image><uri>urn.png</uri></image>")
        + &model("scan", "0 0 0 0 0 0", "<mesh><uri>scan.glb</uri></mesh>");
    let actors = "<actor name='ann'/><actor name='bob'/><light name='lamp'/><physics/><gui/><plugin name='p'/>";
    let world = read_models(&format!("{wall}{chairs}{hills}{actors}"), &mut Shelf::default());
    let told: Vec<&str> = world.warnings.iter().map(|w| w.splitn(4, ':').last().unwrap()).collect();
    assert_eq!(
        told,
        [
            " 7 collisions (`chair0/l/c`, `chair1/l/c`, `chair2/l/c`, `chair3/l/c`, ...) are a mesh `model://chair/c.dae`; `m/chair/c.dae`: no such file: 7 are missing",
            " collision `hill/l/c` is a heightmap `hill.png`; no such file: `hill.png`, `m/hill.png`: it is missing",
            " collision `urn/l/c` is an image `urn.png`, which cannot be read: it is missing",
            " collision `scan/l/c` is a mesh `scan.glb`; `.glb` is not read (.stl, .obj and .dae are): it is missing",
            " 2 times <actor> (`ann`, `bob`) cannot be read: 2 are missing",
        ]
    );
    assert_eq!(world.missing(), 12);
}

/// A hill of 1 m in a field of 8 m by 8 m: of the flat ground nothing is left, of the hill what a lidar at 0.5 m meets.
#[test]
fn a_heightmap_is_floor_where_it_is_flat_and_a_wall_where_it_rises() {
    let field =
        "<heightmap><uri>model://field/f.pgm</uri><size>8 8 1</size><pos>1 0 0</pos></heightmap>";
    let hill = "P2 5 5 255\n0 0 0 0 0\n0 0 0 255 0\n0 0 0 0 0\n0 0 0 0 0\n0 0 0 0 0\n";
    let mut shelf = Shelf::of(&[("m/field/f.pgm", hill)]);
    let world = read_models(&model("field", "0 0 0 0 0 0", field), &mut shelf);
    assert_eq!((world.warnings.len(), world.missing(), world.solids.len()), (0, 0, 1));
    let Body::Mesh { mesh, standing } = &world.solids[0].body else { panic!("a mesh") };
    assert_eq!(standing.triangles(mesh).count(), 6, "those at the top");
    // The hill stands at (3, 2); halfway up it is half as wide.
    let met: Vec<Outline> = world.slice(0.5);
    let bounds = met.iter().fold(Bounds::EMPTY, |b, outline| b.union(outline.bounds()));
    let near = |a: f64, b: f64| (a - b).abs() < 0.02;
    assert!(near(bounds.min.x, 2.0) && near(bounds.max.x, 4.0), "{bounds:?}");
    assert!(near(bounds.min.y, 1.0) && near(bounds.max.y, 3.0), "{bounds:?}");
}

/// A file of some kilobytes would otherwise cost as much memory as it names heightmaps.
#[test]
fn heightmaps_are_read_once_and_of_all_together_only_so_much_is_drawn() {
    let fields: String = (0..5)
        .map(|i| {
            let place = format!("<uri>model://f/f.pgm</uri><size>9 9 9</size><pos>{i} 0 0</pos>");
            let name = format!("field{i}");
            model(&name, "0 0 0 0 0 0", &format!("<heightmap>{place}</heightmap>"))
        })
        .collect();
    let mut image = b"P5 513 513 255\n".to_vec();
    image.extend((0..513 * 513).map(|i| if i % 7 == 0 { 255 } else { 200 }));
    let mut shelf = Shelf { files: [("m/f/f.pgm".to_owned(), image)].into(), ..Shelf::default() };
    let world = read_models(&fields, &mut shelf);
    assert_eq!((world.solids.len(), world.missing()), (2, 3), "two of half a million triangles");
    let told: Vec<&str> = world.warnings.iter().map(|w| w.splitn(4, ':').last().unwrap()).collect();
    assert_eq!(
        told,
        [
            " 3 collisions (`field2/l/c`, `field3/l/c`, `field4/l/c`) are a heightmap `model://f/f.pgm`; the heightmaps of the world \
          have more than 1048576 triangles with it: 3 are missing"
        ]
    );
}

#[test]
fn formats_and_versions_that_are_not_read_are_named() {
    let told = |text: &str| read(&Source::new("t.sdf", text)).unwrap_err()[0].render(false);
    assert_eq!(
        told("<mujoco model='a'/>"),
        "\
error: not an SDF world
 --> t.sdf:1:1
  |
1 | <mujoco model='a'/>
  | ^^^^^^^ expected <sdf>, found <mujoco>
  |
  = help: MJCF, the format of MuJoCo, is not read: Gazebo's SDF is, and world YAML
"
    );
    let wall = model("wall", "0 0 .5 0 0 0", "<box><size>4 .2 1</size></box>");
    let version = |v: &str| {
        let text = world_of(&wall).replace("1.9", v);
        read(&Source::new("t.sdf", text)).unwrap().warnings
    };
    assert_eq!((version("1.3"), version("1.12")), (Vec::new(), Vec::new()));
    assert_eq!(
        version("2.0"),
        ["`t.sdf` is of SDFormat 2.0, which is not known (1.3 to 1.12 are): read as 1.12"]
    );
    let macros = |inner: &str| {
        format!(
            "<sdf version='1.6' xmlns:xacro='http://www.ros.org/wiki/xacro'><world name='w'>{wall}{inner}</world></sdf>"
        )
    };
    let harmless = "<xacro:arg name='a' default='1'/><xacro:unless value='$(arg a)'><plugin name='p'/></xacro:unless>";
    assert!(read(&Source::new("t.sdf.xacro", macros(harmless))).is_ok(), "no solid depends on it");
    let matters = told(&macros(
        "<xacro:if value='$(arg a)'><include><uri>model://a</uri></include></xacro:if>",
    ));
    assert!(matters.starts_with("error: this file is written in macros (xacro)"), "{matters}");
    assert!(
        matters.contains("help: expand them first: `xacro my.sdf.xacro > my.sdf`"),
        "{matters}"
    );
}
