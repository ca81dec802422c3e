//! What people bring: maps, bags and files that are only there in kind, taken to a bundle that is re-executed from itself.

use crate::sandbox::Sandbox;

/// Two rooms of 3 x 2.4 m in cells of 0.1 m with a door of 0.8 m, as a mapping program saves them: grey around, and no wall
/// where the robot looked out of a window.
fn scanned() -> (String, Vec<u8>) {
    let (width, height) = (72_usize, 36_usize);
    let mut image = format!("P5\n# CREATOR: somebody\n{width} {height}\n255\n").into_bytes();
    for y in (0..height).rev() {
        for x in 0..width {
            let inside = (4..68).contains(&x) && (4..32).contains(&y);
            let edge = inside && (x == 4 || x == 67 || y == 4 || y == 31);
            let between = inside && x == 35 && !(14..22).contains(&y);
            let window = x == 4 && (10..14).contains(&y);
            image.push(match (inside, (edge || between) && !window) {
                (_, true) => 0,
                (true, false) => 254,
                (false, false) => 205,
            });
        }
    }
    let descriptor = "\u{feff}image: rooms.pgm\nresolution: 0.1\norigin: [-2.0, -1.8, 0.0]\nnegate: false\noccupied_thresh: 0.65\n\
                      free_thresh: 0.196\nmap_type: occupancy\n";
    (descriptor.to_owned(), image)
}

/// The warning of the key that means nothing.
const WARNED: &str = "\
warning: `map_type` means nothing to a map
 --> rooms.yaml:7:1
  |
7 | map_type: occupancy
  | ^^^^^^^^ left out, as in ROS
  |
  = help: known: image, resolution, origin, occupied_thresh, free_thresh, negate, mode

";

fn desk() -> Sandbox {
    let desk = Sandbox::pinned();
    let (descriptor, image) = scanned();
    desk.write("rooms.yaml", descriptor);
    desk.write("rooms.pgm", image);
    desk
}

#[test]
fn a_map_is_a_world_and_the_map_made_in_it_a_prior() {
    let desk = desk();
    let begun = desk.run(&["init", "two", "--world", "rooms.yaml"]);
    assert_eq!((begun.stdout.as_str(), begun.code), ("reenact run two/two.yaml\n", 0), "{begun:?}");
    assert_eq!(begun.stderr.trim_end(), WARNED.trim_end());
    let run = desk.run(&["run", "two/two.yaml", "--trials", "1"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stdout.contains("2 trials: 2 explored; "), "{}", run.stdout);
    let bundle = run.last_line().to_owned();
    let verified = desk.run(&["verify", "--level", "5", &bundle]);
    assert!(verified.stdout.contains("reached level 5 (full) of level 5"), "{verified:?}");

    // Of what the robot made: a map, and a bag that holds it.
    let words = ["replay", &bundle, "none/0", "--map", "made.yaml", "--mcap", "made.mcap"];
    assert_eq!(desk.run(&words).code, 0);
    let shown = desk.run(&["show", "made.yaml", "-o", "made.svg"]);
    assert!(shown.stdout.contains("free"), "{shown:?}");
    desk.edit("two/two.yaml", "prior: [none, floor-plan]", "prior: [made, bagged]");
    desk.edit(
        "two/two.yaml",
        "  floor-plan: {floor-plan-of: world}\n",
        "  made: {map: ../made.yaml}\n  bagged: {map: ../made.mcap, frame: start}\n",
    );
    let labels = "  prior: {values: {none: no prior, floor-plan: floor plan}}\n";
    desk.edit("two/two.yaml", labels, "  prior: {values: {bagged: from a bag}}\n");
    desk.edit("two/two.yaml", "by: prior, baseline: none", "by: prior");
    desk.edit("two/two.yaml", "where: {prior: none}", "where: {prior: made}");
    desk.edit("two/two.yaml", "where: {prior: floor-plan}", "where: {prior: bagged}");
    let again = desk.run(&["run", "two/two.yaml", "--trials", "1"]);
    assert_eq!(again.code, 0, "{again:?}");
    let verified = desk.run(&["verify", "--level", "5", again.last_line()]);
    assert!(verified.stdout.contains("reached level 5 (full) of level 5"), "{verified:?}");
}

#[test]
fn what_is_imported_is_the_same_world() {
    let desk = desk();
    let told = desk.run(&["import", "rooms.yaml", "-o", "rooms.world.yaml"]);
    assert_eq!(told.code, 0, "{told:?}");
    let solids = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|l| l.starts_with("size:") || l.starts_with("layer "));
        lines.map(str::to_owned).collect()
    };
    let words = ["show", "rooms.world.yaml", "--height", "0.2", "-o", "rooms.svg"];
    let again = desk.run(&words);
    assert_eq!(solids(&told.stdout), solids(&again.stdout), "{told:?}\n{again:?}");
    assert!(solids(&again.stdout)[0].starts_with("size: 6.5 x "), "{again:?}");
    assert!(solids(&again.stdout)[1].starts_with("layer walls: "), "{again:?}");
    let twice = desk.run(&["import", "rooms.yaml", "-o", "rooms.world.yaml"]);
    assert_eq!(
        (twice.code, twice.stderr.as_str()),
        (
            2,
            "error: `rooms.world.yaml` exists already; name another file with `-o`, or write over it with `--force`\n"
        )
    );
}

