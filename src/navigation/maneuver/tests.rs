//! The parts of the pilot on scans of known walls. Closed-loop driving is tested in `tests/maneuvers.rs`, where there
//! is a simulator.

use super::corridor::sides;
use super::door::{Gap, find};
use super::guard::Guard;
use super::heading::{Heading, walls};
use super::outlook::Outlook;
use super::*;
use crate::geometry::{Bounds, Outline, Pose};
use crate::math;
use crate::rng::Seeds;
use crate::robot::Twist;
use std::f64::consts::{FRAC_PI_2, PI};

const MOUNT: Pose = Pose { x: 0.16, y: 0.0, heading: 0.0 };
const BODY: Bounds = Bounds { min: Point::new(-0.254, -0.2485), max: Point::new(0.254, 0.2485) };

/// Returns a scan of 181 beams from the base at `base`, with 5 mm of noise.
fn scan(visible: &[Outline], base: Pose) -> Scan {
    drawn(visible, base, 3)
}

/// Returns the scan of `visible` from `base` with noise of 5 mm, the draw that belongs to `seed`.
fn drawn(visible: &[Outline], base: Pose, seed: u64) -> Scan {
    let sensor = base.compose(MOUNT);
    let mut noise = Seeds::new(seed, vec![]).stream("test");
    let mut scan = Scan {
        stamp: Tick(0),
        mount: MOUNT,
        min_angle: -FRAC_PI_2,
        increment: PI / 180.0,
        min_range: 0.05,
        max_range: 8.0,
        ranges: Vec::new(),
    };
    for i in 0..181 {
        let (sin, cos) = math::sin_cos(sensor.heading + scan.angle(i));
        let range = visible
            .iter()
            .flat_map(Outline::sides)
            .filter_map(|side| side.ray_range(sensor.position(), Point::new(cos, sin)))
            .fold(f64::INFINITY, f64::min);
        let noisy = range + 0.005 * noise.normal();
        scan.ranges.push(if range <= 8.0 { noisy } else { f64::INFINITY });
    }
    scan
}

fn outlook(visible: &[Outline], base: Pose) -> Outlook {
    read(&scan(visible, base))
}

fn read(scan: &Scan) -> Outlook {
    let mut outlook = Outlook::default();
    outlook.read(scan);
    outlook
}

/// Returns the view from `base`, in the frame of a leg to the east.
fn ahead(visible: &[Outline], base: Pose) -> Outlook {
    turned(&outlook(visible, base), base)
}

fn turned(outlook: &Outlook, base: Pose) -> Outlook {
    let mut ahead = Outlook::default();
    ahead.turn(outlook, base.heading);
    ahead
}

/// Returns a box between two corners.
fn block(x: [f64; 2], y: [f64; 2]) -> Outline {
    let center = Point::new(f64::midpoint(x[0], x[1]), f64::midpoint(y[0], y[1]));
    Outline::rectangle(center, x[1] - x[0], y[1] - y[0], 0.0)
}

/// Returns walls 0.15 m thick across the east at x = 3, with gaps between `gaps`, in a room 8 m wide.
fn wall_with(gaps: &[[f64; 2]]) -> Vec<Outline> {
    let mut walls = vec![block([-2.0, 8.0], [4.0, 4.2]), block([-2.0, 8.0], [-4.2, -4.0])];
    walls.push(block([7.0, 7.2], [-4.0, 4.0]));
    let mut from = -4.0;
    for gap in gaps {
        walls.push(block([3.0, 3.15], [from, gap[0]]));
        from = gap[1];
    }
    walls.push(block([3.0, 3.15], [from, 4.0]));
    walls
}

#[test]
fn walls_tell_the_heading_but_for_the_quarter() {
    let room = [
        block([-3.0, 5.0], [2.0, 2.2]),
        block([-3.0, 5.0], [-3.2, -3.0]),
        block([5.0, 5.2], [-3.0, 2.0]),
        block([-3.2, -3.0], [-3.0, 2.0]),
    ];
    for degrees in [-170.0, -93.0, -44.0, -10.0, 0.0, 3.0, 40.0, 88.0, 135.5] {
        let heading = f64::to_radians(degrees);
        let seen = walls(&outlook(&room, Pose::new(0.3, 0.2, heading))).unwrap();
        let off = math::wrap_angle(4.0 * (seen + heading)) / 4.0;
        assert!(off.abs() < 0.01, "{degrees}: {off}");
    }
    let corners = (0..48).map(|i| {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(i) / 48.0);
        Point::new(3.0 * cos, 3.0 * sin)
    });
    let round = [Outline::Polygon(corners.collect())];
    assert_eq!(walls(&outlook(&round, Pose::default())), None, "nothing is square");
    assert_eq!(walls(&outlook(&[], Pose::default())), None, "nothing is seen");
}

