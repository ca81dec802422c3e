//! Error and time of the particle filter on a tour of the office: 500 m along the way of an exploring robot, with odometry
//! that ends metres off. Prints one line a seed, then median and worst.
//!
//! `cargo bench --bench slam_tour -- [seeds (10)] [range noise (m, 0.01)] [particles (30)] [sigma (m^2, 0.01)]`
//!
//! Errors are absolute errors of position (root mean square over the scans taken in, in the start's frame, nothing aligned):
//! of the pose known at the time, of the best particle's whole way in the end, and of odometry alone.

#![expect(clippy::print_stdout, reason = "a benchmark prints")]
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers"
)]

mod shipped;

use reenact::geometry::{Outline, Point, Pose};
use reenact::mapping::{
    FilterRule, KeyframeRule, Mapper, MatchRule, MotionNoise, NoReturn, ScanRule, Showing,
};
use reenact::rng::Seeds;
use reenact::robot::{Lidar, Robot, Twist};
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use reenact::studies::{self, prior_map};
use reenact::units::Tick;

/// Length of the tour (m).
const TOUR: f64 = 500.0;
/// Side of a cell (m), and the longest usable range (m).
const RESOLUTION: f64 = 0.05;
const RANGE: f64 = 25.0;
/// Odometry's errors: 1 % of a metre per square root of metre, 0.012 rad per square root of radian.
const ODOMETRY: OdometryNoise = OdometryNoise { distance: 0.01, heading: 0.012 };

/// GMapping's numbers as the study's real robot had them, but for `sigma` (0.05 there).
fn filter(particles: u32, sigma: f64) -> FilterRule {
    FilterRule {
        particles,
        motion: MotionNoise { srr: 0.1, srt: 0.2, str: 0.1, stt: 0.2 },
        matching: MatchRule { sigma, ..MatchRule::GMAPPING },
        likelihood_gain: 3.0,
        resample_threshold: 0.5,
    }
}

/// What GMapping (openslam_gmapping 5105476, -O3) needed per processed scan on such a tour, with as many particles, cells and
/// beams: measured on 2026-11-28 in turns with this benchmark, which then needed 5.9 ms (benches/README.md). On another machine
/// the ratio says how many times, not how many percent.
const GMAPPING_MILLISECONDS: f64 = 53.0;

/// What is common to all seeds.
struct Tour {
    robot: Robot,
    lidar: Lidar,
    walls: Vec<Outline>,
    way: Vec<Pose>,
}

impl Tour {
    /// The first 500 m of the way of a robot that explores the office without prior knowledge.
    fn of_an_explorer() -> Self {
        let plan = shipped::plan("prior-tables-1-6.yaml");
        let spec = plan.find("described_office_false_none/0").expect("the manifest has this trial");
        let Some(setup) = spec.setup.of::<prior_map::Setup>() else {
            panic!("of the prior-map study")
        };
        let (_, recording) = studies::reenact(spec);
        let frames = recording.frames.iter().take_while(|frame| frame.distance_m <= TOUR);
        Self::along(setup, frames.map(|frame| frame.pose).collect())
    }

    fn along(setup: &prior_map::Setup, way: Vec<Pose>) -> Self {
        let own = setup.robot.lidar.clone().expect("the robot has a scanner");
        Self {
            robot: (*setup.robot).clone(),
            walls: setup.world.slice(own.height),
            lidar: Lidar { beams: 180, max_range: 100.0, ..own },
            way,
        }
    }

    fn simulator(&self, range_noise: f64, seeds: &Seeds) -> Simulator {
        let scene = Scene {
            visible: &self.walls,
            solid: &self.walls,
            robot: &self.robot,
            lidar: Lidar { noise_sd: range_noise, ..self.lidar.clone() },
            camera: None,
            compass: None,
            start: self.way[0],
            drive_noise: DriveNoise::NONE,
            odometry_noise: ODOMETRY,
        };
        Simulator::new(scene, seeds)
    }
}

#[derive(Debug, Default)]
struct Drive {
    scans: usize,
    online: f64,
    in_the_end: f64,
    odometry: f64,
    odometry_at_end: f64,
    milliseconds: Vec<f64>,
    /// On the processor alone, where the system tells it: what others do on the machine counts less.
    cpu_milliseconds: f64,
    contacts: u32,
}

