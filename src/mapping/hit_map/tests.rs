use super::*;
use crate::mapping::tile::CELL_BITS;
use proptest::prelude::*;

const CELL: i32 = 1 << CELL_BITS;

fn place() -> impl Strategy<Value = Place> {
    // About the corner where four tiles meet, and so close together that means move and are as near as others.
    let near = |reach: i32| (-reach..reach, -reach..reach);
    let grid = (-80..80, -80..80).prop_map(|(x, y)| (16 * x, 16 * y));
    prop_oneof![near(2000), near(300), grid].prop_map(|(x, y)| Place { x, y })
}

/// Returns the squared distance (units) from `at` to the mean, rounded to steps, that is nearest to its quarter of
/// a cell, over all cells of the window.
fn by_definition(places: &[Place], at: Place, kernel: i32) -> Option<u32> {
    let cell = |p: Place| [p.x >> CELL_BITS, p.y >> CELL_BITS];
    let [x, y] = cell(at);
    let half = |v: i32| (v >> 7) * 16 + 8;
    let mut best: Option<((i32, i32, i32), i32)> = None;
    for cy in y - kernel..=y + kernel {
        for cx in x - kernel..=x + kernel {
            let here: Vec<_> = places.iter().filter(|p| cell(**p) == [cx, cy]).collect();
            let n = i32::try_from(here.len()).unwrap();
            if n == 0 {
                continue;
            }
            let mean = |of: fn(&Place) -> i32, c: i32| {
                (c * CELL + here.iter().map(|p| of(p) - c * CELL).sum::<i32>() / n) >> 3
            };
            let (mx, my) = (mean(|p| p.x, cx), mean(|p| p.y, cy));
            let to_quarter = (mx - half(at.x)).pow(2) + (my - half(at.y)).pow(2);
            let squared = (mx * 8 + 4 - at.x).pow(2) + (my * 8 + 4 - at.y).pow(2);
            if best.is_none_or(|(rank, _)| (to_quarter, mx, my) < rank) {
                best = Some(((to_quarter, mx, my), squared));
            }
        }
    }
    best.map(|(_, squared)| squared.unsigned_abs())
}

proptest! {
    #[test]
    fn one_look_up_tells_what_the_whole_window_would(
        scans in prop::collection::vec(prop::collection::vec(place(), 1..60), 1..6),
        asked in prop::collection::vec(place(), 50),
        kernel in 0_u32..3,
    ) {
        let mut map = HitMap::new(kernel);
        for scan in &scans {
            map.register(scan);
        }
        let all = scans.concat();
        let kernel = i32::try_from(kernel).unwrap();
        let window = ((kernel + 1) * CELL).pow(2) * 2;
        for at in asked.iter().chain(&all) {
            let found = map.squared_distance(*at);
            match by_definition(&all, *at, kernel) {
                Some(expected) => prop_assert_eq!(found, expected),
                None => prop_assert!(found > window.unsigned_abs()),
            }
        }
    }

    /// Checks copy on write: a change to one copy does not show in the other, and nothing is copied that is not
    /// written.
    #[test]
    fn a_copy_keeps_what_it_had(
        before in prop::collection::vec(place(), 1..20),
        after in prop::collection::vec(place(), 1..20),
    ) {
        let mut map = HitMap::new(1);
        map.register(&before);
        map.register(&[Place { x: 40_000, y: 0 }]);
        let copy = map.clone();
        map.register(&after);
        let mut alone = HitMap::new(1);
        alone.register(&before);
        for at in before.iter().chain(&after) {
            prop_assert_eq!(copy.squared_distance(*at), alone.squared_distance(*at));
        }
        let far = |map: &HitMap| std::ptr::from_ref(map.tile([40_000 >> (CELL_BITS + TILE_BITS), 0]).unwrap());
        prop_assert_eq!(far(&map), far(&copy));
    }
}
