//! A grid of traversal costs.

use crate::grid::{Cell, GridFrame};

/// Cost of entering each cell: 0 free of danger, up to 100 an obstacle; unknown cells have none.
#[derive(Debug, Clone, PartialEq)]
pub struct CostGrid {
    frame: GridFrame,
    /// Row by row from the lower left, with one row or column of unknown cells around, so that spreading over cells
    /// needs no test of the grid's border.
    costs: Vec<u8>,
}

/// Stored for unknown cells: more than any cost, so that it is never below one.
pub(super) const UNKNOWN: u8 = 255;

impl CostGrid {
    /// Returns a grid of unknown cells.
    pub fn unknown(frame: GridFrame) -> Self {
        Self { frame, costs: vec![UNKNOWN; padded_len(&frame)] }
    }

    /// Returns the frame of the grid.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Returns the cost (0 to 100) of `cell`, or `None` where it is unknown or outside.
    pub fn cost(&self, cell: Cell) -> Option<u8> {
        let index = padded_index(&self.frame, cell)?;
        Some(self.costs[index]).filter(|&cost| cost != UNKNOWN)
    }

    /// Sets the cost (0 to 100) of `cell`; outside of the grid nothing happens.
    pub fn set(&mut self, cell: Cell, cost: u8) {
        if let Some(index) = padded_index(&self.frame, cell) {
            self.costs[index] = cost;
        }
    }

    /// Returns whether `cell` is known and cheaper than `lethal`.
    pub fn is_below(&self, cell: Cell, lethal: u8) -> bool {
        self.cost(cell).is_some_and(|cost| cost < lethal)
    }

    /// Returns the costs of row `y` of the grid; more than any cost where cells are unknown.
    pub fn row(&self, y: i32) -> &[u8] {
        match padded_index(&self.frame, Cell::new(0, y)) {
            Some(first) => &self.costs[first..first + padded_width(&self.frame) - 2],
            None => &[],
        }
    }

    /// Copies `length` costs of a row of `other` from the cell `from` on, to `to` and the cells after it. Both rows
    /// hold them.
    pub(super) fn copy_row(&mut self, to: Cell, other: &Self, from: Cell, length: usize) {
        let (to, from) = (padded_index(&self.frame, to), padded_index(&other.frame, from));
        if let (Some(to), Some(from)) = (to, from) {
            self.costs[to..to + length].copy_from_slice(&other.costs[from..from + length]);
        }
    }

    /// Does the same, and adds the padded indices of the costs that this changes to `changed`.
    pub(super) fn copy_changes(
        &mut self,
        to: Cell,
        other: &Self,
        from: Cell,
        length: usize,
        changed: &mut Vec<u32>,
    ) {
        let (to, from) = (padded_index(&self.frame, to), padded_index(&other.frame, from));
        let (Some(to), Some(from)) = (to, from) else { return };
        let (old, new) = (&mut self.costs[to..to + length], &other.costs[from..from + length]);
        if old != new {
            let index = |i: usize| u32::try_from(to + i).unwrap_or(u32::MAX);
            changed.extend((0..length).filter(|&i| old[i] != new[i]).map(index));
            old.copy_from_slice(new);
        }
    }

    /// Returns all costs, padded.
    pub(super) fn padded(&self) -> &[u8] {
        &self.costs
    }

    /// Returns all costs, padded.
    pub(super) fn padded_mut(&mut self) -> &mut [u8] {
        &mut self.costs
    }
}

/// Returns the number of cells with the padding.
pub(super) fn padded_len(frame: &GridFrame) -> usize {
    padded_width(frame) * (usize::try_from(frame.height).unwrap_or(0) + 2)
}

/// Returns the number of cells of a row with the padding.
pub(super) fn padded_width(frame: &GridFrame) -> usize {
    usize::try_from(frame.width).unwrap_or(0) + 2
}

/// Returns the index of `cell` among the padded ones, or `None` outside of the grid.
pub(super) fn padded_index(frame: &GridFrame, cell: Cell) -> Option<usize> {
    #[expect(clippy::cast_sign_loss, reason = "contained cells are not negative")]
    frame.contains(cell).then(|| (cell.y as usize + 1) * padded_width(frame) + cell.x as usize + 1)
}