fn drive(tour: &Tour, range_noise: f64, filter: FilterRule, seed: u64) -> Drive {
    let seeds = Seeds::new(seed, vec![]);
    let mut sim = tour.simulator(range_noise, &seeds);
    let mut scan = sim.blank_scan();
    let mut mapper = Mapper::new(
        KeyframeRule { distance: 1.0, turn: 0.5 },
        ScanRule {
            resolution: RESOLUTION,
            clip_range: RANGE,
            hit_ratio: 0.25,
            no_return: NoReturn::Nothing,
        },
        filter,
        seeds.stream("slam"),
    );
    let mut result = Drive::default();
    let mut truth = Vec::new();
    let mut next = 0;
    let mut next_command = Tick(0);
    loop {
        if sim.now() == sim.odometry_at_scan().stamp {
            let odometry = sim.odometry_at_scan().pose;
            if mapper.wants(odometry) {
                sim.read_scan(&mut scan);
                #[expect(clippy::disallowed_methods, reason = "a benchmark looks at the clock")]
                let (begun, cpu) = (std::time::Instant::now(), cpu_milliseconds());
                mapper.integrate(odometry, &scan, Showing::WhenDue);
                let elapsed = begun.elapsed().as_secs_f64() * 1000.0;
                result.milliseconds.push(elapsed);
                result.cpu_milliseconds +=
                    cpu.zip(cpu_milliseconds()).map_or(elapsed, |(before, after)| after - before);
                let here = tour.way[0].relative(sim.true_pose());
                let squared = |pose: Pose| squared_distance(pose, here);
                result.online += squared(mapper.pose(odometry));
                result.odometry += squared(odometry);
                result.odometry_at_end = squared(odometry).sqrt();
                truth.push(here);
            }
        }
        if sim.now() >= next_command {
            next_command = sim.now() + Tick(300);
            let here = sim.true_pose();
            while next < tour.way.len() && near(here, tour.way[next].position()) {
                next += 1;
            }
            let Some(target) = tour.way.get(next) else { break };
            sim.command(towards(here, target.position()));
        }
        let until = next_command.min(sim.next_scan());
        sim.advance_to(until);
    }
    result.scans = truth.len();
    let way = mapper.way();
    result.in_the_end =
        truth.iter().zip(&way).map(|(&truth, &pose)| squared_distance(truth, pose)).sum();
    for sum in [&mut result.online, &mut result.in_the_end, &mut result.odometry] {
        *sum = (*sum / truth.len() as f64).sqrt();
    }
    result.contacts = sim.contacts();
    result
}

/// Time this thread has had on a processor, where Linux tells it.
fn cpu_milliseconds() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds / 1e6)
}

fn squared_distance(a: Pose, b: Pose) -> f64 {
    let off = a.position() - b.position();
    off.x * off.x + off.y * off.y
}

fn near(here: Pose, there: Point) -> bool {
    here.position().distance(there) < 0.25
}

/// Turns to what lies aside, and drives to what lies ahead.
fn towards(here: Pose, there: Point) -> Twist {
    let to = here.inverse_transform(there);
    let bearing = reenact::math::atan2(to.y, to.x);
    let linear = if bearing.abs() > 0.5 { 0.0 } else { 0.8 };
    Twist { linear, angular: (2.0 * bearing).clamp(-1.0, 1.0) }
}

fn middle(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

fn main() {
    let numbers: Vec<f64> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let seeds = numbers.first().map_or(10, |n| *n as u64);
    let range_noise = numbers.get(1).copied().unwrap_or(0.01);
    let particles = numbers.get(2).map_or(30, |n| *n as u32);
    let sigma = numbers.get(3).copied().unwrap_or(0.01);
    let tour = Tour::of_an_explorer();
    println!(
        "{particles} particles, range noise {range_noise} m, sigma {sigma} m^2, {} places on the way",
        tour.way.len()
    );
    println!(
        "seed  scans  ATE online  in the end  odometry (at end)   ms/scan  p50   p95   max  contacts"
    );
    let mut results = Vec::new();
    for seed in 0..seeds {
        let r = drive(&tour, range_noise, filter(particles, sigma), seed);
        let ms = |share| middle(r.milliseconds.clone(), share);
        println!(
            "{seed:4} {:6} {:11.3} {:11.3} {:9.2} ({:6.2}) {:9.2} {:5.2} {:5.2} {:6.1} {:4}",
            r.scans,
            r.online,
            r.in_the_end,
            r.odometry,
            r.odometry_at_end,
            r.milliseconds.iter().sum::<f64>() / r.scans as f64,
            ms(0.5),
            ms(0.95),
            ms(1.0),
            r.contacts,
        );
        results.push(r);
    }
    for (what, share) in [("median", 0.5), ("worst", 1.0)] {
        let of = |value: fn(&Drive) -> f64| middle(results.iter().map(value).collect(), share);
        println!(
            "{what}: ATE online {:.3} m, in the end {:.3} m, odometry {:.2} m, online / odometry {:.3}",
            of(|r| r.online),
            of(|r| r.in_the_end),
            of(|r| r.odometry),
            of(|r| r.online / r.odometry),
        );
    }
    let all: Vec<f64> = results.iter().flat_map(|r| r.milliseconds.clone()).collect();
    let cpu = results.iter().map(|r| r.cpu_milliseconds).sum::<f64>() / all.len() as f64;
    println!(
        "time per processed scan: mean {:.2} ms, p50 {:.2}, p95 {:.2}; on the processor {cpu:.2} ms",
        all.iter().sum::<f64>() / all.len() as f64,
        middle(all.clone(), 0.5),
        middle(all.clone(), 0.95),
    );
    println!(
        "{:.1} times less than GMapping's {GMAPPING_MILLISECONDS} ms",
        GMAPPING_MILLISECONDS / cpu
    );
}
