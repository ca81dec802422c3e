//! The simulated truth: one integer clock, a dynamic body driven through a noise model, sensors at their own rates.
//!
//! A reading that is not requested is not computed: its pose is kept, and its noise stream is indexed by the reading's
//! number, so laziness changes no bit.

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

/// The parts of which a simulator is made.
#[derive(Debug)]
pub struct Scene<'a> {
    /// The outlines that the lidar sees: those at its height, world frame.
    pub visible: &'a [Outline],
    /// The outlines that the body can touch: those over its height, world frame.
    pub solid: &'a [Outline],
    /// The robot.
    pub robot: &'a Robot,
    /// Its lidar as the study uses it (range and noise may differ from the robot's own).
    pub lidar: Lidar,
    /// Its logical camera among the world's tags, where the study uses one.
    pub camera: Option<CameraScene<'a>>,
    /// Its compass and the compass's errors, where the study uses one.
    pub compass: Option<(robot::Compass, CompassNoise)>,
    /// Its first pose, in the world's frame.
    pub start: Pose,
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

/// The pose of the last scan; its ranges are computed on request.
#[derive(Debug, Clone, Copy)]
struct PendingScan {
    number: u64,
    stamp: Tick,
    pose: Pose,
    odometry: Odometry,
}

/// Time and pose of a sensor's last reading; the reading is computed on request.
#[derive(Debug, Clone, Copy)]
struct Shutter {
    period: Tick,
    number: u64,
    stamp: Tick,
    pose: Pose,
}

impl Shutter {
    /// Creates a shutter first due at tick 0, at `pose`. A rate that the clock cannot serve is replaced by that of
    /// physics, as with the lidar.
    fn new(rate_hz: f64, pose: Pose) -> Self {
        let period = Tick::period_of(rate_hz).unwrap_or(PHYSICS_PERIOD);
        Self { period, number: 0, stamp: Tick(0), pose }
    }

    /// Takes a reading if one is due; physics serves it at the first step after.
    fn note(&mut self, now: Tick, pose: Pose) {
        if now.0 >= (self.number + 1) * self.period.0 {
            (self.number, self.stamp, self.pose) = (now.0 / self.period.0, now, pose);
        }
    }
}

