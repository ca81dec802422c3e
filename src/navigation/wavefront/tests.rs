//! Waves against relaxation of every step, from scratch and following changes.

use super::*;
use crate::geometry::Point;
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use proptest::prelude::*;

fn open(width: i32, height: i32) -> CostGrid {
    let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width, height };
    let mut costs = CostGrid::unknown(frame);
    for cell in frame.cells() {
        costs.set(cell, 0);
    }
    costs
}

/// Lets `wave` follow to `costs`, told of what differs.
fn follow(wave: &mut Wavefront, costs: &CostGrid) -> bool {
    let (old, new) = (wave.costs.padded(), costs.padded());
    let changed: Vec<u32> =
        (0_u32..).zip(old.iter().zip(new)).filter(|(_, (a, b))| a != b).map(|(i, _)| i).collect();
    wave.costs = Arc::new(costs.clone());
    wave.follow(&changed)
}

#[test]
fn open_ground_has_plain_distances() {
    let mut wave = Wavefront::from_goal(Arc::new(open(20, 20)), Cell::new(2, 2), 75, 10.0);
    assert_eq!(wave.metres(Cell::new(12, 2)), Some(1.0));
    assert!((wave.metres(Cell::new(12, 12)).unwrap() - 1.4).abs() < 1e-9);
    assert_eq!(wave.path(Cell::new(5, 5)).len(), 4);
    assert!(wave.path(Cell::new(99, 0)).is_empty());
}

#[test]
fn danger_is_avoided_where_a_detour_is_cheaper() {
    let mut costs = open(20, 9);
    for y in 2..7 {
        costs.set(Cell::new(10, y), 70);
    }
    let costs = Arc::new(costs);
    let mut wave = Wavefront::from_goal(Arc::clone(&costs), Cell::new(18, 4), 75, 10.0);
    let path = wave.path(Cell::new(2, 4));
    assert!(path.iter().all(|&cell| costs.cost(cell) == Some(0)), "{path:?}");
}

#[test]
fn a_blocked_goal_is_approached_and_a_walled_one_is_not_reached() {
    let mut costs = open(30, 30);
    costs.set(Cell::new(15, 15), 100);
    let mut wave = Wavefront::from_goal(Arc::new(costs.clone()), Cell::new(15, 15), 75, 10.0);
    assert_eq!(wave.distance(Cell::new(12, 12)), 0);
    for x in 0..30 {
        costs.set(Cell::new(x, 5), 100);
    }
    let mut wave = Wavefront::from_goal(Arc::new(costs), Cell::new(15, 20), 75, 10.0);
    assert_eq!(wave.metres(Cell::new(15, 2)), None);
}

#[test]
fn a_change_far_from_the_goal_is_followed_and_one_beside_it_is_not() {
    let mut costs = open(40, 40);
    let goal = Cell::new(3, 3);
    let mut wave = Wavefront::from_goal(Arc::new(costs.clone()), goal, 75, 10.0);
    wave.distance(Cell::new(39, 39));
    for y in 0..12 {
        costs.set(Cell::new(20, y), 100);
    }
    assert!(follow(&mut wave, &costs));
    let mut anew = Wavefront::from_goal(Arc::new(costs.clone()), goal, 75, 10.0);
    for cell in costs.frame().cells() {
        assert_eq!(wave.distance(cell), anew.distance(cell), "{cell:?}");
    }
    costs.set(Cell::new(5, 5), 100);
    assert!(!follow(&mut wave, &costs));
}

#[test]
fn what_hung_on_a_cell_before_it_came_nearer_is_forgotten_with_it() {
    let mut costs = open(30, 20);
    for cell in costs.frame().cells() {
        let is_long = cell.y == 3 && (10..=25).contains(&cell.x)
            || (3..12).contains(&cell.y) && [10, 25].contains(&cell.x);
        if !is_long && cell.y != 12 && cell.x > 8 {
            costs.set(cell, 100);
        }
    }
    let goal = Cell::new(2, 12);
    // The end of the corridor is first reached by the long detour, ...
    costs.set(Cell::new(20, 12), 100);
    let mut wave = Wavefront::from_goal(Arc::new(costs.clone()), goal, 75, 10.0);
    assert_ne!(wave.distance(Cell::new(29, 12)), UNREACHED);
    // ... then straight ahead, which its last cells have not heard of, ...
    costs.set(Cell::new(20, 12), 0);
    assert!(follow(&mut wave, &costs));
    wave.distance(Cell::new(25, 12));
    // ... and then not at all.
    costs.set(Cell::new(20, 12), 100);
    costs.set(Cell::new(25, 8), 100);
    assert!(follow(&mut wave, &costs));
    assert_eq!(wave.distance(Cell::new(29, 12)), UNREACHED);
}

