//! The sensors that the robot carries.
//!
//! After SDF: `ray`, `gpu_ray`, `lidar` and `gpu_lidar` are range scanners, `logical_camera` is one, `magnetometer` and `imu`
//! are read as a compass. Of several scanners the level one with the most beams is the robot's, the first of those that have
//! as many; what looks up, down or at one spot (a cliff sensor, a sonar) is none. Of the others the first counts.

use super::parts::{Mounted, Parts};
use super::{Request, amend, asked_scanner, camera, lidar};
use crate::document::xml::{self, Faults};
use crate::document::{sdf, suggestion};
use crate::geometry::Placement;
use crate::robot::{Compass, Lidar, LogicalCamera};
use crate::units::{TICKS_PER_SECOND, Tick};
use roxmltree::Node;

/// The sensors that are simulated.
#[derive(Debug, Default)]
pub(super) struct Sensors {
    pub(super) lidar: Option<Lidar>,
    pub(super) camera: Option<LogicalCamera>,
    pub(super) compass: Option<Compass>,
}

/// How often a sensor reads (Hz) that does not say it. Gazebo's would read at every step of its physics.
const DEFAULT_RATE_HZ: f64 = 10.0;

/// A scanner with fewer beams than this over less than [`SONAR_RAD`] is taken for a sonar.
const SONAR_BEAMS: f64 = 16.0;
/// As wide as sonars look (rad).
const SONAR_RAD: f64 = 0.7;

/// The kind of sensor that is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Scanner,
    Camera,
    Compass,
}

impl Kind {
    /// Returns the kind that SDF's `type` names.
    fn of(name: &str) -> Option<Self> {
        match name {
            "ray" | "gpu_ray" | "lidar" | "gpu_lidar" => Some(Self::Scanner),
            "logical_camera" => Some(Self::Camera),
            "magnetometer" | "imu" => Some(Self::Compass),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Scanner => "range scanner",
            Self::Camera => "logical camera",
            Self::Compass => "compass",
        }
    }
}

/// Reads the sensors of every kind that is simulated. Others are warned of. `ground` is the floor's height (m) in the base
/// frame.
pub(super) fn read(
    parts: &Parts<'_, '_>,
    request: &Request<'_>,
    ground: f64,
    faults: &mut Faults<'_>,
) -> Sensors {
    let mut found = Sensors::default();
    let mut seen = Vec::new();
    let mut scanners: Vec<&Mounted<'_, '_>> = Vec::new();
    for mounted in &parts.sensors {
        let node = mounted.node;
        let written = node.attribute("type").unwrap_or("");
        let name = node.attribute("name").unwrap_or("");
        let Some(kind) = Kind::of(written) else {
            let fault = faults
                .at(node, format!("sensor `{name}` of type `{written}` is not simulated"))
                .label("ignored")
                .warning();
            faults.push(fault);
            continue;
        };
        if kind == Kind::Scanner {
            scanners.push(mounted);
            continue;
        }
        if seen.contains(&kind) {
            let fault = faults
                .at(node, format!("second {} `{name}`", kind.name()))
                .label("ignored: the first one is used")
                .warning();
            faults.push(fault);
            continue;
        }
        let Some(sensor) = Sensor::of(mounted, kind, faults) else { continue };
        seen.push(kind);
        if kind == Kind::Camera {
            found.camera = camera::read(&sensor, faults);
        } else {
            let rate_hz = sensor.rate(faults);
            found.compass = rate_hz.map(|rate_hz| Compass { name: name.to_owned(), rate_hz });
        }
    }
    let described = choose(&scanners, request, faults).and_then(|mounted| {
        let sensor = Sensor::of(mounted, Kind::Scanner, faults)?;
        lidar::read(&sensor, ground, faults)
    });
    found.lidar = amend::lidar(described, request, faults);
    found
}

/// Why a scanner is not the robot's, where it is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unfit {
    Tilted,
    Sonar,
}

