use super::*;
use crate::document::Severity;
use crate::document::mutation::{edits, mutate};
use crate::geometry::Outline;
use crate::robot::DriveKind;
use proptest::prelude::*;

const KOBUKI: &str = include_str!("../../../robots/kobuki.urdf");
const PIONEER: &str = include_str!("../../../robots/pioneer3at.urdf");

fn faults(text: &str) -> Vec<String> {
    let source = Source::new("r.urdf", text);
    let list = match read(&source) {
        Ok((_, warnings)) => warnings,
        Err(faults) => faults,
    };
    list.iter().map(|fault| fault.render(false)).collect()
}

/// Returns the Kobuki with one piece of its text replaced.
fn changed(from: &str, to: &str) -> Vec<String> {
    assert!(KOBUKI.contains(from), "{from}");
    faults(&KOBUKI.replacen(from, to, 1))
}

/// Returns the Pioneer with one piece of its text replaced.
fn changed_pioneer(from: &str, to: &str) -> Vec<String> {
    assert!(PIONEER.contains(from), "{from}");
    faults(&PIONEER.replacen(from, to, 1))
}

#[test]
fn the_kobuki_is_what_the_study_published() {
    let (robot, warnings) = read(&Source::new("robots/kobuki.urdf", KOBUKI)).unwrap();
    assert_eq!(warnings, []);
    assert_eq!(
        robot.footprint,
        Outline::Circle { center: crate::geometry::Point::ZERO, radius: 0.178 }
    );
    assert!(robot.body_z[0].abs() < 1e-9 && (robot.body_z[1] - 0.43).abs() < 1e-9);
    assert!((robot.mass - 2.45).abs() < 1e-12);
    assert_eq!(robot.drive.kind, DriveKind::Differential);
    assert_eq!((robot.drive.wheel_separation, robot.drive.wheel_diameter), (0.23, 0.07));
    assert_eq!((robot.drive.max_linear, robot.drive.max_angular), (None, None));
    let lidar = robot.lidar.unwrap();
    assert!((lidar.height - 0.1602).abs() < 1e-12);
    assert_eq!((lidar.mount.x, lidar.mount.y, lidar.mount.heading), (0.1, 0.0, 0.0));
    assert_eq!((lidar.beams, lidar.rate_hz, lidar.noise_sd), (720, 20.0, 0.01));
    assert_eq!((lidar.min_range, lidar.max_range), (0.01, 10.0));
    assert!((lidar.increment().to_degrees() - 0.2504).abs() < 1e-4);
}

#[test]
fn the_pioneer_is_what_its_data_sheet_says() {
    let (robot, warnings) = read(&Source::new("robots/pioneer3at.urdf", PIONEER)).unwrap();
    assert_eq!(warnings, []);
    let bounds = robot.footprint.bounds();
    assert!((bounds.width() - 0.508).abs() < 1e-9 && (bounds.height() - 0.497).abs() < 1e-9);
    // The swing radius, which the sheet rounds to 34 cm.
    assert!(
        (robot.circumscribed_radius() - 0.342).abs() < 1e-3,
        "{}",
        robot.circumscribed_radius()
    );
    assert!(robot.body_z[0].abs() < 1e-9 && (robot.body_z[1] - 0.487).abs() < 1e-9);
    assert!((robot.mass - (12.0 + 4.5)).abs() < 1e-12, "robot and laser");
    assert_eq!(robot.drive.kind, DriveKind::SkidSteer);
    assert_eq!((robot.drive.wheel_separation, robot.drive.wheel_diameter), (0.422, 0.22));
    assert_eq!(robot.drive.max_linear, Some(0.7));
    assert!((robot.drive.max_angular.unwrap().to_degrees() - 140.0).abs() < 0.1);
    let lidar = robot.lidar.unwrap();
    assert_eq!((lidar.beams, lidar.rate_hz, lidar.noise_sd), (181, 10.0, 0.005));
    assert!((lidar.increment().to_degrees() - 1.0).abs() < 1e-9);
    assert_eq!(
        robot.camera,
        Some(crate::robot::LogicalCamera {
            name: "ids".into(),
            mount: crate::geometry::Pose::default(),
            near: 0.05,
            far: 6.0,
            horizontal_fov: 2.1,
            rate_hz: 10.0,
        })
    );
    assert_eq!(
        robot.compass,
        Some(crate::robot::Compass { name: "compass".into(), rate_hz: 10.0 })
    );
}