/// Computes distances by relaxing every step until nothing changes (Bellman 1958).
fn by_relaxation(costs: &CostGrid, goal: Cell, lethal: u8) -> Vec<u32> {
    let frame = *costs.frame();
    let mut distances = crate::grid::Grid::filled(frame, UNREACHED);
    distances.set(goal, 0);
    loop {
        let before = distances.clone();
        for cell in frame.cells().filter(|&cell| costs.is_below(cell, lethal)) {
            let factor = 1.0 + f64::from(costs.cost(cell).unwrap_or(0)) / 10.0;
            for (i, from) in cell.neighbours8().into_iter().enumerate() {
                let Some(there) = distances.get(from).filter(|&d| d != UNREACHED) else {
                    continue;
                };
                let plain = if i % 2 == 0 { 20.0 } else { 28.0 };
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small"
                )]
                let through = there + (plain * factor).round() as u32;
                if distances.get(cell).is_some_and(|here| through < here) {
                    distances.set(cell, through);
                }
            }
        }
        if distances == before {
            return distances.values().to_vec();
        }
    }
}

proptest! {
    /// Checks that in whatever order cells are queried, distances are the least, and every reached cell has a path
    /// down.
    #[test]
    fn distances_are_the_least_and_paths_end_at_the_goal(
        walls in prop::collection::vec((0..15, 0..15, 0_u8..100), 0..80),
        asked in prop::collection::vec((0..15, 0..15, 0..3), 0..20),
    ) {
        let mut costs = open(15, 15);
        for (x, y, cost) in walls {
            costs.set(Cell::new(x, y), cost);
        }
        let goal = Cell::new(7, 7);
        costs.set(goal, 0);
        let least = by_relaxation(&costs, goal, 75);
        let costs = Arc::new(costs);
        let mut wave = Wavefront::from_goal(Arc::clone(&costs), goal, 75, 10.0);
        for (x, y, how) in asked {
            let cell = Cell::new(x, y);
            let distance = least[costs.frame().index(cell).unwrap()];
            match how {
                0 => prop_assert_eq!(wave.distance(cell), distance),
                1 => prop_assert_eq!(wave.reaches(cell), distance != UNREACHED),
                _ if distance == UNREACHED => prop_assert!(wave.path(cell).is_empty()),
                _ => prop_assert_eq!(wave.path(cell).last().copied(), Some(goal)),
            }
        }
        for (index, &distance) in least.iter().enumerate() {
            prop_assert_eq!(wave.distance(costs.frame().cell_of(index)), distance);
        }
        // In the same memory, to another goal.
        let goal = Cell::new(2, 3);
        let ground = Arc::clone(&costs).into();
        let mut again = Wavefront::in_memory_of(Some(wave), ground, goal, 101, 10.0);
        for (index, distance) in by_relaxation(&costs, goal, 101).into_iter().enumerate() {
            prop_assert_eq!(again.distance(costs.frame().cell_of(index)), distance);
        }
    }

    /// Checks that a wave that follows changes, wherever they are and however far it has come, is that from scratch.
    #[test]
    fn a_wave_that_follows_changes_is_that_from_scratch(
        walls in prop::collection::vec((0..30, 0..20, 0_u8..100), 0..150),
        rounds in prop::collection::vec(
            (prop::collection::vec((0..30, 0..20, 0_u8..100), 1..8), 0..30, 0..20),
            1..6,
        ),
    ) {
        let mut costs = open(30, 20);
        for (x, y, cost) in walls {
            costs.set(Cell::new(x, y), cost);
        }
        let goal = Cell::new(2, 2);
        costs.set(goal, 0);
        let mut wave = Wavefront::from_goal(Arc::new(costs.clone()), goal, 75, 10.0);
        for (changes, x, y) in rounds {
            wave.distance(Cell::new(x, y));
            for (x, y, cost) in changes {
                costs.set(Cell::new(x, y), cost);
            }
            costs.set(goal, 0);
            if !follow(&mut wave, &costs) {
                wave = Wavefront::in_memory_of(Some(wave), Arc::new(costs.clone()).into(), goal, 75, 10.0);
            }
            let mut whole = wave.clone();
            for (index, distance) in by_relaxation(&costs, goal, 75).into_iter().enumerate() {
                prop_assert_eq!(whole.distance(costs.frame().cell_of(index)), distance);
            }
        }
    }
}

#[test]
fn a_wave_over_a_map_is_told_of_what_changes_in_it() {
    let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: 150, height: 150 };
    let mut map = OccupancyGrid::filled(frame, Occupancy::Free);
    let mut inflated = InflatedMap::new(3);
    let (offset, goal, robot) = (Cell::new(0, 0), Cell::new(20, 20), Cell::new(140, 140));
    let ground = inflated.update(&map, offset, &[], []);
    let mut wave = Wavefront::from_goal(ground, goal, 75, 10.0);
    for at in [Cell::new(80, 80), Cell::new(100, 90), Cell::new(60, 70)] {
        assert_ne!(wave.distance(robot), UNREACHED);
        map.set(at, Occupancy::Occupied);
        let resting = wave.rest();
        let ground = inflated.update(&map, offset, &[], [at]);
        assert!(
            inflated.changes_since(resting.0.moment).is_some_and(|changes| !changes.is_empty())
        );
        wave = Wavefront::instead_of(resting, &inflated, ground.clone(), goal, 75, 10.0);
        let mut anew = Wavefront::from_goal(ground, goal, 75, 10.0);
        for cell in frame.cells() {
            assert_eq!(wave.distance(cell), anew.distance(cell), "{cell:?}");
        }
    }
}
