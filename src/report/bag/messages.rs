//! The ROS 2 messages of a bag, field for field as their `.msg` files have them (common interfaces of ROS 2 Humble).

use crate::geometry::{Point as PlanarPoint, Pose as PlanarPose};
use crate::math;
use crate::robot::Twist as PlanarTwist;
use serde::Serialize;

/// A message type.
pub(super) trait Message: Serialize {
    /// `package/Type`, as `.msg` files name it.
    const TYPE: &'static str;
}

macro_rules! message {
    ($type:ty, $name:literal) => {
        impl Message for $type {
            const TYPE: &'static str = $name;
        }
    };
}

#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Time {
    pub(super) sec: i32,
    pub(super) nanosec: u32,
}

impl Time {
    /// Returns the simulated time of `seconds`, to the microsecond: ticks of the clock are coarser.
    pub(super) fn of(seconds: f64) -> Self {
        let nanoseconds = nanoseconds(seconds);
        Self {
            sec: i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX),
            nanosec: u32::try_from(nanoseconds % 1_000_000_000).unwrap_or(0),
        }
    }
}

/// Returns simulated time as MCAP's log time.
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to hours")]
    let microseconds = (seconds * 1e6).round() as u64;
    microseconds * 1000
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Float64 {
    pub(super) data: f64,
}

message!(Float64, "std_msgs/Float64");

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Text<'a> {
    pub(super) data: &'a str,
}

message!(Text<'_>, "std_msgs/String");

#[derive(Debug, Clone, Serialize)]
pub(super) struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: &'static str,
}

#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Vector3 {
    x: f64,
    y: f64,
    z: f64,
}

impl Vector3 {
    pub(super) fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }
}

impl From<PlanarPoint> for Vector3 {
    fn from(point: PlanarPoint) -> Self {
        Self { x: point.x, y: point.y, z: 0.0 }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

/// `geometry_msgs/Pose` and, with the same fields in the same order, `geometry_msgs/Transform`.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Pose {
    position: Vector3,
    orientation: Quaternion,
}

impl Pose {
    /// Returns the same pose at this height (m).
    pub(super) fn at_height(mut self, z: f64) -> Self {
        self.position.z = z;
        self
    }
}

impl From<PlanarPose> for Pose {
    fn from(pose: PlanarPose) -> Self {
        let (sin, cos) = math::sin_cos(pose.heading / 2.0);
        Self {
            position: pose.position().into(),
            orientation: Quaternion { x: 0.0, y: 0.0, z: sin, w: cos },
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Clock {
    pub(super) clock: Time,
}
message!(Clock, "rosgraph_msgs/Clock");

#[derive(Debug, Serialize)]
pub(super) struct TransformStamped {
    pub(super) header: Header,
    pub(super) child_frame_id: &'static str,
    pub(super) transform: Pose,
}

#[derive(Debug, Serialize)]
pub(super) struct TFMessage {
    pub(super) transforms: Vec<TransformStamped>,
}
message!(TFMessage, "tf2_msgs/TFMessage");

#[derive(Debug, Serialize)]
pub(super) struct PoseStamped {
    pub(super) header: Header,
    pub(super) pose: Pose,
}
message!(PoseStamped, "geometry_msgs/PoseStamped");

/// Covariances are all zero, which ROS reads as unknown.
#[derive(Debug, Serialize)]
pub(super) struct Odometry {
    header: Header,
    child_frame_id: &'static str,
    pose: Pose,
    pose_covariance: Covariance,
    linear: Vector3,
    angular: Vector3,
    twist_covariance: Covariance,
}

#[derive(Debug, Default, Serialize)]
struct Covariance([[f64; 12]; 3]);

impl Odometry {
    pub(super) fn new(
        header: Header,
        child_frame_id: &'static str,
        pose: PlanarPose,
        twist: PlanarTwist,
    ) -> Self {
        Self {
            header,
            child_frame_id,
            pose: pose.into(),
            pose_covariance: Covariance::default(),
            linear: Vector3 { x: twist.linear, ..Vector3::default() },
            angular: Vector3 { z: twist.angular, ..Vector3::default() },
            twist_covariance: Covariance::default(),
        }
    }
}
message!(Odometry, "nav_msgs/Odometry");

#[derive(Debug, Serialize)]
pub(super) struct LaserScan {
    pub(super) header: Header,
    pub(super) angle_min: f32,
    pub(super) angle_max: f32,
    pub(super) angle_increment: f32,
    pub(super) time_increment: f32,
    pub(super) scan_time: f32,
    pub(super) range_min: f32,
    pub(super) range_max: f32,
    pub(super) ranges: Vec<f32>,
    pub(super) intensities: Vec<f32>,
}
message!(LaserScan, "sensor_msgs/LaserScan");

#[derive(Debug, Serialize)]
pub(super) struct OccupancyGrid {
    pub(super) header: Header,
    pub(super) info: MapMetaData,
    pub(super) data: Vec<i8>,
}

#[derive(Debug, Serialize)]
pub(super) struct MapMetaData {
    pub(super) map_load_time: Time,
    pub(super) resolution: f32,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) origin: Pose,
}
message!(OccupancyGrid, "nav_msgs/OccupancyGrid");

#[derive(Debug, Serialize)]
pub(super) struct Path {
    pub(super) header: Header,
    pub(super) poses: Vec<PoseStamped>,
}
message!(Path, "nav_msgs/Path");

#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct ColorRGBA {
    pub(super) r: f32,
    pub(super) g: f32,
    pub(super) b: f32,
    pub(super) a: f32,
}

/// What a marker draws, by the numbers of `visualization_msgs/Marker`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Arrow = 0,
    Sphere = 2,
    LineList = 5,
    Points = 8,
    Text = 9,
}

#[derive(Debug, Serialize)]
pub(super) struct Marker {
    header: Header,
    ns: &'static str,
    id: i32,
    kind: i32,
    action: i32,
    pose: Pose,
    scale: Vector3,
    color: ColorRGBA,
    lifetime: Time,
    frame_locked: bool,
    points: Vec<Vector3>,
    colors: Vec<ColorRGBA>,
    texture_resource: &'static str,
    texture: CompressedImage,
    uv_coordinates: Vec<[f32; 2]>,
    text: String,
    mesh_resource: &'static str,
    mesh_file: MeshFile,
    mesh_use_embedded_materials: bool,
}

#[derive(Debug, Serialize)]
struct CompressedImage {
    header: Header,
    format: &'static str,
    data: Vec<u8>,
}

#[derive(Debug, Default, Serialize)]
struct MeshFile {
    filename: &'static str,
    data: Vec<u8>,
}

impl Marker {
    /// Action 0: draw.
    const ADD: i32 = 0;
    /// Action 3: take away all that were drawn before.
    const DELETE_ALL: i32 = 3;

