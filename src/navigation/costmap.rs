//! A grid of traversal costs.

use crate::grid::{Cell, Grid, GridFrame};

/// Cost of entering each cell: 0 free of danger, up to 100 an obstacle; unknown cells have none.
#[derive(Debug, Clone, PartialEq)]
pub struct CostGrid {
    costs: Grid<u8>,
}

/// Stored for unknown cells.
const UNKNOWN: u8 = 255;

impl CostGrid {
    /// A grid of unknown cells.
    pub fn unknown(frame: GridFrame) -> Self {
        Self { costs: Grid::filled(frame, UNKNOWN) }
    }

    /// Where the grid lies.
    pub fn frame(&self) -> &GridFrame {
        self.costs.frame()
    }

    /// The cost (0 to 100) of `cell`, or `None` where it is unknown or outside.
    pub fn cost(&self, cell: Cell) -> Option<u8> {
        self.costs.get(cell).filter(|&cost| cost != UNKNOWN)
    }

    /// Sets the cost (0 to 100) of `cell`.
    pub fn set(&mut self, cell: Cell, cost: u8) {
        self.costs.set(cell, cost);
    }

    /// Whether `cell` is known and cheaper than `lethal`.
    pub fn is_below(&self, cell: Cell, lethal: u8) -> bool {
        self.cost(cell).is_some_and(|cost| cost < lethal)
    }
}
