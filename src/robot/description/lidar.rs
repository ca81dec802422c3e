//! The range scanner: `<ray>` of SDF 1.6, `<lidar>` of later versions.

use super::sensors::Sensor;
use crate::document::xml::{self, Faults};
use crate::geometry::Pose;
use crate::robot::Lidar;
use roxmltree::Node;
use std::f64::consts::TAU;

/// What a look at a scanner shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Glance {
    /// Number of beams; 0 where that is not to be read.
    pub(super) samples: f64,
    /// How far round it looks (rad); 0 where that is not to be read.
    pub(super) angle: f64,
}

/// Looks at a scanner without a word on what is wrong with it.
pub(super) fn glance(sensor: Node<'_, '_>) -> Glance {
    let scan = rays(sensor).and_then(|ray| xml::descend(ray, "scan/horizontal"));
    let number = |name| {
        let written = scan.and_then(|scan| xml::child(scan, name)).map(xml::text);
        written.and_then(|text| text.parse::<f64>().ok()).filter(|number| number.is_finite())
    };
    let angle = number("min_angle").zip(number("max_angle")).map(|(min, max)| max - min);
    Glance { samples: number("samples").unwrap_or(0.0), angle: angle.unwrap_or(0.0) }
}

/// Returns what holds a scanner's beams, however old or new its format.
fn rays<'a, 'i>(sensor: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    ["ray", "lidar", "gpu_ray", "gpu_lidar"].into_iter().find_map(|name| xml::child(sensor, name))
}

fn rounded(angle: f64) -> f64 {
    (angle * 1e6).round() / 1e6
}

/// Reads a scanner; `ground` is the floor's height (m) in the base frame.
pub(super) fn read(sensor: &Sensor<'_, '_>, ground: f64, faults: &mut Faults<'_>) -> Option<Lidar> {
    let name = sensor.name;
    let placement = sensor.level_placement("scan plane", faults)?;
    let rate_hz = sensor.rate(faults);
    let sensor = sensor.node;
    let Some(ray) = rays(sensor) else {
        let fault = faults
            .at(sensor, format!("range scanner `{name}` has no <ray>"))
            .label("expected <ray> with <scan> and <range>");
        faults.push(fault);
        return None;
    };
    let (scan, range) = (xml::descend(ray, "scan/horizontal"), xml::child(ray, "range"));
    let (Some(scan), Some(range)) = (scan, range) else {
        let fault = faults
            .at(ray, format!("range scanner `{name}` is incomplete"))
            .label("expected <scan> with <horizontal>, and <range>");
        faults.push(fault);
        return None;
    };
    if let Some(rows) = xml::descend(ray, "scan/vertical/samples").and_then(|n| faults.number(n))
        && rows > 1.0
    {
        let fault = faults
            .at(ray, format!("range scanner `{name}` scans {rows} rows"))
            .label("only the horizontal one is simulated")
            .warning();
        faults.push(fault);
    }
    let samples = faults.required(scan, "samples", "a number of beams");
    let min_angle = faults.required(scan, "min_angle", "an angle in radians");
    let max_angle = faults.required(scan, "max_angle", "an angle in radians");
    let min_range = faults.required(range, "min", "a distance in metres");
    let max_range = faults.required(range, "max", "a distance in metres");
    let noise_sd = noise(ray, name, faults);

    let beams = beams(scan, samples?, faults);
    let (mut min_angle, mut max_angle) = (min_angle?, max_angle?);
    if max_angle <= min_angle || max_angle - min_angle > TAU + 0.01 {
        let mut fault = faults
            .at(scan, format!("range scanner `{name}` looks from {min_angle} to {max_angle} rad"))
            .label("expected min_angle below max_angle and at most a full turn between them");
        if max_angle > min_angle && max_angle - min_angle <= 360.0 + 1e-6 {
            fault = fault.help(format!(
                "angles are in radians: are these degrees? Then they are {} and {}",
                rounded(min_angle.to_radians()),
                rounded(max_angle.to_radians())
            ));
        }
        faults.push(fault);
    }
    let beams = beams?;
    if (TAU - 1e-6..=TAU + 0.01).contains(&(max_angle - min_angle)) {
        // Gazebo would look along the seam twice; the sensor itself does not.
        max_angle = min_angle + TAU * f64::from(beams - 1) / f64::from(beams);
        let fault = faults
            .at(scan, format!("range scanner `{name}` looks all round"))
            .label(format!("read as {beams} beams spaced evenly over the full turn"))
            .warning();
        faults.push(fault);
    }
    let (min_range, max_range) = (min_range?, max_range?);
    if min_range < 0.0 || max_range <= min_range {
        let fault = faults
            .at(range, format!("range scanner `{name}` sees from {min_range} to {max_range} m"))
            .label("expected zero or more, and a larger maximum");
        faults.push(fault);
    }
    // Seen from above, one that hangs upside down sweeps the other way.
    if placement.rotation[2][2] < 0.0 {
        (min_angle, max_angle) = (-max_angle, -min_angle);
        let fault = faults
            .at(sensor, format!("range scanner `{name}` hangs upside down"))
            .label("its beams are read in the other order")
            .warning();
        faults.push(fault);
    }
    let [x, y, z] = placement.translation;
    Some(Lidar {
        name: name.to_owned(),
        mount: Pose::new(x, y, placement.yaw()),
        height: z - ground,
        beams,
        min_angle,
        max_angle,
        min_range,
        max_range,
        rate_hz: rate_hz?,
        noise_sd: noise_sd?,
    })
}

