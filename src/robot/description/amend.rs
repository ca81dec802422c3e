//! What the manifest says of a robot, put before what its description says.

use super::Request;
use crate::document::xml::Faults;
use crate::document::{Diagnostic, listed};
use crate::geometry::{Outline, Point, Pose, convex_hull};
use crate::robot::Lidar;
use crate::robot::given::{DriveDoc, FootprintDoc, LidarDoc};
use crate::units::Tick;
use std::f64::consts::TAU;

/// Nothing is said of the drive.
pub(super) const NO_DRIVE: DriveDoc = DriveDoc {
    kind: None,
    wheel_separation_m: None,
    wheel_diameter_m: None,
    max_linear_m_s: None,
    max_angular_rad_s: None,
};

/// Returns the outline that the manifest gives; `None` with a fault where it has no area.
pub(super) fn outline(
    given: &FootprintDoc,
    fault: &dyn Fn(&str, &str) -> Diagnostic,
    faults: &mut Faults<'_>,
) -> Option<Outline> {
    match given {
        FootprintDoc::Disc(disc) => {
            Some(Outline::Circle { center: Point::new(disc.x_m, disc.y_m), radius: disc.radius_m })
        }
        FootprintDoc::Rectangle(rectangle) => {
            let center = Point::new(rectangle.x_m, rectangle.y_m);
            Some(Outline::rectangle(center, rectangle.length_m, rectangle.width_m, 0.0))
        }
        FootprintDoc::Polygon(polygon) => {
            let corners: Vec<Point> =
                polygon.polygon_m.iter().map(|[x, y]| Point::new(*x, *y)).collect();
            let hull = convex_hull(&corners);
            if hull.len() < 3 {
                let fault = fault("/footprint/polygon-m", "the footprint has no area");
                faults.push(fault.label("expected corners that do not lie on one line"));
                return None;
            }
            Some(Outline::Polygon(hull))
        }
    }
}

/// Returns the scanner `described` as the manifest amends it.
pub(super) fn lidar(
    described: Option<Lidar>,
    request: &Request<'_>,
    faults: &mut Faults<'_>,
) -> Option<Lidar> {
    let Some(LidarDoc::Numbers(given)) = &request.given.lidar else { return described };
    let of = |get: fn(&Lidar) -> f64| described.as_ref().map(get);
    let angle = |degrees: Option<f64>, get| degrees.map(f64::to_radians).or(of(get));
    let beams = given.beams.or(described.as_ref().map(|lidar| lidar.beams));
    let min_angle = angle(given.min_angle_deg, |lidar| lidar.min_angle);
    let max_angle = angle(given.max_angle_deg, |lidar| lidar.max_angle);
    let min_range = given.min_range_m.or(of(|lidar| lidar.min_range));
    let max_range = given.max_range_m.or(of(|lidar| lidar.max_range));
    let rate = given.rate_hz.or(of(|lidar| lidar.rate_hz));
    let height = given.height_m.or(of(|lidar| lidar.height));
    let known = [
        ("beams", beams.is_some()),
        ("min-angle-deg", min_angle.is_some()),
        ("max-angle-deg", max_angle.is_some()),
        ("min-range-m", min_range.is_some()),
        ("max-range-m", max_range.is_some()),
        ("rate-hz", rate.is_some()),
        ("height-m", height.is_some()),
    ];
    let missing: Vec<&str> =
        known.iter().filter(|(_, is_known)| !is_known).map(|(key, _)| *key).collect();
    if !missing.is_empty() {
        let message = format!("the range scanner lacks {}", listed(&missing));
        let fault = (request.fault)("/lidar", &message);
        faults.push(fault.label("the robot's description has no scanner that says the rest"));
        return None;
    }
    let (beams, min_angle, mut max_angle) = (beams?, min_angle?, max_angle?);
    let (min_range, max_range, rate_hz) = (min_range?, max_range?, rate?);
    let mut refuse = |key: &str, message: String, label: &str| {
        faults.push((request.fault)(&format!("/lidar/{key}"), &message).label(label));
    };
    if max_angle <= min_angle || max_angle - min_angle > TAU + 1e-6 {
        let (from, to) = (min_angle.to_degrees(), max_angle.to_degrees());
        let key = if given.max_angle_deg.is_some() { "max-angle-deg" } else { "min-angle-deg" };
        let label = "expected the first below the last and at most a full turn between them";
        refuse(key, format!("the range scanner looks from {from} to {to} degrees"), label);
    } else if max_angle - min_angle >= TAU - 1e-6 {
        // The last beam of a full turn would be the first one again.
        max_angle = min_angle + TAU * f64::from(beams - 1) / f64::from(beams);
    }
    if max_range <= min_range {
        let key = if given.max_range_m.is_some() { "max-range-m" } else { "min-range-m" };
        let message = format!("the range scanner sees from {min_range} to {max_range} m");
        refuse(key, message, "expected a larger maximum");
    }
    if Tick::period_of(rate_hz).is_none() {
        let label =
            "expected a rate that divides the clock's 3000 Hz, such as 5, 10, 12.5, 20 or 40";
        refuse("rate-hz", format!("the range scanner scans at {rate_hz} Hz"), label);
    }
    let mount = described.as_ref().map(|lidar| lidar.mount).unwrap_or_default();
    Some(Lidar {
        name: described.as_ref().map_or_else(|| "lidar".to_owned(), |lidar| lidar.name.clone()),
        mount: Pose::new(
            given.x_m.unwrap_or(mount.x),
            given.y_m.unwrap_or(mount.y),
            given.heading_deg.map_or(mount.heading, f64::to_radians),
        ),
        height: height?,
        beams,
        min_angle,
        max_angle,
        min_range,
        max_range,
        rate_hz,
        noise_sd: given.noise_sd_m.or(of(|lidar| lidar.noise_sd)).unwrap_or(0.0),
    })
}
