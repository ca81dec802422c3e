use super::*;
use crate::document::mutation::{edits, mutate};
use crate::geometry::Point;
use crate::robot::NoFiles;
use crate::world::sdf::NoModels;
use proptest::prelude::*;

const KOBUKI: &str = include_str!("../../../robots/kobuki.urdf");
const PIONEER: &str = include_str!("../../../robots/pioneer3at.urdf");
const BASIC: &str = include_str!("../../../worlds/basic.yaml");
const ENGINEERING: &str = include_str!("../../../worlds/engineering-building.yaml");
const MAP: &str = "image: m.pgm\nresolution: 0.1\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                   occupied_thresh: 0.65\nfree_thresh: 0.196\n";
const WORLD: &str = "<!-- a box --><sdf version='1.6'><world name='w'><model name='m'><static>1</static>\
                     <link name='l'><collision name='c'><geometry><box><size>1 2 3</size></box></geometry>\
                     </collision></link></model></world></sdf>";

/// Draws a file that names no other but, perhaps, an image.
fn draw(
    name: &str,
    bytes: &[u8],
    height: f64,
    models: &mut NoModels,
    fetch: &mut Fetch<'_>,
) -> Result<Drawing, Vec<Diagnostic>> {
    let nothing = BTreeMap::new();
    let mut robot = RobotFiles { packages: &nothing, arguments: &nothing, files: &mut NoFiles };
    super::draw(name, bytes, height, models, &mut robot, fetch)
}

fn drawn(name: &str, text: &str) -> Drawing {
    draw(name, text.as_bytes(), CUT_HEIGHT, &mut NoModels, &mut |_| {
        Ok(b"P2 2 2 255\n0 254 205 254".to_vec())
    })
    .unwrap()
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let nodes = document.descendants().filter(|node| node.has_tag_name("text"));
    nodes.filter_map(|node| node.text().map(str::to_owned)).collect()
}

#[test]
fn a_logical_camera_is_drawn_with_its_cone() {
    let robot = drawn("robots/pioneer3at.urdf", PIONEER);
    for line in [
        "logical camera: ids at (0, 0) m, heading 0.0 deg, 120.3 deg wide, 0.05 to 6 m, 10 Hz\n",
        "compass: compass, 10 Hz\n",
    ] {
        assert!(robot.text.contains(line), "{}", robot.text);
    }
    let said = texts(&robot.svg);
    for text in ["camera: 120.3° to 6 m, 10 Hz", "logical camera", "181 beams over 180.0°"] {
        assert!(said.iter().any(|t| t == text), "{text}: {said:?}");
    }
    let cones = |svg: &str| svg.matches("stroke=\"#d98324\"").count();
    assert_eq!(
        (cones(&robot.svg), cones(&drawn("robots/kobuki.urdf", KOBUKI).svg)),
        (4, 0),
        "cone and legend, on either sheet"
    );
}

#[test]
fn every_kind_is_told_by_its_content() {
    let robot = drawn("robots/kobuki.urdf", KOBUKI);
    assert!(
        robot.text.starts_with("robot: kobuki\nfootprint: circle of radius 0.178 m\n"),
        "{}",
        robot.text
    );
    assert!(
        robot.text.contains(
            "range scanner: laser at (0.1, 0) m, 0.1602 m above ground, heading 0.0 deg\n"
        )
    );
    let said = texts(&robot.svg);
    for text in
        ["kobuki", "⌀ 0.356 m", "0.23 m between wheels", "720 beams over 180.0°", "x (m)", "0.2 m"]
    {
        assert!(said.iter().any(|t| t == text), "{text}: {said:?}");
    }

    let world = drawn("worlds/basic.yaml", BASIC);
    assert!(
        world
            .text
            .starts_with("world: basic\nsize: 18.7 x 9.75 m, x -8.785 to 9.915, y -4.85 to 4.9\n"),
        "{}",
        world.text
    );
    assert!(
        world.text.contains("layer furniture: 17 solids, 17 of them at 0.1602 m\n"),
        "{}",
        world.text
    );
    let said = texts(&world.svg);
    for text in ["living-room", "start default", "walls", "furniture", "y (m)", "2 m"] {
        assert!(said.iter().any(|t| t == text), "{text}: {said:?}");
    }

    let gazebo = drawn("w.world", WORLD);
    assert!(gazebo.text.contains("layer walls: 1 solids, 1 of them"), "{}", gazebo.text);

    let map = drawn("m.yaml", MAP);
    assert!(
        map.text.ends_with(
            "occupied: 1 cells, 0.0 m2\nfree: 2 cells, 0.0 m2\nunknown: 1 cells, 0.0 m2\n"
        ),
        "{}",
        map.text
    );
    let png = map.png.unwrap();
    let again = map_server::read(
        &Source::new("m.yaml", MAP),
        "m.png",
        &png,
        map_server::Options::default(),
    );
    assert_eq!(grid_png(&again.unwrap()), png, "what is drawn is read again");
}