/// Returns the number of beams: whole, 2 to 100 000.
fn beams(scan: Node<'_, '_>, samples: f64, faults: &mut Faults<'_>) -> Option<u32> {
    // SDF: the number of ranges reported is samples times resolution, interpolated where that is above 1.
    if let Some(node) = xml::child(scan, "resolution")
        && let Some(resolution) = faults.number(node)
        && resolution != 1.0
    {
        let fault = faults
            .at(node, format!("scan resolution {resolution}"))
            .label("read as 1: every sample is a beam of its own")
            .warning();
        faults.push(fault);
    }
    if samples.fract() != 0.0 || !(2.0..=100_000.0).contains(&samples) {
        let fault = faults
            .at(scan, "number of samples out of range")
            .label(format!("expected a whole number from 2 to 100000, found {samples}"));
        faults.push(fault);
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Some(samples as u32)
}

/// Returns the standard deviation (m) of the range noise: zero where none is described.
fn noise(ray: Node<'_, '_>, name: &str, faults: &mut Faults<'_>) -> Option<f64> {
    let Some(noise) = xml::child(ray, "noise") else { return Some(0.0) };
    let kind = noise
        .attribute("type")
        .or_else(|| xml::child(noise, "type").map(xml::text))
        .unwrap_or("none");
    match kind {
        "none" => return Some(0.0),
        "gaussian" => {}
        _ => {
            let fault = faults
                .at(noise, format!("range scanner `{name}` has noise of kind `{kind}`"))
                .label("expected `gaussian` or `none`");
            faults.push(fault);
            return None;
        }
    }
    if let Some(mean) = xml::child(noise, "mean").and_then(|node| faults.number(node))
        && mean != 0.0
    {
        let fault = faults
            .at(noise, format!("range scanner `{name}` has a bias of {mean} m"))
            .label("read as zero")
            .warning();
        faults.push(fault);
    }
    let sd = faults.required(noise, "stddev", "a standard deviation in metres")?;
    if sd < 0.0 {
        let fault = faults
            .at(noise, format!("range scanner `{name}` has a negative standard deviation"))
            .label(format!("expected zero or more, found {sd}"));
        faults.push(fault);
        return None;
    }
    Some(sd)
}
