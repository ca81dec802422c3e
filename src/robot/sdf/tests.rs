use crate::document::Source;
use crate::document::mutation::{edits, mutate};
use crate::geometry::Outline;
use crate::robot::{DriveKind, urdf};
use proptest::prelude::*;

/// A model with frames, a nested model, and wheels whose plugin leaves their distance out.
const CRATE: &str = r#"<sdf version="1.8">
  <model name="crate">
    <pose>5 6 7 0 0 1</pose>
    <frame name="deck" attached_to="base"><pose>0 0 0.3 0 0 0</pose></frame>
    <link name="base">
      <pose>0 0 0.1 0 0 0</pose>
      <inertial><mass>12</mass></inertial>
      <collision name="c"><pose>0.05 0 0.1 0 0 0</pose><geometry><box><size>0.5 0.3 0.2</size></box></geometry></collision>
    </link>
    <link name="scanner">
      <pose relative_to="deck">0.2 0 0 0 0 90</pose>
      <sensor name="lidar" type="gpu_lidar">
        <pose>0 0 0.05 0 0 0</pose>
        <update_rate>20</update_rate>
        <lidar><scan><horizontal><samples>271</samples><min_angle>-2.35</min_angle><max_angle>2.35</max_angle></horizontal></scan>
          <range><min>0.05</min><max>12</max></range><noise type="gaussian"><mean>0</mean><stddev>0.01</stddev></noise></lidar>
      </sensor>
    </link>
    <link name="left"><pose>0 0.2 0.06 -1.5707963267948966 0 0</pose>
      <collision name="c"><geometry><cylinder><radius>0.06</radius><length>0.03</length></cylinder></geometry></collision></link>
    <link name="right"><pose>0 -0.2 0.06 -1.5707963267948966 0 0</pose></link>
    <joint name="left_joint" type="revolute"><parent>base</parent><child>left</child></joint>
    <joint name="right_joint" type="revolute"><parent>base</parent><child>right</child></joint>
    <model name="mast">
      <pose>0 0 0.4 0 0 0</pose>
      <link name="pole"><inertial><mass>1</mass></inertial>
        <collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision></link>
    </model>
    <plugin filename="libgz-sim8-diff-drive-system.so" name="gz::sim::systems::DiffDrive">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint><max_linear_velocity>0.5</max_linear_velocity>
    </plugin>
    <plugin filename="gz-sim-sensors-system" name="gz::sim::systems::Sensors"/>
  </model>
</sdf>"#;

