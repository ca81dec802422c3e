//! What every cell does to the rays of the released program's gain, kept from choice to choice.

use super::information_gain::AlignedPrior;
use super::rays::{STOPS, UNKNOWN};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};
use crate::navigation::CostGrid;

/// The states of the cells of a map and of those around it, as far as rays reach.
#[derive(Debug, Default)]
pub(super) struct RayField {
    /// How far rays reach (cells).
    margin: usize,
    /// Inflated costs from this one on end rays; unknown cells cost nothing.
    stop: u8,
    known: Option<Known>,
    /// The lattice cells whose states the last update changed.
    changes: Vec<Cell>,
    /// Memory for a row.
    row: Vec<u8>,
}

#[derive(Debug)]
struct Known {
    frame: GridFrame,
    /// Lattice cell of the map's cell (0, 0).
    offset: Cell,
    width: usize,
    states: Vec<u8>,
    /// What cells do of which the robot knows nothing: the prior's part, which stays.
    unseen: Vec<u8>,
}

impl RayField {
    /// Creates a field for rays of `range` cells that end where the inflated cost is `stop` or more.
    pub(super) fn new(range: i32, stop: u8) -> Self {
        let margin = usize::try_from(range).unwrap_or(0);
        Self { margin, stop, ..Self::default() }
    }

    /// Takes in `map`, whose cell (0, 0) is the lattice cell `offset`, and the same map inflated, and returns the lattice cells
    /// whose states this changed; `None` where there is no telling. With a `prior`, which is always the same, cells end rays
    /// that are not free in it.
    pub(super) fn update(
        &mut self,
        map: &OccupancyGrid,
        costs: &CostGrid,
        offset: Cell,
        prior: Option<&AlignedPrior>,
    ) -> Option<&[Cell]> {
        self.changes.clear();
        let frame = map.frame();
        let mut is_told = self.known.is_some();
        let mut known = match self.known.take() {
            Some(known) if known.frame == *frame && known.offset == offset => known,
            earlier => {
                let mut laid = self.laid_over(frame, offset, prior);
                is_told = earlier.is_some_and(|earlier| laid.take_over(&earlier, self.margin));
                laid
            }
        };
        let cells = usize::try_from(frame.width).unwrap_or(0);
        self.row.resize(cells, 0);
        for (y, values) in (0..).zip(map.values().chunks(cells.max(1))) {
            let first = known.index(Cell::new(0, y), self.margin);
            let states = &mut known.states[first..first + cells];
            let unseen = &known.unseen[first..first + cells];
            let was = states.iter().zip(values).zip(costs.row(y)).zip(unseen);
            let mut differs = 0;
            for (now, (((old, value), cost), unseen)) in self.row.iter_mut().zip(was) {
                let is_dear = (self.stop..=100).contains(cost);
                let is_unknown = *value == Occupancy::Unknown;
                *now = (unseen & STOPS)
                    | (u8::from(is_dear) * STOPS)
                    | (u8::from(is_unknown) * UNKNOWN);
                differs |= *now ^ *old;
            }
            // Most rows are as they were.
            if differs != 0 {
                let both = (offset.x..).zip(states.iter().zip(&self.row));
                let changed = both.filter(|(_, (old, new))| old != new);
                self.changes.extend(changed.map(|(x, _)| Cell::new(x, y + offset.y)));
                states.copy_from_slice(&self.row);
            }
        }
        self.known = Some(known);
        is_told.then_some(&self.changes)
    }

    /// Returns the states of all cells row by row, how long rows are, and the place of the map's cell `p`.
    pub(super) fn states(&self, p: Cell) -> (&[u8], usize, usize) {
        let known = self.known.as_ref();
        known.map_or((&[], 0, 0), |known| (&known.states, known.width, known.index(p, self.margin)))
    }

    /// Returns a field over `frame` in which nothing is known but the prior.
    fn laid_over(&self, frame: &GridFrame, offset: Cell, prior: Option<&AlignedPrior>) -> Known {
        let side = |cells: i32| usize::try_from(cells).unwrap_or(0) + 2 * self.margin;
        let (width, height) = (side(frame.width), side(frame.height));
        // Unknown cells cost nothing.
        let alone = if self.stop == 0 { UNKNOWN | STOPS } else { UNKNOWN };
        let mut unseen = vec![alone; width * height];
        if let Some(prior) = prior {
            let margin = i32::try_from(self.margin).unwrap_or(0);
            let corner = Cell::new(offset.x - margin, offset.y - margin);
            for (y, row) in (corner.y..).zip(unseen.chunks_mut(width.max(1))) {
                for (x, cells) in (corner.x..).step_by(64).zip(row.chunks_mut(64)) {
                    let free = prior.free_word(x, y);
                    for (i, cell) in cells.iter_mut().enumerate() {
                        *cell |= if free >> i & 1 == 0 { STOPS } else { 0 };
                    }
                }
            }
        }
        Known { frame: *frame, offset, width, states: unseen.clone(), unseen }
    }
}

impl Known {
    /// Takes over the states of the cells of `earlier`, a part of this one, and returns whether it is one.
    fn take_over(&mut self, earlier: &Self, margin: usize) -> bool {
        let old = earlier.frame;
        let corner = Cell::new(earlier.offset.x - self.offset.x, earlier.offset.y - self.offset.y);
        let far = Cell::new(corner.x + old.width - 1, corner.y + old.height - 1);
        let is_part = self.frame.contains(corner) && self.frame.contains(far);
        if is_part && old.resolution == self.frame.resolution {
            let cells = usize::try_from(old.width).unwrap_or(0);
            for y in 0..old.height {
                let from = earlier.index(Cell::new(0, y), margin);
                let to = self.index(Cell::new(corner.x, corner.y + y), margin);
                self.states[to..to + cells].copy_from_slice(&earlier.states[from..from + cells]);
            }
        }
        is_part
    }

    /// Returns the place of the map's `cell` among the states.
    fn index(&self, cell: Cell, margin: usize) -> usize {
        #[expect(clippy::cast_sign_loss, reason = "cells of the map are not negative")]
        let (x, y) = (cell.x as usize + margin, cell.y as usize + margin);
        y * self.width + x
    }
}
