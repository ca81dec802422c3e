//! One choice of the next location in a half explored office of 88 x 53 m: find frontiers, judge them, rank them. The range is
//! 25 m, cells are 0.1 m.
//!
//! `cargo bench --bench frontier_selection`. `choose` is what the study means by selecting a frontier; `inflate` and `plan` come
//! with it whenever the robot's mind chooses. Items are frontiers judged: noise of 0.1 m tears them into many.

use reenact::document::Source;
use reenact::geometry::{Outline, Point, Pose};
use reenact::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use reenact::mapping::{NoReturn, OccupancyMap, ScanRule};
use reenact::navigation::{CostGrid, Wavefront, inflate};
use reenact::rng::Seeds;
use reenact::robot::{Lidar, Robot, urdf};
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use reenact::studies::prior_map::choice::{Choice, Chooser, Sight};
use reenact::studies::prior_map::information_gain::AlignedPrior;
use reenact::studies::prior_map::utility::ranked;
use reenact::studies::prior_map::{Candidate, Gain, Parameters, View};
use std::sync::Arc;

fn main() {
    divan::main();
}

const KOBUKI: &str = include_str!("../robots/kobuki.urdf");
const SIZE: (f64, f64) = (88.0, 53.0);
const START: Pose = Pose { x: 82.0, y: 17.5, heading: std::f64::consts::PI };
const DOOR: f64 = 1.2;

/// Walls as rectangles (x0, y0, x1, y1): three rows of rooms along two corridors that a third one joins.
fn walls() -> Vec<[f64; 4]> {
    let (width, height) = SIZE;
    let mut walls = vec![
        [-0.15, -0.15, width + 0.15, 0.0],
        [-0.15, height, width + 0.15, height + 0.15],
        [-0.15, 0.0, 0.0, height],
        [width, 0.0, width + 0.15, height],
    ];
    // Walls along the corridors, with a door into every room and a gap where the corridors join.
    for y in [16.0, 19.0, 34.0, 37.0] {
        let joins = (18.0..35.0).contains(&y);
        let mut x = 0.0;
        while x < width {
            let door = x + 2.4;
            walls.push([x, y - 0.075, door, y + 0.075]);
            let end = (x + 6.0_f64).min(width);
            if !(joins && (42.0..48.0).contains(&x)) {
                walls.push([(door + DOOR).min(end), y - 0.075, end, y + 0.075]);
            }
            x += 6.0;
        }
    }
    // Walls between rooms; the third corridor runs at x = 42 to 48.
    for (low, high) in [(0.0, 16.0), (19.0, 34.0), (37.0, 53.0)] {
        let mut x = 6.0;
        while x < width {
            walls.push([x - 0.075, low, x + 0.075, high]);
            x += 6.0;
        }
    }
    walls.push([0.0, 26.4, 42.0, 26.6]);
    walls.push([48.0, 26.4, width, 26.6]);
    walls
}

/// Scans along the eastern half: the lower corridor, the rooms at it, the way to the upper corridor.
fn places() -> Vec<Pose> {
    let mut places = Vec::new();
    let mut x = 82.0;
    while x > 46.0 {
        places.push(Pose::new(x, 17.5, std::f64::consts::PI));
        x -= 1.0;
    }
    for room in 9..14 {
        let middle = 6.0 * f64::from(room) + 3.0;
        for (y, heading) in [(14.0, -1.57), (9.0, -1.57), (21.0, 1.57)] {
            places.push(Pose::new(middle, y, heading));
            places.push(Pose::new(middle, y, heading + 1.0));
        }
    }
    for y in [20.0, 24.0, 28.0, 32.0, 35.0] {
        places.push(Pose::new(45.0, y, 1.57));
    }
    places.extend([0.0, 1.0, 2.0].map(|turn| Pose::new(45.0, 35.5, turn)));
    places
}

/// A half explored office.
struct Office {
    map: OccupancyMap,
    costs: Arc<CostGrid>,
    lidar: Lidar,
    prior: OccupancyGrid,
    pose: Pose,
}