    pub(super) fn new(header: Header, ns: &'static str, id: i32, shape: Shape) -> Self {
        Self {
            texture: CompressedImage {
                header: Header { stamp: Time::default(), frame_id: "" },
                format: "",
                data: Vec::new(),
            },
            header,
            ns,
            id,
            kind: shape as i32,
            action: Self::ADD,
            pose: PlanarPose::default().into(),
            scale: Vector3::new(0.1, 0.1, 0.1),
            color: ColorRGBA { a: 1.0, ..ColorRGBA::default() },
            lifetime: Time::default(),
            frame_locked: false,
            points: Vec::new(),
            colors: Vec::new(),
            texture_resource: "",
            uv_coordinates: Vec::new(),
            text: String::new(),
            mesh_resource: "",
            mesh_file: MeshFile::default(),
            mesh_use_embedded_materials: false,
        }
    }

    pub(super) fn clear(header: Header) -> Self {
        Self { action: Self::DELETE_ALL, ..Self::new(header, "", 0, Shape::Sphere) }
    }

    pub(super) fn at(self, pose: PlanarPose) -> Self {
        Self { pose: pose.into(), ..self }
    }

    pub(super) fn scaled(self, scale: Vector3) -> Self {
        Self { scale, ..self }
    }

    pub(super) fn colored(self, color: ColorRGBA) -> Self {
        Self { color, ..self }
    }

    pub(super) fn through(self, points: impl IntoIterator<Item = PlanarPoint>) -> Self {
        Self { points: points.into_iter().map(Vector3::from).collect(), ..self }
    }

    pub(super) fn saying(self, text: String) -> Self {
        Self { text, ..self }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct MarkerArray {
    pub(super) markers: Vec<Marker>,
}
message!(MarkerArray, "visualization_msgs/MarkerArray");

/// `rcl_interfaces/Log`: what a log panel shows.
#[derive(Debug, Serialize)]
pub(super) struct Log<'a> {
    pub(super) stamp: Time,
    pub(super) level: u8,
    pub(super) name: &'static str,
    pub(super) msg: &'a str,
    pub(super) file: &'static str,
    pub(super) function: &'static str,
    pub(super) line: u32,
}
message!(Log<'_>, "rcl_interfaces/Log");