/// Checks that the digest, which is part of every trial's key, is the pinned one: a robot without camera and compass
/// keeps its earlier one.
#[test]
fn the_kobuki_s_meaning_is_pinned() {
    let (robot, _) = read(&Source::new("robots/kobuki.urdf", KOBUKI)).unwrap();
    assert_eq!(
        robot.meaning().to_string(),
        "397030e0f07be7736e5d95dfc9312fa96674db2cd67d78440e31e084c88783ef"
    );
}

#[test]
fn faults_of_camera_and_compass_say_where() {
    for (from, to, message) in [
        ("<far>6.0</far>", "<far>0.01</far>", "logical camera `ids` sees from 0.05 to 0.01 m"),
        ("<near>0.05</near>", "<near>-1</near>", "logical camera `ids` sees from -1 to 6 m"),
        (
            "<horizontal_fov>2.1</horizontal_fov>",
            "<horizontal_fov>120</horizontal_fov>",
            "logical camera `ids` looks over 120 rad",
        ),
        ("<horizontal_fov>2.1</horizontal_fov>", "", "<logical_camera> has no <horizontal_fov>"),
        (
            "<aspect_ratio>1.0</aspect_ratio>",
            "<aspect_ratio>0</aspect_ratio>",
            "logical camera `ids` has an aspect ratio of 0",
        ),
        (
            "xyz=\"0 0 0.40\" rpy=\"0 0 0\"",
            "xyz=\"0 0 0.40\" rpy=\"0 0.2 0\"",
            "logical camera `ids` is tilted or upside down",
        ),
        (
            "name=\"compass\">\n      <update_rate>10</update_rate>",
            "name=\"compass\">\n      <update_rate>-7</update_rate>",
            "compass `compass` reads at -7 Hz",
        ),
    ] {
        let found = changed_pioneer(from, to);
        assert!(
            found.iter().any(|f| f.lines().next().unwrap().ends_with(message)),
            "{message}: {found:#?}"
        );
        let source = Source::new("r.urdf", PIONEER.replacen(from, to, 1));
        assert!(read(&source).is_err(), "{message}");
    }
    assert_eq!(
        changed_pioneer("<horizontal_fov>2.1<", "<horizontal_fov>0<"),
        ["\
error: logical camera `ids` looks over 0 rad
   --> r.urdf:147:7
    |
147 |       <logical_camera>
    |       ^^^^^^^^^^^^^^^ expected more than zero and at most a full turn
"]
    );
}

#[test]
fn of_two_compasses_the_first_is_used() {
    let second = "<sensor type=\"imu\" name=\"gyro\"><update_rate>50</update_rate></sensor>";
    let text = PIONEER.replacen(
        "<sensor type=\"magnetometer\"",
        &format!("{second}<sensor type=\"magnetometer\""),
        1,
    );
    let (robot, warnings) = read(&Source::new("r.urdf", text)).unwrap();
    assert_eq!(robot.compass.unwrap().rate_hz, 50.0);
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].message, "second compass `compass`");
}

const SKID: &str = r#"<robot name="skid">
  <link name="base_link">
    <inertial><mass value="12"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><origin xyz="0 0 0.177"/><geometry><box size="0.5 0.4 0.15"/></geometry></collision>
    <collision><geometry><mesh filename="package://skid/top.stl"/></geometry></collision>
  </link>
  <link name="wheel"/>
  <joint name="wheel" type="continuous">
    <origin xyz="0.1 0.3 0"/><parent link="base_link"/><child link="wheel"/><axis xyz="0 1 0"/>
  </joint>
  <link name="scanner"/>
  <joint name="scanner" type="fixed">
    <origin xyz="0.2 0.1 0.3" rpy="0 0 0.5"/><parent link="base_link"/><child link="scanner"/>
  </joint>
  <gazebo reference="scanner">
    <sensor type="gpu_ray" name="lds">
      <pose>0.1 0 0.05 0 0 0</pose>
      <update_rate>5</update_rate>
      <ray>
        <scan><horizontal><samples>360</samples><resolution>1</resolution>
          <min_angle>0</min_angle><max_angle>6.28319</max_angle></horizontal></scan>
        <range><min>0.12</min><max>3.5</max></range>
      </ray>
    </sensor>
    <sensor type="contact" name="bumper"/>
  </gazebo>
  <gazebo><plugin name="d" filename="libgazebo_ros_skid_steer_drive.so">
    <wheelSeparation>0.4</wheelSeparation><wheelDiameter>0.215</wheelDiameter>
    <max_linear_velocity>0.7</max_linear_velocity></plugin></gazebo>
  <gazebo><plugin name="x" filename="libgazebo_ros_wifi.so"/></gazebo>