impl Office {
    fn half_explored() -> Self {
        let (robot, _) = urdf::read(&Source::new("kobuki.urdf", KOBUKI)).expect("it is shipped");
        let own = robot.lidar.clone().expect("it has one");
        let lidar = Lidar { max_range: 100.0, noise_sd: 0.1, ..own };
        let outline = |&[x0, y0, x1, y1]: &[f64; 4]| {
            let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
            Outline::Polygon(corners.map(|(x, y)| Point::new(x, y)).to_vec())
        };
        let walls = walls();
        let visible: Vec<Outline> = walls.iter().map(outline).collect();
        let rule = ScanRule {
            resolution: 0.1,
            clip_range: 25.0,
            hit_ratio: 0.25,
            no_return: NoReturn::Nothing,
        };
        let mut map = OccupancyMap::new(rule);
        let mut pose = Pose::default();
        for (number, place) in places().into_iter().enumerate() {
            let mut sim = simulator(&visible, &robot, &lidar, place, number);
            let mut scan = sim.blank_scan();
            sim.read_scan(&mut scan);
            pose = START.relative(place);
            map.integrate(pose, &scan);
        }
        let costs = Arc::new(inflate(map.grid(), 9));
        let frame =
            GridFrame { resolution: 0.1, origin: Point::new(-1.0, -1.0), width: 900, height: 550 };
        let mut prior = OccupancyGrid::filled(frame, Occupancy::Free);
        for [x0, y0, x1, y1] in walls {
            let (low, high) =
                (frame.cell_at(Point::new(x0, y0)), frame.cell_at(Point::new(x1, y1)));
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    prior.set(Cell::new(x, y), Occupancy::Occupied);
                }
            }
        }
        Self { map, costs, lidar, prior, pose }
    }

    fn sight(&self) -> Sight<'_> {
        Sight { map: &self.map, costs: &self.costs, pose: self.pose }
    }

    fn chooser(&self, name: &str) -> Chooser {
        let mut parameters = Parameters::default();
        parameters.mapping.clip_range_m = Some(25.0);
        let exploration = &mut parameters.exploration;
        let (way, prior) = name.split_once(", ").expect("names have two parts");
        match way {
            "released" => {
                exploration.gain = Gain::Released;
                exploration.candidate = Candidate::NearestToCentroid;
            }
            "on arrival" => exploration.view = View::OnArrival,
            "best view" => exploration.view = View::Best,
            _ => {}
        }
        let prior = (prior == "plan").then(|| AlignedPrior::new(&self.prior, START, 0.1));
        Chooser::new(&parameters, &self.lidar, prior)
    }
}

fn simulator(
    visible: &[Outline],
    robot: &Robot,
    lidar: &Lidar,
    place: Pose,
    number: usize,
) -> Simulator {
    let scene = Scene {
        visible,
        solid: &[],
        robot,
        lidar: lidar.clone(),
        camera: None,
        compass: None,
        start: place,
        drive_noise: DriveNoise::NONE,
        odometry_noise: OdometryNoise::NONE,
    };
    Simulator::new(scene, &Seeds::new(1, vec![("scan".to_owned(), number.to_string())]))
}

fn choose(chooser: &mut Chooser, sight: Sight<'_>) -> (Choice, Vec<usize>) {
    let frontiers = chooser.frontiers(sight);
    let choice = chooser.appraise(sight, frontiers);
    let order = ranked(&choice.utilities);
    (choice, order)
}

const WAYS: [&str; 6] = [
    "paper, none",
    "paper, plan",
    "released, none",
    "released, plan",
    "on arrival, plan",
    "best view, plan",
];

#[divan::bench(args = WAYS, sample_size = 1, sample_count = 200)]
fn choose_in_an_office(bencher: divan::Bencher<'_, '_>, name: &str) {
    let office = Office::half_explored();
    let mut chooser = office.chooser(name);
    let (choice, order) = choose(&mut chooser, office.sight());
    assert!(order.len() >= 8, "{} frontiers are too few to mean anything", order.len());
    assert!(choice.appraisals.iter().any(|a| a.gain > 1.0));
    bencher
        .counter(divan::counter::ItemsCount::new(order.len()))
        .bench_local(|| choose(&mut chooser, divan::black_box(office.sight())));
}

#[divan::bench(sample_size = 1, sample_count = 200)]
fn inflate_an_office(bencher: divan::Bencher<'_, '_>) {
    let office = Office::half_explored();
    bencher.bench_local(|| inflate(divan::black_box(office.map.grid()), 9));
}

/// From a frontier at the other end to the robot.
#[divan::bench(sample_size = 1, sample_count = 200)]
fn plan_across_an_office(bencher: divan::Bencher<'_, '_>) {
    let office = Office::half_explored();
    let frame = *office.costs.frame();
    let goal = frame.cell_at(START.relative(Pose::new(80.0, 17.5, 0.0)).position());
    let here = frame.cell_at(office.pose.position());
    bencher.bench_local(|| {
        let mut wave = Wavefront::from_goal(Arc::clone(&office.costs), goal, 75, 10.0);
        assert!(wave.metres(here).is_some(), "the corridors join");
        wave
    });
}
