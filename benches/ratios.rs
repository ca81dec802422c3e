//! Ratios that tell whether something became slow again: what is done in a hot loop beside the plain way of doing the same, in one
//! process and in turns, so that the machine and its mood cancel out. Each is held against the least it may be in `ratios.csv`.
//!
//! `cargo bench --bench ratios` ends with an error where one is missed. `.ci/full` runs it.

#[expect(dead_code, reason = "each benchmark looks at what it is about")]
mod driving;
mod shipped;

use driving::Drive;
use reenact::geometry::{Outline, Point, Pose};
use reenact::grid::Cell;
use reenact::mapping::OccupancyMap;
use reenact::navigation::{InflatedMap, Wavefront, inflate};
use reenact::robot::Lidar;
use reenact::sim::WallSweep;
use reenact::stats::summary::median;
use reenact::studies::TrialSpec;
use reenact::studies::prior_map::Setup;
use reenact::studies::prior_map::choice::{Chooser, Sight};
use reenact::units::Tick;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// The least that each ratio may be.
const KEPT: &str = include_str!("ratios.csv");
/// Both ways are taken in turns so many times.
const TURNS: usize = 15;
const INFLATED: u32 = 9;

/// A part of a trial: what a mind knew at each of its keyframes on one frame of the map.
struct Passage<'a> {
    spec: &'a TrialSpec,
    setup: &'a Setup,
    lidar: Lidar,
    walls: Vec<Outline>,
    states: Vec<State>,
}

struct State {
    map: OccupancyMap,
    changes: Vec<Cell>,
    pose: Pose,
}

#[expect(clippy::print_stdout, reason = "what was measured")]
fn main() -> ExitCode {
    let plan = shipped::plan("prior-tables-1-6.yaml");
    let spec =
        plan.find("described_office_false_floor-plan/0").expect("the manifest has this trial");
    let passage = Passage::of(spec);
    let measured = [
        ("rays: every wall for every beam / sweep", passage.rays()),
        ("costs: inflated anew / around changes", passage.costs()),
        ("wave: from scratch / following changes", passage.waves()),
        ("gains: estimated anew / remembered", passage.gains()),
        ("noise: scan without / scan with", passage.noise()),
    ];
    let mut is_kept = true;
    println!("{:45} {:>7} {:>9}", "ratio", "now", "at least");
    for (name, ratio) in measured {
        let row = KEPT.lines().find_map(|row| row.strip_prefix(name)?.strip_prefix(','));
        let least: f64 = row.and_then(|least| least.parse().ok()).expect("ratios.csv has a row");
        let note = if ratio < least { "  SLOWER" } else { "" };
        println!("{name:45} {ratio:7.2} {least:9.2}{note}");
        is_kept &= ratio >= least;
    }
    ExitCode::from(u8::from(!is_kept))
}

/// Returns how many times longer `plain` takes than `quick`: the median over all turns.
#[expect(clippy::disallowed_methods, reason = "the time is what is measured")]
fn ratio(mut plain: impl FnMut(), mut quick: impl FnMut()) -> f64 {
    let took = |work: &mut dyn FnMut()| {
        let begun = Instant::now();
        work();
        begun.elapsed().as_secs_f64()
    };
    let ratios: Vec<f64> = (0..TURNS).map(|_| took(&mut plain) / took(&mut quick)).collect();
    median(&ratios)
}

impl<'a> Passage<'a> {
    /// Lets a mind explore for five minutes, and keeps the keyframes since its map grew last.
    fn of(spec: &'a TrialSpec) -> Self {
        let mut drive = Drive::new(spec);
        let mut states = Vec::<State>::new();
        while drive.mind.ending().is_none() && drive.sim.now() < Tick(300 * 3000) {
            let Some(changes) = drive.step().changes else { continue };
            let map = drive.mind.map().clone();
            if states.last().is_some_and(|last| last.map.grid().frame() != map.grid().frame()) {
                states.clear();
            }
            states.push(State { map, changes, pose: drive.sim.odometry_at_scan().pose });
        }
        assert!(states.len() > 10, "{} keyframes are too few to mean anything", states.len());
        let Drive { setup, lidar, .. } = drive;
        Self { spec, setup, walls: setup.world.slice(lidar.height), lidar, states }
    }

