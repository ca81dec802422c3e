//! Grid maps of the plane: the position of cells, and their values.
//!
//! Cells are squares of `resolution` m; cell (0, 0) has its lower left corner at `origin` and rows run along
//! y, as in ROS's `nav_msgs/OccupancyGrid`.

mod cell_set;
mod line;
mod visibility;

pub use cell_set::{Axis, CellSet, Run};
pub use line::{Walk, line};
pub use visibility::{QUADRANTS, examine_quadrant, examine_runs, visible_runs};

use crate::geometry::{Bounds, Point};
use serde::{Deserialize, Serialize};

/// A cell by column (along x) and row (along y). May lie outside of any particular grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// Column, counted along x.
    pub x: i32,
    /// Row, counted along y.
    pub y: i32,
}

impl Cell {
    /// Returns the cell of column `x` and row `y`.
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// Returns the four cells that share a side, in the order east, north, west, south.
    pub fn neighbours4(self) -> [Self; 4] {
        [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(dx, dy)| Self::new(self.x + dx, self.y + dy))
    }

    /// Returns the eight cells that share a side or a corner, counter-clockwise from east.
    pub fn neighbours8(self) -> [Self; 8] {
        [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
            .map(|(dx, dy)| Self::new(self.x + dx, self.y + dy))
    }

    /// Returns the squared distance in cells between the centres.
    pub fn distance_squared(self, other: Self) -> i64 {
        let (dx, dy) = (i64::from(self.x - other.x), i64::from(self.y - other.y));
        dx * dx + dy * dy
    }
}

/// The position and resolution of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GridFrame {
    /// Side of a cell (m), positive.
    pub resolution: f64,
    /// Lower left corner of cell (0, 0) (m).
    pub origin: Point,
    /// Columns.
    pub width: i32,
    /// Rows.
    pub height: i32,
}

impl GridFrame {
    /// Creates the frame of `resolution` m cells that covers `bounds`, its origin a whole number of cells from zero.
    pub fn covering(bounds: Bounds, resolution: f64) -> Self {
        let low = |v: f64| (v / resolution).floor();
        let (x0, y0) = (low(bounds.min.x), low(bounds.min.y));
        let (x1, y1) = (low(bounds.max.x) + 1.0, low(bounds.max.y) + 1.0);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a building has fewer than 2^31 cells a side"
        )]
        Self {
            resolution,
            origin: Point::new(x0 * resolution, y0 * resolution),
            width: (x1 - x0) as i32,
            height: (y1 - y0) as i32,
        }
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        usize::try_from(self.width).unwrap_or(0) * usize::try_from(self.height).unwrap_or(0)
    }

    /// Returns whether the grid has no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the cell that holds `point`; it may lie outside of the grid.
    pub fn cell_at(&self, point: Point) -> Cell {
        let index = |v: f64| {
            let cells = v / self.resolution;
            #[expect(
                clippy::cast_possible_truncation,
                reason = "saturates, and such cells are outside"
            )]
            let cut = cells as i32;
            // Rounded down: what `floor` yields, without a call where the processor has no instruction for it.
            cut.saturating_sub(i32::from(f64::from(cut) > cells))
        };
        Cell::new(index(point.x - self.origin.x), index(point.y - self.origin.y))
    }

    /// Returns the centre of `cell` (m).
    pub fn center(&self, cell: Cell) -> Point {
        Point::new(
            self.origin.x + (f64::from(cell.x) + 0.5) * self.resolution,
            self.origin.y + (f64::from(cell.y) + 0.5) * self.resolution,
        )
    }

    /// Returns whether `cell` belongs to the grid.
    pub fn contains(&self, cell: Cell) -> bool {
        (0..self.width).contains(&cell.x) && (0..self.height).contains(&cell.y)
    }

    /// Returns whether `cell` and all its eight neighbours belong to the grid.
    pub fn is_inside(&self, cell: Cell) -> bool {
        (1..self.width - 1).contains(&cell.x) && (1..self.height - 1).contains(&cell.y)
    }

    /// Returns the index of `cell` in row-major order from the lower left, or `None` outside.
    pub fn index(&self, cell: Cell) -> Option<usize> {
        #[expect(clippy::cast_sign_loss, reason = "contained cells are not negative")]
        self.contains(cell).then(|| cell.y as usize * self.width as usize + cell.x as usize)
    }

    /// Returns the cell of row-major `index`.
    pub fn cell_of(&self, index: usize) -> Cell {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            clippy::cast_sign_loss,
            reason = "indices of a grid fit"
        )]
        Cell::new((index % self.width as usize) as i32, (index / self.width as usize) as i32)
    }

    /// Returns all cells, row by row from the lower left.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| Cell::new(x, y)))
    }

    /// Returns the area covered (m).
    pub fn bounds(&self) -> Bounds {
        Bounds {
            min: self.origin,
            max: self.origin
                + Point::new(f64::from(self.width), f64::from(self.height)) * self.resolution,
        }
    }
}

