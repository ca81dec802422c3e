//! The truth in motion: one integer clock, a dynamic body driven through a noise model, sensors at their own
//! rates.
//!
//! A reading nobody asks for is not computed: its pose is kept, and its noise stream is indexed by the reading's number,
//! so laziness changes no bit.

mod camera;
mod compass;
mod drive;
mod engine;
mod lidar;
mod noise;
mod odometry;

pub use camera::{CameraScene, Occlusion};
pub use compass::CompassNoise;
pub use drive::DriveNoise;
pub use engine::Stepping;
pub use lidar::WallSweep;
pub use noise::Distribution;
pub use odometry::OdometryNoise;

use crate::geometry::{Outline, Pose};
use crate::rng::{Seeds, Stream};
use crate::robot::{self, CompassReading, Detection, Lidar, Odometry, Robot, Scan, Twist};
use crate::units::Tick;
use camera::Camera;
use compass::Compass;
use drive::Drive;
use engine::Engine;
use odometry::Odometer;

/// Physics runs at 100 Hz: a robot at 1 m/s moves 1 cm a step, and finer steps cost without benefit.
pub const PHYSICS_PERIOD: Tick = Tick(30);

/// What a simulator is made from.
#[derive(Debug)]
pub struct Scene<'a> {
    /// What the lidar sees: outlines at its height, world frame.
    pub visible: &'a [Outline],
    /// What the body can touch: outlines over its height, world frame.
    pub solid: &'a [Outline],
    /// The robot.
    pub robot: &'a Robot,
    /// Its lidar as the study uses it (range and noise may differ from the robot's own).
    pub lidar: Lidar,
    /// Its logical camera among the world's tags, where the study uses one.
    pub camera: Option<CameraScene<'a>>,
    /// Its compass and that one's errors, where the study uses one.
    pub compass: Option<(robot::Compass, CompassNoise)>,
    /// Where it begins, in the world's frame.
    pub start: Pose,
    /// When the physics engine is asked.
    pub stepping: Stepping,
    /// Errors of the drive.
    pub drive_noise: DriveNoise,
    /// Errors of odometry.
    pub odometry_noise: OdometryNoise,
}

/// One robot in one world.
#[derive(Debug)]
pub struct Simulator {
    engine: Engine,
    drive: Drive,
    odometer: Odometer,
    sweep: WallSweep,
    lidar: Lidar,
    lidar_noise: Stream,
    scan_period: Tick,
    camera: Option<(Camera, Shutter)>,
    compass: Option<(Compass, Shutter)>,
    now: Tick,
    scan: PendingScan,
    travelled: f64,
    turned: f64,
    contacts: u32,
    touching: bool,
}

/// Where the last scan was taken; its ranges are computed when someone asks.
#[derive(Debug, Clone, Copy)]
struct PendingScan {
    number: u64,
    stamp: Tick,
    pose: Pose,
    odometry: Odometry,
}

/// When and where a sensor last read; what it read is computed when someone asks.
#[derive(Debug, Clone, Copy)]
struct Shutter {
    period: Tick,
    number: u64,
    stamp: Tick,
    pose: Pose,
}

impl Shutter {
    /// First due at tick 0, at `pose`. A rate that the clock cannot serve is taken for physics' own, as with the lidar.
    fn new(rate_hz: f64, pose: Pose) -> Self {
        let period = Tick::period_of(rate_hz).unwrap_or(PHYSICS_PERIOD);
        Self { period, number: 0, stamp: Tick(0), pose }
    }

    /// Reads where it is due; physics serves it at the first step after.
    fn note(&mut self, now: Tick, pose: Pose) {
        if now.0 >= (self.number + 1) * self.period.0 {
            (self.number, self.stamp, self.pose) = (now.0 / self.period.0, now, pose);
        }
    }
}

impl Simulator {
    /// A robot at rest at the start of `scene`, its first scan taken at tick 0.
    ///
    /// The lidar's rate must divide the clock, which resolution has checked; otherwise the rate is rounded
    /// to the next slower one that physics can serve.
    pub fn new(scene: Scene<'_>, seeds: &Seeds) -> Self {
        let scan_period = Tick::period_of(scene.lidar.rate_hz).unwrap_or(PHYSICS_PERIOD);
        let odometer = Odometer::new(scene.odometry_noise, seeds);
        Self {
            engine: Engine::new(scene.solid, scene.robot, scene.start, scene.stepping),
            drive: Drive::new(scene.drive_noise, &scene.robot.drive, seeds),
            sweep: WallSweep::new(scene.visible, &scene.lidar),
            lidar_noise: seeds.stream("lidar-noise"),
            scan_period,
            camera: scene.camera.map(|scene_of| {
                let shutter = Shutter::new(scene_of.camera.rate_hz, scene.start);
                (Camera::new(scene_of, scene.visible), shutter)
            }),
            compass: scene.compass.map(|(compass, noise)| {
                (Compass::new(noise, seeds), Shutter::new(compass.rate_hz, scene.start))
            }),
            now: Tick(0),
            scan: PendingScan {
                number: 0,
                stamp: Tick(0),
                pose: scene.start,
                odometry: odometer.reading(Tick(0)),
            },
            odometer,
            lidar: scene.lidar,
            travelled: 0.0,
            turned: 0.0,
            contacts: 0,
            touching: false,
        }
    }