#[test]
fn a_model_is_read_in_its_own_frame_on_its_lowest_point() {
    let text = CRATE.replace("0 0 90</pose>", "0 0 1.5707963267948966</pose>");
    let (robot, warnings) = urdf::read(&Source::new("crate.sdf", text)).unwrap();
    let told: Vec<&str> = warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "the drive does not say the wheels' separation",
            "the drive does not say the wheels' diameter"
        ]
    );
    assert_eq!(robot.name, "crate");
    assert_eq!(robot.drive.kind, DriveKind::Differential);
    assert_eq!((robot.drive.wheel_separation, robot.drive.wheel_diameter), (0.4, 0.12));
    assert_eq!(robot.drive.max_linear, Some(0.5));
    assert!((robot.mass - 13.0).abs() < 1e-12);
    let Outline::Polygon(_) = &robot.footprint else { panic!("{:?}", robot.footprint) };
    let bounds = robot.footprint.bounds();
    assert!((bounds.max.x - 0.3).abs() < 1e-9 && (bounds.min.x + 0.2).abs() < 1e-9);
    assert!((bounds.height() - 0.365).abs() < 1e-6, "{}", bounds.height());
    assert!(robot.body_z[0].abs() < 1e-9 && (robot.body_z[1] - 0.45).abs() < 1e-9);
    let lidar = robot.lidar.unwrap();
    assert!((lidar.height - 0.45).abs() < 1e-9, "{}", lidar.height);
    assert!((lidar.mount.x - 0.2).abs() < 1e-9);
    assert!((lidar.mount.heading - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    assert_eq!((lidar.beams, lidar.noise_sd, lidar.rate_hz), (271, 0.01, 20.0));
}

#[test]
fn faults_say_where_and_what_to_do() {
    let faults = |text: &str| -> String {
        let faults = urdf::read(&Source::new("crate.sdf", text)).unwrap_err();
        faults.iter().map(|fault| fault.render(false)).collect()
    };
    assert_eq!(
        faults("<sdf version='1.6'>\n  <world name='hall'/>\n</sdf>"),
        "\
error: the SDF file holds no robot
 --> crate.sdf:1:1
  |
1 | <sdf version='1.6'>
  | ^^^^ expected a <model>
  |
  = help: it holds a <world>: name it under `world`
"
    );
    for (from, to, said) in [
        ("relative_to=\"deck\"", "relative_to=\"dekc\"", "relative to an unknown frame `dekc`"),
        ("attached_to=\"base\"", "attached_to=\"deck\"", "is relative to itself"),
        ("<size>0.5 0.3 0.2</size>", "<size>0.5 -1 0.2</size>", "box size out of range"),
        ("<size>0.5 0.3 0.2</size>", "", "<box> has no <size>"),
        ("<radius>0.06</radius>", "<radius>-1</radius>", "cylinder radius out of range"),
        ("<mass>12</mass>", "<mass>-12</mass>", "link `base` has a negative mass"),
        ("name=\"right\"><pose>", "name=\"left\"><pose>", "duplicate link `left`"),
        ("</model>\n</sdf>", "</model><model name='b'/></sdf>", "second <model>"),
        ("gz::sim::systems::DiffDrive", "x", "the drive does not say"),
    ] {
        assert!(CRATE.contains(from), "{from}");
        let text = CRATE.replacen(from, to, 1);
        let found = match urdf::read(&Source::new("crate.sdf", text)) {
            Ok((_, faults)) | Err(faults) => faults,
        };
        let found: String = found.iter().map(|fault| fault.render(false)).collect();
        assert!(found.contains(said), "{said}: {found}");
    }
}

#[test]
fn a_collision_stands_where_its_frame_is() {
    let from = "<collision name=\"c\"><pose>0.05 0 0.1 0 0 0</pose>";
    let read = |frame: &str| {
        let to = format!("<collision name='c'><pose relative_to='{frame}'>0.05 0 0.1 0 0 0</pose>");
        urdf::read(&Source::new("c.sdf", CRATE.replacen(from, &to, 1)))
    };
    let (robot, _) = read("scanner").unwrap();
    let bounds = robot.footprint.bounds();
    // The scanner's frame is 0.2 m ahead, and its heading of 90 rad turns the box.
    assert!((f64::midpoint(bounds.min.x, bounds.max.x) - 0.2).abs() < 0.06, "{bounds:?}");
    let faults = read("sacnner").unwrap_err();
    assert!(
        faults.iter().any(|f| {
            f.message == "a collision on `base` is relative to an unknown frame `sacnner`"
        }),
        "{faults:?}"
    );
}

#[test]
fn a_sensor_s_pose_is_read_as_any_other() {
    let from = "<pose>0 0 0.05 0 0 0</pose>";
    let link = "<pose relative_to=\"deck\">0.2 0 0 0 0 90</pose>";
    let read = |pose: &str| {
        let text = CRATE.replacen(from, pose, 1).replacen(link, "<pose>0.2 0 0.3 0 0 0</pose>", 1);
        urdf::read(&Source::new("c.sdf", text))
    };
    let heading = |pose: &str| {
        let (robot, _) = read(pose).unwrap();
        robot.lidar.unwrap().mount.heading.to_degrees()
    };
    assert!((heading("<pose degrees='true'>0 0 0.05 0 0 90</pose>") - 90.0).abs() < 1e-9);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let quaternion = format!("<pose rotation_format='quat_xyzw'>0 0 0 0 0 {half} {half}</pose>");
    assert!((heading(&quaternion) - 90.0).abs() < 1e-9);
    let faults = read("<pose relative_to='deck'>0 0 0.05 0 0 0</pose>").unwrap_err();
    let said = "the pose of range scanner `lidar` is relative to `deck`";
    assert!(faults.iter().any(|fault| fault.message == said), "{faults:?}");
}

#[test]
fn quaternions_and_degrees_are_rotations() {
    let heading = |pose: &str| {
        let from = "<pose relative_to=\"deck\">0.2 0 0 0 0 90</pose>";
        let (robot, _) = urdf::read(&Source::new("c.sdf", CRATE.replacen(from, pose, 1))).unwrap();
        robot.lidar.unwrap().mount.heading.to_degrees()
    };
    assert!((heading("<pose degrees='true'>0 0 0 0 0 90</pose>") - 90.0).abs() < 1e-9);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let pose = format!("<pose rotation_format='quat_xyzw'>0 0 0 0 0 {half} {half}</pose>");
    assert!((heading(&pose) - 90.0).abs() < 1e-9);
}

proptest! {
    #[test]
    fn damaged_models_never_panic(edits in edits()) {
        let text = String::from_utf8_lossy(&mutate(CRATE.as_bytes(), &edits)).into_owned();
        if let Err(faults) = urdf::read(&Source::new("c.sdf", text)) {
            prop_assert!(!faults.is_empty());
        }
    }
}