/// The state of a cell in an occupancy map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Occupancy {
    /// Never observed (ROS -1).
    Unknown,
    /// Observed free (ROS 0).
    Free,
    /// Observed occupied (ROS 100).
    Occupied,
}

/// A dense grid of `T`, row-major from the lower left.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<T> {
    frame: GridFrame,
    cells: Vec<T>,
}

/// A map of free, occupied and unknown cells.
///
/// ```
/// use reenact::geometry::Point;
/// use reenact::grid::{GridFrame, Occupancy, OccupancyGrid};
///
/// let frame = GridFrame { resolution: 0.5, origin: Point::new(-1.0, -1.0), width: 4, height: 4 };
/// let mut map = OccupancyGrid::filled(frame, Occupancy::Unknown);
/// map.set(frame.cell_at(Point::new(0.2, 0.9)), Occupancy::Occupied);
/// assert_eq!(map.count(Occupancy::Unknown), 15);
/// let wall = frame.cells().find(|cell| map.at(*cell) == Occupancy::Occupied).unwrap();
/// assert_eq!(frame.center(wall), Point::new(0.25, 0.75));
/// ```
pub type OccupancyGrid = Grid<Occupancy>;

impl<T: Copy> Grid<T> {
    /// Creates a grid of `frame` filled with `value`.
    pub fn filled(frame: GridFrame, value: T) -> Self {
        Self { cells: vec![value; frame.len()], frame }
    }

    /// Returns a grid of `frame` with `cells` in row-major order from the lower left.
    ///
    /// # Panics
    /// Where the number of cells does not fit the frame.
    pub fn from_cells(frame: GridFrame, cells: Vec<T>) -> Self {
        assert_eq!(cells.len(), frame.len(), "a grid holds one value per cell");
        Self { frame, cells }
    }

    /// Returns the frame of the grid.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Returns the value at `cell`, or `None` outside.
    pub fn get(&self, cell: Cell) -> Option<T> {
        self.frame.index(cell).map(|i| self.cells[i])
    }

    /// Sets the value at `cell`; outside of the grid nothing happens.
    pub fn set(&mut self, cell: Cell, value: T) {
        if let Some(i) = self.frame.index(cell) {
            self.cells[i] = value;
        }
    }

    /// Returns all values, row-major from the lower left.
    pub fn values(&self) -> &[T] {
        &self.cells
    }

    /// Returns all values, row-major from the lower left.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.cells
    }
}

impl OccupancyGrid {
    /// Returns the occupancy of `cell`; unknown outside of the grid.
    pub fn at(&self, cell: Cell) -> Occupancy {
        self.get(cell).unwrap_or(Occupancy::Unknown)
    }

    /// Returns how many cells hold `value`.
    pub fn count(&self, value: Occupancy) -> usize {
        self.cells.iter().filter(|&&c| c == value).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame() -> GridFrame {
        GridFrame { resolution: 0.1, origin: Point::new(-1.0, 2.0), width: 30, height: 20 }
    }

    #[test]
    fn cells_outside_are_unknown_and_cannot_be_set() {
        let mut grid = OccupancyGrid::filled(frame(), Occupancy::Free);
        for cell in
            [Cell::new(-1, 0), Cell::new(30, 0), Cell::new(0, 20), Cell::new(i32::MAX, i32::MIN)]
        {
            grid.set(cell, Occupancy::Occupied);
            assert_eq!(grid.at(cell), Occupancy::Unknown);
        }
        assert_eq!(grid.count(Occupancy::Free), 600);
    }

    #[test]
    fn covering_aligns_to_whole_cells() {
        let bounds = Bounds { min: Point::new(-0.95, 0.0), max: Point::new(1.0, 0.31) };
        let frame = GridFrame::covering(bounds, 0.5);
        assert_eq!((frame.origin, frame.width, frame.height), (Point::new(-1.0, 0.0), 5, 1));
        assert!(frame.bounds().contains(bounds.min) && frame.bounds().contains(bounds.max));
    }

    proptest! {
        #[test]
        fn cells_are_rounded_down(x in prop::num::f64::ANY, y in -5.0..5.0_f64) {
            let frame = frame();
            #[expect(clippy::cast_possible_truncation, reason = "saturates too")]
            let down = |v: f64| (v / frame.resolution).floor() as i32;
            let expected = Cell::new(down(x - frame.origin.x), down(y - frame.origin.y));
            prop_assert_eq!(frame.cell_at(Point::new(x, y)), expected);
        }

        #[test]
        fn a_cell_holds_its_centre_and_its_index(x in 0..30, y in 0..20) {
            let (frame, cell) = (frame(), Cell::new(x, y));
            prop_assert_eq!(frame.cell_at(frame.center(cell)), cell);
            prop_assert_eq!(frame.cell_of(frame.index(cell).unwrap()), cell);
        }
    }
}