    fn sensors(&self) -> impl Iterator<Item = Pose> {
        let start = self.setup.start;
        self.states.iter().map(move |state| start.compose(state.pose).compose(self.lidar.mount))
    }

    fn rays(&self) -> f64 {
        let sweep = WallSweep::new(&self.walls, &self.lidar);
        let mut ranges = Vec::new();
        let every_wall =
            || self.sensors().for_each(|sensor| self.try_every_wall(black_box(sensor)));
        ratio(every_wall, || {
            self.sensors().for_each(|sensor| sweep.cast(black_box(sensor), &mut ranges));
        })
    }

    fn try_every_wall(&self, sensor: Pose) {
        for beam in 0..self.lidar.beams {
            let angle =
                sensor.heading + self.lidar.min_angle + self.lidar.increment() * f64::from(beam);
            let direction = Point::new(reenact::math::cos(angle), reenact::math::sin(angle));
            let sides = self.walls.iter().flat_map(Outline::sides);
            let ranges = sides.filter_map(|side| side.ray_range(sensor.position(), direction));
            black_box(ranges.fold(f64::INFINITY, f64::min));
        }
    }

    fn costs(&self) -> f64 {
        let anew = || {
            for state in &self.states {
                black_box(inflate(state.map.grid(), INFLATED));
            }
        };
        ratio(anew, || {
            let mut inflated = InflatedMap::new(INFLATED);
            for State { map, changes, .. } in &self.states {
                let changes = changes.iter().copied();
                black_box(inflated.update(map.grid(), map.offset(), &[], changes));
            }
        })
    }

    /// Waves from where the robot began to where it is, over costs that are kept current by both ways.
    fn waves(&self) -> f64 {
        let start = Pose::default().position();
        let goal = self.states[0].map.grid().frame().cell_at(start);
        let robot = |state: &State| state.map.grid().frame().cell_at(state.pose.position());
        let update = |inflated: &mut InflatedMap, State { map, changes, .. }: &State| {
            inflated.update(map.grid(), map.offset(), &[], changes.iter().copied())
        };
        let anew = || {
            let mut inflated = InflatedMap::new(INFLATED);
            for state in &self.states {
                let ground = update(&mut inflated, state);
                black_box(Wavefront::from_goal(ground, goal, 75, 10.0).distance(robot(state)));
            }
        };
        ratio(anew, || {
            let mut inflated = InflatedMap::new(INFLATED);
            let mut resting = None;
            for state in &self.states {
                let ground = update(&mut inflated, state);
                let mut wave = match resting {
                    None => Wavefront::from_goal(ground, goal, 75, 10.0),
                    Some(wave) => Wavefront::instead_of(wave, &inflated, ground, goal, 75, 10.0),
                };
                black_box(wave.distance(robot(state)));
                resting = Some(wave.rest());
            }
        })
    }

    fn gains(&self) -> f64 {
        let Self { setup, lidar, states, .. } = self;
        let prior = driving::prior(setup);
        let chooser = || Chooser::new(&setup.parameters, lidar, prior.clone());
        let costs: Vec<_> =
            states.iter().map(|state| inflate(state.map.grid(), INFLATED)).collect();
        let sights = || {
            let sight = |(state, costs)| {
                let State { map, pose, .. }: &State = state;
                Sight { map, costs, pose: *pose }
            };
            states.iter().zip(&costs).map(sight)
        };
        let frontiers: Vec<_> = sights().map(|sight| chooser().frontiers(sight)).collect();
        let anew = || {
            for (sight, frontiers) in sights().zip(&frontiers) {
                black_box(chooser().appraise(sight, frontiers.clone()));
            }
        };
        ratio(anew, || {
            let mut chooser = chooser();
            for (sight, frontiers) in sights().zip(&frontiers) {
                black_box(chooser.appraise(sight, frontiers.clone()));
            }
        })
    }

    fn noise(&self) -> f64 {
        let scan_with = |noise_sd: f64| {
            let lidar = Lidar { noise_sd, ..self.lidar.clone() };
            let mut sim = driving::simulator(self.spec, &lidar);
            let mut scan = sim.blank_scan();
            move || (0..200).for_each(|_| sim.read_scan(black_box(&mut scan)))
        };
        ratio(scan_with(0.0), scan_with(0.1))
    }
}
