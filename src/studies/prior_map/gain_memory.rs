//! Information gains that still hold, because nothing that decided them has changed: far from the robot most do.

use super::information_gain::InformationGain;
use crate::grid::{Cell, CellSet, Run};

/// The gains of the last choice, and the map on which they were estimated.
#[derive(Debug, Default)]
pub(super) struct GainMemory {
    last: Option<InformationGain>,
    known: Vec<Known>,
}

#[derive(Debug)]
struct Known {
    /// The lattice cell of the location p.
    p: Cell,
    /// What is known of each part of what is seen from there.
    parts: Vec<Option<Part>>,
}

#[derive(Debug)]
struct Part {
    /// How many cells count.
    cells: u32,
    /// The lattice cells whose state decided it.
    examined: Box<[Run]>,
}

impl GainMemory {
    /// Returns I(p) of every location of `locations`, cells of the map of `state`, as `count` gives it: the cells that count, part
    /// by part, of `parts`.
    ///
    /// A count is a function of the location, of the part and of the cells that it adds to the list it gets. It is asked for
    /// where one of these changed, or where the location was none at the last choice.
    pub(super) fn gains(
        &mut self,
        state: InformationGain,
        locations: &[Cell],
        parts: usize,
        count: impl Fn(&InformationGain, usize, Cell, &mut Vec<Run>) -> u32,
    ) -> Vec<f64> {
        let changes = self.last.as_ref().map(|last| state.changes_since(last));
        let holds = |part: &mut Part| {
            let has_changed =
                |changes: &CellSet| part.examined.iter().any(|&run| changes.has_any(run));
            !changes.as_ref().is_some_and(has_changed)
        };
        let mut earlier = std::mem::take(&mut self.known);
        let mut examined = Vec::new();
        let mut gain = |&location: &Cell| {
            let p = state.lattice(location);
            let mut known = match earlier.iter().position(|known| known.p == p) {
                Some(i) => earlier.swap_remove(i),
                None => Known { p, parts: (0..parts).map(|_| None).collect() },
            };
            let mut cells = 0;
            for (number, part) in known.parts.iter_mut().enumerate() {
                let kept = part.take_if(holds);
                let part = part.insert(kept.unwrap_or_else(|| {
                    examined.clear();
                    let cells = count(&state, number, location, &mut examined);
                    Part { cells, examined: examined.as_slice().into() }
                }));
                cells += part.cells;
            }
            self.known.push(known);
            state.area(cells)
        };
        let gains = locations.iter().map(&mut gain).collect();
        self.last = Some(state);
        gains
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::grid::{GridFrame, Occupancy, OccupancyGrid, QUADRANTS};
    use proptest::prelude::*;
    use std::cell::Cell as Counter;

    const SIDE: i32 = 60;

    fn state(map: &OccupancyGrid, offset: Cell) -> InformationGain {
        InformationGain::new(map, offset, None, 20, true)
    }

    /// Returns an unknown map with a room of free cells on the left and one on the right of a wall.
    fn rooms() -> OccupancyGrid {
        let frame = GridFrame { resolution: 0.1, origin: Point::ZERO, width: SIDE, height: SIDE };
        let mut map = OccupancyGrid::filled(frame, Occupancy::Unknown);
        for cell in frame.cells().filter(|cell| (20..40).contains(&cell.y)) {
            map.set(cell, if cell.x == 30 { Occupancy::Occupied } else { Occupancy::Free });
        }
        map
    }

    proptest! {
        #[test]
        fn remembered_gains_are_those_estimated_anew(
            rounds in prop::collection::vec(
                prop::collection::vec((0..SIDE, 0..SIDE, 0_u8..3), 0..6), 1..6,
            ),
        ) {
            let mut map = rooms();
            let mut memory = GainMemory::default();
            let locations = [(5, 30), (28, 21), (33, 38), (55, 30)].map(|(x, y)| Cell::new(x, y));
            for changes in rounds {
                for (x, y, kind) in changes {
                    let value = [Occupancy::Unknown, Occupancy::Free, Occupancy::Occupied][usize::from(kind)];
                    map.set(Cell::new(x, y), value);
                }
                let offset = Cell::new(-7, 3);
                let found =
                    memory.gains(state(&map, offset), &locations, QUADRANTS, InformationGain::in_quadrant);
                let anew = state(&map, offset);
                let expected: Vec<f64> = locations.iter().map(|&p| anew.at(p, &mut Vec::new())).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn only_what_a_change_can_be_seen_from_is_estimated_again() {
        let mut map = rooms();
        let mut memory = GainMemory::default();
        let asked = Counter::new(0);
        let mut gains = |map: &OccupancyGrid, offset: Cell, locations: &[Cell]| {
            asked.set(0);
            let count = |state: &InformationGain, quadrant, p, examined: &mut _| {
                asked.set(asked.get() + 1);
                state.in_quadrant(quadrant, p, examined)
            };
            let gains = memory.gains(state(map, offset), locations, QUADRANTS, count);
            (gains, asked.get())
        };
        let (left, right) = (Cell::new(25, 30), Cell::new(35, 30));
        let (first, asked) = gains(&map, Cell::new(0, 0), &[left, right]);
        assert_eq!(asked, 2 * QUADRANTS);
        // On the left side of the wall, which hides it from the right.
        map.set(Cell::new(25, 41), Occupancy::Free);
        let (second, asked) = gains(&map, Cell::new(0, 0), &[left, right]);
        assert_eq!((asked, second[1]), (1, first[1]));
        assert!((first[0] - second[0] - 0.01).abs() < 1e-9);
        // The same cells of a map that has grown to the left.
        let frame = GridFrame { width: SIDE + 5, ..*map.frame() };
        let mut grown = OccupancyGrid::filled(frame, Occupancy::Unknown);
        for cell in map.frame().cells() {
            grown.set(Cell::new(cell.x + 5, cell.y), map.at(cell));
        }
        let moved = [left, right].map(|p| Cell::new(p.x + 5, p.y));
        assert_eq!(gains(&grown, Cell::new(-5, 0), &moved), (second, 0));
    }
}