#[test]
fn a_world_with_tags_is_drawn_as_building_and_graph() {
    let world = drawn("worlds/engineering-building.yaml", ENGINEERING);
    let told: Vec<&str> = world.text.lines().take(9).collect();
    assert_eq!(
        told,
        [
            "world: engineering-building",
            "size: 62.4 x 41.8 m, x 0 to 62.4, y 0 to 41.8",
            "layer walls: 83 solids, 83 of them at 0.1602 m",
            "regions: 20 rooms, 4 corridors",
            "tags: 148",
            "graph: 49 vertices (26 corridor, 23 room), 49 edges (24 through doors), 1 loop",
            "start A: (10.5, 27.9) m, heading -90.0 deg, at C2a, 2 edges from the goal",
            "start B: (19.6, 22.9) m, heading 0.0 deg, at C1e, 5 edges from the goal",
            "start C: (37.8, 22.9) m, heading 0.0 deg, at C1i, 9 edges from the goal",
        ]
    );
    assert!(world.warnings.is_empty(), "{:?}", world.warnings);
    let said = texts(&world.svg);
    for text in [
        "engineering-building",
        "engineering-building: the graph",
        "exit through a door",
        "R: to the right",
        "L: to the left",
        "C1a",
        "R2b",
    ] {
        assert_eq!(said.iter().filter(|t| *t == text).count(), 1, "{text}: {said:?}");
    }
    // Once in each of the two drawings.
    for text in ["A", "B", "C", "R18", "goal"] {
        assert_eq!(said.iter().filter(|t| *t == text).count(), 2, "{text}: {said:?}");
    }
    // Every edge twice, to the right and back to the left; the legend has one more of the dashed.
    assert_eq!(world.svg.matches("stroke-dasharray=\"4 2.5\"").count(), 49 + 1);

    let broken = ENGINEERING.replacen("color: blue", "color: bleu", 1);
    let broken = drawn("b.yaml", &broken);
    assert!(
        broken.text.contains("\ngraph: none, the tags break the convention "),
        "{}",
        broken.text
    );
    let told: Vec<String> = broken.warnings.iter().map(|w| w.message.clone()).collect();
    assert!(told.iter().any(|w| w.contains("belongs to no vertex")), "{told:?}");
}

