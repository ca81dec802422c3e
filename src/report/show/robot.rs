//! A robot from above: footprint, wheels, scanner and logical camera with their fields of view.

use crate::figure::canvas::{ACCENT, Canvas, FAINT, INK, metres};
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::math;
use crate::robot::Robot;

/// Width of a wheel as drawn, in wheel diameters: the description does not say.
const WHEEL_WIDTH: f64 = 0.3;

/// The logical camera's cone.
const CONE: &str = "#d98324";

/// Draws the robot from above, x to the right, with its dimensions, as an SVG file.
pub fn robot_svg(robot: &Robot) -> String {
    let radius = robot.circumscribed_radius();
    let body = robot.footprint.bounds();
    let margin = 0.75 * radius.max(robot.drive.wheel_separation / 2.0);
    // Fields of view are cut off: they show the direction; how far they reach is on the sheet below.
    let (reach, cone_reach) = (2.1 * radius, 1.6 * radius);
    let mut bounds = body.grown(margin);
    if let Some(lidar) = &robot.lidar {
        for point in wedge(lidar.mount, lidar.min_angle, lidar.max_angle, reach) {
            bounds = bounds.union(Bounds { min: point, max: point }.grown(0.12 * radius));
        }
    }
    let mut canvas = Canvas::new(bounds, 620.0, 620.0);
    canvas.raster();
    if let Some(lidar) = &robot.lidar {
        let mut corners = wedge(lidar.mount, lidar.min_angle, lidar.max_angle, reach);
        corners.push(lidar.mount.position());
        let view = canvas
            .path(&corners, true)
            .set("fill", ACCENT)
            .set("fill-opacity", 0.12)
            .set("stroke", ACCENT)
            .set("stroke-dasharray", "5 4");
        canvas.push(view);
    }
    let cone = robot.camera.as_ref().map(|camera| {
        let half = camera.horizontal_fov / 2.0;
        let mut corners = wedge(camera.mount, -half, half, cone_reach);
        corners.push(camera.mount.position());
        (camera, corners)
    });
    if let Some((_, corners)) = &cone {
        let view = canvas
            .path(corners, true)
            .set("fill", CONE)
            .set("fill-opacity", 0.16)
            .set("stroke", CONE)
            .set("stroke-dasharray", "2 3");
        canvas.push(view);
    }
    let body_shape = canvas
        .outline(&robot.footprint)
        .set("fill", "#d9d9d9")
        .set("fill-opacity", 0.85)
        .set("stroke", INK)
        .set("stroke-width", 2);
    canvas.push(body_shape);
    let (half, diameter) = (robot.drive.wheel_separation / 2.0, robot.drive.wheel_diameter);
    for y in [half, -half] {
        let wheel = Outline::rectangle(Point::new(0.0, y), diameter, WHEEL_WIDTH * diameter, 0.0);
        let wheel = canvas.outline(&wheel).set("fill", "#555");
        canvas.push(wheel);
    }
    let axle = canvas
        .path(&[Point::new(0.0, -half), Point::new(0.0, half)], false)
        .set("stroke", "#555")
        .set("stroke-dasharray", "2 3");
    canvas.push(axle);
    // Axes as ROS has them (REP 103).
    let (ahead, aside) = (Point::new(0.45 * radius, 0.0), Point::new(0.0, 0.45 * radius));
    canvas.arrow(Point::ZERO, ahead, INK);
    canvas.arrow(Point::ZERO, aside, INK);
    for (tip, shift, text) in [(ahead, (-2.0, 15.0), "x, ahead"), (aside, (-26.0, 4.0), "y, left")]
    {
        let label = canvas.label(tip, shift, 10.5, text);
        canvas.push(label);
    }
    if let Some(lidar) = &robot.lidar {
        let at = Outline::Circle { center: lidar.mount.position(), radius: 0.04 * radius };
        let dot = canvas.outline(&at).set("fill", ACCENT);
        canvas.push(dot);
        let beyond = Pose::new(lidar.mount.x, lidar.mount.y, lidar.mount.heading)
            .compose(Pose::new(0.0, 0.0, f64::midpoint(lidar.min_angle, lidar.max_angle)))
            .transform(Point::new(0.66 * reach, 0.0));
        let label = canvas.label(
            beyond,
            (0.0, -4.0),
            12.0,
            &format!(
                "{} beams over {:.1}°",
                lidar.beams,
                (lidar.max_angle - lidar.min_angle).to_degrees()
            ),
        );
        canvas.push(label);
        let label = canvas.label(
            beyond,
            (0.0, 12.0),
            12.0,
            &format!("to {} m, {} Hz", metres(lidar.max_range), metres(lidar.rate_hz)),
        );
        canvas.push(label);
    }
    if let Some((camera, corners)) = &cone {
        // Beside the cone's left edge, where neither beams nor body are described.
        let text = format!(
            "camera: {:.1}° to {} m, {} Hz",
            camera.horizontal_fov.to_degrees(),
            metres(camera.far),
            metres(camera.rate_hz)
        );
        let label = canvas.label(corners[40], (0.0, -6.0), 12.0, &text);
        canvas.push(label);
    }
    let above = [Point::new(body.min.x, body.max.y), body.max];
    let width = match &robot.footprint {
        Outline::Circle { radius, .. } => format!("⌀ {} m", metres(2.0 * radius)),
        Outline::Polygon(_) => format!("{} m", metres(body.width())),
    };
    canvas.dimension(above[0], above[1], 24.0, &width);
    let left = Point::new(body.min.x, -half);
    let text = format!("{} m between wheels", metres(robot.drive.wheel_separation));
    canvas.dimension(left, Point::new(body.min.x, half), 22.0, &text);
    canvas.axes();
    let subtitle = format!(
        "from above; {} kg, body from {} to {} m above ground",
        metres(robot.mass),
        metres(robot.body_z[0]),
        metres(robot.body_z[1])
    );
    canvas.heading(&robot.name, &subtitle);
    let mut legend =
        vec![("footprint".to_owned(), "#d9d9d9", INK), ("wheels".to_owned(), "#555", "#555")];
    if robot.lidar.is_some() {
        legend.push(("field of view".to_owned(), "#e2ecf4", ACCENT));
    } else {
        legend.push(("no range scanner".to_owned(), "#fff", FAINT));
    }
    if cone.is_some() {
        legend.push(("logical camera".to_owned(), "#f8ebde", CONE));
    }
    canvas.legend(&legend);
    let title = format!("Robot {} from above", robot.name);
    match reach_sheet(robot) {
        Some(reach) => canvas.finish_above(reach, &title),
        None => canvas.finish(&title),
    }
}

