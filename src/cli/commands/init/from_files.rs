//! A starter study of somebody's own robot, world and map, with what was understood of them as comments.

use crate::geometry::{Point, Pose};
use crate::report::show;
use crate::robot::Robot;
use crate::world::World;
use crate::world::floor::Floor;

/// Side of a map's cell (m): half as large for a small robot.
const RESOLUTIONS: [f64; 2] = [0.1, 0.05];
/// Robots whose radius (m) is less are small.
const SMALL: f64 = 0.15;
/// How much farther (of its radius) a robot stays from walls than it must, as the prior-knowledge study's did.
const MARGIN: f64 = 1.25;
/// The share of the inflation radius within which a cell's cost is lethal to the planner, at its default of 75 of 100.
const LETHAL_SHARE: f64 = 0.25;

/// A study's files, their paths as the manifest has them.
pub(super) struct Files<'a> {
    pub(super) name: &'a str,
    pub(super) robot_file: String,
    /// The value of `robot`: its file, perhaps with more.
    pub(super) robot_entry: String,
    pub(super) robot: &'a Robot,
    /// The value of `world` in flow style.
    pub(super) world_entry: String,
    pub(super) world_file: String,
    pub(super) world: &'a World,
    pub(super) map_file: Option<String>,
    pub(super) start: Pose,
}

impl Files<'_> {
    /// Writes the manifest.
    pub(super) fn manifest(&self) -> String {
        let Self { name, robot_file, robot_entry, robot, .. } = self;
        let Self { world_entry, world_file, world, map_file, start, .. } = self;
        let height = robot.lidar.as_ref().map_or(show::CUT_HEIGHT, |lidar| lidar.height);
        let height = (height * 1e4).round() / 1e4;
        let understood = |file: &str, text: &str| {
            // Digests and counts of faults are for programs, and go out of date.
            let lines = text
                .lines()
                .filter(|line| !["meaning:", "warnings:"].iter().any(|key| line.starts_with(key)));
            let lines: Vec<String> = lines.map(|line| format!("#   {line}")).collect();
            format!("# What was understood of {file}:\n{}\n", lines.join("\n"))
        };
        let robot_text = understood(robot_file, &show::describe_robot(robot));
        let world_text = understood(world_file, &show::describe_world(world, height));
        let (prior, prior_map, knows) = match map_file {
            Some(map) => ("map", format!("{{map: {map}, frame: world}}"), "its map"),
            None => ("floor-plan", "{floor-plan-of: world}".to_owned(), "its floor plan"),
        };
        let parameters = parameters(robot);
        format!(
            "# yaml-language-server: $schema={}\n# A study of a robot and a world of your own, written by `reenact init`: change anything and run it again.\n\
             # `reenact check` tells every fault; docs/manifest.md explains every key.\n#\n{robot_text}{world_text}\
             reenact: 1\nname: {name}\ntitle: Does a robot explore {} sooner with {knows}?\n\
             authors: [{{name: Your Name}}]\nlicense: CC-BY-4.0\n\n\
             study: prior-map\nseed: 1\ntrials: 10\nrobot: {robot_entry}\nworld: {world_entry}\n\
             start: {{x-m: {}, y-m: {}, heading-deg: {}}}\n\
             factors:\n  prior: [none, {prior}]\nlabels:\n  prior: {{values: {{none: no prior, {prior}: {}}}}}\nprior-maps:\n  {prior}: {prior_map}\n{parameters}\
             tables:\n  - id: distance\n    title: Distance travelled (m) at levels of coverage\n    \
             coverage-table: {{metric: distance-m, at: [70, 80, 90, 95], by: prior, baseline: none}}\n\
             figures:\n  - id: coverage\n    title: Coverage over time\n    coverage-curve: {{against: time-s, by: prior}}\n\
             claims:\n  - id: C1\n    ours: with {knows} the robot has covered 90 % after a shorter way than without\n    \
             expect: {{less: {{metric: distance-m-at-90, where: {{prior: {prior}}}, than: {{where: {{prior: none}}}}, test: mann-whitney, censored: worst}}}}\n",
            super::SCHEMA_NAME,
            world.name,
            start.x,
            start.y,
            start.heading.to_degrees(),
            prior.replace('-', " "),
        )
    }
}

/// Writes the parameters that follow from the robot's size and speed.
fn parameters(robot: &Robot) -> String {
    let radius = robot.circumscribed_radius();
    let resolution = if radius < SMALL { RESOLUTIONS[1] } else { RESOLUTIONS[0] };
    let cells = (MARGIN * radius / (LETHAL_SHARE * resolution)).ceil().max(1.0);
    let up = |length: f64| (length * 100.0).ceil() / 100.0;
    let mut text = format!(
        "parameters:\n  mapping:\n    resolution-m: {resolution}\n    hit-ratio: 0.25 # GMapping's own default\n  \
         navigation:\n    robot-radius-m: {} # the robot's is {radius:.3} m\n    inflation-radius-cells: {cells} # lethal up to {:.2} m\n",
        up(1.4 * radius),
        LETHAL_SHARE * cells * resolution,
    );
    for (key, unit, limit) in [
        ("max-linear-m-s", "m/s", robot.drive.max_linear),
        ("max-angular-rad-s", "rad/s", robot.drive.max_angular),
    ] {
        if let Some(limit) = limit.filter(|limit| *limit < 1.0) {
            text.push_str(&format!("    {key}: {limit} # the drive's limit ({unit})\n"));
        }
    }
    text
}

/// Chooses where the robot begins: in the largest room, with some air around it, as near to the world's middle as can be.
pub(super) fn start(robot: &Robot, world: &World) -> Option<Pose> {
    let solids = world.contact(robot.body_z[0], robot.body_z[1]);
    let bounds = world.bounds();
    let radius = robot.circumscribed_radius();
    let middle = Point::new(
        f64::midpoint(bounds.min.x, bounds.max.x),
        f64::midpoint(bounds.min.y, bounds.max.y),
    );
    let room = |air: f64| Floor::of(&solids, bounds, radius + air)?.largest_room()?.nearest(middle);
    let place = room(0.3).or_else(|| room(0.05))?;
    let rounded = |length: f64| (length * 100.0).round() / 100.0;
    Some(Pose::new(rounded(place.x), rounded(place.y), 0.0))
}
