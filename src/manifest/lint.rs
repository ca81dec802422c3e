//! What is well-formed and still wrong: starts inside walls, priors that lie elsewhere, slips of units.

mod surroundings;

use super::faults::Faults;
use super::knowledge::UsedPrior;
use super::worlds::WALLS;
use crate::document::quoted;
use crate::geometry::{Outline, Point, Pose};
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::math;
use crate::robot::Robot;
use crate::studies::Setup;
use crate::units::Tick;
use crate::world::World;
use serde_json::Value;
use std::f64::consts::TAU;
use surroundings::spot;

/// How far a prior's walls may lie from the world's (m) and still be taken for them.
const ALIGNED_WITHIN: f64 = 0.3;
/// The share of walls below which a prior is taken to lie elsewhere.
const ALIGNED_SHARE: f64 = 0.5;

/// Collects what is wrong or suspicious about one condition of whatever study; about its start where that `is_new`, and about
/// what surrounds it where the world is somebody's, `from_file`.
pub(super) fn check(setup: &Setup, is_new: bool, from_file: bool, faults: &mut Faults<'_>) {
    scanner(setup.robot(), faults);
    if is_new {
        start(setup.world(), setup.robot(), setup.start(), faults);
        if from_file {
            surroundings::check(setup, faults);
        }
    }
    units(&setup.parameters(), faults);
}

fn scanner(robot: &Robot, faults: &mut Faults<'_>) {
    let name = &robot.name;
    let Some(lidar) = &robot.lidar else {
        let fault = faults
            .fault("/robot", format!("the robot `{name}` has no range scanner"))
            .label("this study explores with one");
        faults.push(fault.help(
            "give it one in the manifest: `robot: {file, lidar: {beams: ..., min-angle-deg: ..., ...}}`, or name another robot",
        ));
        return;
    };
    if Tick::period_of(lidar.rate_hz).is_none() {
        let message = format!("the scanner `{}` runs at {} Hz", lidar.name, lidar.rate_hz);
        let fault = faults.fault("/robot", message).label("not a whole number of clock ticks");
        faults.push(fault.help("use a rate that divides 3000 Hz, such as 10, 20, 30 or 40"));
    }
}

pub(super) fn start(world: &World, robot: &Robot, start: Pose, faults: &mut Faults<'_>) {
    let at = start.position();
    let radius = robot.circumscribed_radius();
    let nearest = world.nearest(at, robot.body_z[0], robot.body_z[1]);
    if let Some((solid, far)) = nearest.filter(|(_, far)| *far <= radius) {
        let (named, what) = match solid.name.as_str() {
            "" => (String::new(), "the nearest obstacle".to_owned()),
            name => (format!(", `{}`,", quoted(name)), format!("`{}`", quoted(name))),
        };
        let fault = faults.fault(
            "/start",
            format!("the robot starts inside something solid{named} at {}", spot(at)),
        );
        let label = format!("{far:.2} m to {what}, the robot's radius is {radius:.2} m");
        let help = "move the start, or leave out what stands there (`layers`; of a Gazebo world `without`)";
        faults.push(fault.label(label).help(help));
        return;
    }
    if !world.bounds().contains(at) {
        let fault = faults
            .fault("/start", format!("the robot starts outside the building at {}", spot(at)));
        let bounds = world.bounds();
        let help = format!("the world reaches from {} to {}", spot(bounds.min), spot(bounds.max));
        faults.push(fault.label("beyond every wall").help(help).warning());
    }
}

/// Warns of values that look as if they were written in another unit, by the unit in their key.
fn units(parameters: &Value, faults: &mut Faults<'_>) {
    for (group, values) in parameters.as_object().into_iter().flatten() {
        for (key, value) in values.as_object().into_iter().flatten() {
            let Some(value) = value.as_f64() else { continue };
            let slip = if key.ends_with("-rad-s") || key.ends_with("-m-s") {
                (value.abs() > 20.0).then_some("faster than any robot here")
            } else if key.ends_with("-rad") {
                (value.abs() > TAU).then_some("more than a full turn: is this in degrees?")
            } else if key.ends_with("-m") {
                (value.abs() > 200.0).then_some("more than 200 m: is this in millimetres?")
            } else if key.ends_with("-s") {
                (value.abs() > 1e6).then_some("more than 11 days: is this in milliseconds?")
            } else {
                None
            };
            if let Some(label) = slip {
                let pointer = format!("/parameters/{group}/{key}");
                let message = format!("`{group}.{key}` is {value}");
                let fault = faults.fault(&pointer, message).label(label);
                faults.push(fault.warning());
            }
        }
    }
}