/// Draws how far the sensors see, to scale with the body; `None` without any.
fn reach_sheet(robot: &Robot) -> Option<Canvas> {
    let mut views = Vec::new();
    if let Some(lidar) = &robot.lidar {
        let mut view = wedge(lidar.mount, lidar.min_angle, lidar.max_angle, lidar.max_range);
        if lidar.max_angle - lidar.min_angle < 6.2 {
            view.push(lidar.mount.position());
        }
        views.push((view, ACCENT, "5 4", 0.12));
    }
    if let Some(camera) = &robot.camera {
        let half = camera.horizontal_fov / 2.0;
        let mut view = wedge(camera.mount, -half, half, camera.far);
        view.extend(wedge(camera.mount, -half, half, camera.near).into_iter().rev());
        views.push((view, CONE, "2 3", 0.2));
    }
    let points = views.iter().flat_map(|(view, ..)| view.iter().copied());
    let bounds = points.fold(robot.footprint.bounds(), Bounds::including);
    let span = bounds.width().max(bounds.height());
    if views.is_empty() {
        return None;
    }
    let mut canvas = Canvas::new(bounds.grown(0.06 * span), 620.0, 480.0);
    canvas.raster();
    for (view, color, dash, opacity) in views {
        let view = canvas.path(&view, true).set("fill", color).set("fill-opacity", opacity);
        canvas.push(view.set("stroke", color).set("stroke-dasharray", dash));
    }
    let body = canvas.outline(&robot.footprint).set("fill", INK);
    canvas.push(body);
    canvas.axes();
    let of_lidar =
        robot.lidar.as_ref().map(|lidar| format!("scanner to {} m", metres(lidar.max_range)));
    let of_camera = robot.camera.as_ref().map(|camera| {
        format!("logical camera from {} to {} m", metres(camera.near), metres(camera.far))
    });
    let words: Vec<String> = of_lidar.into_iter().chain(of_camera).collect();
    canvas.heading("How far it sees", &format!("to scale with the body: {}", words.join(", ")));
    let mut legend = vec![("body".to_owned(), INK, INK)];
    if robot.lidar.is_some() {
        legend.push(("range scanner".to_owned(), "#e2ecf4", ACCENT));
    }
    if robot.camera.is_some() {
        legend.push(("logical camera".to_owned(), "#f8ebde", CONE));
    }
    canvas.legend(&legend);
    Some(canvas)
}

/// Returns the arc of `reach` m that the scanner looks along, in the base frame.
fn wedge(mount: Pose, min_angle: f64, max_angle: f64, reach: f64) -> Vec<Point> {
    (0..=48)
        .map(|i| {
            let (sin, cos) =
                math::sin_cos(min_angle + (max_angle - min_angle) * f64::from(i) / 48.0);
            mount.transform(Point::new(reach * cos, reach * sin))
        })
        .collect()
}
