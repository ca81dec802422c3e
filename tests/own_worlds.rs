//! Worlds of models in files of their own, by the program as its users run it: sealed, verified and run again from what was
//! sealed; with floors that robots stand on, and models left out.

use crate::sandbox::{Answer, Sandbox};
use std::fs;

const STUDY: &str = "
reenact: 1
name: hall
title: A hall of included models
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 1
robot: robots/kobuki.urdf
world: {file: worlds/hall.world, model-path: [shelf/models]}
start: {x-m: -3, y-m: 2, heading-deg: 0}
parameters:
  mission: {time-limit-s: 20}
";

const HALL: &str = "<sdf version='1.9'><world name='hall'>
<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun</uri></include>
<include><uri>model://walls</uri></include>
<include><uri>model://pillar</uri><name>p1</name><pose>2 0 0 0 0 0</pose></include>
<include><uri>model://pillar</uri><name>p2</name><pose>-2 1 0 0 0 0</pose></include>
</world></sdf>";

const WALLS: &str = "<sdf version='1.6'><model name='walls'><static>1</static>
<link name='floor'><collision name='c'><geometry><box><size>10 8 0.1</size></box></geometry></collision></link>
<link name='l'>
<collision name='n'><pose>0 4 .5 0 0 0</pose><geometry><box><size>10 .2 1</size></box></geometry></collision>
<collision name='s'><pose>0 -4 .5 0 0 0</pose><geometry><box><size>10 .2 1</size></box></geometry></collision>
<collision name='e'><pose>5 0 .5 0 0 0</pose><geometry><box><size>.2 8 1</size></box></geometry></collision>
<collision name='w'><pose>-5 0 .5 0 0 0</pose><geometry><box><size>.2 8 1</size></box></geometry></collision>
</link></model></sdf>";

const PILLAR: &str =
    "<sdf version='1.6'><model name='pillar'><static>1</static><link name='l'><collision name='c'>
<geometry><mesh><uri>meshes/pillar.obj</uri></mesh></geometry></collision></link></model></sdf>";

const CONFIG: &str = "<model><name>Pillar</name><sdf version='1.6'>pillar.sdf</sdf></model>";

const MESH: &str =
    "v -0.3 -0.3 0\nv 0.3 -0.3 0\nv 0 0.3 0\nv 0 0 1\ng p\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn hall(study: &str) -> Sandbox {
    let at = Sandbox::pinned().with_files(&["robots/kobuki.urdf"]);
    for folder in ["worlds", "shelf/models/walls", "shelf/models/pillar/meshes"] {
        fs::create_dir_all(at.path(folder)).unwrap();
    }
    at.write("hall.yaml", study);
    at.write("worlds/hall.world", HALL);
    at.write("shelf/models/walls/model.sdf", WALLS);
    at.write("shelf/models/pillar/model.config", CONFIG);
    at.write("shelf/models/pillar/pillar.sdf", PILLAR);
    at.write("shelf/models/pillar/meshes/pillar.obj", MESH);
    at
}

fn ends(answer: &Answer, code: i32) -> &str {
    assert_eq!(answer.code, code, "{}{}", answer.stdout, answer.stderr);
    answer.last_line()
}

#[test]
fn a_world_of_included_models_is_sealed_verified_and_run_again_from_what_was_sealed() {
    let at = hall(STUDY);
    let run = at.run(&["run", "hall.yaml"]);
    let bundle = ends(&run, 0).to_owned();
    assert!(
        run.stderr.contains("`walls/floor/c` lies flat on the ground: it is floor"),
        "{}",
        run.stderr
    );
    assert!(!run.stderr.contains("incomplete"), "{}", run.stderr);
    // Nothing is left but the bundle.
    for folder in ["shelf", "worlds", "robots"] {
        fs::remove_dir_all(at.path(folder)).unwrap();
    }
    let verified = at.run(&["verify", &bundle, "--level", "5"]);
    assert_eq!(
        ends(&verified, 0),
        "reached level 5 (full) of level 5 (full): the bundle is what it says"
    );
}

#[test]
fn a_model_is_left_out_by_name_and_a_slip_is_told() {
    let at = hall(STUDY);
    let without = |names: &str| {
        let set = format!("world.without=[{names}]");
        at.run(&["check", "hall.yaml", "--set", &set])
    };
    let in_pillar = at.run(&["check", "hall.yaml", "--set", "start={x-m: 2, y-m: 0}"]);
    assert_eq!(in_pillar.code, 2, "{in_pillar:?}");
    assert!(
        in_pillar
            .stderr
            .contains("the robot starts inside something solid, `p1/l/c`, at (2.00, 0.00) m"),
        "{}",
        in_pillar.stderr
    );
    assert_eq!(without("p1").code, 0);
    let slip = without("p3");
    assert_eq!(slip.code, 2);
    assert!(slip.stderr.contains("error: unknown model `p3`"), "{}", slip.stderr);
    assert!(slip.stderr.contains("did you mean `p1`? (known: p1, p2, walls)"), "{}", slip.stderr);
}

#[test]
fn a_world_that_lacks_things_says_so_on_its_drawing() {
    let at = hall(STUDY);
    let show = |words: &[&str]| {
        let all: Vec<&str> =
            ["show", "worlds/hall.world", "-o", "hall.svg"].iter().chain(words).copied().collect();
        let answer = at.run(&all);
        ends(&answer, 0);
        at.read("hall.svg")
    };
    let whole = show(&["--model-path", "shelf/models"]);
    assert!(!whole.contains("incomplete"));
    let lacking = show(&["--models", "walls=shelf/models/walls"]);
    assert!(lacking.contains("incomplete: 2 things are missing"), "{lacking}");
}
