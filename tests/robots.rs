//! Robots that others described, from the outside: everything that is read for one is sealed, and shown for what it is.

use crate::sandbox::{Sandbox, TINY, repository};
use std::fs;

/// Makes a sandbox with `study` and the files of the tests' cart, below `ros/`.
fn with_cart(study: &str) -> Sandbox {
    let sandbox = Sandbox::pinned().with_study(study);
    for folder in ["urdf", "meshes"] {
        fs::create_dir_all(sandbox.path("ros/cart").join(folder)).unwrap();
    }
    for file in ["urdf/cart.urdf.xacro", "urdf/wheel.xacro", "urdf/cart.gazebo", "meshes/body.stl"]
    {
        let from = repository().join("tests/manifests/inputs/robots/cart").join(file);
        sandbox.write(&format!("ros/cart/{file}"), fs::read(from).unwrap());
    }
    sandbox
}

/// Xacro, what it includes, blocks in a file of their own and a mesh are inputs; what the manifest says besides is part of
/// it. So a bundle runs again where none of them is at hand.
#[test]
fn a_robot_with_all_that_it_names_is_sealed_and_runs_again_from_the_bundle() {
    let block = "robot:
  file: ros/cart/urdf/cart.urdf.xacro
  gazebo: [ros/cart/urdf/cart.gazebo]
  packages: {cart: ros/cart}
  arguments: {CART_TRACK: 0.32}
  lidar: {name: front, noise-sd-m: 0.01}
  drive: {max-linear-m-s: 0.6}
  height-m: 0.25";
    let study = TINY.replace("robot: robots/kobuki.urdf", block).replace("trials: 3", "trials: 1");
    let sandbox = with_cart(&study);
    let answer = sandbox.run(&["run", "tiny.yaml", "--only", "prior=none"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let bundle = answer.last_line().to_owned();
    fs::remove_dir_all(sandbox.path("ros")).unwrap();
    fs::remove_file(sandbox.path("tiny.yaml")).unwrap();
    let answer = sandbox.run(&["verify", &bundle, "--level", "5", "--format", "json"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let report: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!(report["reached"], 5, "{report:#}");
}

#[test]
fn show_tells_robots_from_worlds_and_follows_what_they_name() {
    let sandbox = with_cart(TINY);
    let answer = sandbox.run(&["show", "ros/cart/urdf/cart.urdf.xacro"]);
    assert_eq!(answer.code, 2, "{answer:?}");
    let says = "\
error: the robot has no drive
 --> ros/cart/urdf/cart.urdf.xacro:3:1
  |
3 | <robot name=\"cart\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">
  | ^^^^^^ expected a plugin that drives its wheels
  |
  = help: give it in the manifest: `robot: {file, drive: {kind: differential, wheel-separation-m: 0.3, \
wheel-diameter-m: 0.1}}` (numbers of its wheels' joints)
";
    assert!(answer.stderr.contains(says), "{}", answer.stderr);
    let plugin =
        "<gazebo><plugin name='d' filename='libgazebo_ros_diff_drive.so'/></gazebo></robot>";
    let text = fs::read_to_string(sandbox.path("ros/cart/urdf/cart.urdf.xacro")).unwrap();
    sandbox.write("ros/cart/urdf/driven.xacro", text.replace("</robot>", plugin));
    let words = ["show", "ros/cart/urdf/driven.xacro", "--argument", "CART_TRACK=0.5"];
    let answer = sandbox.run(&words);
    assert_eq!(answer.code, 0, "{answer:?}");
    let shown = "wheels 0.5 m apart and 0.1 m in diameter";
    assert!(answer.stdout.contains(shown), "{}", answer.stdout);
    assert!(answer.stdout.contains("footprint: 8 corners, 0.4 x 0.52 m"), "{}", answer.stdout);
}

/// What a file names by a path of some machine is read where whoever runs the study says so, and belongs to the bundle then.
#[test]
fn a_mesh_elsewhere_is_read_only_where_it_is_allowed() {
    let block = "robot: {file: ros/cart/urdf/cart.urdf.xacro, packages: {cart: ros/cart}, gazebo: [ros/cart/urdf/cart.gazebo],
  drive: {max-linear-m-s: 0.6}, height-m: 0.25}";
    let sandbox = with_cart(&TINY.replace("robot: robots/kobuki.urdf", block));
    let mesh = sandbox.path("opt/body.stl");
    fs::create_dir_all(sandbox.path("opt")).unwrap();
    fs::rename(sandbox.path("ros/cart/meshes/body.stl"), &mesh).unwrap();
    let urdf = "ros/cart/urdf/cart.urdf.xacro";
    let text = fs::read_to_string(sandbox.path(urdf)).unwrap();
    let uri = format!("file://{}", mesh.display());
    sandbox.write(urdf, text.replace("package://cart/meshes/body.stl", &uri));

    let label = "a path from the root of some machine is not followed without `--allow FOLDER`";
    for (allowed, told) in [("ros", true), ("opt", false)] {
        let answer = sandbox.run(&["check", "tiny.yaml", "--allow", allowed]);
        assert_eq!(answer.code, 0, "{answer:?}");
        assert_eq!(answer.stderr.contains(label), told, "--allow {allowed}: {}", answer.stderr);
    }

    let words = ["run", "tiny.yaml", "--trials", "1", "--only", "prior=none", "--allow", "opt"];
    let answer = sandbox.run(&words);
    assert_eq!(answer.code, 0, "{answer:?}");
    let bundle = answer.last_line().to_owned();
    fs::remove_dir_all(sandbox.path("opt")).unwrap();
    let answer = sandbox.run(&["verify", &bundle, "--level", "5", "--format", "json"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let report: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!(report["reached"], 5, "{report:#}");
}
