//! The three plans drawn from memory after the department: their errors lie where those of the prior-knowledge study's own
//! drawings lie, which are measured in the same way where `REENACT_ORIGINAL_WORLDS` is set, and written down in
//! `worlds/README.md`. `cargo test --test integration hand_drawn:: -- --nocapture` prints the measurements.
#![expect(
    clippy::print_stdout,
    reason = "a skipped test says so, and measurements are for reading"
)]

mod sketch;

use crate::sandbox::repository;
use reenact::document::Source;
use reenact::grid::OccupancyGrid;
use reenact::provenance::Environment;
use reenact::world::floor_plan::{FloorPlanSettings, floor_plan};
use reenact::world::map_server::{self, Options};
use reenact::world::{World, document};
use sketch::{Errors, Sketch};

/// What the three released drawings measure (`worlds/README.md`), by the names of [`measures`].
const RELEASED: [(&str, [f64; 3]); 18] = [
    ("rooms", [22.0, 43.0, 23.0]),
    ("doors", [24.0, 50.0, 44.0]),
    ("width", [0.90, 0.87, 0.84]),
    ("height", [1.05, 0.88, 0.96]),
    ("rooms matched", [18.0, 30.0, 21.0]),
    ("rooms merged", [34.0, 20.0, 32.0]),
    ("rooms missing", [2.0, 4.0, 1.0]),
    ("area, 10 %", [1.11, 0.53, 0.74]),
    ("area, median", [2.19, 1.10, 1.01]),
    ("area, 90 %", [4.29, 1.68, 4.11]),
    ("displacement, median", [0.50, 0.40, 0.50]),
    ("displacement, 90 %", [4.95, 1.45, 2.90]),
    ("drawn walls right to 0.5 m", [0.48, 0.56, 0.49]),
    ("drawn walls right to 1 m", [0.71, 0.78, 0.75]),
    ("walls drawn to 0.5 m", [0.44, 0.56, 0.42]),
    ("walls drawn to 1 m", [0.67, 0.79, 0.66]),
    ("floor shared", [0.56, 0.69, 0.66]),
    ("floor in its own room", [0.46, 0.47, 0.45]),
];

/// Three drawings make a narrow range: ours may lie this share beyond its ends.
const BEYOND: f64 = 0.1;

/// Height of the study's lidar (m).
const LIDAR: f64 = 0.1602;

/// Draws the plan of our world `name` with walls and `layers`.
fn plan_of(name: &str, layers: &[&str]) -> OccupancyGrid {
    let path = repository().join(format!("worlds/{name}.yaml"));
    let layers: Vec<String> = layers.iter().map(|layer| (*layer).to_owned()).collect();
    let source = Source::new(name, std::fs::read_to_string(path).unwrap());
    let world: World = document::read(&source, Some(&layers)).unwrap_or_else(|faults| {
        panic!("{}", faults.iter().map(|f| f.render(false)).collect::<String>())
    });
    floor_plan(&world, FloorPlanSettings { height: LIDAR, resolution: 0.1, layers: None }).unwrap()
}

/// Returns the department as its floor plan shows it.
fn truth() -> Sketch {
    Sketch::of(&plan_of("department", &["partitions"]))
}

fn measures(of: &Errors) -> [(&'static str, f64); 18] {
    let count = |n: usize| f64::from(u32::try_from(n).unwrap());
    [
        ("rooms", count(of.rooms)),
        ("doors", count(of.doors)),
        ("width", of.width_ratio),
        ("height", of.height_ratio),
        ("rooms matched", count(of.matched)),
        ("rooms merged", count(of.merged)),
        ("rooms missing", count(of.missing)),
        ("area, 10 %", of.area_ratio[0]),
        ("area, median", of.area_ratio[1]),
        ("area, 90 %", of.area_ratio[2]),
        ("displacement, median", of.displacement_m[0]),
        ("displacement, 90 %", of.displacement_m[1]),
        ("drawn walls right to 0.5 m", of.precision[0]),
        ("drawn walls right to 1 m", of.precision[1]),
        ("walls drawn to 0.5 m", of.recall[0]),
        ("walls drawn to 1 m", of.recall[1]),
        ("floor shared", of.overlap),
        ("floor in its own room", of.same_room),
    ]
}

#[test]
fn the_released_drawings_err_as_written_down() {
    let Some(folder) = Environment::read().unwrap().original_worlds else {
        println!(
            "skipped: the_released_drawings_err_as_written_down needs REENACT_ORIGINAL_WORLDS"
        );
        return;
    };
    let truth = truth();
    // Origins as the release's descriptors note them.
    for (name, origin, number) in [
        ("ed21", "[-22, -18.25, 0]", None),
        ("ed21_1", "[-21, -14.75, 0]", Some(0)),
        ("ed21_2", "[-25, -17.75, 0]", Some(1)),
        ("ed21_3", "[-21, -14.75, 0]", Some(2)),
    ] {
        let yaml = format!(
            "image: {name}.png\nresolution: 0.1\norigin: {origin}\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n"
        );
        let bytes = std::fs::read(folder.join(format!("floorplans/{name}.png"))).unwrap();
        // Lines are drawn with soft edges: what is not free by its colours is wall.
        let map = map_server::read(
            &Source::new(name, yaml),
            &format!("{name}.png"),
            &bytes,
            Options { average_alpha: false },
        );
        let drawn = Sketch::of(&map.unwrap_or_else(|faults| panic!("{name}: {faults:?}")));
        let errors = drawn.errors(&truth);
        println!("{name}: {errors:.2?}");
        match number {
            // The true plan, drawn up to 0.4 m too large: what the measures make of no error.
            None => assert!(errors.matched >= 53 && errors.same_room > 0.95, "{errors:?}"),
            Some(number) => {
                for ((measure, value), (_, released)) in measures(&errors).iter().zip(RELEASED) {
                    let expected: f64 = released[number];
                    assert!(
                        (value - expected).abs() < 0.0051,
                        "{name}, {measure}: {value}, {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn our_drawings_err_as_the_released_ones_do() {
    let truth = truth();
    for number in 1..=3 {
        let name = format!("priors/hand-drawn-{number}");
        let errors = Sketch::of(&plan_of(&name, &[])).errors(&truth);
        println!("{name}: {errors:.2?}");
        for ((measure, value), (same, released)) in measures(&errors).iter().zip(RELEASED) {
            assert_eq!(*measure, same);
            let (least, most) =
                released.iter().fold((f64::MAX, f64::MIN), |(l, m), v| (v.min(l), v.max(m)));
            let (least, most) = (least * (1.0 - BEYOND), most * (1.0 + BEYOND));
            assert!(
                (least..=most).contains(value),
                "{name}, {measure}: {value}, expected {least} to {most}"
            );
        }
    }
}
