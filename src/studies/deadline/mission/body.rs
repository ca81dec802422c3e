//! The robot below its decisions: the simulator with its sensors, the pilot, and between them the Intersection
//! Detection System.

use super::{Prepared, graph};
use crate::geometry::{Cardinal, Point, Pose};
use crate::navigation::maneuver::{self, CONTROL_PERIOD, Leg, Pilot, Sense, SpeedLimits};
use crate::rng::Seeds;
use crate::robot::{CompassReading, Detection, Scan, Twist};
use crate::sim::{
    CameraScene, CompassNoise, Distribution, DriveNoise, Occlusion, OdometryNoise, Scene, Simulator,
};
use crate::studies::deadline::build_cmdp::{Motion, Speed};
use crate::studies::deadline::intersection::{Intersection, Opening};
use crate::studies::deadline::{ErrorShape, Hiding, IntersectionDetectionSystem, Setup};
use crate::studies::recording::{Frame, GraphView, Recording, Sensed};
use crate::studies::state_chain::StateChain;
use crate::units::{Radians, Seconds, Tick};

/// The event of a control period.
#[derive(Debug)]
pub(super) enum Happening {
    /// Nothing that requires a decision.
    OnTheWay,
    /// The body touches something.
    Contact,
    /// The robot is at a vertex.
    Arrived(Intersection),
    /// The robot has looked around and seen no vertex.
    Lost,
}

/// A robot in a building.
pub(super) struct Body<'a> {
    sim: Simulator,
    scan: Scan,
    detections: Vec<Detection>,
    pilot: Pilot,
    limits: [SpeedLimits; 2],
    ids: IntersectionDetectionSystem,
    /// Whether it turns once around, to see the vertex at which it stands.
    looking: bool,
    command: Twist,
    chain: StateChain,
    /// Vertices arrived at, for the chain.
    arrivals: u64,
    recording: Option<&'a mut Recording>,
}

impl<'a> Body<'a> {
    /// Creates the robot of `setup` at `start`, about to look around: the scene with its errors, the recording's
    /// unchanging part, then pilot and detection.
    pub(super) fn new(
        setup: &Setup,
        prepared: &Prepared,
        start: Pose,
        seeds: &Seeds,
        mut recording: Option<&'a mut Recording>,
    ) -> Self {
        let sensing = &setup.parameters.sensing;
        let robot = &setup.robot;
        let scene = Scene {
            visible: &prepared.visible,
            solid: &prepared.solid,
            robot,
            lidar: prepared.lidar.clone(),
            camera: robot.camera.clone().map(|camera| CameraScene {
                camera,
                tags: &setup.world.tags,
                occlusion: match sensing.occlusion {
                    Hiding::None => Occlusion::None,
                    Hiding::Walls => Occlusion::Walls,
                },
            }),
            compass: robot.compass.clone().map(|compass| {
                let noise = CompassNoise {
                    distribution: distribution(sensing.compass_noise),
                    heading: Radians::from_degrees(sensing.compass_noise_deg).get(),
                    correlation: Seconds(sensing.compass_noise_correlation_s),
                };
                (compass, noise)
            }),
            start,
            drive_noise: DriveNoise {
                distribution: distribution(sensing.drive_noise),
                linear: sensing.drive_noise_linear,
                angular: sensing.drive_noise_angular,
                correlation: Seconds(sensing.drive_noise_correlation_s),
            },
            // Nothing reads odometry in this study: the paper's robot has compass, laser and camera only.
            odometry_noise: OdometryNoise { distance: 0.0, heading: 0.0 },
        };
        let sim = Simulator::new(scene, seeds);
        if let Some(recording) = &mut recording {
            recording.world.clone_from(&prepared.visible);
            recording.footprint = robot.footprint.clone();
            recording.map_pose = start;
            recording.rule = graph::rule(&setup.parameters.rules);
        }
        let rule = setup.parameters.pilot;
        Self {
            scan: sim.blank_scan(),
            sim,
            detections: Vec::new(),
            limits: [rule.slow, rule.fast],
            pilot: Pilot::new(rule, &robot.footprint),
            ids: IntersectionDetectionSystem::new(&setup.parameters.perception),
            looking: false,
            command: Twist::STOP,
            chain: StateChain::default(),
            arrivals: 0,
            recording,
        }
    }

    /// Returns the clock's time.
    pub(super) fn now(&self) -> Tick {
        self.sim.now()
    }