</robot>"#;

#[test]
fn a_chain_of_joints_mounts_the_sensor_and_the_hull_is_the_footprint() {
    let (robot, warnings) = read(&Source::new("s.urdf", SKID)).unwrap();
    let messages: Vec<_> = warnings.iter().map(|w| w.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "the mesh `package://skid/top.stl` collides on link `base_link` and is not part of the body",
            "unknown plugin `libgazebo_ros_wifi.so`",
            "sensor `bumper` of type `contact` is not simulated",
            "range scanner `lds` looks all round",
        ]
    );
    assert!(warnings.iter().all(|w| w.severity == Severity::Warning));
    let Outline::Polygon(corners) = &robot.footprint else { panic!("{:?}", robot.footprint) };
    assert_eq!(corners.len(), 4);
    let bounds = robot.footprint.bounds();
    assert!((bounds.width() - 0.5).abs() < 1e-12 && (bounds.height() - 0.4).abs() < 1e-12);
    // No base_footprint: the floor is the lowest collision point, z = 0.102.
    let lidar = robot.lidar.unwrap();
    assert!((lidar.height - (0.35 - 0.102)).abs() < 1e-12, "{}", lidar.height);
    assert!((lidar.mount.x - (0.2 + 0.1 * crate::math::cos(0.5))).abs() < 1e-12);
    assert!((lidar.mount.heading - 0.5).abs() < 1e-12);
    assert_eq!((lidar.beams, lidar.noise_sd), (360, 0.0));
    assert!((lidar.increment().to_degrees() - 1.0).abs() < 1e-9);
    assert_eq!(robot.drive.kind, DriveKind::SkidSteer);
    assert_eq!((robot.drive.max_linear, robot.drive.max_angular), (Some(0.7), None));
}

#[test]
fn an_origin_in_degrees_is_noticed() {
    let text = SKID.replacen("rpy=\"0 0 0.5\"", "rpy=\"0 0 90\"", 1);
    assert_ne!(text, SKID);
    let (_, warnings) = read(&Source::new("s.urdf", text)).unwrap();
    let told = warnings.iter().find(|w| w.message.contains("turns")).map(|w| w.render(false));
    let told = told.unwrap_or_default();
    assert!(told.starts_with("warning: an origin turns by more than once around\n"), "{told}");
    assert!(told.ends_with("angles are in radians: are these degrees?\n"), "{told}");
}