    /// The clock.
    pub fn now(&self) -> Tick {
        self.now
    }

    /// Sets the commanded velocity, which holds until the next command.
    pub fn command(&mut self, twist: Twist) {
        self.drive.command(twist);
    }

    /// Runs physics until the clock shows `until` or the first step after it.
    pub fn advance_to(&mut self, until: Tick) {
        while self.now < until {
            let executed = self.drive.executed(self.now);
            let before = self.engine.pose();
            self.engine.step(executed);
            self.now = self.now + PHYSICS_PERIOD;
            let moved = before.relative(self.engine.pose());
            self.travelled += moved.position().norm();
            self.turned += moved.heading.abs();
            self.odometer.integrate(moved, self.now);
            let touching = self.engine.is_touching();
            self.contacts += u32::from(touching && !self.touching);
            self.touching = touching;
            // A rate that physics cannot hit exactly is served at the first step after it is due.
            let due = (self.scan.number + 1) * self.scan_period.0;
            if self.now.0 >= due {
                self.scan = PendingScan {
                    number: self.now.0 / self.scan_period.0,
                    stamp: self.now,
                    pose: self.engine.pose(),
                    odometry: self.odometer.reading(self.now),
                };
            }
            if let Some((_, shutter)) = &mut self.camera {
                shutter.note(self.now, self.engine.pose());
            }
            if let Some((_, shutter)) = &mut self.compass {
                shutter.note(self.now, self.engine.pose());
            }
        }
    }

    /// When the next scan is due.
    pub fn next_scan(&self) -> Tick {
        Tick((self.scan.number + 1) * self.scan_period.0)
    }

    /// Odometry at the time of the latest scan: what a mapper pairs the scan with.
    pub fn odometry_at_scan(&self) -> Odometry {
        self.scan.odometry
    }

    /// Odometry now.
    pub fn odometry(&self) -> Odometry {
        self.odometer.reading(self.now)
    }

    /// The latest scan, written over `scan` to spare an allocation.
    pub fn read_scan(&mut self, scan: &mut Scan) {
        let sensor = self.scan.pose.compose(self.lidar.mount);
        scan.stamp = self.scan.stamp;
        self.sweep.cast(sensor, &mut scan.ranges);
        lidar::add_noise(&self.lidar, self.lidar_noise.at(self.scan.number), &mut scan.ranges);
    }

    /// An empty scan message of this lidar's shape, for [`Simulator::read_scan`].
    pub fn blank_scan(&self) -> Scan {
        Scan {
            stamp: Tick(0),
            mount: self.lidar.mount,
            min_angle: self.lidar.min_angle,
            increment: self.lidar.increment(),
            min_range: self.lidar.min_range,
            max_range: self.lidar.max_range,
            ranges: Vec::new(),
        }
    }

    /// What the logical camera sees in its latest image, written over `detections`; when that was, or `None` where the
    /// scene has no camera.
    pub fn read_detections(&mut self, detections: &mut Vec<Detection>) -> Option<Tick> {
        let (camera, shutter) = self.camera.as_mut()?;
        camera.look(shutter.pose, detections);
        Some(shutter.stamp)
    }

    /// The latest reading of the compass, or `None` where the scene has none.
    pub fn read_compass(&mut self) -> Option<CompassReading> {
        let (compass, shutter) = self.compass.as_mut()?;
        Some(compass.reading(shutter.stamp, shutter.pose.heading))
    }

    /// The true pose in the world's frame. For measuring and drawing; no mind may see it.
    pub fn true_pose(&self) -> Pose {
        self.engine.pose()
    }

    /// True distance travelled so far (m).
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// Sum of the absolute turns so far (rad).
    pub fn turned(&self) -> f64 {
        self.turned
    }

    /// How many times the body came into contact with something.
    pub fn contacts(&self) -> u32 {
        self.contacts
    }

    /// Whether the body touches something now.
    pub fn is_touching(&self) -> bool {
        self.touching
    }
}