/// Reports where a prior map must be resampled to the robot's `map` (m).
pub(super) fn resolution(map: f64, prior: &UsedPrior, faults: &mut Faults<'_>) {
    let own = prior.grid.frame().resolution;
    if own != map {
        let message = format!("the prior map has cells of {own} m, the robot's map of {map} m");
        let fault = faults.fault(&prior.pointer, message).label("is resampled");
        faults.push(fault.help("`parameters.mapping.resolution-m` sets the robot's").warning());
    }
}

/// Holds the walls of a prior map against those of the world.
pub(super) fn alignment(robot: &Robot, world: &World, prior: &UsedPrior, faults: &mut Faults<'_>) {
    let Some(lidar) = &robot.lidar else { return };
    let solids = &world.solids;
    let has_walls = solids.iter().any(|solid| solid.layer == WALLS);
    let outlines: Vec<Outline> = solids
        .iter()
        .filter(|solid| !has_walls || solid.layer == WALLS)
        .flat_map(|solid| solid.body.slice(lidar.height))
        .collect();
    let grid = &prior.grid;
    let walls = along(&outlines, grid.frame().resolution);
    let drawn: Vec<Point> = grid
        .frame()
        .cells()
        .filter(|&cell| grid.at(cell) == Occupancy::Occupied)
        .map(|cell| grid.frame().center(cell))
        .collect();
    if walls.is_empty() || drawn.is_empty() {
        return;
    }
    let near_drawn = share(&walls, |point| near(grid, point));
    // The other way round, a footprint matches too: it draws some of the walls, all of them true.
    let near_wall =
        share(&drawn, |point| outlines.iter().any(|o| o.distance(point) <= ALIGNED_WITHIN));
    if near_drawn.max(near_wall) >= ALIGNED_SHARE {
        return;
    }
    let percent = (near_drawn * 100.0).round();
    let message = if near_drawn == 0.0 && near_wall == 0.0 {
        "the prior map does not overlap the world".to_owned()
    } else {
        format!(
            "the prior map fits the world badly: {percent} % of the walls have one of its own within {ALIGNED_WITHIN} m"
        )
    };
    let scaled = surroundings::scale(&drawn, &walls);
    let label = match scaled {
        Some(factor) => format!("it is {factor:.2} times as large as the world"),
        None => "shifted, scaled or of another building".to_owned(),
    };
    let help = match scaled {
        Some(_) => "check `resolution`; `reenact show --over` lays the map over the world",
        None => "check `origin` and `frame`; `reenact show --over` lays the map over the world",
    };
    faults.push(faults.fault(&prior.pointer, message).label(label).help(help).warning());
}

fn share(points: &[Point], holds: impl Fn(Point) -> bool) -> f64 {
    let count = points.iter().filter(|&&point| holds(point)).count();
    #[expect(clippy::cast_precision_loss, reason = "counts of cells")]
    let share = count as f64 / points.len() as f64;
    share
}

/// Returns whether the grid has an occupied cell within reach of `point`.
fn near(grid: &OccupancyGrid, point: Point) -> bool {
    let resolution = grid.frame().resolution;
    #[expect(clippy::cast_possible_truncation, reason = "a few cells")]
    let reach = (ALIGNED_WITHIN / resolution).ceil().min(64.0) as i32;
    let center = grid.frame().cell_at(point);
    (-reach..=reach).any(|dy| {
        (-reach..=reach).any(|dx| {
            let cell = Cell::new(center.x.saturating_add(dx), center.y.saturating_add(dy));
            grid.at(cell) == Occupancy::Occupied
                && grid.frame().center(cell).distance(point) <= ALIGNED_WITHIN + resolution / 2.0
        })
    })
}

/// Returns points along the outlines, `spacing` m apart.
fn along(outlines: &[Outline], spacing: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for outline in outlines {
        if let Outline::Circle { center, radius } = outline {
            for i in 0..16 {
                let (sin, cos) = math::sin_cos(TAU * f64::from(i) / 16.0);
                points.push(*center + Point::new(cos, sin) * *radius);
            }
        }
        for side in outline.sides() {
            let length = side.a.distance(side.b);
            #[expect(clippy::cast_possible_truncation, reason = "walls are short")]
            let steps = (length / spacing).ceil().clamp(1.0, 1e5) as i32;
            for i in 0..steps {
                let t = f64::from(i) / f64::from(steps);
                points.push(side.a + (side.b - side.a) * t);
            }
        }
    }
    points
}
