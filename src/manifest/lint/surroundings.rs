//! A robot and a world that do not go together: doors too narrow, goals behind walls, scanners that see over or short of
//! everything, lengths in another unit.

use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::manifest::faults::Faults;
use crate::robot::Robot;
use crate::studies::Setup;
use crate::world::World;
use crate::world::floor::{Floor, Reach};
use serde_json::Value;

/// A body (m) that gets through whatever is meant to be gone through.
const NARROW: f64 = 0.1;
/// The share of the floor that a robot may leave out because it is wide, and the cells' own error.
const MAY_MISS: f64 = 0.1;
/// The range (m) of the longest scanners.
const LONGEST_RANGE: f64 = 1000.0;
/// Sizes (m) between which worlds are.
const SIZES: [f64; 2] = [1.0, 1000.0];

/// Collects what is suspicious about the robot of `setup` in its world, which is from a file.
pub(super) fn check(setup: &Setup, faults: &mut Faults<'_>) {
    let (world, robot, start) = (setup.world(), setup.robot(), setup.start());
    let parameters = setup.parameters();
    let parameter = |pointer: &str| parameters.pointer(pointer).and_then(Value::as_f64);
    let bounds = world.bounds();
    size(bounds, faults);
    if let Some(deadline) = parameter("/mission/deadline-s") {
        too_early(world, robot, start, deadline, faults);
    }
    let Some(lidar) = &robot.lidar else { return };
    if lidar.max_range > LONGEST_RANGE {
        let message = format!("the scanner `{}` sees {} m far", lidar.name, lidar.max_range);
        let label = "farther than any scanner: is it in millimetres?";
        faults.push(faults.fault("/robot", message).label(label).warning());
    }
    let visible = world.slice(lidar.height);
    if visible.is_empty() {
        over_everything(world, &lidar.name, lidar.height, faults);
        return;
    }
    let solids = world.contact(robot.body_z[0], robot.body_z[1]);
    let radius = robot.circumscribed_radius();
    let reach = |radius: f64| -> Option<Reach> {
        Some(Floor::of(&solids, bounds, radius)?.reached_from(start.position()))
    };
    let (Some(narrow), Some(own)) = (reach(NARROW.min(radius)), reach(radius)) else { return };
    if own.is_empty() {
        return;
    }
    if !own.is_closed() {
        let message = "the world is open: from its start the robot gets past every wall";
        let label = "exploring it goes on outside for as long as the time limit lets it";
        let help = "close it with a wall, or say when enough is seen with `mission.stop-at-coverage-percent`";
        let fault = faults.fault("/world", message.to_owned()).label(label).help(help);
        faults.push(fault.warning());
    }
    goals(world, &own, radius, faults);
    let misses = 1.0 - own.covers(&narrow, 2.0 * radius + 0.2);
    if narrow.is_closed() && misses > MAY_MISS {
        let message = format!(
            "the robot is too wide for {:.0} % of the floor that is open from its start",
            100.0 * misses
        );
        let label = format!("a disc of {radius:.2} m around its base gets nowhere near it");
        let fault = faults.fault("/robot", message).label(label);
        faults.push(fault.help("`reenact show` draws robot and world to scale").warning());
    }
    let range = parameter("/sensing/range-m").unwrap_or(lidar.max_range);
    short_sighted(&own, &visible, range, faults);
}

fn size(bounds: Bounds, faults: &mut Faults<'_>) {
    let extent = bounds.width().max(bounds.height());
    if bounds.is_empty() || (SIZES[0]..=SIZES[1]).contains(&extent) {
        return;
    }
    let (small, unit) = (
        extent < SIZES[0],
        if extent < SIZES[0] { "kilometres" } else { "centimetres or millimetres" },
    );
    let message = format!("the world is {extent:.3} m across");
    let label =
        format!("{} than any building: is it in {unit}?", if small { "smaller" } else { "larger" });
    faults.push(faults.fault("/world", message).label(label).warning());
}

/// Reports a scan plane that meets nothing.
fn over_everything(world: &World, name: &str, height: f64, faults: &mut Faults<'_>) {
    let over = world.contact(0.0, height).len();
    if world.solids.is_empty() {
        return;
    }
    let message =
        format!("the scanner `{name}` sees nothing of this world: it looks along {height:.2} m");
    let label = if over > 0 { "above everything solid" } else { "below everything solid" };
    let fault = faults.fault("/robot", message).label(label);
    faults.push(fault.help("`reenact show --height` draws the world at any height").warning());
}

fn goals(world: &World, own: &Reach, radius: f64, faults: &mut Faults<'_>) {
    for (name, goal) in &world.goals {
        if !own.gets_near(*goal, radius + 0.5) {
            let message = format!("the robot cannot get from its start to the goal `{name}`");
            let label = format!("nothing of the floor around {} is open to it", spot(*goal));
            let fault = faults.fault("/start", message).label(label);
            faults.push(fault.help("move goal or start, or open a door").warning());
        }
    }
}

/// Warns of a deadline (s) by which no robot can be at the nearest goal.
fn too_early(world: &World, robot: &Robot, start: Pose, deadline: f64, faults: &mut Faults<'_>) {
    let Some(speed) = robot.drive.max_linear.filter(|speed| *speed > 0.0) else { return };
    let distances = world.goals.values().map(|goal| goal.distance(start.position()));
    let nearest = distances.fold(f64::INFINITY, f64::min);
    let least = nearest / speed;
    if nearest.is_finite() && least > deadline {
        let message = format!("no way to a goal takes as little as the deadline of {deadline} s");
        let label = format!(
            "the nearest is {nearest:.1} m away, and the robot drives {speed} m/s: {least:.0} s at least"
        );
        let fault = faults.fault("/parameters/mission/deadline-s", message).label(label);
        faults.push(fault.warning());
    }
}

/// Warns of a range that ends before the walls of the widest room.
fn short_sighted(own: &Reach, visible: &[Outline], range: f64, faults: &mut Faults<'_>) {
    if !own.is_closed() {
        return;
    }
    let Some((place, distance)) = own.loneliest(visible) else { return };
    if range >= distance {
        return;
    }
    let message =
        format!("the scanner's range of {range} m ends before the walls of the widest room");
    let label = format!("from {} the nearest is {distance:.1} m away", spot(place));
    let help =
        "with `mapping.no-return: nothing` a robot that sees no wall learns nothing and gives up";
    faults.push(faults.fault("/robot", message).label(label).help(help).warning());
}

/// Returns where `point` is, in words.
pub(super) fn spot(point: Point) -> String {
    format!("({:.2}, {:.2}) m", point.x, point.y)
}

/// Says by which factor a prior of the size `drawn` is another's than the world's `true_size`, where it is one.
pub(super) fn scale(drawn: &[Point], walls: &[Point]) -> Option<f64> {
    let bounds = |points: &[Point]| points.iter().fold(Bounds::EMPTY, |b, p| b.including(*p));
    let (drawn, walls) = (bounds(drawn), bounds(walls));
    let (across, along) = (drawn.width() / walls.width(), drawn.height() / walls.height());
    let factor = (across * along).sqrt();
    let is_scaled = factor.is_finite()
        && (across / along - 1.0).abs() < 0.1
        && !(0.85..=1.15).contains(&factor);
    is_scaled.then_some(factor)
}