#[test]
fn the_heading_follows_commands_compass_and_walls() {
    let rule = PilotRule::default();
    let mut heading = Heading::UNKNOWN;
    // Off by 9 degrees, in a building seen at 0.02 rad.
    heading.update(&rule, 0.0, FRAC_PI_2 - 0.02 + 0.157, Some(0.02));
    assert!((heading.get() - (FRAC_PI_2 - 0.02)).abs() < 1e-12, "{}", heading.get());
    // A quarter turn, of which the walls show a fifth more than was commanded.
    for step in 1..=20 {
        let truth = FRAC_PI_2 - 0.02 + 0.094 * f64::from(step);
        heading.update(&rule, 0.078, truth, Some(math::wrap_angle(-4.0 * truth) / 4.0));
    }
    let truth = FRAC_PI_2 - 0.02 + 1.88;
    assert!(math::wrap_angle(heading.get() - truth).abs() < 0.05, "{}", heading.get());

    let compass_only = PilotRule { heading: HeadingSource::Compass, ..rule };
    let mut heading = Heading::UNKNOWN;
    let mut noise = Seeds::new(1, vec![]).stream("compass");
    let mut worst = 0.0_f64;
    for step in 0..600 {
        heading.update(&compass_only, 0.0, PI + noise.between(-0.157, 0.157), Some(0.3));
        if step > 100 {
            worst = worst.max(math::wrap_angle(heading.get() - PI).abs());
        }
    }
    // 5.2 degrees of one reading, by sqrt(g / (2 - g)) at a gain of 0.05, are 0.8; four of these.
    assert!(worst < 0.06, "{worst}");
}

#[test]
fn the_middle_of_a_corridor_is_between_its_walls_whatever_opens_in_them() {
    // 2.2 m wide; a door into a room on the left, a side corridor on the right.
    let corridor = [
        block([-3.0, 0.3], [1.1, 1.3]),
        block([1.2, 8.0], [1.1, 1.3]),
        block([-3.0, 8.0], [4.0, 4.2]),
        block([-3.0, 0.5], [-1.3, -1.1]),
        block([2.5, 8.0], [-1.3, -1.1]),
        block([0.5, 2.5], [-6.2, -6.0]),
    ];
    for (y, heading) in [(0.0, 0.0), (0.2, 0.17), (-0.3, -0.17)] {
        let [left, right] = sides(&ahead(&corridor, Pose::new(0.0, y, heading)), 3.0);
        let (left, right) = (left.unwrap(), right.unwrap());
        assert!(
            (left - (1.1 - y)).abs() < 0.02 && (right - (1.1 + y)).abs() < 0.02,
            "{left} {right}"
        );
    }
    let one_wall = ahead(&corridor[..2], Pose::default());
    assert_eq!(sides(&one_wall, 3.0)[1], None);
    // A wall across the leg is no wall on either side.
    let across = ahead(&[block([3.0, 3.2], [-4.0, 4.0])], Pose::default());
    assert_eq!(sides(&across, 6.0), [None, None]);
}

#[test]
fn a_door_is_found_from_near_and_far_and_from_aside() {
    let rule = PilotRule::default();
    let walls = wall_with(&[[-0.15, 0.75]]);
    for (x, y, heading) in
        [(0.0, 0.0, 0.0), (1.9, 0.0, 0.0), (1.9, -0.2, 0.17), (2.4, 0.3, 0.0), (2.0, 0.8, -0.3)]
    {
        // One beam more or less beside an edge moves it by the 3 cm between beams there: what counts is the mean.
        let base = Pose::new(x, y, heading);
        let draws: Vec<Gap> = (0..20)
            .map(|seed| {
                let ahead = turned(&read(&drawn(&walls, base, seed)), base);
                find(&ahead, &rule, 0.0, 10.0).unwrap_or_else(|| panic!("none from ({x}, {y})"))
            })
            .collect();
        let mean = |of: fn(&Gap) -> f64| draws.iter().map(of).sum::<f64>() / 20.0;
        let (distance, middle, width) =
            (mean(|g| g.distance), mean(|g| g.middle), mean(|g| g.width));
        assert!((distance - (3.0 - x)).abs() < 0.03, "({x}, {y}): {distance}");
        assert!((middle - (0.3 - y)).abs() < 0.03, "({x}, {y}): {middle}");
        assert!((width - 0.9).abs() < 0.08, "({x}, {y}): {width}");
        for Gap { middle, width, .. } in draws {
            assert!((middle - (0.3 - y)).abs() < 0.04, "({x}, {y}): {middle}");
            assert!((width - 0.9).abs() < 0.08, "({x}, {y}): {width}");
        }
    }
}