    /// Returns the true distance travelled (m), for measuring.
    pub(super) fn travelled(&self) -> f64 {
        self.sim.travelled()
    }

    /// Returns the sum of the absolute turns (rad), for measuring.
    pub(super) fn turned(&self) -> f64 {
        self.sim.turned()
    }

    /// Returns the chain of state hashes so far.
    pub(super) fn chain(&self) -> &StateChain {
        &self.chain
    }

    /// Begins to look around, to see the vertex at which the robot stands.
    pub(super) fn look_around(&mut self) {
        self.looking = true;
        self.ids.begin_look_around();
        self.pilot.look_around();
    }

    /// Leaves the vertex by `exit`, which leads through `opening`, with a maneuver of that motion.
    pub(super) fn leave(&mut self, exit: Cardinal, opening: Opening, motion: Motion, speed: Speed) {
        self.ids.depart(exit, opening);
        self.pilot.begin(Leg {
            direction: exit.heading(),
            opening: match motion {
                Motion::Corridor => maneuver::Opening::Corridor,
                Motion::DoorLeft | Motion::DoorRight => maneuver::Opening::Door,
            },
            limits: match speed {
                Speed::Slow => self.limits[0],
                Speed::Fast => self.limits[1],
            },
        });
    }

    /// Returns the recording, where the trial is recorded.
    pub(super) fn recording(&mut self) -> Option<&mut Recording> {
        self.recording.as_deref_mut()
    }

    /// Returns whether the trial is recorded.
    pub(super) fn is_recorded(&self) -> bool {
        self.recording.is_some()
    }

    /// Returns the true position, for drawing.
    pub(super) fn position(&self) -> Point {
        self.sim.true_pose().position()
    }

    /// Writes the mind's knowledge and intention into the recording, and the same in words.
    pub(super) fn note(&mut self, graph: GraphView, event: String) {
        let frame = self.frame();
        if let Some(recording) = &mut self.recording {
            recording.frames.push(Frame { graph: Some(graph), event: Some(event), ..frame });
        }
    }

    fn note_sensed(&mut self) {
        if let Some(sensed) = self.recording.as_mut().and_then(|r| r.sensed.as_mut()) {
            let odometry = self.sim.odometry_at_scan();
            let believed = odometry.pose;
            sensed.push(Sensed { scan: self.scan.clone(), odometry, believed });
        }
    }

    /// Drives for one control period: sense, steer, move.
    pub(super) fn step(&mut self) -> Happening {
        self.sim.read_scan(&mut self.scan);
        self.note_sensed();
        self.sim.read_detections(&mut self.detections);
        let blind = CompassReading { stamp: self.sim.now(), heading: 0.0 };
        let compass = self.sim.read_compass().unwrap_or(blind);
        let mut arrived = self.ids.observe(&self.detections, compass, self.command);
        if self.looking && self.pilot.is_standing() {
            self.looking = false;
            match self.ids.end_look_around() {
                Some(here) => arrived = Some(here),
                None => return Happening::Lost,
            }
        }
        if let Some(here) = arrived {
            self.arrivals += 1;
            return Happening::Arrived(here);
        }
        let target = self.ids.target();
        self.command = self.pilot.control(&Sense { scan: &self.scan, compass, target });
        self.sim.command(self.command);
        self.sim.advance_to(self.sim.now() + CONTROL_PERIOD);
        self.note_state();
        if self.sim.is_touching() { Happening::Contact } else { Happening::OnTheWay }
    }

    fn note_state(&mut self) {
        let now = self.sim.now();
        if self.chain.is_due(now) {
            let (pose, travelled) = (self.sim.true_pose(), self.sim.travelled());
            let arrivals = self.arrivals;
            self.chain.push(|hasher| {
                for number in [pose.x, pose.y, pose.heading, travelled] {
                    hasher.update(number.to_bits().to_le_bytes());
                }
                hasher.update(now.0.to_le_bytes());
                hasher.update(arrivals.to_le_bytes());
            });
        }
        let frame = self.frame();
        if let Some(recording) = &mut self.recording {
            recording.frames.push(frame);
        }
    }

    fn frame(&self) -> Frame {
        Frame {
            time_s: self.sim.now().seconds().get(),
            pose: self.sim.true_pose(),
            distance_m: self.sim.travelled(),
            ..Frame::default()
        }
    }
}

fn distribution(shape: ErrorShape) -> Distribution {
    match shape {
        ErrorShape::Uniform => Distribution::Uniform,
        ErrorShape::Gaussian => Distribution::Gaussian,
    }
}