#[test]
fn faults_say_where_and_what_to_do() {
    assert_eq!(
        changed("<mass value=\"2.4\"/>", "<mass value=\"-2.4\"/>"),
        ["\
error: mass value out of range
  --> r.urdf:18:7
   |
18 |       <mass value=\"-2.4\"/> <!-- [K] with the small battery pack -->
   |       ^^^^^ expected zero or more, found -2.4
"]
    );
    assert_eq!(
        changed("xyz=\"0 0 0.05949\"", "xyz=\"0 x 0.0 0.05949\""),
        ["\
error: malformed number in xyz
  --> r.urdf:23:20
   |
23 |       <origin xyz=\"0 x 0.0 0.05949\" rpy=\"0 0 0\"/> <!-- [K] -->
   |                    ^^^^^^^^^^^^^^^ expected a finite number, found `x`
"]
    );
    assert_eq!(
        changed("<child link=\"stack_link\"/>", "<child link=\"stak_link\"/>"),
        ["\
error: joint names an unknown child link `stak_link`
  --> r.urdf:64:3
   |
64 |   <joint name=\"stack_joint\" type=\"fixed\">
   |   ^^^^^^
   |
   = help: did you mean `stack_link`?
"]
    );
}

#[test]
fn what_is_no_robot_is_refused() {
    for (from, to, message) in [
        ("radius=\"0.178\"", "radius=\"NaN\"", "malformed number in radius"),
        ("radius=\"0.178\"", "radius=\"0\"", "cylinder radius out of range"),
        ("xyz=\"0 0 0.0102\"", "xyz=\"0 0\"", "wrong count of numbers in xyz"),
        ("<link name=\"laser_link\"/>", "<link name=\"base_link\"/>", "duplicate link `base_link`"),
        ("<link name=\"laser_link\"/>", "<link/>", "<link> without a name"),
        ("xyz=\"0.10 0 0.15\"", "xyz=\"${x} 0 0.15\"", "xacro expression left in the description"),
        (
            "<robot name=\"kobuki\">",
            "<robot name=\"kobuki\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:m/>",
            "unknown macro `m`",
        ),
        ("radius=\"0.178\" ", "", "<cylinder> has no radius"),
        (
            "<child link=\"laser_link\"/>",
            "<child link=\"base_link\"/>",
            "link `base_link` is the child of two joints",
        ),
        (
            "radius=\"0.178\"",
            "radius=\"178\"",
            "robot `kobuki` is 356 m across: expected less than 20 m",
        ),
        ("<samples>720</samples>", "<samples>1</samples>", "number of samples out of range"),
        (
            "<update_rate>20</update_rate>",
            "<update_rate>5000</update_rate>",
            "range scanner `laser` scans at 5000 Hz",
        ),
        ("<max>10.0</max>", "<max>0.001</max>", "range scanner `laser` sees from 0.01 to 0.001 m"),
        (
            "rpy=\"0 0 0\"/>\n    <parent link=\"base_link\"/>\n    <child link=\"laser_link\"/>",
            "rpy=\"1.5 0 0\"/>\n    <parent link=\"base_link\"/>\n    <child link=\"laser_link\"/>",
            "range scanner `laser` is tilted or upside down",
        ),
        (
            "<stddev>0.01</stddev>",
            "<stddev>-0.01</stddev>",
            "range scanner `laser` has a negative standard deviation",
        ),
        (
            "<type>gaussian</type>",
            "<type>salty</type>",
            "range scanner `laser` has noise of kind `salty`",
        ),
        (
            "reference=\"laser_link\"",
            "reference=\"lasr_link\"",
            "reference to an unknown link `lasr_link`",
        ),
        (
            "<wheel_separation>0.230</wheel_separation>",
            "<wheel_separation>-1</wheel_separation>",
            "wheel_separation out of range",
        ),
        (
            "libgazebo_ros_kobuki.so",
            "libgazebo_ros_kobuko.so",
            "unknown plugin `libgazebo_ros_kobuko.so`",
        ),
        ("<robot name=\"kobuki\">", "<sdf><robot name=\"kobuki\">", "not well-formed XML"),
    ] {
        let found = changed(from, to);
        assert!(
            found.iter().any(|f| f.lines().next().unwrap().ends_with(message)),
            "{message}: {found:#?}"
        );
        let source = Source::new("r.urdf", KOBUKI.replacen(from, to, 1));
        assert!(read(&source).is_err(), "{message}");
    }
    assert_eq!(
        faults("<mujoco model='a'/>"),
        ["\
error: not a robot description
 --> r.urdf:1:1
  |
1 | <mujoco model='a'/>
  | ^^^^^^^ expected <robot> of URDF or <sdf>, found <mujoco>
"]
    );
    assert!(
        faults("<robot name='a'><link name='b'/><link name='c'/></robot>")[0]
            .contains("expected one link without a parent, found `b`, `c`")
    );
}

proptest! {
    #[test]
    fn damaged_descriptions_never_panic(edits in edits()) {
        for text in [KOBUKI, PIONEER, SKID] {
            let text = String::from_utf8_lossy(&mutate(text.as_bytes(), &edits)).into_owned();
            for fault in faults(&text) {
                prop_assert!(fault.ends_with('\n'));
            }
        }
    }
}
