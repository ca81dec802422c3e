//! Models in files of their own.

use super::*;

const CONFIG: &str = "<model><name>pillar</name><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>model.sdf</sdf><sdf version='2.0'>new.sdf</sdf></model>";

const PILLAR: &str = "<sdf version='1.6'><model name='pillar'><static>true</static><pose>9 9 0 0 0 0</pose><link name='l'>\
    <collision name='c'><pose>0 0 0.5 0 0 0</pose><geometry><cylinder><radius>0.3</radius><length>1</length></cylinder></geometry></collision>\
    </link></model></sdf>";

fn world_of(inner: &str) -> Source {
    Source::new(
        "worlds/hall.world",
        format!("<sdf version='1.9'><world name='hall'>\n{inner}\n</world></sdf>"),
    )
}

fn include(uri: &str, more: &str) -> String {
    format!("<include><uri>{uri}</uri>{more}</include>")
}

fn circles(world: &World) -> Vec<(String, [f64; 2])> {
    let round = |v: f64| (v * 1000.0).round() / 1000.0;
    let middle = |s: &Solid| {
        let bounds = s.body.slice(0.5)[0].bounds();
        let middle = (bounds.min + bounds.max) * 0.5;
        (s.name.clone(), [round(middle.x), round(middle.y)])
    };
    world.solids.iter().map(middle).collect()
}

fn shelf() -> Shelf {
    Shelf::of(&[("m/pillar/model.config", CONFIG), ("m/pillar/model.sdf", PILLAR)])
}

#[test]
fn an_included_model_stands_by_its_own_name_and_pose_or_the_ones_given() {
    let inner = include("model://ground_plane", "")
        + &include("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane", "")
        + &include("https://fuel.ignitionrobotics.org/1.0/openrobotics/models/sun/2", "")
        + &include("model://pillar", "<name>p1</name><pose>2 0 0 0 0 0</pose>")
        + &include("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Pillar", "")
        + &include(
            "model://pillar",
            "<name>p3</name><pose>0 0 0 0 0 0</pose><placement_frame>l</placement_frame><static>0</static>",
        );
    let world = read_with(&world_of(&inner), &mut shelf()).unwrap();
    assert_eq!(
        circles(&world),
        [
            ("p1/l/c".to_owned(), [2.0, 0.0]),
            ("pillar/l/c".to_owned(), [9.0, 9.0]),
            ("p3/l/c".to_owned(), [0.0, 0.0]),
        ]
    );
    assert_eq!(
        world.warnings,
        ["worlds/hall.world:2:407: model `p3` can move in Gazebo and stands still here"]
    );
}

#[test]
fn includes_nest_merge_and_are_placed_by_the_state() {
    let pair = "<sdf version='1.9'><model name='pair'><static>1</static>\
        <include><uri>model://pillar</uri><name>left</name><pose>0 1 0 0 0 0</pose></include>\
        <include merge='true'><uri>model://pillar</uri><pose>0 -1 0 0 0 0</pose></include>\
        <model name='third'><pose relative_to='l'>0 -1 0 0 0 0</pose><link name='k'><collision name='c'><pose>0 0 0.5 0 0 0</pose>\
        <geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model></model></sdf>";
    let mut shelf = shelf();
    shelf.files.insert("m/pair/model.sdf".to_owned(), pair.as_bytes().to_vec());
    let inner = include("model://pair", "<pose>5 0 0 0 0 0</pose>")
        + &include("model://pair", "<name>moved</name>");
    let state = "<state world_name='hall'><model name='moved'><pose>0 0 0 0 0 0</pose><scale>2 2 1</scale>\
        <link name='left::l'><pose>7 7 0 0 0 0</pose></link></model></state>";
    let world = read_with(&world_of(&(inner + state)), &mut shelf).unwrap();
    assert_eq!(
        circles(&world),
        [
            ("pair/left/l/c".to_owned(), [5.0, 1.0]),
            ("pair/l/c".to_owned(), [5.0, -1.0]),
            ("pair/third/k/c".to_owned(), [5.0, -2.0]),
            ("moved/left/l/c".to_owned(), [7.0, 7.0]),
            ("moved/l/c".to_owned(), [0.0, -1.0]),
            ("moved/third/k/c".to_owned(), [0.0, -2.0]),
        ]
    );
    let scaled = world.solids[4].body.slice(0.5)[0].bounds();
    assert!((scaled.width() - 1.2).abs() < 1e-9, "merged links are the model's own: {scaled:?}");
}

#[test]
fn a_model_that_is_not_found_says_where_it_was_looked_for_and_which_key_helps() {
    let inner = include("model://pillar", "")
        + &include("model://cafe", "")
        + &include("model://cafe", "<name>b</name>");
    let world = read_with(&world_of(&inner), &mut shelf()).unwrap();
    assert_eq!(
        world.warnings,
        [
            "worlds/hall.world:2:45: 2 times <include> (`model://cafe`): none of that name in `m`; name the folder of each (`models: {cafe: FOLDER, ...}`) or one that holds them (`model-path: [FOLDER]`): 2 are missing"
        ]
    );
    assert_eq!(world.missing(), 2);
    let nothing = read_with(&world_of(&include("model://cafe", "")), &mut NoModels).unwrap_err();
    let told = nothing.iter().find(|f| f.severity == Severity::Error).unwrap().render(false);
    assert_eq!(
        told,
        "\
error: the world has nothing solid that can be read
 --> worlds/hall.world:1:20
  |
1 | <sdf version='1.9'><world name='hall'>
  |                    ^^^^^^ expected a model with collisions
  |
  = help: <include> of `model://cafe`: no folder of models is given; name its own folder (`models: {cafe: FOLDER}`) or one that holds it (`model-path: [FOLDER]`): the model is missing
"
    );
}