#[test]
fn a_study_of_no_files_is_not_begun() {
    let desk = desk();
    let refused = desk.run(&["init", "lost", "--robot", "nobody.urdf"]);
    assert_eq!((refused.code, refused.stdout.as_str()), (2, ""));
    assert_eq!(
        refused.stderr,
        "\
error: cannot read `../nobody.urdf`
 --> lost/lost.yaml:7:8
  |
7 | robot: ../nobody.urdf
  |        ^^^^^^^^^^^^^^ no such file
  |
  = help: paths are relative to the file they are written in

error: 1 error
"
    );
    assert!(!desk.path("lost").exists(), "another attempt can have the name");
}

#[test]
fn a_run_speaks_to_ci() {
    let desk = Sandbox::pinned().with_demo();
    let words = ["run", "demo/demo.yaml", "nowhere.yaml", "--trials", "1", "--format", "junit"];
    let run = desk.run(&words);
    assert_eq!(
        (run.code, run.stderr.as_str()),
        (2, "error: cannot read `nowhere.yaml`: no such file\n")
    );
    let document = roxmltree::Document::parse(&run.stdout).unwrap();
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("errors")), ("testsuites", Some("1")));
    let cases: Vec<String> = document
        .descendants()
        .filter(|node| node.has_tag_name("testcase"))
        .map(|case| {
            let came = case.children().find(roxmltree::Node::is_element);
            let came = came.map_or("passed", |node| node.tag_name().name());
            format!("{}: {came}", case.attribute("name").unwrap_or_default())
        })
        .collect();
    assert_eq!(
        cases,
        ["1 trial of no prior: passed", "1 trial of floor plan: passed", "manifest: error"]
    );
    let power = desk.run(&["plan", "demo/demo.yaml", "--power", "--format", "junit"]);
    assert!(
        power.code == 2 && power.stderr.contains("[possible values: human, json]"),
        "{power:?}"
    );
}

#[test]
fn room_is_made_in_the_store() {
    let desk = Sandbox::pinned().with_demo();
    desk.done(&["run", "demo/demo.yaml", "--trials", "1"]);
    assert_eq!(
        desk.done(&["cache", "prune", "--older-than", "1"]),
        "removed 0 files of trials, 0 bytes\n"
    );
    let pruned = desk.done(&["cache", "prune", "--all"]);
    assert!(pruned.starts_with("removed 1 file of trials, "), "{pruned}");
    assert_eq!(desk.done(&["cache", "size"]), "0 trials, 0 bytes\n");
    assert_eq!(desk.run(&["cache", "prune"]).code, 2);
}