/// Returns the scanner that is the robot's, and warns of the others.
fn choose<'p, 'a, 'i>(
    scanners: &[&'p Mounted<'a, 'i>],
    request: &Request<'_>,
    faults: &mut Faults<'_>,
) -> Option<&'p Mounted<'a, 'i>> {
    let name = |mounted: &Mounted<'a, 'i>| mounted.node.attribute("name").unwrap_or("");
    if let Some(asked) = asked_scanner(request.given) {
        let found = scanners.iter().find(|mounted| name(mounted) == asked);
        if found.is_none() {
            let known: Vec<&str> = scanners.iter().map(|mounted| name(mounted)).collect();
            let pointer = match request.given.lidar {
                Some(crate::robot::given::LidarDoc::Numbers(_)) => "/lidar/name",
                _ => "/lidar",
            };
            let fault = (request.fault)(pointer, &format!("unknown range scanner `{asked}`"));
            let label = "not a range scanner of the robot";
            let help = match (suggestion(asked, known.iter().copied()), &known[..]) {
                (Some(near), _) => format!("did you mean `{near}`?"),
                (None, []) => "it has none: give its numbers, `lidar: {beams: ...}`".to_owned(),
                (None, known) => format!("it has {}", crate::document::listed(known)),
            };
            faults.push(fault.label(label).help(help));
        }
        return found.copied();
    }
    let source = faults.source();
    let unfit = |mounted: &Mounted<'a, 'i>| -> Option<Unfit> {
        let beams = lidar::glance(mounted.node);
        let link = mounted.link.unwrap_or(Placement::IDENTITY);
        // What is wrong with it is told when it is read.
        let pose = sdf::pose(mounted.node, &mut Faults::new(source)).placement;
        if link.compose(&pose).rotation[2][2].abs() < LEVEL {
            return Some(Unfit::Tilted);
        }
        let ranger = xml::elements(mounted.node)
            .any(|e| e.attribute("filename").is_some_and(|file| file.contains("gazebo_ros_range")));
        let narrow = beams.samples < SONAR_BEAMS && beams.angle < SONAR_RAD;
        (ranger || narrow).then_some(Unfit::Sonar)
    };
    let samples = |mounted: &Mounted<'a, 'i>| lidar::glance(mounted.node).samples;
    let mut best: Option<&Mounted<'a, 'i>> = None;
    for mounted in scanners.iter().filter(|mounted| unfit(mounted).is_none()) {
        if best.is_none_or(|best| samples(mounted) > samples(best)) {
            best = Some(mounted);
        }
    }
    // Of one that looks round and is tilted, something was meant.
    if best.is_none() && request.given.lidar.is_none() {
        let looks_round =
            |mounted: &&&Mounted<'a, 'i>| lidar::glance(mounted.node).angle >= SONAR_RAD;
        best = scanners.iter().find(looks_round).copied();
    }
    for mounted in scanners {
        if best.is_some_and(|best| std::ptr::eq(*mounted, best)) {
            continue;
        }
        let label = match (unfit(mounted), best) {
            (Some(Unfit::Tilted), _) => "it is tilted".to_owned(),
            (Some(Unfit::Sonar), _) => "it looks at one spot, as a sonar".to_owned(),
            (None, Some(best)) if samples(best) > samples(mounted) => {
                format!("`{}` has more beams", name(best))
            }
            (None, best) => format!("`{}` is the first", best.map_or("", |best| name(best))),
        };
        let own = name(mounted);
        let mut fault = faults.at(mounted.node, format!("range scanner `{own}` is not used"));
        if unfit(mounted) != Some(Unfit::Tilted) {
            fault = fault.help(if own.is_empty() {
                "give it a name, by which it can be chosen".to_owned()
            } else {
                format!("choose it by its name: `robot: {{file, lidar: {own}}}`")
            });
        }
        faults.push(fault.label(label).warning());
    }
    best
}

/// The cosine of the angle up to which a sensor is level.
const LEVEL: f64 = 1.0 - 1e-6;

/// A `<sensor>` on its link.
pub(super) struct Sensor<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    kind: Kind,
    pub(super) name: &'a str,
    link: Placement,
}