#[test]
fn of_a_mostly_unknown_map_the_known_part_is_drawn() {
    let mut pixels = vec!["205"; 100 * 100];
    pixels[50 * 100 + 20] = "254";
    let image = format!("P2 100 100 255\n{}", pixels.join(" "));
    let map = map_server::read(
        &Source::new("maps/m.yaml", MAP),
        "m.pgm",
        image.as_bytes(),
        map_server::Options::default(),
    );
    let svg = grid_svg("maps/m.yaml", &map.unwrap());
    let said = texts(&svg);
    assert_eq!(said.iter().filter(|text| text.starts_with("100 x 100 cells of 0.1 m")).count(), 1);
    assert!(said.iter().any(|text| text.ends_with("; its known part")), "{said:?}");
    assert!(
        svg.contains(r#"<rect width="21" height="21" "#)
            || svg.contains(r#"<rect width="22" height="21" "#),
        "{svg}"
    );
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let fault = |name: &str, bytes: &[u8]| {
        let faults = draw(name, bytes, CUT_HEIGHT, &mut NoModels, &mut |_| {
            Err(FetchError("no such file".to_owned()))
        })
        .unwrap_err();
        faults[0].render(false)
    };
    assert_eq!(
        fault("m.yaml", MAP.as_bytes()),
        "error: cannot read the image `m.pgm` of `m.yaml`: no such file\n"
    );
    assert!(fault("m.png", b"\x89PNG\xff").contains("of a map image name the YAML"));
}

#[test]
fn a_map_is_laid_over_the_world_that_it_is_to_fit() {
    let world = read_world("w.world", WORLD.as_bytes(), None, &mut NoModels).unwrap();
    // One occupied pixel, the upper left of four of 0.1 m: its middle is at (-0.95, 2.15) from the start.
    let over = |start: Point| Over { name: "m.yaml", bytes: MAP.as_bytes(), start };
    let mut image = |_: &str| Ok(b"P2 2 2 255\n0 254 254 254".to_vec());
    let [beside, on] = [Point::ZERO, Point::new(0.5, -1.1)]
        .map(|start| draw_over(&world, 0.1602, over(start), &mut image).unwrap());
    let near = "agreement: 1 of 1 occupied cells lie within 0.2 m of something solid\n";
    assert!(on.text.ends_with(near), "{}", on.text);
    let far = near.replacen('1', "0", 1);
    assert!(beside.text.ends_with(&far), "{}", beside.text);
    assert!(texts(&on.svg).iter().any(|t| t == "prior, farther off"));
    assert_eq!(on.svg.matches("M0 0h1v1h-1z").count(), 1, "the upper left cell alone");
}

#[test]
fn priors_are_derived_from_the_layers_asked_for() {
    let read = |layers: &[&str]| {
        let layers: Vec<String> = layers.iter().map(|l| (*l).to_owned()).collect();
        read_world("worlds/basic.yaml", BASIC.as_bytes(), Some(&layers), &mut NoModels).unwrap()
    };
    let occupied = |layers: &[&str], kind: Derived| {
        let drawing = draw_derived(&read(layers), kind, CUT_HEIGHT, 0.1).unwrap();
        assert!(drawing.png.is_some());
        let count = drawing.text.split("occupied: ").nth(1).and_then(|rest| rest.split(' ').next());
        (count.unwrap().to_owned(), drawing.text.clone())
    };
    let [plan, footprint] =
        [Derived::FloorPlan, Derived::Footprint].map(|kind| occupied(&[], kind).0);
    assert_ne!(occupied(&["furniture"], Derived::FloorPlan).0, plan);
    assert_eq!(occupied(&["furniture"], Derived::Footprint).0, footprint);
    let bounds = occupied(&[], Derived::BoundingBox).1;
    assert!(bounds.contains("bounding box of basic"), "{bounds}");
    let faults =
        read_world("w.world", WORLD.as_bytes(), Some(&["doors".to_owned()]), &mut NoModels)
            .unwrap_err();
    assert_eq!(
        faults[0].render(false),
        "error: `w.world` has no layer `doors`\n |\n = help: all of a Gazebo world is its layer `walls`\n"
    );
}

#[test]
fn what_lies_off_in_a_prior_is_told_apart_and_in_numbers() {
    let world = read_world("w.world", WORLD.as_bytes(), None, &mut NoModels).unwrap();
    let over = Over { name: "m.yaml", bytes: MAP.as_bytes(), start: Point::ZERO };
    let mut image = |_: &str| Ok(b"P2 2 2 255\n0 254 254 254".to_vec());
    let drawing = draw_over(&world, 0.1602, over, &mut image).unwrap();
    assert!(drawing.text.contains("laid: origin moved by (0, 0) m"), "{}", drawing.text);
    assert!(drawing.text.contains("distance to something solid: median "), "{}", drawing.text);
    let far = drawing.svg.split("M0 0h1v1h-1z").nth(1).unwrap();
    assert!(far.starts_with("\" fill=\"#b2182b\""), "{}", &far[..80]);
}

#[test]
fn a_robots_sensors_are_drawn_to_scale_too() {
    let robot = |text: &str| {
        texts(
            &draw("r.urdf", text.as_bytes(), CUT_HEIGHT, &mut NoModels, &mut |_| {
                Err(FetchError(String::new()))
            })
            .unwrap()
            .svg,
        )
    };
    let said = robot(KOBUKI);
    assert!(said.iter().any(|text| text == "How far it sees"), "{said:?}");
    assert!(said.iter().any(|text| text == "to scale with the body: scanner to 10 m"), "{said:?}");
    assert!(said.iter().any(|text| text == "x, ahead"), "{said:?}");
}

#[test]
fn a_topo_metric_map_is_drawn_alone_and_over_its_world() {
    let map = "reenact-topo-metric-map: 1\nname: m\nsource: ours\nnodes:\n  hall: {at-m: [0, 0]}\n  door: {at-m: [3, 4]}\n\
               edges: [[hall, door]]\n";
    let alone = draw("m.yaml", map.as_bytes(), CUT_HEIGHT, &mut NoModels, &mut |_| {
        Err(FetchError(String::new()))
    })
    .unwrap();
    assert!(alone.text.contains("2 places, 1 direct ways, 5 m together"), "{}", alone.text);
    assert!(
        ["hall", "door", "place"].iter().all(|name| texts(&alone.svg).iter().any(|t| t == name))
    );
    let world = read_world("w.world", WORLD.as_bytes(), None, &mut NoModels).unwrap();
    let over = Over { name: "m.yaml", bytes: map.as_bytes(), start: Point::ZERO };
    let over =
        draw_over(&world, CUT_HEIGHT, over, &mut |_| Err(FetchError(String::new()))).unwrap();
    assert!(over.text.contains("over the world: "), "{}", over.text);
}

proptest! {
    #[test]
    fn whatever_can_be_read_can_be_drawn(edits in edits()) {
        for text in [KOBUKI, BASIC, ENGINEERING, MAP, WORLD] {
            let bytes = mutate(text.as_bytes(), &edits);
            let image = |_: &str| Ok(b"P2 2 2 255\n0 254 205 254".to_vec());
            if let Ok(drawing) = draw("x", &bytes, CUT_HEIGHT, &mut NoModels, &mut { image }) {
                prop_assert!(roxmltree::Document::parse(&drawing.svg).is_ok());
            }
        }
    }
}