#[test]
fn only_what_is_as_wide_as_a_door_and_on_the_way_is_one() {
    let rule = PilotRule::default();
    let seen = |gaps: &[[f64; 2]], expected, limit| {
        find(&ahead(&wall_with(gaps), Pose::new(1.0, 0.0, 0.0)), &rule, expected, limit)
            .map(|gap| gap.middle)
    };
    assert_eq!(seen(&[], 0.0, 10.0), None, "closed");
    assert_eq!(seen(&[[-0.25, 0.25]], 0.0, 10.0), None, "too narrow");
    assert_eq!(seen(&[[-1.0, 1.0]], 0.0, 10.0), None, "too wide");
    assert_eq!(seen(&[[0.6, 1.5]], 0.0, 10.0), None, "out of reach");
    assert_eq!(seen(&[[-0.45, 0.45]], 0.0, 1.5), None, "behind the vertex that it leads to");
    let two = [[-1.3, -0.4], [0.2, 1.1]];
    assert!((seen(&two, 0.5, 10.0).unwrap() - 0.65).abs() < 0.03);
    assert!((seen(&two, -0.5, 10.0).unwrap() + 0.85).abs() < 0.03);
}

#[test]
fn the_guard_brakes_before_contact_and_lets_a_door_be_passed() {
    let rule = PilotRule::default();
    let mut guard = Guard::default();
    let forward = Twist { linear: 0.6, angular: 0.0 };
    let mut limited = |points: &[(f64, f64)], command| {
        let points = points.iter().map(|&(x, y)| Point::new(x, y));
        guard.limit(&rule, BODY, points, command)
    };
    // 0.6 m/s for half a second is 0.3 m, and 0.03 m must be left.
    assert_eq!(limited(&[(0.60, 0.0)], forward), forward);
    assert_eq!(limited(&[(0.50, 0.0)], forward).linear, 0.6 * 0.6);
    assert_eq!(limited(&[(0.28, 0.1)], forward), Twist::STOP);
    // Jambs 0.05 m beside the body; then one of them 0.02 m.
    assert_eq!(limited(&[(0.4, 0.30), (0.4, -0.30)], forward), forward);
    assert_eq!(limited(&[(0.4, 0.27)], forward).linear, 0.6 * 0.3);
    // A point already beside the body does not come nearer.
    assert_eq!(limited(&[(0.1, 0.27)], forward), forward);
    // Turning left sweeps the front right corner; backing off is free.
    let left = Twist { linear: 0.0, angular: 0.9 };
    assert_eq!(limited(&[(0.29, -0.20)], left), Twist::STOP);
    assert_eq!(limited(&[(0.45, -0.20)], left), left);
    let back = Twist { linear: -0.15, angular: 0.0 };
    assert_eq!(limited(&[(0.26, 0.0)], back), back);
    let blind = PilotRule { guard_s: 0.0, ..rule };
    let contact = [Point::new(0.26, 0.0)].into_iter();
    assert_eq!(Guard::default().limit(&blind, BODY, contact, forward), forward);
}

#[test]
fn a_pilot_turns_to_its_leg_and_then_drives() {
    let footprint = Outline::rectangle(Point::ZERO, 0.508, 0.497, 0.0);
    let mut pilot = Pilot::new(PilotRule::default(), &footprint);
    let corridor = [block([-9.0, 9.0], [1.1, 1.3]), block([-9.0, 9.0], [-1.3, -1.1])];
    let command = |pilot: &mut Pilot, heading| {
        let scan = scan(&corridor, Pose::new(0.0, 0.0, heading));
        let compass = CompassReading { stamp: Tick(0), heading };
        pilot.control(&Sense { scan: &scan, compass, target: None })
    };
    assert_eq!(command(&mut pilot, 0.0), Twist::STOP, "no leg");
    assert!(pilot.is_standing());
    let limits = PilotRule::default().slow;
    pilot.begin(Leg { direction: FRAC_PI_2, opening: Opening::Corridor, limits });
    assert_eq!(command(&mut pilot, 0.0), Twist { linear: 0.0, angular: 0.5 });
    assert!(pilot.is_turning_in_place());
    pilot.begin(Leg { direction: 0.0, opening: Opening::Corridor, limits });
    command(&mut pilot, 0.0);
    let twist = command(&mut pilot, 0.0);
    assert!(twist.linear > 0.3 && twist.angular.abs() < 0.1, "{twist:?}");
    assert!(!pilot.is_turning_in_place() && !pilot.is_standing());
}

#[test]
fn rules_are_written_with_units_and_unknown_keys_are_refused() {
    let rule: PilotRule = serde_json::from_str("{\"clearance-m\": 0.1}").unwrap();
    assert_eq!(rule, PilotRule { clearance_m: 0.1, ..PilotRule::default() });
    assert!(serde_json::from_str::<PilotRule>("{\"clearance\": 0.1}").is_err());
}