impl<'a, 'i> Sensor<'a, 'i> {
    /// Returns `mounted`, a sensor of `kind`; `None` with a fault where it is on no link.
    fn of(mounted: &Mounted<'a, 'i>, kind: Kind, faults: &mut Faults<'_>) -> Option<Self> {
        let (node, name) = (mounted.node, mounted.node.attribute("name").unwrap_or(""));
        let Some(link) = mounted.link else {
            let fault = faults
                .at(mounted.around, format!("sensor `{name}` is on no link"))
                .label("expected an attribute `reference`");
            faults.push(fault);
            return None;
        };
        Some(Self { node, kind, name, link })
    }

    /// Returns its kind and name, for messages.
    pub(super) fn title(&self) -> String {
        format!("{} `{}`", self.kind.name(), self.name)
    }

    /// Returns its placement in the base frame; a fault where it is not level.
    pub(super) fn level_placement(
        &self,
        plane: &str,
        faults: &mut Faults<'_>,
    ) -> Option<Placement> {
        let sdf::Pose { frame, placement: within } = sdf::pose(self.node, faults);
        if let Some(frame) = frame {
            let message = format!("the pose of {} is relative to `{frame}`", self.title());
            let fault = faults.at(self.node, message);
            faults.push(fault.label("expected one in the frame of its link"));
            return None;
        }
        let placement = self.link.compose(&within);
        let up = placement.rotation[2][2];
        // A scanner that hangs upside down scans a level plane all the same.
        let is_level = up >= LEVEL || (self.kind == Kind::Scanner && up <= -LEVEL);
        if !is_level {
            let mut fault = faults
                .at(self.node, format!("{} is tilted or upside down", self.title()))
                .label(format!("expected a level {plane}"));
            if self.kind == Kind::Scanner {
                fault = fault.help(
                    "give the scanner in numbers: `robot: {file, lidar: {beams: ..., height-m: ...}}`",
                );
            }
            faults.push(fault);
        }
        Some(placement)
    }

    /// Returns its `<update_rate>` (Hz), or the nearest one that the clock can serve, with a warning.
    pub(super) fn rate(&self, faults: &mut Faults<'_>) -> Option<f64> {
        let written = match xml::child(self.node, "update_rate") {
            Some(node) => Some(faults.number(node)?),
            None => None,
        };
        let verb = if self.kind == Kind::Scanner { "scans" } else { "reads" };
        let rate = match written {
            None => {
                let fault = faults.at(self.node, format!("{} has no <update_rate>", self.title()));
                let label = format!("read as {DEFAULT_RATE_HZ} Hz");
                faults.push(fault.label(label).warning());
                return Some(DEFAULT_RATE_HZ);
            }
            Some(0.0) => {
                let message = format!("{} {verb} at every step", self.title());
                let fault = faults.at(self.node, message).warning();
                faults.push(fault.label(format!("0 Hz is read as {DEFAULT_RATE_HZ} Hz")));
                return Some(DEFAULT_RATE_HZ);
            }
            Some(rate) => rate,
        };
        if Tick::period_of(rate).is_some() {
            return Some(rate);
        }
        let fault = faults.at(self.node, format!("{} {verb} at {rate} Hz", self.title()));
        let Some(nearest) = nearest_rate(rate) else {
            faults.push(fault.label("expected a rate above 0, at most 3000 Hz"));
            return None;
        };
        let shown = (nearest * 1e4).round() / 1e4;
        let label = format!("read as {shown} Hz, which divides the clock's 3000 Hz");
        faults.push(fault.label(label).warning());
        Some(nearest)
    }
}

/// Returns the rate nearest to `rate` that the clock can serve exactly.
fn nearest_rate(rate: f64) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "3000 is exact")]
    let clock = TICKS_PER_SECOND as f64;
    if !(rate > 0.0 && rate <= clock) {
        return None;
    }
    let period = (clock / rate).round();
    // A quotient that is rounded may miss its own period: then one of the neighbours is nearest.
    [period, period + 1.0, period - 1.0, period + 2.0]
        .into_iter()
        .map(|period| clock / period)
        .find(|rate| Tick::period_of(*rate).is_some())
}