#[test]
fn a_download_of_fuel_lies_in_a_folder_of_its_version() {
    let newer = PILLAR.replace("<radius>0.3", "<radius>0.4");
    let mut shelf =
        Shelf::of(&[("m/big_pillar/1/model.sdf", PILLAR), ("m/big_pillar/3/model.sdf", &newer)]);
    let inner = include("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Big Pillar", "");
    let world = read_with(&world_of(&inner), &mut shelf).unwrap();
    let radius = world.solids[0].body.slice(0.5)[0].bounds().width() / 2.0;
    assert!((radius - 0.4).abs() < 1e-9, "the newest: {radius}");
}

#[test]
fn models_that_are_not_wanted_are_left_out_with_what_they_lack() {
    let inner = include("model://pillar", "")
        + &include("model://cafe", "")
        + &include("model://pillar", "<name>b</name>");
    let mut shelf = shelf();
    shelf.without = vec!["cafe".to_owned(), "b".to_owned()];
    let world = read_with(&world_of(&inner), &mut shelf).unwrap();
    assert_eq!((world.solids.len(), world.missing()), (1, 0));
    assert_eq!(shelf.asked, ["pillar", "cafe", "b"]);
}

#[test]
fn files_that_include_each_other_are_told() {
    let of = |other: &str| {
        format!(
            "<sdf version='1.9'><model name='a'>{}</model></sdf>",
            include(&format!("model://{other}"), "")
        )
    };
    let (a, b) = (of("b"), of("a"));
    let mut shelf = Shelf::of(&[("m/a/model.sdf", &a), ("m/b/model.sdf", &b)]);
    let faults = read_with(&world_of(&include("model://a", "")), &mut shelf).unwrap_err();
    let told: Vec<String> = faults.iter().map(|f| f.render(false)).collect();
    assert!(
        told.iter().any(|t| t.starts_with(
            "error: files that include each other: `m/a/model.sdf` includes `m/b/model.sdf` includes `m/a/model.sdf`\n --> m/b/model.sdf:1:36"
        )),
        "{told:#?}"
    );
}

/// Checks that models which include one another tenfold, level by level, cost no more than the limit.
#[test]
fn what_multiplies_is_refused() {
    let mut files: Vec<(String, String)> = vec![("m/n0/model.sdf".to_owned(), PILLAR.to_owned())];
    for level in 1..40 {
        let many = include(&format!("model://n{}", level - 1), "").repeat(10);
        let text = format!("<sdf version='1.9'><model name='n'>{many}</model></sdf>");
        files.push((format!("m/n{level}/model.sdf"), text));
    }
    // Merged, and with a frame that none of them has.
    for level in 1..30 {
        let one = format!(
            "<include merge='true'><uri>model://{}</uri></include>",
            if level == 1 { "n0".to_owned() } else { format!("k{}", level - 1) }
        );
        let more = "<link name='x'><pose relative_to='nowhere'>0 0 0 0 0 0</pose></link>";
        let text = format!(
            "<sdf version='1.9'><model name='k'>{}{}</model></sdf>",
            one.repeat(10),
            if level == 29 { more } else { "" }
        );
        files.push((format!("m/k{level}/model.sdf"), text));
    }
    let told = |level: &str| {
        let files: Vec<(&str, &str)> =
            files.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
        let world = world_of(&include(&format!("model://{level}"), ""));
        let faults = read_with(&world, &mut Shelf::of(&files)).err().unwrap();
        faults.iter().find(|f| f.severity == Severity::Error).unwrap().render(false)
    };
    let wide = told("n9");
    assert!(wide.starts_with("error: the world is too large"), "{wide}");
    assert!(wide.contains("at most 1000000 models, links and collisions"), "{wide}");
    let merged = told("k8");
    assert!(merged.starts_with("error: the world is too large"), "{merged}");
    let lost = told("k29");
    assert!(lost.starts_with("error: pose relative to the unknown frame `nowhere`"), "{lost}");
    let deep = told("n39");
    assert!(deep.starts_with("error: models nested too deeply"), "{deep}");
}

proptest! {
    #[test]
    fn damaged_models_never_panic(edits in edits(), kind in 0..3_usize) {
        let pair = "<sdf version='1.9'><model name='pair' placement_frame='k'><include merge='true'><uri>model://pillar</uri>\
            <pose relative_to='k'>0 -1 0 0 0 0</pose></include><frame name='k' attached_to='l'/><include><uri>model://pair</uri></include></model></sdf>";
        let mut files = [CONFIG, PILLAR, pair].map(str::to_owned);
        files[kind] = String::from_utf8_lossy(&mutate(files[kind].as_bytes(), &edits)).into_owned();
        let mut shelf = Shelf::of(&[
            ("m/pillar/model.config", &files[0]), ("m/pillar/model.sdf", &files[1]), ("m/pair/model.sdf", &files[2]),
        ]);
        let inner = include("model://pillar", "") + &include("model://pair", "<placement_frame>l</placement_frame>");
        if let Ok(world) = read_with(&world_of(&inner), &mut shelf) {
            let _ = (world.slice(0.16), world.contact(0.0, 0.4), world.meaning());
        }
    }
}