impl Simulator {
    /// Creates a robot at rest at the start of `scene`, its first scan taken at tick 0.
    ///
    /// The lidar's rate must divide the clock, which resolution has checked; otherwise the rate is rounded
    /// to the next slower one that physics can serve.
    pub fn new(scene: Scene<'_>, seeds: &Seeds) -> Self {
        let scan_period = Tick::period_of(scene.lidar.rate_hz).unwrap_or(PHYSICS_PERIOD);
        let odometer = Odometer::new(scene.odometry_noise, seeds);
        Self {
            engine: Engine::new(scene.solid, scene.robot, scene.start),
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

    /// Returns the clock's time.
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
            let moved = self.engine.step(executed);
            self.now = self.now + PHYSICS_PERIOD;
            self.travelled += moved.position().norm();
            self.turned += moved.heading.abs();
            self.odometer.integrate(moved, self.now);
            let touching = self.engine.is_touching();
            self.contacts += u32::from(touching && !self.touching);
            self.touching = touching;
            // A rate that physics cannot meet exactly is served at the first step after the reading is due.
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

    /// Returns the time at which the next scan is due.
    pub fn next_scan(&self) -> Tick {
        Tick((self.scan.number + 1) * self.scan_period.0)
    }

    /// Returns the odometry at the time of the latest scan, with which a mapper pairs the scan.
    pub fn odometry_at_scan(&self) -> Odometry {
        self.scan.odometry
    }

    /// Returns the odometry now.
    pub fn odometry(&self) -> Odometry {
        self.odometer.reading(self.now)
    }

    /// Reads the latest scan into `scan`, to spare an allocation.
    pub fn read_scan(&mut self, scan: &mut Scan) {
        let sensor = self.scan.pose.compose(self.lidar.mount);
        scan.stamp = self.scan.stamp;
        self.sweep.cast(sensor, &mut scan.ranges);
        lidar::add_noise(&self.lidar, self.lidar_noise.at(self.scan.number), &mut scan.ranges);
    }

    /// Returns an empty scan message of this lidar's shape, for [`Simulator::read_scan`].
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

    /// Reads the tags in the logical camera's latest image into `detections` and returns the time of that image, or
    /// `None` where the scene has no camera.
    pub fn read_detections(&mut self, detections: &mut Vec<Detection>) -> Option<Tick> {
        let (camera, shutter) = self.camera.as_mut()?;
        camera.look(shutter.pose, detections);
        Some(shutter.stamp)
    }

    /// Returns the latest reading of the compass, or `None` where the scene has none.
    pub fn read_compass(&mut self) -> Option<CompassReading> {
        let (compass, shutter) = self.compass.as_mut()?;
        Some(compass.reading(shutter.stamp, shutter.pose.heading))
    }

    /// Returns the true pose in the world's frame. For measuring and drawing; no mind may see it.
    pub fn true_pose(&self) -> Pose {
        self.engine.pose()
    }

    /// Returns the true distance travelled so far (m).
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// Returns the sum of the absolute turns so far (rad).
    pub fn turned(&self) -> f64 {
        self.turned
    }

    /// Returns how many times the body came into contact with something.
    pub fn contacts(&self) -> u32 {
        self.contacts
    }

    /// Returns whether the body touches something now.
    pub fn is_touching(&self) -> bool {
        self.touching
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Source;
    use crate::geometry::Point;
    use crate::units::Seconds;
    use crate::world::Tag;

    const PIONEER: &str = include_str!("../../robots/pioneer3at.urdf");

    fn simulator(walls: &[Outline], tags: &[Tag]) -> Simulator {
        let (robot, _) = robot::urdf::read(&Source::new("p.urdf", PIONEER)).unwrap();
        let camera = robot.camera.clone().unwrap();
        let heading = 0.157;
        let noise = CompassNoise {
            distribution: Distribution::Uniform,
            heading,
            correlation: Seconds(0.1),
        };
        let scene = Scene {
            visible: walls,
            solid: walls,
            lidar: robot.lidar.clone().unwrap(),
            camera: Some(CameraScene { camera, tags, occlusion: Occlusion::None }),
            compass: robot.compass.clone().map(|compass| (compass, noise)),
            start: Pose::default(),
            drive_noise: DriveNoise {
                distribution: Distribution::Uniform,
                linear: 0.25,
                angular: 0.25,
                correlation: Seconds(0.1),
            },
            odometry_noise: OdometryNoise::NONE,
            robot: &robot,
        };
        Simulator::new(scene, &Seeds::new(4, vec![]))
    }

    #[test]
    fn what_is_read_when_leaves_no_mark() {
        let walls = [Outline::rectangle(Point::new(4.0, 0.0), 0.2, 6.0, 0.0)];
        let tag = Tag { id: "a".into(), color: "green".into(), pose: Pose::new(3.0, 1.0, 0.0) };
        let drive = |eager: bool| {
            let mut sim = simulator(&walls, std::slice::from_ref(&tag));
            let (mut scan, mut seen) = (sim.blank_scan(), Vec::new());
            sim.command(Twist { linear: 0.3, angular: 0.2 });
            for second in 1..=4 {
                sim.advance_to(Tick(3000 * second));
                if eager || second == 4 {
                    sim.read_scan(&mut scan);
                    sim.read_detections(&mut seen);
                    let compass = sim.read_compass().unwrap();
                    assert_eq!((scan.stamp, compass.stamp), (sim.now(), sim.now()));
                    if second == 4 {
                        return (scan, seen, compass, sim.true_pose());
                    }
                }
            }
            unreachable!("the fourth second returns")
        };
        let (eager, lazy) = (drive(true), drive(false));
        assert_eq!(eager, lazy);
        assert_eq!(lazy.1.len(), 1);
        let truth = lazy.3.relative(tag.pose);
        assert!(lazy.1[0].pose.position().distance(truth.position()) < 1e-12);
        assert!((lazy.2.heading - lazy.3.heading).abs() <= 0.157);
    }

    #[test]
    fn contact_is_felt_when_the_body_is_there_and_not_before() {
        let walls = [Outline::rectangle(Point::new(1.0, 0.0), 0.2, 6.0, 0.0)];
        let mut sim = simulator(&walls, &[]);
        sim.command(Twist { linear: 0.6, angular: 0.0 });
        while !sim.is_touching() {
            assert!(sim.now() < Tick(6000), "no contact");
            sim.advance_to(sim.now() + PHYSICS_PERIOD);
        }
        // The wall's face is 0.9 m away, the body's front 0.254 m ahead; a step is 7 mm at most.
        let gap = 0.9 - 0.254 - sim.true_pose().x;
        assert!(gap.abs() < 0.008, "{gap}");
        assert_eq!(sim.contacts(), 1);
    }
}
