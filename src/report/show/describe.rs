//! What was understood, in words: a few lines of `key: value` for a terminal.

use super::graph::summary;
use super::graph_of;
use crate::figure::canvas::metres;
use crate::geometry::{Outline, Pose};
use crate::grid::{Occupancy, OccupancyGrid};
use crate::robot::{DriveKind, Robot};
use crate::world::topology::Topology;
use crate::world::{RegionKind, World};

/// Describes what was understood of a robot.
pub fn describe_robot(robot: &Robot) -> String {
    let footprint = match &robot.footprint {
        Outline::Circle { radius, .. } => format!("circle of radius {} m", metres(*radius)),
        Outline::Polygon(corners) => {
            let bounds = robot.footprint.bounds();
            format!(
                "{} corners, {} x {} m",
                corners.len(),
                metres(bounds.width()),
                metres(bounds.height())
            )
        }
    };
    let kind = match robot.drive.kind {
        DriveKind::Differential => "differential",
        DriveKind::SkidSteer => "skid steer",
    };
    let limit = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "no limit".to_owned(), |v| format!("at most {} {unit}", metres(v)))
    };
    let mut text = format!(
        "robot: {}\nfootprint: {footprint}\nbody: {} to {} m above ground, {} kg\n\
         drive: {kind}, wheels {} m apart and {} m in diameter, {}, {}\n",
        robot.name,
        metres(robot.body_z[0]),
        metres(robot.body_z[1]),
        metres(robot.mass),
        metres(robot.drive.wheel_separation),
        metres(robot.drive.wheel_diameter),
        limit(robot.drive.max_linear, "m/s"),
        limit(robot.drive.max_angular, "rad/s"),
    );
    match &robot.lidar {
        None => text.push_str("range scanner: none\n"),
        Some(lidar) => text.push_str(&format!(
            "range scanner: {} at ({}, {}) m, {:.4} m above ground, heading {:.1} deg\n\
             beams: {} from {:.1} to {:.1} deg, {:.4} deg apart, at {} Hz\n\
             ranges: {} to {} m, noise of {} m\n",
            lidar.name,
            metres(lidar.mount.x),
            metres(lidar.mount.y),
            lidar.height,
            lidar.mount.heading.to_degrees(),
            lidar.beams,
            lidar.min_angle.to_degrees(),
            lidar.max_angle.to_degrees(),
            lidar.increment().to_degrees(),
            metres(lidar.rate_hz),
            metres(lidar.min_range),
            metres(lidar.max_range),
            metres(lidar.noise_sd),
        )),
    }
    if let Some(camera) = &robot.camera {
        text.push_str(&format!(
            "logical camera: {} at ({}, {}) m, heading {:.1} deg, {:.1} deg wide, {} to {} m, {} Hz\n",
            camera.name,
            metres(camera.mount.x),
            metres(camera.mount.y),
            camera.mount.heading.to_degrees(),
            camera.horizontal_fov.to_degrees(),
            metres(camera.near),
            metres(camera.far),
            metres(camera.rate_hz),
        ));
    }
    if let Some(compass) = &robot.compass {
        text.push_str(&format!("compass: {}, {} Hz\n", compass.name, metres(compass.rate_hz)));
    }
    text.push_str(&format!("meaning: {}\n", robot.meaning()));
    text
}

/// Describes what was understood of a world that is cut at `lidar_height` m.
pub fn describe_world(world: &World, lidar_height: f64) -> String {
    let bounds = world.bounds();
    let mut text = format!(
        "world: {}\nsize: {} x {} m, x {} to {}, y {} to {}\n",
        world.name,
        metres(bounds.width()),
        metres(bounds.height()),
        metres(bounds.min.x),
        metres(bounds.max.x),
        metres(bounds.min.y),
        metres(bounds.max.y),
    );
    for layer in world.layers() {
        let of_layer = || world.solids.iter().filter(|solid| solid.layer == layer);
        let cut = of_layer().filter(|solid| !solid.body.slice(lidar_height).is_empty()).count();
        text.push_str(&format!(
            "layer {layer}: {} solids, {cut} of them at {lidar_height} m\n",
            of_layer().count()
        ));
    }
    let rooms = world.regions.iter().filter(|region| region.kind == RegionKind::Room).count();
    if !world.regions.is_empty() {
        text.push_str(&format!(
            "regions: {rooms} rooms, {} corridors\n",
            world.regions.len() - rooms
        ));
    }
    if !world.tags.is_empty() {
        text.push_str(&format!("tags: {}\n", world.tags.len()));
    }
    let graph = graph_of(world);
    match &graph {
        None => {}
        Some(Ok(graph)) => text.push_str(&format!("graph: {}\n", summary(graph))),
        Some(Err(faults)) => {
            let count = faults.len();
            text.push_str(&format!("graph: none, the tags break the convention {count} times\n"));
        }
    }
    let graph = graph.and_then(Result::ok);
    for (name, pose) in &world.starts {
        text.push_str(&format!(
            "start {name}: ({}, {}) m, heading {:.1} deg{}\n",
            metres(pose.x),
            metres(pose.y),
            pose.heading.to_degrees(),
            graph.as_ref().map_or_else(String::new, |graph| place(world, graph, *pose)),
        ));
    }
    for (name, goal) in &world.goals {
        text.push_str(&format!("goal {name}: ({}, {}) m\n", metres(goal.x), metres(goal.y)));
    }
    if let Some(lacks) = super::world::lacks(world) {
        text.push_str(&format!("{lacks}\n"));
    }
    text.push_str(&format!("warnings: {}\nmeaning: {}\n", world.warnings.len(), world.meaning()));
    text
}

/// Says where a start is in the graph: `, at C2c, 2 edges from the goal`.
fn place(world: &World, graph: &Topology, start: Pose) -> String {
    let Some(number) = graph.vertex_near(start.position(), 0.5) else {
        return ", at no vertex".to_owned();
    };
    let name = &graph.names(&world.regions)[number];
    match graph.distances_to_goal()[number] {
        Some(1) => format!(", at {name}, 1 edge from the goal"),
        Some(edges) => format!(", at {name}, {edges} edges from the goal"),
        None => format!(", at {name}, no way to a goal"),
    }
}

/// Describes what was understood of the map called `name`.
pub fn describe_grid(name: &str, grid: &OccupancyGrid) -> String {
    let (frame, bounds) = (grid.frame(), grid.frame().bounds());
    let mut text = format!(
        "map: {name}\nsize: {} x {} cells of {} m, {} x {} m\norigin: ({}, {}) m\n",
        frame.width,
        frame.height,
        frame.resolution,
        metres(bounds.width()),
        metres(bounds.height()),
        metres(frame.origin.x),
        metres(frame.origin.y),
    );
    for (value, word) in [
        (Occupancy::Occupied, "occupied"),
        (Occupancy::Free, "free"),
        (Occupancy::Unknown, "unknown"),
    ] {
        let count = grid.count(value);
        #[expect(clippy::cast_precision_loss, reason = "grids have fewer than 2^53 cells")]
        let area = count as f64 * frame.resolution * frame.resolution;
        text.push_str(&format!("{word}: {count} cells, {area:.1} m2\n"));
    }
    text
}
